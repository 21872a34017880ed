"""Switching flows on the compiled engine: one run with all that happened in it and how disturbances grow, or the ends of many."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stickslip.basics.contracts import Array, Numeric
from stickslip.basics.errors import SolveError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import look
from stickslip.basics.status import STATUS, Status
from stickslip.engine import lanes
from stickslip.engine.cyclic_equations import check_cyclic
from stickslip.engine.flow_as_written import check_flow_as_written, first_of
from stickslip.engine.flow_system import BEGIN, MOST, SIZE, FlowSystem, TracedFlow, flow_system
from stickslip.engine.iterated_maps import MapSteps
from stickslip.engine.kinds import Editions
from stickslip.engine.remembered import Remembered
from stickslip.engine.section import RETURNS, VALUE, passes_of, until_mode_change, until_section, weight_of
from stickslip.engine.symbolic import SPAN
from stickslip.engine.tableaux import RODAS5P as _STIFF
from stickslip.engine.tangent import tangent
from stickslip.models.flow_contacts import inner_scales
from stickslip.models.switching_flow import knows_mode
from stickslip.results.flow_pieces import ModeChange
from stickslip.results.recurrence import KEPT

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from stickslip.engine.system import System
    from stickslip.models.switching_flow import SwitchingFlow


MOST_SWITCHES = 10_000  # in one run, if it is not said
BUDGET = 200_000  # steps
_SHORTER = 5, 100  # so many more of steps that hold a tolerance: in a run that is kept, and in others
TOLERANCE = 1e-9  # of the Rosenbrock steps of flows whose contacts have inner states; Taylor steps have none
MOST_STRETCHES = KEPT - 1  # of which the states at the ends are known at a time
FIRST = 7  # where a step's polynomials begin, behind its times, its mode, and how many switches were before it
_KEPT = 64  # flows whose equations are kept
_SHARP = 1e13  # a disturbance that moves a switch by so much more than itself: what is only touched has no derivative
_systems: Remembered[FlowEquations] = Remembered(_KEPT)
_editions = Editions(_KEPT)
_maps: Remembered[MapSteps] = Remembered(_KEPT)
_kernels: Remembered[tuple[lanes.Kernel, tuple[str, ...]]] = Remembered(_KEPT)


@sealed
@dataclass(frozen=True, eq=False)
class FlowSolution:
    """The solution from one start: its steps, switches and end; `growth` is the derivative of the end by the start."""

    nodes: Array
    modes: Array  # of each step, by the place among the flow's modes
    coefficients: Array
    events: list[ModeChange]
    passed: Array  # states (switch, state) in which it is for an instant, between two switches
    state: Array
    mode: Any
    time: float
    growth: Any  # array, or None where it was not asked for
    rank_deficient: bool
    steps: int


@dataclass(frozen=True, eq=False)
class FlowEquations:
    """A flow of so many states as its functions are now."""

    system: FlowSystem | None
    why: str  # the engine cannot follow it: what one of its functions does that only plain numbers can do; "" if it can
    key: Any  # of what is cached about it


def unknown(flow: SwitchingFlow, n: int) -> str:
    """Why the engine cannot follow a flow of n states: what one of its functions does that only plain numbers can do; "" if it can."""
    return traced_flow(flow, n).why


def _parts(flow: SwitchingFlow, n: int) -> Any:
    """The parts of a flow that determine its equations: its functions, and the names of its numbers."""
    switches = tuple((mode, tuple(exits)) for mode, exits in flow.switches.items())
    return tuple(flow.fields.items()), switches, tuple(flow.contacts.items()), tuple(flow.numbers), tuple(flow.cyclic.items()), n


def check_flow(flow: SwitchingFlow, n: int) -> Any:
    """The key of what is cached about a flow of n states, after its functions were asked whether they have changed.

    Raises
    ------
    InputError
        For functions that give another value each time.
    """
    key = _parts(flow, n)
    _editions.check(key, lambda: first_of(flow, n))
    return (*key, _editions.of(key))


def traced_flow(flow: SwitchingFlow, n: int) -> FlowEquations:
    """The equations of a flow, or why there are none, after its functions were asked whether they have changed."""

    def traced() -> FlowEquations:
        try:
            system = flow_system(flow, n)
        except Exception as error:  # whatever a user's function raises when it is given symbols: on plain numbers it may be right
            check_cyclic(flow, n)
            return FlowEquations(None, str(error) or type(error).__name__, key)
        check_flow_as_written(flow, n)
        check_cyclic(flow, n, TracedFlow(flow, n) if flow.cyclic else None)
        return FlowEquations(system, "", key)

    key = check_flow(flow, n)
    return _systems(key, traced)


def flow_kernel(
    traced: FlowEquations, record: bool, made: Callable[[System], System] | None = None
) -> tuple[FlowSystem, lanes.Kernel, tuple[str, ...]]:
    """The equations, the kernel and the names of its columns; of one run with the change of its state along a direction.

    `made` makes another system of the equations, such as one that ends on a section.
    """
    equations = traced.system
    if equations is None:
        raise SolveError(traced.why)

    def compiled() -> tuple[lanes.Kernel, tuple[str, ...]]:
        system = equations.system if made is None else made(equations.system)
        system = tangent(system, ()) if record else system
        return lanes.ordered(lanes.kernel(system, _STIFF if system.tolerant else None, "SwitchingFlow", record), 1), system.names

    return equations, *_kernels((traced.key, record, made), compiled)


def steps_of_flow(flow: SwitchingFlow) -> tuple[str, float]:
    """The name of the steps that follow a flow, and their tolerance, 0 where they are exact to rounding."""
    return (_STIFF.name, TOLERANCE) if flow.inner else ("exact", 0.0)


def budget_of_flow(flow: SwitchingFlow, kept: bool = False) -> float:
    """Steps that a run may take, fewer where its dense output is kept."""
    return float(BUDGET * (_SHORTER[not kept] if flow.inner else 1))


def number_of_mode(flow: SwitchingFlow, mode: Any) -> int:
    """The number by which the engine knows a mode; one below zero of a mode of the fields, if contacts do there what the state says."""
    return 1 + flow.modes.index(mode) if knows_mode(flow.labels, mode) else -1 - list(flow.fields).index(mode)


def flow_row(
    flow: SwitchingFlow, equations: FlowSystem, names: tuple[str, ...], y: Array, span: Numeric, begin: float, most: float | None,
    more: Mapping[str, Any] | None = None,
) -> Array:  # fmt: skip
    """Numbers of the case in the order of its kernel, for each start (cases, columns)."""
    cases, size = len(y), np.max(abs(y), axis=1, initial=0.0)
    size = np.where(size > 0.0, size, 1.0)
    known: dict[str, Any] = {**equations.constants, **flow.numbers, BEGIN: begin, MOST: MOST_SWITCHES if most is None else most, SPAN: span}
    least = np.repeat(1e-3 * size[:, None], y.shape[1], axis=1)
    if flow.inner:  # of what laws say how large it is
        least[:, -len(flow.inner) :] = inner_scales(flow.contacts, y[0, : -len(flow.inner)].tolist(), *flow.given_once)
    known |= {f"{SIZE}{i}": column for i, column in enumerate(np.maximum(abs(y), least).T)}
    known |= more or {}
    rows = np.empty((cases, len(names)))
    for column, name in enumerate(names):
        rows[:, column] = known[name]
    return rows


class FlowStart(NamedTuple):
    """Where a flow begins: state, mode and time.

    Of a flow with contacts the mode may also be one of its fields, in which the contacts do what the state says.
    """

    y: Array
    mode: Any
    t: float = 0.0


def follow_flow(
    flow: SwitchingFlow,
    start: FlowStart,
    duration: float,
    most: int | None = None,
    growth: bool = True,
    partial: bool = False,
    traced: FlowEquations | None = None,
) -> FlowSolution:
    """Follow a flow from one start.

    Parameters
    ----------
    flow : SwitchingFlow
        Of single numbers.
    start : FlowStart
    duration : float
        How long.
    most : int, optional
        It ends after so many switches.
    growth : bool
        Whether the derivative of the end by the start is asked for.
    partial : bool
        Whether an interruption ends it with the steps until then (without growth).
    traced : FlowEquations, optional
        Its equations, where its functions have been asked already whether they have changed.

    Raises
    ------
    SolveError
        Where it cannot be followed, and why.
    """
    (y, mode, begin), labels = start, list(flow.modes)
    n = len(y)
    equations, kernel, names = flow_kernel(traced or traced_flow(flow, n), record=True)
    row = flow_row(flow, equations, names, y[None, :], duration, begin, most)
    results = []
    moved = np.concatenate([np.ones(n - len(flow.inner)), ~flow.memories])  # what a law remembers is whole: nothing moves it a little
    for direction in np.diag(moved) if growth else np.zeros((1, n)):
        first = np.concatenate([[0.0], y, direction, [0.0, number_of_mode(flow, mode)]])
        job = lanes.Job(1, 0, False, TOLERANCE, 0.75, budget_of_flow(flow, kept=True))
        results.append(lanes.run(kernel, row, first[None, :], job, keep_pieces=True, partial=partial))
        _check(flow, results[-1], begin, n, most)
    whole, early = results[0], int(results[0].status[0]) in (Status.SWITCHES, Status.NOT_COMPUTED)
    steps = _steps(whole)
    end, last = whole.end[0, 1 : 1 + n], whole.memory[0, 0]
    if whole.status[0] == Status.NOT_COMPUTED:  # its last step is that in which it was interrupted
        if len(steps) < 2:
            look()
        end, last = steps[-1, FIRST:].reshape(kernel.states, -1)[:n, 0], steps[-1, 4]
        steps = steps[:-1]
    last = round(float(last))
    sides = _sides(whole, steps)
    where = _last_before_switches(sides)
    modes = [labels[int(number) - 1] for number in sides[:, 0].tolist()]
    events = [ModeChange(begin + float(steps[k, 2]), modes[k], modes[k + 1]) for k in where]
    lasts = steps[:, 2] > steps[:, 1]
    long, passed = steps[lasts], steps[~lasts, FIRST:].reshape(-1, kernel.states, kernel.degree + 1)[:, :n, 0]
    nodes = begin + np.concatenate([steps[:1, 1], long[:, 2]])
    nodes[-1] = nodes[-1] if early else begin + duration
    M, rank_deficient = _growth(results, n, kernel.states) if growth else (None, False)
    coefficients = long[:, FIRST:].reshape(len(long), kernel.states, kernel.degree + 1)[:, :n]
    state = end + 0.0  # no negative zero
    return FlowSolution(
        nodes, long[:, 4].astype(int) - 1, coefficients, events, passed, state, labels[last - 1], float(nodes[-1]), M, rank_deficient,
        int(whole.accepted[0]),
    )  # fmt: skip


def is_smooth(flow: SwitchingFlow, n: int) -> bool:
    """Whether the engine follows a flow of n states in which nothing switches, and which begins anew with each period if it has one."""
    traced = traced_flow(flow, n)
    if traced.system is None or flow.contacts or any(flow.switches.values()):
        return False
    eq = traced.system.system
    return not eq.signs and not eq.clocks and (flow.period is not None or not any("t" in eq.graph.varies(f) for f in eq.f))


def derivatives_along(
    flow: SwitchingFlow, y: Array, mode: Any, every: float, count: int, growth: bool = True
) -> tuple[Array, Array] | None:
    """The states (count, n) of a smooth flow after each of some stretches of time, and how each depends on the one before (count, n, n).

    The motion is followed once; then the changes of its states in all stretches go side by side.

    Parameters
    ----------
    every : float
        How long a stretch is; a period, of a flow that has one.
    count : int
        How many there are, at most `MOST_STRETCHES`.
    growth : bool
        Whether the derivatives are asked for; else there are none.

    Returns
    -------
    tuple of array
        Or None where it could not be followed to the end.
    """
    n = len(y)
    equations, kernel, names = flow_kernel(traced_flow(flow, n), record=True)
    number, none = number_of_mode(flow, mode), np.zeros((1, n))
    first = np.concatenate([[0.0], y, none[0], [0.0, number]])
    budget = budget_of_flow(flow)
    row = flow_row(flow, equations, names, y[None], every, 0.0, None)
    job = lanes.Job(count, 0, False, TOLERANCE, 0.75, budget, whole=True)
    whole = lanes.run(kernel, row, first[None], job, keep_strobes=True)
    ends = whole.strobes[1 : count + 1, 1 : 1 + n]
    if whole.status[0] > Status.REPEATS or not np.isfinite(ends).all():
        return None
    if not growth:
        return ends, np.empty((0, n, n))
    starts = np.concatenate([y[None], ends[:-1]])
    rows = np.repeat(flow_row(flow, equations, names, starts, every, 0.0, None), n, axis=0)
    late = np.tile([0.0, number], (count * n, 1))
    begun = np.column_stack([np.zeros(count * n), np.repeat(starts, n, axis=0), np.tile(np.eye(n), (count, 1)), late])
    results = lanes.run(kernel, rows, begun, lanes.Job(1, 0, False, TOLERANCE, 0.75, budget))
    changes = results.end[:, 1 + n : 1 + 2 * n].reshape(count, n, n).transpose(0, 2, 1)
    return (ends, changes) if np.isfinite(changes).all() and results.status.max() <= Status.REPEATS else None


def _growth(results: list[Any], n: int, states: int) -> tuple[Array, bool]:
    """The derivative of the end by the start, nan where a switch was only touched; and whether one wiped out a direction.

    Each result holds the change of the state along a direction of its own, and that of the last switch. Their steps may differ.
    """
    M = np.array([result.end[0, 1 + n : 1 + 2 * n] for result in results]).T
    passed = [_switches(result, n, states) for result in results]
    rank_deficient, touched = False, not np.isfinite(M).all() or len({len(each) for each in passed}) > 1
    for each in zip(*passed, strict=False):
        before, after, rates = (np.array(part) for part in zip(*each, strict=True))
        rank_deficient = rank_deficient or bool((after[:, :n] == 0.0).all(axis=0).any())
        if np.isfinite(after).all():
            touched = touched or bool(abs(after[:, n]).max() * abs(rates).max() > _SHARP * abs(before).max())
    return np.full((n, n), np.nan) if touched else M + 0.0, rank_deficient


def _switches(result: Any, n: int, states: int) -> list[tuple[Array, Array, Array]]:
    """At each switch the change of the state before it, that after it with the change of its time, and the rates before it."""
    steps = _steps(result)
    c, switches = result.pieces[:, FIRST:].reshape(len(result.pieces), states, -1), []
    for k in _last_before_switches(_sides(result, steps)):
        after = c[k + 1, n : 2 * n + 1, 0] if k + 1 < len(c) else result.end[0, 1 + n : 2 + 2 * n]
        h = steps[k, 2] - steps[k, 1]
        rates = (c[k, :n] * np.arange(c.shape[-1])).sum(axis=-1) / h if h > 0.0 else np.zeros(n)
        switches.append((c[k, n : 2 * n].sum(axis=-1), after, rates))
    return switches


def _steps(result: Any) -> Array:
    """The steps of a result, without what a lane does after its end."""
    return result.pieces[result.pieces[:, 0] < 1]


def _sides(result: Any, steps: Array) -> Array:
    """Number of the mode and count of switches of each step, and after the last."""
    early = int(result.status[0]) == Status.SWITCHES
    beyond = result.pieces[len(steps) : len(steps) + 1, 4:6]
    after = beyond if len(beyond) else [[round(float(result.memory[0, 0])), steps[-1, 5] + early]]
    return np.concatenate([steps[:, 4:6], after])


def _last_before_switches(sides: Array) -> Array:
    """The steps after which there is one switch more than before."""
    return np.flatnonzero(sides[1:, 1] > sides[:-1, 1])


def ends(flow: SwitchingFlow, states: Array, modes: Array, duration: Numeric, begin: float = 0.0) -> tuple[Array, Array, Array]:
    """The states and the modes (by place) of many starts after some time, side by side, and how each ended.

    Parameters
    ----------
    flow : SwitchingFlow
        Its numbers single, or an array with one for each start.
    states : array (cases, n)
    modes : array (cases,) of int
        By the place among the flow's modes; -1, -2 and so on stand for the modes of its fields, in which contacts do what the state says.
    duration : float or array (cases,)
        How long each is followed.
    """
    n = states.shape[1]
    traced = traced_flow(flow, n)
    if flow.map is not None and (count := _iterations(duration)) is not None and begin == 0.0 and not np.any(modes):
        return _iterated(map_steps(flow, n, traced), flow, states, count)
    equations, kernel, names = flow_kernel(traced, record=False)
    rows = flow_row(flow, equations, names, states, duration, begin, None)
    start = np.column_stack([np.zeros(len(states)), states, np.where(modes < 0, modes, 1.0 + modes)])
    result = lanes.run(kernel, np.ascontiguousarray(rows), start, lanes.Job(1, 0, False, TOLERANCE, 0.75, budget_of_flow(flow)))
    status = np.where(np.isfinite(result.end[:, 1:]).all(axis=1), result.status, np.maximum(result.status, Status.NOT_A_NUMBER))
    good = status <= Status.REPEATS
    y = np.where(good[:, None], result.end[:, 1:], np.nan)
    return y, np.where(good, np.round(np.nan_to_num(result.memory[:, 0])) - 1, -1).astype(int), status


def map_steps(flow: SwitchingFlow, n: int, traced: FlowEquations | None = None) -> MapSteps:
    """The compiled map of a flow of n states that was made of one, and that the engine can follow."""
    return _maps((traced or traced_flow(flow, n)).key, lambda: MapSteps(flow, n))


def _iterations(duration: Numeric) -> int | None:
    """How often a map is iterated in a time that is a whole number of periods of 1 and the same for all; None of another time."""
    times = np.ravel(np.asarray(duration, float))
    return int(times[0]) if times[0] >= 0.0 and times[0].is_integer() and (times == times[0]).all() else None


def _iterated(steps: MapSteps, flow: SwitchingFlow, states: Array, count: int) -> tuple[Array, Array, Array]:
    """The ends of many starts after so many iterations, in the mode in which they began."""
    y = steps.after(steps.row(flow.numbers, len(states)), states, count)
    good = np.asarray(np.isfinite(y).all(axis=1))
    status = np.where(good, int(Status.FINISHED), int(Status.NOT_A_NUMBER))
    return np.where(good[:, None], y, np.nan) + 0.0, np.where(good, 0, -1), status


@sealed
@dataclass(frozen=True, eq=False)
class FlowReturns:
    """Where many starts are after some returns to a section (NaN, and the mode -1, where they could not be followed), and how long it took.

    A start that does not come back in time is where it is then, with the status "finished", as those that do.
    """

    states: Array
    modes: Array
    status: Array
    duration: Array


def passing_a_value(which: int, direction: float, value: Array, states: int) -> tuple[Any, dict[str, Any]]:
    """What makes a flow end where a state, of so many, passes a value, rising (1) or falling (-1), and the numbers of the cases."""
    return until_section, {weight_of(i): direction if i == which else 0.0 for i in range(states)} | {VALUE: direction * value}


def switching(passed: tuple[list[bool], list[bool]]) -> tuple[Any, dict[str, Any]]:
    """What makes a flow end where it switches from some of its modes to some others, and the numbers of the cases."""
    numbers = {passes_of(k, which): float(counts) for which, of in zip(("from", "to"), passed, strict=True) for k, counts in enumerate(of)}
    return until_mode_change(len(passed[0])), numbers


def returned(
    flow: SwitchingFlow, states: Array, modes: Array, section: tuple[Any, dict[str, Any]], returns: int, longest: Array
) -> FlowReturns:
    """The states and modes of many starts after some returns to a section, side by side.

    Parameters
    ----------
    flow, states, modes
        As for `ends`.
    section : (callable, dict)
        As `passing_a_value` or `switching` has it.
    returns : int
        How often.
    longest : array (cases,)
        How long each is followed if it does not come back.
    """
    n, (made, numbers) = states.shape[1], section
    equations, kernel, names = flow_kernel(traced_flow(flow, n), False, made)
    rows = flow_row(flow, equations, names, states, longest, 0.0, MOST_SWITCHES * returns, numbers | {RETURNS: float(returns)})
    start = np.column_stack([np.zeros(len(states)), states, np.where(modes < 0, modes, 1.0 + modes)])
    result = lanes.run(kernel, np.ascontiguousarray(rows), start, lanes.Job(1, 0, False, TOLERANCE, 0.75, budget_of_flow(flow) * returns))
    back = result.status == Status.RETURNED
    status = np.where(back, int(Status.FINISHED), result.status)
    status = np.where(np.isfinite(result.end[:, 1:]).all(axis=1), status, np.maximum(status, Status.NOT_A_NUMBER))
    good = status <= Status.REPEATS
    took = np.where(back, np.nan if result.ended is None else result.ended, longest)
    last = np.where(good, np.round(np.nan_to_num(result.memory[:, 0])) - 1, -1).astype(int)
    return FlowReturns(np.where(good[:, None], result.end[:, 1:], np.nan), last, status, took)


def _check(flow: SwitchingFlow, result: Any, begin: float, n: int, most: int | None) -> None:
    """`SolveError` where a run ended before its time."""
    status, rows = int(result.status[0]), result.pieces
    width = (rows.shape[1] - FIRST) // (2 * n + 1)
    lost = np.flatnonzero(~np.isfinite(rows[:, FIRST : FIRST + n * width]).all(axis=1))
    if status <= Status.REPEATS and len(lost):
        rows, status = rows[: lost[0]], Status.NOT_A_NUMBER
    if status in (Status.FINISHED, Status.REPEATS, Status.NOT_COMPUTED) or (status == Status.SWITCHES and most is not None):
        return
    t = begin + (float(rows[-1, 2]) if len(rows) else 0.0)
    names, last = [repr(mode) for mode in flow.modes], round(float(result.memory[0, 0]))
    if status in (Status.SWITCHES, Status.CHATTERS):
        visited = [names[int(number) - 1] for number in [*rows[-3:, 4], last]]
        raise SolveError(accumulates(t, visited, None if status == Status.CHATTERS else MOST_SWITCHES), status)
    end = result.end[0, 1 : 1 + n].tolist()
    mistake = f"the flow could not be followed in mode {names[last - 1]} beyond t = {t:.9g}: {STATUS[status]}; the state was {end}"
    raise SolveError(mistake, status)


def accumulates(t: float, modes: list[str], most: int | None) -> str:
    """That switches do not end."""
    what = (
        "the flow chatters, which needs a mode that slides along the guard, or it comes to rest in ever shorter jumps (Zeno), which needs "
        "a mode of rest and a guard that leads there"
    )
    how = f"switches accumulate at t = {t:.9g} (modes {' -> '.join(modes)})"
    if most is None:
        return f"{how}: {what}"
    return f"{how}: {most} until then; {what}; if they are meant, say how many: switches={10 * most}"
