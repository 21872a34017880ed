"""Formats of numbers in the report."""

from __future__ import annotations

import math
from typing import Any

__all__ = ["digits_within", "millimetres", "percent", "plain", "power", "speed"]


def speed(v: Any, digits: int = 4) -> str:
    """A velocity in mm/s.

    Examples
    --------
    >>> speed(0.0017413), speed(-1.02e-7)
    ('1.741 mm/s', '−1.020·10⁻⁴ mm/s')
    """
    return f"{plain(1e3 * float(v), digits)} mm/s"


def millimetres(length: Any, digits: int = 4) -> str:
    """A length in mm, to 0.1 micrometre."""
    return f"{1e3 * float(length):.{digits}f} mm"


def percent(fraction: Any, digits: int = 2, sign: bool = False) -> str:
    """A fraction in per cent, optionally with a plus sign for positive values."""
    return f"{'+' if sign and fraction > 0 else ''}{plain(100 * float(fraction), digits)} %"


def plain(x: Any, digits: int = 4) -> str:
    """A number with significant digits, as a power of ten if it is very small or very large."""
    x = float(x)
    if not math.isfinite(x) or x == 0:
        return "0" if x == 0 else "none"
    exponent = math.floor(math.log10(abs(x)) + 1e-12)
    if -3 <= exponent <= 5:
        return f"{x:.{max(digits - 1 - exponent, 0)}f}".replace("-", "−")
    mantissa = f"{x / 10.0**exponent:.{digits - 1}f}".replace("-", "−")
    return f"{mantissa}·{power(exponent)}"


def digits_within(x: float, accuracy: float, most: int = 7) -> str:
    """A number without digits beyond its accuracy: the error is at most one unit of the last digit.

    Examples
    --------
    >>> digits_within(0.84415080, 6e-9), digits_within(0.84415080, 2e-4), digits_within(0.5, 0.0)
    ('0.8441508', '0.844', '0.5000000')
    """
    decimals = most if accuracy <= 0 else min(most, max(0, math.floor(-math.log10(accuracy))))
    return f"{x:.{decimals}f}".replace("-", "−")


def power(exponent: int) -> str:
    """A power of ten with a raised exponent."""
    return "10" + str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
