"""Kernels that run many cases in SIMD lanes: their text, and the arrays they work on.

A kernel's file is the step of `rosenbrock.py` or the series of `taylor.py`, whose lines become instructions on two vectors of eight
lanes in turn (two independent chains hide each other's latency; several contacts do that alone, one vector after the other), and what
else depends on the law. The driver (`driver.py`) calls it. The same lines for one lane, which also keeps the dense output, solve a
single case; the two give the same bits.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, TypeAlias

from stickslip.basics.contracts import Model
from stickslip.basics.interruption import is_stopped, look
from stickslip.basics.status import Status
from stickslip.engine import cache, driver, long_series, several_series, slaved_pieces, taylor
from stickslip.engine.kernel_text import FUNCTIONS, KernelSource
from stickslip.engine.kernels import columns
from stickslip.engine.kinds import known_kind
from stickslip.engine.law_checks import check_numbers
from stickslip.engine.lawtext import looks, prelude, work
from stickslip.engine.machine_code import Compiled
from stickslip.engine.observed import Observed, has_arms, lists_of, looked_at, signals_text
from stickslip.engine.remembered import Remembered
from stickslip.engine.rosenbrock_step import Step, write_step
from stickslip.engine.roundings import sizes_text
from stickslip.engine.several_series import SeveralSeries
from stickslip.engine.shared_arrays import Shared, address_of
from stickslip.engine.slaved import Series
from stickslip.engine.steptext import Layout, step_text
from stickslip.engine.tableaux import Tableau
from stickslip.engine.trace import System, label, trace
from stickslip.engine.unforeseen import hides, slopes
from stickslip.engine.values import needed_by
from stickslip.models.state_layout import BodyStates, ContactStates, ControllerStates, StateLayout
from stickslip.results.recurrence import KEPT, LONGEST

#: Rows of numbers in which a step is looked at: at its ends and at the nodes of a quadrature, somewhere else, the states there, which parts
#: of the step these are; then each state at all of them.
ROOM = 11
#: Of a kernel for many cases; and of a vector, which is one register or several in turn, as the processor has them.
LANES, WIDTH = 16, 8
#: Cases at work at a time where steps are of two sorts: more of them wait for lanes, so that these do not.
PLACES = 64
_REPEATS, _NOT_COMPUTED = int(Status.REPEATS), int(Status.NOT_COMPUTED)  # as numbers, which arrays take faster
#: Numbers of the layout that a law's own functions read.
_NAMED = ("DEGREE", "MASS", "F_C", "F_T", "F_T0", "F_HH", "F_K", "F_Y", "F_B", "F_MODE", "F_CLK")


#: What a step is made by; None: Taylor steps of set-valued laws.
AnySteps: TypeAlias = Tableau | Series | SeveralSeries | None


@dataclass(frozen=True)
class Kernel:
    """A compiled kernel and the shape of what it works on."""

    code: Compiled  # the law's functions: the driver knows them by their addresses only
    table: Any  # where the driver finds what (see driver.py)
    lanes: int
    fields: int
    states: int
    degree: int
    record: bool
    names: tuple[str, ...]
    modes: int  # memories of the laws, kept with each piece
    contacts: int  # or what else is kept with each piece
    owners: tuple[int | None, ...]  # of each coordinate, the contact whose slip its state is
    layout: StateLayout  # what its states are
    bodies: tuple[int, ...]  # of each body the coordinate with which it moves; none where no signals are noted
    signals: dict[str, int]  # what is noted of the last motion period, by name, and its number
    arms: bool  # whether a body moves otherwise than its coordinate
    held: int  # flags, modes and clocks that a step holds
    guards: tuple[int | None, ...]  # of each contact of a dynamic law the guard whose flag is the side of its slip
    flights: tuple[int, ...]  # of each contact the mode that is 1 in flight; -1 of one that does not fly
    shifting: frozenset[str]  # numbers that change what states are counted from: velocities that are taken off, or the period


@dataclass(frozen=True)
class Job:
    """The task for every case."""

    periods: int
    settle: int
    auto: bool
    rtol: float
    slip_ratio: float
    budget: float
    whole: bool = False  # make each period, also of a motion that has come back to the same bits


@dataclass(frozen=True)
class Parts:
    """Results of a kernel for each body, contact and stop: a row for each case."""

    moved: Any  # (cases, coordinates): displacement over the window [m]
    wide_max: Any  # (cases, bodies): extremes over the window
    wide_min: Any
    reduced: dict[str, Any]  # by signal (cases, 3) over the last motion period: integral over time, or a count; largest; smallest


@dataclass(frozen=True)
class Results:
    """Results of a kernel, one row for each case (see ``kernels/driving_lanes.py``, `finish`)."""

    displacement: Any  # over the window [m]
    window: Any  # [drive periods]
    v_max: Any
    v_min: Any
    end: Any  # (cases, 1 + states): x and the states at the end
    friction_power: Any  # mean over the last motion period [W]; NaN where it is not known
    status: Any
    period: Any
    periods_run: Any
    seg_count: Any
    seg_time: Any  # [s]
    seg_code: Any
    accepted: Any
    rejected: Any
    memory: Any  # (cases, modes): memories of the law at the end
    limit: Any  # displacement in a drive period that the motion approaches [m]; NaN of a case that ended before its time
    wide_max: Any  # extremes of v over the window
    wide_min: Any
    ended: Any  # how far into its period a case ended before its time [s], NaN of others; None where none did
    parts: Parts | None = None  # of a machine that lists its bodies
    pieces: Any = None  # (pieces, 4 + contacts + modes + states (degree + 1)) of a recorded case
    changed: Any = None  # (cases, 1 + contacts) of set-valued laws: changes of modes in the last steps, if they used up the budget
    strobes: Any = None  # (KEPT, 1 + states + …) of the last case of a kernel of one lane, where asked for: period n stands at n % KEPT


_kernels: Remembered[Kernel] = Remembered(most=cache.KEPT)
_layouts: Remembered[tuple[StateLayout, tuple[int, ...]]] = Remembered()


def kernel_of(
    model: Model, tableau: AnySteps, record: bool, observe: Observed = (), made: Callable[[System], System] | None = None,
    noted: bool = False,
) -> Kernel:  # fmt: skip
    """The compiled kernel of a model's kind, by Rosenbrock steps or (no tableau: set-valued laws) Taylor steps.

    With `made` it is that of what this function makes of the model's system, such as its `stickslip.engine.tangent.tangent`; with `noted`
    this system has signals, also of one body.

    A kind that was seen before costs nothing.

    The law of a new kind is called once with plain numbers, so that one that gives no numbers is said before compiling.
    """

    def system() -> System:
        traced = trace(model, observe, noted)
        return traced if made is None else replace(made(traced), signals=(), ratios=())  # nothing is noted of what is made of a system

    def compiled() -> Kernel:
        check_numbers(model)
        return kernel(system(), tableau, label(model) if made is None else f"{made.__name__.replace('_', ' ')} of {label(model)}", record)

    return _kernels((known_kind(model), tableau and tableau.name, record, observe, made, noted), compiled)


def kernel(eq: System, tableau: AnySteps, label: str, record: bool) -> Kernel:
    """The compiled kernel of a traced model: eight lanes twice, or one lane that keeps its dense output."""
    step = step_of(eq, tableau, record)
    method = "Taylor" if tableau is None else tableau.name
    lanes = 1 if record else LANES
    source = _source(eq, step, lanes)
    name = "single" if record else "lanes"
    code = cache.load(
        source, f"{name}_{plain_name(label)}_{method.lower()}", f"{label} ({method}, {'one case' if record else 'many cases'})"
    )
    return Kernel(
        code,
        driver.table(code, *layout(eq, step, lanes), lists_of(eq, watched(eq, step))),
        lanes,
        len(step.fields) + len(_constants(eq, step)),
        eq.states,
        step.degree,
        record,
        eq.names,
        eq.memories,
        eq.sides,
        tuple(next((i for i, c in enumerate(eq.contacts) if c.state == j), None) for j in range(eq.coordinates)),
        states_of(eq),
        tuple(j for _, j in eq.bodies) if eq.signals else (),
        {name: i for i, signal in enumerate(eq.signals) for name in signal.names},
        has_arms(eq),
        eq.signs + len(eq.modes) + len(eq.clocks),
        tuple(c.guard if c.branches is None else None for c in eq.contacts),
        tuple(-1 if c.flight is None else c.flight.mode for c in eq.contacts),
        frozenset(node.name for node in needed_by([*eq.offsets, eq.period]) if node.op == "case"),
    )


def step_of(eq: System, method: AnySteps, record: bool) -> Step:
    """The written step of a method."""
    if method is None:
        return (long_series if eq.graph.linear else taylor).write_step(eq)
    if isinstance(method, SeveralSeries):
        return several_series.write_step(eq, method, record)
    return slaved_pieces.write_step(eq, method, record) if isinstance(method, Series) else write_step(eq, method, record)


def ordered(k: Kernel, order: int) -> Kernel:
    """The kernel that goes through guards of one instant in their order (1), against it (-1), or as rounding has it (0)."""
    table = k.table.copy()
    table[driver.column("ORDERED")] = order
    return replace(k, table=table)


def layout_of(model: Model) -> StateLayout:
    """The layout of the states of a model's kernels; nothing is compiled, and a known kind costs nothing.

    Examples
    --------
    >>> from stickslip.machines import Chain
    >>> layout_of(Chain.example()).names
    ('v.module 1', 'v.module 2', 'l.module 2')
    """
    return _arranged(model)[0]


def needed_positions(model: Model) -> tuple[int, ...]:
    """Numbers of the coordinates whose positions (or differences to that of the first) stand in a force, a load or a guard."""
    return _arranged(model)[1]


def _arranged(model: Model) -> tuple[StateLayout, tuple[int, ...]]:
    return _layouts(known_kind(model), lambda: _arrangement(trace(model)))


def _arrangement(eq: System) -> tuple[StateLayout, tuple[int, ...]]:
    nodes, first = (*eq.f[: eq.positions.start], *eq.guards, *eq.sampled.values(), *eq.heights), int(eq.cyclic)
    varied = frozenset[str]().union(*map(eq.graph.varies, nodes))
    return states_of(eq), tuple(first + k for k, i in enumerate(eq.positions) if eq.y[i].name in varied)


def states_of(eq: System) -> StateLayout:
    """Which states are of which body and contact."""
    first = eq.positions.start - (1 if eq.cyclic else 0)  # of the positions, as if the first coordinate had one too
    places = [None if j == 0 and eq.cyclic else first + j for j in range(eq.coordinates)]
    way = 0 if eq.cyclic else None
    return StateLayout(
        bodies=tuple(BodyStates(name, j, way, position=places[j]) for name, j in eq.bodies),
        contacts=tuple(
            ContactStates(c.name, of, c.inner, c.modes if c.branches is None else ())
            for c, of in zip(eq.contacts, eq.slips_of, strict=True)
        ),
        controllers=tuple(ControllerStates(*each) for each in eq.controllers),
        ways=(0,) if eq.cyclic else (),
        single=eq.single,
        principal=eq.principal,
    )


def plain_name(label: str) -> str:
    """A label as a part of a file's name.

    Examples
    --------
    >>> plain_name("LuGre × Harmonic")
    'lugre_harmonic'
    """
    return re.sub(r"[^A-Za-z0-9]+", "_", label).strip("_").lower()


def _constants(eq: System, step: Step) -> list[Any]:
    """Expressions computed once for each case, in order: those of the step, then those of the driver."""
    scales = [s for s in (*eq.scales, *eq.lengths) if s is not None]
    instants = [*eq.instants, *(instant for instant, _ in eq.impulses)]
    own = [eq.period, eq.velocity_scale, eq.free_velocity, eq.mass]
    late = [*eq.delays, *(kick for kicks in eq.kicks for kick in kicks)]
    jumps = [jump for _, jumps in eq.impulses for jump in jumps]
    return [*step.case_nodes, *own, *scales, *eq.sampling, *eq.shares, *late, *instants, *jumps]


def layout(eq: System, step: Step, lanes: int) -> tuple[dict[str, int], tuple[int, ...]]:
    """The numbers by which the driver finds its way; a field that this kind of step has not is at -1.

    Then where each state's scale is, and the length after which it comes again.
    """
    offsets = {name: i * lanes for i, name in enumerate(step.fields)}
    first = len(step.case_nodes)
    scale_at = [-1] * (2 * eq.states)
    measures = (*enumerate(eq.scales), *enumerate(eq.lengths, start=eq.states))
    for number, i in enumerate(i for i, s in measures if s is not None):
        scale_at[i] = first + 4 + number
    constants = len(_constants(eq, step))
    sample_at = first + 4 + sum(at >= 0 for at in scale_at)
    breaks, share_at = len(eq.instants) + len(eq.impulses), sample_at + len(eq.sampling)
    named = {
        "LANES": lanes, "STATES": eq.states, "GUARDS": len(eq.guards), "SIGNS": eq.signs, "FIELDS": len(offsets) + constants,
        "CONSTANTS": constants, "DEGREE": step.degree, "PERIOD": first, "FREE": first + 2, "MASS": first + 3,
        "SET_VALUED": int(not eq.dynamic), "SERIES": int(not eq.stiff), "OFFERED": int(eq.offered is not None),
        "CYCLIC": int(eq.cyclic), "MODES": len(eq.modes),
        "KEPT_MODES": eq.memories, "CLOCKS": len(eq.clocks), "IMPULSES": len(eq.impulses), "BREAKS": breaks,
        "BREAK_AT": constants - len(eq.impulses) * eq.coordinates - breaks,
        "COORDINATES": eq.coordinates, "CONTACTS": eq.sides, "SHARES": len(eq.shares),
        "SHARE_AT": share_at, "PASSIVE": eq.passive, "CARRIED": len(eq.carried), "DELAY_AT": share_at + len(eq.shares), "ORDERED": 0,
        "WATCHED": _rows_of("g", offsets), "EXPONENTS": _rows_of("e", offsets),
        "SIGNALS": len(eq.signals), "RATIOS": len(eq.ratios), "BODIES": len(eq.bodies), "ARMS": int(has_arms(eq)),
        "LOOKED": len(looked_at(eq)), "SAMPLE_AT": sample_at if eq.sampling else -1,
        "PLACES": 1 + (eq.coordinates if eq.signals else 0),
        "LASTING": step.fields.index("soon") if "soon" in offsets else 0,
        "FLAGS": sum(f"b{k}" in offsets for k in range(len(eq.guards))),
        "F_C": len(offsets) * lanes, "F_Y": offsets["y0"], "F_SIGN": offsets["b0" if eq.dynamic else "mode0" if eq.modes else "y0"],
    }  # fmt: skip
    firsts = {
        "F_B": "b0", "F_ON": "on0", "F_M": "m1", "F_K": "k0_0", "F_MODE": "mode0", "F_CLK": "clk0", "F_G": "g0_0", "F_CLEAR": "clear0",
        "F_HELD": "side" if eq.labels else "held0", "F_ENDS": "ends0", "F_RATES": "rates0",
    }  # fmt: skip
    fields = {name: name.removeprefix("F_").lower() for name in driver.FIELDS} | firsts
    return {name: offsets.get(field, offsets.get(f"{field}_0", -1)) for name, field in fields.items()} | named, tuple(scale_at)


def watched(eq: System, step: Step) -> Sequence[int]:
    """The guards whose zeros a step finds, in its order."""
    return taylor.watched(eq) if step.series else range(len(eq.guards))


def _rows_of(letter: str, fields: Iterable[str]) -> int:
    """How many polynomials of a sort a lane holds."""
    return sum(re.fullmatch(rf"{letter}\d+_0", field) is not None for field in fields)


def _source(eq: System, step: Step, lanes: int) -> KernelSource:
    """The law's part of a kernel: the functions that the driver calls (`FUNCTIONS` in ``kernel_text.py``)."""
    width = min(lanes, WIDTH)
    group = width if step.by_vector or len(eq.contacts) > 1 else lanes  # several contacts hide each other's latency, in half the text
    functions, text = law_text(eq, step, lanes)
    lines = step_text(step, places(eq, step, lanes, group, width))
    return KernelSource(text, {name: FUNCTIONS[name] for name in (*functions, "step")}, lines)


