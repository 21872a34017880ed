"""A user's own columns: what lanes make of a function of the state is what the dense output of single runs says."""

import numpy as np
import pytest

import every
import stickslip as ss
from parts_of_runs import solved
from rows import each_row
from stickslip.maths import sin, where

PERIODS = 60
ROBOT = every.SHAKEN
LUGRE = ROBOT.replace(friction=ss.LuGre.example())
CHAIN = ss.Chain.example()
#: The judge's rectangle rule on 1e5 samples of a period is exact for smooth periodic functions; a kink costs a sample's part, (1e-5)^2.
SAMPLES, KINK = 100_000, 1e-8


def last_period(run, period=1):
    """The columns at many instants of the last motion period."""
    T = run.period_time * max(period, 1)
    return run.at(run.pieces.t[-1] - T * (1 - (np.arange(SAMPLES) + 0.5) / SAMPLES))


OF_ONE = {
    "square": ss.observable(lambda s: s.v**2, "mean", "m^2/s^2"),
    "speed": ss.observable(lambda s: abs(s.v), "mean", "m/s"),
    "top": ss.observable(lambda s: s.v, "max", "m/s"),
    "way": ss.observable(lambda s: s.v, "integral", "m"),
    "power": ss.observable(lambda s: s.friction_force * s.slip, "mean", "W"),
    "least": ss.observable(lambda s: s.friction_force / s.load, "min"),
    "forwards": ss.observable(lambda s: where(s.v > 0, s.v * sin(s.model.drive.omega * s.t), 0.0), "mean", "m/s"),
    "end": ss.observable(lambda s: s.v, "last", "m/s"),
}


def expected(run, at):
    v, force = at["v"], at["friction_force"]
    return {
        "square": (v**2).mean(), "speed": abs(v).mean(), "top": v.max(), "way": v.mean() * run.period_time,
        "power": (force * v).mean(), "least": (force / run.model.load(0.0, 0.0)).min(),
        "forwards": (np.maximum(v, 0) * np.sin(run.model.drive.omega * at["t"])).mean(), "end": run.v[-1],
    }  # fmt: skip


@pytest.mark.parametrize("robot", [ROBOT, LUGRE], ids=["Coulomb", "LuGre"])
def test_observables_of_a_robot_are_those_of_its_run(robot):
    many, run = solved(robot, PERIODS, rtol=1e-7, lanes_only={"observe": OF_ONE})
    want = expected(run, last_period(run))
    scale = float(robot.velocity_scale)
    for name, value in want.items():
        size = {"least": 1.0, "way": scale * run.period_time, "square": scale**2, "power": scale * float(abs(run.friction_force).max())}
        assert abs(getattr(many, name)[0] - value) <= 1e-6 * size.get(name, scale), name  # sampled peaks: (pi / 1e5)^2; steps: rtol
    assert abs(many.velocity_max[0] - many.top[0]) <= 1e-12 * scale
    assert many.friction_power[0] == pytest.approx(float(many.power[0]), rel=1e-12)


def test_other_columns_do_not_change_by_being_observed():
    """The closed arcs of Coulomb friction give way to Taylor steps, which are as exact."""
    batch = ROBOT.replace({"drive.amplitude": [4e-4, 6e-4]})
    plain, observed = ss.solve(batch, periods=PERIODS), ss.solve(batch, periods=PERIODS, observe=OF_ONE)
    assert (plain.motion_type == observed.motion_type).all() and (plain.pattern == observed.pattern).all()
    for name in ("mean_velocity", "velocity_max", "velocity_min", "stick_fraction", "forward_fraction"):
        assert np.allclose(plain.columns[name], observed.columns[name], rtol=1e-9, atol=1e-12), name
    assert set(observed.columns) >= set(plain.columns)


OF_SEVERAL = {
    "stretch": ss.observable(lambda s: s.bodies["module 1"].x - s.bodies["module 2"].x, "max", "m"),
    "product": ss.observable(lambda s: s.v[0] * s.v[1], "mean", "m^2/s^2"),
    "force": ss.observable(lambda s: s.contacts["module 2"].friction_force, "max", "N"),
    "work": ss.observable(lambda s: sum(r * w for r, w in zip(s.friction_force, s.slip, strict=True)), "integral", "J"),
    "jerk": ss.observable(lambda s: s.acceleration[1], "max", "m/s^2"),
}


