"""The judges beside our solvers: fixed-step Runge-Kutta, and scipy's integrators on the same law object."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest

import kinds
import stickslip as ss
from rows import each_row
from stickslip.solvers import METHODS, solve

P1 = {"tilt_deg": 1.7, "amplitude": 5.525e-4}
scipy_methods = pytest.mark.parametrize("method", ["radau", "lsoda", "bdf", "dop853"])


@dataclass(frozen=True)
class Viscous:
    """A set-valued law without dry friction: smooth everywhere, and solvable by hand."""

    c: float

    def sliding(self, v, load):
        return self.c * v

    def breakaway(self, load):
        return 0.0 * load, 0.0 * load


@dataclass(frozen=True)
class TwoSprings:
    """A dynamic law with two inner states: Maxwell elements side by side."""

    k: float
    rest: float
    states = 2

    def rate(self, v, z, load):
        return v - self.rest * z[0], v - 3 * self.rest * z[1]

    def force(self, v, z, zdot, load):
        return self.k * (z[0] + 2 * z[1])


@pytest.fixture(scope="module")
def viscous():
    return ss.Robot(body_mass=0.06, inner_mass=0.01, drive=ss.Harmonic(amplitude=5e-4, omega=200.0), friction=Viscous(3.0))


def viscous_velocity(robot, t):
    """v' = a sin(omega t) - k v from rest: the textbook's answer."""
    k, omega = robot.friction.c / robot.total_mass, robot.drive.omega
    a = robot.mass_ratio * robot.drive.amplitude * omega**2
    return a * (k * np.sin(omega * t) - omega * np.cos(omega * t) + omega * np.exp(-k * t)) / (k**2 + omega**2)


def end_of(run):
    return np.array([float(run.strobe_v[-1]), float(run.strobe_x[-1])])


# fixed steps ------------------------------------------------------------------------------------------------------


def test_rk4_has_order_four_where_all_is_smooth(viscous):
    t = 3 * viscous.period
    errors = [abs(solve(viscous, periods=3, method="rk4", steps=n).strobe_v[-1] - viscous_velocity(viscous, t)) for n in (40, 80, 160)]
    orders = [math.log2(a / b) for a, b in pairwise(errors)]
    assert orders == pytest.approx([4.0, 4.0], abs=0.1)


def test_rk4_is_of_first_order_where_the_body_should_stick():
    """The naive sign(v) chatters: its error falls with its step and no faster, and it never finds the type."""
    robot = ss.presets.piezo_rig(**P1, law="coulomb")
    exact = ss.mean_velocity(solve(robot, periods=20))
    runs = [solve(robot, periods=20, method="rk4", steps=n) for n in (1000, 16000)]
    errors = [abs(ss.mean_velocity(run) - exact) / exact for run in runs]
    assert 1e-5 < errors[1] < errors[0] < 5e-3
    assert ss.motion(solve(robot, periods=20)).type == "I" != ss.motion(runs[0]).type


def test_rk4_keeps_a_body_at_rest_that_nothing_moves():
    robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=1e-4, law="coulomb")
    run = solve(robot, periods=3, method="rk4", steps=200)
    assert not run.v.any() and not run.x.any() and run.events == []


def test_rk4_agrees_with_our_solver_where_its_steps_are_fine_enough():
    robot = ss.presets.piezo_rig(**P1)
    run, ours = solve(robot, periods=20, method="rk4", steps=20_000), solve(robot, periods=20, rtol=1e-10)
    assert ss.mean_velocity(run) == pytest.approx(ss.mean_velocity(ours), rel=1e-7)  # 1e-9 at 50 000, order 1 to 2 at the kink
    assert ss.motion(run).type == ss.motion(ours).type
    assert ss.energy(run).worst < 1e-7
    v, scale = run.at(np.linspace(0.0, 0.6, 1001))["v"], robot.velocity_scale
    assert abs(v - ours.at(np.linspace(0.0, 0.6, 1001))["v"]).max() < 1e-6 * scale  # Hermite pieces between 1000 nodes per period


def test_rk4_says_the_wrong_direction_on_the_stiffest_robot():
    """TRUTH 1, Fig. 22: at mu0 = 0.03 fixed steps send the robot backwards, even fifty thousand in each period."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, mu0=0.03)
    assert ss.mean_velocity(solve(robot, periods=100)) == pytest.approx(0.012385126, rel=1e-4)
    for steps in (2000, 10_000, 50_000):
        assert float(solve(robot, periods=60, method="rk4", steps=steps, keep="summary").mean_velocity) < -0.005


