"""Answers of nonlinear dynamics that are known, by the public functions: the table of notes/known-answers.md.

``python verification/known_answers.py`` prints its rows; with names of rows only those.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from published_systems import EDGE, LEINE, PECK, bent, crossing, every_other, fallen, woodpecker

import stickslip as ss
from stickslip.maths import atan, cos, where


class Row(NamedTuple):
    """A system with what is known of it: where that is printed, or its closed form; the numbers, ours, and how far they may differ."""

    system: str
    source: str
    known: tuple[float, ...]
    ours: Callable[[], tuple[float, ...]]
    within: float


def henon() -> tuple[float, ...]:
    """Largest exponent of a million iterations."""
    found = ss.dynamics.lyapunov_of_map(lambda x: (1 - 1.4 * x[0] * x[0] + x[1], 0.3 * x[0]), [0.1, 0.1], iterations=1_000_000)
    return (found.largest,)


def lorenz() -> tuple[float, ...]:
    """The three exponents over 20 000 units of time."""
    flow = ss.SwitchingFlow({0: lambda t, y: (10 * (y[1] - y[0]), y[0] * (28 - y[2]) - y[1], y[0] * y[1] - 8 / 3 * y[2])})
    return tuple(ss.dynamics.lyapunov_of_flow(flow, [1.0, 1.0, 1.0], duration=20_000.0).spectrum.tolist())


DELTA, EPSILON, DAMPING = 1.3, 0.8, 0.1


def meissner() -> tuple[float, ...]:
    """Multipliers of x'' + c x' + (delta + epsilon sgn cos t) x = 0 about its rest."""
    field = lambda t, y: (y[1], -DAMPING * y[1] - where(cos(t) > 0.0, DELTA + EPSILON, DELTA - EPSILON) * y[0])  # noqa: E731
    flow = ss.SwitchingFlow({0: field}, {}, 2 * math.pi, states=("x", "v"))
    return sizes(ss.periodic_orbit(flow, guess={"x": 0.0, "v": 0.0}).multipliers)


def meissner_closed() -> tuple[float, ...]:
    """Eigenvalues of the product of two damped rotations, each half a period long."""
    M = np.eye(2)
    for stiffness in (DELTA + EPSILON, DELTA - EPSILON):  # the order does not change the eigenvalues
        w, t, b = math.sqrt(stiffness - DAMPING**2 / 4), math.pi, DAMPING / 2
        c, s = math.cos(w * t), math.sin(w * t) / w
        M = math.exp(-b * t) * np.array([[c + b * s, s], [-stiffness * s, c - b * s]]) @ M
    return sizes(np.linalg.eigvals(M))


def sizes(multipliers: object) -> tuple[float, ...]:
    """Real numbers that do not depend on the order of a pair: sum and product."""
    found = np.asarray(multipliers, complex)
    return (float(found.sum().real), float(found.prod().real))


R = 0.7


def oscillator(F: float) -> ss.ForcedOscillator:
    """Den Hartog's oscillator at 0.7 of its own frequency; everything else is 1."""
    return ss.ForcedOscillator(mass=1.0, stiffness=1.0, damping=0.0, force=1.0, omega=R, friction=ss.Coulomb(F, F))


def den_hartog() -> tuple[float, ...]:
    """Friction from which on the mass stops within its period, by continuation."""
    branch = ss.continuation(oscillator, parameter="F", start=0.7, stop=0.75, step=0.1)
    return (next(s.value for s in branch.special if s.kind == "type-border"),)


