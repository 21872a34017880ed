"""Curves of grazings, of borders of rest and of events of one's own in two parameters, with closed answers and answers from elsewhere."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from every import DEN_HARTOG
from stickslip.maths import cos, pi

RIG = {"tilt_deg": 1.7, "law": "coulomb"}


def wall():
    """x'' + 0.2 x' + x = cos(w t) beside a wall at -gap, that throws back 0.8 of the speed."""
    hit = ss.Switch(lambda t, y, n: y[0] + n.gap, 0, lambda t, y, n: (-n.gap, -0.8 * y[1]))
    swing = {0: lambda t, y, n: (y[1], -y[0] - 0.2 * y[1] + cos(n.omega * t))}
    return ss.SwitchingFlow(swing, {0: (hit,)}, lambda n: 2 * pi / n.omega, {"omega": 2.0, "gap": 0.1}, ("x", "v"))


def swing(omega, damping=0.2):
    """How far it swings without a wall."""
    return 1.0 / np.sqrt((1.0 - omega**2) ** 2 + (damping * omega) ** 2)


def stopping(r):
    """Den Hartog 1930: the friction, over the force, beyond which a forced mass on a spring stops twice in a period."""
    steady, turning = 1 / (1 - r**2), np.sin(pi / r) / (r * (1 + np.cos(pi / r)))
    return steady / np.sqrt(1 / r**4 + turning**2)


def first(branch, *kinds):
    return next(s for s in branch.special if s.kind in kinds)


def agrees(curve, expected, wanted):
    """The first parameter is that of a closed form of the second, within the accuracy that is told, which is small."""
    p, q = curve.values.T
    assert np.all(abs(p - expected(q)) <= curve.accuracy[:, 0] + 1e-12) and curve.accuracy.max() < wanted
    assert curve.ended == "it reached the end of the range" and len(curve.orbits) == len(p)


def test_the_grazing_of_a_wall_is_where_the_free_swing_reaches_it():
    branch = ss.continuation(wall(), parameter="gap", start=0.35, stop=0.325)
    grazing = first(branch, "grazing")
    curve = ss.dynamics.special_curve(branch, grazing, "omega", stop=2.15, step=0.4)
    agrees(curve, swing, 1e-9)
    assert curve.values[0, 1] == 2.0 and abs(curve.values[0, 0] - grazing.value) <= grazing.accuracy + curve.accuracy[0, 0]
    assert all(len(orbit.events) == 0 for orbit in curve.orbits), "its motions are those that just miss the wall"


@pytest.mark.parametrize("way", ["machine", "flow"])
def test_the_sliding_border_of_a_spring_oscillator_is_den_hartogs(way):
    if way == "machine":
        make, other = lambda F, omega=0.7: ss.ForcedOscillator(1.0, 1.0, 1.0, omega, ss.Coulomb(F, F)), "omega"
    else:
        make, other = DEN_HARTOG, "r"
    border = float(stopping(0.7))
    branch = ss.continuation(make, parameter="F", start=border - 0.01, stop=border + 0.01, guess={"x": 0.9, "v": 0.8}, step=0.2)
    agrees(ss.dynamics.special_curve(branch, first(branch, "type-border", "grazing"), other, stop=0.72, step=0.3), stopping, 1e-8)


def test_a_robot_begins_to_move_where_the_force_of_its_drive_reaches_the_friction():
    branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=2.5e-4, stop=2.8e-4, step=0.2, **RIG)
    curve = ss.dynamics.special_curve(branch, first(branch, "grazing"), "mu0", stop=0.2, step=0.2)
    robots = [ss.presets.piezo_rig(amplitude=a, mu0=m, **RIG) for a, m in curve.values]
    limits = [r.friction.mu_plus * (r.body_mass + r.inner_mass) * r.gravity for r in robots]
    np.testing.assert_allclose(limits, [r.inner_mass * r.drive.amplitude * r.drive.omega**2 for r in robots], rtol=1e-11)
    assert all(orbit.type == "rest" for orbit in curve.orbits)


def on_a_branch(value, other, **changed):
    """The grazing of a branch at another value of the second parameter."""
    ways = {"parameter": "amplitude", "start": value - 2e-6, "stop": value + 2e-6, "step": 0.5, "tilt_deg": 1.7}
    return first(ss.continuation(ss.presets.piezo_rig, **(ways | changed | other)), "grazing")


