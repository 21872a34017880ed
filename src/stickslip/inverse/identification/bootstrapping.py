"""The bootstrap: fits to resampled data, all replicates together."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import Problems
from stickslip.basics.executors import Workers
from stickslip.basics.interruption import look
from stickslip.basics.pool import handed_out
from stickslip.inverse.identification.covariance import effective
from stickslip.inverse.identification.search import polished_to_end
from stickslip.inverse.identification.uncertainty import widening

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit

_STEPS = 8  # common steps of all replicates
_NEAR = 0.05  # ... and when it moves the residuals by less than this part of one standard error of them all
_SMALL = 0.01  # a replicate is done when its step is below this part of the standard errors


def by_bootstrap(
    fit: Fit, name: str, level: float, repeats: int = 200, seed: int = 0, workers: int = 1, executor: Any = None
) -> tuple[float, float]:
    """Quantiles of fits to resampled data: the fitted curve plus blocks of residuals in random order.

    Along a direction that the data do not determine all replicates stay where the fit began, which says nothing: there it is open.
    """
    table = bootstrap(fit, repeats, seed, workers, executor)
    k = fit.names.index(name)
    if fit.information.undetermined[k]:
        return fit.problem.parameters.free[k].low, fit.problem.parameters.free[k].high
    low, high = np.quantile(table[:, k], [0.5 - 0.5 * level, 0.5 + 0.5 * level])
    free, factor = fit.problem.parameters.free[k], widening(fit).get(name, 1.0)
    if factor == 1.0:
        return float(low), float(high)
    ends = np.clip(fit.point[k] + factor * (free.inner(np.array([low, high])) - fit.point[k]), 0.0, 1.0)
    return float(free.outer(ends[0])), float(free.outer(ends[1]))


def bootstrap(fit: Fit, repeats: int, seed: int, workers: int = 1, executor: Any = None) -> Any:
    """Values of the free parameters in fits to resampled data, bit for bit the same for any number of workers.

    All replicates start at the fit and step by Gauss and Newton with its derivatives, so that one step costs one curve for each; where
    that does not settle, trust-region steps with derivatives of its own finish the replicate. Forces against motion are one batch per
    step; steady curves are shared among threads, or the workers of an executor.

    Parameters
    ----------
    fit : Fit
    repeats : int
    seed : int
    workers : int
        Threads.
    executor : executor or callable, optional
        Compute there, as for `sweep`; `workers` is then the number of its workers.

    Returns
    -------
    array (repeats, parameters)
        NaN for parameters that the data do not determine.
    """
    problems = Problems("bootstrap")
    problems.whole("repeats", repeats, 2, example=200)
    crew = Workers(workers, executor)
    crew.note(problems)
    problems.check()
    resampled = [_resampled_problem(fit, np.random.default_rng([seed, r])) for r in range(repeats)]
    with crew.kept() as kept:
        points, settled = _stepped(fit, resampled, kept)
        left = ((r, resampled[r]) for r in range(repeats) if not settled[r])
        for (r, _), point in handed_out(partial(_finished, fit.point), left, kept):
            points[r] = point
    free = fit.problem.parameters.free
    table = np.stack([np.array([float(f.outer(p)) for f, p in zip(free, point, strict=False)]) for point in points])
    return np.where(fit.information.undetermined[: len(free)], np.nan, table)


def _finished(start: Array, replicate: tuple[int, Any]) -> Any:
    """Where the steps of one replicate end."""
    return polished_to_end(replicate[1].afresh(), start, rough=True).point


def _stepped(fit: Fit, problems: list[Any], workers: Workers) -> tuple[Any, Any]:
    """Places of all replicates after common steps, and which of them have settled."""
    low, high = fit.problem.bounds()
    inverse = fit.information.inverse
    small = _SMALL * fit.scale * np.sqrt(np.sum(inverse**2, axis=1))
    points = np.tile(fit.point, (len(problems), 1))
    open_ones, settled = np.arange(len(problems)), np.zeros(len(problems), bool)
    costs = np.full(len(problems), np.inf)
    for _ in range(_STEPS):
        look()
        rests = _residuals(problems, points, open_ones, workers)
        cost = np.sum(rests**2, axis=1)
        falls = cost <= costs[open_ones] * (1 + 1e-9)
        costs[open_ones] = cost
        steps = np.array([inverse @ rest.copy() for rest in rests])  # one by one: sums do not depend on how many there are
        moved = np.clip(points[open_ones] - steps, low, high)
        step = moved - points[open_ones]
        near = np.linalg.norm(step @ fit.jacobian.T, axis=1) <= _NEAR * fit.scale
        done = falls & near & (abs(step) <= small).all(axis=1)
        points[open_ones] = np.where(falls[:, None], moved, points[open_ones])
        settled[open_ones[done]] = True
        open_ones = open_ones[falls & ~done]
        if len(open_ones) == 0:
            break
    return points, settled


def _residuals(problems: list[Any], points: Array, which: Any, workers: Workers) -> Any:
    """Residuals of some replicates: array (replicates, values)."""
    if problems[0].batched:
        least, most = problems[0].ends(points[which])
        return np.stack([problems[r].rest((least[:, k], most[:, k]), points[r]) for k, r in enumerate(which)])
    replicates = ((r, problems[r], points[r]) for r in which)
    by_replicate = {replicate[0]: residuals for replicate, residuals in handed_out(_residuals_of, replicates, workers)}
    return np.stack([by_replicate[r] for r in which])


def _residuals_of(replicate: tuple[int, Any, Array]) -> Any:
    return replicate[1].afresh().residuals(replicate[2])


def _resampled_problem(fit: Fit, rng: Any) -> Any:
    """Other noise, and other calibrations of what is known beforehand."""
    y = _resampled_values(fit, rng)
    return fit.problem.with_values(y, rng.normal(size=len(fit.jacobian) - fit.count))


def _resampled_values(fit: Fit, rng: Any) -> Any:
    rest = fit.problem.parts(fit.residuals * fit.problem.sigma)
    parts = zip(fit.predicted, rest, fit.problem.targets, strict=True)
    values = np.concatenate([_with_noise(c, r, t, rng) for c, r, t in parts])
    if fit.changes is None:
        return values
    return values - fit.problem.sigma * fit.changes[:, rng.integers(fit.changes.shape[1])]  # as if the motion had been another


def _with_noise(curve: Any, rest: Array, target: Any, rng: Any) -> Any:
    """A curve with residuals of its record; what was clipped stays at the end of the range."""
    exact = target.exact
    noisy = np.array(target.y, float)
    noisy[exact] = curve[exact] + _resampled(rest[exact], rng, target.sigma if len(rest) == 1 else 0.0)
    return noisy


def _resampled(rest: Array, rng: Any, sigma: float) -> Any:
    """Residuals in blocks as long as they are correlated; a single number gets noise of the given size."""
    n = len(rest)
    if n == 1:
        return rng.normal(scale=sigma, size=1)
    block = int(np.clip(n / max(effective(rest), 1.0), 1, max(n // 8, 1)))
    starts = rng.integers(0, n, int(np.ceil(n / block)))
    index = (starts[:, None] + np.arange(block)) % n
    return (rest - rest.mean())[index.ravel()[:n]]
