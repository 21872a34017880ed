"""Branches that leave another one: of twice the period at a flip, and the one that crosses at a branch point."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, SolveError
from stickslip.dynamics.continuation.following.path_kinds import path_of
from stickslip.dynamics.continuation.following.pseudo_arclength import Path, Point
from stickslip.dynamics.continuation.following.traced_branch import BranchTrace, trace_branch
from stickslip.dynamics.continuation.special_points.accuracy import Special
from stickslip.dynamics.continuation.special_points.branch_points import branch_point_near, motions_beside

if TYPE_CHECKING:
    from stickslip.dynamics.continuation.branches import Branch


_ASIDE = 0.01  # how far from a flip its doubled branch is looked for, in scales


def special_point_of(branch: Branch, given: Special | None, kind: str, method: str) -> Special:
    """The special point of a branch that was asked for, or its first of the kind."""
    special = given or next((s for s in branch.special if s.kind == kind), None)
    if special is None or special.kind != kind:
        mistake = f"it is a {special.kind}" if special else f"there is no {kind} on this branch"
        raise InputError(f"Branch.{method}", [f"{mistake}; allowed is one of branch.special whose kind is {kind!r}"])
    return special


def range_of(branch: Branch, special: Special, stop: float | None) -> tuple[float, float]:
    """From where to where a branch that leaves another one is followed: to `stop`, or as far as the other one goes."""
    if stop is None:
        return float(np.min(branch.values)), float(np.max(branch.values))
    return min(stop, special.value), max(stop, special.value)


def doubled(branch: Branch, flip: Special, low: float, high: float, step: float, points: int) -> BranchTrace:
    """The motions of twice the period."""
    orbit = flip.orbit
    path = path_of(branch.family, orbit, flip.value, max(high - low, 1e-300), 2 * branch.period)
    values, vectors = np.linalg.eig(orbit.monodromy / path.scales[:, None] * path.scales)
    aside = vectors[:, int(np.argmin(abs(values + 1)))].real
    direction = np.append(aside / np.linalg.norm(aside), 0.0)
    origin = path.scaled(orbit, flip.value)
    for distance in (_ASIDE, _ASIDE / 4, _ASIDE / 16, _ASIDE / 64):
        root = path.corrected(origin + distance * direction, direction, path.remembered(orbit))
        if root.good and np.linalg.norm(root.at - origin) < 4 * distance:
            return trace_branch(path, path.point(root, direction), low, high, min(step, distance), points, branch.events)
    raise SolveError(
        f"no motion of period {2 * branch.period} was found beside the flip at {branch.parameter} = {flip.rounded}: {root.why}"
    )


def across(branch: Branch, special: Special, low: float, high: float, step: float, points: int) -> BranchTrace:
    """The motions of the branch that crosses this one, on both sides of the crossing, in order."""
    orbit = special.orbit
    path = path_of(branch.family, orbit, special.value, max(high - low, 1e-300))
    origin = path.scaled(orbit, special.value)
    here = branch_point_near(path, origin, _along(path, branch, origin), path.remembered(orbit))
    starts = motions_beside(path, here, here.other) if here else ()
    if here is None or not starts:
        raise SolveError(f"no motion of the other branch was found beside the branch point at {branch.parameter} = {special.rounded}")
    followed_sides = [_side(path, first, low, high, step, points, branch.events) for first in reversed(starts)]
    middle = replace(here.point, tangent=here.other, orbit=orbit)
    back, ahead = followed_sides
    return BranchTrace(
        [*reversed(back.points), middle, *ahead.points],
        [*reversed(back.special), special, *ahead.special],
        f"on one side {back.ended}; on the other {ahead.ended}",
    )


def _side(path: Path, first: Point, low: float, high: float, step: float, points: int, events: Any) -> BranchTrace:
    """One side of a branch; nothing where it leaves the range at once."""
    if not low <= first.value <= high:
        return BranchTrace([], [], "it leaves the range at once")
    return trace_branch(path, first, low, high, min(step, float(np.linalg.norm(first.u))), points, events)


def _along(path: Path, branch: Branch, u: Array) -> Array:
    """The direction of a branch near one of its places: from the point before it to the one after it."""
    U = np.array([path.scaled(orbit, value) for orbit, value in zip(branch.orbits, branch.values, strict=True)])
    sides = np.diff(U, axis=0)
    share = np.clip(np.sum((u - U[:-1]) * sides, axis=1) / np.maximum(np.sum(sides**2, axis=1), 1e-300), 0.0, 1.0)
    return np.asarray(sides[int(np.argmin(np.linalg.norm(U[:-1] + share[:, None] * sides - u, axis=1)))])
