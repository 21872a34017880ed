r"""Branch points: where two branches of motions cross, and in which directions they leave.

At a crossing the derivative :math:`J = (F_y, F_p)` of what a motion misses has rank :math:`d - 1`. It is found as a regular root, with two
unknowns of the bordered system more: :math:`F + \beta b = 0` and :math:`g = 0`, where

.. math:: \begin{pmatrix} J & b \\ C^{\mathsf T} & 0 \end{pmatrix} \begin{pmatrix} V \\ g \end{pmatrix}
   = \begin{pmatrix} 0 \\ I_2 \end{pmatrix}.

Two branches that only pass near one another have :math:`\beta \neq 0`. With the null vectors :math:`V` the directions :math:`V x` of both
branches solve :math:`x^{\mathsf T} A x = 0`, where :math:`A = -(\nabla g) V` (Govaerts, Numerical Methods for Bifurcations of Dynamical
Equilibria, 2000, ch. 7).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.frozen_arrays import sealed
from stickslip.dynamics.continuation.following.pseudo_arclength import Path, Point
from stickslip.dynamics.periodic.newton import STEP, Root, newton

MET = 1e-9  # of a residual: branches that miss one another by more do not cross
_KNOWN = 1e-10  # how well derivatives are known
_ROUNDING = 1e-8  # of derivatives of derivatives: a residual below it that does not shrink has met rounding
_SLANT = 1e-6  # how different the directions of two branches are, as a sine, at least
_WIDE = 4  # times the step of differences: what they become then shows how well they are known
_WAYS = (1.0, -1.0)
_UPRIGHT = 1e-2  # part of the parameter in the direction of a branch that leaves to both sides alike, at most
_LIKE = 1e-3  # of the square of how far motions are apart: what differs by less is the same
_ASIDE = (1e-2, 2.5e-3, 6e-4)  # how far from a crossing the motions of the other branch are looked for


@sealed
class Crossing:
    """A crossing of two branches: the point, whose direction is that of the branch itself, the other direction, and its accuracy."""

    point: Point
    other: Array
    memory: Array
    accuracy: float


def branch_point_near(path: Path, guess: Array, along: Array, memory: Array) -> Crossing | None:
    """The branch point near a guess on a branch of a known direction; None where no two branches cross.

    Parameters
    ----------
    path : Path
    guess : array (unknowns,)
        A point near it.
    along : array (unknowns,)
        About the direction of the branch there.
    memory : array
        What the law remembers on the strobe.
    """
    d, by_value = len(guess) - 1, path.numbers(guess)
    J = path.derivative(guess, memory, by_value)[1]
    if not np.isfinite(J).all():
        return None
    left, _, right = np.linalg.svd(J)
    border, C = left[:, -1:], right[-2:]

    def bordered(u: Array, step: float, way: Path = path) -> tuple[Array, Array, Array]:
        """The residual, the two test functions and the null vectors."""
        missed, J = way.derivative(u, memory, by_value, step)
        M = np.block([[J, border], [C, np.zeros((2, 1))]])
        solved = np.linalg.solve(M, np.eye(d + 2)[:, d:]) if np.isfinite(M).all() else np.full((d + 2, 2), np.nan)
        return missed, solved[-1], solved[:-1]

    def residuals(U: Array, step: float = STEP, way: Path = path) -> Array:
        rows = [(u, *bordered(u[:-1], step, way)) for u in U]
        return np.array([np.append(missed + u[-1] * border[:, 0], g) for u, missed, g, _ in rows])

    root = newton(residuals, np.append(guess, 0.0), tolerance=1e-12, most=12, floor=_ROUNDING, reach=0.1)
    if not root.good or abs(root.at[-1]) > max(MET, 100 * path.rtol):
        return None
    V = bordered(root.at[:-1], STEP)[2]
    ways = _directions(-root.jacobian[d:, :-1] @ V, V)
    if ways is None:
        return None
    own, other = sorted(ways, key=lambda way: -abs(way @ along))
    here, opinions = root.at[None, :], ((_WIDE * STEP, path), (STEP, path.loosened()))
    moved = sum(abs(residuals(here, *each)[0] - residuals(here)[0]) for each in opinions)
    orbit = path.orbit(replace(root, at=root.at[:-1], memory=memory))
    point = Point(root.at[:-1], own * np.sign(own @ along), float(path.value(root.at[:-1])), orbit)
    return Crossing(point, other, memory, _accuracy(path, root, moved))


def crossing_between(path: Path, a: Point, b: Point) -> Crossing | None:
    """The branch point between two points of a branch where the sign of `branch_point_near` changes."""
    along = b.u - a.u
    met = branch_point_near(path, a.u + a.crossing / (a.crossing - b.crossing) * along, along, path.remembered(a.orbit))
    return met if met and 0.0 <= (met.point.u - a.u) @ a.tangent <= along @ a.tangent else None


def _directions(A: Array, V: Array) -> tuple[Array, Array] | None:
    """The two directions V x in which x A x vanishes, of length 1; None where they are not two."""
    (a, b), (_, c) = 0.5 * (A + A.T)
    size, room = max(abs(a), abs(b), abs(c)), b * b - a * c
    if not room > (_SLANT * size) ** 2:
        return None
    rise = b + np.copysign(np.sqrt(room), b)  # the sum that loses no digits
    return tuple(V @ x / np.linalg.norm(V @ x) for x in (np.array([-rise, a]), np.array([c, -rise])))


def _accuracy(path: Path, root: Root, moved: Array) -> float:
    """By how much the parameter may be wrong: by what is left of the equations, and what derivatives do not know."""
    unsure = max(root.residual, 1e-14) + np.append(np.zeros(len(moved) - 2), [_KNOWN, _KNOWN]) + moved
    step = abs(np.linalg.pinv(root.jacobian)) @ unsure
    return float(path.span * step[-2] + 2 * np.spacing(abs(path.value(root.at[:-1]))))


def motions_beside(path: Path, here: Crossing, direction: Array) -> tuple[Point, ...]:
    """Motions of one of the branches, one on each side of a crossing; none if they are not found."""
    for distance in _ASIDE:
        roots = [path.corrected(here.point.u + way * distance * direction, direction, here.memory) for way in _WAYS]
        if all(each.good and np.linalg.norm(each.at - here.point.u) < 2 * distance for each in roots):
            return tuple(path.point(each, way * direction) for each, way in zip(roots, _WAYS, strict=True))
    return ()


def broken_symmetry(path: Path, here: Crossing) -> str:
    """The symmetry that breaks at a crossing, in words: motions on the two sides of one branch are images of one another."""
    for direction in (here.other, here.point.tangent):
        adjacent = motions_beside(path, here, direction) if abs(direction[-1]) < _UPRIGHT else ()
        shift = symmetry_shift(path, adjacent[0], adjacent[1], here.point) if adjacent else None
        if shift is not None:
            later = f", {shift} later" if shift else ""
            return (
                f"symmetry breaking: on one of the branches motions are their own images{later}, on the other those of its two sides are "
                f"images of one another{later}"
            )
    return ""


def symmetry_shift(path: Path, a: Point, b: Point, between: Point) -> str | None:
    """After which time one motion is the image of another, as the one between them is of itself: "", "half a period", or None.

    The other is looked for at the same parameter: a symmetry moves states along curved lines, and not the plane in which it was found.
    """
    level = path.at_value(b.u, a.value, path.remembered(b.orbit))
    apart = 0.5 * float(np.linalg.norm(a.u - level.at))
    if not level.good or (a.u - between.u) @ (level.at - between.u) >= 0.0:
        return None
    near, there = _LIKE * apart**2, path.point(level, b.tangent)
    here, other, begun = (path.inner(p.orbit) for p in (a, between, there))
    if _alike(here, other, begun, other, near):
        return ""
    later, half = (path.later(p.orbit) for p in (a, between))
    return "half a period" if _alike(later, half, begun, other, near) else None


def _alike(a: Array, a0: Array, b: Array, b0: Array, near: float) -> bool:
    """Whether the numbers b are those of a, exchanged or with other signs, and b0 those of a0 in the same way."""
    same = [(abs(a - way * b[:, None]) < near) & (abs(a0 - way * b0[:, None]) < near) for way in _WAYS]
    matched = same[0] | same[1]
    return bool(matched.any(axis=0).all() and matched.any(axis=1).all())
