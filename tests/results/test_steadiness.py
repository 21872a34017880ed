"""Whether a mean velocity is that of a steady motion: said where it is not, and only there. And results that cannot be written to."""

import dataclasses
import importlib
import inspect
import itertools
import pkgutil
import re

import matplotlib
import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.results.steadiness import IRREGULAR, STEADY, UNKNOWN, UNSETTLED

#: What counts as steady: an error below this, relative to the steady mean.
CLOSE = 1e-6


def level_robots(count, seed):
    """Moving Coulomb robots whose weaker friction is 1e-4 to 1 of the drive, the stronger up to ten times that."""
    random = np.random.default_rng(seed)
    weak = 10 ** random.uniform(-4, 0, count)
    strong = weak * 10 ** random.uniform(0, 1, count)
    swapped = random.random(count) < 0.5
    return ss.presets.coulomb_robot(np.where(swapped, strong, weak), np.where(swapped, weak, strong))


@pytest.fixture(scope="module")
def weakly_damped():
    """alpha = 1e-3: it takes thousands of periods to settle."""
    return ss.solve(ss.presets.coulomb_robot(1e-3, 2e-3))


@each_row("asked", [{}, {"periods": 40}, {"periods": 1000}, {"settle": "auto"}], ids=["200", "40", "1000", "auto"])
def test_every_mean_that_is_off_is_said_to_be(asked):
    """1900 level robots against the closed formula: none that is off by more than 1e-6 is called steady."""
    robots = level_robots(1900, seed=1)
    true, many = ss.analysis.periodic_mean_velocity(robots), ss.solve(robots, keep="summary", **asked)
    off = abs(many.mean_velocity / true - 1) > CLOSE
    assert off.sum() > 500 and (many.steadiness[off] == UNSETTLED).all()
    assert (many.steadiness[~off] != STEADY).sum() <= (0.04 if asked.get("settle") == "auto" else 0.0) * len(off)
    known = off & np.isfinite(many.settling_error) & (abs(many.mean_velocity - true) > 1e-9)
    ratio = many.settling_error[known] / abs(many.mean_velocity - true)[known]
    assert ratio.min() > 0.1 and ratio.max() < 5.0, "40 periods of a transient of thousands say no more than the order"


def test_a_run_that_has_not_settled_says_so_and_what_to_type(weakly_damped):
    (note,) = weakly_damped.notes
    assert "has not settled" in note and "ss.analysis.periodic_mean_velocity(robot, periods=" in note and "type more periods" in note
    true = float(ss.analysis.periodic_mean_velocity(weakly_damped.model))
    assert weakly_damped.steadiness.error == pytest.approx(abs(weakly_damped.steadiness.mean_velocity - true), rel=0.2)


@each_row("law", ["coulomb", "coulomb-static", "lugre"])
def test_where_a_note_recommends_the_steady_motion_itself_there_is_one(law):
    """Robots from little friction to much, after few periods and after many: what the note says is typed, and gives a number."""
    recommended = 0
    for mu, periods in itertools.product((2e-4, 2e-3, 2e-2, 0.2), (3, 12, 60, 200)):
        rig = ss.presets.piezo_rig(tilt_deg=float(np.degrees(np.arctan(0.3 * mu))), amplitude=6e-4, mu0=mu, law=law)
        note = ss.solve(rig, periods=periods).steadiness.note
        typed = re.search(r"ss\.analysis\.periodic_mean_velocity\(robot(?:, periods=(\d+))?\)", note)
        if typed:
            recommended += 1
            assert np.isfinite(ss.analysis.periodic_mean_velocity(rig, **({"periods": int(typed[1])} if typed[1] else {}))), (
                mu,
                periods,
                note,
            )
        assert bool(note) == (ss.solve(rig, periods=periods).steadiness.code == UNSETTLED)
    assert recommended > 0


def test_a_run_and_its_batch_say_the_same_of_settling(weakly_damped):
    many = ss.solve(weakly_damped.model, keep="summary")
    assert many.steadiness == weakly_damped.steadiness.code == UNSETTLED
    assert float(many.settling_error) == pytest.approx(weakly_damped.steadiness.error, rel=1e-6)
    assert "1 case has not settled" in many.notes[0] and "1 not settled" in repr(many)


