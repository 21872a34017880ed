"""Special points between two neighbours of a branch: where a test function vanishes, or the kind of motion changes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from functools import partial
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stickslip.analysis.contact_modes import pressed_stops
from stickslip.analysis.motion import Motion
from stickslip.dynamics.continuation.following.pseudo_arclength import Path, Point
from stickslip.dynamics.continuation.special_points.accuracy import certain
from stickslip.dynamics.continuation.special_points.branch_points import broken_symmetry, crossing_between
from stickslip.dynamics.continuation.special_points.own_events import Event, number_of
from stickslip.dynamics.periodic.newton import root_between
from stickslip.models.machine_adapter import machine_of
from stickslip.models.model_adapter import adapter_of

if TYPE_CHECKING:
    from stickslip.dynamics.periodic.periodic_orbits import PeriodicOrbit


_AT_A_FOLD = 0.05  # how near to 1 a multiplier must be: a direction that turns without one is rounding where a branch ends
_MOST_CHANGES = 8  # that are looked for between two points
_HALVINGS = 60  # at most; until the two sides are the same number
_NEAR = {False: 1e-13, True: 1e-6}  # in the scaled space: where rest is exact, and for laws whose words have thresholds


_ASIDE = 1e-4  # how far away the slope of a test function is taken
_MULTIPLIERS = 1e-10  # how well they are known: under dynamic laws, at a tolerance of 1e-12, they are some 3e-11 from those at 3e-12
_ROUNDED, _JUMPED = 1e-13, 1e-6  # of an event beside its zero: what rounding leaves of it, and what is left where it jumps
_RESIDUALS = 10.0  # by how much more than the point itself a border may be moved by its residual
_BETWEEN, _COUNTED = " | ", ", "  # the patterns of several contacts; what a motion touches
_TOUCHES = {"hit": "hit", "take-off": "takes off"}
_UNSEEN = 1e-12  # an arc shorter than 1e-13 of a period is not seen; borders known in closed form are moved by up to 6e-13 of their value


class Located(NamedTuple):
    """A special point, what else is to be said, and how far its parameter may be wrong."""

    kind: str
    point: Point
    notes: tuple[str, ...]
    accuracy: float


def located(path: Path, a: Point, b: Point, events: Mapping[str, Event] | None = None) -> list[Located]:
    """Every special point between a and b, in order; zeros of events of one's own among them."""
    points = _crossed(path, a, b) if a.crossing * b.crossing < 0 else []
    if a.fold * b.fold < 0 and not points:
        test = attrgetter("unity" if a.unity * b.unity < 0 else "fold")
        there = _root(path, a, b, test)
        if abs(np.asarray(there.orbit.multipliers) - 1.0).min(initial=np.inf) < _AT_A_FOLD:
            points.append(Located("fold", there, (), _accuracy(path, there, test, b)))
    if a.flip * b.flip < 0:
        there = _root(path, a, b, attrgetter("flip"))
        points.append(Located("flip", there, (), _accuracy(path, there, attrgetter("flip"), b)))
    if a.turning * b.turning < 0:
        points += _turning(path, a, b)
    points += _changes(path, a, b, _reversals, lambda x, y: "grazing", _said_of_reversals) if _is_dynamic(a.orbit) else []
    points += _changes(path, a, b, _word, _kind_of_change if adapter_of(a.orbit.model).has_bodies else _kind_of_switches, _said_of_words)
    for name, event in (events or {}).items():
        points += _event(path, a, b, name, event)
    return sorted(points, key=lambda item: (item.point.u - a.u) @ a.tangent)


def _event(path: Path, a: Point, b: Point, name: str, event: Event) -> list[Located]:
    """Where an event of one's own passes zero between two points, or jumps past it."""

    def test(p: Point) -> float:
        return number_of(name, event, p.orbit)

    before, after = test(a), test(b)
    if not (before * after < 0.0 or (after == 0.0 and before != 0.0)):
        return []
    there, size = _root(path, a, b, test), max(abs(before), abs(after))
    if abs(test(there)) > _JUMPED * size:
        unsure = path.span * (_NEAR[_is_dynamic(a.orbit)] + _RESIDUALS * there.blur)
        return [Located(name, there, (f"{name} jumps past zero here",), unsure)]
    return [Located(name, there, (f"{name} is zero here",), _accuracy(path, there, test, b, _ROUNDED * size))]


