"""Self-excited machines against SciPy and formulas: where stick-slip ends, two blocks, a drill string, a hunting joint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve

import stickslip as ss
from problems import TwoBlocks, Weakening
from rows import each_row
from stickslip.dynamics.periodic.cycle_sections import TURN
from stickslip.dynamics.stroboscopic.chosen_sections import on_section
from stickslip.dynamics.stroboscopic.strobe_maps import strobe_map
from stickslip.maths import exp, where

K, DAMPING, MU, F, V_S = 2.0, 0.3, 1.0, 1.5, 0.2


@dataclass(frozen=True)
class Exponential:
    """Friction that weakens exponentially with the speed of the slip."""

    kinetic: float = MU
    static: float = F
    speed: float = V_S

    def sliding(self, v, load):
        return where(v > 0, 1.0, -1.0) * load * (self.kinetic + (self.static - self.kinetic) * exp(-abs(v) / self.speed))

    def breakaway(self, load):
        return -self.static * load, self.static * load


STRIBECK = ss.Stribeck(mu_plus=MU, mu_minus=MU, f_plus=F, f_minus=F, v_s=V_S)
LUGRE = ss.LuGre(mu_plus=MU, mu_minus=MU, f_plus=F, f_minus=F, sigma0=1e3, sigma1=10.0, sigma2=0.0, v_s=V_S)


def belt(law: Any, speed: float = 0.55) -> Any:
    return ss.BlockOnBelt(mass=1.0, stiffness=K, speed=speed, friction=law, damping=DAMPING)


CURVES = {"Stribeck": lambda w: MU + (F - MU) * np.exp(-((w / V_S) ** 2)), "Exponential": lambda w: MU + (F - MU) * np.exp(-abs(w) / V_S)}
LAWS = {"Stribeck": STRIBECK, "Exponential": Exponential()}


def _beyond(curve: Any, speed: float) -> float:
    """By how much the slide from break-away is faster than the belt where its acceleration vanishes, by SciPy alone."""
    field = lambda t, y: (y[1], curve(y[1] - speed) - K * y[0] - DAMPING * y[1])  # noqa: E731
    top = lambda t, y: curve(y[1] - speed) - K * y[0] - DAMPING * y[1]  # noqa: E731
    top.terminal, top.direction = True, -1.0  # type: ignore[attr-defined]
    how: dict[str, Any] = {"rtol": 1e-13, "atol": 1e-15, "method": "DOP853"}
    y = solve_ivp(field, (0.0, 1e-3), ((F - DAMPING * speed) / K, speed), **how).y[:, -1]
    return float(solve_ivp(field, (0.0, 30.0), y, events=top, **how).y_events[0][0][1]) - speed


def _sticks_beside(law: Any, value: float, aside: float, turns: int, begun: Any = None) -> Any:
    """Whether runs that much slower and faster still reach the speed of the belt after so many turns; from riding along, or a state."""
    speeds = value + np.array([-aside, aside])
    both, state = belt(law, speeds), np.column_stack([[0.5, 0.5], speeds]) if begun is None else np.tile(begun, (2, 1))
    at = on_section(both)
    late = strobe_map(both, strobe_map(both, state, turns, 1e-12, at).state, 1, 1e-12, at)
    return late.v_max >= speeds


@each_row("name, low, high", [("Stribeck", 0.6, 0.7), ("Exponential", 0.6, 0.68)])
def test_stick_slip_ends_where_the_slide_just_reaches_the_speed_of_the_belt(name, low, high):
    """Both branches: the stable cycle that rests ends there, and the unstable one that only slides goes back from it (subcritical)."""
    end = brentq(lambda speed: _beyond(CURVES[name], speed), low, high, xtol=1e-14, rtol=1e-14)
    branch = ss.continuation(belt(LAWS[name]), parameter="speed", start=0.6, stop=0.75, guess=dict(x=0.6, v=0.6), step=0.05)
    (border,) = [s for s in branch.special if s.kind == "type-border"]
    assert border.value == pytest.approx(end, abs=1e-11) and border.accuracy < 1e-9
    rests = np.array(["0" in orbit.pattern for orbit in branch.orbits])
    assert [orbit.stable for orbit in branch.orbits] == rests.tolist() and rests[0] and not rests[-1] and branch.values.max() <= end + 1e-9
    assert _sticks_beside(LAWS[name], border.value, 1e-9, turns=60).tolist() == [True, False]
    beside, rides = [end - 2e-3, end + 2e-3], dict(x=0.5, v=end - 2e-3)
    diagram = ss.bifurcation(belt(LAWS[name]), parameter="speed", values=beside, settle=40, start=rides)
    assert diagram.motion.values.tolist() == [["periodic", "steady"], ["steady", "steady"]]


def test_under_a_law_with_bristles_stick_slip_ends_at_a_fold_just_beyond_the_touch():
    """The branch turns back within 1e-7 of where the slip touches zero.

    An independent program (SciPy's DOP853 from event to event) has the touch at 0.6656146572272, and the largest speed of a cycle, by
    a parabola through those whose slip passes zero by 30, 45 and 60 nm/s, at 0.6656146601227.
    """
    nearby = ss.dynamics.PeriodicOrbit(belt(LUGRE), 1, np.array([1.06515561, 0.0, -1.00000823e-3]), 0.0, duration=4.527192923, section=TURN)
    branch = ss.continuation(belt(LUGRE), parameter="speed", start=0.6655, stop=0.6755, guess=nearby, step=0.05, points=8)
    fold, touch = (next(s for s in branch.special if s.kind == kind) for kind in ("fold", "grazing"))
    assert touch.value == pytest.approx(0.6656146572272, abs=touch.accuracy) and touch.accuracy < 1e-10
    assert fold.value == pytest.approx(0.6656146601227, abs=fold.accuracy) and fold.accuracy < 1e-10
    assert fold.orbit.multipliers[0] == pytest.approx(1.0, abs=1e-5)
    assert branch.orbits[0].motion.type == branch.orbits[0].type == "stick-slip"
    assert _sticks_beside(LUGRE, fold.value, 1e-9, turns=300, begun=fold.orbit.strobe_state).tolist() == [True, False]
    assert ss.periodic_orbit(belt(LUGRE, fold.value - 1e-10), guess=fold.orbit).residual < 1e-12
    with pytest.raises(ss.StickslipError, match="beside a fold"):  # what returns there within 2e-10 is no cycle
        ss.periodic_orbit(belt(LUGRE, fold.value + 1e-10), guess=fold.orbit)


def _rides_along(curve: Any, speed: float, x: float, v: float) -> bool:
    """Whether a start comes to ride along with the belt, or its swings die out, by SciPy."""
    hit = lambda t, y: y[1] - speed  # noqa: E731
    hit.terminal, hit.direction = True, 1.0  # type: ignore[attr-defined]
    field = lambda t, y: (y[1], curve(y[1] - speed) - K * y[0] - DAMPING * y[1])  # noqa: E731
    y, still = np.array([x, v]), curve(speed) / K
    for _ in range(400):
        run = solve_ivp(field, (0.0, 20.0), y, events=hit, rtol=1e-9, atol=1e-11)
        y = run.y[:, -1]
        if len(run.t_events[0]) or np.max(abs(run.y[:, -50:] - [[still], [0.0]])) < 1e-2:
            return bool(len(run.t_events[0]))
    raise AssertionError("neither within 400 times 20 s")


def _swings_on(x: float, v: float) -> bool:
    """The same under LuGre's law, whether the block comes to swing for ever, by SciPy's method for stiff equations."""

    def field(t: float, y: Any) -> tuple[float, float, float]:
        w = y[1] - 0.55
        rate = w - abs(w) * y[2] * 1e3 / CURVES["Stribeck"](w)
        return y[1], -K * y[0] - DAMPING * y[1] - 1e3 * y[2] - 10.0 * rate, rate

    y = np.array([x, v, 0.0])
    for _ in range(40):
        run = solve_ivp(field, (0.0, 30.0), y, method="Radau", rtol=1e-7, atol=1e-10)
        y, late = run.y[:, -1], run.y[1][run.t > 15.0]
        if late.max() > 0.99 * 0.55 or np.ptp(late) < 0.05:
            return bool(late.max() > 0.99 * 0.55)
    raise AssertionError("neither within 40 times 30 s")


@pytest.mark.slow
@pytest.mark.parametrize("name, tried", [("Stribeck", 150), ("Exponential", 150), ("LuGre", 24)])
def test_basins_of_many_starts_have_the_shares_of_brute_force(name, tried):
    x, v = np.linspace(-0.5, 1.5, 200), np.linspace(-0.6, 0.5, 200)
    found = ss.basins(belt(LUGRE if name == "LuGre" else LAWS[name]), x=x, v=v, settle=40, workers=2)
    kinds = [a.kind for a in found.attractors]
    assert sorted(kinds) == ["periodic", "steady"] and not found.others
    ours = found.map.attractor.values == kinds.index("periodic")
    places = np.random.default_rng(11).choice(ours.size, tried, replace=False)
    judge = _swings_on if name == "LuGre" else lambda a, b: _rides_along(CURVES[name], 0.55, a, b)
    brute = np.array([judge(x[i], v[k]) for i, k in zip(*np.unravel_index(places, ours.shape), strict=True)])
    assert np.array_equal(ours.ravel()[places], brute)
    assert abs(brute.mean() - ours.mean()) < 3.0 * np.sqrt(ours.mean() * (1 - ours.mean()) / tried)


def test_one_exponent_is_zero_and_the_others_are_those_of_the_cycle():
    """Over few returns too; the one along the motion is measured, as M f = f, and is no better than the tangent."""
    blocks = TwoBlocks(0.295, Weakening())
    for model, start, zero, known in (
        (belt(LUGRE), dict(x=1.0), 1e-7, 1e-6),
        (belt(STRIBECK), dict(x=1.0), 1e-12, 0.0),
        (blocks, None, 1e-9, 1e-8),
    ):
        found = ss.lyapunov(model, periods=30, settle=40 if start else 120, start=start)
        cycle = ss.periodic_orbit(model, guess=start or ss.solve(blocks, duration=600))
        with np.errstate(divide="ignore"):
            rate = np.log(abs(cycle.multipliers[0])) / cycle.duration
        assert abs(found.spectrum[0]) < zero and found.spectrum[1] == pytest.approx(rate, rel=known)


# ---- two blocks on a belt (Galvanetto and Bishop 1999; the values that they print were not at hand: SciPy is the judge) ----


LOADS = np.array([1.0, 1.3])


def _pull(x: Any) -> Any:
    """What springs do to the blocks."""
    return np.array([-x[0] - 1.2 * (x[0] - x[1]), -x[1] + 1.2 * (x[0] - x[1])])


def _turn(speed: float, gap: float) -> float:
    """Two blocks that ride along, so far apart, until they do again: how far apart then. By SciPy, from event to event."""
    x, v = np.array([0.0, gap]), np.full(2, speed)
    x += np.min(LOADS + _pull(x))  # the place at which the first of them is pulled off
    side = np.where(LOADS + _pull(x) > 1e-12, 0, -1)  # 0 rides along, -1 is slower than the belt, 1 faster
    how: dict[str, Any] = {"rtol": 1e-11, "atol": 1e-13, "method": "DOP853"}
    for _ in range(60):

        def field(t: float, y: Any, side: Any = side) -> Any:
            slide = _pull(y[:2]) - side * LOADS / (1 + 3 * side * (y[2:] - speed))
            return np.concatenate([y[2:], np.where(side == 0, 0.0, slide)])

        def event(i: int, side: Any = side) -> Any:
            free = lambda t, y: LOADS[i] - abs(_pull(y[:2])[i])  # noqa: E731
            meets = lambda t, y: side[i] * (y[2 + i] - speed) + (t == 0)  # noqa: E731
            one = meets if side[i] else free
            one.terminal, one.direction = True, -1.0  # type: ignore[attr-defined]
            return one

        run = solve_ivp(field, (0.0, 100.0), np.concatenate([x, v]), events=[event(0), event(1)], max_step=0.1, **how)
        x, v = run.y[:2, -1].copy(), run.y[2:, -1].copy()
        k = next(i for i in range(2) if len(run.t_events[i]))
        pulled = float(_pull(x)[k])
        side, v[k] = side.copy(), speed
        side[k] = 0 if side[k] and abs(pulled) < LOADS[k] else np.sign(pulled)
        if not side.any():
            return float(x[1] - x[0])
    raise AssertionError("they do not both ride along again within 60 events")


def _flip_of_scipy(near: float, gap: float, turns: int) -> float:
    """Where the map of the distances has the multiplier -1."""

    def after(speed: float, d: float) -> float:
        for _ in range(turns):
            d = _turn(speed, d)
        return d

    def beyond(speed: float) -> float:
        fixed = brentq(lambda d: after(speed, d) - d, gap - 3e-3, gap + 3e-3, xtol=1e-12)
        return (after(speed, fixed + 1e-5) - after(speed, fixed - 1e-5)) / 2e-5 + 1.0

    return float(brentq(beyond, near - 2e-5, near + 2e-5, xtol=1e-9))


@each_row("start, stop, flip", [(0.295, 0.2895, 0.2907408), (0.2495, 0.251, 0.2502567)])
def test_two_blocks_double_their_period_where_scipy_says(start, stop, flip):
    blocks = TwoBlocks(start, Weakening())
    branch = ss.continuation(blocks, parameter="speed", start=start, stop=stop, guess=ss.solve(blocks, duration=600), step=0.3)
    (special,) = [s for s in branch.special if s.kind == "flip"]
    assert special.value == pytest.approx(flip, abs=1e-7) and special.accuracy < 1e-9
    run = special.orbit.run
    resting = (np.asarray(run.pieces.mode) == 0).all(axis=1)
    begun = np.flatnonzero(resting & ~np.roll(resting, 1))
    x = run.at(float(run.pieces.t[begun[-1]]) + 1e-9)["x"]
    assert special.value == pytest.approx(_flip_of_scipy(flip, float(x[1] - x[0]), len(begun)), abs=1e-7)


# ---- a drill string of two discs (numbers of the kind of Navarro-Lopez and Suarez 2004; SciPy and eigenvalues are the judges) ----
STATIC, DYNAMIC, FALL, ARM = 0.8, 0.5, 0.9, 53018.0 * 0.155575
TOP, BIT, TWIST, TWISTING, MUD, HOLE = 2122.0, 471.9698, 861.5336, 50.0, 425.0, 50.0


@dataclass(frozen=True, eq=False)
class DrillString(ss.Machine):
    """A motor's torque turns the top; the bit rubs on rock."""

    torque: float
    friction: Any = Exponential(DYNAMIC, STATIC, 1 / FALL)
    time_scale = 2 * np.pi / np.sqrt(TWIST / BIT + TWIST / TOP)
    velocity_scale = 10.0

    def bodies(self):
        top = ss.machines.Body(TOP, force=lambda t, x, v: self.torque - MUD * v)
        return {"top": top, "bit": ss.machines.Body(BIT, force=lambda t, x, v: -HOLE * v)}

    def contacts(self):
        return {"bit": ss.machines.Contact("bit", self.friction, load=ARM)}

    def links(self):
        return {("top", "bit"): ss.machines.Spring(TWIST, damping=TWISTING)}


def _growth(speed: float) -> float:
    """How fast disturbances of steady rotation grow [1/s]."""
    slope = -ARM * (STATIC - DYNAMIC) * FALL * np.exp(-FALL * speed)
    rates = [
        [0, 1, -1],
        [-TWIST / TOP, -(MUD + TWISTING) / TOP, TWISTING / TOP],
        [TWIST / BIT, TWISTING / BIT, -(TWISTING + HOLE + slope) / BIT],
    ]
    return float(np.linalg.eigvals(np.array(rates)).real.max())


def _touch() -> float:
    """The torque at which the bit's slide from break-away comes back to break-away and only touches rest, by SciPy alone."""

    def force(y: Any) -> float:
        return float(TWIST * y[0] + TWISTING * (y[1] - y[2]) - HOLE * y[2] - ARM * (DYNAMIC + (STATIC - DYNAMIC) * np.exp(-FALL * y[2])))

    def beyond(u: Any) -> Any:
        torque, top = u

        def slide(t: float, y: Any) -> tuple[float, float, float]:
            couple = TWIST * y[0] + TWISTING * (y[1] - y[2])
            return y[1] - y[2], (torque - MUD * y[1] - couple) / TOP, force(y) / BIT

        slowest = lambda t, y: force(y)  # noqa: E731
        slowest.terminal, slowest.direction = True, 1.0  # type: ignore[attr-defined]
        how: dict[str, Any] = {"rtol": 1e-12, "atol": 1e-14, "method": "DOP853"}
        y = solve_ivp(slide, (0.0, 2.0), [(ARM * STATIC - TWISTING * top) / TWIST, top, 0.0], **how).y[:, -1]
        end = solve_ivp(slide, (0.0, 8.0), y, events=slowest, **how).y_events[0][0]
        return end[2], end[1] - top

    return float(fsolve(beyond, [7178.0, 6.5], xtol=1e-13)[0])


def test_a_drill_string_stops_sticking_at_a_torque_and_begins_again_at_a_smaller_one():
    """Steady rotation is stable down to a Hopf point, the cycle that sticks goes on up to a torque at which its rest vanishes."""
    string = DrillString(6900.0)
    run = ss.solve(string, duration=300.0, start={"x": {"top": 7.0}})
    branch = ss.continuation(string, parameter="torque", start=6900.0, stop=7400.0, guess=run, points=40, step=0.1)
    (end,) = [s for s in branch.special if s.kind == "type-border"]
    assert end.accuracy < 1e-7 and end.value == pytest.approx(_touch(), abs=end.accuracy)
    speed = brentq(_growth, 1.0, 12.0, xtol=1e-13)
    hopf = (MUD + HOLE) * speed + ARM * (DYNAMIC + (STATIC - DYNAMIC) * np.exp(-FALL * speed))
    assert hopf == pytest.approx(5727.107158793, abs=1e-8)
    torques, begun = [hopf - 100.0, hopf + 200.0, end.value - 200.0, end.value + 100.0], {"x": {"top": 10.0}, "v": {"top": 3.0}}
    diagram = ss.bifurcation(string, parameter="torque", values=torques, settle=80, points=4, start=begun)
    assert diagram.motion.values.tolist() == [["periodic"] * 3 + ["steady"], ["periodic"] + ["steady"] * 3]


# ---- a joint that hunts about its target ----
def _joint(stiction: float = 1.5, kd: float = 0.1) -> Any:
    joint = ss.Joint.example()
    return joint.replace({"friction.f_plus": 0.02 * stiction, "friction.f_minus": 0.02 * stiction, "control.kd": kd})


def test_a_joint_hunts_as_long_as_it_takes_more_to_start_than_to_slide():
    """What is beyond sliding friction sets the size of the cycle and the rest in which the integral gathers it: T = a + b / (F / f - 1)."""
    branch = ss.continuation(_joint, parameter="stiction", start=1.5, stop=1.3, step=0.2)
    over, times = 1 / (branch.values - 1.0), np.array([cycle.duration for cycle in branch.orbits])
    np.testing.assert_allclose(times, np.polyval(np.polyfit(over, times, 1), over), rtol=1e-9)
    np.testing.assert_allclose([cycle.multipliers[0] for cycle in branch.orbits], branch.orbits[0].multipliers[0], rtol=1e-6)
    m = ss.motion(ss.solve(_joint(), duration=200.0))
    assert (m.type, m.period, m.pattern) == ("stick-slip", 1, "0-0+") and m.duration == pytest.approx(times[0], rel=1e-8)
    diagram = ss.bifurcation(_joint, parameter="stiction", values=[1.499, 1.5], settle=40, points=4, follow=False)
    assert diagram.motion.values.tolist() == [["periodic"] * 2] and diagram.duration.values[0, 1] == pytest.approx(times[0], rel=1e-6)


def test_an_atlas_has_the_border_of_hunting():
    plane = ss.atlas(_joint, over={"stiction": [1.0, 1.25, 1.5], "kd": [0.1, 0.15]}, settle=40, starts=2, branches=0, refine=0)
    hunts = np.array([["stick-slip" in region for region in row] for row in plane.map.region.values])
    assert hunts.tolist() == [[False] * 2, [True] * 2, [True] * 2]
