"""Points of a branch of periodic orbits by pseudo-arclength: a guess along the tangent, corrected by Newton's method across it.

A point of a branch is u = (state, parameter), each coordinate in its own scale. Folds are passed, because the parameter is an
unknown like any other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.dynamics.continuation.following.arclength import in_plane, tangent_of
from stickslip.dynamics.continuation.one_parameter import Family
from stickslip.dynamics.derivatives.tangents import Directions, changes_along, jacobians_of, not_followed
from stickslip.dynamics.periodic.closed_orbits import RUNS, PeriodicOrbit
from stickslip.dynamics.periodic.newton import STEP, Root, newton_within, slopes_at
from stickslip.dynamics.periodic.periodic_orbits import orbit_through
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, flight, state_at, strobe_map
from stickslip.models.model_adapter import adapter_of

_CORNER = 10.0  # how much further than the parameter the state may move across a corner, in scales
_SAME_WAY = 1.0 - 1e-4  # cosine of directions that are one: a branch has a curvature
_FLAT = 1e-7  # slopes smaller by so much than others are rounding: central differences know them to some 1e-9
_REACH = 1e-4  # of differences of fourth order
_JUMPS = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2)  # how far corners are jumped across


@sealed
class Point:
    """A point of a branch: where it is in the scaled space (without what the law remembers), its direction there, and the orbit."""

    u: Array
    tangent: Array
    value: float
    orbit: Any
    blur: float = 0.0  # how far its residual may have moved it, in the scaled space
    alone: bool = True  # not one of a family of motions at the same value of the parameter
    crossing: float = 1.0  # determinant of the slopes beside the direction: changes its sign at a branch point, and not at a fold

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
        multipliers = np.asarray(self.orbit.multipliers, complex)
        return float(np.prod([1.0 - a * b for a, b in combinations(multipliers, 2)]).real)

    @cached_property
    def half(self) -> Array:
        """How far the state moves in half the period, in scales.

        It passes zero, and so turns round, where a doubled motion falls together with its two halves.
        """
        orbit, at = self.orbit, coordinates(self.orbit.model)
        moved = strobe_map(orbit.model, orbit.strobe_state, orbit.period // 2, orbit.rtol).state[0] - orbit.strobe_state
        return np.asarray(moved[: at.smooth] / at.scales[: at.smooth])

    @property
    def fold(self) -> float:
        """The parameter's part of the direction: changes its sign where the branch turns back."""
        return float(self.tangent[-1])


