"""Functions shared by several laws: a coefficient for each direction, the Stribeck curve, and powers that are safe at zero."""

from __future__ import annotations

from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import exp, log, where

_BLUNT = 1e-24  # a power that is singular at 0 is rounded off below the root of this, so that it has a slope there


def by_side(v: Numeric, plus: Any, minus: Any) -> Any:
    """The forward value where v > 0, else the backward one."""
    return where(v > 0, plus, minus)


def static(f: Numeric | None, mu: Numeric) -> Any:
    """The break-away coefficient; ``None`` means that it is the kinetic one."""
    return mu if f is None else f


def stribeck(v: Numeric, mu: Numeric, f: Numeric | None, v_s: Numeric | None) -> Any:
    """Steady friction coefficient: from f at rest to mu at speed (the bracket of Eq. 2.6)."""
    return mu + (f - mu) * exp(-((v / v_s) ** 2))


def fading(law: Any, v: Any, exponent: Any = None) -> Any:
    """Steady friction coefficient of a law with mu, f and v_s on the side of v; with an exponent other than 2 if one is given."""
    mu = by_side(v, law.mu_plus, law.mu_minus)
    f = by_side(v, static(law.f_plus, law.mu_plus), static(law.f_minus, law.mu_minus))
    return stribeck(v, mu, f, law.v_s) if exponent is None else mu + (f - mu) * exp(-power(v / law.v_s, exponent))


def power(x: Numeric, exponent: Numeric) -> Any:
    """``|x|**exponent`` for a positive exponent: 1 and 2 to the last bit, others with a finite slope at x = 0."""
    if hasattr(x, "__ss_power__"):
        return x.__ss_power__(exponent)
    other = exp(0.5 * exponent * log(x * x + _BLUNT))
    return where(_is(exponent, 1.0), abs(x), where(_is(exponent, 2.0), x * x, other))


def signed_power(x: Numeric, exponent: Numeric) -> Any:
    """``|x|**exponent * sgn(x)`` for a positive exponent, with a finite slope at x = 0."""
    if hasattr(x, "__ss_power__"):
        return x * x.__ss_power__(exponent - 1.0)
    return x * exp(0.5 * (exponent - 1.0) * log(x * x + _BLUNT))


def each(z: Numeric | tuple[Numeric, ...]) -> tuple[Any, ...]:
    """The inner states as a tuple; a law with one state is given a number."""
    return z if isinstance(z, tuple) else (z,)


def alone_or_all(values: tuple[Any, ...]) -> Any:
    """A number for one state, a tuple for several."""
    return values[0] if len(values) == 1 else values


def _is(number: Any, value: float) -> Any:
    """Whether a number of the case is this one (a symbol cannot be asked with ==)."""
    return abs(number - value) < 1e-12
