r"""Values that a sensor rounds to counts: their rounding stays the same while what is measured rests, or moves by less than a count.

With noise of size s in front of it, a sensor that rounds h to multiples of c shows on average :math:`h + b(h)`,

.. math:: b(h) = \sum_k \frac{(-1)^k c}{\pi k} \exp\!\left(-2 \pi^2 k^2 s^2 / c^2\right) \sin(2 \pi k h / c)

(Widrow and Kollár, *Quantization Noise*, 2008). Nobody knows where between two counts a servo rests, so that b is noise; it is not
white, because it is the same for equal h. With noise of half a count nothing is left of it; without noise it is all that there is.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array

_HARMONICS = 16  # of b that are counted; what comes after them is a twentieth of its square, and counts as white
_COARSE = 1.2  # counts for each standard deviation of all that is left of a value, below which b is nothing
_LEVELS, _LITTLE = 12, 0.15  # values in a record, and parts of a count left of it, with fewer and less than which it has steps of its own
_SAME = 1e-9  # of the range of values: differences that are rounding of numbers
_FEW, _WHOLE = 8.5, 0.15  # counts in a step between neighbours that is looked at, and by how many it may be off a whole number


def count_of(y: Array) -> float:
    """The least step between neighbours, in the unit of the values: of rounded ones one count."""
    steps = abs(np.diff(y))
    return float(np.min(steps[steps > _SAME * np.ptp(y)], initial=np.ptp(y)))


def rounded_to(y: Array) -> float:
    """The count to which values are rounded, in their unit: neighbours differ by whole numbers of it; 0 for values that are not."""
    count = count_of(y)
    steps = abs(np.diff(y)) / count if count > 0 else np.empty(0)
    steps = steps[(steps > 0.5) & (steps < _FEW)]
    whole = np.round(steps)
    return float(count * np.mean(steps / whole)) if len(steps) > 1 and abs(steps - whole).max() < _WHOLE else 0.0


def rounding_columns(problem: Any, residuals: Array, scale: float) -> list[Any]:
    """For each record the directions of b, in standard deviations of its values: arrays (values, directions).

    The sum of the squares of a row is the variance of b, and the product of two rows its covariance for the h of these values, for any
    place of the counts. Without directions where a record is not rounded, or noise of a count hides that.
    """
    parts = (problem.parts(each) for each in (residuals[: len(problem.y)], problem.sigma, problem.y))
    averaged = (target.within > 0.0 for target in problem.targets)
    return [
        np.empty((len(y), 0)) if lost else _columns(rest, sigma, y, scale) for lost, rest, sigma, y in zip(averaged, *parts, strict=True)
    ]


def _columns(rest: Array, sigma: Array, y: Array, scale: float) -> Any:
    """Of one record."""
    count, size = rounded_to(y), scale * float(np.median(sigma))
    if not count > _COARSE * size or (size < _LITTLE * count and len(np.unique(np.round((y - y[0]) / count))) < _LEVELS):
        return np.empty((len(y), 0))
    before = max(size**2 - count**2 / 12, 0.0)  # noise in front of the rounding, squared
    k = np.arange(1, _HARMONICS + 1)
    sizes = count / (np.pi * k) * np.exp(-2 * np.pi**2 * k**2 * before / count**2) / np.sqrt(2)
    turn = 2 * np.pi * ((y + rest * sigma - y[0]) / count)[:, None] * k
    return np.concatenate([sizes * np.cos(turn), sizes * np.sin(turn)], axis=1) / sigma[:, None]


def beside_white(columns: Any, square: float) -> tuple[float, float]:
    """Mean square of what the directions make, and of the white rest of a mean square of both; not less than a twentieth of that."""
    own = float(np.mean(np.sum(columns**2, axis=1))) if columns.shape[1] else 0.0
    return own, max(square - own, 0.05 * square)