@pytest.mark.parametrize(("parameter", "stop"), [("tilt_deg", 1.75), ("mu0", 0.182)])
def test_a_grazing_under_lugre_is_that_of_a_branch_at_another_value(parameter, stop):
    branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=4.16e-4, stop=4.22e-4, tilt_deg=1.7, step=0.5)
    curve = ss.dynamics.special_curve(branch, first(branch, "grazing"), parameter, stop=stop, step=0.5)
    value, other = map(float, curve.values[-1])
    there = on_a_branch(value, {parameter: other})
    assert abs(there.value - value) <= there.accuracy + curve.accuracy[-1, 0] and curve.accuracy[:, 0].max() < 1e-10 and other >= stop
    for orbit in curve.orbits:  # an extreme of the velocity is zero
        v = orbit.run.at(np.linspace(0.0, orbit.run.t[-1], 4001))["v"]
        turns = v[1:-1][(np.diff(v)[:-1] * np.diff(v)[1:]) < 0]
        assert abs(turns).min() < 1e-5 * abs(v).max()


@pytest.mark.slow
def test_a_grazing_under_dahls_law_is_that_of_a_branch_at_another_frequency():
    bench = lambda F, omega=0.3: ss.ForcedOscillator(1.0, 1.0, 1.0, omega, ss.Dahl(F, F, sigma0=30.0), damping=0.05)  # noqa: E731
    branch = ss.continuation(bench, parameter="F", start=0.077, stop=0.081, step=0.5)
    curve = ss.dynamics.special_curve(branch, first(branch, "grazing"), "omega", stop=0.302, step=0.5)
    F, omega = map(float, curve.values[-1])
    there = first(ss.continuation(bench, parameter="F", start=F - 5e-4, stop=F + 5e-4, step=0.5, omega=omega), "grazing")
    assert abs(there.value - F) <= there.accuracy + curve.accuracy[-1, 0] and curve.accuracy[:, 0].max() < 1e-8


@pytest.mark.slow
def test_a_capsule_grazes_its_stop_where_the_inner_mass_swings_so_far():
    capsule = lambda gap, omega=0.6: ss.presets.capsule(force_ratio=1.0, omega=omega, mass_ratio=4.0, gap=gap, reaction=True)  # noqa: E731
    begin = float(swing(0.6, 0.1)) + 0.05
    guess = ss.periodic_orbit(capsule(begin)).state
    branch = ss.continuation(capsule, parameter="gap", start=begin, stop=begin - 0.1, guess=guess)
    agrees(ss.dynamics.special_curve(branch, first(branch, "grazing"), "omega", stop=0.65), lambda omega: swing(omega, 0.1), 1e-9)


@pytest.mark.slow
def test_the_rest_of_a_limit_cycle_vanishes_where_a_branch_beside_it_says():
    law = ss.Stribeck(1.0, 1.0, f_plus=1.5, f_minus=1.5, v_s=0.5)
    belt = lambda speed, damping=0.1: ss.BlockOnBelt(mass=1.0, stiffness=1.0, speed=speed, damping=damping, friction=law)  # noqa: E731
    branch = ss.continuation(belt, parameter="speed", start=0.3, stop=2.0)
    curve = ss.dynamics.special_curve(branch, first(branch, "type-border"), "damping", stop=0.12, step=0.1)
    speed, damping = map(float, curve.values[-1])
    there = first(ss.continuation(belt, parameter="speed", start=0.3, stop=2.0, damping=damping), "type-border")
    assert abs(there.value - speed) <= there.accuracy + curve.accuracy[-1, 0] and curve.accuracy[:, 0].max() < 1e-7


def test_what_has_no_sharp_border_is_refused_with_what_has():
    branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=5.6e-4, stop=5.7e-4, tilt_deg=1.7, step=0.5)
    with pytest.raises(ss.InputError, match=r"type-border under LuGre, where types depend on thresholds; allowed are fold, flip.*grazing"):
        ss.dynamics.special_curve(branch, first(branch, "type-border"), "mu0", stop=0.19)


