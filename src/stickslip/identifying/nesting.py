"""Simpler laws inside the one that is fitted, and the places where the law is one of them, from which a search goes on."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np

from stickslip.errors import InputError
from stickslip.fields import leaves
from stickslip.identifying.effects import EFFECTS, numbers_without
from stickslip.identifying.search import polished, searched

__all__ = ["nested_seeds"]

_ALL = 3  # effects up to which every set of them is left out
_STARTS = 16
_GOLDEN = 0.5 * (np.sqrt(5) - 1)
_GRID, _STEPS = 33, 40


def nested_seeds(problem: Any, starts: int, seed: int) -> list[Any]:
    """Whole places where the law is a simpler one, and fits best as such: from the simplest on, each sought from those inside it."""
    try:
        active = _active(problem)
    except InputError:
        return []
    sets = [each for k in range(len(active), 0, -1) if k in (1, len(active)) or len(active) <= _ALL for each in combinations(active, k)]
    ends: dict[frozenset[str], Any] = {}
    for effects in sets:
        inside = [place for more, place in ends.items() if more > set(effects)]
        end = _fitted(problem, effects, inside, starts, seed)
        if end is not None:
            ends[frozenset(effects)] = end
    return list(ends.values())


def _samples(problem: Any) -> Any:
    """A few places, the same always."""
    rng = np.random.default_rng(0)
    return rng.uniform(0.05, 0.95, (24, len(problem.parameters.free)))


def _away(problem: Any, place: Any, effects: Any) -> Any:
    """How far the numbers of effects are from what they are without these, in all records; None where there is no model."""
    models = problem.parameters.models(place)
    if models is None:
        return None
    found = []
    for model in models:
        numbers = dict(leaves(model))
        plain = numbers_without(numbers, effects)
        found += [float(numbers[n] - v) for n, v in plain.items()]
    return np.array(found)


def _active(problem: Any) -> list[str]:
    """Effects that the free parameters can change."""
    found = []
    for effect in EFFECTS:
        each = _differences(problem, [effect])
        if len(each) > 1 and (np.ptp(each, axis=0) > 1e-9 * abs(each).max(axis=0)).any():
            found.append(effect)
    return found


def _differences(problem: Any, effects: Any) -> Any:
    """How far the numbers of effects are from what they are without these, at a few places: array (places, numbers)."""
    each = [a for place in _samples(problem) if (a := _away(problem, place, effects)) is not None and len(a)]
    return np.stack(each) if each else np.empty((0, 0))


def _idle(problem: Any, effects: Any) -> list[int]:
    """Free parameters that change nothing once the effects are left out."""
    of, found = problem.parameters.leaving_out(effects), []
    base = next((p for p in _samples(problem) if of.models(p) is not None), None)
    if base is None:
        return []
    here = [dict(leaves(m)) for m in of.models(base) or []]
    for k in range(len(of.free)):
        moved = []
        for part in (0.02, -0.02, 0.3, -0.3):
            place = np.array(base)
            place[k] = np.clip(place[k] + part, 0.0, 1.0)
            models = of.models(place)
            moved += [] if models is None else [[dict(leaves(m)) for m in models] == here]
        if moved and all(moved):
            found.append(k)
    return found


def _fitted(problem: Any, effects: Any, inside: list[Any], starts: int, seed: int) -> Any:
    """The best place of the law without some effects, at which the whole law is that one; None if there is none."""
    idle = _idle(problem, effects)
    kept = [k for k in range(len(problem.parameters.free)) if k not in idle]
    if not idle or not kept:
        return None
    middle = problem.parameters.values(np.full(len(problem.parameters.free), 0.5))
    reduced = problem.leaving_out(effects).only(
        {problem.parameters.free[k].name: float(middle[problem.parameters.free[k].name]) for k in idle}
    )
    try:
        if inside:
            end = min((polished(reduced, np.delete(place, idle), rough=True) for place in inside), key=lambda e: e.cost)
        else:
            end, _ = searched(reduced, min(starts, _STARTS), seed)
    except InputError:
        return None
    if end.stopped:
        raise KeyboardInterrupt
    place = end.place
    for k in idle:
        place = np.insert(place, k, 0.5)
    return _embedded(problem, place, idle, effects)


def _embedded(problem: Any, place: Any, idle: list[int], effects: Any) -> Any:
    """The place with idle parameters where the whole law is as near as can be to the one without the effects."""
    scale = abs(_differences(problem, effects)).max(axis=0)
    for k in [*idle, *(idle if len(idle) > 1 else [])]:
        place = _nearest(problem, place, k, effects, np.where(scale > 0, scale, 1.0))
    return place


def _nearest(problem: Any, place: Any, k: int, effects: Any, scale: Any) -> Any:
    """The place with one parameter moved to where the numbers of the effects are nearest to what they are without these."""
    n = len(problem.parameters.free)

    def size(x: float) -> float:
        moved = np.array(place[:n])
        moved[k] = x
        away = _away(problem, moved, effects)
        return np.inf if away is None else float(np.linalg.norm(away / scale))

    grid = np.linspace(0.0, 1.0, _GRID)
    sizes = [size(x) for x in grid]
    if not np.isfinite(sizes).any() or np.ptp([s for s in sizes if np.isfinite(s)]) == 0:
        return place
    i = int(np.argmin(sizes))
    low, high = grid[max(i - 1, 0)], grid[min(i + 1, _GRID - 1)]
    best = (sizes[i], grid[i])
    left, right = ((size(x), x) for x in (high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)))
    for _ in range(_STEPS):
        best = min(best, left, right)
        if left[0] < right[0]:
            high, right, x = right[1], left, right[1] - _GOLDEN * (right[1] - low)
            left = size(x), x
        else:
            low, left, x = left[1], right, left[1] + _GOLDEN * (high - left[1])
            right = size(x), x
    found = np.array(place)
    found[k] = best[1]
    return found
