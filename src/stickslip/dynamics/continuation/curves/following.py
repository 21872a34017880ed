"""Following a curve of special points in two parameters, and the points on it where another condition is met."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import SolveError
from stickslip.basics.interruption import look, partial_result
from stickslip.basics.progress import Reported
from stickslip.dynamics.continuation.curves.problems import CurvePoint, CurveProblem
from stickslip.dynamics.continuation.following.arclength import OUTSIDE, TOO_SHORT, in_plane, step_along, tangent_of
from stickslip.dynamics.continuation.special_points.accuracy import Meeting
from stickslip.dynamics.periodic.newton import Root, newton, root_between

_VANISHED = 1e-4  # of what a test was beside it: what is more at its root has jumped there
_ASIDE = 1e-4  # how far away the slope of a test is taken
_KNOWN = 1e-10  # how well tests are known
_AGAIN = 1e-6  # of the scaled plane: special points so near one another are one
_ENDS = {"neimark-sacker": {"R1", "R2"}}  # beyond which a pair whose product is 1 is real, and nothing special
_TRIPLE = ("triple-point", "two borders of motion types meet here")
_TURNED_REAL = "a resonance ({}) was met: beyond it the two multipliers whose product is 1 are real, and there is no rotation"
_BEYOND = "it met another border, beyond which its motion does not exist"
_LARGEST = 0.1  # the longest step
_UPRIGHT = 0.1  # of how fast the first parameter moves: the second is held where it moves faster than that
_ROUNDED = 1e-8  # a residual below it that does not shrink has met rounding
_TIMES = (2, 4, 8)  # distances, besides 1, from which what is known on one side only is continued to 0
_CUBIC, _PARABOLA = np.array([64.0, -56.0, 14.0, -1.0]) / 21.0, np.array([8.0, -6.0, 1.0, 0.0]) / 3.0  # shares of the motions there


class FollowedCurve(NamedTuple):
    """Points of a curve in order, special points on it, and why it ends."""

    points: list[Root]
    special: list[Meeting]
    ended: str


def followed_curve(
    problem: CurveProblem, guess: Array, kind: str, sign: float, step: float, most: int, report: Reported = lambda *state: None
) -> FollowedCurve:
    """The curve from a guess until it leaves the range."""
    n = len(guess)
    first = _corrected(problem, guess, np.eye(n)[-1])
    if not first.good:
        raise SolveError(f"the special point could not be found again in two parameters: {first.why} (residual {first.residual:.1e})")
    here = _point(problem, first, sign * np.eye(n)[-1], None)
    roots, special = [first], list[Meeting]()
    before = problem.watched(here.u)
    with partial_result() as ending:
        while len(roots) < most:
            look()
            ahead = _next(problem, here, step)
            if isinstance(ahead, str):
                return FollowedCurve(roots, special, ahead)
            _, there, step = ahead
            if why := problem.apart(there.u):
                return FollowedCurve(roots, special, why)
            now = problem.watched(there.u)
            lost = [name for name, value in now.items() if value < 0 <= before.get(name, -1.0)]
            if lost and problem.meeting is not None:
                roots.append(problem.meeting(0.5 * (here.u + there.u), lost[0]))
                return FollowedCurve(roots, [*special, _meeting(problem, roots[-1], _TRIPLE, problem.accuracy(roots[-1]))], _BEYOND)
            for met, point in _between(problem, here, there):
                if not any(m.kind == met.kind and np.allclose(m.values, met.values, atol=_AGAIN * problem.span) for m in special):
                    special.append(met)
                if met.kind in _ENDS.get(kind, ()):
                    return FollowedCurve([*roots, point.root], special, _TURNED_REAL.format(met.kind))
            here, before = there, now
            roots.append(there.root)
            report(kind, len(roots), most)
            if ended := _left(problem, here, sign):
                return FollowedCurve(roots, special, ended)
            step = min(_LARGEST, 1.3 * step) if there.root.iterations <= 4 else step
    if ending.interrupted:
        return FollowedCurve(roots, special, f"it was {ending.words}")
    return FollowedCurve(roots, special, f"it was followed for {most} points")


def two_parameters_of(problem: CurveProblem, root: Root) -> tuple[Array, Array]:
    """The two parameters of a point of a curve, and by how much they may be wrong; continued from beside it if it is known so."""
    if problem.farther is None:
        return problem.values(root.at), problem.accuracy(root)
    tangent = tangent_of(root.jacobian[:-1], np.eye(len(root.at))[-1])
    across = np.eye(len(root.at))[-1 if tangent[-1] > _UPRIGHT * abs(tangent[-2]) else -2]
    J, kept = np.vstack([root.jacobian[:-1], across]), [root, root]
    unsure = [problem.accuracy(root)]
    for times in _TIMES:
        way = problem.farther(times)
        there = _root_near(way, 3.0 * kept[-1].at - 2.0 * kept[-2].at, J)
        if not there.good:
            return problem.values(root.at), unsure[0] + problem.span
        kept.append(there)
        unsure.append(way.accuracy(there))
    places = np.array([each.at for each in kept[1:]])
    value = problem.values(_CUBIC @ places)
    return value, abs(_CUBIC) @ np.array(unsure) + abs(value - problem.values(_PARABOLA @ places))


def _root_near(way: CurveProblem, guess: Array, J: Array) -> Root:
    """The point of a problem near a guess, by Newton's method with slopes from nearby, which are not computed anew."""

    def slopes(u: Array) -> tuple[Array, Array]:
        return np.append(way.residuals(u[None, :])[0], (u - guess) @ J[-1]), J

    def residuals(U: Array) -> Array:
        return np.array([slopes(u)[0] for u in U])

    return newton(residuals, guess, way.tolerance, most=15, floor=_ROUNDED, reach=0.2, slopes=slopes)