def test_steady_and_irregular_runs_have_no_note():
    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[6e-4, 4e-4], mu0=[0.04, 0.05])  # period two; chaos
    many = ss.solve(rig, keep="summary", periods=400, settle=200)
    assert many.steadiness.tolist() == [STEADY, IRREGULAR] and many.notes == []
    bench = ss.ForcedOscillator(mass=1.0, stiffness=1.0, force=1.0, omega=0.3, friction=ss.Coulomb(0.1, 0.1), damping=0.02)
    symmetric = ss.sweep(bench, omega=[0.3, 0.6, 0.9])  # means are zero within rounding; nothing is relative to them
    assert (symmetric.steadiness == STEADY).all() and abs(symmetric.mean_velocity).max() < 1e-9
    for amplitude, mu0, code in ((6e-4, 0.04, STEADY), (4e-4, 0.05, IRREGULAR)):
        run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=amplitude, mu0=mu0), periods=400, settle=200)
        assert run.steadiness.code == code and run.notes == run.model.notes


def test_what_has_no_period_is_not_judged():
    belt = ss.BlockOnBelt(mass=1.0, stiffness=100.0, speed=0.1, friction=ss.Coulomb(0.2, 0.2))
    assert ss.solve(belt, duration=2.0).steadiness.code == UNKNOWN


def test_a_sweep_has_a_column_and_a_map_marks_what_has_not_settled():
    matplotlib.use("Agg")
    axis = np.geomspace(2e-3, 1.2, 12)
    grid = ss.sweep(ss.presets.coulomb_robot, alpha_plus=axis, alpha_minus=axis, settle=100)
    assert (grid.steadiness == UNSETTLED).any() and "1: not settled" in grid.steadiness.attrs["flag_meanings"]
    for draw in (ss.plot.motion_map, ss.plot.velocity_map):
        words = [text.get_text() for text in draw(grid).get_legend().get_texts()]
        assert "not settled" in words
    settled = ss.sweep(ss.presets.coulomb_robot, alpha_plus=[0.4, 0.6], alpha_minus=[0.7, 0.9])
    assert (settled.steadiness == STEADY).all()
    assert "not settled" not in [text.get_text() for text in ss.plot.motion_map(settled).figure.axes[0].get_legend().get_texts()]


def test_the_mean_lies_between_the_extremes_settled_or_not():
    """Decelerating, creeping, accelerating down a slope: where the motion is not steady all three are those of one window."""
    random = np.random.default_rng(2)
    robots = level_robots(300, seed=2)
    for many in (ss.solve(robots, keep="summary", periods=n) for n in (5, 40, 200)):
        assert ((many.velocity_min <= many.mean_velocity) & (many.mean_velocity <= many.velocity_max)).all()
    slope = ss.presets.piezo_rig(tilt_deg=random.uniform(0, 6, 60), amplitude=3e-4, mu0=0.05, law="coulomb", incline="gravity")
    still = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[0.0, 1e-12], law="coulomb")
    drive = ss.Harmonic(amplitude=4e-4, omega=random.uniform(30, 400, 60))
    viscous = ss.Robot(0.1, 0.05, drive, ss.CoulombViscous(0.02, 0.03, viscous=1e-3))
    for robot, asked in ((slope, {}), (still, {"start": {"v": 0.05}, "periods": 20}), (viscous, {})):
        many = ss.solve(robot, keep="summary", **asked)
        room = 1e-12 * np.maximum(abs(many.velocity_min), abs(many.velocity_max))
        assert ((many.velocity_min - room <= many.mean_velocity) & (many.mean_velocity <= many.velocity_max + room)).all()


