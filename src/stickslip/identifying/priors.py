"""Numbers that are known beforehand, but not exactly: what a user types, and what it says to a fit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

__all__ = ["ALLOWED", "Prior", "prior_of"]

#: What may be typed for an uncertain number.
ALLOWED = '("normal", mean, standard deviation), ("uniform", low, high) or (value, "1%")'
_WIDE = 8.0  # standard deviations within which a number with a normal distribution is looked for


@dataclass(frozen=True)
class Prior:
    """What is known of a number beforehand.

    Parameters
    ----------
    mean, sd : float
        Mean and standard deviation; those of a uniform distribution count as in the GUM's type B evaluation.
    low, high : float
        It is not below, nor above these.
    """

    mean: float
    sd: float
    low: float = -math.inf
    high: float = math.inf

    @property
    def bounds(self) -> tuple[float, float]:
        """Where a search looks: within eight standard deviations, and of a normal distribution on the side of zero where its mean is."""
        if math.isfinite(self.low):
            return self.low, self.high
        low, high = self.mean - _WIDE * self.sd, self.mean + _WIDE * self.sd
        return (max(low, 1e-3 * self.mean) if self.mean > 0 else low), (min(high, 1e-3 * self.mean) if self.mean < 0 else high)


def prior_of(given: Any) -> Prior | None:
    """The distribution that was typed; None if it is none.

    Examples
    --------
    >>> prior_of(("normal", 1, 0.02)), prior_of((5e-4, "2%")).sd
    (Prior(mean=1.0, sd=0.02, low=-inf, high=inf), 1e-05)
    >>> prior_of(("uniform", 0, 6)).mean, prior_of((0.1, 0.5)) is None
    (3.0, True)
    """
    if not isinstance(given, (tuple, list)):
        return None
    try:
        if len(given) == 2 and isinstance(given[1], str) and given[1].strip().endswith("%"):
            value, part = float(given[0]), float(given[1].strip()[:-1]) / 100
            return _made(value, part * abs(value))
        if len(given) != 3:
            return None
        kind, a, b = given[0], float(given[1]), float(given[2])
    except (TypeError, ValueError):
        return None
    if kind == "normal":
        return _made(a, b)
    if kind == "uniform" and math.isfinite(a) and math.isfinite(b) and a < b:
        return Prior(0.5 * (a + b), (b - a) / math.sqrt(12), a, b)
    return None


def _made(mean: float, sd: float) -> Prior | None:
    return Prior(mean, sd) if math.isfinite(mean) and math.isfinite(sd) and sd > 0 else None
