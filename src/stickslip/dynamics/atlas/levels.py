"""The grid of an atlas and its finer levels: cells in which places are in doubt are halved, again and again."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from stickslip.dynamics.atlas.changes_between_neighbours import Change, changes
from stickslip.dynamics.atlas.motions_on_the_grid import PointOfGrid
from stickslip.dynamics.atlas.parameter_plane import Cell, Plane

ParameterPoint = tuple[float, float]


@dataclass(frozen=True, eq=False)
class RefinementLevel:
    """Points of a grid, each of whose cells may be divided at the next level.

    Parameters
    ----------
    plane : Plane
        The grid; of the first level that of the atlas, of every further one the same with halved cells.
    points : dict of PointOfGrid
        What is known, with the points of the coarser levels.
    """

    plane: Plane
    points: dict[Cell, PointOfGrid]

    def halved(self) -> RefinementLevel:
        """The next level, as long as nothing new is known there."""
        return RefinementLevel(self.plane.halved, {(2 * i, 2 * j): point for (i, j), point in self.points.items()})

    def cells(self) -> Iterator[Cell]:
        """The cells all of whose corners are known, each by its lowest corner."""
        return (cell for cell in sorted(self.points) if all(corner in self.points for corner in corners_of(cell)))


def corners_of(cell: Cell) -> tuple[Cell, ...]:
    """The corners of a cell, by its lowest one.

    Examples
    --------
    >>> corners_of((0, 2))
    ((0, 2), (0, 3), (1, 2), (1, 3))
    """
    i, j = cell
    return ((i, j), (i, j + 1), (i + 1, j), (i + 1, j + 1))


def points_within(cell: Cell) -> set[Cell]:
    """The points at the next level that halve a cell: its middle and those of its sides.

    Examples
    --------
    >>> sorted(points_within((0, 1)))
    [(0, 3), (1, 2), (1, 3), (1, 4), (2, 3)]
    """
    i, j = 2 * cell[0] + 1, 2 * cell[1] + 1
    return {(i, j), (i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)}


def corners_around(levels: tuple[RefinementLevel, ...], here: ParameterPoint) -> tuple[RefinementLevel, list[Cell]]:
    """The smallest cell around a place all of whose corners are known: its level and its corners; of the first level those that are."""
    for level in reversed(levels):
        corners = _around(level.plane, here)
        if all(cell in level.points for cell in corners):
            return level, corners
    first = levels[0]
    return first, [cell for cell in _around(first.plane, here) if cell in first.points]


def _around(plane: Plane, here: ParameterPoint) -> list[Cell]:
    first, second = (
        {max(int(np.searchsorted(axis, value)) - 1, 0), min(int(np.searchsorted(axis, value)), len(axis) - 1)}
        for axis, value in zip(plane.axes, here, strict=True)
    )
    return [(i, j) for i in sorted(first) for j in sorted(second)]


def open_changes(levels: tuple[RefinementLevel, ...]) -> Iterator[tuple[RefinementLevel, list[Change]]]:
    """Neighbours with different motions between which no further point is known, at each level."""
    for level, finer in zip(levels, [*(level.points for level in levels[1:]), {}], strict=True):
        yield level, [change for change in changes(level.points) if tuple(np.add(change.near, change.far)) not in finer]


def shared_upwards(levels: Iterable[RefinementLevel]) -> None:
    """Give every coarser level what finer ones found at its points."""
    ordered = list(levels)
    for coarse, fine in zip(ordered[-2::-1], ordered[:0:-1], strict=True):
        for i, j in coarse.points:
            coarse.points[i, j] = fine.points[2 * i, 2 * j]
