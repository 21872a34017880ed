"""The delay of a load cell: which of many fits best to what a model gives, and which of them fit as well as the best one.

A force that jumps where the motion turns shows its delay by the samples between which it jumps, and so to no better than a sample: no
derivative has that, and steps along derivatives do not lead over a jump.
"""

from __future__ import annotations

from typing import Any

import numpy as np

_TRIED, _NEAR, _SIDE = 60, 2, 12  # delays that are tried between two others; samples of a search about its end; delays on either side
_WITHIN, _OTHERS = (
    4.0,
    6.0,
)  # squares of a standard deviation by which noise leaves the sum open: with the same values left open, and others


def best_delay(problem: Any, h: Any, point: Any, k: int, around: float = np.inf) -> float:
    """The delay that fits best to what a model gives (`MeasuredProblem.modelled`); of several that noise leaves open the middle one.

    With `around` it is looked for so many samples about that of the point.
    """
    step, (low, high) = _step(problem, k), _range(problem, k)
    low, high = max(low, point[k] - around * step), min(high, point[k] + around * step)
    best = float(point[k])
    for _ in range(2):
        if not np.isfinite(high - low) or not high > low:
            return best
        tried = np.linspace(low, high, int(np.clip(np.ceil((high - low) / step - 1e-9), 2, _TRIED)) + 1)
        sums = _sums(problem, h, point, k, tried)
        least = int(np.argmin(sums))
        worse = np.flatnonzero(sums > sums[least] * (1 + _by_noise(problem, k) / len(problem.y)))
        first, last = np.max(worse[worse < least], initial=-1) + 1, np.min(worse[worse > least], initial=len(tried)) - 1
        best, apart = float(0.5 * (tried[first] + tried[last])), float(tried[1] - tried[0])
        if apart <= step * (1 + 1e-9):
            return best
        low, high = max(low, float(tried[first]) - apart), min(high, float(tried[last]) + apart)
    return best


def delayed_best(problem: Any, point: Any) -> tuple[Any, Any]:
    """The problem, and a point, with the delays that fit best to what the point's model gives, where they fit better."""
    h, here, moved = problem.modelled(point), problem.lagging(point), np.array(point, float)
    for k in problem.delays if h is not None else ():
        moved[k] = best_delay(problem, h, moved, k, _NEAR * problem.model.thin)
    if h is None or np.array_equal(moved, point):
        return here, point
    there = problem.lagging(moved)
    moved[problem.first :] = there.linear(h, moved)[0]
    old, new = here.residuals(point), there.residuals(moved)
    return (there, moved) if new @ new < old @ old else (here, point)


def with_jumps(problem: Any, end: Any, scale: float, spread: Any) -> Any:
    """A covariance with the delays that no derivative determines as far as the jumps of the force do."""
    from stickslip.inverse.identification.covariance import information_of

    unknown = [k for k in problem.delays if not end.stopped and np.isinf(spread[k, k])]
    alone = {members[0] for members, _ in information_of(problem, end.jacobian).groups if len(members) == 1} if unknown else set()
    for k in alone.intersection(unknown):
        if np.isfinite(variance := _variance_by_jumps(problem, end.point, k, scale)):
            spread[k] = spread[:, k] = 0.0
            spread[k, k] = variance
    return spread


def _variance_by_jumps(problem: Any, point: Any, k: int, scale: float) -> float:
    """Mean square distance from a delay of those that fit as well within the noise, the other numbers held; infinite if all do."""
    h, apart, (low, high) = problem.modelled(point), 0.5 * _step(problem, k), _range(problem, k)
    if h is None or not np.isfinite(high - low):
        return float("inf")
    while True:
        tried = point[k] + apart * np.arange(-_SIDE, _SIDE + 1)
        tried = tried[(tried >= low - 1e-3 * apart) & (tried <= high + 1e-3 * apart)]
        points = [np.where(np.arange(len(point)) == k, each, point) for each in tried]
        sums = _sums_over_the_same(problem, points)
        worse = np.flatnonzero(sums > min(sums) + _by_noise(problem, k) * scale**2)
        here = int(np.argmin(abs(tried - point[k])))
        here = int(np.argmin(sums)) if here in worse else here
        first, last = np.max(worse[worse < here], initial=-1), np.min(worse[worse > here], initial=len(tried))
        whole = len(tried) < 2 * _SIDE + 1
        if first < 0 and last == len(tried) and whole:
            return float("inf")
        if whole or (first >= 0 and last < len(tried)):
            break
        apart *= 2
    behind, ahead = (float(tried[np.clip(i, 0, len(tried) - 1)] - point[k]) for i in (first, last))
    return (ahead**3 - behind**3) / (3 * (ahead - behind))


def _sums_over_the_same(problem: Any, points: list[Any]) -> Any:
    """Sums of squares at points of different delays, over the values that all of them compare: none gains by what it leaves out."""
    late = [problem.lagging(each) for each in points]
    counted = np.min([each.known for each in late], axis=0)
    rests = np.array([each.residuals(point) for each, point in zip(late, points, strict=True)])
    rests[:, : len(counted)] *= counted
    return np.sum(rests**2, axis=1)


def _by_noise(problem: Any, k: int) -> float:
    """By how many squares of a standard deviation sums for two delays may differ by noise: other values are left open for each."""
    return _WITHIN + _OTHERS * float(np.sqrt(sum(problem.targets[i].left_open for i in problem.numbers[k - problem.first].records)))


def _step(problem: Any, k: int) -> float:
    return float(min(problem.targets[i].step for i in problem.numbers[k - problem.first].records))


def _range(problem: Any, k: int) -> tuple[float, float]:
    low, high = problem.numbers[k - problem.first].bounds
    return float(low), float(high)


def _sums(problem: Any, h: Any, point: Any, k: int, tried: Any) -> Any:
    """Sums of squares with some delays, the numbers that act in proportion at their best."""
    points = (np.where(np.arange(len(point)) == k, each, point) for each in tried)
    return np.array([problem.lagging(each).linear(h, each)[1] for each in points])
