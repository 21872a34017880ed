"""A smooth function along one step of an integrator: its extremes, and where it first falls through zero.

It is read at the Chebyshev points of the step, and the polynomial through them says where it turns. Where the polynomial has not
converged, as at a kink, the step is halved.

References
----------
L. N. Trefethen, Approximation Theory and Approximation Practice, SIAM 2013, chapters 3 and 18.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from stickslip.basics.contracts import Array

_DEGREE = 8  # the dense output of DOP853 has degree 7
_NODES = -np.cos(np.pi * np.arange(_DEGREE + 1) / _DEGREE)
_SERIES = np.linalg.inv(chebyshev.chebvander(_NODES, _DEGREE))
_CONVERGED = 1e-9  # the last two coefficients over the largest
_HALVINGS = 14


def points(begin: Any, end: Any) -> Array:
    """Where a function is read between two instants; of columns of instants (steps, 1) a row for each step."""
    return _at(_NODES, begin, end)


def _at(x: Array, begin: Any, end: Any) -> Array:
    """Instants of a step from numbers in [-1, 1]; its ends are met to the bit."""
    half = 0.5 * (end - begin)
    at: Array = np.where(x < 0, np.maximum(begin + half * (1.0 + x), begin), np.minimum(end - half * (1.0 - x), end))
    return at


def lowest_and_highest(values: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """The lowest and the highest value so far of each row of a table (functions, points), also between the points.

    Examples
    --------
    >>> t, start = points(0.0, 1.0), np.zeros(2)
    >>> low, high = lowest_and_highest(np.array([t * (1.0 - t), t]), start, start)
    >>> low.round(12).tolist(), high.round(12).tolist()
    ([0.0, 0.0], [0.25, 1.0])
    """
    low, high = np.minimum(low, values.min(axis=1)), np.maximum(high, values.max(axis=1))
    series = values @ _SERIES.T
    reach = abs(series[:, 1:]).sum(axis=1)
    for i in np.flatnonzero((series[:, 0] - reach < low) | (series[:, 0] + reach > high)):
        between = chebyshev.chebval(_stationary(series[i]), series[i])
        low[i], high[i] = min(low[i], between.min(initial=np.inf)), max(high[i], between.max(initial=-np.inf))
    return low, high


def over_steps(values: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """The same of many steps at once: values (steps, functions, points).

    Examples
    --------
    >>> begin, start = np.array([[0.0], [0.5]]), np.zeros(1)
    >>> t = points(begin, begin + 0.5)
    >>> low, high = over_steps((t * (0.9 - t))[:, None, :], start, start)
    >>> low.round(12).tolist(), high.round(12).tolist()
    ([-0.1], [0.2025])
    """
    low, high = np.minimum(low, values.min(axis=(0, 2))), np.maximum(high, values.max(axis=(0, 2)))
    series = values @ _SERIES.T
    reach = abs(series[..., 1:]).sum(axis=-1)
    for k in np.flatnonzero(((series[..., 0] - reach < low) | (series[..., 0] + reach > high)).any(axis=1)):
        low, high = lowest_and_highest(values[k], low, high)
    return low, high


def _stationary(c: Array) -> Array:
    """Where a Chebyshev series turns, in order."""
    c = chebyshev.chebtrim(c, 1e-15 * abs(c).max())
    if len(c) < 3:
        return np.empty(0)
    roots = chebyshev.chebroots(chebyshev.chebder(c))
    return np.sort(roots[(abs(roots.imag) < 1e-6) & (abs(roots.real) < 1.0)].real)


def first_fall(g: Callable[[float], float], begin: float, end: float, level: float, halvings: int = _HALVINGS) -> float | None:
    """The first zero after which g is below -`level`; None if there is none. What stays above -`level` is rounding.

    Parameters
    ----------
    g : callable
        Of the time; not below -`level` at the beginning.
    begin, end, level : float
    halvings : int
        How often the stretch may be halved.

    Examples
    --------
    A dip between two ends that are above zero:

    >>> round(first_fall(lambda t: (t - 0.5) ** 2 - 0.01, 0.0, 1.0, 1e-15), 12)
    0.4
    """
    t = points(begin, end)
    values = np.array([g(s) for s in t])
    c = _SERIES @ values
    size, tail = float(abs(c).sum()), float(abs(c[-2:]).sum())
    if 2.0 * c[0] - size > 10.0 * tail + level:
        return None  # positive all along
    middle = 0.5 * (begin + end)
    if tail > max(_CONVERGED * size, level) and halvings and begin < middle < end:
        first = first_fall(g, begin, middle, level, halvings - 1)
        return first if first is not None else first_fall(g, middle, end, level, halvings - 1)
    t = np.unique(np.concatenate([t, _at(_stationary(c), begin, end)]))
    return _fall(g, t, np.array([g(s) for s in t]), level)


def _fall(g: Callable[[float], float], t: Array, values: Array, level: float) -> float | None:
    """The zero before the first value that is below -`level`."""
    from scipy.optimize import brentq

    below = np.flatnonzero(values < -level)
    if not len(below):
        return None
    k = int(below[0])
    if k == 0 or values[k - 1] <= 0.0:
        return float(t[max(k - 1, 0)])
    return float(brentq(g, t[k - 1], t[k], xtol=4 * np.spacing(abs(t[k])) + 1e-300, rtol=1e-15))
