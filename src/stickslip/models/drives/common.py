"""The period that several motions, forces or inputs have in common, and each one's own time in it."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.fields import everywhere, is_array
from stickslip.basics.maths import where

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
    repeats = tuple(int(whole / ratio) for ratio in ratios)  # type: ignore[operator]
    fits = (
        everywhere(abs(n * p - repeats[0] * periods[0]) <= _SAME * abs(repeats[0] * periods[0]))
        for n, p in zip(repeats, periods, strict=True)
    )
    return repeats if max(repeats) <= MOST_REPEATS and all(fits) else None


def times(count: int, period: Numeric) -> Any:
    """So many periods, and for one the very same number."""
    return period if count == 1 else count * period


def own_time(t: Numeric, period: Numeric, count: int) -> Any:
    """The time since the last of `count` periods in a row began [s].

    Examples
    --------
    >>> own_time(0.75, 0.5, 3), own_time(1.25, 0.5, 3)
    (0.25, 0.25)
    """
    elapsed = t
    for k in range(1, count):
        elapsed = where(t < times(k, period), elapsed, t - times(k, period))
    return elapsed


def repeated_instants(instants: Iterable[Any], period: Numeric, count: int) -> tuple[Any, ...]:
    """Instants of one period in each of `count` periods in a row, and the borders between these [s].

    Examples
    --------
    >>> repeated_instants([0.2], 0.5, 2)
    (0.2, 0.5, 0.7)
    """
    own = tuple(instants)
    later = ((times(k, period), *(times(k, period) + s for s in own)) for k in range(1, count))
    return (*own, *(s for each in later for s in each))


def _ratio(period: Numeric, first: Numeric) -> Fraction | None:
    """One period over another as a fraction of small numbers; of arrays that of their first cases."""
    ratio = period / first
    value = (
        float(ratio.ravel()[0])
        if is_array(ratio) and not hasattr(ratio, "dims")
        else float(getattr(ratio, "values", ratio).flat[0])
        if is_array(ratio)
        else float(ratio)
    )
    nearest = Fraction(value).limit_denominator(MOST_REPEATS)
    return nearest if nearest > 0 else None


def _lowest_common(a: Fraction, b: Fraction) -> Fraction:
    """The smallest number that is a whole number of times each of two fractions."""
    from math import gcd, lcm

    return Fraction(lcm(a.numerator, b.numerator), gcd(a.denominator, b.denominator))
