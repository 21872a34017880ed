"""Derivatives of plain Python: numbers that carry their slopes, so that a law's own lines give its Jacobian.

A law is written once. Called with these numbers instead of floats it gives the derivative of every line at every instant
at once; nothing is differenced and nothing is typed again.
"""

from __future__ import annotations

from collections.abc import Callable
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
        yes, no = _lift(yes), _lift(no)
        count = max(len(yes.slopes), len(no.slopes))
        slopes = [np.where(self.holds, yes.slope(i), no.slope(i)) for i in range(count)]
        return Dual(np.where(self.holds, yes.value, no.value), slopes)

    def __and__(self, other: Any) -> Truth:
        return Truth(self.holds & _holds(other))

    def __or__(self, other: Any) -> Truth:
        return Truth(self.holds | _holds(other))

    def __invert__(self) -> Truth:
        return Truth(np.logical_not(self.holds))  # of a Python bool ~ is a number that always holds

    def __bool__(self) -> bool:
        """The truth value of one number; NumPy refuses it for an array."""
        return bool(self.holds)

    __mul__ = __rand__ = __and__
    __ror__ = __or__


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

    def _with(
        self, other: Any, value: Callable[[Any, Any], Any], left: Callable[[Any, Any], Any], right: Callable[[Any, Any], Any]
    ) -> Dual:
        b = _lift(other)
        dl, dr = left(self.value, b.value), right(self.value, b.value)
        count = max(len(self.slopes), len(b.slopes))
        return Dual(value(self.value, b.value), [dl * self.slope(i) + dr * b.slope(i) for i in range(count)])

    def _through(self, value: Any, slope: Any) -> Dual:
        return Dual(value, [slope * s for s in self.slopes])

    def __add__(self, other: Any) -> Dual:
        return self._with(other, lambda a, b: a + b, lambda a, b: 1.0, lambda a, b: 1.0)

    def __sub__(self, other: Any) -> Dual:
        return self._with(other, lambda a, b: a - b, lambda a, b: 1.0, lambda a, b: -1.0)

    def __mul__(self, other: Any) -> Dual:
        return self._with(other, lambda a, b: a * b, lambda a, b: b, lambda a, b: a)

    def __truediv__(self, other: Any) -> Dual:
        return self._with(other, lambda a, b: a / b, lambda a, b: 1.0 / b, lambda a, b: -a / (b * b))

    def __rsub__(self, other: Any) -> Dual:
        return _lift(other) - self

    def __rtruediv__(self, other: Any) -> Dual:
        return _lift(other) / self

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
        return self._through(np.abs(self.value), np.sign(self.value))


def _compared(compare: Callable[[Any, Any], Any]) -> Callable[[Dual, Any], Truth]:
    return lambda self, other: Truth(compare(self.value, _lift(other).value))


for _sign, _compare in {
    "gt": np.greater, "ge": np.greater_equal, "lt": np.less, "le": np.less_equal, "eq": np.equal, "ne": np.not_equal,
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
        with np.errstate(all="ignore"):  # in a branch that is not taken
            return self._through(value, _SLOPES[name](np.asarray(self.value), np.asarray(value)))

    return through


for _name in _SLOPES:
    setattr(Dual, f"__ss_{_name}__", _hook(_name))


def _lift(value: Any) -> Dual:
    return value if isinstance(value, Dual) else Dual(value, [])


def variables(*values: Numeric) -> list[Dual]:
    """Numbers as independent variables: the slope of each by itself is 1.

    Examples
    --------
    >>> x, y = variables(np.array([1.0, 2.0]), np.array([3.0, 4.0]))
    >>> (x * y).slope(0).tolist(), (x * y).slope(1).tolist()
    ([3.0, 4.0], [1.0, 2.0])
    """
    return [Dual(value, [1.0 if i == k else 0.0 for i in range(len(values))]) for k, value in enumerate(values)]


def slopes_of(number: Any, count: int) -> list[Any]:
    """The derivatives of a result by each of `count` variables; a plain number has none."""
    return [_lift(number).slope(i) for i in range(count)]