def places(eq: System, step: Step, lanes: int, group: int, width: int) -> Layout:
    """Where a step's lines have what they read and write."""
    offsets = {name: i * lanes for i, name in enumerate(step.fields)}
    return Layout(lanes, group, width, offsets, layout(eq, step, lanes)[0]["F_C"])


def law_text(eq: System, step: Step, lanes: int) -> tuple[tuple[str, ...], str]:
    """The names of a law's own functions, and their text."""
    named, _ = layout(eq, step, lanes)
    functions = {"prelude": prelude(eq, _constants(eq, step)), "look": looks(eq)}
    if named["F_WORK"] < 0:
        functions["work"] = work(eq, step.degree)
    if not eq.stiff:
        functions["switched"] = taylor.switches(eq, step, lanes)
        functions["sizes"] = sizes_text(eq, step, lanes, [taylor.slips_of(eq, eq.guards[k]) for k in taylor.watched(eq)])
        functions |= {"slopes": slopes(eq, step, lanes)} if hides(eq) else {}
    if eq.signals:
        functions["signals"] = signals_text(eq, watched(eq, step))
    return tuple(functions), "\n".join([f"L = {lanes}", "", *(f"{name} = {named[name]}" for name in _NAMED), *functions.values()])


def _aligned(count: int) -> Any:
    """Ones in memory, of which no vector of eight lies across two lines of the cache."""
    import numpy as np

    room = np.ones(count + 7)
    first = -(address_of(room) // 8) % 8
    return room[first : first + count]


def bytes_of_piece(k: Kernel) -> int:
    """The size of a step's dense output: period, times, way, sides, memories, coefficients."""
    return 8 * (4 + k.contacts + k.modes + k.states * (k.degree + 1))


def _shapes(k: Kernel, cases: int, at_work: int, parts: int, signals: int, places: int) -> dict[str, tuple[int, ...]]:
    """The shapes of the arrays of a table of cases, of those that are at work, and of the room in which they look at a step."""
    n = k.states
    return {
        "JOB": (columns.WHOLE + 1,),
        "LIMITS": (columns.BUDGET_OF_STEPS + 1,),
        "PARAM": (cases, len(k.names)),
        "START": (cases, 1 + n + k.modes),
        "OUT": (cases, 9 + n + k.modes + places - 1),
        "COUNT": (cases, 5 + parts),
        "CHANGED": (cases if k.table[driver.column("SERIES")] else 0, 1 + k.contacts),
        "NOTED": (cases if signals else 0, signals + len(k.bodies), 3),
        "SEGT": (cases, parts * columns.SEGS),
        "SEGC": (cases, parts * columns.SEGS),
        "N": (at_work, columns.SEGMENTS + parts),
        "K": (at_work, columns.SINCE + 1),
        "RING": (at_work, KEPT, 1 + n + k.modes + columns.BESIDE),
        "XS": (at_work, LONGEST + 1, places),
        "HELD": (at_work, k.held),
        "FOUND": (at_work, signals + len(k.bodies), 3),
        "ROOM": (ROOM + n, max(n, parts + signals, 8)),
    }


def arrays_of(k: Kernel, params: Any, start: Any, job: Job, room: int, goal: int = 0) -> tuple[Any, Shared]:
    """What the lanes hold, and the arrays that a kernel shares with its driver, before the first case.

    There is room for so many steps of dense output, and for so many numbers that say where a held lane goes (see `held_lane.py`).
    """
    import numpy as np

    cases, signals = len(params), 1 + max(k.signals.values(), default=-1)
    parts, places = (k.contacts, 1 + len(k.owners)) if signals else (1, 1)
    pooled = k.table[driver.column("F_SOON")] >= 0 and cases > k.lanes
    at_work, before = (min(PLACES, cases), 8 * (max(PLACES, k.fields) // 8 + 1)) if pooled else (k.lanes, 0)
    pool = {"STORE": (at_work, k.fields), "POOL": (5, before)} if pooled else {}
    more = pool | ({"GOAL": (goal,)} if goal else {})
    shared = Shared(_shapes(k, cases, at_work, parts, signals, places) | more)
    shared["JOB"][:] = (0, cases, 0, job.periods, job.settle, job.auto, room > 0 or job.whole)
    shared["LIMITS"][:] = (job.rtol, job.slip_ratio, job.budget)
    shared["PARAM"][:] = params
    shared["START"][:, : start.shape[1]] = start
    shared["N"][:, columns.CASE] = -1
    shared["COUNT"][:, 0] = _NOT_COMPUTED
    shared["OUT"].fill(np.nan)
    shared["NOTED"].fill(np.nan)
    if room > 0:
        shared["PIECES"] = np.empty((room, bytes_of_piece(k) // 8))
    return _aligned(before + (k.fields + 2 * (len(k.bodies) + 2)) * k.lanes), shared


def _taken(shared: Shared) -> Any:
    """The dense output that a slice has written, whose room is free again."""
    written = shared["PIECES"][: shared["JOB"][columns.WRITTEN]].copy()
    shared["JOB"][columns.WRITTEN] = 0
    return written


def _results(k: Kernel, shared: Shared, written: list[Any] | None) -> Results:
    """The results in what a kernel has written."""
    import numpy as np

    out, count, noted, last = shared["OUT"], shared["COUNT"], shared["NOTED"], 6 + k.states + k.modes
    limit, ended = out[:, last], None
    if count[:, 0].max(initial=0) > _REPEATS:
        early = (count[:, 0] > _REPEATS) & (count[:, 0] != _NOT_COMPUTED)
        limit, ended = (np.where(early, np.nan, limit), np.where(early, limit, np.nan)) if early.any() else (limit, None)
    several = None
    if k.signals:
        wide_max, wide_min = noted[:, 1 + max(k.signals.values()) :, 1:].transpose(2, 0, 1)
        several = Parts(out[:, last + 3 :], wide_max, wide_min, {name: noted[:, i] for name, i in k.signals.items()})
    return Results(
        out[:, 0], out[:, 1], out[:, 2], out[:, 3], out[:, 5 : 6 + k.states], out[:, 4],
        count[:, 0], count[:, 1], count[:, 2], count[:, 5:], shared["SEGT"], shared["SEGC"], count[:, 3], count[:, 4],
        out[:, 6 + k.states : last], limit, out[:, last + 1], out[:, last + 2], ended,
        several, None if written is None else written[0] if len(written) == 1 else np.concatenate(written),
        shared["CHANGED"] if len(shared["CHANGED"]) else None,
    )  # fmt: skip


def run(
    k: Kernel,
    params: Any,
    start: Any,
    job: Job,
    progress: Callable[[int], None] | None = None,
    keep_pieces: bool = False,
    slice_calls: int = 0,
    partial: bool = False,
    keep_strobes: bool = False,
) -> Results:
    """Run all cases of a table, returning to Python after every slice, where an interruption ends it (see `stickslip.basics.interruption`).

    With `partial` what is done by then is returned: a case that has not ended has the status "not computed", and of a recorded one there
    are the steps until then. `progress` is called with the number of cases begun; of a recorded case with its drive periods.

    A start is a row of x, the states, and the memories of the law; a row without memories begins with zeros.
    Results do not depend on how cases are spread over lanes, slices, calls and threads.
    """
    S, shared = arrays_of(k, params, start, job, 8192 if keep_pieces else 0)
    advance = driver.load("advance_pooled" if "POOL" in shared else "advance")
    slice_calls = slice_calls or (8192 if k.lanes == 1 else 65536)  # about 2 and 30 milliseconds
    if not partial:
        look()
    written, todo = [], shared["JOB"]
    go_on = advance.on(S, slice_calls, address_of(shared.at), k.table)
    while go_on():
        if keep_pieces:
            written.append(_taken(shared))
        if progress is not None:
            progress(int(shared["N"][0, columns.DONE] if keep_pieces else todo[columns.NEXT]))
        if is_stopped():
            if not partial:
                look()
            break
    else:
        if progress is not None:
            progress(job.periods if keep_pieces else len(params))
    if keep_pieces:
        written.append(_taken(shared))
    results = _results(k, shared, written if keep_pieces else None)
    return replace(results, strobes=shared["RING"][0]) if keep_strobes else results


def joined(first: Results, second: Results, of_first: Any) -> Results:
    """The results of two kernels for cases of one table, in its order; `of_first` has which cases are the first's."""
    import numpy as np

    def merged(a: Any, b: Any) -> Any:
        if isinstance(a, dict):
            return {name: merged(a[name], b[name]) for name in a}
        if isinstance(a, Parts):
            return Parts(*(merged(getattr(a, each.name), getattr(b, each.name)) for each in fields(Parts)))
        if a is None and b is None:
            return None
        a, b = (np.full(int(which.sum()), np.nan) if x is None else x for x, which in ((a, of_first), (b, ~of_first)))
        whole = np.empty((len(of_first), *a.shape[1:]), a.dtype)
        whole[of_first], whole[~of_first] = a, b
        return whole

    return Results(*(merged(getattr(first, each.name), getattr(second, each.name)) for each in fields(Results)))
