"""Special points between two neighbours of a branch: where a test function vanishes, or the kind of motion changes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from stickslip.dynamics.orbits import PeriodicOrbit
from stickslip.dynamics.paths import Path, Point
from stickslip.forces import is_dynamic

__all__ = ["located", "root"]

_HALVINGS = 60  # at most; until the two sides are the same number
_NEAR = {False: 1e-13, True: 1e-6}  # in the scaled space: where rest is exact, and for laws whose words have thresholds


def located(path: Path, a: Point, b: Point) -> list[tuple[str, Point, tuple[str, ...]]]:
    """Every special point between a and b, in order: its kind, the point, and what else is to be said."""
    found: list[tuple[str, Point, tuple[str, ...]]] = []
    if a.fold * b.fold < 0:
        found.append(("fold", root(path, a, b, _unity if a.unity * b.unity < 0 else _fold), ()))
    if a.flip * b.flip < 0:
        found.append(("flip", root(path, a, b, lambda p: p.flip), ()))
    found += _changes(path, a, b, _reversals, lambda x, y: "grazing", _said_of_reversals) if is_dynamic(a.orbit.model.friction) else []
    found += _changes(path, a, b, _word, _kind_of_change, _said_of_words)
    return sorted(found, key=lambda item: (item[1].u - a.u) @ a.tangent)


def _unity(p: Point) -> float:
    return p.unity


def _fold(p: Point) -> float:
    return p.fold


def _length(a: Point, b: Point) -> float:
    return float((b.u - a.u) @ a.tangent)


def root(path: Path, a: Point, b: Point, test: Callable[[Point], float]) -> Point:
    """Where a test function of the branch vanishes."""
    from scipy.optimize import brentq

    kept: dict[float, Point] = {0.0: a, _length(a, b): b}

    def value(s: float) -> float:
        if s not in kept:
            point = path.between(a, s)
            if point is None:  # no number here: take the nearest point there is, so that the search goes on
                return test(kept[min(kept, key=lambda k: abs(k - s))])
            kept[s] = point
        return test(kept[s])

    s = brentq(value, 0.0, _length(a, b), xtol=1e-15, rtol=1e-14, maxiter=60)
    return kept.get(s) or min(kept.values(), key=lambda p: abs(test(p)))


def _changes(path: Path, a: Point, b: Point, word: Callable[[PeriodicOrbit], Any], kind: Any, said: Any) -> list[Any]:
    """Where a word for the motion changes, however often: bisection for each change."""
    found, low, end, near = [], 0.0, _length(a, b), _NEAR[is_dynamic(a.orbit.model.friction)]
    last = word(a.orbit)
    while last != word(b.orbit):
        inner, outer, here = low, end, b
        for _ in range(_HALVINGS):
            middle = 0.5 * (inner + outer)
            if not inner < middle < outer or outer - inner < near:
                break
            point = path.between(a, middle)
            if point is None:
                break
            if word(point.orbit) == last:
                inner = middle
            else:
                outer, here = middle, point
        after = word(here.orbit)
        found.append((kind(last, after), here, (said(last, after, here.orbit),)))
        low, last = outer, after
        if len(found) > 8:
            break
    return found


def _word(orbit: PeriodicOrbit) -> str:
    """What the motion is called: its pattern where rest is exact, its type where the word depends on thresholds."""
    return orbit.type if is_dynamic(orbit.model.friction) else orbit.pattern


def _reversals(orbit: PeriodicOrbit) -> int:
    """Pairs of reversals in the motion period."""
    return (len(orbit.events) + 1) // 2


def _said_of_reversals(before: int, after: int, orbit: PeriodicOrbit) -> str:
    return f"v touches zero: {2 * before} reversals in a motion period before, {2 * after} after"


def _said_of_words(before: str, after: str, orbit: PeriodicOrbit) -> str:
    m = orbit.motion
    if m.slip_ratio is not None:
        return f"type {before} becomes {after} by the thresholds slip_ratio = {m.slip_ratio:g}, dwell = {m.dwell:g}"
    return f"pattern {before} becomes {after}"


def _kind_of_change(before: str, after: str) -> str:
    """A slide that is cut in two where its velocity touches zero is a grazing; any other change is a border of types."""
    long, short = sorted((before, after), key=len, reverse=True)
    for side in "+-":
        if any(
            side + gap + side in long + long and side + gap + side not in short + short for gap in ("0", "-" if side == "+" else "+")
        ) and (long.count(side) > short.count(side)):
            return "grazing"
    return "type-border"
