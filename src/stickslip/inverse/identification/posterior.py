"""How the parameters of a fit are spread: by its covariance, on the scale of its search, within its bounds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import Problems
from stickslip.basics.fields import leaves
from stickslip.inverse.identification.covariance import root_of

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit

_FAR = 1e-12  # how near a sample comes to the ends of the normal distribution


@dataclass(frozen=True)
class OfFit:
    """The parameters of a fit, and the numbers of a machine that they set.

    Parameters
    ----------
    fit : Fit
    inside : dict
        Number of the fitted model -> its name in the machine.
    """

    fit: Fit
    inside: dict[str, str]

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters."""
        return self.fit.names

    @property
    def independent(self) -> bool:
        """Of one parameter only: the data correlate several."""
        return len(self.names) < 2

    def inputs(self, u: Array) -> dict[str, Array]:
        """The parameters, for u evenly spread between 0 and 1."""
        return self._values(self.fit.point[: len(self.names), None] + _root(self.fit) @ _normal(u))

    def numbers(self, u: Array) -> dict[str, Array]:
        """The numbers of the machine."""
        return self._numbers(self.inputs(u))

    def alone(self, name: str, u: Array) -> dict[str, Array]:
        """The numbers where one parameter is at some parts of its own distribution and the others are as fitted."""
        k, u = self.names.index(name), np.asarray(u, float)
        points = np.repeat(self.fit.point[: len(self.names), None], u.size, axis=1)
        points[k] += np.linalg.norm(_root(self.fit)[k]) * _normal(u)
        return self._numbers(self._values(points))

    def _values(self, points: Array) -> dict[str, Array]:
        return self.fit.problem.parameters.values(np.clip(points, 0.0, 1.0))

    def _numbers(self, values: dict[str, Array]) -> dict[str, Array]:
        count = len(next(iter(values.values())))
        own = dict(leaves(self.fit.problem.parameters.model(values, 0)))
        return {name: np.broadcast_to(np.asarray(own[leaf], float), (count,)) for leaf, name in self.inside.items()}


def _normal(u: Array) -> Array:
    from scipy.special import ndtri

    return ndtri(np.clip(u, _FAR, 1.0 - _FAR))


def _root(fit: Fit) -> Array:
    """A square root of the covariance on the scale of the search."""
    return root_of(fit.covariance / np.outer(fit.slopes, fit.slopes))


def distribution_of(fit: Fit, machine: Any, problems: Problems) -> OfFit | None:
    """How a fit's parameters spread the numbers of a machine; what stands against it is noted."""
    if lost := [name for name, error in fit.errors.items() if name in fit.undetermined or not np.isfinite(error)]:
        mistake = f"the data do not determine {' and '.join(lost)}, which could be anything"
        problems.add(f"{mistake}; fix {'it' if len(lost) == 1 else 'them'}, or {fit.remedy}")
        return None
    moved, known = _moved(fit), {name for name, _ in leaves(machine)}
    inside = {leaf: next((name for name in (leaf, f"friction.{leaf}") if name in known), "") for leaf in moved}
    if missing := [leaf for leaf, name in inside.items() if not name]:
        kind = type(machine).__name__
        problems.add(
            f"the fit sets {', '.join(missing)}, which {kind} does not have; give a machine of the fitted kind, such as fit.model()"
        )
        return None
    return OfFit(fit, inside)


def _moved(fit: Fit) -> list[str]:
    """The numbers of the fitted model that depend on its parameters."""
    parameters, point = fit.problem.parameters, fit.point[: len(fit.names)]
    shifted = point[:, None] + 1e-4 * np.where(point < 0.5, 1.0, -1.0)[:, None] * np.eye(len(point))
    base, many = (dict(leaves(parameters.model(parameters.values(p), 0))) for p in (point, shifted))
    return [name for name, value in base.items() if np.any(np.asarray(many[name]) != value)]
