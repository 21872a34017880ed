"""Special points between two neighbours of a branch: where a test function vanishes, or the kind of motion changes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.dynamics.paths import Path, Point
from stickslip.forces import is_dynamic

__all__ = ["located", "root"]

_AT_A_FOLD = 0.05  # how near to 1 a multiplier must be: a direction that turns without one is rounding where a branch ends
_HALVINGS = 60  # at most; until the two sides are the same number
_NEAR = {False: 1e-13, True: 1e-6}  # in the scaled space: where rest is exact, and for laws whose words have thresholds


def located(path: Path, a: Point, b: Point) -> list[tuple[str, Point, tuple[str, ...]]]:
    """Every special point between a and b, in order: its kind, the point, and what else is to be said."""
    found: list[tuple[str, Point, tuple[str, ...]]] = []
    if a.fold * b.fold < 0:
        there = root(path, a, b, _unity if a.unity * b.unity < 0 else _fold)
        if abs(np.asarray(there.orbit.multipliers) - 1.0).min(initial=np.inf) < _AT_A_FOLD:
            found.append(("fold", there, ()))
    if a.flip * b.flip < 0:
        found.append(("flip", root(path, a, b, lambda p: p.flip), ()))
    if a.turning * b.turning < 0:
        found += _turning(path, a, b)
    found += _changes(path, a, b, _reversals, lambda x, y: "grazing", _said_of_reversals) if is_dynamic(a.orbit.model.friction) else []
    found += _changes(path, a, b, _word, _kind_of_change, _said_of_words)
    return sorted(found, key=lambda item: (item[1].u - a.u) @ a.tangent)


def _turning(path: Path, a: Point, b: Point) -> list[tuple[str, Point, tuple[str, ...]]]:
    """Where a complex pair of multipliers passes the unit circle; two real ones whose product is 1 are nothing special."""
    there = root(path, a, b, lambda p: p.turning)
    found = np.asarray(there.orbit.multipliers, complex)
    pair = found[int(np.argmin(abs(abs(found) - 1.0) + (abs(found.imag) < 1e-9)))]
    if abs(pair.imag) < 1e-9:
        return []
    turn = abs(float(np.angle(pair))) / (2 * np.pi)
    return [("neimark-sacker", there, (f"a pair of multipliers passes the unit circle; it turns by {turn:.9g} of a turn in each period",))]


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


def _changes(path: Path, a: Point, b: Point, word: Callable[[Any], Any], kind: Any, said: Any) -> list[Any]:
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


def _word(orbit: Any) -> str:
    """What the motion is called: its pattern where rest is exact, its type where the word depends on thresholds."""
    return orbit.type if is_dynamic(orbit.model.friction) else orbit.pattern


def _reversals(orbit: Any) -> int:
    """Pairs of reversals in the motion period."""
    return (len(orbit.events) + 1) // 2


def _said_of_reversals(before: int, after: int, orbit: Any) -> str:
    return f"v touches zero: {2 * before} reversals in a motion period before, {2 * after} after"


def _said_of_words(before: str, after: str, orbit: Any) -> str:
    m = getattr(orbit, "motion", None)
    if m is not None and m.slip_ratio is not None:
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