# events of one's own ------------------------------------------------------------------------------------------------


def far(orbit):
    """By how much it swings farther than 0.3."""
    return orbit.run.highest[0] - 0.3


def test_an_event_of_ones_own_is_located_and_followed_where_its_closed_form_says():
    branch = ss.continuation(
        wall().replace(gap=9.0), parameter="omega", start=1.8, stop=2.3, events={"far": far, "never": lambda orbit: 1.0}
    )
    event = first(branch, "far")
    assert [s.kind for s in branch.special] == ["far"] and event.orbit.notes == ("far is zero here",)
    assert abs(swing(event.value) - 0.3) < 1e-12 and event.accuracy < 1e-10 and "far at 2.0" in repr(branch)


def test_an_event_is_followed_in_two_parameters_of_a_machine():
    """Den Hartog's amplitude without stops, X^2 = V^2 - F^2 U^2, is 1.9 along a curve of friction and frequency."""
    bench = lambda F, omega=0.7: ss.ForcedOscillator(1.0, 1.0, 1.0, omega, ss.Coulomb(F, F))  # noqa: E731
    peak = {"peak": lambda orbit: abs(float(orbit.run.at(orbit.run.events[0].t)["x"])) - 1.9}
    guess = {"x": 1.0, "v": 0.5}
    branch = ss.continuation(bench, parameter="F", start=0.2, stop=0.35, guess=guess, events=peak, step=0.2)

    def friction(r):
        return np.sqrt((1 / (1 - r**2)) ** 2 - 1.9**2) * r * (1 + np.cos(pi / r)) / abs(np.sin(pi / r))

    event = first(branch, "peak")
    assert abs(event.value - friction(0.7)) <= event.accuracy + 1e-13 and event.accuracy < 1e-11
    curve = ss.dynamics.special_curve(branch, event, "omega", stop=0.72, step=0.2)
    agrees(curve, friction, 1e-10)
    assert curve.kind == "peak" and "peak in (F, omega)" in repr(curve)


def test_a_curve_of_an_event_names_the_fold_that_it_meets():
    """A fixed point x of Henon's map has a = (1 - (1 - b) x)/x^2; it folds where x = 2/(1 - b), and x = 1.6 at b = -0.25."""
    henon = ss.SwitchingFlow.of_map(lambda y, n: (1 - n.a * y[0] ** 2 + y[1], n.b * y[0]), {"a": 0.1, "b": 0.3}, ("x", "y"))
    events = {"x": lambda orbit: orbit.state[0] - 1.6}
    branch = ss.continuation(henon, parameter="a", start=0.1, stop=-0.1, guess={"x": 1.2, "y": 0.4}, events=events)
    curve = ss.dynamics.special_curve(branch, first(branch, "x"), "b", stop=-0.5, step=0.1)
    agrees(curve, lambda b: (1 - (1 - b) * 1.6) / 1.6**2, 1e-10)
    (met,) = curve.special
    assert met.kind == "x-fold" and np.all(abs(np.array(met.values) - [-0.390625, -0.25]) <= met.accuracy) and max(met.accuracy) < 1e-8


def test_an_event_that_jumps_past_zero_says_so():
    events = {"walks": lambda orbit: 1.0 if orbit.type == "II" else -1.0}
    branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=3.6e-4, stop=3.8e-4, step=0.2, events=events, **RIG)
    event, border = first(branch, "walks"), first(branch, "type-border")
    assert event.orbit.notes == ("walks jumps past zero here",) and abs(event.value - border.value) <= event.accuracy + border.accuracy


def test_everything_wrong_with_events_is_said_at_once():
    follow = lambda events: ss.continuation(  # noqa: E731
        ss.presets.piezo_rig, parameter="amplitude", start=5e-4, stop=5.1e-4, events=events, **RIG
    )
    with pytest.raises(ss.InputError, match="allowed is a dict of functions"):
        follow([far])
    with pytest.raises(ss.InputError, match=r"(?s)2 problems.*'fold' is no name.*events\['V'\] = 3"):
        follow({"fold": far, "V": 3})
    with pytest.raises(ss.InputError, match=r"events\['V'\] raised AttributeError"):
        follow({"V": lambda orbit: orbit.no_such_thing})