def sliding() -> tuple[float, ...]:
    """The same border of a hand-written flow in its forcing: sliding along v = 0 begins."""
    slide = lambda side: lambda t, y, n: (y[1], -y[0] + n.p * cos(R * t) - side)  # noqa: E731
    held = lambda t, y, n: abs(n.p * cos(R * t) - y[0]) < 1.0  # noqa: E731
    forth = ss.Switch(lambda t, y, n: y[1], lambda t, y, n: "rest" if held(t, y, n) else -1)
    back = ss.Switch(lambda t, y, n: -y[1], lambda t, y, n: "rest" if held(t, y, n) else 1)
    pull = lambda side: lambda t, y, n: 1.0 - side * (n.p * cos(R * t) - y[0])  # noqa: E731
    loose = (ss.Switch(pull(1), 1), ss.Switch(pull(-1), -1))
    fields = {1: slide(1), -1: slide(-1), "rest": lambda t, y, n: (0.0 * y[0], 0.0)}
    flow = ss.SwitchingFlow(fields, {1: (forth,), -1: (back,), "rest": loose}, 2 * math.pi / R, {"p": 1.36}, ("x", "v"))
    branch = ss.continuation(flow, parameter="p", start=1.36, stop=1.42, guess={"x": -1.32 * 1.36, "v": 0.5, "mode": 1})
    return (next(s.value for s in branch.special if s.kind in ("grazing", "type-border")),)


def stop_border() -> float:
    """V / sqrt(1/R^4 + U^2) with V = 1/(1 - R^2), U = tan(pi/2R)/R (Den Hartog 1930)."""
    return 1 / (1 - R**2) / math.sqrt(1 / R**4 + (math.tan(math.pi / (2 * R)) / R) ** 2)


def lorenz_pitchfork() -> tuple[float, ...]:
    """Where the rest of Lorenz' flow loses its symmetry: the branch point of its equilibrium."""
    field = lambda t, y, n: (10 * (y[1] - y[0]), n.r * y[0] - y[1] - y[0] * y[2], y[0] * y[1] - 8 / 3 * y[2])  # noqa: E731
    flow = ss.SwitchingFlow({0: field}, {}, 1.0, {"r": 0.5}, ("x", "y", "z"))
    branch = ss.continuation(flow, parameter="r", start=0.5, stop=2.0, guess={"x": 0.0})
    return (next(s.value for s in branch.special if s.kind == "branch-point"),)


def henon_resonance() -> tuple[float, ...]:
    """Where both multipliers of Henon's map are -1, on its curve of flips."""
    flow = ss.SwitchingFlow.of_map(lambda y, n: (1 - n.a * y[0] ** 2 + y[1], n.b * y[0]), {"a": 0.1, "b": 0.3}, ("x", "y"))
    branch = ss.continuation(flow, parameter="a", start=0.1, stop=1.0, guess={"x": 0.7, "y": 0.2})
    curve = ss.dynamics.special_curve(branch, branch.special[0], "b", stop=-1.2)
    return next(met.values for met in curve.special if met.kind == "R2")


def cusp() -> tuple[float, ...]:
    """Where the two curves of folds of x to p + q x - x^3 end."""
    flow = ss.SwitchingFlow.of_map(lambda y, n: (n.p + n.q * y[0] - y[0] ** 3,), {"p": -0.5, "q": 1.3}, ("x",))
    branch = ss.continuation(flow, parameter="p", start=-0.5, stop=0.3, guess={"x": -0.9})
    curve = ss.dynamics.special_curve(branch, next(s for s in branch.special if s.kind == "fold"), "q", stop=0.5)
    return next(met.values for met in curve.special if met.kind == "cusp")


K, C, W, D = 1.0, 0.2, 2.0, 1.0


def impact() -> tuple[float, ...]:
    """Forcing at which an oscillator begins to hit a wall at the distance d, by continuation."""
    swing = lambda t, y, n: (y[1], -K * y[0] - C * y[1] + n.a * cos(W * t))  # noqa: E731
    wall = ss.Switch(lambda t, y, n: y[0] + D, 0, lambda t, y, n: (-D, -0.8 * y[1]))
    flow = ss.SwitchingFlow({0: swing}, {0: (wall,)}, 2 * math.pi / W, {"a": 2.0}, ("x", "v"))
    branch = ss.continuation(flow, parameter="a", start=2.0, stop=4.0)
    return (next(s.value for s in branch.special if s.kind == "grazing"),)


def grazing() -> float:
    """The forcing at which the free swing is d."""
    return D * math.sqrt((K - W * W) ** 2 + (C * W) ** 2)


