"""Flows without a period, looked at on a section: van der Pol's oscillator with a stop, and a predator that is hunted, against SciPy."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stickslip as ss
from rows import each_row
from stickslip.dynamics.stroboscopic.chosen_sections import on_section
from stickslip.dynamics.stroboscopic.strobe_maps import strobe_map

MU, GAP, R = 1.0, 1.2, 0.6


def _swing(t: float, y: Any, n: Any) -> tuple[Any, Any]:
    return y[1], n.mu * (1 - y[0] ** 2) * y[1] - y[0]


STOP = ss.Switch(lambda t, y, n: n.gap - y[0], 0, lambda t, y, n: (n.gap, -n.r * y[1]))
POL = ss.SwitchingFlow({0: _swing}, {0: (STOP,)}, None, {"mu": MU, "gap": GAP, "r": R}, ("x", "v"))


# ---- the same by SciPy alone ----
def _to_the_stop(y: Any) -> tuple[float, Any]:
    hit = lambda t, y: GAP - y[0]  # noqa: E731
    hit.terminal, hit.direction = True, -1.0  # type: ignore[attr-defined]
    field = lambda t, y: (y[1], MU * (1 - y[0] ** 2) * y[1] - y[0])  # noqa: E731
    run = solve_ivp(field, (0.0, 50.0), y, events=hit, rtol=1e-12, atol=1e-13, method="DOP853")
    return float(run.t_events[0][0]), run.y_events[0][0]


@cache
def cycle() -> tuple[float, float, float]:
    """Time from hit to hit, the velocity after it, and the multiplier, by fixed points of the map of rebounds."""
    v = -1.0
    for _ in range(40):
        T, y = _to_the_stop([GAP, v])
        v = -R * float(y[1])
    after, before = (-R * float(_to_the_stop([GAP, v + d])[1][1]) for d in (1e-5, -1e-5))
    return T, v, (after - before) / 2e-5


def _fastest(v: float) -> float:
    """The largest velocity on the way to the stop."""
    field = lambda t, y: (y[1], MU * (1 - y[0] ** 2) * y[1] - y[0])  # noqa: E731
    T, _ = _to_the_stop([GAP, v])
    run = solve_ivp(field, (0.0, T), [GAP, v], rtol=1e-12, atol=1e-13, method="DOP853", dense_output=True)
    return float(run.sol(np.linspace(0.0, T, 20001))[1].max())


def test_the_cycle_of_a_run_is_that_of_scipy():
    T, v, multiplier = cycle()
    orbit = ss.periodic_orbit(POL)
    assert (orbit.period, len(orbit.events)) == (1, 1) and orbit.duration == pytest.approx(T, rel=1e-9)
    assert orbit.multipliers == pytest.approx([multiplier], abs=1e-6)
    assert ss.solve(POL, start=orbit.state, duration=T).at(orbit.events[0].t)["v"] == pytest.approx(v, rel=1e-9)


def test_a_cycle_begins_on_the_section_that_is_asked_for():
    orbit = ss.periodic_orbit(POL, section=("v", 0.5, 1), turns=2)
    assert orbit.state[1] == pytest.approx(0.5, abs=1e-12) and orbit.duration == pytest.approx(cycle()[0], rel=1e-9)
    branch = ss.continuation(POL, parameter="r", start=0.6, stop=0.62, section=("v", 0.5, 1), step=0.5)
    np.testing.assert_allclose([each.state[1] for each in branch.orbits], 0.5, atol=1e-10)


def test_one_exponent_is_zero_and_the_other_that_of_the_multiplier():
    T, _, multiplier = cycle()
    spectrum = ss.lyapunov(POL, periods=40, settle=40).spectrum
    assert spectrum == pytest.approx([0.0, np.log(multiplier) / T], abs=1e-6)


def test_basins_and_verdict_are_of_the_cycle_and_an_unstable_rest_is_no_attractor():
    b = ss.basins(POL, x=[-1.0, 0.0, 1.0], v=[0.0, 1.0], settle=40)
    (only,) = b.attractors
    assert (only.kind, only.period) == ("periodic", 1) and only.orbit.duration == pytest.approx(cycle()[0], rel=1e-9)
    assert b.map.motion.sel(x=0.0, v=0.0) == "not settled" and "at an unstable rest" in b.notes[0]
    assert ss.verdict(POL, periods=40, settle=40).kind == "periodic"


def test_starts_beyond_the_guards_of_every_mode_are_said():
    b = ss.basins(POL, x=[0.5, 1.3, 2.0], v=[0.0], settle=20)
    assert b.notes[-1].startswith("2 of 3 starts lie beyond the guards of every mode, and a reset makes another state of each at t = 0")
    assert not ss.basins(POL, x=[0.5], v=[0.0], settle=20).notes


def test_diagrams_maps_attractors_and_branches_have_the_cycles_of_each_value():
    r = [0.5, 0.6]
    times = [ss.dynamics.flow_orbit(POL.replace(r=each), ss.periodic_orbit(POL).state, 0, duration=4.5).duration for each in r]
    diagram = ss.bifurcation(POL, parameter="r", values=r, settle=40, points=4)
    np.testing.assert_allclose(diagram.duration.values, [times] * 2, rtol=1e-9)
    assert ss.dynamics.chaos_map(POL, r=r, settle=40, periods=20).period.values.tolist() == [1, 1]
    along = ss.attractors(POL, parameter="r", values=r, starts={"x": [0.5]}, settle=40)
    assert along.motion.values.tolist() == [["periodic", "periodic"]]
    branch = ss.continuation(POL, parameter="r", start=0.5, stop=0.6)
    assert [branch.orbits[k].duration for k in (0, -1)] == pytest.approx(times, rel=1e-9)


def test_a_section_is_chosen_or_named():
    at = on_section(POL, section=("v", 0.5, 1))
    state = strobe_map(POL, [[0.5, 0.0, 0.0]], 30, at=at).state
    assert (at.section.name, at.section.direction) == ("v", 1.0) and state[0, 1] == pytest.approx(0.5, abs=1e-14)
    assert strobe_map(POL, state, 1, at=at).duration[0] == pytest.approx(cycle()[0], rel=1e-9)
    twice = on_section(POL, section="x", turns=2)
    state = strobe_map(POL, [[0.5, 0.0, 0.0]], 30, at=twice).state
    assert strobe_map(POL, state, 1, at=twice).duration[0] == pytest.approx(2 * cycle()[0], rel=1e-9)


def test_a_switch_is_a_section_too():
    """The instants of guards are exact: cycles begin right behind them, with the durations and exponents of other sections."""
    T, v, multiplier = cycle()
    hit = ss.periodic_orbit(POL, section="0 to 0")
    assert (hit.period, len(hit.events)) == (1, 1) and hit.duration == pytest.approx(T, rel=1e-11)
    assert hit.state == pytest.approx([GAP, v], abs=1e-11) and hit.multipliers == pytest.approx([multiplier], abs=1e-8)
    spectrum = ss.lyapunov(POL, periods=30, settle=20, section="0 to 0", turns=2).spectrum
    assert spectrum == pytest.approx([0.0, np.log(multiplier) / T], abs=1e-8)
    (only,) = ss.basins(POL, x=[0.5], v=[0.0, 1.0], settle=40, section="0 to 0").attractors
    assert only.orbit.state == pytest.approx([GAP, v], abs=1e-9)
    branch = ss.continuation(POL, parameter="r", start=0.5, stop=0.6, section="0 to 0", step=0.5)
    np.testing.assert_allclose([orbit.state[0] for orbit in branch.orbits], GAP, atol=1e-12)
    assert branch.at(0.6).state == pytest.approx([GAP, v], abs=1e-9)
    leaves = ss.periodic_orbit(HUNT, guess={"prey": 1.0, "predator": 0.5}, section="slides to hunted")
    assert leaves.mode == "hunted" and leaves.duration == pytest.approx(_hunted_cycle(), rel=1e-10)
    with pytest.raises(ss.StickslipError, match="the cycle has no 'free to hunted'; its modes are slides, hunted"):
        ss.periodic_orbit(HUNT, guess=leaves, section="free to hunted")
    foot = ss.machines.FlowContact(lambda t, y: y[1] - 0.1, ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5), load=1.0)
    block = ss.SwitchingFlow(lambda t, y, R: (y[1], -2.0 * y[0] - R.belt), states=("x", "v"), contacts={"belt": foot})
    for name, x in (("stick of belt", 0.25), ("slip of belt", 0.75), ("belt0 to belt-", 0.75)):
        assert ss.periodic_orbit(block, guess={"x": 1.0}, section=name).state == pytest.approx([x, 0.1], abs=1e-12)
        assert ss.lyapunov(block, periods=20, settle=5, start={"x": 1.0}, section=name).spectrum[0] == pytest.approx(0.0, abs=1e-9)


FORCED = ss.SwitchingFlow({0: _swing}, period=1.0, numbers={"mu": 1.0}, states=("x", "v"))


@each_row(
    "flow, more, said",
    [
        (POL, dict(section="w"), "section = 'w': 'w' is not a name of the state, and no switch; known: x, v, 0 to 0"),
        (POL, dict(section=("v", float("nan"))), "allowed are a finite value, and as a direction 1"),
        (POL, dict(section=("v", 0.0, 2)), "allowed are a finite value, and as a direction 1"),
        (POL, dict(section=("0 to 0", 1.0)), "a switch has neither value nor direction; type section='0 to 0'"),
        (POL, dict(section=3), "allowed is a name of the state, alone or with a value"),
        (POL, dict(turns=0), "turns = 0"),
        (FORCED, dict(section="v"), "section is given, and the model has a period"),
    ],
    ids=["name", "value", "direction", "switch", "not a name", "turns", "period"],
)
def test_what_is_no_section_is_said(flow, more, said):
    with pytest.raises(ss.InputError) as error:
        ss.basins(flow, x=[0.5], settle=5, **more)
    assert said in str(error.value)


# ---- a predator that is hunted while there are many: a Filippov flow ----
A, B, M, EFFORT, LIMIT = 1.0, 0.5, 0.3, 0.35, 0.9


def _grow(effort: float) -> Any:
    """Prey that saturates, a predator with a saturating appetite, hunted with some effort (Rosenzweig and MacArthur)."""
    return lambda t, y, n: (
        y[0] * (1 - y[0] / n.k) - A * y[0] * y[1] / (1 + B * y[0]),
        y[1] * (A * y[0] / (1 + B * y[0]) - M - effort * n.effort),
    )


def _slide(t: float, y: Any, n: Any) -> tuple[Any, Any]:
    """Along the limit the hunt holds the predator there."""
    return y[0] * (1 - y[0] / n.k) - A * y[0] * n.limit / (1 + B * y[0]), 0.0 * y[1]


def _gain(y: Any) -> Any:
    return A * y[0] / (1 + B * y[0]) - M


def _after(t: float, y: Any, n: Any) -> str:
    if _gain(y) > n.effort:
        return "hunted"
    return "slides" if _gain(y) > 0.0 else "free"


HUNT = ss.SwitchingFlow(
    {"free": _grow(0.0), "hunted": _grow(1.0), "slides": _slide},
    {
        "free": (ss.Switch(lambda t, y, n: n.limit - y[1], _after, lambda t, y, n: (y[0], n.limit)),),
        "hunted": (ss.Switch(lambda t, y, n: y[1] - n.limit, _after, lambda t, y, n: (y[0], n.limit)),),
        "slides": (ss.Switch(lambda t, y, n: _gain(y), "free"), ss.Switch(lambda t, y, n: n.effort - _gain(y), "hunted")),
    },
    None, {"k": 6.0, "effort": EFFORT, "limit": LIMIT}, ("prey", "predator"),
)  # fmt: skip


def _hunted_cycle() -> float:
    """How long it takes from the end of the slide through the hunt to the limit, and along it to the end of the slide, by SciPy."""
    k, leaves = HUNT.numbers["k"], (M + EFFORT) / (A - B * (M + EFFORT))
    hunted = lambda t, y: (  # noqa: E731
        y[0] * (1 - y[0] / k) - A * y[0] * y[1] / (1 + B * y[0]),
        y[1] * (A * y[0] / (1 + B * y[0]) - M - EFFORT),
    )
    falls = lambda t, y: y[1] - LIMIT  # noqa: E731
    falls.terminal, falls.direction = True, -1.0  # type: ignore[attr-defined]
    how: dict[str, Any] = dict(rtol=1e-12, atol=1e-13, method="DOP853")
    away = solve_ivp(hunted, (0.0, 60.0), [leaves, LIMIT + 1e-13], events=falls, **how)
    there = lambda t, x: x[0] - leaves  # noqa: E731
    there.terminal, there.direction = True, 1.0  # type: ignore[attr-defined]
    along = lambda t, x: [x[0] * (1 - x[0] / k) - A * x[0] * LIMIT / (1 + B * x[0])]  # noqa: E731
    slide = solve_ivp(along, (0.0, 60.0), [away.y_events[0][0][0]], events=there, **how)
    return float(away.t_events[0][0] + slide.t_events[0][0])


def test_a_cycle_that_slides_along_its_limit_is_that_of_scipy():
    orbit = ss.periodic_orbit(HUNT, guess={"prey": 1.0, "predator": 0.5})
    assert orbit.pattern == ("slides", "hunted") and orbit.duration == pytest.approx(_hunted_cycle(), rel=1e-6)
    assert orbit.multipliers == pytest.approx([0.0], abs=1e-12)  # the slide forgets from where it came


def test_every_door_leads_to_that_cycle():
    start, T = {"prey": 1.0, "predator": 0.5}, _hunted_cycle()
    (only,) = ss.basins(HUNT, prey=[0.5, 2.0], predator=[0.5, 1.5], settle=20).attractors
    assert only.orbit.duration == pytest.approx(T, rel=1e-6)
    spectrum = ss.lyapunov(HUNT, periods=40, settle=20, start=start).spectrum
    assert abs(spectrum[0]) < 1e-6 and np.isneginf(spectrum[1])
    assert ss.verdict(HUNT, periods=40, settle=20, start=start).kind == "periodic"
    diagram = ss.bifurcation(HUNT, parameter="k", values=[5.9, 6.0], settle=20, points=4, start=start)
    np.testing.assert_allclose(diagram.duration.values[:, 1], T, rtol=1e-6)


def test_between_two_cycles_is_an_unstable_one_of_which_a_run_keeps_away():
    """With little effort a small cycle that slides and a large one that does not attract; SciPy's runs beside the edge part there."""
    flow = HUNT.replace(effort=0.1)
    small, large = {"prey": 0.5118, "predator": 1.544, "mode": "hunted"}, {"prey": 1.5, "predator": 0.5}
    edge = ss.dynamics.edge_state(flow, small, large)
    assert edge.kind == "repeller" and edge.multipliers[0] > 1.0 and edge.orbit.residual < 1e-9
    beside = [ss.solve(flow, start=edge.state[:2] * side, mode="hunted", duration=400.0) for side in ([1.0, 1.01], [1.0, 0.99])]
    assert sorted({event.after for event in run.events[-6:]} == {"free", "hunted"} for run in beside) == [False, True]


