"""Following a branch of periodic orbits by pseudo-arclength: predict along the tangent, correct by Newton across it.

A point of a branch is u = (state, parameter), each coordinate in its own scale. Folds are passed, because the parameter is an
unknown like any other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np

from stickslip.dynamics.continuation.grazing import grazed
from stickslip.dynamics.continuation.one_parameter import Family
from stickslip.dynamics.periodic.newton import Found, newton_within
from stickslip.dynamics.periodic.periodic_orbits import RUNS, PeriodicOrbit
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, strobe_map, with_rests
from stickslip.errors import InputError
from stickslip.sealing import sealed

__all__ = ["SIDE_BY_SIDE", "Path", "Point", "tangent_of"]

Array = Any
_CORNER = 10.0  # how much further than the parameter the state may move across a corner, in scales
_SAME, _LOOKED_BACK = 1e-2, 20  # a point so near, in steps, to the line through so many before it is on the way back
_FLAT = 1e-7  # slopes smaller by so much than others are rounding: central differences know them to some 1e-9
SIDE_BY_SIDE = "such motions lie side by side, each as good as the next (a multiplier is 1), and no single one can be followed"
_SMALL, _PATIENCE = 1e-4, 40  # a step that is small, and how many such steps in a row are taken before it is no use


@sealed
@dataclass(frozen=True, eq=False)
class Point:
    """A point of a branch: where it is in the scaled space (without what the law remembers), its direction there, and the orbit."""

    u: Array
    tangent: Array
    value: float
    orbit: Any
    blur: float = 0.0  # how far its residual may have moved it, in the scaled space
    alone: bool = True  # not one of a family of motions at the same value of the parameter

    @cached_property
    def flip(self) -> float:
        """Product of (1 + multiplier): changes its sign where one passes -1."""
        return float(np.prod(1.0 + np.asarray(self.orbit.multipliers, complex)).real)

    @cached_property
    def unity(self) -> float:
        """Product of (1 - multiplier): changes its sign where one passes 1, at a fold."""
        return float(np.prod(1.0 - np.asarray(self.orbit.multipliers, complex)).real)

    @cached_property
    def turning(self) -> float:
        """Product of (1 - multiplier multiplier) over pairs: changes its sign where a complex pair passes the unit circle."""
        found = np.asarray(self.orbit.multipliers, complex)
        return float(np.prod([1.0 - a * b for a, b in combinations(found, 2)]).real)

    @cached_property
    def half(self) -> float:
        """How far v moves in half the period, of several bodies all coordinates.

        It changes its sign where a doubled motion falls together with its two halves.
        """
        orbit, at = self.orbit, coordinates(self.orbit.model)
        moved = strobe_map(orbit.model, orbit.strobe_state, orbit.period // 2, orbit.rtol).state[0] - orbit.strobe_state
        if at.mechanics is None:
            return float(moved[0])
        share = np.linspace(1.0, 2.0, at.smooth)  # of all: the first body may rest on the strobe
        return float(share @ (moved / at.scales)[: at.smooth])

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

    @property
    def scales(self) -> Array:
        """Sizes of the coordinates of a point, but the parameter's."""
        return self.at.scales[: self.at.smooth]

    def value(self, u: Array) -> Any:
        """The parameter at a point."""
        return self.origin + self.span * u[..., -1]

    def scaled(self, orbit: Any, value: float) -> Array:
        """The point u of an orbit."""
        return np.append(orbit.strobe_state[: self.at.smooth] / self.scales, (value - self.origin) / self.span)

    def remembered(self, orbit: Any) -> Array:
        """What the law remembers on the strobe of an orbit."""
        return orbit.strobe_state[self.at.smooth :]

    def ends(self, U: Array, memory: Array) -> Array:
        """The states after the period."""
        states = np.hstack([U[:, :-1] * self.scales, np.broadcast_to(memory, (len(U), len(memory)))])
        return strobe_map(self.family.robots(self.value(U)), states, self.period, self.rtol).state

    def misses(self, U: Array, memory: Array) -> Array:
        """How far each state is from itself after the period, in its scales."""
        return self.ends(U, memory)[:, : self.at.smooth] / self.scales - U[:, :-1]

    def _admissible_misses(self, U: Array, memory: Array) -> Array:
        """The misses; no numbers at points beside the first whose parameter is refused, such as a restitution just below zero."""
        try:
            return self.misses(U, memory)
        except InputError:
            good = np.array([self._is_admissible(u) for u in U])
            if not good[0]:
                raise
        found = np.full((len(U), len(self.scales)), np.nan)
        found[good] = self.misses(U[good], memory)
        return found

    def _is_admissible(self, u: Array) -> bool:
        try:
            self.family.robot(self.value(u))
        except InputError:
            return False
        return True

    def corrected(self, guess: Array, across: Array, memory: Array, reach: float = 0.1) -> Found:
        """The point of the branch in the plane through `guess` across a direction."""

        def problem(memory: Array) -> Any:
            return lambda U: np.column_stack([self._admissible_misses(U, memory), (U - guess) @ across])

        def after(u: Array, memory: Array) -> Array:
            return self.ends(u[None, :], memory)[0, self.at.smooth :]

        return newton_within(problem, after, guess, memory, tolerance=self.tolerance, most=12, reach=reach)

    def at_value(self, guess: Array, value: float, memory: Array) -> Found:
        """The point of the branch at a value of the parameter."""
        return self.corrected(np.append(guess[:-1], (value - self.origin) / self.span), _along_parameter(len(guess)), memory)

    def orbit(self, found: Found) -> Any:
        """The motion at a point."""
        state = np.append(found.at[:-1] * self.scales, found.memory)
        model = self.family.robot(self.value(found.at))
        return PeriodicOrbit(model, self.period, with_rests(model, state, self.period, self.rtol), found.residual, self.rtol)

    def point(self, found: Found, towards: Array) -> Point:
        """A point with its orbit and its direction."""
        tangent = tangent_of(found.jacobian[:-1], towards)
        blur = found.residual / max(float(np.linalg.svd(found.jacobian, compute_uv=False)[-1]), 1e-300)
        sizes = np.linalg.svd(found.jacobian[:-1], compute_uv=False)
        return Point(found.at, tangent, float(self.value(found.at)), self.orbit(found), blur, bool(sizes[-1] > _FLAT * sizes[0]))

    def beyond(self, here: Point) -> tuple[Found, Point, float] | None:
        """The next point where the branch has a corner, such as where a new switch begins: found at a fixed parameter beyond it."""
        ahead = float(np.sign(here.tangent[-1])) * _along_parameter(len(here.u))
        for step in (1e-4, 3e-4, 1e-3, 3e-3):
            found = self.corrected(here.u + step * ahead, ahead, self.remembered(here.orbit))
            if found.good and np.linalg.norm(found.at - here.u) < _CORNER * step:
                return found, self.point(found, found.at - here.u), step
        return None

    def loosened(self) -> Path:
        """The same with tenfold tolerances, of the map and of the runs."""
        return replace(self, rtol=10 * max(self.rtol, RUNS))

    def between(self, a: Point, s: float) -> Point | None:
        """The point that lies s ahead of `a`, along the tangent there."""
        found = self.corrected(a.u + s * a.tangent, a.tangent, self.remembered(a.orbit))
        return self.point(found, a.tangent) if found.good else None


