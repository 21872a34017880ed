"""Formulas of several numbers: sums, products, ratios, and what holds near the fitted values where none of these does."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import combinations as chosen, permutations, product
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array

_FEW = 4  # numbers of which products of powers are tried that are not 1
_SHAPES = (1.0, 0.0, -1.0, 2.0, 0.5)  # powers of the numbers in a weighted sum; 0 for their logarithms, a product of powers
_NOTHING = 1e-3  # share of a number in a formula that is left out

Formula = tuple[str, Callable[[Any], float]]


def gradient(function: Callable[[Any], float], at: Any, size: Any) -> Any:
    """Change of a formula for a relative change of each number."""
    h = 1e-6
    moved = [(function(at + h * e * size) - function(at - h * e * size)) / (2 * h) for e in np.eye(len(at))]
    return np.array(moved)


def candidates(names: list[str], at: Any) -> Iterator[Formula]:
    """Formulas of numbers and their values, in the order in which they are easy to read."""
    order = [int(i) for i in np.argsort(abs(at), kind="stable")]
    for i, j in chosen(order, 2):
        first, last = sorted((i, j))
        yield f"{names[i]}/({names[first]} + {names[last]})", partial(_share, i, (i, j))
    for count in range(2, len(names) + 1):
        for which in chosen(range(len(names)), count):
            yield from _sums(names, which)
            yield from _powers(names, which)
    for i, j, k in permutations(range(len(names)), 3):
        if i < j:
            yield f"({names[i]} + {names[j]})*{names[k]}", partial(_of_three, i, j, k, 1)
            yield f"({names[i]} + {names[j]})/{names[k]}", partial(_of_three, i, j, k, -1)
            yield f"{names[k]}/({names[i]} + {names[j]} + {names[k]})", partial(_share, k, (i, j, k))
            yield f"{names[i]}*{names[j]} + {names[k]}", partial(_and_one, i, j, k, 1)
        yield f"{names[i]}/{names[j]} + {names[k]}", partial(_and_one, i, j, k, -1)


def _share(i: int, of: tuple[int, ...], v: Array) -> float:
    return float(v[i] / sum(v[j] for j in of))


def _of_three(i: int, j: int, k: int, power: int, v: Array) -> float:
    return float((v[i] + v[j]) * v[k] ** float(power))


def _and_one(i: int, j: int, k: int, power: int, v: Array) -> float:
    return float(v[i] * v[j] ** float(power) + v[k])


def _sums(names: list[str], which: tuple[int, ...]) -> Iterator[Formula]:
    for signs in product((1, -1), repeat=len(which) - 1):
        text = names[which[0]] + "".join(f" {'+' if s > 0 else '-'} {names[i]}" for s, i in zip(signs, which[1:], strict=True))
        yield text, partial(_weighted_sum, which, (1, *signs), 1.0)


def _powers(names: list[str], which: tuple[int, ...]) -> Iterator[Formula]:
    """Products and ratios of first powers, squares and roots; of more than four numbers, of first powers."""
    usual = (1, -1, 2, -2, 0.5, -0.5) if len(which) <= _FEW else (1, -1)
    for powers in sorted(product(usual, repeat=len(which)), key=lambda e: (sum(map(abs, e)), sum(p < 0 for p in e))):
        if max(powers) >= 1 and sum(p < 0 for p in powers) <= sum(p > 0 for p in powers):
            yield _product([names[i] for i in which], powers), partial(_power, which, powers)


def _power(which: tuple[int, ...], powers: tuple[float, ...], v: Array) -> float:
    return float(np.prod([np.sign(v[i]) * abs(v[i]) ** e if e % 2 else abs(v[i]) ** e for i, e in zip(which, powers, strict=True)]))


def _product(names: list[str], powers: Any) -> str:
    """A product of powers as it is written."""
    over = "*".join(_raised(n, e) for n, e in zip(names, powers, strict=True) if e > 0)
    under = [_raised(n, -e) for n, e in zip(names, powers, strict=True) if e < 0]
    return over + (f"/({'*'.join(under)})" if len(under) > 1 else f"/{under[0]}" if under else "")


def _raised(name: str, power: float) -> str:
    return name if power == 1 else f"{name}**{f'({power:.4g})' if power < 0 else f'{power:.4g}'}"


def local_formulas(names: list[str], at: Any, size: Any, lost: Any) -> Iterator[list[Formula]]:
    """Sets of formulas whose gradients at the fitted values are orthogonal to undetermined directions: weighted sums of powers."""
    rows = _echelon(np.linalg.svd(lost)[2][len(lost) :])
    for power in _SHAPES if (at > 0).all() else (1.0,):
        yield [_weighted(names, row, at, size, power) for row in rows]


def _echelon(rows: Any) -> Any:
    """Rows with the same span, of which each has a number of its own."""
    from scipy.linalg import qr

    own = qr(rows, mode="economic", pivoting=True)[2][: len(rows)]
    return np.linalg.solve(rows[:, own], rows)


def _weighted(names: list[str], row: Any, at: Any, size: Any, power: float) -> Formula:
    """A weighted sum of powers, or a product of powers, whose relative gradient is a row."""
    which = tuple(int(i) for i in np.flatnonzero(abs(row) > _NOTHING * abs(row).max()))
    kept = [names[i] for i in which]
    weights = np.array([row[i] / (size[i] if power == 1 else at[i] ** power) for i in which])
    weights /= weights[np.argmax(abs(weights))]
    factors = tuple(float(f"{x:.4g}") for x in weights)
    if power == 0:
        return _product(kept, factors), partial(_power, which, factors)
    text = " + ".join(_term(factor, _raised(name, power)) for factor, name in zip(factors, kept, strict=True))
    return text.replace("+ -", "- "), partial(_weighted_sum, which, factors, power)


def _term(factor: float, name: str) -> str:
    return name if factor == 1 else f"-{name}" if factor == -1 else f"{factor:.4g}*{name}"


def _weighted_sum(which: tuple[int, ...], factors: tuple[float, ...], power: float, v: Array) -> float:
    return float(sum(c * v[i] ** power for c, i in zip(factors, which, strict=True)))
