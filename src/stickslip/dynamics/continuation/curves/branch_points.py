"""Branch points in two parameters: they are followed as long as a symmetry, or an invariant motion, keeps the two branches together."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.dynamics.continuation.curves.multipliers import KNOWN
from stickslip.dynamics.continuation.curves.problems import CurveProblem
from stickslip.dynamics.continuation.following.path_kinds import path_of
from stickslip.dynamics.continuation.following.pseudo_arclength import Path
from stickslip.dynamics.continuation.one_parameter import Family
from stickslip.dynamics.continuation.special_points.accuracy import Special
from stickslip.dynamics.continuation.special_points.branch_points import MET

_TOLERANCE = {True: 1e-8, False: 1e-11}  # of the equations: where runs have a tolerance, and where they are exact


def crossing_problem(both: Family, special: Special, origin: Array, span: Array) -> tuple[CurveProblem, Array]:
    """The equations of a curve of branch points, and its first point.

    The bordered system of `branch_points`, in which the second parameter is one more unknown: u = (inner unknowns, beta, two parameters).
    """
    path = path_of(both, special.orbit, origin, span)
    n, memory, begin = path.at.smooth, path.remembered(special.orbit), path.scaled(special.orbit, origin)
    left, _, right = np.linalg.svd(_slopes(path, begin[None, :], memory, False)[1][0])
    border, C = left[:, -1], right[-2:]

    def residuals(U: Array, worse: bool = False) -> Array:
        missed, J = _slopes(path, np.delete(U, n, axis=1), memory, worse)
        M = np.zeros((len(U), n + 2, n + 2))
        M[:, :n, : n + 1], M[:, :n, n + 1], M[:, n:, : n + 1] = J, border, C
        good = np.isfinite(M).all(axis=(1, 2))
        g = np.full((len(U), 2), np.nan)
        g[good] = np.linalg.solve(M[good], np.broadcast_to(np.eye(n + 2)[:, n:], (int(good.sum()), n + 2, 2)))[:, -1]
        return np.hstack([missed + U[:, n : n + 1] * border, g])

    def orbit(u: Array) -> Any:
        return path.orbit_at(np.delete(u, n), memory)

    def apart(u: Array) -> str:
        name = both.parameters[1]
        together = abs(u[n]) <= max(MET, 100 * path.rtol)
        return "" if together else f"the two branches separate as {name} changes: no symmetry preserves their crossing"

    known = np.append(np.zeros(n), np.full(2, KNOWN[path.has_tolerance]))
    problem = CurveProblem(
        both, origin, span, residuals, orbit, _TOLERANCE[path.has_tolerance], again=lambda U: residuals(U, True), known=known, apart=apart
    )
    return problem, np.insert(begin, n, 0.0)


def _slopes(path: Path, U: Array, memory: Array, worse: bool) -> tuple[Array, Array]:
    """The residual, and its derivatives by the inner unknowns and the first parameter."""
    n = path.at.smooth
    missed, J = path.derivatives(U, memory, worse)
    return missed, np.concatenate([J, path.differences(U, memory, worse, slice(n, n + 1))[1]], axis=2)
