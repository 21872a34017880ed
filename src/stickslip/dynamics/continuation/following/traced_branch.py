"""A branch followed within a range of its parameter: its points, the special points between them, and why it ends."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.interruption import look, partial_result
from stickslip.basics.progress import Reported
from stickslip.dynamics.continuation.following.cycle_paths import CyclePath, birth, border_of_rest, rests_on_one_contact, vanishing
from stickslip.dynamics.continuation.following.pseudo_arclength import Path, Point
from stickslip.dynamics.continuation.following.steps import STOPPED, follow
from stickslip.dynamics.continuation.special_points.accuracy import Special, certain
from stickslip.dynamics.continuation.special_points.between_neighbours import Located, located
from stickslip.dynamics.continuation.special_points.grazing import grazed, grazing_end, grazing_near
from stickslip.dynamics.continuation.special_points.own_events import Event

_AGAIN = 3.0  # accuracies within which two borders are one
_ROUND = 0.9  # minus the cosine from which on a vector has turned round
_BESIDE = 1e-5  # of the branch's range: where the cycles are that tell where a rest vanishes


class BranchTrace(NamedTuple):
    """Points of a branch in order, special points between them in order, and why it ends."""

    points: list[Point]
    special: list[Special]
    ended: str


def trace_branch(
    path: Path,
    first: Point,
    low: float,
    high: float,
    step: float,
    most: int,
    events: Mapping[str, Event] | None = None,
    report: Reported = lambda *state: None,
    while_stable: bool = False,
) -> BranchTrace:
    """A branch from its first point until it leaves the range, with what lies between the points, and zeros of events of one's own.

    `while_stable` follows it to the first point where its stability changes, and looks for no borders of types on the way.
    """
    slack = 1e-12 * (high - low)
    points_so_far, ended = [first], ""
    special: list[Special] = []
    with partial_result() as ending:
        for item in follow(path, first, step, most, lambda value: low - slack <= value <= high + slack):
            look()
            if isinstance(item, str):
                ended = item
                break
            last = points_so_far[-1]
            if path.period % 2 == 0 and not isinstance(path, CyclePath) and _turned_round(last.half, item.half):
                end = _returned(path, last, item)
                points_so_far += [end] if end is not None else []
                ended = f"it returned to a motion of half the period at {path.family.parameters[0]} = {points_so_far[-1].value:.9g}"
                break
            born = birth(path, points_so_far, item) if isinstance(path, CyclePath) else None
            if born is not None:
                ended = f"the cycle shrinks to a steady motion at {path.family.parameters[0]} = {certain(*born)}"
                special.append(Special("hopf", born[0], replace(last.orbit, notes=(ended,)), born[1]))
                break
            if not low <= item.value <= high:
                item = _clipped(path, last, item, low if item.value < low else high)
            for s in located(path, last, item, events, borders=not while_stable):
                there = _special(path, points_so_far, item, s)
                special += [] if isinstance(path, CyclePath) and _known(special, there) else [there]
            points_so_far.append(item)
            report(f"{path.family.parameters[0]} = {item.value:.6g}", len(points_so_far), most)
            if while_stable and (border := next((s for s in special if s.changes_stability), None)):
                ended = f"its stability changes at {path.family.parameters[0]} = {border.rounded}"
                break
    ended = f"it was {ending.words}" if ending.interrupted else ended
    if ended.startswith(STOPPED):
        ended, border = _ended(path, points_so_far, ended)
        special += [] if border is None or _known(special, border) else [border]
    return BranchTrace(points_so_far, special, ended)


def _ended(path: Path, points: list[Point], why: str) -> tuple[str, Special | None]:
    """Why the motions of a branch end where no further point was found, and the special point there; else the solver's words."""
    name, last = path.family.parameters[0], points[-1]
    critical = vanishing(path, points)
    if critical is not None:
        sentence = f"the rest of the cycle vanishes at {name} = {certain(*critical)}, and no such cycle exists beyond"
        note = f"{sentence}; the cycle shown is at {name} = {last.value:.9g}"
        return sentence, Special("type-border", critical[0], replace(last.orbit, notes=(note,)), critical[1])
    end = grazing_end(path, last)
    what = end[0] if end else grazed(last.orbit)
    if not what:
        return why, None
    sentence = f"{what} is grazed at {name} = {certain(*end[1:]) if end else f'{last.value:.9g}'}"
    why = f"{sentence}, where impacts begin or end, and the continuation of this motion was not found: it may jump to another one; "
    return f"{why}ss.solve from its state shows to which", Special(
        "grazing", end[1], replace(last.orbit, notes=(sentence,)), end[2]
    ) if end else None


