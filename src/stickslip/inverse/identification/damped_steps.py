r"""Levenberg and Marquardt's steps between bounds, for derivatives of any rank.

SciPy's trust-region steps stop within two of them, as if at a minimum, where a column of the derivatives is zero or a combination of the
others: numbers that data do not determine are usual here. A damped step has a solution in any case, and a search has ended at a minimum
only where the step without damping promises next to nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array

_FIRST, _MOST, _LITTLE = 1e-3, 1e12, 1e-10  # damping beside columns of length one: at first, at most, at least
_SURE = 1e-4  # of what a step promises that it has to hold
_TURNS = 8  # bounds that a step may reach one after the other


@dataclass(frozen=True, eq=False)
class StepsEnd:
    """Where damped steps ended.

    Parameters
    ----------
    x, residuals, jacobian : array
    steps : int
        How often residuals were asked for.
    promised : float
        By how much a step without damping, along what the derivatives determine, would lower the sum of squares.
    """

    x: Any
    residuals: Any
    jacobian: Any
    steps: int
    promised: float


def damped_steps(
    residuals: Callable[[Any], Any], jacobian: Callable[[Any], Any], start: Array, bounds: tuple[Any, Any],
    until: tuple[float, float, int, float], known: Any = None,
) -> StepsEnd:  # fmt: skip
    """Steps to the nearest least sum of squares.

    Parameters
    ----------
    residuals, jacobian : callable
        Of a point; the derivatives are asked for at points that were asked for residuals last.
    start : array (n,)
        Within the bounds.
    bounds : tuple of array (n,)
    until : tuple
        Steps end where the next one promises to lower the sum of squares by less than a part of it, or is shorter than a part of the point,
        or residuals were asked for so often; singular values below a part of the largest are zero for what is promised.
    known : tuple, optional
        Residuals and derivatives at the start.

    Examples
    --------
    The second of two numbers does nothing, and the first one is found:

    >>> end = damped_steps(lambda x: np.array([x[0] ** 2 - 2.0, 0.1]), lambda x: np.array([[2 * x[0], 0.0], [0.0, 0.0]]),
    ...                    np.array([1.0, 0.5]), (np.zeros(2), np.full(2, 9.0)), (1e-12, 1e-12, 60, 1e-9))
    >>> bool(abs(end.x[0] - 2**0.5) < 1e-9), float(end.x[1]), end.steps < 12, end.promised < 1e-9
    (True, 0.5, True, True)
    """
    x, (low, high), (part, close, most, resolution) = np.array(start, float), bounds, until
    r, J = known or (residuals(x), None)
    J = jacobian(x) if J is None else J
    steps, cost, damping, growth, sizes = 1, float(r @ r), _FIRST, 2.0, np.zeros(len(x))
    while True:
        sizes = np.maximum(sizes, np.sqrt(np.sum(J**2, axis=0)))
        model = _Linear(J, r, x, low, high, np.where(sizes > 0, sizes, 1.0))
        promised = model.promised(model.step(0.0, resolution))
        if promised <= part * cost or steps >= most:
            return StepsEnd(x, r, J, steps, promised)
        while True:
            step = model.step(damping, resolution)
            hoped = model.promised(step)
            if damping > _MOST or np.linalg.norm(step) <= close * (close + np.linalg.norm(x)):
                return StepsEnd(x, r, J, steps, promised)
            ahead = np.clip(x + step, low, high)
            there = residuals(ahead)
            steps, held = steps + 1, min((cost - float(there @ there)) / max(hoped, 1e-300), 2.0)
            if held > _SURE:
                break
            damping, growth = damping * growth, 2 * growth
            if steps >= most:
                return StepsEnd(x, r, J, steps, promised)
        x, r, cost = ahead, there, float(there @ there)
        J = jacobian(x)
        damping, growth = max(damping * max(1 / 3, 1 - (2 * held - 1) ** 3), _LITTLE), 2.0


class _Linear:
    """The residuals near a point as straight lines, with numbers that steps from it must not take over a bound."""

    def __init__(self, J: Any, r: Any, x: Any, low: Any, high: Any, sizes: Any):
        self.J, self.r, self.low, self.high, self.sizes = J, r, low - x, high - x, sizes
        whole: Any = np.linalg.qr(np.column_stack([J / sizes, r]), mode="r")
        self.triangle, self.end = whole[:, : len(x)], whole[:, len(x)]

    def step(self, damping: float, resolution: float) -> Any:
        """The step with some damping, which ends at bounds; of those without it the shortest."""
        step, held = np.zeros(len(self.sizes)), np.zeros(len(self.sizes), bool)
        for _ in range(_TURNS):
            free = ~held
            if not free.any():
                break
            left = self.end + self.triangle[:, held] @ (step * self.sizes)[held]
            step[free] = -self._solved(self.triangle[:, free], left, damping, resolution) / self.sizes[free]
            over = free & ((step < self.low) | (step > self.high))
            if not over.any():
                break
            step[over] = np.clip(step[over], self.low[over], self.high[over])
            held |= over
        return np.clip(step, self.low, self.high)

    def _solved(self, A: Any, b: Any, damping: float, resolution: float) -> Any:
        U, s, V = np.linalg.svd(A, full_matrices=False)
        known = s > resolution * s.max(initial=0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            factors = np.where(known & (s > 0), s / (s**2 + damping), 0.0)
        return V.T @ (factors * (U.T @ b))

    def promised(self, step: Any) -> float:
        """By how much the sum of squares falls with a step, if lines stay straight."""
        moved = self.triangle @ (step * self.sizes)
        return float(-(moved @ moved) - 2 * (moved @ self.end))
