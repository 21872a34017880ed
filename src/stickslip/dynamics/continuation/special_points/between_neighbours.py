"""Special points between two neighbours of a branch: where a test function vanishes, or the kind of motion changes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np

from stickslip.analysis.motion import Motion
from stickslip.dynamics.continuation.following.pseudo_arclength import Path, Point
from stickslip.dynamics.continuation.following.stretches import Stretch
from stickslip.dynamics.continuation.special_points.accuracy import certain
from stickslip.dynamics.continuation.special_points.branch_points import broken_symmetry, crossing_between
from stickslip.dynamics.continuation.special_points.near_grazings import BOTH_SIDES, Touch, touches
from stickslip.dynamics.continuation.special_points.own_events import Event, number_of
from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit
from stickslip.dynamics.periodic.newton import root_between
from stickslip.models.model_adapter import adapter_of

_AT_A_FOLD = 0.05  # how near to 1 a multiplier must be: a direction that turns without one is rounding where a branch ends
_MOST_CHANGES = 8  # that are looked for between two points
_HALVINGS = 60  # at most; until the two sides are the same number
_NEAR = {False: 1e-13, True: 1e-6}  # in the scaled space: where rest is exact, and for laws whose words have thresholds


_ASIDE = 1e-4  # how far away the slope of a test function is taken
_NEARER = 1e-3  # of a stretch that turns sharply: the same there
_AT_ABOUT = 0.05  # of a period: instants of the same extreme in motions that are near one another
_MULTIPLIERS = 1e-10  # how well they are known: under dynamic laws, at a tolerance of 1e-12, they are some 3e-11 from those at 3e-12
_ROUNDED, _JUMPED = 1e-13, 1e-6  # of an event beside its zero: what rounding leaves of it, and what is left where it jumps
_RESIDUALS = 10.0  # by how much more than the point itself a border may be moved by its residual
_UNSEEN = 1e-12  # an arc shorter than 1e-13 of a period is not seen; borders known in closed form are moved by up to 6e-13 of their value


class Located(NamedTuple):
    """A special point, what else is to be said, and how far its parameter may be wrong; the value, where it is known better than there."""

    kind: str
    point: Point
    notes: tuple[str, ...]
    accuracy: float
    value: float | None = None


def located(path: Path, a: Point, b: Point, events: Mapping[str, Event] | None = None, borders: bool = True) -> list[Located]:
    """Every special point between a and b, in order; zeros of events of one's own among them, and borders of types if asked for."""
    on = Stretch(path, a, b)
    points = _crossed(path, a, b) if a.crossing * b.crossing < 0 else []
    if a.fold * b.fold < 0 and not points:
        test = attrgetter("unity" if a.unity * b.unity < 0 else "fold")
        there = _root(on, test)
        if abs(np.asarray(there.orbit.multipliers) - 1.0).min(initial=np.inf) < _AT_A_FOLD:
            points.append(Located("fold", there, (), _accuracy(on, there, test)))
    if a.flip * b.flip < 0:
        there = _root(on, attrgetter("flip"))
        points.append(Located("flip", there, (), _accuracy(on, there, attrgetter("flip"))))
    if a.turning * b.turning < 0:
        points += _turning(on)
    if borders:
        points += _changes(on, _reversals, lambda x, y: "grazing", _said_of_reversals) if _is_dynamic(a.orbit) else []
        points += _changes(on, _word, partial(_kind_of_change, a.orbit), _said_of_words)
    for name, event in (events or {}).items():
        points += _event(on, name, event)
    return sorted(points, key=lambda item: (item.point.u - a.u) @ on.along)


def _event(on: Stretch, name: str, event: Event) -> list[Located]:
    """Where an event of one's own passes zero between two points, or jumps past it."""

    def test(p: Point) -> float:
        return number_of(name, event, p.orbit)

    before, after, path = test(on.a), test(on.b), on.path
    if not (before * after < 0.0 or (after == 0.0 and before != 0.0)):
        return []
    there, size = _root(on, test), max(abs(before), abs(after))
    if abs(test(there)) > _JUMPED * size:
        unsure = path.span * (_NEAR[_is_dynamic(on.a.orbit)] + _RESIDUALS * there.blur)
        return [Located(name, there, (f"{name} jumps past zero here",), unsure)]
    return [Located(name, there, (f"{name} is zero here",), _accuracy(on, there, test, _ROUNDED * size))]


