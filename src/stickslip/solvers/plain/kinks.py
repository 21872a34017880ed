"""Kinks of forces and loads: where a condition on positions or velocities changes, in built-in and user-defined functions.

A function is called with numbers that remember what they are compared with. The answers are held while an integrator steps, so that it
sees one smooth branch, and the differences are guards: an elastic stop, a `where` or `maximum` of a user's own, or a plain `if`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import function_value

Sides = tuple[bool, ...]


class _Book:
    """The conditions of one call, in the order in which they were asked."""

    def __init__(self, sides: Sides | None):
        self.sides, self.differences = sides, list[float]()

    def answer(self, difference: float) -> bool:
        """Whether a difference counts as positive: as held, else as it is."""
        k = len(self.differences)
        self.differences.append(difference)
        return self.sides[k] if self.sides is not None and k < len(self.sides) else difference > 0


_new = float.__new__


class _Number(float):
    """A float that notes what it is compared with."""

    __slots__ = ("book",)
    book: _Book

    def __new__(cls, value: float, book: _Book) -> _Number:
        new = _new(cls, value)
        new.book = book
        return new

    def __gt__(self, other: Any) -> bool:
        return self.book.answer(float(self) - float(other))

    def __lt__(self, other: Any) -> bool:
        return self.book.answer(float(other) - float(self))

    def __ge__(self, other: Any) -> bool:
        return not self < other

    def __le__(self, other: Any) -> bool:
        return not self > other

    def __abs__(self) -> _Number:
        return self if self > 0 else -self  # type: ignore[return-value]


def _lifted(name: str) -> Callable[..., Any]:
    plain = getattr(float, name)

    def operation(self: _Number, *others: Any) -> Any:
        result = plain(self, *others)
        if result is NotImplemented:
            return result
        new = _new(_Number, result)
        new.book = self.book
        return new

    return operation


def _function(name: str) -> Callable[[_Number], _Number]:
    return lambda self: _Number(function_value(name, float(self)), self.book)


for _name in ("add", "sub", "mul", "truediv", "pow", "floordiv", "mod"):
    setattr(_Number, f"__{_name}__", _lifted(f"__{_name}__"))
    setattr(_Number, f"__r{_name}__", _lifted(f"__r{_name}__"))
for _name in ("neg", "pos"):
    setattr(_Number, f"__{_name}__", _lifted(f"__{_name}__"))
for _name in ("sin", "cos", "exp", "log", "sqrt", "tanh", "atan", "sinh", "cosh", "asinh"):
    setattr(_Number, f"__ss_{_name}__", _function(_name))


def noting(value: float, like: Any) -> Any:
    """A value that notes what it is compared with, if the number of which it was made does."""
    return _Number(float(value), like.book) if isinstance(like, _Number) else value


class Watching:
    """A function of time and of vectors, asked with the answers to its conditions held.

    Examples
    --------
    >>> pressed = Watching(lambda t, q: [max(q[0] - 1.0, 0.0)])
    >>> pressed.differences(None, 0.0, [3.0]), pressed((False,), 0.0, [3.0])
    ([-2.0], [2.0])
    """

    def __init__(self, function: Callable[..., Any]):
        self.function = function

    def __call__(self, sides: Sides, t: Numeric, *vectors: Sequence[float]) -> list[float]:
        """Its values; with plain numbers where it has no condition."""
        if sides:
            return self._asked(_Book(sides), t, vectors)
        return [float(value) for value in self.function(t, *vectors)]

    def differences(self, sides: Sides | None, t: Numeric, *vectors: Sequence[float]) -> list[float]:
        """The differences whose signs its conditions test."""
        book = _Book(sides)
        self._asked(book, t, vectors)
        return book.differences

    def _asked(self, book: _Book, t: Numeric, vectors: Sequence[Sequence[float]]) -> list[float]:
        return [float(value) for value in self.function(t, *([_Number(value, book) for value in vector] for vector in vectors))]