def belt() -> tuple[float, ...]:
    """Period of the stick-slip cycle of a block on a belt."""
    law = ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)
    return (ss.periodic_orbit(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=law)).duration,)


def belt_closed() -> float:
    """It sticks while the spring is stretched from x1 to F_s/k, and slides along an ellipse about F/k."""
    w, k, v, static, kinetic = math.sqrt(2.0), 2.0, 0.1, 1.5, 1.0
    drop = (static - kinetic) / k
    return 2 * drop / v + 2 * (math.pi - math.atan(drop * w / v)) / w


SPEED, FADES = 0.2, 3.0  # of the belt; of friction with velocity


def set_valued_belt() -> tuple[float, ...]:
    """Largest displacement in the limit cycle of Leine's block on a belt, whose friction falls from 1 as 1/(1 + 3|v|)."""
    slide = lambda side: lambda t, y: (y[1], -y[0] - side / (1.0 + FADES * side * (y[1] - SPEED)))  # noqa: E731
    caught = lambda side: lambda t, y: "stick" if abs(y[0]) <= 1.0 else -side  # noqa: E731
    switches = {
        -1: (ss.Switch(lambda t, y: SPEED - y[1], caught(-1)),),
        1: (ss.Switch(lambda t, y: y[1] - SPEED, caught(1)),),
        "stick": (ss.Switch(lambda t, y: 1.0 - y[0], -1), ss.Switch(lambda t, y: 1.0 + y[0], 1)),
    }
    fields = {-1: slide(-1), 1: slide(1), "stick": lambda t, y: (SPEED + 0.0 * y[0], 0.0 * y[0])}
    flow = ss.SwitchingFlow(fields, switches, states=("q", "u"))
    return (float(ss.dynamics.flow_orbit(flow, [1.0, SPEED], -1, duration=12.0).passage.highest[0]),)


def rounded_belt() -> tuple[float, ...]:
    """The same, with sgn v rounded off by an arctangent."""

    def rates(side: int) -> Callable[..., tuple[object, ...]]:
        shape = lambda v: 2.0 / math.pi * atan(1e3 * v) / (1.0 + FADES * side * v)  # noqa: E731
        return lambda t, y: (y[1], -y[0] - shape(y[1] - SPEED))

    turn = {-1: (ss.Switch(lambda t, y: SPEED - y[1], 1),), 1: (ss.Switch(lambda t, y: y[1] - SPEED, -1),)}
    flow = ss.SwitchingFlow({-1: rates(-1), 1: rates(1)}, turn, states=("q", "u"))
    return (float(ss.dynamics.flow_orbit(flow, [1.067, 0.0], -1, duration=11.3).passage.highest[0]),)


LUGRE = (1.043656607367126, 0.081148750297240, -0.007831711872955)  # a state of the cycle as it is printed


def lugre_belt() -> tuple[float, ...]:
    """The same with bristles (stiffness 100, damping 20): displacement and bristle where the velocity falls through the printed one."""

    def rates(side: int) -> Callable[..., tuple[object, ...]]:
        bristle = lambda v, z: v - 100.0 * side * v * (1.0 + FADES * side * v) * z  # noqa: E731
        return lambda t, y: (y[1], -y[0] - 100.0 * y[2] - 20.0 * bristle(y[1] - SPEED, y[2]), bristle(y[1] - SPEED, y[2]))

    switches = {
        "above": (ss.Switch(lambda t, y: y[1] - LUGRE[1], "below"), ss.Switch(lambda t, y: SPEED - y[1], "ahead")),
        "below": (ss.Switch(lambda t, y: LUGRE[1] - y[1], "above"),),
        "ahead": (ss.Switch(lambda t, y: y[1] - SPEED, "above"),),
    }
    flow = ss.SwitchingFlow({"above": rates(-1), "below": rates(-1), "ahead": rates(1)}, switches, states=("q", "u", "z"))
    orbit = ss.dynamics.flow_orbit(flow, LUGRE, "below", duration=11.0)
    fallen = next(c.t for c in orbit.events if c.after == "below")
    at = ss.dynamics.passage(flow, orbit.state, orbit.mode, fallen).state
    return (float(at[0]), float(at[2]))


