"""Is friction the same in both directions? A fit with one coefficient for both is freed to have two."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import described_arguments
from stickslip.basics.fields import leaves
from stickslip.basics.notebook_display import rounded, sure
from stickslip.basics.number_names import SIDES
from stickslip.inverse.identification.covariance import spread_of
from stickslip.inverse.identification.fit_text import unit_of_parameter
from stickslip.inverse.identification.search import polished_to_end

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit

_COARSE = 0.05  # of the mean: a difference that is less well known says little
_CLEAR = 3.3  # standard errors beyond which a difference is one: once in a thousand, if there is none


@dataclass(frozen=True)
class Symmetry:
    """Kinetic friction forwards and backwards.

    Parameters
    ----------
    name : str
        The coefficient.
    mean, mean_error : float
        Half the sum of both directions.
    half, error : float
        Half the difference, and its standard error; infinite where the record does not determine it.
    unit : str
    apart : bool
        Whether both directions were fitted.
    """

    name: str
    mean: float
    mean_error: float
    half: float
    error: float
    unit: str = ""
    apart: bool = False

    @property
    def determined(self) -> bool:
        """Whether the record tells one direction from the other."""
        return bool(np.isfinite(self.error))

    @property
    def asymmetric(self) -> bool:
        """Whether friction differs by direction."""
        return self.determined and abs(self.half) > _CLEAR * self.error

    def __str__(self) -> str:
        unit = f" {self.unit}".rstrip()
        mean = f"{self.name}: mean of both directions {rounded(self.mean, self.mean_error)} {sure(self.mean_error)}{unit}"
        if not self.determined:
            zero = 'the zero of the sensor looks the same; if the sensor was zeroed, type sensor={"offset": 0.0}'
            return f"{mean}, half difference not determined: {zero}"
        coarse = self.error > _COARSE * abs(self.mean)
        same = "the record hardly tells one direction from the other" if coarse else "one coefficient for both is enough"
        verdict = f"friction differs by direction{'' if self.apart else '; type asymmetric=True'}" if self.asymmetric else same
        return f"{mean}, half difference {rounded(self.half, self.error)} {sure(self.error)}{unit}: {verdict}"


def symmetry(fit: Fit) -> tuple[Symmetry, ...]:
    """Whether friction is the same in both directions, as far as a fit over a measured motion says; empty for other fits.

    A fit with one coefficient for both is freed to have two; of one with both, half the sum and half the difference are determined, or not.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> t = np.arange(0, 4, 0.005)
    >>> F = 2.0 * np.sign(np.cos(3 * t)) + np.random.default_rng(0).normal(0, 0.05, len(t))
    >>> rec = ss.Record.of(t, {"x [m]": 5e-3 * np.sin(3 * t), "F [N]": F}, roles={"F": "force"})
    >>> ss.identify(rec, ss.Coulomb, free={"mu": (0.1, 5.0)}, load=1.0, starts=2, sensor={"offset": 0.0}).symmetry[0].asymmetric
    False
    """
    if fit.stopped:
        return ()
    return tuple(by_sides(fit)) or tuple(filter(None, (symmetry_of(fit),)))


def symmetry_of(fit: Fit) -> Symmetry | None:
    """The test of symmetry of a fit with one kinetic coefficient for both directions of a law over a measured motion; None of others.

    Static friction is freed with it: else a difference of the two would be taken for one by direction.
    """
    name = next((name for name in fit.names if name.rpartition(".")[2] == "mu"), None)
    if name is None or not fit.problem.batched or not _has_both_sides(fit.problem.parameters.make, name):
        return None
    of, unit = fit.problem.parameters, unit_of_parameter(fit, name)
    both = [f.name.rpartition(".")[2] in ("mu", "f") for f in of.free]
    free = tuple(
        each for f, two in zip(of.free, both, strict=True) for each in ([replace(f, name=f.name + side) for side in SIDES] if two else [f])
    )
    k = next(i for i, f in enumerate(free) if f.name == name + SIDES[0])
    model = replace(fit.problem.model, parameters=replace(of, free=free, known_limits=None))
    problem = replace(fit.problem, model=model, _memory={})
    twice = np.repeat(np.asarray(fit.point[: len(both)], float), np.where(both, 2, 1))
    end = polished_to_end(problem, np.concatenate([twice, fit.point[len(both) :]]))
    spread = spread_of(problem, end.jacobian, end.residuals, fit.scale)
    slope = [free[i].slope(end.point[i]) for i in (k, k + 1)]
    values = [float(free[i].outer(end.point[i])) for i in (k, k + 1)]
    own = spread[k : k + 2, k : k + 2] * np.outer(slope, slope)
    half = float(np.sqrt(max(0.25 * (own[0, 0] + own[1, 1] - 2 * own[0, 1]), 0.0))) if np.isfinite(own).all() else float("inf")
    return Symmetry(name, fit.values[name], fit.errors[name], 0.5 * (values[0] - values[1]), half, unit)


def _has_both_sides(make: Any, name: str) -> bool:
    """Whether a coefficient is that of two directions, which can be told apart; an argument of a user's own function is not."""
    known = described_arguments(make) if callable(make) else dict(leaves(make))
    return all(name + side in known for side in SIDES)


def by_sides(fit: Fit) -> list[Symmetry]:
    """For each coefficient that was fitted for both directions apart: mean and half difference, as far as the record determines them."""
    symmetries = []
    for stem in [name.removesuffix(SIDES[0]) for name in fit.names if name.endswith(SIDES[0])]:
        names = [stem + side for side in SIDES]
        if names[1] not in fit.names:
            continue
        i, j = map(fit.names.index, names)
        unit = unit_of_parameter(fit, names[0])
        if not set(names) & set(fit.undetermined):
            c = fit.covariance
            mean, half = (0.5 * float(np.sqrt(max(c[i, i] + c[j, j] + sign * 2 * c[i, j], 0.0))) for sign in (1, -1))
            values = fit.values[names[0]], fit.values[names[1]]
            symmetries.append(Symmetry(stem, 0.5 * sum(values), mean, 0.5 * (values[0] - values[1]), half, unit, apart=True))
            continue
        whole = {formula: (value, error) for formula, value, error in fit.combinations}
        if both := whole.get(" + ".join(names)) or whole.get(" + ".join(names[::-1])):
            symmetries.append(Symmetry(stem, 0.5 * both[0], 0.5 * both[1], 0.0, float("inf"), unit, apart=True))
    return symmetries
