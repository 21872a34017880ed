"""Answers of nonlinear dynamics that are known, by the public functions: the table of docs/known-answers.md.

``python verification/known_answers.py`` prints its rows; with names of rows only those.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

import stickslip as ss
from stickslip.maths import cos, where


class Row(NamedTuple):
    """A system with what is known of it: where that is printed, or its closed form; the numbers, ours, and how far they may differ."""

    system: str
    source: str
    known: tuple[float, ...]
    ours: Callable[[], tuple[float, ...]]
    within: float


def henon() -> tuple[float, ...]:
    """Largest exponent of a million iterations."""
    found = ss.lyapunov_of_map(lambda x: (1 - 1.4 * x[0] * x[0] + x[1], 0.3 * x[0]), [0.1, 0.1], iterations=1_000_000)
    return (found.largest,)


def lorenz() -> tuple[float, ...]:
    """The three exponents over 20 000 units of time."""
    flow = ss.SwitchingFlow({0: lambda t, y: (10 * (y[1] - y[0]), y[0] * (28 - y[2]) - y[1], y[0] * y[1] - 8 / 3 * y[2])})
    return tuple(ss.lyapunov_of_flow(flow, [1.0, 1.0, 1.0], duration=20_000.0).spectrum.tolist())


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
    curve = ss.special_curve(branch, branch.special[0], "b", stop=-1.2)
    return next(met.values for met in curve.special if met.kind == "R2")


def cusp() -> tuple[float, ...]:
    """Where the two curves of folds of x to p + q x - x^3 end."""
    flow = ss.SwitchingFlow.of_map(lambda y, n: (n.p + n.q * y[0] - y[0] ** 3,), {"p": -0.5, "q": 1.3}, ("x",))
    branch = ss.continuation(flow, parameter="p", start=-0.5, stop=0.3, guess={"x": -0.9})
    curve = ss.special_curve(branch, next(s for s in branch.special if s.kind == "fold"), "q", stop=0.5)
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
