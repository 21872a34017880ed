"""How well the records of a fit are met."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from stickslip.inverse.identification.covariance import correlations_by_input, neighbours
from stickslip.inverse.identification.fit_text import OVER_MOTION, unit_of_values

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit


@dataclass(frozen=True)
class Quality:
    """How well one record is met.

    Parameters
    ----------
    label, kind : str
    count : int
    rms : float
        Of the residuals, in the unit of the record [SI].
    noise : float
        What the record's own noise is, where that is known [SI]; NaN otherwise.
    r2 : float
        Part of the variance that is explained; NaN for a single number.
    correlation : float
        Of neighbouring residuals: 0 for white noise; near 1 what is left has a shape, so the law or the drive is not right.
    coloured : bool
        Whether residuals are those of noise at equal phases of the drive, or over velocities and places, so that a correlation is not due
        to law or drive.
    unit : str
        SI unit of the values.
    """

    label: str
    kind: str
    count: int
    rms: float
    noise: float
    r2: float
    correlation: float
    coloured: bool = False
    unit: str = ""
    structure: str = ""  # what of the residuals stands above noise where a wrong law or drive shows, in words
    of_input: float = 0.0  # correlation of neighbours that the noise of the motion makes at most

    @property
    def excess(self) -> str:
        """The unexplained rest, in words."""
        noise = f" where the noise is {self.noise:.3g} {self.unit}" if np.isfinite(self.noise) else ""
        more = f", {self.structure}" if self.structure else ""
        return f"residuals of {self.rms:.3g} {self.unit}{noise}, neighbours correlated {self.correlation:.2f}{more}"

    @property
    def suspicious(self) -> bool:
        """Whether more is left than noise."""
        white = 3.5 / np.sqrt(max(self.count, 1))
        too_large = (
            np.isfinite(self.noise)
            and self.rms > 1.15 * self.noise
            and self.rms**2 > self.noise**2 * (1 + 5 * np.sqrt(2 / max(self.count, 1)))
        )
        return bool(self.structure) or bool(self.count > 20 and (abs(self.correlation) > max(white, 0.1) + self.of_input or too_large))


def quality(fit: Fit) -> tuple[Quality, ...]:
    """Goodness of fit of each record."""
    qualities = []
    rests, plain = fit.problem.parts(fit.residuals * fit.problem.sigma), fit.problem.unclipped(fit.residuals)
    inputs = correlations_by_input(fit.problem, fit.jacobian, fit.changes, fit.residuals)
    structure = fit.misfit.said if fit.misfit else ("",) * len(rests)
    for target, exact, rest, of_input, said in zip(fit.problem.targets, fit.problem.parts(plain), rests, inputs, structure, strict=True):
        y = target.y
        square, spread = (
            target.mean_square(rest, exact),
            target.mean_square(y - np.average(y, weights=target.weight * np.ones(len(y))), exact),
        )
        r2 = 1 - square / spread if len(y) > 1 and spread > 0 else float("nan")
        noise = float(getattr(target, "sigma", float("nan")))
        known = target.kind in ("velocity", "position") or target.given_sigma
        if not known and np.isfinite(target.most_noise):
            known, noise = True, target.most_noise
        periodic = target.kind == "velocity" and not target.transient and target.phase[-1] > 2 * target.period
        order = np.argsort(np.mod(target.phase, target.period), kind="stable") if target.kind == "velocity" else np.arange(len(rest))
        known_ones, in_phase = rest[exact], rest[order][exact[order]]
        folded, shape = neighbours(in_phase), max(neighbours(known_ones), neighbours(in_phase), key=abs)
        coloured = (periodic and abs(folded) < 3.5 / np.sqrt(len(known_ones))) or (target.kind in OVER_MOTION and not said)
        qualities.append(
            Quality(
                target.label,
                target.kind,
                len(known_ones),
                float(np.sqrt(square)),
                noise if known else float("nan"),
                r2,
                shape,
                coloured,
                unit_of_values(target),
                said,
                of_input,
            )
        )
    return tuple(qualities)
