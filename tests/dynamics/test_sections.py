"""Machines without a period, looked at on a section: a belt against formulas and SciPy, a joint that hunts, two blocks on a belt."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import stickslip as ss
from problems import TwoBlocks, Weakening
from rows import each_row
from stickslip.dynamics.stroboscopic.chosen_sections import on_section
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, strobe_map, strobe_points

MU, F, V_S, DAMPING = 0.2, 0.4, 0.3, 0.1
COULOMB = ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5))
STRIBECK = ss.Stribeck(mu_plus=MU, mu_minus=MU, f_plus=F, f_minus=F, v_s=V_S)
#: Two motions attract: the block rides along and slides back, or rests in space while the belt slides below it.
BELT = ss.BlockOnBelt(mass=1.0, stiffness=1.0, speed=0.7, friction=STRIBECK, damping=DAMPING, load=1.0)
#: T = 2 (f - mu) N / (k v) + (2 pi - 2 atan((f - mu) N / (k v) omega)) / omega
DURATION = 5.0 + (2 * np.pi - 2 * np.arctan(2.5 * np.sqrt(2.0))) / np.sqrt(2.0)


# ---- the same belt by SciPy alone ----
def _slides(speed: float) -> Any:
    """The block while it is slower than the belt, which drags it forwards."""
    return lambda t, y: (y[1], MU + (F - MU) * np.exp(-(((y[1] - speed) / V_S) ** 2)) - y[0] - DAMPING * y[1])


def _turning(t: float, y: Any) -> float:
    return float(y[1])


_turning.direction = -1.0  # type: ignore[attr-defined]


def _swing(speed: float, x: float, v: float = 0.0) -> tuple[float, float, float]:
    """From one turning point to the next at the largest position: the position there, the time, and the largest velocity on the way."""
    run = solve_ivp(_slides(speed), (0.0, 15.0), (x, v), events=[_turning], rtol=1e-12, atol=1e-13, dense_output=True, max_step=0.2)
    k = int(np.flatnonzero(run.t_events[0] > 1e-3)[0])  # the start itself is one
    T = float(run.t_events[0][k])
    return float(run.y_events[0][k][0]), T, float(run.sol(np.linspace(0.0, T, 4000))[1].max())


def _steady(speed: float) -> float:
    """Where the block stands still while the belt slides below it."""
    return MU + (F - MU) * float(np.exp(-((speed / V_S) ** 2)))


def _sticks(speed: float, x: float, v: float) -> bool:
    """Whether the block comes to ride along with the belt, or its swings die out, by swings in which it is slower than the belt."""
    for _ in range(400):
        x, _, fastest = _swing(speed, x, v)
        if fastest >= speed or abs(x - _steady(speed)) < 0.05:
            return fastest >= speed
        v = 0.0
    raise AssertionError("neither within 400 swings")


@cache
def basins() -> Any:
    return ss.basins(BELT, x=np.linspace(-1.0, 2.0, 16), v=np.linspace(-1.0, 0.6, 9))


def test_returns_of_a_belt_are_those_of_the_formula():
    at = on_section(COULOMB)
    ends = strobe_map(COULOMB, [[0.0, 0.0], [0.9, 0.1], [-0.7, 0.0]], 6, at=at)
    once = strobe_map(COULOMB, ends.state, 1, at=at)
    np.testing.assert_allclose(once.duration, DURATION, rtol=1e-13)
    np.testing.assert_allclose(once.state, np.tile([0.5 + np.hypot(0.25, 0.1 / np.sqrt(2.0)), 0.0], (3, 1)), atol=1e-14)


def test_many_returns_in_one_run_are_those_one_after_the_other():
    at, starts = on_section(BELT), [[1.5, 0.0], [0.3, 0.2]]
    states, ways, times = strobe_points(BELT, starts, 5, 1e-12, at)
    ends = strobe_map(BELT, starts, 5, at=at)
    np.testing.assert_allclose(ends.state, states[-1], atol=1e-13)
    np.testing.assert_allclose(ends.duration, times.sum(axis=0), rtol=1e-13)
    np.testing.assert_allclose(ends.displacement, ways.sum(axis=0), atol=1e-13)


def test_basins_of_a_belt_are_those_of_scipy():
    found = basins()
    kinds = [a.kind for a in found.attractors]
    assert kinds == ["periodic", "steady"] and not found.others
    choice = np.random.default_rng(7).choice(found.map.attractor.size, 12, replace=False)
    for i, k in zip(*np.unravel_index(choice, found.map.attractor.shape), strict=True):
        x, v = float(found.map.x[i]), float(found.map.v[k])
        assert kinds[int(found.map.attractor[i, k])] == ("periodic" if _sticks(BELT.speed, x, v) else "steady"), (x, v)


def test_what_stands_still_is_a_rest_at_the_force_of_the_sliding_belt():
    (steady,) = [a for a in basins().attractors if a.kind == "steady"]
    np.testing.assert_allclose(steady.state, [_steady(BELT.speed), 0.0], atol=1e-5)
    assert steady.mean_velocity == 0.0 and steady.word == "steady"


def test_the_edge_between_them_is_the_unstable_cycle_of_scipy():
    edge = ss.dynamics.edge_state(BELT, dict(x=1.0), dict(x=0.2))
    x = brentq(lambda x: _swing(BELT.speed, x)[0] - x, 0.5, 0.9, xtol=1e-12)
    after, T, _ = _swing(BELT.speed, x + 1e-5)
    before = _swing(BELT.speed, x - 1e-5)[0]
    assert edge.kind == "repeller"
    assert edge.state[0] == pytest.approx(x, abs=1e-9) and edge.orbit.duration == pytest.approx(T, abs=1e-4)
    assert edge.multipliers[0] == pytest.approx((after - before) / 2e-5, rel=1e-5)


def test_stick_slip_ends_where_the_block_just_reaches_the_speed_of_the_belt():
    tracked = ss.attractors(BELT, parameter="speed", values=[0.8, 0.85, 0.9], starts=dict(x=[0.3, 1.5]))
    (ends,) = [
        re.fullmatch(r"vanishes between (\S+) and (\S+); its last state leads to attractor 0", each) for each in tracked.ends.values[1:]
    ]
    low, high = map(float, ends.groups())
    end = brentq(lambda speed: _swing(speed, _swing(speed, F - DAMPING * speed, 0.999999 * speed)[0])[2] - speed, 0.8, 0.95, xtol=1e-6)
    assert low < end < high
    assert tracked.motion.values.tolist() == [["steady"] * 3, ["periodic", "periodic", ""]]


def test_a_diagram_over_the_speed_has_the_duration_of_the_cycle():
    diagram = ss.bifurcation(COULOMB, parameter="speed", values=[0.05, 0.1], settle=20)
    assert diagram.motion.values.tolist() == [["periodic"] * 2] * 2
    np.testing.assert_allclose(diagram.duration.values[:, 1], DURATION, rtol=1e-12)


def test_one_exponent_is_zero_and_the_others_are_those_of_the_multipliers():
    joint = ss.Joint.example()
    found, cycle = ss.lyapunov(joint, periods=40, settle=80), ss.periodic_orbit(joint)
    assert abs(found.spectrum[0]) < 1e-6 and np.isneginf(found.spectrum[2])
    assert found.spectrum[1] == pytest.approx(np.log(cycle.multipliers[0]) / cycle.duration, abs=1e-6) and found.unit == "second"


def test_exponents_of_what_stands_still_are_those_of_its_oscillation():
    still = BELT.replace(speed=1.0)
    weakening = (F - MU) * 2 / V_S**2 * np.exp(-((1.0 / V_S) ** 2))
    found = ss.lyapunov(still, periods=20, settle=5, start=dict(x=_steady(1.0) + 1e-6))
    np.testing.assert_allclose(found.spectrum, -(DAMPING - weakening) / 2, rtol=1e-5)


def test_the_motion_of_a_run_is_that_of_its_cycle():
    m = ss.motion(ss.solve(COULOMB, duration=60))
    assert (m.type, m.period, m.pattern) == ("stick-slip", 1, "0-") and m.settled
    assert m.duration == pytest.approx(DURATION, rel=1e-9) and m.stick_fraction == pytest.approx(5.0 / DURATION, rel=1e-9)
    size = np.hypot(0.25, 0.1 / np.sqrt(2.0))
    assert m.amplitude == pytest.approx(size, rel=1e-9)
    assert m.velocity_ranges["body"] == pytest.approx((-size * np.sqrt(2.0), 0.1), rel=1e-9)
    assert m.mean_velocity == pytest.approx(0.0, abs=1e-12)


def test_a_run_that_has_not_settled_is_not_typed_and_one_that_stands_still_is_steady():
    slow = BELT.replace(speed=1.0)
    early, late = (ss.motion(ss.solve(slow, duration=T)) for T in (60, 1500))
    assert early.type == "not settled" and early.period is None and early.change > 1e-3
    assert late.type == "steady" and late.pattern == "-" and np.isnan(late.duration)


def test_a_run_without_a_whole_turn_has_no_mean_and_no_amplitude():
    cycle = ss.periodic_orbit(COULOMB)
    part, whole = ss.motion(ss.solve(COULOMB, start=cycle.start, duration=cycle.duration, keep="trajectory")), cycle.motion
    assert part.type == "not settled" and np.isnan([part.mean_velocity, part.amplitude, part.change]).all() and "nan m/s" not in str(part)
    assert whole.mean_velocity == pytest.approx(0.0, abs=1e-12) and whole.stick_fraction == pytest.approx(5.0 / DURATION, rel=1e-9)
    assert str(ss.motion(cycle.run)) == str(whole) and whole.change < 1e-11  # the run of an orbit is known to come back


def test_what_only_driven_motions_have_is_said():
    with pytest.raises(AttributeError, match="the motion of a machine without a period has no margin; it has type, period, duration"):
        _ = ss.motion(ss.solve(COULOMB, duration=60)).margin


def test_a_pulled_mass_makes_its_way_with_the_pull():
    pulled = ss.PulledMass(mass=1.0, stiffness=2.0, speed=0.1, friction=COULOMB.friction)
    (only,) = ss.basins(pulled, x=[0.0, 0.3], v=[0.0], settle=30).attractors
    assert only.mean_velocity == pytest.approx(0.1, abs=1e-12) and only.orbit.duration == pytest.approx(DURATION, rel=1e-9)


def test_mean_velocities_of_cycles_are_those_of_the_pull():
    pulled = ss.PulledMass(mass=1.0, stiffness=2.0, speed=[0.1, 0.2], friction=COULOMB.friction)
    assert ss.analysis.periodic_mean_velocity(pulled) == pytest.approx([0.1, 0.2], abs=1e-12)
    assert ss.analysis.periodic_mean_velocity(COULOMB) == pytest.approx(0.0, abs=1e-12)


def test_a_verdict_and_an_atlas_tell_stick_slip_from_steady_sliding():
    kinds = [ss.verdict(BELT.replace(speed=speed), periods=20, settle=60, start=dict(x=1.5)).kind for speed in (0.8, 1.0)]
    assert kinds == ["periodic", "steady"]
    plane = ss.atlas(BELT, over={"speed": [0.8, 1.0], "damping": [0.1, 0.11]}, starts=dict(x=[0.3, 1.5]), settle=60, branches=0, refine=0)
    assert plane.at(speed=0.8, damping=0.1) == ("steady", "stick-slip") and plane.at(speed=1.0, damping=0.1) == ("steady",)


def test_a_cycle_of_several_turns_is_the_one_that_a_run_shows():
    blocks = TwoBlocks(0.33, Weakening())
    run = ss.solve(blocks, duration=600)
    m, cycle = ss.motion(run), ss.periodic_orbit(blocks, guess=run)
    assert (m.type, m.period) == (cycle.type, cycle.period) == ("stick-slip", 2)
    assert cycle.duration == pytest.approx(m.duration, rel=1e-10)
    np.testing.assert_allclose(run.at(600.0 - m.duration)["x"], run.at(600.0)["x"], atol=1e-9)


@each_row("section, turns, state", [
    (("x", 0.5, -1), None, (0.5, -np.sqrt(2.0) * np.hypot(0.25, 0.1 / np.sqrt(2.0)))),
    (("v", 0.05, 1), 2, (0.5 - np.sqrt(0.0675 - 0.00125), 0.05)),
])  # fmt: skip
def test_a_cycle_begins_on_the_section_that_is_asked_for(section, turns, state):
    """The slide is a circle about x = 0.5 of the radius of the formula."""
    cycle = ss.periodic_orbit(COULOMB, section=section, turns=turns)
    np.testing.assert_allclose(cycle.state, state, atol=1e-12)
    assert cycle.period == 1 and cycle.duration == pytest.approx(DURATION, rel=1e-12)
    assert bool(cycle.notes) == (turns == 2)
    branch = ss.continuation(COULOMB, parameter="speed", start=0.1, stop=0.12, guess=cycle, section=section, step=0.5)
    index = ("x", "v").index(section[0])
    np.testing.assert_allclose([orbit.state[index] for orbit in branch.orbits], section[1], atol=1e-15)
    far = (0.12 / np.sqrt(2.0), 0.25)
    assert branch.orbits[-1].duration == pytest.approx(0.5 / 0.12 + (2 * np.pi - 2 * np.arctan2(far[1], far[0])) / np.sqrt(2.0), rel=1e-11)


@pytest.mark.parametrize("name, rests", [("stick of b", True), ("slip of b", True), ("stick of a", False)])
def test_a_switch_of_a_contact_is_a_section_with_the_same_multipliers(name, rests):
    """The return map from switch to switch has the cycle of the usual section, its duration, and its multipliers."""
    blocks = TwoBlocks(0.295, Weakening())
    usual = ss.periodic_orbit(blocks, guess=ss.solve(blocks, duration=600))
    cycle = ss.periodic_orbit(blocks, guess=usual, section=name)
    np.testing.assert_allclose(cycle.multipliers, usual.multipliers, atol=1e-9)
    assert cycle.duration == usual.duration
    assert cycle.state[1 if name.endswith("b") else 0] == pytest.approx(0.295, abs=1e-13)  # it moves with the belt
    at = on_section(blocks, section=name)
    points, _, took = strobe_points(blocks, cycle.state[None], 2 * cycle.period, 1e-12, at)
    np.testing.assert_allclose(points[[cycle.period - 1, -1], 0], [cycle.state] * 2, atol=1e-12)
    assert took.sum() == pytest.approx(2 * cycle.duration, rel=1e-12) and str(at.section) == name
    back = ss.periodic_orbit(blocks, guess=cycle)
    assert back.duration == pytest.approx(usual.duration, rel=1e-12) and back.on_section is None
    if rests:
        events = [e.t for e in cycle.run.events if f"{e.kind} of {e.part}" == name]
        assert len([t for t in events if 1e-9 < t < cycle.duration - 1e-9]) == cycle.period - 1


def test_studies_look_at_motions_where_a_contact_sticks():
    blocks, name = TwoBlocks(0.295, Weakening()), "stick of b"
    cycle = ss.periodic_orbit(blocks, guess=ss.solve(blocks, duration=600), section=name)
    begun = coordinates(blocks).start(cycle.state)
    found = ss.lyapunov(blocks, section=name, turns=cycle.period, periods=30, settle=20, start=begun)
    assert abs(found.spectrum[0]) < 1e-4 and found.spectrum[1:].tolist()[1:] == [-np.inf, -np.inf]  # the same on the usual section, 1e-5
    assert found.spectrum[:2].sum() == pytest.approx(np.log(abs(cycle.multipliers[0])) / cycle.duration, rel=1e-5)
    branch = ss.continuation(blocks, parameter="speed", start=0.295, stop=0.2949, guess=cycle, section=name, step=0.5)
    np.testing.assert_allclose([orbit.state[1] for orbit in branch.orbits], branch.values, atol=1e-12)  # it has just stuck to the belt
    near = branch.at(0.29495)
    assert near.state[1] == pytest.approx(0.29495, abs=1e-12) and near.period == cycle.period
    diagram = ss.bifurcation(blocks, parameter="speed", values=[0.2949, 0.295], section=name, settle=200, points=4, start=begun)
    assert diagram.period.values.ravel().tolist() == [cycle.period] * diagram.period.size
    np.testing.assert_allclose(diagram.duration.values[:, -1], cycle.duration, rtol=1e-6)
    verdict = ss.verdict(blocks, start=begun, section=name)
    assert verdict.orbit.period == cycle.period and verdict.orbit.duration == pytest.approx(cycle.duration, rel=1e-9)


def test_a_section_of_a_driven_machine_or_of_what_drifts_along_or_a_switch_that_never_happens_is_refused():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb")
    pulled = ss.PulledMass(mass=1.0, stiffness=2.0, speed=0.1, friction=COULOMB.friction)
    for model, more, said in [
        (robot, dict(section="v"), "section is given, and the model has a period"),
        (robot, dict(turns=2), "turns is given, and the model has a period"),
        (pulled, dict(section="x"), "which goes on with the spring's far end"),
        (pulled, dict(turns=0), "turns = 0"),
        (TwoBlocks(0.33, Weakening()), dict(section="stick of c"), "no switch; did you mean 'stick of"),
        (COULOMB, dict(section=("slip of contact", 0.1)), "a switch has neither value nor direction; type section='slip of contact'"),
        (
            replace(COULOMB, friction=ss.LuGre(1.0, 1.0, 1.5, 1.5, sigma0=1e3, sigma1=10.0, sigma2=0.0, v_s=0.2)),
            dict(section="stick of contact"),
            "none of its contacts rests exactly",
        ),
    ]:
        with pytest.raises(ss.InputError, match=said):
            ss.periodic_orbit(model, **more)


def test_two_blocks_on_a_belt_come_back_as_their_run_says():
    blocks = TwoBlocks(0.15, STRIBECK)
    at = on_section(blocks)
    start = np.array([0.02, 0.15, 0.4, 0.5])
    states, _, times = strobe_points(blocks, start[None], 4, 1e-12, at)
    run = ss.solve(blocks, duration=float(times.sum()) + 1.0, start=at.start(start))
    there = run.at(np.cumsum(times[:, 0]))
    np.testing.assert_allclose(states[:, 0], np.hstack([there["v"], there["x"]]), atol=1e-10)
    np.testing.assert_allclose(states[:, 0, at.section.index], at.section.value, atol=1e-12)


@pytest.mark.slow
def test_two_blocks_on_a_belt_move_periodically_or_chaotically_by_their_start():
    found = ss.basins(TwoBlocks(0.15, STRIBECK), **{"v.a": [0.0, 0.1], "x.b": [0.0, 0.3, 0.6]})
    assert {a.kind for a in found.attractors} == {"chaotic", "periodic"}
    (cycle,) = [a for a in found.attractors if a.kind == "periodic"]
    assert cycle.orbit.stable and cycle.orbit.duration == pytest.approx(8.480716761, abs=1e-8)