def _accuracy(on: Stretch, p: Point, test: Callable[[Point], float], known: float | None = None) -> float:
    """How far the parameter may be wrong where a test function vanishes.

    What is left of the function, what is not known of it (by itself of its multipliers), and by how much it and the branch move with
    tenfold tolerances.
    """
    if known is None:
        known = _MULTIPLIERS * float(np.prod(1.0 + abs(np.asarray(p.orbit.multipliers))))
    path, aside = on.path, _beside(on, p)
    other = path.loosened().between(p, 0.0)
    if not aside or other is None:
        return abs(on.b.value - p.value) + _turned(on.a, on.b, path.span)
    lengths = [abs(float((each.u - p.u) @ p.tangent)) for each in aside]
    slope = min(abs(test(each) - test(p)) / h for each, h in zip(aside, lengths, strict=True))
    bend = max(abs(each.fold - p.fold) / h for each, h in zip(aside, lengths, strict=True))
    unsure = abs(test(p)) + abs(test(other) - test(p)) + known
    along = unsure / slope if unsure < slope else 1.0  # of the range, where the test hardly changes
    moved = path.span * (abs(p.fold) * along + 0.5 * bend * along**2 + _RESIDUALS * p.blur)
    return float(min(moved + abs(other.value - p.value) + 2 * np.spacing(abs(p.value)), path.span))


def _beside(on: Stretch, p: Point) -> list[Point]:
    """A point beside one of a stretch; on both sides, and nearer, where the branch turns sharply."""
    if not on.turns:
        aside = on.path.between(p, _ASIDE) or on.path.between(p, -_ASIDE)
        return [aside] if aside else []
    there, h = float((p.u - on.a.u) @ on.along), _NEARER * on.length
    return [point for way in (h, -h) if (point := on.at(there + way))]


def _turned(a: Point, b: Point, span: float) -> float:
    """By how much the parameter may lie beyond those of two points between which the branch turns back; 0 where it does not."""
    if a.fold * b.fold >= 0.0:
        return 0.0
    along = a.tangent + b.tangent
    arc = float((b.u - a.u) @ along) / max(float(a.tangent @ along), 1e-300)  # no longer where it turns from one direction to the other
    return span * max(abs(a.fold), abs(b.fold)) * abs(arc)


def _crossed(path: Path, a: Point, b: Point) -> list[Located]:
    """The branch point between two points."""
    here = crossing_between(path, a, b)
    if here is None:
        return []
    symmetry = broken_symmetry(path, here)
    notes = ("two branches cross: switched() follows the other one", *((symmetry,) if symmetry else ()))
    return [Located("branch-point", here.point, notes, here.accuracy)]


def _turning(on: Stretch) -> list[Located]:
    """Where a complex pair of multipliers passes the unit circle; two real ones whose product is 1 are nothing special."""
    circle = attrgetter("turning")
    there = _root(on, circle)
    multipliers = np.asarray(there.orbit.multipliers, complex)
    pair = multipliers[int(np.argmin(abs(abs(multipliers) - 1.0) + (abs(multipliers.imag) < 1e-9)))]
    if abs(pair.imag) < 1e-9:
        return []
    turn = abs(float(np.angle(pair))) / (2 * np.pi)
    accuracy = _accuracy(on, there, circle)
    rotation = certain(turn, max(accuracy / on.path.span, 10 * _MULTIPLIERS))
    note = f"a pair of multipliers crosses the unit circle; it rotates by {rotation} of a turn in each period"
    return [Located("neimark-sacker", there, (note,), accuracy)]


def _root(on: Stretch, test: Callable[[Point], float]) -> Point:
    """Where a test function of the branch vanishes."""
    return root_between(on.at, on.length, on.a, on.b, test)