def impacting(mu: float) -> ss.SwitchingFlow:
    """Tang's linear flow in three dimensions with impacts at x = 1; its eigenvalues are -0.1 +- 0.2i and -0.5 - mu."""

    def rates(t: object, y: tuple[float, ...], n: object) -> tuple[object, ...]:
        third = -0.5 - n.mu  # type: ignore[attr-defined]
        return ((third - 0.2) * y[0] + y[1], (0.2 * third - 0.05) * y[0] + y[2], 0.05 * third * y[0])

    def hit(t: object, y: tuple[float, ...], n: object) -> tuple[object, ...]:
        speed = (-0.7 - n.mu) * y[0] + y[1]  # type: ignore[attr-defined]
        return (1.0, y[1] - (1.78192697901049 + 0.095612982101833) * speed, y[2] - 1.6 * speed)

    return ss.SwitchingFlow({0: rates}, {0: (ss.Switch(lambda t, y, n: y[0] - 1.0, 0, hit),)}, None, {"mu": mu}, ("x", "y", "z"))


def cycles(values: tuple[float, ...], state: object, duration: float) -> list[ss.dynamics.PeriodicOrbit]:
    """Limit cycles for rising or falling mu, each looked for from the one before."""
    found = []
    for mu in values:
        orbit = ss.dynamics.flow_orbit(impacting(mu), state, 0, duration=duration)
        state, duration = orbit.state, orbit.duration
        found.append(orbit)
    return found


TANG = (0.025014022367497, 4.795364374429504)  # mu and duration at the fold as they are printed
START = ((1.04672901, 0.747249541, 0.126217862), 3.379)  # of the cycle at half the value of the fold


def impact_fold() -> tuple[float, ...]:
    """Fold of limit cycles: mu and duration as polynomials of the largest multiplier, where that is 1."""
    values = (0.0125, 0.02, 0.023, 0.0242, 0.0246, 0.0248, 0.0249, 0.02495, 0.02498, 0.025, 0.02501)
    near = cycles(values, *START)[-6:]
    beyond = [float(np.abs(orbit.multipliers).max()) - 1.0 for orbit in near]
    return tuple(float(np.polyfit(beyond, y, 5)[-1]) for y in (values[-6:], [orbit.duration for orbit in near]))


def across(orbit: ss.dynamics.PeriodicOrbit) -> tuple[object, float]:
    """A guess of the cycle of the same mu on the other side of the fold, where the duration is as far above."""
    ahead = ss.dynamics.flow_orbit(impacting(0.02499), orbit.state, 0, duration=orbit.duration)
    share = (TANG[1] - orbit.duration) / (orbit.duration - ahead.duration)
    return orbit.state + 2 * share * (orbit.state - ahead.state), 2 * TANG[1] - orbit.duration


def impact_ends() -> tuple[float, ...]:
    """Durations of the two cycles at mu = 0, where both branches end."""
    fold = cycles((0.02, 0.023, 0.0242, 0.0248, 0.025), *START)[-1]
    beyond = cycles((0.025, 0.0248, 0.0242, 0.023, 0.02, 0.015, 0.01, 0.005, 0.0), *across(fold))
    return (cycles((0.01, 0.005, 0.0), *START)[-1].duration, beyond[-1].duration)


