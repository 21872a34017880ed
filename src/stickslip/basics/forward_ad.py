"""Derivatives of plain Python: numbers that carry their slopes, so that a law's own lines give its Jacobian.

A law is written once. Called with these numbers instead of floats it gives the derivative of every line at every instant
at once; nothing is differenced and nothing is typed again.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from contextlib import suppress
from itertools import zip_longest
from typing import Any

import numpy as np

from stickslip.basics import maths
from stickslip.basics.contracts import Numeric


class Truth:
    """A condition on numbers with slopes; `where` asks it to choose."""

    __array_ufunc__ = None

    def __init__(self, holds: Any):
        self.holds = holds

    def __ss_where__(self, yes: Any, no: Any) -> Any:
        kind = next((type(x) for x in (yes, no) if isinstance(x, NestedDual)), Dual)
        yes, no = kind.lifted(yes), kind.lifted(no)
        count = max(len(yes.slopes), len(no.slopes))
        slopes = [_chosen(self.holds, yes.slope(i), no.slope(i)) for i in range(count)]
        return kind(_chosen(self.holds, yes.value, no.value), slopes)

    def __and__(self, other: Any) -> Any:
        return type(self)(self.holds & _holds(other))

    def __or__(self, other: Any) -> Any:
        return type(self)(self.holds | _holds(other))

    def __invert__(self) -> Any:
        holds = self.holds
        return type(self)(not holds if isinstance(holds, bool) else ~holds)  # of a Python bool ~ is a number that always holds

    def __bool__(self) -> bool:
        """The truth value of one number; NumPy refuses it for an array."""
        return bool(self.holds)

    __mul__ = __rand__ = __and__
    __ror__ = __or__


def _chosen(holds: Any, yes: Any, no: Any) -> Any:
    """`yes` where a condition holds on numbers, arrays or numbers with slopes."""
    return holds.__ss_where__(yes, no) if isinstance(holds, Truth) else _picked(holds, yes, no)


def _picked(holds: Any, yes: Any, no: Any) -> Any:
    """The same where what holds is known; NumPy knows nothing of numbers with slopes."""
    if isinstance(yes, Dual) or isinstance(no, Dual):
        return Truth(holds).__ss_where__(yes, no)
    if isinstance(holds, bool) and isinstance(yes, float) and isinstance(no, float):
        return yes if holds else no
    return np.where(holds, yes, no)


def _sums(a: list[Any], b: list[Any]) -> list[Any]:
    """Slopes of a sum; those that a number does not list are zero."""
    if not b:
        return a
    return [x + y for x, y in zip(a, b, strict=True)] if len(a) == len(b) else [x + y for x, y in zip_longest(a, b, fillvalue=0.0)]


def _holds(other: Any) -> Any:
    return other.holds if isinstance(other, Truth) else other


class Dual:
    """A number (or an array of them) with its derivatives by some variables."""

    __array_ufunc__ = None  # NumPy's operators leave the work to ours
    __hash__ = None  # type: ignore[assignment]  # equality is a condition on the value, as the others are

    def __init__(self, value: Numeric, slopes: list[Any]):
        self.value: Any = value
        self.slopes = slopes

    def slope(self, i: int) -> Any:
        """The derivative by variable i."""
        return self.slopes[i] if i < len(self.slopes) else 0.0

    def _through(self, value: Any, slope: Any) -> Dual:
        return type(self)(value, [slope * s for s in self.slopes])

    @classmethod
    def lifted(cls, value: Any) -> Any:
        """A number as one with slopes of this kind."""
        return value if isinstance(value, cls) else cls(value, [])

    def __add__(self, other: Any) -> Dual:
        if isinstance(other, type(self)):
            return type(self)(self.value + other.value, _sums(self.slopes, other.slopes))
        return type(self)(self.value + other, self.slopes)

    def __sub__(self, other: Any) -> Dual:
        if isinstance(other, type(self)):
            return type(self)(self.value - other.value, _sums(self.slopes, [-s for s in other.slopes]))
        return type(self)(self.value - other, self.slopes)

    def __mul__(self, other: Any) -> Dual:
        a = self.value
        if isinstance(other, type(self)):
            b = other.value
            return type(self)(a * b, _sums([b * s for s in self.slopes], [a * s for s in other.slopes]))
        return type(self)(a * other, [other * s for s in self.slopes])

    def __truediv__(self, other: Any) -> Dual:
        a = self.value
        if isinstance(other, type(self)):
            b = other.value
            by_a, by_b = 1.0 / b, -a / (b * b)
            return type(self)(a / b, _sums([by_a * s for s in self.slopes], [by_b * s for s in other.slopes]))
        by_a = 1.0 / other
        return type(self)(a / other, [by_a * s for s in self.slopes])

    def __rsub__(self, other: Any) -> Dual:
        return self.lifted(other) - self

    def __rtruediv__(self, other: Any) -> Dual:
        return self.lifted(other) / self

    def __pow__(self, power: Any) -> Dual:
        if isinstance(power, Dual):
            return maths.exp(power * maths.log(self))
        return self._through(self.value**power, power * self.value ** (power - 1) if np.ndim(power) or power != 0 else 0.0)

    def __rpow__(self, base: Any) -> Dual:
        return maths.exp(self * np.log(base))

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self) -> Dual:
        return self._through(-self.value, -1.0)

    def __pos__(self) -> Dual:
        return self

    def __abs__(self) -> Dual:
        value = self.value
        return self._through(abs(value), _chosen(value > 0, 1.0, _chosen(value < 0, -1.0, value)))


def _compared(compare: Callable[[Any, Any], Any]) -> Callable[[Dual, Any], Truth]:
    return lambda self, other: Truth(compare(self.value, self.lifted(other).value))


for _sign, _compare in {
    "gt": operator.gt, "ge": operator.ge, "lt": operator.lt, "le": operator.le, "eq": operator.eq, "ne": operator.ne,
}.items():  # fmt: skip
    setattr(Dual, f"__{_sign}__", _compared(_compare))


#: Slope of each function of `stickslip.maths` from its argument x and its value y.
_SLOPES: dict[str, Callable[[Any, Any], Any]] = {
    "exp": lambda x, y: y,
    "log": lambda x, y: 1.0 / x,
    "sqrt": lambda x, y: 0.5 / y,
    "sin": lambda x, y: maths.cos(x),
    "cos": lambda x, y: -maths.sin(x),
    "atan": lambda x, y: 1.0 / (1.0 + x * x),
    "sinh": lambda x, y: maths.cosh(x),
    "cosh": lambda x, y: maths.sinh(x),
    "tanh": lambda x, y: 1.0 - y * y,
    "asinh": lambda x, y: 1.0 / maths.hypot(x, 1.0),
}


def _hook(name: str) -> Callable[[Dual], Dual]:
    def through(self: Dual) -> Dual:
        value = getattr(maths, name)(self.value)
        if isinstance(value, Dual):
            return self._through(value, _SLOPES[name](self.value, value))
        if isinstance(value, float):
            with suppress(ZeroDivisionError):
                return self._through(value, _SLOPES[name](self.value, value))
        with np.errstate(all="ignore"):  # in a branch that is not taken
            return self._through(value, _SLOPES[name](np.asarray(self.value), np.asarray(value)))

    return through


for _name in _SLOPES:
    setattr(Dual, f"__ss_{_name}__", _hook(_name))


class NestedDual(Dual):
    """A dual number whose value and slopes may be dual numbers: what is differentiated may hold a derivative itself.

    Examples
    --------
    The slope of x^3 by x, which is 3 x^2, has the slope 6 x:

    >>> (x,) = variables(2.0)
    >>> cubed = NestedDual(x, [1.0]) ** 3
    >>> cubed.slope(0).value, cubed.slope(0).slope(0)
    (12.0, 12.0)
    """

    # Python asks the number on the right first where its class is a subclass with operations of its own.
    def __radd__(self, other: Any) -> Dual:
        return self + other

    def __rmul__(self, other: Any) -> Dual:
        return self * other

    def __rsub__(self, other: Any) -> Dual:
        return self.lifted(other) - self

    def __rtruediv__(self, other: Any) -> Dual:
        return self.lifted(other) / self

    def __pow__(self, power: Any) -> Dual:
        if isinstance(power, Dual):
            return maths.exp(power * maths.log(self))
        return self._through(self.value**power, power * self.value ** (power - 1) if power != 0 else 0.0)

    def __rpow__(self, base: Any) -> Dual:
        return maths.exp(self * maths.log(base))


def variables(*values: Numeric) -> list[Dual]:
    """Numbers as independent variables: the slope of each by itself is 1.

    Examples
    --------
    >>> x, y = variables(np.array([1.0, 2.0]), np.array([3.0, 4.0]))
    >>> (x * y).slope(0).tolist(), (x * y).slope(1).tolist()
    ([3.0, 4.0], [1.0, 2.0])
    """
    return [Dual(value, [1.0 if i == k else 0.0 for i in range(len(values))]) for k, value in enumerate(values)]


def without_slopes(number: Any) -> Any:
    """The value of a number alone."""
    while isinstance(number, Dual):
        number = number.value
    return number


def slopes_of(number: Any, count: int) -> list[Any]:
    """The derivatives of a result by each of `count` variables; a plain number has none."""
    return [Dual.lifted(number).slope(i) for i in range(count)]