def test_what_does_not_come_back_to_a_section_has_not_settled():
    flow = HUNT.replace(effort=0.1)
    b = ss.basins(flow, prey=[0.4], predator=[0.5, 0.89], settle=20, section=("prey", 2.5))
    assert b.map.motion.values[0].tolist() == ["periodic", "not settled"]
    assert "does not come back to the section (prey" in b.notes[0] and "type section=(name, value)" in b.notes[0]
    assert [a.kind for a in ss.basins(flow, prey=[0.4], predator=[0.5, 0.89], settle=20).attractors] == ["periodic"] * 2


def test_an_atlas_names_cycles_by_their_modes():
    plane = ss.atlas(
        HUNT, over={"k": [5.0, 6.0], "effort": [0.1, 0.35]}, starts={"prey": [1.0], "predator": [0.5]}, settle=20, branches=0, refine=0
    )
    assert "modes hunted slides" in plane.at(k=6.0, effort=0.35) and "modes free hunted" in plane.at(k=6.0, effort=0.1)


def test_the_motion_of_a_run_is_that_of_its_cycle():
    T, v, _ = cycle()
    m = ss.motion(ss.solve(POL, start={"x": 0.5}, duration=200.0))
    assert (m.type, m.period, m.pattern, m.settled) == ("periodic", 1, (0,), True) and m.duration == pytest.approx(T, rel=1e-9)
    assert m.ranges["x"][1] == pytest.approx(GAP, abs=1e-12) and m.ranges["v"][1] == pytest.approx(_fastest(v), rel=1e-6)
    slid = ss.motion(ss.solve(HUNT, start={"prey": 1.0, "predator": 0.5}, duration=300.0))
    assert set(slid.pattern) == set(slid.modes) == {"hunted", "slides"} and slid.duration == pytest.approx(_hunted_cycle(), rel=1e-6)
    assert slid.ranges["predator"][0] == pytest.approx(LIMIT, abs=1e-12) and sum(slid.modes.values()) == pytest.approx(1.0)


def test_the_motion_of_a_run_that_rests_is_steady_and_one_that_still_swings_is_not_settled():
    damped = ss.SwitchingFlow({0: lambda t, y: (y[1], -0.1 * y[1] - y[0])}, states=("x", "v"))
    early, late = (ss.motion(ss.solve(damped, start={"x": 1.0, "v": 0.0}, duration=T)) for T in (60.0, 4000.0))
    assert early.type == "not settled" and early.change > 1e-3 and np.isnan(early.duration)
    assert late.type == "steady" and late.period is None
