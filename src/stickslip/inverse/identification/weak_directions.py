"""Directions in which next to nothing measured changes, differentiated along themselves.

A sample that lies beside a kink of its curve, where a contact begins or ends to stick, has an average of the slopes on either side for a
derivative, another average for each number that is moved. Numbers of which only one combination acts then seem to act a little each by
itself: of 2000 samples three beside kinks raise a singular value that is zero to 2e-3 of the largest. Moved together they do not move
the kink, so that the difference along the direction itself is exact.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.information import decomposed

_WEAK = 0.02  # part of the largest singular value below which a direction is differentiated along itself
_TIMES = 2  # by which it is turned, each time by some thousandth of what it was turned before
_STEP = 1e-4  # of the distance between bounds, at most: differences along a direction
_NOTHING = 1e-12  # of the largest column: a number that moves nothing


def sharpened(jacobian: Array, along: Callable[[Any], Any], singular: float) -> Any:
    """Derivatives that are right in weak directions too.

    Parameters
    ----------
    jacobian : array (values, numbers)
        Derivatives by one number at a time.
    along : callable
        Gives the derivative of the values along a direction (numbers,), or None where there is no room for it.
    singular : float
        Part of the largest singular value below which one is zero.

    Examples
    --------
    The second of two numbers acts as the first one does, but its derivative is off at one value:

    >>> off = np.array([[1.0, 1.0], [1.0, 1.0], [1.0, 1.01]])
    >>> right = sharpened(off, lambda direction: np.full(3, direction.sum()), 1e-6)
    >>> bool(np.linalg.svd(off)[1][1] > 1e-3), bool(np.linalg.svd(right)[1][1] < 1e-6)
    (True, True)
    """
    sizes = np.sqrt(np.sum(jacobian**2, axis=0))
    sizes = np.where(sizes > _NOTHING * sizes.max(initial=0.0), sizes, np.inf)
    scaled = jacobian / sizes
    values, directions = decomposed(scaled)
    most = values.max(initial=0.0)
    weak, strong = (values > singular * most) & (values < _WEAK * most), values >= _WEAK * most
    inverse = (directions[strong].T / values[strong] ** 2) @ directions[strong] @ scaled.T
    for direction in directions[weak]:
        change = along(direction / sizes)
        for _ in range(_TIMES):
            if change is None:
                break
            direction = direction - inverse @ change
            change = along(direction / sizes)
        if change is not None:
            scaled = scaled + np.outer(change - scaled @ direction, direction) / (direction @ direction)
    return np.where(np.isfinite(sizes), scaled * np.where(np.isfinite(sizes), sizes, 0.0), jacobian)


def derivative_along(problem: Any, point: Array, slopes: Any, direction: Array) -> Any:
    """Derivative of the residuals of a `MeasuredProblem` along a direction; None where bounds leave no room, or there is no model."""
    sizes = np.sqrt(np.sum(slopes[:, : len(problem.parameters.free)] ** 2, axis=0))
    step = _STEP * float(min(sizes[sizes > 0], default=0.0))
    low, high = problem.bounds()
    ends = [point + step * direction, point - step * direction]
    if step == 0 or not all(((low <= end) & (end <= high)).all() and problem.parameters.limits.allows(end) for end in ends):
        return None
    if any(problem.predicted(end) is None for end in ends):
        return None
    ahead, behind = (problem.residuals(end)[: len(problem.y)] for end in ends)
    return (ahead - behind) / (2 * step)
