"""Least squares that finds its way: a multistart in batches, then trust-region steps from the best places."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import Interrupted, look, looking, partial_result
from stickslip.basics.one_thread import in_one_thread

if TYPE_CHECKING:
    from stickslip.basics.progress import Reported


_ALIGNED = 16  # places that are judged by their curves
_POLISHED = 3  # places from which steps are taken
_APART = 0.03  # places nearer than this are one
_PLATEAU = 1e-9  # places whose sums of squares differ by a smaller part give one curve


@sealed
@dataclass(frozen=True, eq=False)
class Found:
    """Where a search ended: place, residuals there, their derivatives, and in how many steps."""

    place: Any
    residuals: Any
    jacobian: Any
    steps: int
    stopped: bool = False  # whether somebody said stop before the search had ended

    @property
    def cost(self) -> float:
        """Sum of squared residuals."""
        return float(self.residuals @ self.residuals)


def multistart(numbers: int, starts: int, seed: int) -> Any:
    """Places of a multistart: the middle between all bounds, then those of a Sobol sequence."""
    from scipy.stats import qmc

    places = qmc.Sobol(numbers, rng=seed).random_base2(int(np.ceil(np.log2(max(starts, 2)))))
    return np.concatenate([np.full((1, numbers), 0.5), places])


def starting_places(of: Any, starts: int, seed: int) -> Any:
    """Places of a multistart of free parameters (`Parameters`), within what the laws demand of them."""
    return np.array([of.limits.place(inner) for inner in multistart(len(of.free), starts, seed)])


def searched(
    problem: Any, starts: int, seed: int, progress: Callable[[int, int], None] | None = None, seeds: Callable[[], list[Any]] = list
) -> tuple[Found, int]:
    """The best place of a multistart, and how many of the polished starts ended there, roughly.

    Parameters
    ----------
    problem : Sensed
    starts : int
        Places of the multistart (a Sobol sequence, and the middle).
    seed : int
    progress : callable, optional
        Called with (done, in all).
    seeds : callable
        Gives whole places from which steps are taken in any case: the best of simpler models inside this one.
    """
    judged: list[tuple[float, Any]] = []
    with partial_result() as ending:
        ends = _ends(problem, starts, seed, progress, seeds, judged)
    ending.needs(judged)
    if ending.interrupted:
        place = min(judged, key=lambda pair: pair[0])[1]
        ends = [Found(place, problem.residuals(place), problem.jacobian(place), 0, stopped=True)]
    best = min(ends, key=lambda end: end.cost)
    agree = sum(end.cost < 1.01 * best.cost + 1e-9 for end in ends)
    if progress and not ends[-1].stopped:
        progress(_POLISHED + 1, _POLISHED + 1)
    return dataclasses.replace(best, stopped=ends[-1].stopped), agree


def _ends(
    problem: Any, starts: int, seed: int, progress: Reported | None, seeds: Callable[[], list[Any]], judged: list[tuple[float, Any]]
) -> list[Found]:
    """Where steps from the best places end; the places that were judged by their curves are noted."""
    places = starting_places(problem.parameters, starts, seed)
    score = problem.coarse(places)
    order = [int(i) for i in np.argsort(score) if np.isfinite(score[i])]
    if problem.batched:  # the batch has judged them already
        chosen = [place for _, place in _spread([(float(score[i]), places[i]) for i in order], problem.first)]
        judged += [_judged(problem, place) for place in chosen]
    else:
        for i in order[:_ALIGNED]:
            judged.append(_judged(problem, places[i]))
    inside = seeds()
    if not order and not inside:
        none = f"at none of {len(places)} places between the bounds can the model be solved"
        raise InputError("identify", [f"{none}; widen or correct the bounds"])
    kept = _spread(sorted(judged, key=lambda pair: pair[0]), problem.first)
    if kept and problem.has_known_rows:  # what is known beforehand counts by the noise, of which the best place tells most
        problem = problem.trusting(max(float(np.sqrt(kept[0][0] / len(problem.y))), 1.0))
    ends: list[Found] = []
    for k, place in enumerate([*inside, *(place for _, place in kept)]):
        if progress:
            progress(min(k, _POLISHED), _POLISHED + 1)
            look()
        ends.append(polished(problem, place, rough=True))
        if ends[-1].stopped:
            break
    return ends


def _judged(problem: Any, place: Array) -> tuple[float, Any]:
    look()
    whole = problem.aligned(place)
    rest = problem.residuals(whole)
    return float(rest @ rest), whole


def _spread(chosen: list[tuple[float, Any]], first: int) -> list[tuple[float, Any]]:
    """The best places that are apart from one another in the numbers of the model, and of a plateau one."""
    kept: list[tuple[float, Any]] = []
    for cost, place in chosen:
        if all(abs(place - other)[:first].max() > _APART and abs(cost - same) > _PLATEAU * cost for same, other in kept):
            kept.append((cost, place))
        if len(kept) == _POLISHED:
            break
    return kept


@in_one_thread
def polished(problem: Any, place: Array, rough: bool = False) -> Found:
    """Trust-region steps from a place to the nearest least sum of squares; who interrupts them gets the best place so far."""
    from scipy.optimize import least_squares

    low, high = problem.bounds()
    best = _Best(problem)
    inside = np.clip(best.limits.inner(place), low + 1e-9, high - 1e-9)
    if len(inside) == 0:
        rest = problem.residuals(inside)
        return Found(inside, rest, np.empty((len(rest), 0)), 0)
    with partial_result() as ending:
        fit = least_squares(
            looking(best), inside, jac=best.jacobian, bounds=(low, high), x_scale="jac",
            ftol=1e-4 if rough else 1e-9, xtol=1e-5 if rough else 1e-8, gtol=1e-12, max_nfev=12 if rough else 60,
        )  # fmt: skip
    ending.needs(best.place is not None)
    if ending.interrupted:
        return Found(best.place, best.residuals, problem.jacobian(best.place), best.steps, stopped=True)
    return Found(best.limits.place(fit.x), fit.fun, best.slopes, int(fit.nfev))


def polished_to_end(problem: Any, place: Array, rough: bool = False) -> Found:
    """The same for whoever needs the least sum of squares itself: an interruption goes on."""
    end = polished(problem, place, rough)
    if end.stopped:
        raise Interrupted
    return end


class _Best:
    """The residuals of a problem over coordinates of a search, and the best place at which they were asked for."""

    def __init__(self, problem: Any):
        self.problem, self.steps = problem, 0
        self.limits = problem.parameters.limits
        self.place: Any = None
        self.residuals: Any = None
        self.slopes: Any = None  # by the place, where derivatives were asked for last: where the best place was reached

    def __call__(self, inner: Any) -> Any:
        place = self.limits.place(inner)
        found = self.problem.residuals(place)
        self.steps += 1
        if self.residuals is None or found @ found < self.residuals @ self.residuals:
            self.place, self.residuals = np.array(place), found
        return found

    def jacobian(self, inner: Any) -> Any:
        """Derivatives by the coordinates."""
        self.slopes = self.problem.jacobian(self.limits.place(inner))
        return self.slopes @ self.limits.slopes_of_place(inner) if len(self.limits.slopes) else self.slopes
