"""Where neighbours on the grid have different motions: the places that a border must pass."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.dynamics.atlas.motions_on_the_grid import MotionThere, PointOfGrid, unmatched
from stickslip.dynamics.atlas.parameter_plane import Cell, Plane

_SLACK = 0.02  # of a cell: how far beyond its end a border may be found and still be what lies between two neighbours
_BEYOND = 0.1  # of a cell
_FINE = 24  # places between two points of a curve at which it is looked where it passes


class Change(NamedTuple):
    """Two neighbours that do not have the same motions: along which axis they lie, the nearer one, and what each alone has."""

    axis: int
    near: Cell
    before: tuple[str, ...]
    after: tuple[str, ...]

    @property
    def far(self) -> Cell:
        """The neighbour."""
        i, j = self.near
        return (i + 1, j) if self.axis == 0 else (i, j + 1)

    @property
    def words(self) -> str:
        """The changes in words."""
        before, after = (" + ".join(words) for words in sorted((self.before, self.after)))
        return f"{before} and {after}" if before and after else f"{before or after} and none of that name"

    def range(self, plane: Plane) -> tuple[float, float]:
        """The values of its axis between which the border lies, with a little slack."""
        a, b = (plane.point(cell)[self.axis] for cell in (self.near, self.far))
        return a - _SLACK * (b - a), b + _SLACK * (b - a)

    def beyond(self, plane: Plane, seed: Seed) -> float:
        """Where a branch from a seed ends that goes no farther than it must: a little beyond the neighbour."""
        near, far = (plane.point(cell)[self.axis] for cell in ((self.near, self.far) if seed.cell == self.near else (self.far, self.near)))
        axis = plane.axes[self.axis]
        return float(np.clip(far + _BEYOND * (far - near), axis[0], axis[-1]))


class Seed(NamedTuple):
    """A motion from which a branch is followed: along which axis, from which point, towards which end of the axis."""

    axis: int
    cell: Cell
    motion: MotionThere
    end: float


def changes(grid: Mapping[Cell, PointOfGrid]) -> list[Change]:
    """All neighbours on the grid whose motions differ, along the first axis and then along the second."""
    differing = []
    for axis in (0, 1):
        for cell, here in sorted(grid.items()):
            change = Change(axis, cell, (), ())
            there = grid.get(change.far)
            if there is None or here.refused or there.refused:
                continue
            before, after = unmatched(here, there), unmatched(there, here)
            if before or after:
                differing.append(Change(axis, cell, *(tuple(sorted(m.word for m in part)) for part in (before, after))))
    return differing


def seeds_of(plane: Plane, grid: Mapping[Cell, PointOfGrid], change: Change) -> list[Seed]:
    """The motions that may be followed across a change; those with the longer way to the end of the axis come first."""
    axis = plane.axes[change.axis]
    a, b = plane.point(change.near)[change.axis], plane.point(change.far)[change.axis]
    seeds = []
    for cell, other, end, room in (
        (change.near, change.far, float(axis[-1]), axis[-1] - a),
        (change.far, change.near, float(axis[0]), b - axis[0]),
    ):
        seeds += [(room, Seed(change.axis, cell, m, end)) for m in unmatched(grid[cell], grid[other]) if m.period]
    return [seed for _, seed in sorted(seeds, key=lambda item: -item[0])]


def passed_by(plane: Plane, values: Array, todo: Iterable[Change]) -> set[Change]:
    """The changes between whose neighbours a curve of points (points, 2) passes."""
    x, y = smooth(values).T
    passed = set()
    for change in todo:
        along, across = (x, y) if change.axis == 0 else (y, x)
        level, (low, high) = plane.point(change.near)[1 - change.axis], change.range(plane)
        beyond = across - level
        turns = np.flatnonzero((beyond[:-1] <= 0) != (beyond[1:] <= 0))
        touched = np.flatnonzero(abs(beyond) <= _SLACK * np.ptp(plane.axes[1 - change.axis]) / len(plane.axes[1 - change.axis]))
        places = np.concatenate([_crossing(along, beyond, turns), along[touched]])
        if np.any((places >= low) & (places <= high)):
            passed.add(change)
    return passed


def _crossing(along: Array, beyond: Array, turns: Array) -> Array:
    part = beyond[turns] / (beyond[turns] - beyond[turns + 1])
    return along[turns] + part * (along[turns + 1] - along[turns])


def crosses(line: Any, a: tuple[float, float], b: tuple[float, float]) -> bool:
    """Whether a line passes between two points of the plane an odd number of times, on the straight line from one to the other.

    Examples
    --------
    >>> crosses([(0.0, 0.0), (1.0, 1.0)], (0.2, 0.8), (0.8, 0.2)), crosses([(0.0, 0.0), (1.0, 1.0)], (0.2, 0.8), (0.3, 0.8))
    (True, False)
    """
    ahead = np.asarray(line, float) - np.asarray(a)
    along = np.asarray(b) - np.asarray(a)
    side = ahead[:, 1] * along[0] - ahead[:, 0] * along[1]
    turns = np.flatnonzero((side[:-1] < 0) != (side[1:] < 0))
    if not along.any() or not len(turns):
        return False
    k = int(np.argmax(abs(along)))
    places = _crossing(ahead[:, k], side, turns) / along[k]
    return bool(np.count_nonzero((places >= 0) & (places <= 1)) % 2)


def smooth(values: Array) -> Array:
    """A smooth line through the points of a curve: array (points, 2)."""
    from scipy.interpolate import CubicSpline

    scaled = values / np.maximum(np.ptp(values, axis=0), 1e-300)
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(scaled, axis=0), axis=1))])
    kept = np.concatenate([[True], np.diff(s) > 0])
    if kept.sum() < 3:
        return values
    fine = np.unique(np.concatenate([np.linspace(a, b, _FINE) for a, b in zip(s[kept][:-1], s[kept][1:], strict=True)]))
    return np.asarray(CubicSpline(s[kept], values[kept])(fine))
