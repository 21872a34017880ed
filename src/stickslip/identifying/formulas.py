"""What data determine of numbers that they do not determine one by one: products, ratios and sums that nothing undetermined changes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import combinations as chosen, permutations, product
from typing import Any

import numpy as np

from stickslip.identifying.search import polished
from stickslip.identifying.spread import determined_spread

__all__ = ["combinations"]

_ALONG = 3e-3  # a formula may change along an undetermined direction by this part of what it can change by
_MOVED = 0.07  # by how much numbers are moved to see whether nothing measured changes while the formulas do not
_SEEN = 0.05  # standard deviations, squared, by which the fit may then be worse
_TRIED = 8  # sets of formulas
_FEW = 4  # numbers of which products of powers are tried that are not 1

Formula = tuple[str, Callable[[Any], float]]


def combinations(fit: Any) -> list[tuple[str, float, float]]:
    """Formula, value and standard error of what the data determine of the undetermined parameters.

    A formula is a product, a ratio or a sum whose gradient is orthogonal to every undetermined direction, and that holds along the way
    too: where numbers are moved by 7 % and the formulas are kept, the fit is as good as before. Where there is none as simple, it is the
    product of powers (or the sum) that holds near the fitted values.
    """
    found, n = [], len(fit.names)
    spread = determined_spread(fit.problem, fit.jacobian, fit.residuals, fit.scale)
    for members, directions in fit.information.groups:
        own = [k for k in members if k < n]
        at = np.array([fit.values[fit.names[k]] for k in own])
        size = np.where(at != 0, abs(at), 1.0)
        rows = directions[:, [members.index(k) for k in own]] * fit.slopes[own] / size
        lost = _basis(rows)
        if not own or len(lost) == len(own):
            continue
        for text, function in _formulas(fit, own, at, size, lost):
            gradient = np.zeros(len(fit.place))
            gradient[own] = _gradient(function, at, size) / size * fit.slopes[own]
            found.append((text, float(function(at)), float(np.sqrt(max(gradient @ spread @ gradient, 0.0)))))
    return found


def _basis(rows: Any) -> Any:
    """Orthonormal rows of what these rows span."""
    _, values, directions = np.linalg.svd(np.atleast_2d(rows), full_matrices=False)
    return directions[values > 1e-3 * values.max(initial=0.0)] if values.max(initial=0.0) > 0 else np.empty((0, rows.shape[1]))


def _gradient(function: Callable[[Any], float], at: Any, size: Any) -> Any:
    """Change of a formula for a relative change of each number."""
    h = 1e-6
    moved = [(function(at + h * e * size) - function(at - h * e * size)) / (2 * h) for e in np.eye(len(at))]
    return np.array(moved)


def _formulas(fit: Any, own: list[int], at: Any, size: Any, lost: Any) -> list[Formula]:
    """As many formulas as there are determined combinations."""
    names, wanted = [fit.names[k] for k in own], len(own) - len(lost)
    fitting = []
    for text, function in _candidates(names, at):
        gradient = _gradient(function, at, size)
        length = float(np.linalg.norm(gradient))
        if length > 0 and np.linalg.norm(lost @ gradient) < _ALONG * length:
            fitting.append((text, function, gradient / length))
    tried = 0
    for several in chosen(fitting, wanted):
        if np.linalg.svd(np.stack([g for _, _, g in several]), compute_uv=False).min() < 0.05:
            continue
        formulas = [(text, function) for text, function, _ in several]
        if _holds(fit, own, formulas, at, size, lost):
            return formulas
        if (tried := tried + 1) >= _TRIED:
            break
    return _near_here(names, at, size, lost)


def _candidates(names: list[str], at: Any) -> Iterator[Formula]:
    """Formulas in the order in which they are easy to read."""
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


def _share(i: int, of: tuple[int, ...], v: Any) -> float:
    return float(v[i] / sum(v[j] for j in of))


def _of_three(i: int, j: int, k: int, power: int, v: Any) -> float:
    return float((v[i] + v[j]) * v[k] ** float(power))


def _and_one(i: int, j: int, k: int, power: int, v: Any) -> float:
    return float(v[i] * v[j] ** float(power) + v[k])


def _sums(names: list[str], which: tuple[int, ...]) -> Iterator[Formula]:
    for signs in product((1, -1), repeat=len(which) - 1):
        text = names[which[0]] + "".join(f" {'+' if s > 0 else '-'} {names[i]}" for s, i in zip(signs, which[1:], strict=True))
        yield text, partial(_sum, which, (1, *signs))


def _sum(which: tuple[int, ...], factors: tuple[float, ...], v: Any) -> float:
    return float(sum(c * v[i] for c, i in zip(factors, which, strict=True)))


def _powers(names: list[str], which: tuple[int, ...]) -> Iterator[Formula]:
    """Products and ratios of first powers, squares and roots; of more than four numbers, of first powers."""
    usual = (1, -1, 2, -2, 0.5, -0.5) if len(which) <= _FEW else (1, -1)
    for powers in sorted(product(usual, repeat=len(which)), key=lambda e: (sum(map(abs, e)), sum(p < 0 for p in e))):
        if max(powers) >= 1 and sum(p < 0 for p in powers) <= sum(p > 0 for p in powers):
            yield _product([names[i] for i in which], powers), partial(_power, which, powers)


def _power(which: tuple[int, ...], powers: tuple[float, ...], v: Any) -> float:
    return float(np.prod([np.sign(v[i]) * abs(v[i]) ** e if e % 2 else abs(v[i]) ** e for i, e in zip(which, powers, strict=True)]))


def _product(names: list[str], powers: Any) -> str:
    """A product of powers as it is written."""
    over = "*".join(_raised(n, e) for n, e in zip(names, powers, strict=True) if e > 0)
    under = [_raised(n, -e) for n, e in zip(names, powers, strict=True) if e < 0]
    return over + (f"/({'*'.join(under)})" if len(under) > 1 else f"/{under[0]}" if under else "")


def _raised(name: str, power: float) -> str:
    return name if power == 1 else f"{name}**{power:.3g}"


def _holds(fit: Any, own: list[int], formulas: list[Formula], at: Any, size: Any, lost: Any) -> bool:
    """Whether the fit stays as good where numbers move and the formulas do not."""
    wanted = np.array([function(at) for _, function in formulas])
    for sign in (1.0, -1.0):
        v = at + sign * _MOVED * size * lost.sum(axis=0) / abs(lost.sum(axis=0)).max()
        for _ in range(20):
            rest = np.array([function(v) for _, function in formulas]) - wanted
            slopes = np.stack([_gradient(function, v, size) for _, function in formulas])
            v = v - size * (np.linalg.pinv(slopes) @ rest)
        free = [fit.problem.parameters.free[k] for k in own]
        if not np.isfinite(v).all() or not all(f.low <= x <= f.high for f, x in zip(free, v, strict=True)):
            continue
        problem = fit.problem.only({f.name: float(x) for f, x in zip(free, v, strict=True)})
        found = polished(problem, np.delete(fit.place, own), rough=True)
        return bool(found.cost - fit.cost < _SEEN * fit.scale**2 + 1e-6 * fit.cost)
    return True  # the bounds leave no room to see


def _near_here(names: list[str], at: Any, size: Any, lost: Any) -> list[Formula]:
    """Products of powers, or sums, that do not change along the undetermined directions at the fitted values."""
    rows = np.linalg.svd(lost)[2][len(lost) :]
    found: list[Formula] = []
    for row in rows / abs(rows).max(axis=1, keepdims=True):
        shape = row * np.sign(row[np.argmax(abs(row))]) if (at > 0).all() else row / size
        factors = tuple(float(f"{x:.3g}") for x in shape / abs(shape).max())
        which = tuple(i for i, x in enumerate(factors) if abs(x) > 1e-3)
        own, kept = tuple(factors[i] for i in which), [names[i] for i in which]
        if (at > 0).all():
            found.append((_product(kept, own), partial(_power, which, own)))
        else:
            text = " + ".join(f"{x:.3g}*{name}" for x, name in zip(own, kept, strict=True))
            found.append((text.replace("+ -", "- "), partial(_sum, which, own)))
    return found
