"""The period that several motions or forces have in common."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from stickslip.fields import everywhere, is_array

__all__ = ["MOST_REPEATS", "repeats_of"]

MOST_REPEATS = 64  # of each part in the common period
_SAME = 1e-12  # of the period: by so much the parts may miss one another when it is over


def repeats_of(periods: list[Any]) -> tuple[int, ...] | None:
    """How often each part repeats in the smallest period that all have in common; None where there is none with so few repeats.

    Periods may be arrays of cases, which then repeat equally often in all cases.

    Examples
    --------
    >>> repeats_of([0.06, 0.02, 0.03]), repeats_of([1.0, 2.0**0.5])
    ((1, 3, 2), None)
    """
    whole = Fraction(1)  # the common period, in periods of the first part
    ratios = [_ratio(period, periods[0]) for period in periods]
    if None in ratios:
        return None
    for ratio in ratios:
        whole = _lowest_common(whole, ratio)  # type: ignore[arg-type]
    found = tuple(int(whole / ratio) for ratio in ratios)  # type: ignore[operator]
    fits = (
        everywhere(abs(n * p - found[0] * periods[0]) <= _SAME * abs(found[0] * periods[0])) for n, p in zip(found, periods, strict=True)
    )
    return found if max(found) <= MOST_REPEATS and all(fits) else None


def _ratio(period: Any, first: Any) -> Fraction | None:
    """One period over another as a fraction of small numbers; of arrays that of their first cases."""
    ratio = period / first
    value = (
        float(ratio.ravel()[0])
        if is_array(ratio) and not hasattr(ratio, "dims")
        else float(getattr(ratio, "values", ratio).flat[0])
        if is_array(ratio)
        else float(ratio)
    )
    found = Fraction(value).limit_denominator(MOST_REPEATS)
    return found if found > 0 else None


def _lowest_common(a: Fraction, b: Fraction) -> Fraction:
    """The smallest number that is a whole number of times each of two fractions."""
    from math import gcd, lcm

    return Fraction(lcm(a.numerator, b.numerator), gcd(a.denominator, b.denominator))