@pytest.mark.slow
def test_every_law_says_what_has_not_settled():
    """Batches of 150 random robots of four laws against runs of 3000 periods: no mean that is off by more than 1e-6 is called steady."""
    random, n = np.random.default_rng(3), 150
    mu, ratio = 10 ** random.uniform(-3.5, -0.8, n), 10 ** random.uniform(0, 0.6, n)
    drive = ss.Harmonic(amplitude=random.uniform(1e-4, 9e-4, n), omega=10 ** random.uniform(1.5, 2.6, n))
    rig = dict(tilt_deg=random.uniform(0, 4, n), amplitude=random.uniform(1e-4, 9e-4, n), mu0=10 ** random.uniform(-2, -0.7, n))
    robots = [
        ss.presets.piezo_rig(incline="gravity", **rig),
        ss.presets.piezo_rig(incline="gravity", law="coulomb-static", **rig),
        ss.Robot(0.1, 0.05, drive, ss.Stribeck(mu, mu * ratio, 1.3 * mu, 1.3 * mu * ratio, v_s=1e-3)),
        ss.Robot(0.1, 0.05, drive, ss.CoulombViscous(mu, mu * ratio, viscous=10 ** random.uniform(-4, -1, n))),
    ]
    alarms, cases = 0, 0
    for robot in robots:
        long = ss.solve(robot, periods=3000, settle=2000, keep="summary", workers=2)
        known, scale = long.steadiness == STEADY, abs(long.mean_velocity) + 1e-6 * robot.free_velocity
        for asked in ({}, {"periods": 40}, {"settle": "auto"}):
            many = ss.solve(robot, keep="summary", **asked)
            off = known & (abs(many.mean_velocity - long.mean_velocity) > CLOSE * scale)
            assert (many.steadiness[off] != STEADY).all()
            alarms += int((known & ~off & (many.steadiness != STEADY)).sum())
            cases += int((known & ~off).sum())
    assert alarms <= 0.01 * cases


# ---- results cannot be written to ----
def test_nothing_written_into_a_run_changes_it(weakly_damped):
    run, before = weakly_damped, ss.mean_velocity(weakly_damped)
    for name in ("t", "x", "v", "mode", "acceleration", "friction_force", "xi", "strobe_x", "strobe_v", "strobe_times"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(run, name)[:] = 0
    with pytest.raises(ValueError, match="read-only"):
        run.pieces.v0[:] = 0
    assert ss.mean_velocity(run) == before


def records():
    """Every frozen dataclass of the package that says of a field that it is an array."""
    for module in pkgutil.walk_packages(ss.__path__, "stickslip."):
        if "__main__" in module.name or ".kernels" in module.name:
            continue
        for _, cls in inspect.getmembers(importlib.import_module(module.name), inspect.isclass):
            own = cls.__module__ == module.name and dataclasses.is_dataclass(cls) and cls.__dataclass_params__.frozen
            if own and any("Array" in str(f.type) and "Callable" not in str(f.type) for f in dataclasses.fields(cls)):
                yield cls


#: Records of a computation under way, which no result holds.
_WITHIN = {"Answer", "ArcNumbers", "Arcs", "Asked", "Column", "Image", "RawParts", "Standing"}


def test_every_record_that_holds_arrays_seals_them():
    open_to_all = [c.__qualname__ for c in records() if not hasattr(c.__init__, "__wrapped__") and not c.__name__.startswith("_")]
    assert set(open_to_all) <= _WITHIN, open_to_all


def test_results_of_every_kind_are_sealed():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    run = ss.solve(robot, periods=20)
    orbit = ss.periodic_orbit(robot)
    found = [run, run.pieces, ss.solve(robot, keep="summary"), ss.energy(run), orbit, orbit.run, ss.lyapunov(robot, periods=20)]
    for record in found:
        for field in dataclasses.fields(record):
            assert_sealed(getattr(record, field.name), f"{type(record).__name__}.{field.name}")


def assert_sealed(value, name):
    if isinstance(value, np.ndarray):
        assert not value.flags.writeable, name
    elif isinstance(value, dict):
        for key, part in value.items():
            assert_sealed(part, f"{name}[{key!r}]")
    elif isinstance(value, (list, tuple)):
        for i, part in enumerate(value):
            assert_sealed(part, f"{name}[{i}]")