@dataclass(frozen=True, eq=False)
class Path:
    """Constants of a branch."""

    family: Family
    period: int
    at: Coordinates
    origin: Any
    span: Any
    rtol: float
    tolerance: float

    @property
    def scales(self) -> Array:
        """Sizes of the coordinates of a point, but the parameters'."""
        return self.at.scales[: self.at.smooth]

    def values(self, u: Array) -> Array:
        """The parameters at points, one column each: a branch has one, a curve of special points two."""
        return np.asarray(self.origin + self.span * u[..., self.at.smooth :])

    def value(self, u: Array) -> Any:
        """The one parameter at a point."""
        return self.values(u)[..., 0]

    def inner(self, orbit: PeriodicOrbit) -> Array:
        """The unknowns of an orbit besides the parameters."""
        return np.asarray(orbit.strobe_state[: self.at.smooth] / self.scales)

    def later(self, orbit: PeriodicOrbit) -> Array:
        """The same unknowns half a motion period later."""
        return np.asarray(state_at(orbit.run, 0.5 * self.period * float(orbit.model.period)) / self.scales)

    def scaled(self, orbit: Any, value: Any) -> Array:
        """The point u of an orbit."""
        return np.append(self.inner(orbit), (np.asarray(value) - self.origin) / self.span)

    def robot(self, u: Array) -> Any:
        """The robot at a point."""
        return self.family.robot(*self.values(u))

    def robots(self, U: Array) -> Any:
        """The robots at many points, as one batch."""
        return self.family.robots(*self.values(U).T)

    def remembered(self, orbit: PeriodicOrbit) -> Array:
        """The law's memory on the strobe of an orbit."""
        return orbit.strobe_state[self.at.smooth :]

    def ends(self, U: Array, memory: Array) -> Array:
        """The states after the period."""
        states = np.hstack([U[:, : self.at.smooth] * self.scales, np.broadcast_to(memory, (len(U), len(memory)))])
        return strobe_map(self.robots(U), states, self.period, self.rtol).state

    def misses(self, U: Array, memory: Array) -> Array:
        """How far each state is from itself after the period, in its scales."""
        return self.missed(self.ends(U, memory), U)

    def missed(self, ends: Array, U: Array) -> Array:
        """Residuals of states; positions on a track with a wavelength are compared modulo it."""
        ends, begun = ends[..., : self.at.smooth], U[..., : self.at.smooth]
        if not self.at.comes_again:  # the difference of numbers in scales keeps a digit more
            return ends / self.scales - begun
        return self.at.difference(ends, begun * self.scales) / self.scales

    def returned(self, J: Array) -> Array:
        """The derivative of the map whose fixed points the motions are, from those of what is missed by the inner unknowns."""
        return J + np.eye(self.at.smooth)

    def numbers(self, guess: Array) -> dict[str, float] | None:
        """Derivatives of the machine's numbers by the parameter beside a point; None where small changes are not followed."""
        return self.family.slopes(float(self.value(guess))) if self._followed else None

    def slopes(self, u: Array, memory: Array, by_value: dict[str, float]) -> tuple[Array, Array]:
        """The residual of one state, and its derivatives by the state and the parameter."""
        model, d = self.robot(u), len(self.scales)
        starts = np.vstack([np.diag(self.scales), np.zeros((1, d))])
        numbers = {name: np.append(np.zeros(d), slope * self.span) for name, slope in by_value.items()}
        states = np.tile(np.append(u[:-1] * self.scales, memory), (d + 1, 1))
        changes = changes_along(model, states, starts, self.period, Directions(numbers, self.rtol))
        return self.missed(changes.state[0], u), (changes.change / self.scales).T - np.eye(d, d + 1)

    def derivative(self, u: Array, memory: Array, by_value: dict[str, float] | None, step: float = STEP) -> tuple[Array, Array]:
        """The residual of one state, and its derivatives by all unknowns: exact if `by_value` is known, else by differences."""
        if by_value is None:
            return slopes_at(lambda U: self._admissible_misses(U, memory), u, step)
        return self.slopes(u, memory, by_value)

    @property
    def has_tolerance(self) -> bool:
        """Whether runs have a tolerance, or are exact to rounding."""
        first = self.family.robot(*np.atleast_1d(self.origin))
        return adapter_of(first).has_tolerance

    @cached_property
    def _followed(self) -> bool:
        """Whether changes of the state are followed along the runs, as they are in lanes."""
        first = self.family.robot(*np.atleast_1d(self.origin))
        return self.at.in_lanes and not not_followed(first)

    def derivatives(self, U: Array, memory: Array, worse: bool = False) -> tuple[Array, Array]:
        """Residuals of states, and their derivatives by the inner unknowns, in one batch; by differences if that fails.

        There are no numbers where what the law remembers on the strobe changes.
        """
        if not self._followed:
            return self.differences(U, memory, worse)
        path = self.loosened() if worse else self
        ends, states = path.ends(U, memory), np.hstack([U[:, : self.at.smooth] * self.scales, np.tile(memory, (len(U), 1))])
        jacobian = jacobians_of(self.robots(U), states, self.period, path.rtol) * self.scales / self.scales[:, None]
        return self.missed(self._held(ends, memory), U), jacobian - np.eye(self.at.smooth)

    def differences(self, U: Array, memory: Array, worse: bool = False, by: slice | None = None) -> tuple[Array, Array]:
        """The same by differences of fourth order; by the inner unknowns, or by others."""
        step, along = _REACH * (2.0 if worse else 1.0), np.eye(U.shape[1])[slice(self.at.smooth) if by is None else by]
        n, shifts = len(along), step * np.vstack([0.0 * along[:1], *(k * along for k in (1.0, -1.0, 2.0, -2.0))])
        tried = np.repeat(U, len(shifts), axis=0) + np.tile(shifts, (len(U), 1))
        missed = self.missed(self._held(self.ends(tried, memory), memory), tried).reshape(len(U), len(shifts), -1)
        near, far = (missed[:, k : k + n] - missed[:, k + n : k + 2 * n] for k in (1, 1 + 2 * n))
        return missed[:, 0], np.swapaxes(8.0 * near - far, 1, 2) / (12.0 * step)

    def _held(self, ends: Array, memory: Array) -> Array:
        """States at ends; no numbers where what the law remembers has changed."""
        same = np.all(ends[:, self.at.smooth :] == memory, axis=1)
        return np.where(same[:, None], ends, np.nan)

    def _admissible_misses(self, U: Array, memory: Array) -> Array:
        """The misses; no numbers at points beside the first whose parameter is refused, such as a restitution just below zero."""
        try:
            return self.misses(U, memory)
        except InputError:
            good = np.array([self.family.made(*self.values(u)) is not None for u in U])
            if not good[0]:
                raise
        misses = np.full((len(U), len(self.scales)), np.nan)
        misses[good] = self.misses(U[good], memory)
        return misses

    def corrected(self, guess: Array, across: Array, memory: Array, reach: float = 0.1, most: int = 12) -> Root:
        """The point of the branch in the plane through `guess` across a direction."""

        def problem(memory: Array) -> Any:
            return in_plane(lambda U: self._admissible_misses(U, memory), guess, across)

        by_value = self.numbers(guess)

        def slopes(memory: Array) -> Any:
            def at_point(u: Array) -> tuple[Array, Array]:
                missed, J = self.slopes(u, memory, by_value)  # type: ignore[arg-type]
                return np.append(missed, (u - guess) @ across), np.vstack([J, across])

            return at_point

        def after(u: Array, memory: Array) -> Array:
            return self.ends(u[None, :], memory)[0, self.at.smooth :]

        exact = None if by_value is None else slopes
        return newton_within(problem, after, guess, memory, exact, tolerance=self.tolerance, most=most, reach=reach)

    def at_value(self, guess: Array, value: float, memory: Array) -> Root:
        """The point of the branch at a value of the parameter."""
        return self.corrected(np.append(guess[:-1], (value - self.origin) / self.span), _along_parameter(len(guess)), memory)

    def orbit(self, root: Root) -> Any:
        """The motion at a point."""
        state = np.append(root.at[: self.at.smooth] * self.scales, root.memory)
        return orbit_through(self.at, self.robot(root.at), self.period, state, root.residual, self.rtol)

    def longer_run(self, u: Array, memory: Array) -> tuple[Any, float, float]:
        """A run from a place that goes on for some time after the motion, how long the motion takes, and a period of it."""
        model, state = self.robot(u), np.append(u[: self.at.smooth] * self.scales, memory)
        T = float(model.period)
        return flight(model, state, self.period + 1, self.rtol), self.period * T, T

    def orbit_at(self, u: Array, memory: Array) -> Any:
        """The motion at a place that was found in more unknowns than its own."""
        return self.orbit(Root(u, float(abs(self.misses(u[None, :], memory)).max()), 0, np.empty((0, 0)), True, "", memory))

    def point(self, root: Root, towards: Array) -> Point:
        """A point with its orbit and its direction."""
        J = root.jacobian[:-1]
        tangent = tangent_of(J, towards)
        blur = root.residual / max(float(np.linalg.svd(root.jacobian, compute_uv=False)[-1]), 1e-300)
        sizes = np.linalg.svd(J, compute_uv=False)
        crossing = float(np.linalg.det(np.vstack([J, tangent])))
        return Point(root.at, tangent, float(self.value(root.at)), self.orbit(root), blur, bool(sizes[-1] > _FLAT * sizes[0]), crossing)

    def beyond(self, here: Point, turns: bool = True) -> Iterator[tuple[Root, Point, float]]:
        """Points where the branch may go on behind a corner, such as where a new switch begins.

        They are found at fixed parameters beyond it, and along the directions that the branch has by its slopes on the other side of the
        corner: it may turn back there, if that is asked for.
        """
        ahead, memory = float(np.sign(here.tangent[-1])) * _along_parameter(len(here.u)), self.remembered(here.orbit)
        for step in _JUMPS:
            yield from self._jumped(here, step, ahead, memory)
        for step in _JUMPS if turns else ():
            for direction in self._other_directions(here, step, memory):
                yield from self._jumped(here, step, direction, memory)
                yield from self._jumped(here, step, -direction, memory)

    def _other_directions(self, here: Point, step: float, memory: Array) -> Iterator[Array]:
        """Directions that the branch would have by the slopes at points around one of its points, where they are not its own."""
        for aside in (here.tangent, *np.eye(len(here.u)), *-np.eye(len(here.u))):
            J = self.corrected(here.u + step * aside, here.tangent, memory, most=0).jacobian[:-1]
            direction = tangent_of(J, here.tangent) if np.isfinite(J).all() else here.tangent
            if direction @ here.tangent < _SAME_WAY:
                yield direction

    def _jumped(self, here: Point, step: float, direction: Array, memory: Array) -> Iterator[tuple[Root, Point, float]]:
        root = self.corrected(here.u + step * direction, direction, memory)
        if root.good and np.linalg.norm(root.at - here.u) < _CORNER * step:
            yield root, self.point(root, root.at - here.u), step

    def loosened(self) -> Path:
        """The same with tenfold tolerances, of the map and of the runs."""
        return replace(self, rtol=10 * max(self.rtol, RUNS))

    def between(self, a: Point, s: float) -> Point | None:
        """The point that lies s ahead of `a`, along the tangent there."""
        root = self.corrected(a.u + s * a.tangent, a.tangent, self.remembered(a.orbit))
        return self.point(root, a.tangent) if root.good else None


def _along_parameter(n: int) -> Array:
    return np.eye(n)[-1]