def _accuracy(path: Path, p: Point, test: Callable[[Point], float], b: Point, known: float | None = None) -> float:
    """How far the parameter may be wrong where a test function vanishes.

    What is left of the function, what is not known of it (by itself of its multipliers), and by how much it and the branch move with
    tenfold tolerances.
    """
    if known is None:
        known = _MULTIPLIERS * float(np.prod(1.0 + abs(np.asarray(p.orbit.multipliers))))
    aside = path.between(p, _ASIDE) or path.between(p, -_ASIDE)
    other = path.loosened().between(p, 0.0)
    if aside is None or other is None:
        return abs(b.value - p.value)
    h = float((aside.u - p.u) @ p.tangent)
    slope, bend = abs(test(aside) - test(p)) / abs(h), abs(aside.fold - p.fold) / abs(h)
    unsure = abs(test(p)) + abs(test(other) - test(p)) + known
    along = unsure / slope if unsure < slope else 1.0  # of the range, where the test hardly changes
    moved = path.span * (abs(p.fold) * along + 0.5 * bend * along**2 + _RESIDUALS * p.blur)
    return float(min(moved + abs(other.value - p.value) + 2 * np.spacing(abs(p.value)), path.span))


def _crossed(path: Path, a: Point, b: Point) -> list[Located]:
    """The branch point between two points."""
    here = crossing_between(path, a, b)
    if here is None:
        return []
    symmetry = broken_symmetry(path, here)
    notes = ("two branches cross: switched() follows the other one", *((symmetry,) if symmetry else ()))
    return [Located("branch-point", here.point, notes, here.accuracy)]


def _turning(path: Path, a: Point, b: Point) -> list[Located]:
    """Where a complex pair of multipliers passes the unit circle; two real ones whose product is 1 are nothing special."""
    circle = attrgetter("turning")
    there = _root(path, a, b, circle)
    multipliers = np.asarray(there.orbit.multipliers, complex)
    pair = multipliers[int(np.argmin(abs(abs(multipliers) - 1.0) + (abs(multipliers.imag) < 1e-9)))]
    if abs(pair.imag) < 1e-9:
        return []
    turn = abs(float(np.angle(pair))) / (2 * np.pi)
    accuracy = _accuracy(path, there, circle, b)
    rotation = certain(turn, max(accuracy / path.span, 10 * _MULTIPLIERS))
    note = f"a pair of multipliers crosses the unit circle; it rotates by {rotation} of a turn in each period"
    return [Located("neimark-sacker", there, (note,), accuracy)]


def _length(a: Point, b: Point) -> float:
    return float((b.u - a.u) @ a.tangent)


def _root(path: Path, a: Point, b: Point, test: Callable[[Point], float]) -> Point:
    """Where a test function of the branch vanishes."""
    return root_between(partial(path.between, a), a, b, test)


def _changes(path: Path, a: Point, b: Point, word: Callable[[Any], Any], kind: Any, said: Any) -> list[Located]:
    """Where a word for the motion changes, however often: bisection for each change. Changes that cannot be told apart are one."""
    places: list[tuple[Any, Any, Point, float]] = []  # word before, word after, where, accuracy
    low, end, first, last = 0.0, _length(a, b), a, word(a.orbit)
    while last != word(b.orbit) and len(places) <= _MOST_CHANGES:
        low, before, here = _change(path, first, (low, a), (end, b), word, last)
        after = word(here.orbit)
        moved = _RESIDUALS * path.span * max(here.blur, before.blur) + _UNSEEN * max(abs(here.value), path.span)
        unsure, earlier = abs(here.value - before.value) + moved, last
        if places and abs(here.value - places[-1][2].value) <= unsure + places[-1][3]:  # as where both halves of a motion do the same
            earlier, _, there, wide = places.pop()
            unsure = max(unsure, wide) + abs(here.value - there.value)
        places += [(earlier, after, here, float(unsure))] if earlier != after else []
        last, a = after, here
    return [Located(kind(x, y), here, (said(x, y, here.orbit),), unsure) for x, y, here, unsure in places]


