"""Numbers that must not fall below others, as static friction below kinetic, and coordinates of a search that never propose it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Numeric
from stickslip.basics.fields import leaves
from stickslip.inverse.identification.friction_effects import floors

_TRIED = 256  # points among which one that makes a model is looked for
_CHECKED = 16  # points at which what is even in the numbers is checked
_AWAY = 0.01  # between the bounds: how far a number is moved to see what it does
_EVEN = 1e-9  # by which part of the largest coefficient a number may differ from what is even in the numbers


@dataclass(frozen=True, eq=False)
class Limits:
    r"""Rows of :math:`G v + c \ge 0` that the free values v must obey besides their bounds.

    A search moves coordinates between 0 and 1. In the order of the rows' falling, then rising numbers, each runs from the least to the
    greatest value which those before it leave: kinetic friction up to where the static one still has room above, static friction from
    the kinetic one on, f = mu + u (most - mu). So every place of such a search is possible, and f/mu = 1 is a bound.

    Parameters
    ----------
    free : tuple of Free
    slopes : array (rows, numbers)
        G.
    rest : array (rows,)
        c.
    """

    free: tuple[Any, ...]
    slopes: Any
    rest: Any

    @property
    def order(self) -> list[int]:
        """The limited numbers in the order in which they are set: those that use up room before those that make it."""
        involved = np.flatnonzero((self.slopes != 0).any(axis=0))
        return [int(k) for k in sorted(involved, key=lambda k: (self.slopes[:, k].max() > 0, k))]

    @property
    def roomy(self) -> Any:
        """The point at which numbers leave the others most room: at the upper bound those that others must stay below, else the middle."""
        return np.where((self.slopes > 0).any(axis=0), 1.0, 0.5)

    def only(self, fixed: dict[str, float]) -> Limits:
        """The same with some of the numbers held."""
        held = np.array([f.name in fixed for f in self.free], bool)
        values = np.array([fixed.get(f.name, 0.0) for f in self.free])
        kept = tuple(f for f in self.free if f.name not in fixed)
        return _that_matter(kept, self.slopes[:, ~held], self.rest + self.slopes @ values)

    def allows(self, point: Array) -> bool:
        """Whether a point between the bounds is possible."""
        return bool((self.slopes @ self._values(point) + self.rest >= 0).all())

    def _values(self, point: Array) -> Any:
        return np.array([float(f.outer(p)) for f, p in zip(self.free, point, strict=False)])

    def point(self, inner: Any) -> Any:
        """The point between the bounds of coordinates of a search; what comes after the free numbers stays."""
        return self._moved(inner)[0] if len(self.slopes) else inner

    def slopes_of_point(self, inner: Any) -> Any:
        """Derivatives of the point by the coordinates: array (numbers, numbers)."""
        return self._moved(inner)[1]

    def inner(self, point: Array) -> Any:
        """The coordinates of a point; the nearest ones of one that is not possible."""
        if not len(self.slopes):
            return point
        inner, values, done = np.array(point, float), self._values(point), self._at_once()
        for k in self.order:
            low, high = (float(self.free[k].inner(end)) for end, _ in self._range(k, values, done))
            part = (point[k] - low) / (high - low) if high > low else 0.0
            inner[k], done[k] = np.clip(part, 0.0, 1.0), True
            values[k] = float(self.free[k].outer(low + inner[k] * (high - low)))
        return inner

    def _at_once(self) -> Any:
        """Which numbers are set from the start."""
        return ~(self.slopes != 0).any(axis=0)

    def _moved(self, inner: Any) -> tuple[Any, Any]:
        """The point and its derivatives."""
        moved, n = np.array(inner, float), len(self.free)
        values, done, turned = self._values(inner), self._at_once(), np.eye(len(moved))
        by = np.diag([f.slope(p) for f, p in zip(self.free, inner, strict=False)]) @ turned[:n]  # of the values
        for k in self.order:
            f, ends = self.free[k], self._range(k, values, done)
            low, high = (float(f.inner(end)) for end, _ in ends)
            d_low, d_high = (row @ by / f.slope(float(f.inner(end))) for end, row in ends)
            moved[k] = low + inner[k] * (high - low)
            turned[k] = (1 - inner[k]) * d_low + inner[k] * d_high
            turned[k, k] += high - low
            values[k], by[k], done[k] = float(f.outer(moved[k])), f.slope(moved[k]) * turned[k], True
        return moved, turned

    def _range(self, k: int, values: Numeric, done: Any) -> tuple[tuple[float, Any], tuple[float, Any]]:
        """Least and greatest value of a number, whatever those after it will be, each with its derivatives by all values.

        Where the bounds of the others leave none, its own bounds.
        """
        f, none = self.free[k], np.zeros(len(self.free))
        low, high = (f.low, none), (f.high, none)
        later = ~done & (np.arange(len(done)) != k)
        best = np.maximum(self.slopes * [g.low for g in self.free], self.slopes * [g.high for g in self.free])
        room = self.rest + (self.slopes * done) @ values + best @ later
        for row, left in zip(self.slopes, room, strict=True):
            if row[k] > 0:
                low = max(low, (float(-left / row[k]), -row * done / row[k]), key=lambda end: end[0])
            elif row[k] < 0:
                high = min(high, (float(-left / row[k]), -row * done / row[k]), key=lambda end: end[0])
        return (low, high) if low[0] <= high[0] else ((f.low, none), (f.high, none))


def limits_of(of: Any) -> Limits:
    """The limits that laws set to the free parameters (`Parameters`), where they are even in the values.

    Others the search only runs into. A law that takes numbers beyond them has none.
    """
    n = len(of.free)
    none = Limits(of.free, np.empty((0, n)), np.empty(0))
    points = np.random.default_rng(0).uniform(0.0, 1.0, (_TRIED, n))
    base = next((point for point in points if of.models(point) is not None), None)
    if base is None or not len(_room(of, base)):
        return none
    near = [np.clip(np.where(np.arange(n) == k, base + side * _AWAY, base), 0.0, 1.0) for k in range(n) for side in (1, -1)]
    made = [(point, room) for point in [base, *near, *points[:_CHECKED]] if (room := _room(of, point)) is not None]
    columns = np.array([[*of.values(point).values(), 1.0] for point, _ in made])
    rooms = np.array([room for _, room in made])
    size = abs(columns).max(axis=0)
    coefficients, _, rank, _ = np.linalg.lstsq(columns / size, rooms, rcond=1e-12)
    off = abs(columns / size @ coefficients - rooms).max(axis=0)
    even = (off <= _EVEN * np.maximum(abs(coefficients).max(axis=0), 1e-300)) & (rooms >= -_EVEN * abs(coefficients).max(axis=0)).all(
        axis=0
    )
    if rank <= n:
        return none
    coefficients = np.where(abs(coefficients) > _EVEN * abs(coefficients).max(axis=0, initial=0.0), coefficients, 0.0) / size[:, None]
    return _that_matter(of.free, coefficients[:n, even].T, coefficients[n, even])


def _room(of: Any, point: Array) -> Any:
    """How far numbers are above those that they must not fall below, in all records; None where there is no model."""
    models = of.models(point)
    return None if models is None else np.array([room for model in models for room in floors(dict(leaves(model)))])


def _that_matter(free: tuple[Any, ...], slopes: Any, rest: Array) -> Limits:
    """The limits that some values between the bounds would break."""
    least = rest + np.minimum(slopes * [f.low for f in free], slopes * [f.high for f in free]).sum(axis=1)
    size = abs(rest) + abs(slopes * [max(abs(f.low), abs(f.high)) for f in free]).sum(axis=1)
    kept = (least < -_EVEN * size) & (slopes != 0).any(axis=1)
    rows = np.unique(np.concatenate([slopes, rest[:, None]], axis=1)[kept], axis=0)
    return Limits(free, rows[:, :-1], rows[:, -1])