def test_rk4_summaries_are_those_of_the_runs():
    batch = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=np.array([4e-4, 6e-4]))
    many, threads = (solve(batch, periods=30, method="rk4", steps=4000, workers=n) for n in (1, 2))
    ours = solve(batch, periods=30)
    one = solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4), periods=30, method="rk4", steps=4000)
    assert many.mean_velocity[1] == pytest.approx(ss.mean_velocity(one), rel=1e-12)
    assert np.array_equal(many.mean_velocity, threads.mean_velocity)
    assert many.motion_type.tolist() == ours.motion_type.tolist() and many.period.tolist() == [1, 1]
    assert many.velocity_max == pytest.approx(ours.velocity_max, rel=1e-4)
    assert many.stick_fraction == pytest.approx(ours.stick_fraction, abs=2e-3)
    auto = solve(batch, periods=200, settle="auto", method="rk4", steps=4000)
    assert (auto.periods_run < 50).all() and auto.mean_velocity == pytest.approx(ours.mean_velocity, rel=1e-5)


# Every method, every law, every drive and every track at least once; compiled where the pair is cheap to compile.
COVERING = [
    ("exact", "coulomb", "harmonic", "downhill"),
    ("exact", "stribeck", "verticalvibration", "level"),
    ("dop853", "viscous", "bangbang", "varying"),
    ("dop853", "coulombviscous", "verticalvibration", "uphill"),
    ("dop853", "tabulated", "trapezoid", "varying"),
    ("dop853", "tanhcoulomb", "reversed", "varying"),
    ("dop853", "coulomb", "pieces", "uphill"),
    ("dop853", "coulomb", "sawtooth", "level"),
    ("dop853", "deadband", "twophase", "level"),
    ("dop853", "karnopp", "recorded", "level"),
    ("dop853", "sum", "threephase", "downhill"),
    ("dop853", "bristle", "harmonic", "level"),
    ("rodas4", "lugre", "verticalvibration", "level"),
    ("taylor", "lugre", "harmonic", "downhill"),
    ("rodas5p", "dahl", "harmonic", "varying"),
    ("radau", "dahl", "verticalvibration", "level"),
    ("lsoda", "lugre", "multiharmonic", "varying"),
    ("lsoda", "gms", "harmonic", "level"),
    ("bdf", "lugre + viscous", "verticalvibration", "uphill"),
    ("lsoda", "elastoplastic", "reversed", "varying"),
    ("radau", "resetintegrator", "threephase", "level"),
    ("rodas5p", "ratestate", "harmonic", "level"),
    ("rk4", "lugre", "verticalvibration", "level"),
    ("rk4", "lugre", "harmonic", "varying"),
    ("rk4", "dahl", "harmonic", "varying"),
]


@pytest.mark.parametrize(("method", "law", "drive", "track"), COVERING)
def test_a_summary_tells_the_motion_of_its_trajectory(method, law, drive, track):
    """The load that decides what slips is that of the instant, also where it varies."""
    model, options = kinds.robot(law, drive, track), {"steps": 2000} if method == "rk4" else {}
    many = solve(model, periods=3, method=method, keep="summary", **options)
    one = ss.motion(solve(model, periods=3, method=method, **options))
    assert str(many.motion_type) == one.type
    # a summary looks at 5000 instants (rk4: 2000 steps) in a period, or at the ends of steps: a few borders, each off by one of these
    told = [float(getattr(many, f"{name}_fraction")) for name in ("stick", "forward", "backward")]
    assert told == pytest.approx([one.stick_fraction, one.forward_fraction, one.backward_fraction], abs=2e-3)


def test_the_covering_set_covers():
    for column, known in enumerate((METHODS[1:], kinds.LAWS, kinds.DRIVES, kinds.TRACKS)):
        assert {row[column] for row in COVERING} == set(known)


@each_row("method", ["rk4", "rodas4", "rodas5p"])
def test_a_law_for_plain_numbers_only_is_not_compiled(method):
    with pytest.raises(ss.InputError, match=rf"'{method}' does not solve this Robot; .*it is compiled, and Bristle is written for plain"):
        solve(kinds.robot("bristle", "harmonic"), periods=2, method=method)


def test_rk4_that_explodes_says_so(viscous):
    stiff = viscous.replace({"friction.c": 1e6})
    with pytest.raises(ss.SolveError, match=r"period \d+ of 50.*steps=10"):
        solve(stiff, periods=50, method="rk4", steps=10)
    assert solve(stiff, periods=50, method="rk4", steps=10, keep="summary").status_counts == {"not a number": 1}


# scipy ------------------------------------------------------------------------------------------------------------


