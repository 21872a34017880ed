"""Information about the parameters of a fit: the covariance, and the undetermined directions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.one_thread import in_one_thread

#: Singular values of the derivatives, each parameter scaled on its own, count as zero below this fraction of the largest: derivatives by
#: central differences have a relative accuracy of 1e-8, by one-sided ones of 1e-5.
SINGULAR = 1e-6
PART = 1e-3  # a parameter with a smaller share of a direction does not lie in it
_EXACT = 1e-13  # singular values below this fraction of the largest are zero if rounding is the only error
_NOTHING = 1e-12  # of the largest column: a parameter with a smaller column has no effect


@dataclass(frozen=True, eq=False)
class Information:
    r"""The information :math:`J^TJ` in the derivatives J of residuals (in standard deviations) by parameters, decomposed.

    With :math:`J = U S V^T`, after each column was divided by its length, directions in V whose singular value is zero to the accuracy
    of the derivatives are *undetermined*: their variance is infinite, and so is that of every parameter that lies in one of them. (The
    pseudo-inverse of the information would make it zero.) The variances of the others come from the remaining directions.

    Parameters
    ----------
    jacobian : array (values, parameters)
        Derivatives of the residuals.
    singular : float
        Singular values below this fraction of the largest are zero.
    prior : array (rows, parameters), optional
        Derivatives of the prior knowledge, in the same units of noise. They are exact, so that no row is too small to count, and may
        determine directions that the data do not.

    Examples
    --------
    Only the sum of the first two numbers has an effect, and the third by itself:

    >>> found = Information(np.array([[1.0, 1.0, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 0.5]]))
    >>> found.undetermined.tolist(), found.errors().tolist()
    ([True, True, False], [inf, inf, 2.0])
    """

    jacobian: Any
    singular: float = SINGULAR
    prior: Any = None

    @cached_property
    def _rows(self) -> Any:
        """All derivatives, those of the prior knowledge last."""
        data = np.asarray(self.jacobian)
        return data if self.prior is None else np.concatenate([data, self.prior])

    @cached_property
    def _sizes(self) -> Any:
        """Lengths of the columns; infinite for zero columns."""
        data = np.sqrt(np.sum(np.asarray(self.jacobian) ** 2, axis=0))
        size = np.where(data > _NOTHING * data.max(initial=0.0), data, 0.0)
        known = 0.0 if self.prior is None else np.sqrt(np.sum(np.asarray(self.prior) ** 2, axis=0))
        size = np.hypot(size, known)
        return np.where(size > 0, size, np.inf)

    @cached_property
    def _parts(self) -> tuple[Any, Any, Any]:
        """A singular value for each parameter, the directions as rows, and which of them are undetermined."""
        values, directions = decomposed(np.asarray(self.jacobian) / self._sizes)
        lost = values <= self.singular * values.max(initial=0.0)
        if self.prior is None or not len(self.prior):
            return values, directions, lost
        determined = np.where(lost, 0.0, values)[:, None] * directions
        values, directions = decomposed(np.concatenate([determined, _without_traces(self.prior / self._sizes, directions[lost])]))
        return values, directions, values <= _EXACT * values.max(initial=0.0)

    @cached_property
    def directions(self) -> Any:
        """Undetermined directions as rows, in parameters times the lengths of their columns: array (directions, parameters)."""
        _, directions, lost = self._parts
        return directions[lost]

    @cached_property
    def projector(self) -> Any:
        """Projector on the undetermined directions: parameters coupled by an off-diagonal entry are undetermined together."""
        return self.directions.T @ self.directions

    @cached_property
    def undetermined(self) -> Any:
        """Which parameters lie in an undetermined direction: array (parameters,) of bool."""
        return np.diag(self.projector) > PART**2

    @cached_property
    def inverse(self) -> Any:
        """The pseudo-inverse of the derivatives: least-squares steps without components in undetermined directions."""
        values, directions, lost = self._parts
        kept = directions[~lost]
        scaled = self._rows / self._sizes
        return (kept.T / values[~lost] ** 2) @ kept @ scaled.T / self._sizes[:, None]

    def covariance(self, scale: float = 1.0) -> Any:
        """Covariance of the parameters for noise that is `scale` times the unit of the residuals.

        An undetermined parameter has infinite variance, and no (NaN) covariance with others.
        """
        return self.marked(self.of_the_determined(scale))

    def of_the_determined(self, scale: float = 1.0) -> Any:
        """Covariance without undetermined directions; it holds for every combination that does not change along them."""
        values, directions, lost = self._parts
        kept = directions[~lost] / self._sizes
        return (kept.T * (scale / values[~lost]) ** 2) @ kept

    def marked(self, covariance: Any) -> Any:
        """A covariance with infinite variance for the undetermined parameters, and no (NaN) covariance with others."""
        marked = np.array(covariance)
        marked[self.undetermined] = marked[:, self.undetermined] = np.nan
        marked[np.diag_indices(len(marked))] = np.where(self.undetermined, np.inf, np.diag(marked))
        return marked

    def errors(self, scale: float = 1.0) -> Any:
        """Standard errors of the parameters; infinite where they are undetermined."""
        return np.sqrt(np.diag(self.covariance(scale)))

    @cached_property
    def groups(self) -> list[tuple[list[int], Any]]:
        """Parameters that are undetermined together, and their undetermined directions per unit of each: (numbers, array of rows)."""
        left, groups = [int(k) for k in np.flatnonzero(self.undetermined)], []
        while left:
            group = {left[0]}
            while more := {j for j in left if j not in group and any(abs(self.projector[i, j]) > PART**2 for i in group)}:
                group |= more
            left, members = [k for k in left if k not in group], sorted(group)
            inside = np.linalg.svd(self.directions[:, members])
            rows = inside[2][: len(inside[1])][inside[1] > 0.5]
            sizes = self._sizes[members]
            groups.append((members, rows / np.where(np.isfinite(sizes), sizes, 1.0)))
        return groups


def _without_traces(rows: Any, lost: Any) -> Any:
    """Rows without small components in undetermined directions, which result from the limited accuracy of these directions."""
    share = rows @ lost.T
    return rows - np.where(abs(share) < PART * np.linalg.norm(rows, axis=1, keepdims=True), share, 0.0) @ lost


@in_one_thread
def decomposed(rows: Any) -> tuple[Any, Any]:
    """Singular values, one for each parameter, and their directions."""
    _, values, directions = np.linalg.svd(np.linalg.qr(rows, mode="r"), full_matrices=True)
    return np.append(values, np.zeros(len(directions) - len(values))), directions
