"""What data say about the parameters of a fit: the covariance, and the directions in which they say nothing."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

__all__ = ["Information"]

#: Singular values of derivatives, each parameter on a scale of its own, that are this small beside the largest count as zero: derivatives
#: by central differences are good to 1e-8 of themselves, by one-sided ones to 1e-5.
SINGULAR = 1e-6
PART = 1e-3  # a parameter with a smaller share of a direction does not lie in it
_NOTHING = 1e-12  # of the largest column: a parameter that moves nothing


@dataclass(frozen=True, eq=False)
class Information:
    r"""The information in the derivatives J of residuals (in standard deviations) by parameters, :math:`J^TJ`, taken apart.

    With :math:`J = U S V^T`, after each column was divided by its length, directions in V whose singular value is zero to the accuracy
    of the derivatives are *undetermined*: their variance is infinite, and so is that of every parameter that lies in one of them. (The
    pseudo-inverse of the information would make it zero.) The others have their variance from the directions that are left.

    Parameters
    ----------
    jacobian : array (values, parameters)
        Derivatives of the residuals.
    singular : float
        Singular values below this part of the largest are zero.

    Examples
    --------
    Only the sum of the first two numbers moves anything, and the third by itself:

    >>> found = Information(np.array([[1.0, 1.0, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 0.5]]))
    >>> found.undetermined.tolist(), found.errors().tolist()
    ([True, True, False], [inf, inf, 2.0])
    """

    jacobian: Any
    singular: float = SINGULAR

    @cached_property
    def _sizes(self) -> Any:
        """Lengths of the columns; 1 for those that are nothing."""
        size = np.sqrt(np.sum(np.asarray(self.jacobian) ** 2, axis=0))
        return np.where(size > _NOTHING * size.max(initial=0.0), size, np.inf)

    @cached_property
    def _parts(self) -> tuple[Any, Any, Any]:
        """Singular values as one for each parameter, the directions as rows, and which of them are undetermined."""
        triangle = np.linalg.qr(np.asarray(self.jacobian) / self._sizes, mode="r")
        _, values, directions = np.linalg.svd(triangle, full_matrices=True)
        values = np.append(values, np.zeros(len(directions) - len(values)))
        return values, directions, values <= self.singular * values.max(initial=0.0)

    @cached_property
    def directions(self) -> Any:
        """Undetermined directions as rows, in parameters times the lengths of their columns: array (directions, parameters)."""
        _, directions, lost = self._parts
        return directions[lost]

    @cached_property
    def projector(self) -> Any:
        """Projector on the undetermined directions: parameters with an entry beside the diagonal are undetermined together."""
        return self.directions.T @ self.directions

    @cached_property
    def undetermined(self) -> Any:
        """Which parameters lie in an undetermined direction: array (parameters,) of bool."""
        return np.diag(self.projector) > PART**2

    @cached_property
    def inverse(self) -> Any:
        """The pseudo-inverse of the derivatives: steps to the least sum of squares that leave undetermined directions alone."""
        values, directions, lost = self._parts
        kept = directions[~lost]
        scaled = np.asarray(self.jacobian) / self._sizes
        return (kept.T / values[~lost] ** 2) @ kept @ scaled.T / self._sizes[:, None]

    def covariance(self, scale: float = 1.0) -> Any:
        """Covariance of the parameters for noise that is `scale` times what the residuals are measured in.

        An undetermined parameter has infinite variance, and no (NaN) covariance with others.
        """
        values, directions, lost = self._parts
        kept = directions[~lost] / self._sizes
        found = (kept.T * (scale / values[~lost]) ** 2) @ kept
        found[self.undetermined] = found[:, self.undetermined] = np.nan
        found[np.diag_indices(len(found))] = np.where(self.undetermined, np.inf, np.diag(found))
        return found

    def errors(self, scale: float = 1.0) -> Any:
        """Standard errors of the parameters; infinite where they are undetermined."""
        return np.sqrt(np.diag(self.covariance(scale)))

    @cached_property
    def groups(self) -> list[tuple[list[int], Any]]:
        """Parameters that are undetermined together, and their undetermined directions per unit of each: (numbers, array of rows)."""
        left, found = [int(k) for k in np.flatnonzero(self.undetermined)], []
        while left:
            group = {left[0]}
            while more := {j for j in left if j not in group and any(abs(self.projector[i, j]) > PART**2 for i in group)}:
                group |= more
            left, members = [k for k in left if k not in group], sorted(group)
            inside = np.linalg.svd(self.directions[:, members])
            rows = inside[2][: len(inside[1])][inside[1] > 0.5]
            sizes = self._sizes[members]
            found.append((members, rows / np.where(np.isfinite(sizes), sizes, 1.0)))
        return found
