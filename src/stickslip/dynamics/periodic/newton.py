"""Newton's method on maps that are evaluated in batches: the slopes and the trial steps of one iteration are one batch each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.frozen_arrays import sealed

P = TypeVar("P", bound=Any)

Residuals = Callable[[Array], Array]  # (cases, unknowns) -> (cases, equations), all in units of 1
Slopes = Callable[[Array], tuple[Array, Array]]  # unknowns -> residuals there, and their Jacobian
Share = Callable[[Array, Array], float]  # unknowns and a step from there -> the part of it that may be taken

STEP = 1e-6  # half the distance of the points of a central difference
_PATTERNS = 6  # sets of whole numbers that are tried
_NEXT_TO_NOTHING, _PROBED = 1e-8, 1e-3  # lengths of steps: what rounding leaves, and over which slopes are compared
_ROUNDED = 1e-12  # a residual that is rounding wherever one is
_NO_ROOT = "its steps do not converge, as beside a fold behind which there is no such motion"
SHARES = np.array([0.5, 0.25, 0.1, 0.03, 0.01, 0.003])  # of a step that went too far, tried together


@sealed
class Root:
    """Where Newton's method ended."""

    at: Array
    residual: float
    iterations: int
    jacobian: Array
    good: bool
    why: str
    memory: Any = ()  # whole numbers that were held (see `newton_within`)
    needed: int = 0  # iterations until the residual was near rounding: those that follow say nothing of how good the guess was


def slopes_at(residuals: Residuals, u: Array, step: float = STEP) -> tuple[Array, Array]:
    """The residuals and their Jacobian by central differences, in one batch; by one-sided ones where one side has no residuals."""
    n = len(u)
    values = residuals(np.vstack([u, u + step * np.eye(n), u - step * np.eye(n)]))
    here, ahead, behind = values[0], values[1 : n + 1], values[n + 1 :]
    with np.errstate(invalid="ignore"):
        slopes, forwards, backwards = (ahead - behind) / (2 * step), (ahead - here) / step, (here - behind) / step
    for one_sided in (forwards, backwards):  # beside the border of what the map takes
        slopes = np.where(np.isfinite(slopes).all(axis=1, keepdims=True), slopes, one_sided)
    return here, slopes.T


def newton(
    residuals: Residuals, guess: Array, tolerance: float = 1e-12, most: int = 25, floor: float = 1e-9, reach: float = np.inf,
    slopes: Slopes | None = None, share: Share | None = None, in_turn: bool = False,
) -> Root:  # fmt: skip
    """A root of F(u) = 0.

    Parameters
    ----------
    residuals : callable
        Gives F for a table of trial points, one row each. Unknowns and equations are measured in their own scales.
    guess : array
    tolerance : float
        The residual at which it is done.
    most : int
        Largest number of iterations.
    floor : float
        A residual below it that does not shrink any more has met rounding, if Newton's steps converge there: by Kantorovich's theorem there
        is a root where the slopes change by half of themselves, or less, along a step. Beside a fold, where two roots have met and
        there is none any more, they change by more, however small the residual is.
    reach : float
        Longest step.
    slopes : callable, optional
        Gives F and its Jacobian at one point; where it does not they are central differences.
    share : callable, optional
        Gives the part of a step that may be taken, where that depends on the place.
    in_turn : bool
        Whether parts of a step that went too far are tried in turn until one helps, as rows of a table take one after the other; else they
        are one table, and the best is taken.

    Examples
    --------
    >>> found = newton(lambda u: u**2 - 2.0, np.array([1.0]))
    >>> bool(abs(found.at[0] - 2**0.5) < 1e-14), found.good
    (True, True)
    """

    def at(u: Array) -> tuple[Array, Array]:
        derivatives = None if slopes is None else slopes(u)
        lacking = derivatives is None or (np.isfinite(derivatives[0]).all() and not np.isfinite(derivatives[1]).all())
        return slopes_at(residuals, u) if derivatives is None or lacking else derivatives

    u = np.array(guess, float)
    F, J = at(u)
    size, needed = _size(F), 0

    def ended(good: bool, why: str) -> Root:
        return Root(u, size, k, J, good, why, needed=needed)

    def stopped(why: str) -> Root:
        if size > floor:
            return ended(False, why)
        good = size <= _ROUNDED or _converges(at, u, F, J)
        return ended(good, "found, to rounding" if good else _NO_ROOT)

    for k in range(most + 1):
        needed += size > floor
        if not np.isfinite(size) or not np.isfinite(J).all():
            return ended(False, "the map is not defined here")
        if size <= tolerance:
            return ended(True, "found")
        if k == most:
            break
        step = np.linalg.lstsq(J, -F, rcond=1e-13)[0]
        if size <= floor and np.linalg.norm(step) <= tolerance:  # where a map stretches, its rounding is more than that of the point
            return ended(True, "found, to rounding")
        step = step * min(1.0, reach / max(float(np.linalg.norm(step)), 1e-300)) * (1.0 if share is None else share(u, step))
        ahead, J_ahead = at(u + step)
        if _size(ahead) < size:
            u, F, J, size = u + step, ahead, J_ahead, _size(ahead)
            continue
        part = (_first_share if in_turn else _best_share)(residuals, u, step, size)
        if part == 0.0:
            return stopped("no part of Newton's step makes the residual smaller")
        u = u + part * step
        F, J = at(u)
        size = _size(F)
    return stopped(f"{most} iterations were not enough")


