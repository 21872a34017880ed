"""Ball arithmetic: numbers with a propagated error bound, so that statements about them are proved.

A ball is an `arb` of Arb (F. Johansson, IEEE Trans. Comput. 66 (2017) 1281), which python-flint brings.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.optional import library
from stickslip.engine.symbols import Sym
from stickslip.engine.values import Arithmetic, needed_by

Ball = Any
_NAMES = {"absolute": "__abs__", "arctan": "atan", "arcsin": "asin", "arccos": "acos"}
_MOST = 20_000  # parts of an interval after which a sign is given up


def flint_for(what: str) -> Any:
    """python-flint; an error that says what to type where it is not installed."""
    return library(what, "flint", 'it needs python-flint, which is not installed; type pip install "stickslip[certify]"')


@sealed
@dataclass(frozen=True)
class Enclosure:
    """A number with proved lower and upper bounds.

    Parameters
    ----------
    low, high : float
        The bounds, rounded outwards, so that they differ at least in their last digit.
    text : str
        Its proved digits, with the bound of their error where that is not one of the last digit.

    Examples
    --------
    >>> 0.3 in Enclosure(0.29, 0.31, "0.3 +/- 0.01"), 0.4 in Enclosure(0.29, 0.31, "0.3 +/- 0.01")
    (True, False)
    """

    low: float
    high: float
    text: str

    def __contains__(self, value: float) -> bool:
        return self.low <= value <= self.high

    def __float__(self) -> float:
        return 0.5 * (self.low + self.high)

    def __str__(self) -> str:
        return self.text

    @classmethod
    def of(cls, ball: Ball, digits: int) -> Enclosure:
        """That of a ball."""
        low, high = math.nextafter(float(ball.lower()), -math.inf), math.nextafter(float(ball.upper()), math.inf)
        return cls(low, high, ball.str(digits, radius=True).strip("[]"))


def balls_of(arb: Any, known: dict[str, float], roots: Iterable[Sym]) -> dict[int, Ball]:
    """The values of traced expressions, by their numbers, where each number of the case is the decimal that is printed for it.

    Multiples of pi among the constants are taken as such.
    """
    return _Balls(arb, known).values(needed_by(roots))


class _Balls(Arithmetic):
    """Ball arithmetic."""

    one = 1

    def __init__(self, arb: Any, known: dict[str, float]):
        super().__init__(known)
        self.arb = arb

    def constant(self, value: Any) -> Ball:
        return _constant(self.arb, float(value))

    def named(self, name: str) -> Ball:
        return self.arb(repr(float(self.known[name])))

    def select(self, condition: Ball, above: Ball, below: Ball) -> Ball:
        return above if condition > 0 else below if condition <= 0 else above.union(below)

    def function(self, name: str, x: Ball) -> Ball:
        return getattr(x, _NAMES.get(name, name))()


def _constant(arb: Any, value: float) -> Ball:
    for parts in (1, 2, 3, 4, 6, 12):
        whole = round(value / math.pi * parts)
        if whole and value == whole * math.pi / parts:
            return arb(whole) * arb.pi() / parts
    return arb(repr(value))


def krawczyk(
    flint: Any, f: Callable[[list[Ball]], list[Ball]], slope: Callable[[list[Ball]], Any], middle: list[Ball], radius: Ball
) -> Any:
    r"""Balls around an approximate zero of f that are proved to hold one zero, and only one; None where they are not.

    .. math:: K(X) = m - Y f(m) + (I - Y f'(X))(X - m)

    lies within the inner of X (R. Krawczyk, Computing 4 (1969) 187), with Y near the inverse of f'(m).

    Parameters
    ----------
    f, slope : callable
        The function, and its matrix of derivatives.
    middle : list
        Where it nearly vanishes; Newton's steps sharpen it.
    radius : ball
        Half the width of the balls.
    """
    n = len(middle)
    for _ in range(8):
        middle = [x - dx for x, dx in zip(middle, (slope(middle).inv() * flint.arb_mat(n, 1, f(middle))).entries(), strict=True)]
        middle = [x.mid() for x in middle]
    inverse = slope(middle).inv().mid()
    box = [x + flint.arb(0, radius) for x in middle]
    one = flint.arb_mat(n, n, [int(i == j) for i in range(n) for j in range(n)])
    off = flint.arb_mat(n, 1, [flint.arb(0, radius)] * n)
    enclosure = flint.arb_mat(n, 1, middle) - inverse * flint.arb_mat(n, 1, f(middle)) + (one - inverse * slope(box)) * off
    inside = all(whole.contains_interior(part) for whole, part in zip(box, enclosure.entries(), strict=True))
    return list(enclosure.entries()) if inside else None


def above_zero(
    arb: Any, f: Callable[[Ball], Ball], slope: Callable[[Ball], Ball], begin: Ball, end: Ball, root: bool = False, divided: Any = None
) -> Ball | None:
    """A lower bound of f over the whole of an interval if it is above 0 there, found by halving; else None.

    Parameters
    ----------
    f, slope : callable
        The function and its derivative; f(m) + f'(X) (X - m) is enclosed too, which is sharp near a minimum.
    root : bool
        Whether f vanishes at the end: there it is enough that it falls.
    divided : callable, optional
        A function of the sign of f whose values are sharper near the beginning, such as f / x^2 where f vanishes at 0.
    """
    lowest = None
    waiting = [(begin.lower(), end.upper())]
    for _ in range(_MOST):
        if not waiting:
            return lowest
        a, b = waiting.pop()
        x = a.union(b)
        middle = x.mid()
        bound = _larger(f(x).lower(), (f(middle) + slope(x) * (x - middle)).lower())
        if bound > 0 or (divided is not None and divided(x) > 0):
            bound = bound.nonnegative_part()
        elif root and b >= end.lower() and slope(x) < 0:
            bound = arb(0)
        else:
            waiting += [(a, middle), (middle, b)]
            continue
        lowest = bound if lowest is None else lowest.min(bound)
    return None


def _larger(a: Ball, b: Ball) -> Ball:
    return a if a >= b or b.is_nan() else b
