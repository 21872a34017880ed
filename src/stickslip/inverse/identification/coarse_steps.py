"""Steps from sample to sample over which a law with inner states is followed, and whether they are short enough where the motion turns."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.inverse.identification.covariance import determined_spread, information_of, noise_scale
from stickslip.inverse.identification.search import SearchEnd, polished

_OF_SECOND_ORDER, _LITTLE = 4 / 3, 0.3  # whole error over what halves of the steps show of it; standard errors that do not matter
_ROUNDS = 5  # times that long steps are halved


def coarse_steps(problem: Any, end: SearchEnd) -> tuple[Any, float]:
    """What steps of zero length would change of the values, and by how many standard errors that moves numbers: array (values, 1).

    From what halves of the long ones change. None, 0 where no step is long; 0 where numbers move by little.
    """
    finer, free, count = problem.model.finer(), len(problem.parameters.free), len(problem.y)
    if finer is problem.model or end.stopped:
        return None, 0.0
    here, there = problem.predicted(end.point), problem.over(finer).predicted(end.point)
    if here is None or there is None:
        return None, 0.0
    change = _OF_SECOND_ORDER * (there - here) / problem.sigma * problem.known
    moved = (information_of(problem, end.jacobian).inverse[:free, :count]) @ change
    errors = np.sqrt(np.diag(determined_spread(problem, end.jacobian, end.residuals[:count], noise_scale(problem, end))))[:free]
    off = float(np.max(abs(moved[errors > 0]) / errors[errors > 0], initial=0.0))
    return change[:, None], off if off > _LITTLE else 0.0


def with_short_steps(problem: Any, end: SearchEnd) -> tuple[Any, SearchEnd]:
    """The fit with long steps halved where that moves numbers, again and again."""
    for _ in range(_ROUNDS):
        if not coarse_steps(problem, end)[1]:
            break
        problem = problem.over(problem.model.finer())
        end = polished(problem, end.point)
    return problem, end
