"""How long a body rests where its measured velocity passes zero, and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array

_RISE = 4.0  # of chi squared at the ends of an interval: 95 % for one number


@dataclass(frozen=True)
class Rest:
    """A place where the velocity is near zero.

    Parameters
    ----------
    start, length : float
        The rest that fits best, in drive periods; length 0 where the body only passes zero.
    least, most : float
        95 % interval of the length.
    before, after : int
        Sign of the velocity on either side.
    """

    start: float
    length: float
    least: float
    most: float
    before: int
    after: int

    def lasts(self, dwell: float) -> bool | None:
        """Whether it lasts at least `dwell`; None where the data leave that open."""
        if self.least >= dwell:
            return True
        return False if self.most < dwell else None


def rest_at(phase: Any, v: Array, error: Any, start: float, end: float, window: float, signs: tuple[int, int]) -> Rest:
    r"""Fit a curve with a plateau at zero to the mean cycle about one place.

    Left of a and right of b the velocity is a polynomial of third degree through zero; between them it is zero. Both ends go over a
    grid, so that the least sum of squares is known for every length :math:`b-a`: its 95 % interval is where that rises by less than 4.

    Parameters
    ----------
    phase, v, error : array (bins,)
        The mean cycle, its phases rising through the place.
    start, end : float
        Roughly where the velocity is near zero.
    window : float
        How much on either side is looked at.
    signs : tuple of int
        Of the velocity before and after.

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 201)
    >>> v = np.where(t < 0.4, 0.4 - t, 0.0) - np.where(t > 0.6, t - 0.6, 0.0)
    >>> found = rest_at(t, v, np.full(201, 1e-3), 0.4, 0.6, 0.1, (1, -1))
    >>> round(found.length, 2), found.lasts(0.03)
    (0.2, True)
    """
    inside = (phase >= start - window) & (phase <= end + window)
    x, y, e = phase[inside], v[inside], error[inside]
    step = float(np.median(np.diff(x)))
    a = np.arange(x[0] + 0.15 * window, x[-1] - 0.15 * window + 0.5 * step, 0.5 * step)
    left, right = _branch(x, y, e, a, before=True), _branch(x, y, e, a, before=False)
    sums = np.concatenate([[0.0], np.cumsum((y / e) ** 2)])
    middle = sums[np.searchsorted(x, a)]
    cost = left[:, None] + right[None, :] + middle[None, :] - middle[:, None]
    lengths = np.arange(len(a)) * 0.5 * step
    least = np.array([np.diagonal(cost, k).min() for k in range(len(a))])
    best = int(np.argmin(least))
    scale = max(1.0, least[best] / max(len(x) - 8, 1))
    allowed = np.flatnonzero(least <= least[best] + _RISE * scale)
    where = int(np.argmin(np.diagonal(cost, best)))
    first, last = allowed[0], allowed[-1]
    ends = lengths[first] - (0.5 * step if first else 0.0), lengths[last] + 0.5 * step
    return Rest(float(a[where]), float(lengths[best]), float(ends[0]), float(ends[1]), *signs)


def _branch(x: Array, y: Array, e: Any, knots: Any, before: bool) -> Any:
    """Least sum of squares of a polynomial without constant term on one side of each knot."""
    sums = np.empty(len(knots))
    for i, knot in enumerate(knots):
        part = x < knot if before else x >= knot
        s = x[part] - knot
        matrix = np.stack([s, s**2, s**3], axis=1) / e[part, None]
        z = y[part] / e[part]
        fitted = matrix @ np.linalg.lstsq(matrix, z, rcond=None)[0] if len(s) else z
        sums[i] = float(np.sum((z - fitted) ** 2))
    return sums
