"""Combinations that data determine although they do not determine the numbers one by one: products, ratios and sums."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, combinations as chosen, islice
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.inverse.identification.covariance import determined_spread
from stickslip.inverse.identification.formula_shapes import Formula, candidates, gradient, local_formulas
from stickslip.inverse.identification.search import polished_to_end

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit


_ALONG = (3e-3, 0.05)  # parts of what a formula can change by that it may change by along an undetermined direction: exact, and less so
_MOVED = (0.07, 0.3)  # by how much numbers are moved to see whether nothing measured changes while the formulas do not
_SEEN = 0.05  # standard deviations, squared, by which the fit may then be worse
_TRIED = 8  # sets of formulas


@dataclass(frozen=True)
class Combination:
    """A formula of undetermined parameters that data determine.

    Parameters
    ----------
    formula : str
    value, error : float
    holds : bool
        Whether it holds where the numbers are moved far along, too, and not only near the fitted values.
    """

    formula: str
    value: float
    error: float
    holds: bool


def combinations(fit: Fit) -> tuple[Combination, ...]:
    """Combinations of undetermined parameters that the data determine, each with whether it also holds far from the fit.

    A formula is a product, a ratio or a sum whose gradient is orthogonal to every undetermined direction, and that holds along the way
    too: where numbers are moved by 7 and by 30 % and the formulas are kept, the fit is as good as before. Where there is none as simple,
    weighted sums and products of powers are tried; and where none holds, the one that does so best is told as one that holds near here.
    """
    combinations, n = list[Combination](), len(fit.names)
    spread = determined_spread(fit.problem, fit.jacobian, fit.residuals, fit.scale, fit.changes, fit.misfit)
    for members, directions in fit.information.groups:
        own = [k for k in members if k < n]
        at = np.array([fit.values[fit.names[k]] for k in own])
        size = np.where(at != 0, abs(at), 1.0)
        lost = _basis(directions[:, [members.index(k) for k in own]] * fit.slopes[own] / size)
        if not own or len(lost) == len(own):
            continue
        formulas, holds = _formulas(fit, _Way(fit, members, directions, own, at, size, lost))
        for text, function in formulas:
            slopes = np.zeros(len(fit.point))
            slopes[own] = gradient(function, at, size) / size * fit.slopes[own]
            combinations.append(Combination(text, float(function(at)), float(np.sqrt(max(slopes @ spread @ slopes, 0.0))), holds))
    return tuple(combinations)


def _basis(rows: Any) -> Any:
    """Orthonormal rows of what these rows span."""
    _, values, directions = np.linalg.svd(np.atleast_2d(rows), full_matrices=False)
    return directions[values > 1e-3 * values.max(initial=0.0)] if values.max(initial=0.0) > 0 else np.empty((0, rows.shape[1]))


def _formulas(fit: Fit, way: _Way) -> tuple[list[Formula], bool]:
    """As many formulas as there are determined combinations, and whether they hold."""
    names = [fit.names[k] for k in way.own]
    tried = []
    for formulas in chain(islice(_simple(names, way), _TRIED), local_formulas(names, way.at, way.size, way.lost)):
        rise = way.rise(formulas)
        if rise < _SEEN:
            return formulas, True
        tried.append((rise, formulas))
    return min(tried, key=lambda pair: pair[0])[1], False


def _simple(names: list[str], way: _Way) -> Iterator[list[Formula]]:
    """Sets of simple formulas that say different things and do not change along the undetermined directions; exact ones first."""
    wanted, fitting = len(way.own) - len(way.lost), list[tuple[float, Formula, Any]]()
    for formula in candidates(names, way.at):
        slopes = gradient(formula[1], way.at, way.size)
        length = float(np.linalg.norm(slopes))
        if length > 0 and (along := float(np.linalg.norm(way.lost @ slopes)) / length) < _ALONG[1]:
            fitting.append((along, formula, slopes / length))
    exact = [each for each in fitting if each[0] < _ALONG[0]]
    for several in chain(chosen(exact, wanted), chosen(sorted(fitting, key=lambda each: each[0]), wanted)):
        if np.linalg.svd(np.stack([g for _, _, g in several]), compute_uv=False).min() >= 0.05:
            yield [formula for _, formula, _ in several]


@dataclass(frozen=True, eq=False)
class _Way:
    """Undetermined numbers of a fit, their values, and the directions in which they can be moved: rows in relative changes."""

    fit: Any
    members: list[int]
    directions: Any
    own: list[int]
    at: Any
    size: Any
    lost: Any

    def rise(self, formulas: list[Formula]) -> float:
        """By how many standard deviations, squared, the fit gets worse where numbers move and formulas do not; beyond `_SEEN`, at least.

        Zero where the bounds leave no room to see.
        """
        worst = 0.0
        for part in _MOVED:
            for direction in self.lost:
                for sign in (1.0, -1.0):
                    v = self._kept(formulas, self.at + sign * part * self.size * direction / abs(direction).max())
                    worst = max(worst, self._risen(v))
                    if worst >= _SEEN:
                        return worst
        return worst

    def _kept(self, formulas: list[Formula], v: Array) -> Any:
        """The nearest values to these at which the formulas are what they are at the fit; not finite where there are none."""
        wanted = np.array([function(self.at) for _, function in formulas])
        with np.errstate(all="ignore"):
            for _ in range(20):
                rest = np.array([function(v) for _, function in formulas]) - wanted
                slopes = np.stack([gradient(function, v, self.size) for _, function in formulas])
                if not np.isfinite(rest).all() or not np.isfinite(slopes).all():
                    break
                v = v - self.size * (np.linalg.pinv(slopes) @ rest)
        return v if np.isfinite(rest).all() else np.full(len(v), np.inf)

    def _risen(self, v: Array) -> float:
        """By how much the best fit with these values is worse; zero beyond the bounds."""
        fit, free = self.fit, self.fit.problem.parameters.free
        if not np.isfinite(v).all():
            return np.inf
        if not all(free[k].low <= x <= free[k].high for k, x in zip(self.own, v, strict=True)):
            return 0.0
        point = np.array(fit.point)
        point[self.own] = [float(free[k].inner(x)) for k, x in zip(self.own, v, strict=True)]
        index = [self.members.index(k) for k in self.own]
        rest = [j for j in range(len(self.members)) if j not in index]
        others = [self.members[j] for j in rest]
        point[others] += (point - fit.point)[self.own] @ np.linalg.pinv(self.directions[:, index]) @ self.directions[:, rest]
        problem = fit.problem.only({free[k].name: float(x) for k, x in zip(self.own, v, strict=True)})
        end = polished_to_end(problem, np.delete(point, self.own))
        return float(max(end.cost - fit.cost - 1e-6 * fit.cost, 0.0) / fit.scale**2)
