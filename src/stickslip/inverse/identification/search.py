"""Least squares that finds its way: a multistart in batches, then trust-region steps from the best points."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.executors import HERE, Workers
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import Interrupted, looking, partial_result
from stickslip.basics.one_thread import in_one_thread
from stickslip.basics.pool import handed_out
from stickslip.inverse.identification.damped_steps import damped_steps
from stickslip.studies.designs import sobol_cube

if TYPE_CHECKING:
    from stickslip.basics.progress import Reported


_TOGETHER = 16  # points of the multistart in one batch
_ALIGNED = 16  # points that are judged by their curves
_POLISHED = 3  # points from which steps are taken
_APART = 0.03  # points nearer than this are one
_TIED = 1e-4  # part of a sum of squares by which ends of rough steps differ and are as good
_PLATEAU = 1e-9  # points whose sums of squares differ by a smaller part give one curve


@sealed
@dataclass(frozen=True, eq=False)
class SearchEnd:
    """Where a search ended: the point, residuals there, their derivatives, and in how many steps."""

    point: Any
    residuals: Any
    jacobian: Any
    steps: int
    stopped: bool = False  # whether somebody said stop before the search had ended
    promised: float = 0.0  # by how much derivatives promise that the sum of squares can still be lowered

    @property
    def cost(self) -> float:
        """Sum of squared residuals."""
        return float(self.residuals @ self.residuals)


def multistart(numbers: int, starts: int, seed: int) -> Any:
    """Places of a multistart: the middle between all bounds, then those of a Sobol sequence."""
    count = 1 << int(np.ceil(np.log2(max(starts, 2))))
    return np.concatenate([np.full((1, numbers), 0.5), sobol_cube(count, numbers, seed)])


def starting_points(of: Any, starts: int, seed: int) -> Any:
    """Places of a multistart of free parameters (`Parameters`), within what the laws demand of them."""
    return np.array([of.limits.point(inner) for inner in multistart(len(of.free), starts, seed)])


def searched(
    problem: Any,
    starts: int,
    seed: int,
    progress: Callable[[int, int], None] | None = None,
    seeds: Callable[[], list[Any]] = list,
    workers: Workers = HERE,
) -> tuple[SearchEnd, int]:
    """The best point of a multistart, and how many of the polished starts ended there, roughly.

    Parameters
    ----------
    problem : MeasuredProblem
    starts : int
        Places of the multistart (a Sobol sequence, and the middle); 0 leaves the seeds alone.
    seed : int
    progress : callable, optional
        Called with (done, in all).
    seeds : callable
        Gives whole points from which steps are taken in any case: the best of simpler models inside this one.
    workers : Workers
        Where points are judged and polished, each as if it were the only one; the result does not depend on it.
    """
    judged: dict[int, tuple[float, Any]] = {}
    ends: dict[int, SearchEnd] = {}
    with partial_result() as ending:
        _judge(problem, starts, seed, workers, judged)
        inside = seeds()
        if not judged and not inside:
            none = f"at none of {starts} points between the bounds can the model be solved"
            raise InputError("identify", [f"{none}; widen or correct the bounds"])
        trusted, kept = _kept(problem, judged)
        _polish(trusted, [*inside, *kept], progress, workers, ends)
    ending.needs(judged or ends)
    if not ends:
        point = min(judged.values(), key=lambda pair: pair[0])[1]
        ends[0] = SearchEnd(point, problem.residuals(point), problem.jacobian(point), 0)
    each, stopped = [ends[k] for k in sorted(ends)], ending.interrupted or any(end.stopped for end in ends.values())
    best = _inmost(each, len(problem.parameters.free))
    agree = sum(end.cost < 1.01 * best.cost + 1e-9 for end in each)
    if progress and not stopped:
        progress(_POLISHED + 1, _POLISHED + 1)
    return dataclasses.replace(best, stopped=stopped), agree


def _inmost(ends: list[SearchEnd], free: int) -> SearchEnd:
    """The end of least cost; of several that are as good, as where data do not determine a number, the one farthest from all bounds."""
    least = min(end.cost for end in ends)
    good = [end for end in ends if end.cost <= (1 + _TIED) * least]
    return max(good, key=lambda end: float(np.min(np.minimum(end.point, 1 - end.point)[:free], initial=1.0)))


def _judge(problem: Any, starts: int, seed: int, workers: Workers, judged: dict[int, tuple[float, Any]]) -> None:
    """Note the sums of squares at the best points of a multistart, by their rank in a look at all of them."""
    if not starts:
        return
    points = starting_points(problem.parameters, starts, seed)
    score = np.empty(len(points))
    some = (slice(k, k + _TOGETHER) for k in range(0, len(points), _TOGETHER))
    for part, (scores, solves) in handed_out(partial(_coarse, problem.afresh(), points), some, workers):
        score[part] = scores
        problem.count(solves)
    order = [int(i) for i in np.argsort(score) if np.isfinite(score[i])]
    best = [points[i] for i in order[:_ALIGNED]]
    if problem.batched:  # the batch has judged them already
        best = [point for _, point in _spread([(float(score[i]), points[i]) for i in order], problem.first)]
    for (rank, _), (cost, whole, solves) in handed_out(partial(_judged, problem.afresh()), enumerate(best), workers):
        judged[rank] = cost, whole
        problem.count(solves)


def _kept(problem: Any, judged: dict[int, tuple[float, Any]]) -> tuple[Any, list[Any]]:
    """The judged points from which steps are taken, and the problem of these steps."""
    kept = _spread(sorted((judged[rank] for rank in sorted(judged)), key=lambda pair: pair[0]), problem.first)
    if kept and problem.has_known_rows:  # what is known beforehand counts by the noise, of which the best point tells most
        problem = problem.trusting(max(float(np.sqrt(kept[0][0] / len(problem.y))), 1.0))
    return problem, [point for _, point in kept]


def _polish(problem: Any, points: list[Any], progress: Reported | None, workers: Workers, ends: dict[int, SearchEnd]) -> None:
    """Note where steps from some points end."""

    def begun() -> Iterator[tuple[int, Any]]:
        for k, point in enumerate(points):
            if progress:
                progress(min(k, _POLISHED), _POLISHED + 1)
            yield k, point

    for (k, _), (end, solves) in handed_out(partial(_polished, problem.afresh()), begun(), workers):
        ends[k] = end
        problem.count(solves)
        if end.stopped:
            break


def _coarse(problem: Any, points: Array, part: slice) -> tuple[Any, int]:
    """How badly some points fit, and how many models were solved for it."""
    own = problem.afresh()
    return own.coarse(points[part]), own.solves


def _judged(problem: Any, ranked: tuple[int, Array]) -> tuple[float, Any, int]:
    own = problem.afresh()
    whole = own.aligned(ranked[1])
    own = own.lagging(whole)
    rest = own.residuals(whole)
    return float(rest @ rest), whole, own.solves


def _polished(problem: Any, numbered: tuple[int, Array]) -> tuple[SearchEnd, int]:
    own = problem.afresh().lagging(numbered[1])
    return polished(own, numbered[1], rough=True), own.solves


def _spread(chosen: list[tuple[float, Any]], first: int) -> list[tuple[float, Any]]:
    """The best points that are apart from one another in the numbers of the model, and of a plateau one."""
    kept: list[tuple[float, Any]] = []
    for cost, point in chosen:
        if all(abs(point - other)[:first].max() > _APART and abs(cost - same) > _PLATEAU * cost for same, other in kept):
            kept.append((cost, point))
        if len(kept) == _POLISHED:
            break
    return kept


@in_one_thread
def polished(problem: Any, point: Array, rough: bool = False) -> SearchEnd:
    """Trust-region steps from a point to the nearest least sum of squares; who interrupts them gets the best point so far."""
    from scipy.optimize import least_squares

    low, high = problem.bounds()
    best = _Best(problem)
    inside = np.clip(best.limits.inner(point), low + 1e-9, high - 1e-9)
    if len(inside) == 0:
        rest = problem.residuals(inside)
        return SearchEnd(inside, rest, np.empty((len(rest), 0)), 0)
    part, close, most = (1e-4, 1e-5, 12) if rough else (1e-9, 1e-8, 60)
    bounds = low + 1e-9, high - 1e-9
    with partial_result() as ending:
        fit = least_squares(looking(best), inside, jac=best.jacobian, bounds=(low, high), x_scale="jac", ftol=part, xtol=close, gtol=1e-12,
                            max_nfev=most)  # fmt: skip
        known = (fit.fun, fit.jac) if ((low < fit.x) & (fit.x < high)).all() else None
        start = fit.x if known else np.clip(fit.x, *bounds)
        end = damped_steps(looking(best), best.jacobian, start, bounds, (part, close, most, problem.resolution), known)
    ending.needs(best.point is not None)
    if ending.interrupted:
        return SearchEnd(best.point, best.residuals, problem.jacobian(best.point), best.steps, stopped=True)
    return SearchEnd(best.limits.point(end.x), end.residuals, best.slopes, int(fit.nfev) + end.steps, promised=end.promised)


def polished_to_end(problem: Any, point: Array, rough: bool = False) -> SearchEnd:
    """The same for whoever needs the least sum of squares itself: an interruption goes on."""
    end = polished(problem, point, rough)
    if end.stopped:
        raise Interrupted
    return end


def best_polished(problem: Any, points: list[Any], workers: Workers) -> SearchEnd:
    """The least sum of squares at which steps from some points end; an interruption goes on."""
    ends: dict[int, SearchEnd] = {}
    _polish(problem, points, None, workers, ends)
    if any(end.stopped for end in ends.values()):
        raise Interrupted
    return min((ends[k] for k in sorted(ends)), key=lambda end: end.cost)


class _Best:
    """The residuals of a problem over coordinates of a search, and the best point at which they were asked for."""

    def __init__(self, problem: Any):
        self.problem, self.steps = problem, 0
        self.limits = problem.parameters.limits
        self.point: Any = None
        self.residuals: Any = None
        self.slopes: Any = None  # by the point, where derivatives were asked for last: where the best point was reached

    def __call__(self, inner: Any) -> Any:
        point = self.limits.point(inner)
        residuals = self.problem.residuals(point)
        self.steps += 1
        if self.residuals is None or residuals @ residuals < self.residuals @ self.residuals:
            self.point, self.residuals = np.array(point), residuals
        return residuals

    def jacobian(self, inner: Any) -> Any:
        """Derivatives by the coordinates."""
        self.slopes = self.problem.jacobian(self.limits.point(inner))
        return self.slopes @ self.limits.slopes_of_point(inner) if len(self.limits.slopes) else self.slopes
