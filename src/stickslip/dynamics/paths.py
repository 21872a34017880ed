"""Following a branch of periodic orbits by pseudo-arclength: predict along the tangent, correct by Newton across it.

A point of a branch is u = (state, parameter), each coordinate in its own scale. Folds are passed, because the parameter is an
unknown like any other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.dynamics.family import Family
from stickslip.dynamics.mapping import Coordinates, strobe_map
from stickslip.dynamics.newton import Found, newton
from stickslip.dynamics.orbits import PeriodicOrbit

__all__ = ["Path", "Point", "tangent_of"]

Array = Any


@dataclass(frozen=True, eq=False)
class Point:
    """A point of a branch: where it is in the scaled space, the branch's direction there, and the orbit."""

    u: Array
    tangent: Array
    value: float
    orbit: PeriodicOrbit

    @cached_property
    def flip(self) -> float:
        """Product of (1 + multiplier): changes its sign where one passes -1."""
        return float(np.prod(1.0 + np.asarray(self.orbit.multipliers, complex)).real)

    @cached_property
    def unity(self) -> float:
        """Product of (1 - multiplier): changes its sign where one passes 1, at a fold."""
        return float(np.prod(1.0 - np.asarray(self.orbit.multipliers, complex)).real)

    @cached_property
    def half(self) -> float:
        """How far v moves in half the period: changes its sign where a doubled motion falls together with its two halves."""
        return float(
            strobe_map(self.orbit.model, self.orbit.state, self.orbit.period // 2, self.orbit.rtol).state[0, 0] - self.orbit.state[0]
        )

    @property
    def fold(self) -> float:
        """The parameter's part of the direction: changes its sign where the branch turns back."""
        return float(self.tangent[-1])


@dataclass(frozen=True, eq=False)
class Path:
    """What stays the same along a branch."""

    family: Family
    period: int
    at: Coordinates
    origin: float
    span: float
    rtol: float
    tolerance: float

    def unscaled(self, u: Array) -> tuple[Array, Array]:
        """States and values of the parameter."""
        return u[..., :-1] * self.at.scales, self.origin + self.span * u[..., -1]

    def scaled(self, state: Array, value: float) -> Array:
        """A point u."""
        return np.append(np.asarray(state, float) / self.at.scales, (value - self.origin) / self.span)

    def misses(self, U: Array) -> Array:
        """How far each state is from itself after the period, in its scales."""
        states, values = self.unscaled(U)
        return strobe_map(self.family.robots(values), states, self.period, self.rtol).state / self.at.scales - U[:, :-1]

    def corrected(self, guess: Array, across: Array, reach: float = 0.1) -> Found:
        """The point of the branch in the plane through `guess` across a direction."""

        def residuals(U: Array) -> Array:
            return np.column_stack([self.misses(U), (U - guess) @ across])

        return newton(residuals, guess, self.tolerance, most=12, reach=reach)

    def at_value(self, guess: Array, value: float) -> Found:
        """The point of the branch at a value of the parameter."""
        return self.corrected(self.scaled(guess[:-1] * self.at.scales, value), _along_parameter(len(guess)))

    def point(self, found: Found, towards: Array) -> Point:
        """A point with its orbit and its direction."""
        state, value = self.unscaled(found.at)
        tangent = tangent_of(found.jacobian[:-1], towards)
        return Point(
            found.at, tangent, float(value), PeriodicOrbit(self.family.robot(value), self.period, state, found.residual, self.rtol)
        )

    def between(self, a: Point, s: float) -> Point | None:
        """The point that lies s ahead of `a`, along the tangent there."""
        found = self.corrected(a.u + s * a.tangent, a.tangent)
        return self.point(found, a.tangent) if found.good else None


def _along_parameter(n: int) -> Array:
    return np.eye(n)[-1]


def tangent_of(J: Array, towards: Array) -> Array:
    """The direction in which the residual does not change, on the side of `towards`."""
    direction = np.linalg.svd(J)[2][-1]
    return direction * (1.0 if direction @ towards >= 0 else -1.0)


def follow(path: Path, first: Point, step: float, most: int, inside: Callable[[float], bool]) -> Iterator[Point | str]:
    """The points after the first; at the end a sentence that says why it ended."""
    from stickslip.errors import InputError

    here, largest, name = first, 4 * step, path.family.parameters[0]
    for _ in range(most):
        while True:
            try:
                found, why = path.corrected(here.u + step * here.tangent, here.tangent, step), None
            except InputError as error:
                found, why = None, f"it left the admissible region beyond {name} = {here.value:.9g}: {error.problems[0]}"
            if found is not None and found.good and np.linalg.norm(found.at - here.u) < 2 * step:
                point = path.point(found, here.tangent)
                if point.tangent @ here.tangent > 0.8 or step <= 1e-4:
                    break
            step *= 0.5
            if step < 1e-6:
                yield why or f"no step was small enough at {name} = {here.value:.9g}: {found.why if found else ''}"
                return
        if not inside(point.value):
            yield point
            yield "it reached the end of the range"
            return
        yield point
        step = min(largest, step * (1.5 if found.iterations <= 3 else 1.0 if found.iterations <= 6 else 0.6))
        here = point
    yield f"it was followed for {most} points"