def _along_parameter(n: int) -> Array:
    return np.eye(n)[-1]


def tangent_of(J: Array, towards: Array) -> Array:
    """The direction in which the residual does not change, on the side of `towards`."""
    direction = np.linalg.svd(J)[2][-1]
    return direction * (1.0 if direction @ towards >= 0 else -1.0)


def _apart(u: Array, corners: Array) -> float:
    """How far a point is from the line through these corners."""
    sides = np.diff(corners, axis=0)
    along = np.clip(np.sum((u - corners[:-1]) * sides, axis=1) / np.sum(sides**2, axis=1), 0.0, 1.0)
    return float(np.linalg.norm(u - corners[:-1] - along[:, None] * sides, axis=1).min())


def follow(path: Path, first: Point, step: float, most: int, inside: Callable[[float], bool]) -> Iterator[Point | str]:
    """The points after the first; at the end a sentence that says why it ended."""
    here, largest, name, small = first, 4 * step, path.family.parameters[0], 0
    passed = [first.u]
    for _ in range(most):
        while True:
            try:
                found, why = path.corrected(here.u + step * here.tangent, here.tangent, path.remembered(here.orbit), step), None
            except InputError as error:
                beyond = float(path.value(here.u + 2 * step * here.tangent))
                why = f"it left the admissible region beyond {name} = {here.value:.9g}: {path.family.refusal(error, beyond)}"
                found = None
            if found is not None and found.good and np.linalg.norm(found.at - here.u) < 2 * step:
                point = path.point(found, here.tangent)
                if point.tangent @ here.tangent > 0.8 or step <= _SMALL:
                    break
            step *= 0.5
            if step < 1e-6 and why is None:
                corner = path.beyond(here)
                if corner is not None:
                    found, point, step = corner
                    break
            if step < 1e-6:
                stop = "" if why else grazed(here.orbit)
                if stop:
                    yield (
                        f"the stop {stop} is grazed at {name} = {here.value:.9g}, where hits begin or end, and how this motion goes on was "
                        "not found: it may jump to another one; ss.solve from its state shows to which"
                    )
                    return
                yield why or f"no step was small enough at {name} = {here.value:.9g}: {found.why if found else ''}"
                return
        if not point.alone:
            yield f"at {name} = {point.value:.9g} {SIDE_BY_SIDE}"
            return
        if not inside(point.value):
            yield point
            yield "it reached the end of the range"
            return
        if len(passed) > 1 and _apart(point.u, np.array(passed)) < _SAME * np.linalg.norm(point.u - here.u):
            yield f"it has a corner at {name} = {here.value:.9g}, and how it goes on there was not found; follow it from the other side"
            return
        yield point
        small = small + 1 if step < _SMALL else 0
        if small > _PATIENCE:
            steepest = abs(np.asarray(point.orbit.multipliers)).max()
            yield (
                f"its last {small} steps were below {_SMALL:g} of the range, at {name} = {point.value:.9g}: "
                f"the motion changes abruptly there (largest multiplier {steepest:.3g}); follow it from the other side"
            )
            return
        step = min(largest, step * (1.5 if found.iterations <= 3 else 1.0 if found.iterations <= 6 else 0.6))
        here = point
        passed = [*passed[1 - _LOOKED_BACK :], here.u]
    yield f"it was followed for {most} points"