def _converges(at: Slopes, u: Array, F: Array, J: Array) -> bool:
    """Whether Newton's steps from a point converge to a root beside it: h = |J^-1 (J(u + s) - J(u))| <= 1/2 for the step s.

    Where a step is long its slopes are taken on a part of it, and where they are not known only a step that is next to nothing counts.

    References
    ----------
    P. Deuflhard, Newton Methods for Nonlinear Problems, Springer 2004, theorem 2.1 (Newton-Kantorovich, affine covariant).
    """
    step = np.linalg.lstsq(J, -F, rcond=1e-13)[0]
    length = float(np.linalg.norm(step))
    if length <= _NEXT_TO_NOTHING:
        return True
    part = min(1.0, _PROBED / length)
    bent = np.linalg.lstsq(J, at(u + part * step)[1] - J, rcond=1e-13)[0]
    return bool(np.isfinite(bent).all() and np.linalg.norm(bent, 2) <= 0.5 * part)


def newton_within(
    problem: Callable[[Array], Residuals], after: Callable[[Array, Array], Array], guess: Array, memory: Array,
    slopes: Callable[[Array], Slopes] | None = None, share: Callable[[Array], Share | None] | None = None, **options: Any,
) -> Root:  # fmt: skip
    """A root for which whole numbers come back too: Newton's method with them held, and again with what they became.

    Parameters
    ----------
    problem : callable
        The residuals for whole numbers that are held.
    after : callable
        What the whole numbers are one period after a point, from it and the ones that were held.
    guess, memory : array
        Where it begins.
    slopes : callable, optional
        The residuals with their Jacobian, for whole numbers that are held.
    share : callable, optional
        The part of a step that may be taken, for whole numbers that are held.
    **options
        As for `newton`.

    Examples
    --------
    >>> found = newton_within(lambda m: lambda u: u - m, lambda u, m: np.minimum(m + 1, 2.0), np.array([0.5]), np.array([0.0]))
    >>> float(found.at[0]), found.memory.tolist()
    (2.0, [2.0])
    """
    for _ in range(_PATTERNS):
        root = newton(problem(memory), guess, slopes=slopes and slopes(memory), share=share and share(memory), **options)
        if not len(memory) or not np.isfinite(root.at).all():
            return replace(root, memory=memory)
        now = after(root.at, memory)
        if np.array_equal(now, memory):
            return replace(root, memory=memory)
        guess, memory = root.at if root.good else guess, now
    return replace(root, memory=memory, good=False, why="the memory of the law at the strobe does not return")


def root_between(ahead: Callable[[float], P | None], length: float, a: P, b: P, test: Callable[[P], float]) -> P:
    """Where a test vanishes between two points of a curve, of which `ahead` gives the one that lies so far ahead of the first, if any."""
    from scipy.optimize import brentq

    kept = {0.0: (test(a), a), length: (test(b), b)}

    def value(s: float) -> float:
        if s not in kept:
            point = ahead(s)
            there = np.nan if point is None else test(point)
            if point is None or np.isnan(there):  # no number here: take the nearest there is, so that the search goes on
                return kept[min(kept, key=lambda k: abs(k - s))][0]
            kept[s] = there, point
        return kept[s][0]

    s = brentq(value, 0.0, length, xtol=1e-15, rtol=1e-14, maxiter=100, disp=False)
    return kept.get(s, min(kept.values(), key=lambda each: abs(each[0])))[1]


def _best_share(residuals: Residuals, u: Array, step: Array, size: float) -> float:
    """The part of a step that leaves the smallest residual; 0 if none leaves less than there is."""
    sizes = np.array([_size(f) for f in residuals(u + SHARES[:, None] * step)])
    best = int(np.argmin(sizes))
    return float(SHARES[best]) if sizes[best] < size else 0.0


def _first_share(residuals: Residuals, u: Array, step: Array, size: float) -> float:
    """The largest part of a step that leaves a smaller residual; 0 if none does."""
    return next((float(part) for part in SHARES if _size(residuals((u + part * step)[None, :])) < size), 0.0)


def _size(F: Array) -> float:
    return float(np.max(np.abs(F))) if np.isfinite(F).all() else float("inf")
