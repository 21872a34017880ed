"""Following a branch from point to point: step lengths, corners, and the end of the branch."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.dynamics.continuation.following.arclength import OUTSIDE, TOO_SHORT, step_along
from stickslip.dynamics.continuation.following.pseudo_arclength import Path, Point
from stickslip.dynamics.continuation.special_points.branch_points import crossing_between
from stickslip.dynamics.continuation.special_points.grazing import grazed
from stickslip.dynamics.periodic.newton import Root

_SAME, _LOOKED_BACK = 1e-2, 20  # a point so near, in steps, to the line through so many before it is on the way back
_STRAIGHT, _SMALL = 0.8, 1e-4  # by how much, as a cosine, a branch may turn within a step that is not small
_ANOTHER = 0.7  # of a step that led to a place where the motion is not alone
_BLURRED = 0.1  # of the way to a point: a residual that may have moved it by more says that the branch has no point there
_CORNER = "it has a corner"
STOPPED = TOO_SHORT, _CORNER
SIDE_BY_SIDE = "such motions form a continuous family (a multiplier is 1), and no single one can be followed"


def follow(path: Path, first: Point, step: float, most: int, inside: Callable[[float], bool]) -> Iterator[Point | str]:
    """The points after the first; at the end a sentence that says why it ended."""
    here, largest, name = first, 4 * step, path.family.parameters[0]
    passed = [first.u]
    for _ in range(most):
        ahead = _next(path, here, step, passed)
        if isinstance(ahead, str):
            yield ahead
            return
        root, point, step = ahead
        if not point.alone:  # one step may end right where two branches cross
            again = _next(path, here, _ANOTHER * step, passed)
            root, point, step = ahead if isinstance(again, str) else again
        if not point.alone:
            yield f"at {name} = {point.value:.9g} {SIDE_BY_SIDE}"
            return
        yield point
        if not inside(point.value):
            yield "it reached the end of the range"
            return
        step = min(largest, step * (1.5 if root.needed <= 3 else 1.0 if root.needed <= 6 else 0.6))
        here = point
        passed = [*passed[1 - _LOOKED_BACK :], here.u]
    yield f"it was followed for {most} points"


def _next(path: Path, here: Point, step: float, passed: list[Array]) -> tuple[Root, Point, float] | str:
    """The next point, by steps that are halved and at last by a jump across a corner; or why there is none."""
    at = f"{path.family.parameters[0]} = {here.value:.9g}"

    def corrected(guess: Array, step: float) -> Root:
        return path.corrected(guess, here.tangent, path.remembered(here.orbit), step)

    def accepted(root: Root, step: float) -> Point | str:
        point = path.point(root, here.tangent)
        if point.blur > _BLURRED * float(np.linalg.norm(point.u - here.u)):
            return failed(replace(root, why=f"a residual of {root.residual:.1e} is left"))
        if _goes_back(point, here, passed):
            return f"{_CORNER} at {at}, and its continuation there was not found"
        same = step <= _SMALL or (point.tangent @ here.tangent > _STRAIGHT and not _hops(path, here, point))
        return point if same else failed(root)

    def failed(root: Root) -> str:
        return f"{TOO_SHORT} at {at}: {root.why}"

    def refused(error: InputError, beyond: Array) -> str:
        return f"{OUTSIDE} beyond {at}: {path.family.refusal(error, float(path.value(beyond)))}"

    ahead = step_along(here, step, corrected, accepted, failed, refused)
    if not isinstance(ahead, str) or ahead.startswith(OUTSIDE):
        return ahead
    # behind a stop of a machine the search is longer than all the rest
    turns = not path.at.in_lanes or not grazed(here.orbit)
    jumped = (beyond for beyond in path.beyond(here, turns) if not _goes_back(beyond[1], here, passed))
    return next(jumped, None) or ahead


def _hops(path: Path, here: Point, point: Point) -> bool:
    """Whether a step seems to have led to another branch, one that comes near: a sign changes as at a crossing, and there is none."""
    return here.crossing * point.crossing < 0.0 and crossing_between(path, here, point) is None


def _goes_back(point: Point, here: Point, passed: list[Array]) -> bool:
    """Whether a point lies where the branch came from."""
    return len(passed) > 1 and _apart(point.u, np.array(passed)) < _SAME * float(np.linalg.norm(point.u - here.u))


def _apart(u: Array, corners: Array) -> float:
    """How far a point is from the line through these corners."""
    sides = np.diff(corners, axis=0)
    along = np.clip(np.sum((u - corners[:-1]) * sides, axis=1) / np.sum(sides**2, axis=1), 0.0, 1.0)
    return float(np.linalg.norm(u - corners[:-1] - along[:, None] * sides, axis=1).min())