@scipy_methods
def test_scipy_agrees_with_the_textbook(method, viscous):
    run = solve(viscous, periods=2, method=method, rtol=1e-9)
    assert abs(run.v - viscous_velocity(viscous, run.t)).max() < 1e-6 * viscous.velocity_scale  # its dense output, cubic for Radau
    assert run.strobe_v[-1] == pytest.approx(viscous_velocity(viscous, run.t[-1]), rel=1e-6)


@scipy_methods
def test_scipy_with_restarts_agrees_with_exact_arcs(method):
    """rtol is that of one step: a hundred and more of them, and four restarts, in each period."""
    robot = ss.presets.piezo_rig(**P1, law="coulomb")
    exact, run = solve(robot, periods=4), solve(robot, periods=4, method=method, rtol=1e-8)
    assert ss.mean_velocity(run) == pytest.approx(ss.mean_velocity(exact), rel=1e-6)
    assert [(e.kind, e.after) for e in run.events] == [(e.kind, e.after) for e in exact.events]
    assert [e.t for e in run.events] == pytest.approx([e.t for e in exact.events], abs=1e-7 * robot.period)


def test_scipy_knows_a_higher_break_away():
    """T11, kinetic (.5, 1.2) and static (.8, 1.4)."""
    law = ss.Coulomb(mu_plus=0.5, mu_minus=1.2, f_plus=0.8, f_minus=1.4)
    robot = ss.Robot(body_mass=1.0, inner_mass=1.0, drive=ss.Harmonic(amplitude=2.0, omega=1.0), friction=law, gravity=1.0)
    run = solve(robot, periods=4, method="dop853", rtol=1e-10)
    assert ss.mean_velocity(run) == pytest.approx(0.170822286993, rel=1e-9)
    assert ss.motion(run).pattern == "+0"


def test_scipy_agrees_with_our_steps_for_lugre():
    robot = ss.presets.piezo_rig(**P1)
    ours = solve(robot, periods=2, settle=1, rtol=1e-10)
    for method, tolerance in (("radau", 1e-9), ("lsoda", 1e-6), ("bdf", 1e-6), ("dop853", 1e-7)):
        run = solve(robot, periods=2, settle=1, method=method, rtol=1e-8)
        assert ss.mean_velocity(run) == pytest.approx(ss.mean_velocity(ours), rel=tolerance), method
        assert ss.motion(run).type == ss.motion(ours).type
        assert len(run.events) == len(ours.events)


def test_scipy_takes_a_law_with_two_states():
    robot = ss.Robot(body_mass=0.06, inner_mass=0.01, drive=ss.Harmonic(amplitude=5e-4, omega=200.0), friction=TwoSprings(400.0, 50.0))
    run, steps = solve(robot, periods=3, method="lsoda", rtol=1e-9), solve(robot, periods=3, method="rk4", steps=1000)
    assert run.z.shape[1] == 2
    assert end_of(run) == pytest.approx(end_of(steps), rel=1e-6)
    assert run.strobe_z[-1] == pytest.approx(steps.strobe_z[-1], rel=1e-6)


def test_scipy_summaries_are_those_of_the_exact_solver():
    batch = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=np.array([4e-4, 8e-4]), law="coulomb")
    many, exact = solve(batch, periods=6, method="dop853", rtol=1e-8), solve(batch, periods=6)
    assert many.mean_velocity == pytest.approx(exact.mean_velocity, rel=1e-6)
    assert many.motion_type.tolist() == exact.motion_type.tolist()
    assert many.stick_fraction == pytest.approx(exact.stick_fraction, abs=1e-3)


def test_judges_start_where_they_are_told():
    robot = ss.presets.piezo_rig(**P1, law="coulomb")
    start = {"x": 0.1, "v": -0.02}
    exact = solve(robot, periods=2, start=start)
    for method, tolerance in (("dop853", 1e-9), ("rk4", 0.05)):  # of a small difference; sign(v) is of first order
        run = solve(robot, periods=2, start=start, method=method, rtol=1e-9)
        assert run.strobe_x[0] == 0.1 and run.strobe_v[0] == -0.02
        assert run.strobe_x[-1] - 0.1 == pytest.approx(exact.strobe_x[-1] - 0.1, rel=tolerance)


@each_row(("steps", "shown"), [(0, "0"), (2.5, "2.5"), ("many", "'many'")])
def test_steps_must_be_a_whole_number(steps, shown):
    with pytest.raises(ss.InputError, match=rf"steps = {shown}; allowed is a whole number"):
        solve(ss.presets.piezo_rig(**P1), method="rk4", steps=steps)
