"""The mechanisms against the closed forms of their literature; runs of a given duration."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

import stickslip as ss
from rows import each_row
from stickslip.analysis.oscillators import belt_period, den_hartog_amplitude

STATIC = ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)
LUGRE_1995 = ss.LuGre(1.0, 1.0, 1.5, 1.5, sigma0=1e5, sigma1=math.sqrt(1e5), sigma2=0.4, v_s=1e-3)  # Canudas de Wit et al. 1995
UNEVEN = ss.Coulomb(0.8, 1.2, f_plus=1.1, f_minus=1.5)

belt = ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=STATIC)
pull = ss.PulledMass(mass=1.0, stiffness=2.0, speed=0.1, friction=STATIC)


def oscillator(friction, **numbers):
    given = {"mass": 1.0, "stiffness": 1.0, "damping": 0.0, "force": 1.0, "omega": 0.7, **numbers}
    return ss.ForcedOscillator(friction=friction if not isinstance(friction, float) else ss.Coulomb(friction, friction), **given)


def plain(model, **arguments):
    return ss.solve(model, **{"method": "dop853", "rtol": 1e-12, **arguments})


def turning_points(run):
    return np.array([float(run.at(e.t)["x"]) for e in run.events])


# closed forms -----------------------------------------------------------------------------------------------------


def test_den_hartogs_amplitude_is_his():
    """O1, Den Hartog 1930."""
    assert den_hartog_amplitude(0.7, 0.3) == pytest.approx(1.88569985041425, rel=1e-12)


@each_row("ratio, friction", [(0.7, 0.3), (0.9, 0.6), (1.7, 0.3)])
def test_the_forced_oscillator_has_den_hartogs_amplitude(ratio, friction):
    """What is left of the transient is below 1e-10 after 60 periods; steps and events are held to 1e-12."""
    bench = oscillator(friction, omega=ratio)
    settled = ss.solve(bench, periods=55)
    run = plain(bench, periods=12, samples=4, start={"x": settled.x[-1], "v": settled.v[-1]})
    amplitude = abs(turning_points(run)[-2:])
    assert amplitude == pytest.approx(den_hartog_amplitude(ratio, friction), rel=1e-9)
    assert {e.kind for e in run.events[-20:]} == {"reversal"}


def test_where_the_closed_form_ends_the_mass_stops():
    """The form is NaN beyond X r^2 = F; just beyond, the simulated mass rests once in each half period."""
    ratio = 0.7
    friction = brentq(lambda f: np.nan_to_num(den_hartog_amplitude(ratio, f), nan=-1.0), 0.1, 0.9)
    assert np.isfinite(den_hartog_amplitude(ratio, friction - 1e-9)) and np.isnan(den_hartog_amplitude(ratio, friction + 1e-9))
    kinds = [{e.kind for e in plain(oscillator(friction + d, omega=ratio), periods=12, samples=4).events[-8:]} for d in (-0.01, 0.01)]
    assert kinds == [{"reversal"}, {"stick", "slip"}]


def test_free_decay_loses_two_friction_lengths_in_each_half_swing():
    """O2: F/k = 1 from x = 10.3."""
    run = plain(oscillator(1.0, force=0.0, omega=1.0), duration=30.0, start={"x": 10.3})
    assert turning_points(run) == pytest.approx([-8.3, 6.3, -4.3, 2.3, -0.3], abs=2e-12)
    assert [e.t for e in run.events] == pytest.approx(np.pi * np.arange(1, 6), abs=1e-11)
    assert run.events[-1].kind == "stick" and run.v[-1] == 0.0 and run.x[-1] == turning_points(run)[-1]


@pytest.mark.parametrize("numbers", [{}, {"mass": 0.3, "stiffness": 40.0, "speed": 0.02}, {"speed": -0.1}])
def test_the_block_on_the_belt_sticks_and_slips_as_long_as_it_should(numbers):
    """O3 for the first: the cycle lasts 7.6112592541013 s. Damping there is none, so the first cycle is the last."""
    bench = belt.replace(**numbers)
    stick, slip = belt_period(bench.mass, bench.stiffness, abs(bench.speed), 1.0, 1.5)
    run = plain(bench, duration=5 * float(stick + slip))
    slips, sticks = ([e.t for e in run.events if e.kind == kind] for kind in ("slip", "stick"))
    assert np.diff(slips) == pytest.approx(stick + slip, rel=1e-10)
    assert [next(t for t in sticks if t > begin) - begin for begin in slips[:3]] == pytest.approx([float(slip)] * 3, rel=1e-10)
    if not numbers:
        assert np.diff(slips) == pytest.approx(7.6112592541013, rel=1e-10)


def test_stuck_on_a_belt_means_to_ride_along():
    run = plain(belt, duration=20.0)
    stuck = run.mode == 0
    assert stuck.any() and np.all(run.v[stuck] == 0.1) and np.all(run.acceleration[stuck] == 0.0)
    assert run.friction_force[stuck] == pytest.approx(-2.0 * run.x[stuck], abs=1e-12)  # it holds against the spring


def test_a_pulled_mass_is_a_block_on_a_belt_seen_from_the_pulled_end():
    """With y = x - u t the belt runs at -u, and a mass at rest rides along."""
    pulled, seen = plain(pull, duration=25.0), plain(belt.replace(speed=-0.1), duration=25.0, start={"v": -0.1})
    t = np.linspace(0.0, 25.0, 301)
    assert pulled.at(t)["x"] - 0.1 * t == pytest.approx(seen.at(t)["x"], abs=1e-9)
    assert [e.t for e in pulled.events] == pytest.approx([e.t for e in seen.events], abs=1e-9)


def test_a_pulled_lugre_mass_sticks_and_slips():
    """L2: period 6.36271982 s, peak velocity .369816 m/s (one method in the table, another one here)."""
    run = ss.solve(pull.replace(friction=LUGRE_1995), duration=22.0, method="radau", rtol=1e-9)
    above = np.flatnonzero((run.v[1:] > 0.05) & (run.v[:-1] <= 0.05))
    rises = [brentq(lambda t: float(run.at(t)["v"]) - 0.05, run.t[i], run.t[i + 1], xtol=1e-12) for i in above]
    top = int(np.argmax(run.v))
    peak = minimize_scalar(lambda t: -float(run.at(t)["v"]), bounds=(run.t[top - 1], run.t[top + 1]), method="bounded")
    assert np.diff(rises)[1:] == pytest.approx(6.36271982, rel=1e-6)
    assert -peak.fun == pytest.approx(0.369816, abs=1e-6)


def test_lugre_drifts_below_break_away():
    """L3: u = .4 + .2 sin(2 pi t) never reaches Fs = 1.5, and yet the mass creeps."""
    pushed = ss.ForcedOscillator(mass=1.0, stiffness=0.0, damping=0.0, force=0.2, omega=2 * np.pi, bias=0.4, friction=LUGRE_1995)
    run = ss.solve(pushed, periods=10, method="radau", rtol=1e-8, samples=4)
    assert (run.strobe_x[10] - run.strobe_x[5]) / 5 == pytest.approx(2.347e-6, rel=0.01)
    still = plain(pushed.replace(friction=STATIC), periods=3)
    assert not still.v.any() and still.events == []


def test_elasto_plastic_friction_does_not_drift_below_break_away():
    """L3, Dupont et al. 2002: within the elastic range z_ba = .7 Fc/sigma0 the mass comes back, here to 1e-12 m per period."""
    law = ss.friction.ElastoPlastic(1.0, 1.0, 1.5, 1.5, sigma0=1e5, sigma1=math.sqrt(1e5), sigma2=0.4, v_s=1e-3, z_ba=0.7e-5)
    pushed = oscillator(law, stiffness=0.0, force=0.2, omega=2 * np.pi, bias=0.4)
    run = ss.solve(pushed, periods=9, method="lsoda", rtol=1e-10, samples=4)
    assert abs(run.strobe_x[9] - run.strobe_x[7]) / 2 < 1e-12


# physics ----------------------------------------------------------------------------------------------------------


FORCED = oscillator(0.3, damping=0.1, bias=0.1, force=2.5)
BRISTLES = ss.LuGre(0.8, 1.2, 1.1, 1.5, 1e4, 100.0, 0.4, 0.01)


@each_row(
    "bench, law",
    [
        (belt.replace(damping=0.2), UNEVEN), (pull.replace(damping=0.2), UNEVEN), (FORCED, UNEVEN), (oscillator(0.3, force=0.0), UNEVEN),
        (oscillator(0.3, stiffness=0.0, force=2.5), UNEVEN), (belt.replace(damping=0.2), BRISTLES), (FORCED, BRISTLES),
    ],
    ids=["belt", "pull", "forced", "free", "pushed", "belt, LuGre", "forced, LuGre"],
)  # fmt: skip
def test_energy_balances(bench, law):
    """Power in = rise of kinetic and spring energy + friction + damping. Gauss nodes on cubic pieces leave 1e-7 at rtol 1e-8."""
    run = ss.solve(bench.replace(friction=law), duration=6.0, start={"x": 2.5, "v": 0.1}, method="radau", rtol=1e-8)
    balance = ss.energy(run)
    paid = balance.friction + balance.damping
    assert paid[0] > 0 and abs(balance.residual).max() < 1e-6
    assert balance.actuator.tolist() == balance.gravity.tolist() == [0.0] * len(paid)


@pytest.mark.parametrize("bench", [belt, pull])
def test_the_mirror_image_moves_the_other_way(bench):
    image = bench.replace(speed=-bench.speed, friction=ss.Coulomb(1.2, 0.8, f_plus=1.5, f_minus=1.1))
    run, turned = plain(bench.replace(friction=UNEVEN), duration=20.0), plain(image, duration=20.0)
    assert run.x == pytest.approx(-turned.x, abs=1e-12) and len(run.events) == len(turned.events) > 2
    assert [(e.kind, e.after) for e in run.events] == [(e.kind, -e.after) for e in turned.events]


# durations --------------------------------------------------------------------------------------------------------


def test_a_run_without_period_has_ten_times_its_samples():
    run = plain(pull, duration=20.0, samples=100)
    assert 1001 <= len(run.t) <= 1001 + len(run.events) and np.isin([e.t for e in run.events], run.t).all()
    assert run.window == (0.0, 20.0) and run.t[-1] == 20.0 and run.status == "finished"
    assert ss.mean_velocity(run) == pytest.approx(run.x[-1] / 20.0, rel=1e-14)
    assert "20 s by dop853" in repr(run)


def test_what_a_run_without_period_or_drive_does_not_have_says_so():
    run = plain(pull, duration=2.0)
    for name in ("period_time", "strobe_times", "strobe_v"):
        with pytest.raises(ss.InputError, match=r"PulledMass has no period.*run\.at"):
            getattr(run, name)
    with pytest.raises(AttributeError, match="no xi: PulledMass has no drive"):
        run.xi  # noqa: B018
    assert set(run.to_xarray().data_vars) == {"x", "v", "mode", "acceleration", "friction_force"}


@each_row("method", ["exact", "dop853"])
def test_a_duration_cuts_a_periodic_run(method):
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb")
    end = 3.4 * robot.period
    cut, whole = (ss.solve(robot, method=method, rtol=1e-10, **given) for given in ({"duration": end}, {"periods": 4}))
    assert cut.periods == 4 and cut.t[-1] == cut.pieces.t[-1] == end
    assert len(cut.strobe_times) == 4 and cut.provenance["settings"]["duration"] == end
    t = np.linspace(0.0, end, 500)
    assert cut.at(t)["x"] == pytest.approx(whole.at(t)["x"], abs=1e-13) and cut.at(t)["v"] == pytest.approx(whole.at(t)["v"], abs=1e-11)
    assert len(ss.energy(cut).drive) == 4 and abs(ss.energy(cut).residual).max() < 1e-8


@each_row(
    ("model", "arguments", "message"),
    [
        (pull, {}, r"PulledMass has no period.*type duration=60"),
        (pull, {"periods": 5}, r"PulledMass has no period.*type duration=60"),
        (pull, {"duration": 5.0, "settle": 3}, r"settle = 3 counts periods"),
        (pull, {"duration": -1.0}, r"duration = -1.0; allowed is a positive time"),
        (oscillator(0.3), {"duration": 5.0, "periods": 5}, r"periods = 5 and duration = 5.0 are both given"),
        (oscillator(0.3, omega=np.array([0.5, 0.7])), {"duration": 5.0}, r"duration is for one ForcedOscillator.*shape \(2,\)"),
    ],
)
def test_a_wrong_length_of_a_run_is_explained(model, arguments, message):
    with pytest.raises(ss.InputError, match=message):
        ss.solve(model, method="dop853", **arguments)


# records ----------------------------------------------------------------------------------------------------------


def test_arrays_make_a_batch():
    speeds = np.array([0.05, 0.1, 0.2])
    many = ss.solve(pull.replace(speed=speeds), duration=40.0, method="dop853", rtol=1e-8)
    one = plain(pull.replace(speed=0.1), duration=40.0)
    assert many.shape == (3,) and many.status.tolist() == [0, 0, 0]
    assert many.mean_velocity[1] == pytest.approx(ss.mean_velocity(one), rel=1e-6)
    assert np.all(np.diff(many.mean_velocity) > 0) and np.all(many.stick_fraction > 0.1)


@each_row("bench", [belt, pull.replace(damping=0.25), oscillator(0.3, bias=1 / 3)])
def test_a_mechanism_survives_its_text(bench):
    assert type(bench).from_toml(bench.to_toml()) == bench
    assert f'kind = "{bench.kind}"' in bench.to_toml() and type(bench).__name__ in bench._repr_html_()


@each_row("bench", [belt, pull.replace(friction=LUGRE_1995), oscillator(0.3)])
def test_a_run_comes_back_from_its_file(bench, tmp_path):
    run = ss.solve(bench, duration=9.0, method="radau", rtol=1e-5)
    same = ss.load(run.save(tmp_path / "run.nc"))
    assert same.model == bench and same.events == run.events and same.pieces.layout == run.pieces.layout and "x" in run.pieces.layout.names
    for name in ("t", "x", "v", "mode", "acceleration", "friction_force"):
        assert np.array_equal(getattr(same, name), getattr(run, name))


def test_wrong_numbers_are_reported_together():
    with pytest.raises(ss.InputError) as caught:
        ss.PulledMass(mass=-1.0, stiffness=0.0, speed=0.0, friction=ss.Coulomb, load=-1.0)
    told = "\n".join(caught.value.problems)
    assert all(name in told for name in ("mass = -1.0", "stiffness = 0.0", "speed = 0.0", "load = -1.0", "friction = "))
    with pytest.raises(ss.InputError, match=r'mechanism.kind = "?\'?pulled_mass.*BlockOnBelt reads kind = "block_on_belt"'):
        ss.BlockOnBelt.from_toml(pull.to_toml())
    with pytest.raises(ss.InputError, match=r"no \[mechanism\] table; begin with the line \[mechanism\] and then mass = 1"):
        ss.PulledMass.from_toml("[robot]")


@dataclass(frozen=True)
class Own:
    """A mechanism of a user's own, whose load is a function: a mass that is pressed on harder and harder."""

    friction: object
    mass: float = 2.0
    velocity_scale = 1.0
    cyclic = True
    period = None

    @property
    def total_mass(self):
        return self.mass

    def contact_velocity(self, v):
        return v

    def load(self, t, x):
        return 1.0 + t

    def acceleration(self, t, x, v, R):
        return -R / self.mass


def test_a_mechanism_of_ones_own_runs():
    """v' = -mu (1 + t)/m from v = 1: it stops where t + t^2/2 = m/mu."""
    run = plain(Own(ss.Coulomb(0.5, 0.5)), duration=5.0, start={"v": 1.0})
    assert [(e.kind, e.after) for e in run.events] == [("stick", 0)]
    assert run.events[0].t == pytest.approx(2.0, rel=1e-13)
    assert run.x[-1] == pytest.approx(2 - 0.25 * (4 / 2 + 8 / 6), rel=1e-13)
