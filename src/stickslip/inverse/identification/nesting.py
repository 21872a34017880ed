"""Simpler laws inside the one that is fitted, and the points where the law is one of them, from which a search goes on."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import combinations
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Numeric
from stickslip.basics.errors import InputError
from stickslip.basics.executors import HERE, Workers
from stickslip.basics.fields import leaves
from stickslip.basics.interruption import Interrupted
from stickslip.inverse.identification.friction_effects import EFFECTS, numbers_without
from stickslip.inverse.identification.search import best_polished, searched

_ALL = 3  # effects up to which every set of them is left out
_STARTS = 16
_GRID, _FINE = 33, 1e-10  # points that are tried, and how near the best one is found


def nested_seeds(problem: Any, starts: int, seed: int, workers: Workers = HERE) -> list[Any]:
    """Whole points where the law is a simpler one, and fits best as such: from the simplest on, each sought from those inside it."""
    try:
        known = [numbers for point in _samples(problem) if (numbers := _numbers(problem, point)) is not None]
    except InputError:
        return []
    active = [effect for effect in EFFECTS if _changed(_differences(known, [effect]))]
    sets = [each for k in range(len(active), 0, -1) if k in (1, len(active)) or len(active) <= _ALL for each in combinations(active, k)]
    ends: dict[frozenset[str], Any] = {}
    for effects in sets:
        inside = [point for more, point in ends.items() if more > set(effects)]
        end = _fitted(problem, known, effects, inside, (starts, seed, workers))
        if end is not None:
            ends[frozenset(effects)] = end
    return list(ends.values())


def _samples(problem: Any) -> Any:
    """A few points, the same always."""
    rng = np.random.default_rng(0)
    return rng.uniform(0.05, 0.95, (24, len(problem.parameters.free)))


Numbers = list[dict[str, Any]]  # of the models of all records


def _numbers(problem: Any, point: Array) -> Numbers | None:
    """The numbers of the models at a point; None where there are none."""
    models = problem.parameters.models(point)
    return None if models is None else [dict(leaves(model)) for model in models]


def _away(models: Numbers, effects: Iterable[str]) -> Any:
    """How far the numbers of effects are from what they are without these, in all records."""
    return np.array([float(numbers[n] - v) for numbers in models for n, v in numbers_without(numbers, effects).items()])


def _differences(known: list[Numbers], effects: Iterable[str]) -> Any:
    """The same at a few points: array (points, numbers)."""
    each = [away for models in known if len(away := _away(models, effects))]
    return np.stack(each) if each else np.empty((0, 0))


def _changed(differences: Any) -> bool:
    """Whether the free parameters can change an effect."""
    return len(differences) > 1 and bool((np.ptp(differences, axis=0) > 1e-9 * abs(differences).max(axis=0)).any())


def _idle(problem: Any, effects: Iterable[str]) -> list[int]:
    """Free parameters that change nothing once the effects are left out."""
    of, idle = problem.parameters.leaving_out(effects), []
    base = next((p for p in _samples(problem) if of.models(p) is not None), None)
    if base is None:
        return []
    here = [dict(leaves(m)) for m in of.models(base) or []]
    for k in range(len(of.free)):
        moved = []
        for part in (0.02, -0.02, 0.3, -0.3):
            point = np.array(base)
            point[k] = np.clip(point[k] + part, 0.0, 1.0)
            models = of.models(point)
            moved += [] if models is None else [[dict(leaves(m)) for m in models] == here]
        if moved and all(moved):
            idle.append(k)
    return idle


def _fitted(problem: Any, known: list[Numbers], effects: Iterable[str], inside: list[Any], how: tuple[int, int, Workers]) -> Any:
    """The best point of the law without some effects, at which the whole law is that one; None if there is none."""
    starts, seed, workers = how
    idle = _idle(problem, effects)
    kept = [k for k in range(len(problem.parameters.free)) if k not in idle]
    if not idle or not kept:
        return None
    held = problem.parameters.values(problem.parameters.limits.roomy)
    reduced = problem.leaving_out(effects).only({name: float(held[name]) for name in (problem.parameters.names[k] for k in idle)})
    try:
        if inside:
            end = best_polished(reduced, [np.delete(point, idle) for point in inside], workers)
        else:
            end, _ = searched(reduced, min(starts, _STARTS), seed, workers=workers)
    except InputError:
        return None
    if end.stopped:
        raise Interrupted
    point = end.point
    for k in idle:
        point = np.insert(point, k, 0.5)
    scale = abs(_differences(known, effects)).max(axis=0)
    return _embedded(problem, point, idle, effects, np.where(scale > 0, scale, 1.0))


def _embedded(problem: Any, point: Array, idle: list[int], effects: Iterable[str], scale: Numeric) -> Any:
    """The point with idle parameters where the whole law is as near as can be to the one without the effects."""
    for k in [*idle, *(idle if len(idle) > 1 else [])]:
        point = _nearest(problem, point, k, effects, scale)
    return point


def _nearest(problem: Any, point: Array, k: int, effects: Iterable[str], scale: Numeric) -> Any:
    """The point with one parameter moved to where the numbers of the effects are nearest to what they are without these."""
    from scipy.optimize import minimize_scalar

    n = len(problem.parameters.free)

    def size(x: float) -> float:
        moved = np.array(point[:n])
        moved[k] = x
        models = _numbers(problem, moved)
        return np.inf if models is None else float(np.linalg.norm(_away(models, effects) / scale))

    grid = np.linspace(0.0, 1.0, _GRID)
    sizes = [size(x) for x in grid]
    if not np.isfinite(sizes).any() or np.ptp([s for s in sizes if np.isfinite(s)]) == 0:
        return point
    i = int(np.argmin(sizes))
    low, high = grid[max(i - 1, 0)], grid[min(i + 1, _GRID - 1)]
    with np.errstate(invalid="ignore"):  # where there is no law
        near = minimize_scalar(size, bounds=(low, high), method="bounded", options={"xatol": _FINE})
    nearest = np.array(point)
    nearest[k] = min((sizes[i], grid[i]), (near.fun, near.x))[1]
    return nearest
