"""Places where an atlas is uncertain of its motions, with the reasons in words; empty where nothing contradicts them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.dynamics.atlas.changes_between_neighbours import Change, crosses, passed_by
from stickslip.dynamics.atlas.levels import ParameterPoint, RefinementLevel, corners_around, corners_of, open_changes
from stickslip.dynamics.atlas.motions_on_the_grid import MotionThere, PointOfGrid, unmatched
from stickslip.dynamics.atlas.parameter_plane import Cell, Plane

if TYPE_CHECKING:
    from stickslip.dynamics.atlas.borders_followed import Border, PointOfBorder

_CONFIDENCE = 0.95
_BESIDE = "a neighbour has other motions, and no border between was located"
_CORNERS, _SEVERAL = 4, 2
_RENAMES = ("type-border", "grazing")
_PROBED = (1 / 6, 1 / 2, 5 / 6)  # of a cell: where it is asked whether places in it are in doubt


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


@dataclass(frozen=True, eq=False)
class UncertainPlaces:
    """Evidence against the motions of an atlas, at its grid points and between them.

    Parameters
    ----------
    levels : tuple of Level
        The grid and its finer levels.
    borders : tuple of Border
    points : tuple of PointOfBorder
        Special points.
    """

    levels: tuple[RefinementLevel, ...]
    borders: tuple[Border, ...]
    points: tuple[PointOfBorder, ...]

    @cached_property
    def of_points(self) -> dict[ParameterPoint, str]:
        """The points at which motions may be missing or may be no motions of their own, with the reason."""
        adjacent = self._next_to_open_changes()
        level = self.levels[-1]
        known = {level.plane.point(cell): _reasons(point) for cell, point in level.points.items() if point.motions}
        reasons = {location: why + [_BESIDE] * (location in adjacent) for location, why in known.items()}
        return {location: "; ".join(why) for location, why in reasons.items() if why}

    def _next_to_open_changes(self) -> set[ParameterPoint]:
        adjacent = set()
        for level, left in open_changes(self.levels):
            unexplained = set(left) - explained_by(level.plane, self.borders, self.points, left)
            adjacent |= {level.plane.point(cell) for change in unexplained for cell in (change.near, change.far)}
        return adjacent

    def free(self, here: ParameterPoint) -> tuple[RefinementLevel, list[Cell]]:
        """The corners of the smallest known cell around a place from which no border separates it, the nearest first."""
        level, corners = corners_around(self.levels, here)
        known = [cell for cell in corners if level.points[cell].motions]
        near = sorted(known, key=lambda cell: self.distance(level.plane.point(cell), here))
        return level, [cell for cell in near if not self.separated(level.plane.point(cell), here)]

    def separated(self, a: ParameterPoint, b: ParameterPoint) -> bool:
        """Whether a border passes between two places."""
        return bool(self._between(a, b))

    def distance(self, a: ParameterPoint, b: ParameterPoint) -> float:
        """The distance of two places, each number counted in its span."""
        axes = self.levels[0].plane.axes
        return float(np.hypot(*((x - y) / np.ptp(axis) for x, y, axis in zip(a, b, axes, strict=True))))

    def at(self, here: ParameterPoint) -> str:
        """Why the motions at a place are not sure: it is judged by the corners of its cell.

        They must have the same motions, or the borders that were followed must explain each difference between two of them.
        """
        level, free = self.free(here)
        if not free:
            return "a border separates it from every corner of its cell"
        if len({level.points[cell].words for cell in free}) > 1:
            return "corners of its cell have different motions, and no border between was located"
        if not self._understood(here):
            return "corners of its cell have different motions, and the borders between do not explain all that changes"
        return next(("; ".join(why) for cell in free if (why := _reasons(level.points[cell]))), "")

    def _understood(self, here: ParameterPoint) -> bool:
        """Whether all corners of a cell have the same motions, or differ by what is between them, for a point within the cell too."""
        level, corners = corners_around(self.levels, here)
        if len(corners) == _CORNERS and len({level.points[cell].words for cell in corners}) == 1:
            return True
        ahead = {cell: self._between(here, level.plane.point(cell)) for cell in corners}
        return all(self._explained(level, a, b, ahead[a] ^ ahead[b]) for a, b in combinations(corners, 2))

    def _explained(self, level: RefinementLevel, a: Cell, b: Cell, expected: set[int]) -> bool:
        """Whether at most one border lies between two corners, as it must by the way over the place, and accounts for what changes."""
        passed = self._between(level.plane.point(a), level.plane.point(b))
        one, other = level.points[a], level.points[b]
        change = unmatched(one, other), unmatched(other, one)
        if passed != expected or len(passed) > 1:
            return False
        return all(_accounts(self.borders[k].kind, *change) for k in passed) if passed else not any(change)

    def _between(self, a: ParameterPoint, b: ParameterPoint) -> set[int]:
        """The borders that pass between two places, by their numbers."""
        return {k for k, border in enumerate(self.borders) if _meets(border.line, a, b) and crosses(border.line, a, b)}

    def cells(self) -> list[Cell]:
        """The cells of the finest level in which some places are in doubt, each by its lowest corner."""
        level = self.levels[-1]
        return [cell for cell in level.cells() if any(self.at(location) for location in _probes(level.plane, cell))]


def _probes(plane: Plane, cell: Cell) -> list[ParameterPoint]:
    (p, q), (r, s) = (plane.point(corner) for corner in (corners_of(cell)[0], corners_of(cell)[-1]))
    return [(p + a * (r - p), q + b * (s - q)) for a in _PROBED for b in _PROBED]


def _accounts(kind: str, before: list[MotionThere], after: list[MotionThere]) -> bool:
    """Whether a border of a kind makes such a difference: a fold one motion more or less, a border of types another name.

    Beyond a flip there may be a cascade, and irregular motion, to the next corner.
    """
    if kind == "fold":
        return len(before) + len(after) == 1
    return kind in _RENAMES and len(before) < _SEVERAL and [m.period for m in before] == [m.period for m in after]


def _meets(line: Any, a: ParameterPoint, b: ParameterPoint) -> bool:
    """Whether a line comes into the rectangle of two places, or jumps across it from one of its points to the next."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    step = np.abs(np.diff(line, axis=0)).max(axis=0, initial=0.0)
    return bool(np.any(np.all((line >= low - step) & (line <= high + step), axis=1)))


def _reasons(point: PointOfGrid) -> list[str]:
    """Why the motions that were found at a point may not be all, or no motions of their own."""
    conditions = {
        "some starts have not settled": point.unsettled > 0,
        "a motion came from a neighbour and from no start, so others may be missing": any(not motion.hits for motion in point.motions),
        "a start led nowhere": point.lost > point.unsettled,
    }
    return [why for why, holds in conditions.items() if holds]


def unseen_share(starts: int) -> float:
    """The largest share of the starts that a motion may attract which none of them reached, at 95 % confidence.

    Examples
    --------
    >>> round(unseen_share(5), 2), round(unseen_share(59), 3)
    (0.45, 0.05)
    """
    return 1.0 - float((1.0 - _CONFIDENCE) ** (1.0 / starts))
