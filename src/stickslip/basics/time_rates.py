"""Functions of time with their first and second rates: numbers, arrays or symbols that carry both through plain Python."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

from stickslip.basics import maths
from stickslip.basics.contracts import Numeric
from stickslip.basics.forward_ad import Truth
from stickslip.basics.of_own import OfOwn


class TimeJet:
    """A value that varies in time, with its rate and the rate of that: a jet of second order.

    Parameters
    ----------
    value, rate, second : float, array or symbol
        The value, its first and its second derivative by time.

    Examples
    --------
    >>> t = TimeJet(2.0, 1.0, 0.0)
    >>> cubic = t**3 - t / 2.0
    >>> cubic.value, cubic.rate, cubic.second
    (7.0, 11.5, 12.0)
    """

    __array_ufunc__ = None  # NumPy's operators leave the work to ours
    __hash__ = None  # type: ignore[assignment]  # equality is a condition on the value, as the others are

    def __init__(self, value: Any, rate: Any = 0.0, second: Any = 0.0):
        self.value, self.rate, self.second = value, rate, second

    def _through(self, value: Any, first: Any, second: Any) -> TimeJet:
        """A function of it, from its value and two derivatives by its argument."""
        return TimeJet(value, first * self.rate, second * (self.rate * self.rate) + first * self.second)

    def __add__(self, other: Any) -> TimeJet:
        b = time_jet(other)
        return TimeJet(self.value + b.value, self.rate + b.rate, self.second + b.second)

    def __sub__(self, other: Any) -> TimeJet:
        b = time_jet(other)
        return TimeJet(self.value - b.value, self.rate - b.rate, self.second - b.second)

    def __mul__(self, other: Any) -> TimeJet:
        b = time_jet(other)
        second = self.second * b.value + 2.0 * (self.rate * b.rate) + self.value * b.second
        return TimeJet(self.value * b.value, self.rate * b.value + self.value * b.rate, second)

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, other: Any) -> TimeJet:
        return self * time_jet(other)._reciprocal()

    def __rtruediv__(self, other: Any) -> TimeJet:
        return time_jet(other) * self._reciprocal()

    def _reciprocal(self) -> TimeJet:
        one = 1.0 / self.value
        return self._through(one, -(one * one), 2.0 * (one * one * one))

    def __rsub__(self, other: Any) -> TimeJet:
        return time_jet(other) - self

    def __neg__(self) -> TimeJet:
        return TimeJet(-self.value, -self.rate, -self.second)

    def __pos__(self) -> TimeJet:
        return self

    def __abs__(self) -> TimeJet:
        return maths.where(self > 0.0, self, -self)

    def __pow__(self, power: Any) -> TimeJet:
        if isinstance(power, TimeJet):
            return maths.exp(power * maths.log(self))
        if isinstance(power, (int, float)) and power in (0, 1, 2):
            return (time_jet(1.0), self, self * self)[int(power)]
        x = self.value
        return self._through(x**power, power * x ** (power - 1.0), power * (power - 1.0) * x ** (power - 2.0))

    def __rpow__(self, base: Any) -> TimeJet:
        return maths.exp(self * maths.log(base))

    def __lt__(self, other: Any) -> _Condition:
        return _Condition(self.value < time_jet(other).value)

    def __le__(self, other: Any) -> _Condition:
        return _Condition(self.value <= time_jet(other).value)

    def __gt__(self, other: Any) -> _Condition:
        return _Condition(self.value > time_jet(other).value)

    def __ge__(self, other: Any) -> _Condition:
        return _Condition(self.value >= time_jet(other).value)

    def __ss_within__(self, period: Any) -> TimeJet:
        return TimeJet(maths.within(self.value, period), self.rate, self.second)


class _Condition(Truth):
    """A condition on values that vary, which may be symbols; `where` asks it to choose."""

    def __ss_where__(self, yes: Any, no: Any) -> TimeJet:
        yes, no = time_jet(yes), time_jet(no)
        return TimeJet(*(maths.where(self.holds, *both) for both in ((yes.value, no.value), (yes.rate, no.rate), (yes.second, no.second))))


def time_jet(value: Any) -> TimeJet:
    """A number as a jet; a constant has no rates."""
    return value if isinstance(value, TimeJet) else TimeJet(value)


def _tanh(x: Any) -> tuple[Any, Any, Any]:
    y = maths.tanh(x)
    slope = 1.0 - y * y
    return y, slope, -2.0 * (y * slope)


def _atan(x: Any) -> tuple[Any, Any, Any]:
    slope = 1.0 / (1.0 + x * x)
    return maths.atan(x), slope, -2.0 * (x * (slope * slope))


def _asinh(x: Any) -> tuple[Any, Any, Any]:
    slope = 1.0 / maths.sqrt(1.0 + x * x)
    return maths.asinh(x), slope, -(x * (slope * slope * slope))


def _sqrt(x: Any) -> tuple[Any, Any, Any]:
    y = maths.sqrt(x)
    return y, 0.5 / y, -0.25 / (x * y)


#: Value, slope and curvature of each function of `stickslip.maths` of one argument.
_FUNCTIONS: dict[str, Callable[[Any], tuple[Any, Any, Any]]] = {
    "exp": lambda x: (maths.exp(x),) * 3,
    "log": lambda x: (maths.log(x), 1.0 / x, -1.0 / (x * x)),
    "sqrt": _sqrt,
    "sin": lambda x: (maths.sin(x), maths.cos(x), -maths.sin(x)),
    "cos": lambda x: (maths.cos(x), -maths.sin(x), -maths.cos(x)),
    "sinh": lambda x: (maths.sinh(x), maths.cosh(x), maths.sinh(x)),
    "cosh": lambda x: (maths.cosh(x), maths.sinh(x), maths.cosh(x)),
    "tanh": _tanh,
    "atan": _atan,
    "asinh": _asinh,
}


def _hook(derivatives: Callable[[Any], tuple[Any, Any, Any]]) -> Callable[[TimeJet], TimeJet]:
    return lambda self: self._through(*derivatives(self.value))


for _name, _derivatives in _FUNCTIONS.items():
    setattr(TimeJet, f"__ss_{_name}__", _hook(_derivatives))


def defers_to_jets(cls: type) -> type:
    """Decorator of a class of symbols, whose operators leave the work to a `TimeJet` or an `OfOwn` on their right."""

    def deferring(own: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
        @functools.wraps(own)
        def operator(self: Any, other: Any) -> Any:
            return NotImplemented if type(other) in (TimeJet, OfOwn) else own(self, other)

        return operator

    for name in ("add", "sub", "mul", "truediv", "pow", "lt", "le", "gt", "ge"):
        setattr(cls, f"__{name}__", deferring(getattr(cls, f"__{name}__")))
    return cls


def with_rates(function: Callable[[Any], Any], t: Numeric) -> tuple[Any, Any, Any]:
    """The value of a function of time at an instant, its rate, and the rate of that.

    Examples
    --------
    >>> with_rates(lambda t: maths.sin(2.0 * t), 0.0)
    (0.0, 2.0, -0.0)
    """
    moved = time_jet(function(TimeJet(t, 1.0, 0.0)))
    return moved.value, moved.rate, moved.second
