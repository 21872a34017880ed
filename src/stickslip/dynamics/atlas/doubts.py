"""Where an atlas is not sure of its motions, and why: in words, empty where nothing speaks against them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from stickslip.dynamics.atlas.changes_between_neighbours import Change, changes, crosses, passed_by
from stickslip.dynamics.atlas.motions_on_the_grid import PointOfGrid
from stickslip.dynamics.atlas.parameter_plane import Cell, Plane

if TYPE_CHECKING:
    from stickslip.dynamics.atlas.borders_followed import Border, PointOfBorder

__all__ = ["doubt_at", "doubts_of", "explained_by", "unseen_share"]

_CONFIDENCE = 0.95


def explained_by(plane: Plane, borders: Iterable[Border], points: Iterable[PointOfBorder], left: list[Change]) -> set[Change]:
    """The changes between whose neighbours something passes that was found."""
    done: set[Change] = set()
    for border in borders:
        done |= passed_by(plane, np.array(border.values), left)
    return done | {change for change in left for point in points if point.stable and _between(plane, change, point)}


def _between(plane: Plane, change: Change, point: PointOfBorder) -> bool:
    """Whether a special point lies between two neighbours, on the line of the grid that joins them."""
    low, high = change.range(plane)
    return point.values[1 - change.axis] == plane.point(change.near)[1 - change.axis] and low <= point.values[change.axis] <= high


def doubts_of(
    plane: Plane, grid: Mapping[Cell, PointOfGrid], borders: Iterable[Border], points: Iterable[PointOfBorder]
) -> dict[Cell, str]:
    """The points of a grid at which motions may be missing or may be no motions of their own, with the reason."""
    left = changes(plane, grid)
    unexplained = set(left) - explained_by(plane, borders, points, left)
    beside = {cell for change in unexplained for cell in (change.near, change.far)}
    told = {cell: "; ".join(_reasons(point, cell in beside)) for cell, point in grid.items() if point.motions}
    return {cell: why for cell, why in told.items() if why}


def _reasons(point: PointOfGrid, unexplained: bool) -> list[str]:
    told = {
        "a motion without a period is irregular or has not settled": any(not motion.period for motion in point.motions),
        "a motion came from a neighbour and from no start, so others may be missing": any(not motion.hits for motion in point.motions),
        "a start led nowhere": point.lost > 0,
        "a neighbour has other motions, and no border between was located": unexplained,
    }
    return [why for why, holds in told.items() if holds]


def doubt_at(
    plane: Plane, grid: Mapping[Cell, PointOfGrid], doubts: Mapping[Cell, str], borders: Iterable[Border], here: tuple[float, float]
) -> str:
    """Why the motions at a place are not sure: it is judged by the corners of its cell that no border separates from it."""
    lines = [border.values for border in borders]
    corners = [cell for cell in _corners(plane, here) if cell in grid and grid[cell].motions]
    free = [cell for cell in corners if not any(crosses(line, plane.point(cell), here) for line in lines)]
    if not free:
        return "a border separates it from every corner of its cell"
    if len({grid[cell].words for cell in free}) > 1:
        return "corners of its cell have different motions, and no border between was located"
    return next((doubts[cell] for cell in free if cell in doubts), "")


def _corners(plane: Plane, here: tuple[float, float]) -> list[Cell]:
    first, second = (
        {max(int(np.searchsorted(axis, value)) - 1, 0), min(int(np.searchsorted(axis, value)), len(axis) - 1)}
        for axis, value in zip(plane.axes, here, strict=True)
    )
    return [(i, j) for i in sorted(first) for j in sorted(second)]


def unseen_share(starts: int) -> float:
    """The largest share of the starts that a motion may attract which none of them reached, at 95 % confidence.

    Examples
    --------
    >>> round(unseen_share(5), 2), round(unseen_share(59), 3)
    (0.45, 0.05)
    """
    return 1.0 - float((1.0 - _CONFIDENCE) ** (1.0 / starts))
