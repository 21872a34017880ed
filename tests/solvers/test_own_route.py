"""The judge's own derivation of machines in coordinates of their own, beside that of the engine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import stickslip as ss
from rows import each_row
from stickslip.maths import asinh, atan, cos, cosh, exp, log, maximum, sin, sinh, sqrt, tanh
from stickslip.solvers.plain.jets import coordinates
from stickslip.solvers.plain.own_route import OwnRoute


@dataclass(frozen=True, eq=False)
class Crank(ss.Machine):
    """A slider on a rail that is curved, with a swinging rod on it and a link between its coordinates."""

    coordinates = ("s", "turn")

    def bodies(self):
        pushed = ss.Body(1.3, force=lambda t, x, v: (0.4 * x[1] - 0.1 * v[0], 0.2 * t, 0.3 * x[2]), inertia=0.2)
        return {"slider": ss.Body(0.7, force=lambda t, x, v: (0.1 * v[1], 0.0)), "rod": pushed, "line": ss.Body(0.4)}

    def places(self, t, q):
        s, a = q["s"], q["turn"]
        z = 0.3 * tanh(s) + 0.1 * exp(-s * s) + maximum(0.1 * s, s * s / 9.0)
        return {
            "slider": (s, z),
            "rod": (s + 0.4 * sin(a + s), z - 0.4 * cos(a + s), a + s),
            "line": 0.5 * s**3 + sqrt(2.0 + s) / (1.0 + a**2),
        }

    def forces(self, t, q, u):
        return {"turn": -0.3 * q["s"] * u["turn"]}

    def links(self):
        return {("s", "turn"): ss.Spring(3.0, 0.2, 0.1), ("s", None): ss.Spring(5.0)}


class Metal(Crank):
    """By a kinetic energy that has parts of every degree in the rates."""

    def bodies(self):
        return {}

    def places(self, t, q):
        return None

    def kinetic(self, q, u):
        a, b = u["s"], u["turn"]
        mixed = 0.3 * sin(q["turn"]) * a * b
        return (1.0 + 0.4 * q["s"] ** 2) * a * a + (0.7 + 0.1 * cos(q["s"] * q["turn"])) * b * b + mixed + q["s"] * b + 0.3 * cos(q["turn"])


class Table(Metal):
    """By a matrix of inertia."""

    def kinetic(self, q, u):
        return None

    def inertia(self, q):
        mixed = 0.3 * sin(q["turn"] + q["s"])
        return ((2.0 + q["s"] ** 2, mixed), (mixed, 1.0 + 0.1 * cos(q["turn"]) * q["s"]))


@each_row("machine", [Crank(), Metal(), Table()], ids=["places", "kinetic energy", "matrix"])
def test_two_ways_to_derive_one_motion_agree(machine):
    """Accelerations at 100 random states, each a sum of some tens of products: 1e-12 of the largest."""
    own, engine = OwnRoute(machine.mechanics), machine.mechanics
    for q, u in np.random.default_rng(20261129).uniform(-1.5, 1.5, (100, 2, 2)):
        there, here = (of.accelerations(0.3, tuple(q), tuple(u), ()) for of in (engine, own))
        assert np.allclose(here, there, rtol=0, atol=1e-12 * max(1.0, *map(abs, there)))


@each_row("f", [
    lambda x, y: asinh(x * y) / (2.0 + cosh(y)), lambda x, y: log(2.0 + x) * sinh(y) - x, lambda x, y: (2.0 + x) ** y + 2.0**x,
    lambda x, y: 3.0 - atan(x - y) ** 3.0, lambda x, y: 1.0 / (3.0 + x) ** 2 + abs(y) ** 1.5,
])  # fmt: skip
def test_slopes_and_rates_are_those_of_differences(f):
    """Central differences of step 1e-4: their error is 1e-8 of third and fourth derivatives of size one, and rounding 1e-8."""
    (x, y), (u, v), h = (0.4, -0.7), (1.2, 0.5), 1e-4
    jet, at = f(*coordinates([x, y], [u, v])), lambda a, b: f(float(a), float(b))
    assert np.isclose(jet.value, at(x, y), rtol=1e-14)
    slopes = [(at(x + h, y) - at(x - h, y)) / (2 * h), (at(x, y + h) - at(x, y - h)) / (2 * h)]
    ahead, back = at(x + h * u, y + h * v), at(x - h * u, y - h * v)
    assert np.allclose([*jet.slopes, jet.rate], [*slopes, (ahead - back) / (2 * h)], rtol=0, atol=1e-6)
    assert np.isclose(jet.second, (ahead - 2 * jet.value + back) / h**2, rtol=0, atol=1e-6)