def two_masses() -> ss.SwitchingFlow:
    """A forced Duffing oscillator that carries a small mass between two walls of its own, both nonlinear, with impacts of the two."""
    ratio, restitution, gap = 0.05, 0.9, 1.0
    pull = lambda y: 0.952**2 * (y[0] - y[1]) + 2 * 0.127 * (y[2] - y[3]) + 0.1 * (y[0] - y[1]) ** 3  # noqa: E731
    own = lambda t, y, n: cos(n.w * t) - y[0] - 2 * 0.02 * y[2] - 0.1 * y[0] ** 3  # noqa: E731
    rates = lambda t, y, n: (y[2], y[3], own(t, y, n) - ratio * pull(y), pull(y))  # noqa: E731

    def hit(t: object, y: tuple[float, ...], n: object) -> tuple[object, ...]:
        both = (1 + restitution) / (1 + ratio) * (y[2] + ratio * y[3])
        return (y[0], y[1], both - restitution * y[2], both - restitution * y[3])

    up, down = ss.Switch(lambda t, y, n: gap - y[1] + y[0], 0, hit), ss.Switch(lambda t, y, n: gap + y[1] - y[0], 0, hit)
    return ss.SwitchingFlow({0: rates}, {0: (up, down)}, lambda n: 2 * math.pi / n.w, {"w": 1.5}, ("x1", "x2", "v1", "v2"))


TIMES = (4.620, 2.100, 3.451 - 2.100, 4.620 - 3.451)  # printed: 0, 2.100, 3.451 and the period


def grazed(start: float, stop: float) -> ss.Special:
    """Where the motion that is left of a broken symmetry grazes one of the walls."""
    flow = two_masses()
    guess = ss.dynamics.flow_orbit(flow.replace(w=start), [0.1, 0.0, 0.0, 0.0], 0, settle=60)
    found = ss.continuation(flow, parameter="w", start=start, stop=stop, guess=guess).switched(stop=stop)
    return min((s for s in found.special if s.kind == "grazing"), key=lambda s: s.accuracy)


def duffing_grazing() -> tuple[float, ...]:
    """Period at the grazing below resonance, and the times between hits."""
    special = grazed(1.5, 1.25)
    hits = [c.t for c in special.orbit.events]
    period = 2 * math.pi / special.value
    return (period, hits[2] - hits[1], period - hits[2] + hits[0], hits[1] - hits[0])


def duffing_other() -> tuple[float, ...]:
    """Period at the grazing of the other branch."""
    return (2 * math.pi / grazed(0.7, 1.2).value,)


RIG = {tilt: ss.presets.PAPER_AMPLITUDES[tilt] for tilt in (1.7, 4.7, 2.7, 5.7)}  # inferred


def rig(law: str) -> tuple[float, ...]:
    """Mean velocities of the piezo robot in mm/s on four slopes."""
    robots = (ss.presets.piezo_rig(tilt_deg=tilt, amplitude=A, law=law) for tilt, A in RIG.items())
    return tuple(1e3 * ss.periodic_orbit(robot).mean_velocity for robot in robots)


def rig_of_coulomb() -> tuple[float, ...]:
    """With Coulomb's law."""
    return rig("coulomb-static")


def rig_of_lugre() -> tuple[float, ...]:
    """With LuGre's law."""
    return rig("lugre")


PENDULUM = {"pull": 0.8, "damping": 0.5, "height": 0.2}


def pendulum() -> ss.SwitchingFlow:
    """A pendulum over three magnets on the unit circle; nothing depends on time, and half a unit is between two looks."""

    def rates(t: object, s: tuple[float, ...]) -> tuple[object, ...]:
        x, y, u, v = s
        a, b = -(PENDULUM["pull"] ** 2) * x - PENDULUM["damping"] * u, -(PENDULUM["pull"] ** 2) * y - PENDULUM["damping"] * v
        for turn in (0.0, 2 * math.pi / 3, 4 * math.pi / 3):
            dx, dy = x - math.cos(turn), y - math.sin(turn)
            cube = (dx * dx + dy * dy + PENDULUM["height"] ** 2) ** 1.5
            a, b = a - dx / cube, b - dy / cube
        return (u, v, a, b)

    return ss.SwitchingFlow({0: rates}, {}, 0.5, states=("x", "y", "u", "v"))


