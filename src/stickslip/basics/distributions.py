"""Distributions of uncertain numbers, in the notation that users type."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.contracts import ArrayLike

#: Allowed notation for an uncertain number.
ALLOWED = '("normal", mean, standard deviation), ("uniform", low, high) or (value, "1%")'
_WIDE = 8.0  # half width of the search range of a normal distribution, in standard deviations
_EDGE = 1e-12  # probabilities are clipped to this distance from 0 and 1, so that quantiles stay finite


@dataclass(frozen=True)
class Distribution:
    """One number's distribution: "uniform" from a to b, or "normal" with mean a and standard deviation b."""

    kind: str
    a: float
    b: float

    @property
    def uniform(self) -> bool:
        """Whether the distribution is uniform, with two finite bounds."""
        return self.kind == "uniform"

    @property
    def mean(self) -> float:
        """Its mean."""
        return 0.5 * (self.a + self.b) if self.uniform else self.a

    @property
    def sd(self) -> float:
        """Its standard deviation; that of a uniform distribution is the GUM's type B evaluation."""
        return (self.b - self.a) / math.sqrt(12) if self.uniform else self.b

    @property
    def low(self) -> float:
        """Lower bound of its values; -inf if normal."""
        return self.a if self.uniform else -math.inf

    @property
    def high(self) -> float:
        """Upper bound of its values; inf if normal."""
        return self.b if self.uniform else math.inf

    @property
    def bounds(self) -> tuple[float, float]:
        """Search range: its bounds if uniform; if normal, eight standard deviations around the mean, on the mean's side of zero."""
        if self.uniform:
            return self.a, self.b
        low, high = self.a - _WIDE * self.b, self.a + _WIDE * self.b
        return (max(low, 1e-3 * self.a) if self.a > 0 else low), (min(high, 1e-3 * self.a) if self.a < 0 else high)

    def at(self, u: ArrayLike) -> Any:
        """Quantiles of the distribution at the probabilities u."""
        from scipy.special import ndtri

        u = np.clip(u, _EDGE, 1.0 - _EDGE)
        return self.a + (self.b - self.a) * u if self.uniform else self.a + self.b * ndtri(u)


def distribution_of(given: Any) -> Distribution | None:
    """The given distribution; None if the value is not one. (value, "1%") is normal with that fraction of the value as standard deviation.

    Examples
    --------
    >>> distribution_of(("normal", 1, 0.02)), distribution_of((5e-4, "2%")).sd
    (Distribution(kind='normal', a=1.0, b=0.02), 1e-05)
    >>> distribution_of(["uniform", 0, 6]).mean, distribution_of((0.1, 0.5)) is None
    (3.0, True)
    """
    if not isinstance(given, (tuple, list)):
        return None
    try:
        if len(given) == 2 and isinstance(given[1], str) and given[1].strip().endswith("%"):
            given = ("normal", given[0], abs(float(given[0])) * float(given[1].strip()[:-1]) / 100.0)
        kind, a, b = given[0], *map(float, given[1:])
    except (TypeError, ValueError):
        return None
    good = math.isfinite(a) and math.isfinite(b) and ((kind == "uniform" and a < b) or (kind == "normal" and b > 0.0))
    return Distribution(kind, a, b) if good else None
