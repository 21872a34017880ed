"""What a fit leaves that is not noise, and what that makes of its numbers: no narrow interval beside a law that does not hold.

Where what is left has structure, the law lacks something that acts along those directions; of what it lacks along the derivatives nothing
is left, because the numbers of the fit have taken it up. It is supposed to be as large there as where it shows: a random term, of equal
size along every direction in which structure was found. What the numbers take up of it is part of their covariance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.inverse.identification.coarse_steps import coarse_steps
from stickslip.inverse.identification.covariance import information_of, noise_scale, still_promised
from stickslip.inverse.identification.rounding import rounding_columns
from stickslip.inverse.identification.structure import Left, Structure, structures

_LARGE, _SURE = 1.15, 5.0  # times the given noise, and standard errors of its square, beyond which it explains no residuals
_LEAST_SHOWN = 0.2  # of the directions of a structure that numbers leave to be shown


@dataclass(frozen=True, eq=False)
class Misfit:
    """What is left of a fit besides noise.

    Parameters
    ----------
    said : tuple of str
        The structure in each record, in words; empty where there is none.
    columns : array (values, directions)
        What the law may lack, in standard deviations of the values: one column for each direction.
    factor : float
        By how much errors are larger besides that, because residuals are larger than the noise that was given, or a number is far off what
        was known of it.
    promised : float
        By how many squares of the noise the sum of squares would still fall, by the derivatives where the search ended; 0 at a minimum. The
        step that they promise is a direction too.
    coarse : float
        By how many standard errors numbers are off because samples are too far apart where the motion turns; 0 where that is little.
    """

    said: tuple[str, ...]
    columns: Any
    factor: float = 1.0
    promised: float = 0.0
    coarse: float = 0.0

    @property
    def is_none(self) -> bool:
        """Whether intervals are as they are without it."""
        return not self.columns.shape[1] and self.factor == 1.0


def misfit_of(problem: Any, minimum: Any, changes: Any) -> Misfit:
    """The misfit at the end of a search (`SearchEnd`)."""
    count = len(problem.y)
    residuals, inverse = minimum.residuals[:count], information_of(problem, minimum.jacobian).inverse[:, :count]
    visible = _beside_numbers(minimum.jacobian[:count], inverse)
    inputs = problem.parts(visible(np.zeros((count, 0)) if changes is None else changes))
    met = problem.y + residuals * problem.sigma
    parts = (problem.parts(each) for each in (np.arange(count), residuals, problem.unclipped(residuals), met))
    rounded = rounding_columns(problem, residuals, noise_scale(problem, minimum))
    said, columns, factor = [], [np.zeros((count, 0))], _off_what_is_known(problem, minimum.point)
    promised = still_promised(problem, minimum)
    columns += [residuals[:, None]] if promised else []
    steps, coarse = coarse_steps(problem, minimum)
    columns += [steps] if coarse else []
    for target, rows, rest, which, here, noise, own in zip(problem.targets, *parts, inputs, rounded, strict=True):
        left = Left(here, rest, which, noise, visible(_spread_out(own, rows, count))[rows])
        tested = [] if np.ndim(problem.rows) else structures(target, left)
        said.append(tested[0].said if tested else "")
        columns += [_column(one, rows, count, visible) for one in tested]
        factor = max(factor, _too_large(target, rest[which], problem.sigma[rows][which]))
    return Misfit(tuple(said), np.concatenate(columns, axis=1), factor, promised, coarse)


def _beside_numbers(jacobian: Any, inverse: Any) -> Callable[[Any], Any]:
    """What of columns of changes is left where the numbers of a fit follow them as far as they can."""
    return lambda columns: columns - jacobian @ (inverse @ columns) if columns.shape[1] else columns


def _spread_out(part: Any, rows: Any, count: int) -> Any:
    """Columns of one record as columns of all values."""
    whole = np.zeros((count, part.shape[1]))
    whole[rows] = part
    return whole


def _column(one: Structure, rows: Any, count: int, visible: Callable[[Any], Any]) -> Any:
    """Directions of a structure with the size that it has there, as far as the parameters leave it visible."""
    whole = _spread_out(one.basis, rows, count)
    shown = float(np.mean(np.sum(visible(whole) ** 2, axis=0)))
    return whole * np.sqrt(one.power / max(shown, _LEAST_SHOWN))


def _too_large(target: Any, rest: Array, sigma: Array) -> float:
    """How many times the noise that was given for a record, or that it shows by itself, is left of it; 1 where that may be noise."""
    if target.kind == "mean" or len(rest) < 2:
        return 1.0
    if not target.given_sigma:
        rest = rest * sigma / target.most_noise
    square = float(np.mean(rest**2))
    return float(np.sqrt(square)) if square > max(_LARGE**2, 1 + _SURE * np.sqrt(2 / len(rest))) else 1.0


def _off_what_is_known(problem: Any, point: Array) -> float:
    """By how many standard deviations a number is off what was known of it, if it is far off; else 1."""
    return max(problem.against_what_is_known(point).values(), default=1.0)