def thirds() -> tuple[float, ...]:
    """Shares of the three magnets in the starts from rest within a circle of radius 2, largest first, then of the undecided."""
    side = np.linspace(-2.0, 2.0, 25)
    found = ss.basins(pendulum(), x=side, y=side, u=0.0, v=0.0, settle=140).map.attractor.values[:, :, 0, 0]
    inside = found[np.hypot(*np.meshgrid(side, side, indexing="ij")) <= 2.0]
    shares = sorted((float((inside == i).mean()) for i in range(3)), reverse=True)
    return (*shares, float((inside < 0).mean()))


def pecking() -> ss.dynamics.PeriodicOrbit:
    """The motion of the woodpecker toy, from the printed state and duration as a guess."""
    return ss.dynamics.flow_orbit(woodpecker(), LEINE, "free", duration=PECK)


def pecks() -> tuple[float, ...]:
    """Its period; velocity and angle of the bird where the sleeve has the printed angle."""
    orbit = pecking()
    state = crossing(orbit, 0, LEINE[0], "free")[1]
    return (orbit.duration, float(state[2]), float(state[1]))


def pecks_fast() -> tuple[float, ...]:
    """The rates of both angles there."""
    return tuple(crossing(pecking(), 0, LEINE[0], "free")[1][3:].tolist())


SICONOS = (0.145981186, 0.019445404)  # its first passages of the bird through -0.2788 rad: time and height between them


def pecks_down() -> tuple[float, ...]:
    """Period, and height lost in it, of the motion from the state that Siconos begins with."""
    orbit = ss.dynamics.flow_orbit(woodpecker(), [-EDGE, -0.2788, -0.3411, 0.0, -7.4583], "2 down", duration=PECK)
    return (orbit.duration, fallen(orbit))


GHOSH = {"flip": (0.81, 0.3475333988945534), "fold": (0.799, 0.3628362019762544)}  # frequency and forcing as they are printed
GHOSH_SPEEDS = (0.0653039882953620, 0.1240865713379020)
GHOSH_MULTIPLIERS = (-0.4354918489543720, 0.4317851125949386)


def bends() -> tuple[float, ...]:
    """Forcing at the flip and at the fold of the motions that hit a wall every other period."""
    return tuple(bent(kind, w)[1].value for kind, (w, _) in GHOSH.items())


def bends_at() -> tuple[float, ...]:
    """There: speed before the hit, and the other multiplier."""
    orbits = [bent(kind, w)[1].orbit for kind, (w, _) in GHOSH.items()]
    after = [ss.dynamics.passage(o.model, o.state, o.mode, o.duration, switches=1).state[1] for o in orbits]
    others = [min(o.multipliers.real, key=abs) for o in orbits]
    return (*(float(-v / 0.9) for v in after), *map(float, others))


GHOSH_FAR = (0.8498099999999956, 0.3243226716878754)


def far_flip() -> tuple[float, ...]:
    """Forcing at the flip at another frequency, to which the stable motion is followed first."""
    w, start = GHOSH_FAR[0], bent("flip", 0.81)[0].orbits[0]
    there = ss.continuation(every_other(0.81), parameter="w", start=0.81, stop=w, guess=start, period=2).orbits[-1]
    branch = ss.continuation(every_other(w), parameter="F", start=0.36, stop=0.32, guess=there, period=2)
    return (next(s.value for s in branch.special if s.kind == "flip"),)


