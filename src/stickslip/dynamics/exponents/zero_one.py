"""The 0-1 test for chaos of Gottwald and Melbourne: regular or chaotic, from a series of numbers alone."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.arguments import Numbers, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import Problems
from stickslip.basics.fields import floats
from stickslip.basics.frozen_arrays import sealed

_LEAST = 200  # numbers of a series
_CHAOS, _ORDER = 0.8, 0.2  # of K: above is chaotic, below regular, between is not decided
_BAND = (0.2, 0.8)  # of pi: frequencies outside come near those that every series resonates with
_CONSTANT = 1e-10  # of its size: a series that varies less has no motion in it


@sealed
class ZeroOne:
    """The result of the 0-1 test on a series.

    Parameters
    ----------
    K : float
        The median over the frequencies: near 1 for chaotic, near 0 for regular motion.
    values : array (frequencies,)
        K of each frequency.
    length : int
        How many numbers the series has.

    Examples
    --------
    >>> ZeroOne(0.99, np.array([0.98, 0.99, 1.0]), 1000).kind
    'chaotic'
    """

    K: float
    values: Array
    length: int

    @property
    def kind(self) -> str:
        """The motion by K: "chaotic" above 0.8, "regular" (periodic or quasi-periodic) below 0.2, else "undecided"."""
        return "chaotic" if self.K > _CHAOS else "regular" if self.K < _ORDER else "undecided"

    @property
    def quartiles(self) -> tuple[float, float]:
        """Between which half of the values of K lie."""
        low, high = np.percentile(self.values, [25, 75])
        return float(low), float(high)

    def __repr__(self) -> str:
        low, high = self.quartiles
        return f"<ZeroOne: {self.kind}, K = {self.K:.3f} (half of the frequencies: {low:.3f} to {high:.3f}), {self.length} numbers>"


@explains_arguments
def zero_one_test(series: Numbers, *, frequencies: int = 100) -> ZeroOne:
    """The 0-1 test for chaos: whether a series of numbers is of a chaotic or of a regular motion.

    For each frequency c the series drives p(n + 1) = p(n) + x(n) cos(c n), q(n + 1) = q(n) + x(n) sin(c n). The mean square displacement of
    (p, q) grows linearly if the motion is chaotic and stays bounded if it is not; K is its correlation with time. What the mean of the
    series adds is taken off. It needs no model and no derivative, so it is a second opinion on `verdict` and `lyapunov`, also of measured
    records.

    Parameters
    ----------
    series : array (n,)
        A number of the motion on the strobe, or of the iterates of a map, at least 200 after the transient; 1000 or more are better. A
        record that is sampled far more often than the motion changes looks regular: take every so many of its numbers.
    frequencies : int
        How many frequencies c between pi/5 and 4 pi/5, spread by the golden section.

    Returns
    -------
    ZeroOne
        `K`, `kind`, `values`.

    References
    ----------
    Gottwald, Melbourne, *On the implementation of the 0-1 test for chaos*, SIAM Journal on Applied Dynamical Systems 8 (2009) 129.

    Examples
    --------
    >>> import stickslip as ss
    >>> def logistic(r, n):
    ...     x = [0.3]
    ...     for _ in range(n):
    ...         x.append(r * x[-1] * (1 - x[-1]))
    ...     return x[500:]
    >>> [ss.dynamics.zero_one_test(logistic(r, 1500)).kind for r in (3.55, 3.97)]  # Gottwald and Melbourne's two cases
    ['regular', 'chaotic']
    """
    x = _checked(series, frequencies)
    if np.ptp(x) <= _CONSTANT * max(float(np.max(abs(x))), 1e-300):
        return ZeroOne(0.0, np.zeros(int(frequencies)), len(x))
    x = x / np.std(x)
    golden = np.modf(np.arange(1, int(frequencies) + 1) * (np.sqrt(5) - 1) / 2)[0]
    c = np.pi * (_BAND[0] + (_BAND[1] - _BAND[0]) * golden)
    values = np.array([_growth(x, each) for each in c])
    return ZeroOne(float(np.median(values)), values, len(x))


def _checked(series: Any, frequencies: Any) -> Array:
    problems = Problems("zero_one_test")
    x = floats(series)
    if x.ndim != 1 or len(x) < _LEAST or not np.isfinite(x).all():
        allowed = f"allowed are {_LEAST} or more finite numbers in a row"
        problems.add(f"series has shape {x.shape}; {allowed}; type ss.dynamics.zero_one_test(ss.dynamics.strobe(run).v.values)")
    problems.whole("frequencies", frequencies, 10, example=100)
    problems.check()
    return x


def _growth(x: Array, c: float) -> float:
    """The correlation with time of the mean square displacement at one frequency (Gottwald and Melbourne's equations 2.3 to 3.5)."""
    n = np.arange(1, len(x) + 1)
    path, most = np.cumsum(x * np.exp(1j * c * n)), len(x) // 10
    starts, steps = len(x) - most, np.arange(1, most + 1)
    square = np.array([np.mean(abs(path[k : k + starts] - path[:starts]) ** 2) for k in steps])
    swing = np.mean(x) ** 2 * (1 - np.cos(steps * c)) / (1 - np.cos(c))
    return float(np.corrcoef(steps, square - swing)[0, 1])
