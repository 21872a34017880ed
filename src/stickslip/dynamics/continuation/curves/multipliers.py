r"""Folds, flips and Neimark-Sacker points in two parameters, and where two conditions on multipliers meet on their curves.

With the derivative :math:`R` of the return map a fold is :math:`\det(R - I) = 0`, a flip :math:`\det(R + I) = 0`, and a pair of
multipliers whose product is 1 has :math:`\det(R^{(2)} - I) = 0`, where :math:`R^{(2)}` is the second compound matrix, whose eigenvalues
are the products of two multipliers. A multiplier is a double one where the derivative of :math:`\det(\lambda I - R)` vanishes there too.
At a cusp the two parameters stand still along the curve of folds (Kuznetsov, Elements of Applied Bifurcation Theory, 2004, ch. 9).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import combinations

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.dynamics.continuation.curves.problems import CurveProblem
from stickslip.dynamics.continuation.following.path_kinds import path_of
from stickslip.dynamics.continuation.one_parameter import Family
from stickslip.dynamics.continuation.special_points.accuracy import Special
from stickslip.dynamics.periodic.newton import Root

_TOLERANCE = {True: 1e-9, False: 1e-12}  # of the equations: where runs have a tolerance, and where they are exact
KNOWN = {True: 1e-10, False: 1e-11}  # multipliers, in both cases
_ONE = 1e-3  # how near to 1, -1 or the unit circle a multiplier is that is there: of a double one rounding leaves 1e-5
_DOUBLE, _CUSP, _THIRD, _FOURTH = "double", "cusp", "third", "fourth"


def _fold(R: Array) -> Array:
    return np.linalg.det(R - np.eye(R.shape[-1]))


def _flip(R: Array) -> Array:
    return np.linalg.det(R + np.eye(R.shape[-1]))


def _pair(R: Array) -> Array:
    """Of the second compound matrix: minors of two rows and two columns."""
    pairs = np.array(list(combinations(range(R.shape[-1]), 2)), int).reshape(-1, 2)
    (p, q), (r, s) = (pairs.T[:, :, None], pairs.T[:, None, :])
    products = R[..., p, r] * R[..., q, s] - R[..., p, s] * R[..., q, r]
    return np.linalg.det(products - np.eye(len(pairs)))


CONDITIONS: dict[str, Callable[[Array], Array]] = {"fold": _fold, "flip": _flip, "neimark-sacker": _pair}
_OWN = {"fold": 1.0, "flip": -1.0}  # the multiplier that a curve keeps
_WORDS = {
    "cusp": "two curves of folds end here in a cusp",
    "R1": "two multipliers are 1 (resonance 1:1): a Neimark-Sacker curve meets a curve of folds",
    "R2": "two multipliers are -1 (resonance 1:2): a Neimark-Sacker curve meets a curve of flips",
    "R3": "a pair of multipliers has arguments of 120 degrees (resonance 1:3)",
    "R4": "a pair of multipliers has arguments of 90 degrees (resonance 1:4)",
    "fold-flip": "one multiplier is 1 and another -1: a fold and a flip at once",
    "fold-neimark-sacker": "a multiplier is 1 and a pair is on the unit circle: a fold and a Neimark-Sacker point at once",
    "flip-neimark-sacker": "a multiplier is -1 and a pair is on the unit circle: a flip and a Neimark-Sacker point at once",
}


def multiplier_problem(both: Family, special: Special, origin: Array, span: Array) -> tuple[CurveProblem, Array]:
    """The equations of a curve of such special points, and its first point."""
    path, kind = path_of(both, special.orbit, origin, span), special.kind
    n, memory, condition = path.at.smooth, path.remembered(special.orbit), CONDITIONS[kind]

    def residuals(U: Array, worse: bool = False) -> Array:
        missed, J = path.derivatives(U, memory, worse)
        return np.column_stack([missed, condition(path.returned(J))])

    def tests(root: Root, tangent: Array, facing: Array, worse: bool = False) -> tuple[dict[str, float], Array]:
        J = path.derivatives(root.at[None, :], memory, worse)[1][0]
        values = _tests(kind, path.returned(J))
        if kind == "fold":
            values[_CUSP], facing = _standing(J, root.jacobian[:n, n:], tangent[n:], facing)
        return values, facing

    def named(u: Array, name: str) -> tuple[str, str] | None:
        R = path.returned(path.derivatives(u[None, :], memory)[1][0])
        met = _kind(kind, name, np.linalg.eigvals(R))
        return None if met is None else (met, _WORDS[met])

    rough, orbit = path.has_tolerance, partial(path.orbit_at, memory=memory)
    problem = CurveProblem(
        both, origin, span, residuals, orbit, _TOLERANCE[rough], again=lambda U: residuals(U, True), tests=tests, named=named,
        known=np.append(np.zeros(n), KNOWN[rough]),
    )  # fmt: skip
    return problem, path.scaled(special.orbit, origin)


def _tests(kind: str, R: Array) -> dict[str, float]:
    """Test functions along a curve of such points; of a fold all but that of the cusp."""
    values = {name: float(condition(R)) for name, condition in CONDITIONS.items() if name != kind}
    if kind in _OWN:
        return values | {_DOUBLE: float(np.polyval(np.polyder(np.poly(R)), _OWN[kind]).real)}
    pair = _on_the_circle(np.linalg.eigvals(R))
    return values | ({} if pair is None else {_THIRD: pair.real + 0.5, _FOURTH: pair.real})


def _standing(J: Array, by_parameters: Array, moved: Array, facing: Array) -> tuple[float, Array]:
    """How fast the parameters move along a curve of folds, with a sign; and the normal of the curve, on the side of the one before."""
    normal = np.linalg.svd(J)[0][:, -1] @ by_parameters
    normal = normal if facing is None or normal @ facing >= 0.0 else -normal
    return float(moved[0] * normal[1] - moved[1] * normal[0]), normal


def _on_the_circle(multipliers: Array) -> complex | None:
    """The multiplier of the complex pair nearest to the unit circle, moved onto it."""
    turning = multipliers[multipliers.imag > 0.0]
    if not len(turning):
        return None
    multiplier = complex(turning[int(np.argmin(abs(abs(turning) - 1.0)))])
    return multiplier / abs(multiplier)


def has_multiplier(name: str, multipliers: Array) -> bool:
    """Whether a multiplier is what a condition says: 1, -1, or one of a pair on the unit circle.

    Examples
    --------
    >>> has_multiplier("flip", np.array([-1.0, 0.3])), has_multiplier("neimark-sacker", np.array([2.0, 0.5]))
    (True, False)
    """
    if name in _OWN:
        return bool(np.any(abs(multipliers - _OWN[name]) < _ONE))
    return bool(np.any((abs(abs(multipliers) - 1.0) < _ONE) & (np.imag(multipliers) > _ONE)))


def _kind(kind: str, name: str, multipliers: Array) -> str | None:
    """Which special point of a curve it is where a test vanishes."""
    at = {sign: int(np.sum(abs(multipliers - sign) < _ONE)) for sign in (1.0, -1.0)}
    pair = has_multiplier("neimark-sacker", multipliers)
    if name in (_CUSP, _THIRD, _FOURTH):
        return {_CUSP: "cusp", _THIRD: "R3", _FOURTH: "R4"}[name]
    if kind == "neimark-sacker":
        if at[-_OWN[name]] >= 2 or at[_OWN[name]] >= 2:
            return {"fold": "R1", "flip": "R2"}[name]
        return f"{name}-neimark-sacker" if pair and at[_OWN[name]] else None
    if name == _DOUBLE:
        return {1.0: "R1", -1.0: "R2"}[_OWN[kind]]
    if name == "neimark-sacker":
        return f"{kind}-neimark-sacker" if pair else None
    return "fold-flip" if at[1.0] and at[-1.0] else None