def _left(problem: CurveProblem, here: CurvePoint, sign: float) -> str:
    """Why a curve ends at a point; "" where it goes on."""
    first, second = problem.family.parameters
    if sign * here.u[-1] >= 1.0:
        return "it reached the end of the range"
    if sign * here.u[-1] < -1e-9:
        return f"it returned to where {second} began"
    return f"{first} has moved by five times the branch's range" if abs(here.u[-2]) > 5.0 else ""


def _next(problem: CurveProblem, here: CurvePoint, step: float) -> tuple[Root, CurvePoint, float] | str:
    """The next point and the step that led to it; or why there is none."""
    return step_along(
        here,
        step,
        lambda guess, step: _corrected(problem, guess, here.tangent),
        lambda root, step: _point(problem, root, here.tangent, here.facing),
        lambda root: f"{TOO_SHORT}: {root.why}",
        lambda error, beyond: f"{OUTSIDE}: {problem.family.refusal(error, *problem.values(beyond))}",
    )


def _point(problem: CurveProblem, root: Root, towards: Array, facing: Array | None) -> CurvePoint:
    tangent = tangent_of(root.jacobian[:-1], towards)
    tests, facing = problem.tests(root, tangent, facing) if problem.tests else ({}, None)
    return CurvePoint(root, tangent, tests, facing)


# ---- special points on the way ----
def _between(problem: CurveProblem, a: CurvePoint, b: CurvePoint) -> Iterator[tuple[Meeting, CurvePoint]]:
    """Special points between two neighbours, in order."""
    changed = [name for name, value in a.tests.items() if value * b.tests.get(name, np.nan) < 0.0]
    places = [(name, point) for name in changed if (point := _root(problem, a, b, name)) is not None]
    for name, point in sorted(places, key=lambda item: float((item[1].u - a.u) @ a.tangent)):
        kind = problem.named(point.u, name) if problem.named else None
        if kind is not None:
            yield _meeting(problem, point.root, kind, _accuracy(problem, point, name)), point


def _root(problem: CurveProblem, a: CurvePoint, b: CurvePoint, name: str) -> CurvePoint | None:
    """Where a test vanishes between two points; None where it jumps."""
    best = root_between(partial(_ahead, problem, a), float((b.u - a.u) @ a.tangent), a, b, lambda p: p.tests.get(name, np.nan))
    return best if abs(best.tests[name]) <= _VANISHED * max(abs(a.tests[name]), abs(b.tests[name])) else None


def _ahead(problem: CurveProblem, a: CurvePoint, s: float) -> CurvePoint | None:
    """The point of a curve that lies s ahead of another, along the tangent there."""
    root = _corrected(problem, a.u + s * a.tangent, a.tangent)
    return _point(problem, root, a.tangent, a.facing) if root.good else None


def _accuracy(problem: CurveProblem, p: CurvePoint, name: str) -> Array:
    """By how much the two parameters may be wrong: across the curve, and along it by what is not known of the test that vanishes."""
    across, aside = problem.accuracy(p.root), _ahead(problem, p, _ASIDE) or _ahead(problem, p, -_ASIDE)
    if aside is None or name not in aside.tests or problem.tests is None:
        return across + problem.span
    h = float(np.linalg.norm(aside.u - p.u))
    slope = abs(aside.tests[name] - p.tests[name]) / h
    worse = problem.tests(p.root, p.tangent, p.facing, True)[0].get(name, np.nan)
    unsure = abs(p.tests[name]) + abs(worse - p.tests[name]) + _KNOWN
    along = unsure / slope if unsure < slope else 1.0
    bend = abs(aside.tangent[-2:] - p.tangent[-2:]) / h
    return across + problem.span * (abs(p.tangent[-2:]) * along + 0.5 * bend * along**2)


def _meeting(problem: CurveProblem, root: Root, kind: tuple[str, str], accuracy: Array) -> Meeting:
    orbit, (p, q) = problem.orbit(root.at), problem.values(root.at).tolist()
    return Meeting(kind[0], (p, q), replace(orbit, notes=(kind[1],)), (float(accuracy[0]), float(accuracy[1])))


def _corrected(problem: CurveProblem, guess: Array, across: Array) -> Root:
    return newton(in_plane(problem.residuals, guess, across), guess, problem.tolerance, most=15, floor=1e-7, reach=0.2)