def _change(
    path: Path, first: Point, low: tuple[float, Point], high: tuple[float, Point], word: Callable[[Any], Any], last: Any
) -> tuple[float, Point, Point]:
    """The first change after the word `last`: where it is along the tangent of the first point, and the points before and after it."""
    (inner, before), (outer, here) = low, high
    for _ in range(_HALVINGS):
        middle = 0.5 * (inner + outer)
        if not inner < middle < outer or outer - inner < _NEAR[_is_dynamic(first.orbit)]:
            break
        point = path.between(first, middle)
        if point is None:
            break
        if word(point.orbit) == last:
            inner, before = middle, point
        else:
            outer, here = middle, point
    return outer, before, here


def _word(orbit: PeriodicOrbit) -> str:
    """The name of the motion: its pattern if rest is exact, else its type, which depends on thresholds; and the parts that it touches."""
    return _pattern_of(orbit) + _touched(orbit)


def _touched(orbit: PeriodicOrbit) -> str:
    """How often in the motion each stop is hit, or begins to be pressed, and each contact takes off: ", inner-body hit twice"."""
    if not adapter_of(orbit.model).has_bodies:
        return ""
    run = orbit.run
    end = float(run.pieces.t[-1])
    counts = Counter(f"{event.part} {_TOUCHES[event.kind]}" for event in run.events if event.kind in _TOUCHES)
    counts.update({f"{name} pressed": sum(start > 0.0 for start, _ in of) for name, of in pressed_stops(run, 0.0, end).items()})
    times = ("", "once", "twice", "three times or more")
    return "".join(f"{_COUNTED}{name} {times[min(count, 3)]}" for name, count in sorted(counts.items()) if count)


def _pattern_of(orbit: PeriodicOrbit) -> str:
    """Of a machine of several bodies the patterns of all contacts; where laws never rest exactly its reversals say all that is sharp."""
    if not adapter_of(orbit.model).has_bodies:
        return f"{len(orbit.events)} switches to {', '.join(map(str, orbit.pattern))}" if orbit.events else "no switch"
    if machine_of(orbit.model).names_parts:
        return "" if _is_dynamic(orbit) else _BETWEEN.join(orbit.patterns.values())
    return orbit.type if _is_dynamic(orbit) else orbit.pattern


def _is_dynamic(orbit: PeriodicOrbit) -> bool:
    return adapter_of(orbit.model).has_tolerance


def _reversals(orbit: PeriodicOrbit) -> int:
    """Pairs of reversals in the motion period."""
    return (len(orbit.events) + 1) // 2


def _said_of_reversals(before: int, after: int, orbit: PeriodicOrbit) -> str:
    return f"v touches zero: {2 * before} reversals in a motion period before, {2 * after} after"


def _said_of_words(before: str, after: str, orbit: PeriodicOrbit) -> str:
    m = orbit.motion if adapter_of(orbit.model).has_bodies and orbit.model.period is not None else None
    if isinstance(m, Motion) and m.slip_ratio is not None:
        return f"type {before} becomes {after} by the thresholds slip_ratio = {m.slip_ratio:g}, dwell = {m.dwell:g}"
    return f"pattern {before} becomes {after}"


def _kind_of_switches(before: str, after: str) -> str:
    """More or fewer switches among the same modes begin where a guard is touched; of a flow any other change is a border of types."""
    modes = [set(word.partition(" to ")[2].split(", ")) - {""} for word in (before, after)]
    return "grazing" if modes[0] <= modes[1] or modes[1] <= modes[0] else "type-border"


def _kind_of_change(before: str, after: str) -> str:
    """A slide that is cut in two where its velocity touches zero is a grazing; any other change is a border of types."""
    before, after = before.partition(_COUNTED)[0], after.partition(_COUNTED)[0]
    changed = [(a, b) for a, b in zip(before.split(_BETWEEN), after.split(_BETWEEN), strict=True) if a != b]
    return "grazing" if all(_is_grazing(a, b) for a, b in changed) else "type-border"


def _is_grazing(before: str, after: str) -> bool:
    long, short = sorted((before, after), key=len, reverse=True)
    for side in "+-":
        if any(
            side + gap + side in long + long and side + gap + side not in short + short for gap in ("0", "-" if side == "+" else "+")
        ) and (long.count(side) > short.count(side)):
            return True
    return False
