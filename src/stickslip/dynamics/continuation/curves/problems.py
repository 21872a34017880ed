"""The equations of curves of special points: one equation fewer than unknowns, the last two of which are the parameters."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.frozen_arrays import sealed
from stickslip.dynamics.continuation.one_parameter import Family
from stickslip.dynamics.periodic.newton import Root

_FLOOR = 1e-14  # of residuals: their own rounding


class CurvePoint(NamedTuple):
    """A point of a curve, its direction, what vanishes at special points of the curve, and a vector that keeps its side along the curve."""

    root: Root
    tangent: Array
    tests: dict[str, float]
    facing: Array | None = None

    @property
    def u(self) -> Array:
        """Where it is in the scaled space."""
        return self.root.at


@sealed
class CurveProblem:
    """Unknowns u = (inner unknowns, two scaled parameters); `residuals` has one equation less.

    Parameters
    ----------
    family, origin, span
        The robots, and the parameters in their scales.
    residuals : callable
        Of a table of points, a row each.
    orbit : callable
        The motion at a point.
    tolerance : float
        Of the residuals.
    watched : callable
        Conditions that must stay positive, by name.
    meeting : callable, optional
        Where such a condition vanishes, from a guess.
    again : callable, optional
        The residuals by a worse method.
    tests : callable, optional
        What vanishes at special points of the curve, at a point with its direction: (numbers by name, vector that keeps its side),
        from the point, the direction, that vector before, and whether by the worse method.
    named : callable, optional
        Kind of a point where the test of a name vanishes, and words for it; None where it is nothing special.
    known : float or array
        How well each equation is known.
    apart : callable
        Why the special point is none any more at a point, each after the last; "" where it is one.
    farther : callable, optional
        Of a problem whose equations hold on one side only, and that is solved a little beside: the same problem so many times as far away.
    """

    family: Family
    origin: Array
    span: Array
    residuals: Callable[[Array], Array]
    orbit: Callable[[Array], Any]
    tolerance: float
    watched: Callable[[Array], dict[Any, float]] = lambda u: {}
    meeting: Callable[[Array, Any], Root] | None = None
    again: Callable[[Array], Array] | None = None
    tests: Callable[..., tuple[dict[str, float], Array]] | None = None
    named: Callable[[Array, str], tuple[str, str] | None] | None = None
    known: Any = _FLOOR
    apart: Callable[[Array], str] = lambda u: ""
    farther: Callable[[int], CurveProblem] | None = None

    def values(self, u: Array) -> Array:
        """The two parameters."""
        return self.origin + self.span * u[..., -2:]

    def accuracy(self, root: Root) -> Array:
        """By how much the two parameters of a point may be wrong."""
        unsure = np.full(len(root.at), max(root.residual, _FLOOR))
        if self.again is not None:
            unsure[:-1] += self.known + abs(self.again(root.at[None, :])[0] - self.residuals(root.at[None, :])[0])
        moved = abs(np.linalg.pinv(root.jacobian)) @ unsure
        return self.span * moved[-2:] + 2 * np.spacing(abs(self.values(root.at)))
