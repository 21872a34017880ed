"""The section on which the motions of a model without a period are looked at: as `section=` says, or as a run shows it."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.analysis.section_choice import Asked, Cut, asked_for, cut_of, passages, states_in
from stickslip.basics.batch import cases_of
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, Problems, StickslipError
from stickslip.basics.frozen_arrays import sealed
from stickslip.dynamics.stroboscopic.return_maps import ReturnSection
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, flow_map, state_at_rest
from stickslip.models.model_adapter import adapter_of
from stickslip.solvers.plain.composed_flows import composed, mode_of_strobe_state

LONGEST_RETURN = 60.0  # times the model's own time: how long a return may take before it is one that does not come back
LONGEST_CYCLE = 16  # turns after which a cycle may repeat
_ALIKE, _SAME = 10.0, 1e-9  # times the nearest, and in scales: a return that comes as near as that
_SOME = 24  # of the starts that are given: those whose motions share a section
_TRIED = 8  # starts from which a run may show an oscillation, and as many that are scattered about rest
_STILL = 1e-6  # of the scales: what moves by less in the second half of a run has come to rest
_LASTING = 0.9  # of the swing in the third quarter of a run: a swing in the last that does not die out
_ENOUGH = 5  # passages in the second half of a run that show how long returns take
_FIRST, _DOUBLED = 32.0, 13  # times the time in which a flow first moves by its scales: how long its run is, and how often it is doubled
_LOOKS = 240  # instants at which a batch is looked at, in the second half of a run, for the middle of a range


def on_section(
    model: Model, at: Coordinates | None = None, *, section: Any = None, turns: int = 1, states: Any = None, groups: Any = None,
    what: str = "section",
) -> Coordinates:  # fmt: skip
    """The coordinates of a model, and, where it has no period, the section on which its motions are looked at.

    Which it is says `stickslip.analysis.section_choice`, from the run of the first start that oscillates; of a batch its value is in the
    middle of the range of each case. A motion that does not come back within sixty of the machine's own times, or of the returns of
    that run, has not come back.

    Parameters
    ----------
    model : Robot, machine or SwitchingFlow
        One, or a batch of them.
    section : str or tuple, optional
        Another section: the name of a state, alone or with the value that it passes and the direction (1 or -1); or a switch: of a contact
        that rests exactly where it sticks or slips, such as "stick of block", of a flow from a mode to another, such as "free to hunted".
    turns : int
        After how many returns the map looks again.
    states : array (starts, coordinates), optional
        Starts from which a run may show where to look; rest if not given.
    groups : array (cases,), optional
        Of a batch, which cases are one model: each begins at its own start then, and the motions of one group share their section.
    what : str
        Who asks, for messages.

    Examples
    --------
    >>> import stickslip as ss
    >>> at = on_section(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)))
    >>> at.section.name, float(at.section.value), at.section.direction
    ('v', 0.0, -1.0)
    """
    at = coordinates(model) if at is None else at
    check_section(what, model, section, turns)
    if model.period is not None:
        return at
    asked, one = asked_for(what, section, model), cases_of(model)[0]
    begun: Any = None
    values: Any
    if asked.switch:
        shown = shown_by_a_run(one, at, Asked(), states)
        time = at.time_of(model)
        longest = _longest_of_switches(shown, asked) if time is None else LONGEST_RETURN * np.asarray(time, float)
        begun = shown.begun if shown.oscillates else None
        return replace(at, section=ReturnSection(str(asked.name), -1, np.nan, 1.0, longest, int(turns), begun))
    if turning := _where_the_spring_turns(model, asked):
        cut, longest, values = *turning, turning[0].value
    else:
        shown = shown_by_a_run(one, at, asked, states)
        cut, longest, lasting, begun = shown.cut, shown.longest, shown.span, shown.begun if shown.oscillates else None
        if states is not None and groups is None and shown.oscillates and asked.value is None:
            cut, longest = _passed_by_all(one, at, asked, shown, _some(states))
        many = len(cases_of(model)) > 1 and asked.value is None
        values = _middles(model, at, cut, lasting, *_begun(model, states, groups, shown)) if many else cut.value
    index = at.names.index(cut.name)
    return replace(at, section=ReturnSection(cut.name, index, values, cut.direction, longest, int(turns), begun))


def _longest_of_switches(shown: Shown, asked: Asked) -> float:
    """The longest time of a return to a switch of a flow: of the returns of its run, and of what comes between its switches there."""
    return max(shown.longest, LONGEST_RETURN * float(np.diff(shown.run._switch_times(str(asked.name))).max(initial=0.0)))


def check_section(what: str, model: Any, section: Any, turns: Any) -> None:
    """`InputError` where a section or turns are given for a model with a period, or turns that are no number of returns."""
    if model.period is None:
        problems = Problems(what)
        problems.whole("turns", 1 if turns is None else turns, 1, example=1)
        problems.check()
    elif section is not None or turns not in (None, 1):
        given = "section" if section is not None else "turns"
        allowed = "allowed is a machine or flow without a period; its motions are looked at once in each drive period"
        raise InputError(what, [f"{given} is given, and the model has a period; {allowed}; leave {given} out"])


def _begun(model: Any, states: Any, groups: Any, shown: Shown) -> tuple[Array, Array]:
    """Where the cases of a batch begin, and which of them are one model."""
    cases = len(cases_of(model))
    return (np.tile(shown.begun, (cases, 1)), np.arange(cases)) if groups is None else (states, np.asarray(groups))


def _where_the_spring_turns(model: Any, asked: Asked) -> tuple[Cut, Any] | None:
    """Of one body on a spring its turning point, with the longest return; None of anything else, or where something else is asked for."""
    far = adapter_of(model).turning_velocity
    if far is None or asked.value is not None or asked.name not in (None, "v"):
        return None
    return Cut("v", np.asarray(far, float), -1.0), LONGEST_RETURN * np.asarray(adapter_of(model).time_scale, float)  # type: ignore[arg-type]


@sealed
class Shown:
    """What the run of a start shows: the section, the longest time of a return, how long the run was, and whether it oscillates.

    `begun` and `end` are the states at its start and its end.
    """

    cut: Cut
    longest: float
    span: float
    oscillates: bool
    run: Any
    begun: Array
    end: Array


def shown_by_a_run(model: Any, at: Coordinates, asked: Asked, states: Any = None, only: bool = False) -> Shown:
    """What the run of the first start shows that oscillates; where none does, that of the first that there is: all its states stand still.

    With `only` no other starts are tried than those that are given.
    """
    first: Shown | None = None
    why: list[str] = []
    for state in np.atleast_2d(states) if only else _tried(model, at, states):
        try:
            shown = _shown(model, at, asked, state)
        except StickslipError as error:
            why.append(error.problems[0] if isinstance(error, InputError) else str(error))
            continue
        if shown.oscillates:
            return shown
        first = shown if first is None else first
    if first is None:
        raise InputError(
            type(model).__name__,
            ["it has no period, and no run from the starts, or from rest, could be followed that would show a section on which to look at "
             f"its motions; the first: {why[0]}"],
        )  # fmt: skip
    return first


def _tried(model: Any, at: Coordinates, states: Any) -> Array:
    """Starts whose runs may show an oscillation: some of those that are given, rest, and some about it."""
    from scipy.stats import qmc

    rest = state_at_rest(model, at)[:1]
    given = rest if states is None else np.atleast_2d(np.asarray(states, float))
    some = _some(given)
    spread, about = qmc.Halton(at.smooth, scramble=False).fast_forward(1).random(_TRIED), np.tile(rest, (_TRIED, 1))
    about[:, : at.smooth] += 2.0 * (2.0 * spread - 1.0) * at.scales[: at.smooth]
    return np.vstack([some, rest, about])


def _some(states: Any) -> Array:
    """Some of many starts, evenly."""
    states = np.atleast_2d(np.asarray(states, float))
    return np.asarray(states[np.unique(np.linspace(0, len(states) - 1, _SOME).round().astype(int))])


def _passed_by_all(model: Any, at: Coordinates, asked: Asked, first: Shown, states: Array) -> tuple[Cut, float]:
    """A section that the motions of all of some starts pass that oscillate, and the longest time of a return; else that of the first."""
    shown = [first]
    for state in states:
        with suppress(StickslipError):
            other = _shown(model, at, asked, state)
            shown += [other] if other.oscillates else []
    lates = [_late(each.run) for each in shown]
    names = (first.cut.name,) if asked.name is not None else (first.cut.name, *(name for name in lates[0] if name != first.cut.name))
    for name in names:
        low, high = max(late[name].min() for late in lates), min(late[name].max() for late in lates)
        if high - low > _STILL * at.scales[at.names.index(name)]:
            middle = first.cut.value if name == first.cut.name and low == lates[0][name].min() and high == lates[0][name].max() else None
            middle = float(0.5 * (low + high)) if middle is None else middle
            return cut_of(first.run, Asked(name, middle, asked.direction)), max(each.longest for each in shown)
    return first.cut, first.longest


def _shown(model: Any, at: Coordinates, asked: Asked, state: Array) -> Shown:
    """What the run of one start shows."""
    time = at.time_of(model)
    span = _FIRST * _begins_in(model, at, state) if time is None else LONGEST_RETURN * float(np.max(time))
    for k in range(_DOUBLED + 1):
        run = _run_of(model, at, state, span)
        cut = cut_of(run, asked)
        if time is not None:
            return Shown(cut, span, span, _moves(run, at, cut), run, state, at.last(run))
        t = passages(run, cut)
        late = t[t >= 0.5 * span]
        if len(late) >= _ENOUGH and _moves(run, at, cut):
            return Shown(cut, LONGEST_RETURN * float(np.diff(late).max()), span, True, run, state, at.last(run))
        if k == _DOUBLED or _rests(run, at):
            break
        span *= 2.0
    return Shown(cut, span, span, False, run, state, at.last(run))


def _run_of(model: Any, at: Coordinates, state: Array, duration: float) -> Any:
    """The run of a start."""
    from stickslip.solvers import solve

    return solve(model, duration=duration, keep="trajectory", **at.begun(model, state))


def _late(run: Any) -> dict[str, Array]:
    """The states in the second half of a run."""
    t = np.unique(run.t)
    return states_in(run, t[t >= 0.5 * (t[0] + t[-1])])


def _rests(run: Any, at: Coordinates) -> bool:
    """Whether no state moves in the second half of a run, but for rounding."""
    return all(np.ptp(column) <= _STILL * at.scales[at.names.index(name)] for name, column in _late(run).items())


def _moves(run: Any, at: Coordinates, cut: Cut) -> bool:
    """Whether the coordinate of a section still passes it in the second half of a run, by more than rounding, and does not die out."""
    column = _late(run)[cut.name]
    early, last = (np.ptp(part) for part in np.split(column, [len(column) // 2]))
    moves = last > _LASTING * early and last > _STILL * at.scales[at.names.index(cut.name)]
    return bool(moves and column.min() < cut.value < column.max())


def _begins_in(flow: Any, at: Coordinates, state: Array) -> float:
    """The time in which a flow first moves by the scale of one of its states; 1 where it stands still."""
    field = composed(flow).fields[mode_of_strobe_state(flow, state)]
    rates = abs(np.array(field(0.0, list(state[:-1])), float)) / (at.scales[: at.smooth] + abs(state[:-1]))
    return float(1.0 / rates.max()) if np.isfinite(rates).all() and rates.max() > 0.0 else 1.0


def _middles(model: Model, at: Coordinates, cut: Cut, span: float, begun: Array, groups: Array) -> Array:
    """The middle of the range that all moving cases of a group pass late in their runs; that of the first run where none is."""
    index = at.names.index(cut.name)
    states = flow_map(model, begun, 0.5 * span).state
    low, high = states[:, index], states[:, index]
    for _ in range(_LOOKS):
        states = flow_map(model, states, 0.5 * span / _LOOKS).state
        low, high = np.fmin(low, states[:, index]), np.fmax(high, states[:, index])
    moves, values = high - low > _STILL * at.scales[index], np.full(len(begun), cut.value)
    for group in np.unique(groups[moves]):
        own = np.flatnonzero(moves & (groups == group))
        shared = float(low[own].max()), float(high[own].min())
        values[groups == group] = np.mean(shared if shared[1] > shared[0] else (low[own[0]], high[own[0]]))
    return values


def turns_shown(at: Coordinates, points: Array) -> int:
    """After how many turns the last of some points on a section comes back most nearly; of several alike the fewest."""
    most = min(LONGEST_CYCLE, len(points) - 1)
    misses = np.array([float(at.distance(points[-1], points[-1 - p])) for p in range(1, most + 1)])
    return 1 + int(np.argmax(misses <= _ALIKE * misses.min() + _SAME))
