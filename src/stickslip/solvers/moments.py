"""Moments of a simulation: what it is at an instant, and the step from one to the next."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, did_you_mean
from stickslip.basics.fields import number
from stickslip.basics.interruption import look
from stickslip.basics.status import Status
from stickslip.engine.held_lane import ALL, ENDED, ROOM, SPAN_ALONE, THERE
from stickslip.solvers.held_cases import HeldCase, Standing

#: Of what has no period: how many typical times its run is taken to be long, until it has lasted half of that.
AHEAD = 64.0
_SAME = 1e-12  # of a period: an instant this close to its end is its end


class Kept(NamedTuple):
    """Steps of dense output that are kept, behind those before them."""

    before: Kept | None
    case: HeldCase
    rows: Array


class Last(NamedTuple):
    """The last step: what is needed to say what happened in it."""

    case: HeldCase
    early: tuple[Any, ...]  # events that are known
    before: Standing
    rows: Array
    after: Standing


class Moment(NamedTuple):
    """All that a simulation is at an instant; a step makes another one."""

    lane: Any
    side: Any
    case: HeldCase
    inputs: dict[str, float]  # applied forces, and others that change alone, by the numbers that they are
    span: float
    t: float
    standing: Standing
    status: int
    sentence: str
    last: Last | None
    kept: Kept | None


def first_moment(case: HeldCase) -> Moment:
    """Where a case begins."""
    unit = case.unit
    span = AHEAD * unit if unit is not None and math.isfinite(unit) and unit > 0.0 else AHEAD
    lane, numbers = case.lane(span), case.numbers()
    quick = {number: numbers[name] for name, number in case.names.items() if case.is_quick(number)}
    return Moment(lane, lane.first, case, quick, span, 0.0, case.standing(lane.first, 0.0), 0, "", None, None)


def standing_of(moment: Moment) -> Moment:
    """A moment whose lane was put where it stands."""
    return moment._replace(standing=moment.case.standing(moment.side, moment.t))


def end_of(t: float, dt: Any, until: Any) -> float:
    """Where a step ends [s]."""
    if (dt is None) == (until is None):
        both = "neither of dt and until is given" if dt is None else "dt and until are both given"
        raise InputError("step", [f"{both}; allowed is one of them; type sim.step(1e-3), or sim.step(until=0.5)"])
    name, value = ("dt", dt) if until is None else ("until", until)
    good = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool) and math.isfinite(value)
    end = (t + float(value) if until is None else float(value)) if good else math.nan
    if not end > t or end > 1e12:
        least = "a positive time [s]" if until is None else f"a time after t = {t:.9g} s"
        small = " (it is lost in the rounding of the time)" if good and until is None and value > 0 else ""
        raise InputError("step", [f"{name} = {value!r}{small}; allowed is {least}; type for example sim.step(1e-3)"])
    return end


def changes_in(now: Moment, inputs: Any) -> dict[str, float]:
    """Inputs that differ from what they are, by the names of the numbers."""
    problems, changed = Problems("step"), dict[str, float]()
    if not isinstance(inputs, dict):
        raise InputError(
            "step",
            [f'inputs = {inputs!r}; allowed is a dict; type for example inputs={{"{next(iter(now.case.names), "force")}": 0.1}}'],
        )
    names, old = now.case.names, None
    for name, value in inputs.items():
        if name not in names:
            problems.add(f"there is no input {name!r}; {did_you_mean(str(name), names)}; type sim.inputs for all of them")
            continue
        try:
            new = number(value)
            if not isinstance(new, float) or not math.isfinite(new):
                raise ValueError(f"{value!r} is not one finite number")
        except (TypeError, ValueError) as error:
            problems.add(f"inputs[{name!r}]: {error}; allowed is one finite number, constant over the step")
            continue
        key = names[name]
        if key not in now.inputs and old is None:
            old = now.case.numbers()
        if new != (now.inputs[key] if old is None or key in now.inputs else old[name]):
            changed[key] = new
    problems.check()
    return changed


def after_step(now: Moment, end: float, dt: float | None, given: dict[str, float], stop: bool, record: bool) -> Moment:
    """The moment after a step: nothing of `now` changes, so that a step that does not come to its end leaves it as it was.

    Parameters
    ----------
    now : Moment
    end : float
        Where the step ends [s].
    dt : float, optional
        How long it is, where that was given.
    given : dict
        Inputs that change, by the numbers that they are.
    stop : bool
        Whether it ends at the first event.
    record : bool
        Whether its dense output is kept.
    """
    base = now.case.ready_for(given)
    if base is now.case:
        lane, draft = now.lane, now.lane.draft_of(now.side)
    else:
        lane = base.lane(now.span, now.side)
        draft = lane.first
        draft.stand(now.side.periods, now.side.time)
    case, inputs, span = _renumbered(now, base, draft, given, end)
    _aim(draft, case, now.t, end, dt, stop)
    goal = now._replace(lane=lane, side=draft, case=case, inputs=inputs, span=span, t=end)
    return _advanced(now, goal, stop, bool(given), record)


def _renumbered(now: Moment, base: HeldCase, draft: Any, given: dict[str, float], end: float) -> tuple[Any, dict[str, float], float]:
    """Put new numbers into a draft: the case that has them, those that change alone, and how long a run is taken to be."""
    case, span = base, now.span
    quick = {**now.inputs, **{name: value for name, value in given.items() if name in now.inputs}}
    others = {name: value for name, value in given.items() if name not in now.inputs}
    if others:
        case = base.changed(others)
        span = max(span, AHEAD * (case.unit or 0.0))
    while case.period is None and end > 0.5 * span:
        span *= 2.0
    if others or span != now.span or base is not now.case:
        row = case.row(span)
        put(quick, row, case)
        draft.renumber(row, ALL if given else SPAN_ALONE)
    elif given:
        row = draft.row.copy()
        put(given, row, case)
        draft.renumber(row)
    if given:
        case.judge_anew(draft)
    if others:
        case.rebase(draft, now.case, now.t)
        if case.period is not None and case.period != now.case.period:
            whole = math.floor(now.t / case.period + _SAME)
            draft.stand(whole, max(now.t - whole * case.period, 0.0))
    return case, quick, span


def _aim(draft: Any, case: HeldCase, t: float, end: float, dt: float | None, each_step: bool) -> None:
    """Say where a draft goes: a period and a time in it."""
    T, whole, time = case.period, draft.periods, draft.time
    time = time + float(dt) if dt is not None else end if T is None else end - whole * T
    if T is not None:
        more = math.floor(time / T)
        whole, time = whole + more, time - more * T
        if more > 0 and time <= _SAME * T:
            whole, time = whole - 1, T
    draft.aim(whole, time, case.budget(end - t), each_step)


def _advanced(now: Moment, goal: Moment, stop: bool, anew: bool, record: bool) -> Moment:
    """Take the draft of a goal there, or to the first event: the moment to which it comes."""
    draft, case, early = goal.side, goal.case, list[Any]()
    before, kept = now.standing, now.kept
    if stop and anew:
        draft.advance(0)
    held = (draft.sides, draft.modes.copy())
    rows: Any = ()
    while True:
        code = draft.advance()
        new = draft.taken()
        rows = np.concatenate([rows, new]) if len(rows) else new
        if code in (THERE, ENDED):
            break
        look()
        if stop and draft.switched(new, *held):
            happened = case.events(before, rows, case.standing(draft, _time_of(draft, case)))
            if any(event.t > now.t + _SAME * (case.period or goal.span) for event in happened):
                break
            held = (draft.sides, draft.modes.copy())
        if len(rows) >= ROOM and not stop:
            after = case.standing(draft, _time_of(draft, case))
            early += case.events(before, rows, after)
            kept = Kept(kept, case.changed(goal.inputs), case.whole(before, rows, draft)) if record else kept
            before, rows = after, rows[:0]
    status = draft.status if code == ENDED else 0
    t = goal.t if code == THERE else _time_of(draft, case)
    sentence = case.sentence(status, draft, t) if status else ""
    after = case.standing(draft, t)
    if not np.isfinite(after.states).all():
        status = status or int(Status.NOT_A_NUMBER)
        return now._replace(status=status, sentence=sentence or case.sentence(status, now.side, now.t), last=None)
    last, whole = Last(case, tuple(early), before, rows, after), case.whole(before, rows, draft) if record else rows
    if status == Status.LOST:
        last = last._replace(early=(*early, *case.events(before, rows, after), *case.lost(draft, t)), rows=rows[:0])
    if record and len(whole):
        kept = Kept(kept, case.changed(goal.inputs), whole)
    return goal._replace(t=t, standing=after, status=status, sentence=sentence, last=last, kept=kept)


def _time_of(side: Any, case: HeldCase) -> float:
    return side.time if case.period is None else side.periods * case.period + side.time


def put(numbers: dict[str, float], row: Array, case: HeldCase) -> None:
    """Write numbers that change alone into a row; a force that no kernel knows yet is zero."""
    for name, value in numbers.items():
        column = case.column(name)
        if column is not None:
            row[column] = value