def test_observables_of_several_bodies_are_those_of_their_run(tmp_path):
    axes = {"phases.1": [0.5, 1.0]}
    grid = ss.sweep(CHAIN, **axes, observe=OF_SEVERAL, out=tmp_path / "study")
    run = ss.solve(CHAIN.replace({"phases.1": 0.5}), periods=PERIODS)
    at = last_period(run)
    x, v, R = at["x"], at["v"], at["friction_force"]
    want = {
        "stretch": (x[:, 0] - x[:, 1]).max(), "product": (v[:, 0] * v[:, 1]).mean(), "force": R[:, 1].max(),
        "work": (R * at["slip"]).sum(axis=1).mean() * run.period_time, "jerk": at["acceleration"][:, 1].max(),
    }  # fmt: skip
    for name, value in want.items():
        assert float(grid[name][0]) == pytest.approx(value, rel=1e-6), name  # the strobe repeats to 1e-8; samples as above
    assert grid.work.attrs["units"] == "J" and grid.work.dims == ("phases.1",)
    assert float(grid.work[0]) == pytest.approx(float(grid.friction_power[0].sum()) * run.period_time, rel=1e-12)
    kept = ss.open_study(tmp_path / "study")
    assert kept.stretch.values.tolist() == grid.stretch.values.tolist() and kept.stretch.attrs == grid.stretch.attrs


def test_a_study_with_another_observable_is_another_study(tmp_path):
    axes = {"phases.1": [0.5, 1.0]}
    ss.sweep(CHAIN, **axes, periods=4, observe={"a": ss.observable(lambda s: s.v[0])}, out=tmp_path / "study")
    again = {"a": ss.observable(lambda s: s.v[0])}
    ss.sweep(CHAIN, **axes, periods=4, observe=again, out=tmp_path / "study", resume=True)
    with pytest.raises(ss.InputError, match="observe a was"):
        ss.sweep(CHAIN, **axes, periods=4, observe={"a": ss.observable(lambda s: s.v[1])}, out=tmp_path / "study", resume=True)


@each_row(
    ("function", "says"),
    [
        (lambda s: s.x[0], "depends on how far the machine went"),
        (lambda s: np.sin(s.v[0]), "ufunc.*stickslip.maths"),
        (lambda s: s.speed, "s has no 'speed'; it has t, model, x, v,"),
        (lambda s: 1.0 if s.v[0] > 0 else 0.0, "write where"),
        (lambda s: s.bodies["head"].v, "no part is called 'head'"),
        (lambda s: s.v, "bad:.*return one number"),
    ],
)
def test_what_cannot_be_traced_is_refused_with_a_reason(function, says):
    with pytest.raises(ss.InputError, match=says):
        ss.sweep(CHAIN, **{"phases.1": [0.5, 1.0]}, observe={"bad": ss.observable(function)})


def test_observe_says_what_it_takes():
    batch, good = ROBOT.replace({"drive.amplitude": [4e-4, 6e-4]}), {"a": ss.observable(lambda s: s.v)}
    for wrong, says in (
        ({"period": good["a"]}, "a name of letters that no column"),
        ({"a": lambda s: s.v}, "type ss.observable"),
        ([good["a"]], "allowed is a dict"),
    ):
        with pytest.raises(ss.InputError, match=says):
            ss.solve(batch, periods=4, observe=wrong)
    with pytest.raises(ss.InputError, match="reduce = 'median'; allowed is one of mean, integral"):
        ss.observable(lambda s: s.v, reduce="median")
    with pytest.raises(ss.InputError, match="observe is for the compiled methods"):
        ss.solve(batch, periods=4, method="dop853", observe=good)
    with pytest.raises(ss.InputError, match="observe makes columns of a batch"):
        ss.solve(ROBOT, periods=4, observe=good)
    with pytest.raises(ss.InputError, match="observe or events and continue_along"):
        ss.sweep(ROBOT, **{"drive.amplitude": [4e-4, 6e-4]}, continue_along="drive.amplitude", observe=good)
    with pytest.raises(ss.InputError, match="no column and no axis"):
        ss.sweep(ss.presets.piezo_rig, amplitude=[4e-4, 6e-4], tilt_deg=1.7, observe={"amplitude": good["a"]})