def _changes(on: Stretch, word: Callable[[Any], Any], kind: Any, said: Any) -> list[Located]:
    """Where a word for the motion changes, however often: bisection for each change. Changes that cannot be told apart are one."""
    places: list[tuple[Any, Any, Point, float, float]] = []  # word before, word after, where, value there, accuracy
    low, a, last, path = 0.0, on.a, word(on.a.orbit), on.path
    while last != word(on.b.orbit) and len(places) <= _MOST_CHANGES:
        low, before, here = _change(on, (low, a), word, last)
        after = word(here.orbit)
        moved = _RESIDUALS * path.span * max(here.blur, before.blur) + _UNSEEN * max(abs(here.value), path.span)
        value, unsure, earlier = here.value, abs(here.value - before.value) + _turned(before, here, path.span) + moved, last
        if _is_dynamic(here.orbit) and (touch := _touched_between(on, before, here)):
            value, unsure = touch if touch[1] < unsure else (value, unsure)
        if places and abs(value - places[-1][3]) <= unsure + places[-1][4]:  # as where both halves of a motion do the same
            earlier, _, _, other, wide = places.pop()
            unsure = max(unsure, wide) + abs(value - other)
        places += [(earlier, after, here, value, float(unsure))] if earlier != after else []
        last, a = after, here
    return [Located(kind(x, y), here, (said(x, y, here.orbit),), unsure, value) for x, y, here, value, unsure in places]


def _touched_between(on: Stretch, before: Point, here: Point) -> tuple[float, float] | None:
    """The parameter where an extreme of a slip passes zero between two near points of a stretch, and its accuracy; None if none does.

    Under a dynamic law motions on both sides have the extreme, and it is smooth (see `near_grazings`).
    """
    pairs = [(first, _like(first, here.orbit)) for first in _extremes(before.orbit)]
    what = next((first for first, then in pairs if then and first.extremum()[1] * then.extremum()[1] < 0.0), None)
    if what is None:
        return None

    def test(p: Point) -> float:
        there = _like(what, p.orbit)
        return there.extremum()[1] if there else float("nan")

    begin = float((before.u - on.a.u) @ on.along)
    length = float((here.u - before.u) @ on.along)
    there = root_between(lambda s: on.at(begin + s), length, before, here, test)
    return there.value, _accuracy(on, there, test, _ROUNDED * what.size)


def _extremes(orbit: Any) -> list[Touch]:
    return list(touches(orbit.run.with_axes, _span_of(orbit), lambda what: what[0] == BOTH_SIDES))


def _like(touch: Touch, orbit: Any) -> Touch | None:
    """The extreme of the same slip at about the same time in another motion."""
    span = _span_of(orbit)
    near = [each for each in _extremes(orbit) if each.what == touch.what and abs(each.t - touch.t) < _AT_ABOUT * span]
    return min(near, key=lambda each: abs(each.t - touch.t), default=None)


def _span_of(orbit: Any) -> float:
    """How long a drive period takes, or a cycle [s]."""
    return float(orbit.model.period or orbit.duration)


def _change(on: Stretch, low: tuple[float, Point], word: Callable[[Any], Any], last: Any) -> tuple[float, Point, Point]:
    """The first change after the word `last`: where it is along the stretch, and the points before and after it."""
    (inner, before), (outer, here) = low, (on.length, on.b)
    for _ in range(_HALVINGS):
        middle = 0.5 * (inner + outer)
        if not inner < middle < outer or outer - inner < _NEAR[_is_dynamic(on.a.orbit)]:
            break
        point = on.at(middle)
        if point is None:
            break
        if word(point.orbit) == last:
            inner, before = middle, point
        else:
            outer, here = middle, point
    return outer, before, here


def _word(orbit: PeriodicOrbit) -> str:
    """The name of the motion: it changes where the motion becomes another one."""
    return orbit.signature


def _is_dynamic(orbit: PeriodicOrbit) -> bool:
    return adapter_of(orbit.model).has_tolerance


def _reversals(orbit: PeriodicOrbit) -> int:
    """Pairs of reversals in the motion period."""
    return (len(orbit.events) + 1) // 2


def _said_of_reversals(before: int, after: int, orbit: PeriodicOrbit) -> str:
    return f"v touches zero: {2 * before} reversals in a motion period before, {2 * after} after"


def _said_of_words(before: str, after: str, orbit: PeriodicOrbit) -> str:
    m = orbit.motion if _is_dynamic(orbit) else None
    if isinstance(m, Motion) and m.slip_ratio is not None:
        return f"type {before} becomes {after} by the thresholds slip_ratio = {m.slip_ratio:g}, dwell = {m.dwell:g}"
    return f"pattern {before} becomes {after}"


def _kind_of_change(orbit: PeriodicOrbit, before: str, after: str) -> str:
    """A motion in which something begins that is only touched is at a grazing; any other change is a border of types."""
    return "grazing" if orbit.grazes(before, after) else "type-border"
