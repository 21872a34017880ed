"""Sums, products and linear equations of floats, arrays or symbols, in which zero costs nothing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np


def is_nothing(value: Any) -> bool:
    """Whether a value is zero: a plain zero, an array of zeros (none if it is empty), or a symbol that knows it (``__ss_is_zero__``)."""
    if isinstance(value, (int, float)):
        return value == 0
    hook = getattr(value, "__ss_is_zero__", None)
    return bool(hook()) if hook is not None else isinstance(value, np.ndarray) and value.size > 0 and not value.any()


def product(a: Any, b: Any) -> Any:
    """a times b; zero or one is not multiplied.

    Examples
    --------
    >>> product(0.0, float("nan")), product(1.0, 3.0), product(2.0, 3.0)
    (0.0, 3.0, 6.0)
    """
    if is_nothing(a) or is_nothing(b):
        return 0.0
    if isinstance(a, float) and a == 1.0:
        return b
    return a if isinstance(b, float) and b == 1.0 else a * b


def total(terms: Iterable[Any]) -> Any:
    """The sum of terms, without zeros.

    Examples
    --------
    >>> total([0.0, 2.0, 3.0]), total([])
    (5.0, 0.0)
    """
    whole: Any = 0.0
    for term in terms:
        whole = term if is_nothing(whole) else whole if is_nothing(term) else whole + term
    return whole


def solved(matrix: Sequence[Sequence[Any]], right: Sequence[Any]) -> tuple[Any, ...]:
    """The solution of linear equations with a symmetric, positive definite matrix.

    Symbols solve them themselves (``__ss_solved__``).

    Examples
    --------
    >>> solved(((2.0, 1.0), (1.0, 3.0)), (3.0, 5.0))
    (0.8, 1.4)
    """
    hooks = (getattr(value, "__ss_solved__", None) for value in (*(entry for row in matrix for entry in row), *right))
    hook = next((hook for hook in hooks if hook is not None), None)
    return eliminated(matrix, right) if hook is None else hook(matrix, right)


def eliminated(matrix: Sequence[Sequence[Any]], right: Sequence[Any]) -> tuple[Any, ...]:
    """The solution of linear equations by elimination without pivots, for matrices that need none.

    Examples
    --------
    >>> eliminated(((2.0, 1.0), (1.0, 3.0)), (3.0, 5.0))
    (0.8, 1.4)
    """
    n, rows, b = len(right), [list(row) for row in matrix], list(right)
    for p in range(n):
        for i in range(p + 1, n):
            if is_nothing(rows[i][p]):
                continue
            factor = rows[i][p] / rows[p][p]
            for k in range(p, n):
                rows[i][k] = 0.0 if k == p else total([rows[i][k], product(-1.0, product(factor, rows[p][k]))])
            b[i] = total([b[i], product(-1.0, product(factor, b[p]))])
    for p in reversed(range(n)):
        b[p] = total([b[p], *(product(-1.0, product(rows[p][k], b[k])) for k in range(p + 1, n))])
        b[p] = 0.0 if is_nothing(b[p]) else b[p] / rows[p][p]
    return tuple(b)


def determinant(matrix: Sequence[Sequence[Any]]) -> Any:
    """The determinant of a small matrix, by its first row.

    Examples
    --------
    >>> determinant(((2.0, 1.0), (1.0, 3.0)))
    5.0
    """
    first, *others = matrix
    if not others:
        return first[0]
    minors = (determinant([[*row[:j], *row[j + 1 :]] for row in others]) if not is_nothing(of) else 0.0 for j, of in enumerate(first))
    return total(product(product(-1.0 if j % 2 else 1.0, of), minor) for j, (of, minor) in enumerate(zip(first, minors, strict=True)))
