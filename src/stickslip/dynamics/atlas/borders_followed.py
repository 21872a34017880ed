"""From a motion on the grid to what borders it: a branch across the plane, its special points, and their curves in both numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError, SolveError
from stickslip.dynamics.atlas.changes_between_neighbours import Change, Seed, smooth
from stickslip.dynamics.atlas.parameter_plane import Plane
from stickslip.dynamics.continuation.branches import Branch, continuation
from stickslip.dynamics.continuation.special_points.accuracy import Special, certain
from stickslip.dynamics.continuation.two_parameters import Curve, special_curve
from stickslip.models.model_adapter import adapter_of

_MEANING = {"flip": "a multiplier of -1: the period doubles", "fold": "a multiplier of 1: the motion ends, or turns back unstable"}
_USUAL, _LONG = 0.02, 0.25  # first steps of a branch across the plane, and of one to the next neighbour
_SAME = 1e-6  # of the plane: special points nearer to one another are one


@dataclass(frozen=True)
class PointOfBorder:
    """A special point of the plane.

    Parameters
    ----------
    kind : str
        That of a `Special`, such as "fold" or "grazing", or of a point on a curve, such as "cusp" or "triple-point".
    values : (float, float)
        The two numbers there.
    accuracy : (float, float)
        By how much each may be wrong; 0 of the number at which a branch was followed.
    change : str
        What changes there.
    stable : bool
        Whether the motion beside it attracts, so that what changes there can be seen.
    """

    kind: str
    values: tuple[float, float]
    accuracy: tuple[float, float]
    change: str = ""
    stable: bool = True

    def __repr__(self) -> str:
        at = ", ".join(certain(value, unsure) for value, unsure in zip(self.values, self.accuracy, strict=True))
        return f"<{self.kind} at ({at}), accuracy {max(self.accuracy):.1g}{f': {self.change}' if self.change else ''}>"


@dataclass(frozen=True)
class Border:
    """A border between motions, as a curve in the two numbers.

    Parameters
    ----------
    kind : str
        What its points are, as of the `Special` that it was followed from: "flip", "fold", "type-border" and others.
    values : tuple of (float, float)
        Its points in order.
    accuracy : tuple of (float, float)
        By how much they may be wrong, across the curve.
    change : str
        What changes there.
    special : tuple of PointOfBorder
        Where it meets another border.
    ended : (str, str)
        Why it ends where it ends, at either end.
    """

    kind: str
    values: tuple[tuple[float, float], ...]
    accuracy: tuple[tuple[float, float], ...]
    change: str
    special: tuple[PointOfBorder, ...]
    ended: tuple[str, ...]

    @cached_property
    def line(self) -> Array:
        """A smooth line through its points: array (points, 2)."""
        return smooth(np.array(self.values))

    def distance(self, values: ArrayLike, spans: Any) -> float:
        """Distance of a place from a smooth line through its points, each number counted in its span."""
        return float(np.min(np.linalg.norm((self.line - values) / spans, axis=1)))

    def __repr__(self) -> str:
        return f"<Border: {self.kind}, {len(self.values)} points{f', {self.change}' if self.change else ''}>"


@dataclass(frozen=True)
class FollowedBranch:
    """A branch across the plane: along which number, where the other one stays, and its motions.

    Parameters
    ----------
    parameter : str
        The number along which it was followed.
    other : float
        The value at which the other number stays.
    period : int
        Drive periods after which its motions repeat.
    values, mean_velocity, largest_multiplier : tuple of float
        The number, V [m/s] (NaN of flows), and the size of the largest multiplier along it.
    ended : str
        The reason why it ends.
    """

    parameter: str
    other: float
    period: int
    values: tuple[float, ...]
    mean_velocity: tuple[float, ...]
    largest_multiplier: tuple[float, ...]
    ended: str


@dataclass(frozen=True)
class BordersOfBranch:
    """The result of following one motion: its branch, special points, borders, and failures in sentences."""

    branch: FollowedBranch | None = None
    points: tuple[PointOfBorder, ...] = ()
    borders: tuple[Border, ...] = ()
    refused: tuple[str, ...] = field(default_factory=tuple)


def follow_borders(
    plane: Plane, seed: Seed, change: Change, wanted: Callable[[PointOfBorder], bool], short: bool = False
) -> BordersOfBranch:
    """Follow a motion along its axis, and the curves of those of its special points that are wanted.

    `short`: only to just beyond the neighbour, and no curves, as of borders that no curve is known for.
    """
    name, across = plane.names[seed.axis], plane.names[1 - seed.axis]
    start, other = plane.point(seed.cell)[seed.axis], plane.point(seed.cell)[1 - seed.axis]
    fixed = {**plane.family.fixed, across: other}
    try:
        branch = continuation(
            plane.family.make, parameter=name, start=start, stop=change.beyond(plane, seed) if short else seed.end,
            period=seed.motion.period, guess=np.array(seed.motion.state), step=_LONG if short else _USUAL, **fixed,
        )  # fmt: skip
    except (SolveError, InputError) as error:
        return BordersOfBranch(refused=(f"{change.words}: {seed.motion.word} could not be followed: {_reason(error)}",))
    points = [_point(seed, special, other, branch) for special in branch.special]
    borders, refused = [], []
    low, high = change.range(plane)
    for special, point in zip(branch.special, points, strict=True):
        if low <= special.value <= high and not short and wanted(point):
            border, why = _border(plane, seed, branch, special, point, across, other)
            borders += [border] if border else []
            refused += [why] if why else []
    return BordersOfBranch(_kept(branch, other), tuple(points), tuple(borders), tuple(refused))


def _kept(branch: Branch, other: float) -> FollowedBranch:
    largest = [float(abs(np.asarray(orbit.multipliers)).max(initial=0.0)) for orbit in branch.orbits]
    V = [float(orbit.mean_velocity) if adapter_of(orbit.model).has_displacement else np.nan for orbit in branch.orbits]
    values = tuple(map(float, branch.values))
    return FollowedBranch(branch.parameter, other, branch.period, values, tuple(V), tuple(largest), branch.ended)


def _point(seed: Seed, special: Special, other: float, branch: Branch) -> PointOfBorder:
    nearest = int(np.argmin(abs(branch.values - special.value)))
    around = branch.orbits[max(nearest - 1, 0) : nearest + 2]
    stable = any(bool(orbit.stable) for orbit in around)
    note = "; ".join(special.orbit.notes) or _MEANING.get(special.kind, "")
    values, unsure = (float(special.value), other), (float(special.accuracy), 0.0)
    return PointOfBorder(special.kind, _in_order(seed.axis, values), _in_order(seed.axis, unsure), note, stable)


def _in_order(axis: int, pair: tuple[float, float]) -> tuple[float, float]:
    """A pair of (number along the branch, other number) in the order of the plane."""
    return pair if axis == 0 else (pair[1], pair[0])


def _border(
    plane: Plane, seed: Seed, branch: Branch, special: Special, point: PointOfBorder, across: str, other: float
) -> tuple[Border | None, str]:
    """The curve of a special point, both ways to the ends of the other axis; or why there is none."""
    axis = plane.axes[1 - seed.axis]
    ways, refused = [], ""
    for end in (float(axis[0]), float(axis[-1])):
        if end != other:
            try:
                ways.append(special_curve(branch, special, across, stop=end))
            except (SolveError, InputError) as error:
                refused = f"a {special.kind} was located on lines of the grid, and not followed in both numbers: {_reason(error)}"
    return (_joined(seed, special, point, ways), refused) if ways else (None, refused)


def _joined(seed: Seed, special: Special, point: PointOfBorder, ways: list[Curve]) -> Border:
    """One curve of the two that leave a point."""
    parts = [(way.values, way.accuracy) for way in ways]
    if len(parts) == 2:
        (a, unsure_a), (b, unsure_b) = parts
        parts = [(np.vstack([a[:0:-1], b]), np.vstack([unsure_a[:0:-1], unsure_b]))]
    values, unsure = ((part if seed.axis == 0 else part[:, ::-1]) for part in parts[0])
    met = [
        PointOfBorder(m.kind, _in_order(seed.axis, m.values), _in_order(seed.axis, m.accuracy), f"a {special.kind} ends at another border")
        for way in ways
        for m in way.special
        if len(m.values) == 2
    ]
    rows, errors = (tuple((float(p), float(q)) for p, q in table) for table in (values, unsure))
    return Border(special.kind, rows, errors, point.change, tuple(met), tuple(way.ended for way in ways))


def _reason(error: Exception) -> str:
    problems = getattr(error, "problems", None)
    reason = str(problems[0] if problems else error)
    return reason.rpartition("; type ss.continuation at each value")[0] or reason


def same_place(plane: Plane, a: tuple[float, float], b: tuple[float, float]) -> bool:
    """Whether two points of the plane are one."""
    spans = [float(np.ptp(axis)) for axis in plane.axes]
    return all(abs(x - y) <= _SAME * span for x, y, span in zip(a, b, spans, strict=True))
