"""Numbers that carry their slopes by each coordinate and two rates in time: one call of a function gives all that motion asks of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from stickslip.basics import maths
from stickslip.basics.maths import function_value


class Jet:
    """A value with its slopes by the coordinates, its rate while they move, and the rate of that while their own rates stay.

    Parameters
    ----------
    value : float
    slopes : sequence of float
        Derivatives by each coordinate.
    rate, second : float
        First and second derivative by time.

    Examples
    --------
    At x = 3 and y = 2, which move at 1 and 10:

    >>> x, y = coordinates([3.0, 2.0], [1.0, 10.0])
    >>> area = x * y
    >>> area.value, area.slopes, area.rate, area.second
    (6.0, [2.0, 3.0], 32.0, 20.0)
    """

    __slots__ = ("rate", "second", "slopes", "value")
    __array_ufunc__ = None
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, value: Any, slopes: Sequence[Any], rate: Any, second: Any):
        self.value, self.slopes, self.rate, self.second = value, slopes, rate, second

    def _through(self, value: Any, first: Any, second: Any) -> Jet:
        """A function of it, from its value and two derivatives."""
        rate = self.rate
        return Jet(value, [first * s for s in self.slopes], first * rate, second * rate * rate + first * self.second)

    def __add__(self, other: Any) -> Jet:
        if isinstance(other, Jet):
            slopes = [a + b for a, b in zip(self.slopes, other.slopes, strict=True)]
            return Jet(self.value + other.value, slopes, self.rate + other.rate, self.second + other.second)
        return Jet(self.value + other, self.slopes, self.rate, self.second)

    def __mul__(self, other: Any) -> Jet:
        a = self.value
        if isinstance(other, Jet):
            b = other.value
            slopes = [a * t + b * s for s, t in zip(self.slopes, other.slopes, strict=True)]
            second = self.second * b + 2.0 * self.rate * other.rate + a * other.second
            return Jet(a * b, slopes, self.rate * b + a * other.rate, second)
        return Jet(a * other, [other * s for s in self.slopes], self.rate * other, self.second * other)

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self) -> Jet:
        return self * -1.0

    def __pos__(self) -> Jet:
        return self

    def __sub__(self, other: Any) -> Jet:
        return self + (-other)

    def __rsub__(self, other: Any) -> Jet:
        return -self + other

    def __truediv__(self, other: Any) -> Jet:
        return self * (other**-1.0 if isinstance(other, Jet) else 1.0 / other)

    def __rtruediv__(self, other: Any) -> Jet:
        return self**-1.0 * other

    def __pow__(self, power: Any) -> Jet:
        if isinstance(power, Jet):
            return maths.exp(maths.log(self) * power)
        if power in (0, 1, 2):
            return (self * 0.0 + 1.0, self, self * self)[int(power)]
        x = self.value
        return self._through(x**power, power * x ** (power - 1), power * (power - 1) * x ** (power - 2))

    def __rpow__(self, base: Any) -> Jet:
        return maths.exp(self * maths.log(base))

    def __abs__(self) -> Jet:
        return self if self.value > 0.0 else -self

    def __gt__(self, other: Any) -> bool:
        return bool(self.value > _value(other))

    def __lt__(self, other: Any) -> bool:
        return bool(self.value < _value(other))

    def __ge__(self, other: Any) -> bool:
        return bool(self.value >= _value(other))

    def __le__(self, other: Any) -> bool:
        return bool(self.value <= _value(other))

    def __ss_within__(self, period: Any) -> Jet:
        return Jet(maths.within(self.value, period), self.slopes, self.rate, self.second)


def _value(number: Any) -> Any:
    return number.value if isinstance(number, Jet) else number


#: Of each function of `stickslip.maths` its first and second derivative, from the argument x and the value y.
_DERIVATIVES: dict[str, Callable[[Any, Any], tuple[Any, Any]]] = {
    "exp": lambda x, y: (y, y),
    "log": lambda x, y: (1.0 / x, -1.0 / x**2),
    "sqrt": lambda x, y: (0.5 / y, -0.25 / (x * y)),
    "sin": lambda x, y: (function_value("cos", x), -y),
    "cos": lambda x, y: (-function_value("sin", x), -y),
    "sinh": lambda x, y: (function_value("cosh", x), y),
    "cosh": lambda x, y: (function_value("sinh", x), y),
    "tanh": lambda x, y: (1.0 - y * y, -2.0 * y * (1.0 - y * y)),
    "atan": lambda x, y: (1.0 / (1.0 + x * x), -2.0 * x / (1.0 + x * x) ** 2),
    "asinh": lambda x, y: ((1.0 + x * x) ** -0.5, -x * (1.0 + x * x) ** -1.5),
}


def _hook(name: str) -> Callable[[Jet], Jet]:
    derivatives = _DERIVATIVES[name]

    def through(self: Jet) -> Jet:
        y = function_value(name, self.value)
        return self._through(y, *derivatives(self.value, y))

    return through


for _name in _DERIVATIVES:
    setattr(Jet, f"__ss_{_name}__", _hook(_name))


def coordinates(q: Sequence[Any], u: Sequence[Any]) -> list[Jet]:
    """Coordinates that move with given rates."""
    n = len(q)
    return [Jet(x, [float(i == j) for j in range(n)], rate, 0.0) for i, (x, rate) in enumerate(zip(q, u, strict=True))]


def lifted(value: Any, n: int) -> Jet:
    """A number that may be constant, with slopes by n coordinates."""
    return value if isinstance(value, Jet) else Jet(value, [0.0] * n, 0.0, 0.0)