def _known(special: list[Special], candidate: Special) -> bool:
    """Whether a border was found already: the branch has a corner where a cycle loses its rest, and may pass it and come back."""
    return any(s.kind == candidate.kind and abs(s.value - candidate.value) <= _AGAIN * (s.accuracy + candidate.accuracy) for s in special)


def _special(path: Path, points: list[Point], b: Point, s: Located) -> Special:
    """A special point between the last point and another, as well as it is known from the motions beside it."""
    known: tuple[float, float] | None = None
    if s.kind == "type-border" and isinstance(path, CyclePath) and rests_on_one_contact(s.point.orbit):
        known = _rest_begins(path, points, b, s)
    elif s.kind == "grazing":
        known = _touch_begins(path, points[-1], b, s)
    value, accuracy = known or (s.point.value if s.value is None else s.value, s.accuracy)
    return Special(s.kind, value, replace(s.point.orbit, notes=s.notes), accuracy)


def _rest_begins(path: CyclePath, points: list[Point], b: Point, s: Located) -> tuple[float, float] | None:
    """Where a cycle loses its rest is better known from cycles that have some."""
    resting = [p for p in (points[-1], b) if "0" in p.orbit.pattern]
    spread = max(_BESIDE * path.span, 10 * s.accuracy)
    known = border_of_rest(path, resting[0], s.point.value, spread) if len(resting) == 1 else None
    return known or (vanishing(path, points) if resting == [points[-1]] else None)


def _touch_begins(path: Path, a: Point, b: Point, s: Located) -> tuple[float, float] | None:
    """Where a stop or a guard is grazed is better known from motions that miss it, on one side or the other."""
    for point, ahead in ((a, s.point.value - a.value), (b, s.point.value - b.value)):
        known = grazing_near(path, point, s.point.value, float(np.sign(ahead)), s.accuracy) if ahead else None
        if known and known[2] < s.accuracy:
            return known[1:]
    return None


def _turned_round(a: Array, b: Array) -> bool:
    """Whether a vector passed zero between two values: all of it turns round then, not one of its coordinates."""
    return bool(a @ b < -_ROUND * np.linalg.norm(a) * np.linalg.norm(b))


def _returned(path: Path, a: Point, b: Point) -> Point | None:
    """Where a doubled motion falls together with its halves: there the motion of half the period has a multiplier of -1."""
    from scipy.optimize import brentq

    shorter, part = replace(path, period=path.period // 2), a.half @ a.half / (a.half @ (a.half - b.half))
    near = a.u + part * (b.u - a.u)
    kept: dict[float, Point] = {}

    def flip(value: float) -> float:
        root = shorter.at_value(near, value, path.remembered(a.orbit))
        if not root.good:
            return float("nan")
        kept[value] = shorter.point(root, a.tangent)
        return kept[value].flip

    middle = float(path.value(near))
    for width in (1e-6, 1e-5, 1e-4, 1e-3, 1e-2):
        low, high = middle - width * path.span, middle + width * path.span
        if flip(low) * flip(high) < 0:
            where = brentq(flip, low, high, xtol=1e-14 * path.span, rtol=1e-14)
            last = kept.get(where) or min(kept.values(), key=lambda p: abs(p.flip))
            return replace(last, orbit=replace(last.orbit, period=path.period))
    return None


def _clipped(path: Path, last: Point, beyond: Point, end: float) -> Point:
    """The point of the branch at the end of the range."""
    part = (end - last.value) / (beyond.value - last.value) if beyond.value != last.value else 1.0
    root = path.at_value(last.u + part * (beyond.u - last.u), end, path.remembered(last.orbit))
    return path.point(root, last.tangent) if root.good else beyond