ROWS = {
    "henon": Row("Hénon's map, a 1.4, b .3: largest exponent", "Sprott 2003", (0.41922,), henon, 1e-3),
    "lorenz": Row("Lorenz' flow, 10, 28, 8/3: spectrum", "Sprott 2003", (0.9056, 0.0, -14.5723), lorenz, 3e-3),
    "meissner": Row("Meissner's equation: sum and product of multipliers", "two rotations", meissner_closed(), meissner, 1e-11),
    "den_hartog": Row("forced oscillator with dry friction: F/P at which it stops", "Den Hartog 1930", (stop_border(),), den_hartog, 1e-11),
    "sliding": Row("the same as a flow: P/F at which sliding along v = 0 begins", "Den Hartog 1930", (1 / stop_border(),), sliding, 1e-8),
    "impact": Row("oscillator with a wall: grazing amplitude", "d √((k − ω²)² + (c ω)²)", (grazing(),), impact, 1e-8),
    "pitchfork": Row("Lorenz' flow: r at which its rest loses its symmetry", "closed form", (1.0,), lorenz_pitchfork, 1e-8),
    "resonance": Row("Hénon's map: a and b at which both multipliers are −1", "a = 3(1 − b)²/4", (3.0, -1.0), henon_resonance, 1e-8),
    "cusp": Row("x to p + q x − x³: p and q at which two curves of folds end", "double root", (0.0, 1.0), cusp, 1e-8),
    "belt": Row("block on a belt: period of its cycle", "closed form", (belt_closed(),), belt, 1e-11),
    "leine": Row("Leine's block on a belt: largest x", "Leine, script", (1.135,), set_valued_belt, 2e-3),
    "leine_rounded": Row("the same, rounded by an arctangent: largest x", "Leine, script", (1.067,), rounded_belt, 1e-3),
    "leine_lugre": Row("the same with bristles: x and z of a state of the cycle", "Leine, script", (LUGRE[0], LUGRE[2]), lugre_belt, 1e-5),
    "tang_fold": Row("flow with impacts: μ and duration at the fold of cycles", "Tang, log of COCO", TANG, impact_fold, 1e-5),
    "tang_ends": Row("the same: durations of the two cycles at μ = 0", "Tang, log of COCO", (2.9149, 7.5951), impact_ends, 1e-4),
    "duffing": Row(
        "two masses that hit: period and times between hits at a grazing", "Iklódi, PWSDDE-cont demo", TIMES, duffing_grazing, 1e-2
    ),
    "duffing_other": Row("the same: period at the grazing of the other branch", "Iklódi, PWSDDE-cont demo", (5.980,), duffing_other, 1e-2),
    "pecks": Row("woodpecker toy: period, velocity and bird's angle at a state", "Leine, script", (PECK, LEINE[2], LEINE[1]), pecks, 2e-4),
    "pecks_fast": Row("the same: rates of sleeve and bird there", "Leine, script", LEINE[3:], pecks_fast, 2e-2),
    "pecks_down": Row("the same: period, and height lost in it", "Siconos, reference file", SICONOS, pecks_down, 2e-5),
    "bends": Row(
        "oscillator that hits a wall every other period: forcing at flip and fold",
        "Ghosh and Simpson, VIVID",
        tuple(f for _, f in GHOSH.values()),
        bends,
        1e-8,
    ),
    "bends_at": Row(
        "the same: speeds of the hits, and the other multipliers",
        "Ghosh and Simpson, VIVID",
        GHOSH_SPEEDS + GHOSH_MULTIPLIERS,
        bends_at,
        1e-5,
    ),
    "far_flip": Row("the same: forcing at the flip for ω 0.84981", "Ghosh and Simpson, VIVID", GHOSH_FAR[1:], far_flip, 1e-7),
    "thirds": Row("pendulum over three magnets: shares, and undecided", "symmetry", (1 / 3, 1 / 3, 1 / 3, 0.0), thirds, 0.05),
    "rig": Row("robot on four slopes, Coulomb: mean velocity in mm/s", "founding paper, 4.2", (2.0, 4.0, 3.8, 28.7), rig_of_coulomb, 0.05),
    "rig_lugre": Row("the same with LuGre's law", "founding paper, 4.2", (1.8, 3.7, 3.7, 28.1), rig_of_lugre, 0.05),
}


def line(row: Row) -> str:
    """A row of the table, and whether ours is near enough."""
    ours = row.ours()
    worst = max(abs(a - b) for a, b in zip(row.known, ours, strict=True))
    known, mine = (", ".join(f"{v:.12g}" for v in values) for values in (row.known, ours))
    return f"| {row.system} | {row.source} | {known} | {mine} | {worst:.1g} | {row.within:g} |"


if __name__ == "__main__":
    for name in sys.argv[1:] or ROWS:
        print(line(ROWS[name]), flush=True)
