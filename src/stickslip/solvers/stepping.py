"""From a request to the engine's lanes and back: rows, starts, chunks and threads, and the dense output of a single case."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from stickslip.basics.contracts import Model, Numeric
from stickslip.basics.errors import SolveError
from stickslip.basics.pool import handed_out
from stickslip.basics.status import ENDS, Status
from stickslip.engine import lanes, law_checks as checks
from stickslip.engine.kernels.columns import SEGS as SEGMENTS
from stickslip.models.machine_adapter import MachineAdapter, machine_of
from stickslip.models.state_layout import StateLayout
from stickslip.results.dense_output import PolynomialPieces
from stickslip.results.summary import Summary
from stickslip.results.trajectory import Trajectory
from stickslip.solvers import stopped
from stickslip.solvers.gather import RawResults, gather, trajectory
from stickslip.solvers.lane_tables import CaseTable
from stickslip.solvers.part_results import RawParts
from stickslip.solvers.settings import Request
from stickslip.solvers.time_dependence import check_period

#: Steps that a case may take: for each period it should run, and in all where there is no period.
BUDGET, BUDGET_APERIODIC = 200_000, 20_000_000
#: The same of machines with stops that throw bodies back: rebounds that do not end would use up any budget.
BUDGET_WITH_STOPS, LEAST_WITH_STOPS = 2_000, 100_000
#: Bytes that the dense output of one run may take.
KEPT = 4_000_000_000
CHUNK = 4096


def run(todo: Request, tableau: lanes.AnySteps, rtol: float) -> Trajectory | Summary:
    """Solve as asked, by Rosenbrock steps, Taylor series of laws with an inner state, or (no tableau) Taylor steps."""
    check_period(todo.model, todo.machine)
    kernel = lanes.kernel_of(todo.model, tableau, todo.cases == 1 or todo.watched is not None, todo.observe)
    method = _method(tableau)
    if todo.watched is not None:
        return gather(todo, method, _parts_watched(todo, kernel, _job(todo, rtol, KEPT // lanes.bytes_of_piece(kernel)), method))
    if todo.keep == "summary":
        return gather(todo, method, _parts(todo, kernel, _job(todo, rtol)), len(_bounds(todo.cases, todo.workers)))
    job = _job(todo, rtol, KEPT // lanes.bytes_of_piece(kernel))
    table = CaseTable(todo.model, kernel, todo.start, todo.span, machine=todo.machine, own=todo.numbers_of())
    results = lanes.run(
        kernel, table.rows, table.start, job, lambda done: todo.progress(done, todo.periods), keep_pieces=True, partial=todo.partial
    )
    status = int(results.status[0])
    if status == Status.NOT_COMPUTED:
        pieces = _pieces(results.pieces, kernel, table, todo.periods)
        return trajectory(todo, method, pieces, {"steps": len(pieces.mode)}, status)
    if status > Status.REPEATS and status not in ENDS:
        checks.check_numbers(todo.model)
        t = (float(results.pieces[-1, 0]) * table.span[0] + float(results.pieces[-1, 2])) if len(results.pieces) else 0.0
        changes = _changes(results, 0) or stopped.Changes.of(results.pieces[:, 4 : 4 + kernel.contacts])
        status = stopped.rattling(status, changes)
        raise SolveError(_stopped(todo, results, kernel, table, 0, status, t, changes), status)
    counts = {"steps": int(results.accepted[0]), "rejected": int(results.rejected[0])}
    return trajectory(todo, method, _pieces(results.pieces, kernel, table, todo.periods), counts, status if status in ENDS else 0)


def run_of_two(todo: Request, first: Any, one: tuple[lanes.AnySteps, float], other: tuple[lanes.AnySteps, float]) -> Summary:
    """A batch of which some cases, an array (cases,) says which, go by other steps than the rest."""
    check_period(todo.model, todo.machine)
    kernel, rest = (lanes.kernel_of(todo.model, steps, False, todo.observe) for steps, _ in (one, other))
    job, of_rest = (_job(todo, rtol) for _, rtol in (one, other))
    method = f"{_method(one[0])}, {_method(other[0])}"
    return gather(todo, method, _parts(todo, kernel, job, (first, rest, of_rest)), len(_bounds(todo.cases, todo.workers)))


def _stopped(
    todo: Request, results: lanes.Results, kernel: lanes.Kernel, table: CaseTable, case: int, status: int, t: float,
    changes: stopped.Changes | None,
) -> str:  # fmt: skip
    """The message of a run, or of one of the cases of a table, that could not be finished."""
    mechanics = machine_of(table.model_of(case)).mechanics
    q, u, _ = table.ends(results)
    done = "" if todo.model.period is None else f" after {results.periods_run[case]} of {todo.periods} periods,"
    where = stopped.location(mechanics, t, u[case], changes, q[case])
    remedy = stopped.remedy(status, todo.rtol, bool(mechanics.stops), mechanics.together)
    state = _state(results.end[case], table.offsets[case], kernel.layout)
    return stopped.stopping_message(status, f"{done.lstrip()} {where}".strip(), state, remedy)


def _failures(todo: Request, results: lanes.Results, kernel: lanes.Kernel, table: CaseTable) -> dict[int, str]:
    """The messages of the first cases of a table that could not be finished."""
    if results.ended is None:
        return {}
    early = np.flatnonzero(np.isfinite(results.ended))[: stopped.FAILURES].tolist()
    times = {i: float(results.periods_run[i] * table.span[i] + results.ended[i]) for i in early}
    return {i: _stopped(todo, results, kernel, table, i, int(results.status[i]), t, _changes(results, i)) for i, t in times.items()}


def _changes(results: lanes.Results, case: int) -> stopped.Changes | None:
    """How often contacts changed their modes in the last steps of a case that used up its budget, if its kernel counts them."""
    counted = None if results.changed is None else results.changed[case]
    return None if counted is None or not counted.any() else stopped.Changes.counted(counted)


def _state(end: Any, offsets: Any, layout: StateLayout) -> str:
    """The state at which a run stopped, each number with its name and unit."""
    if not layout.single:
        velocities = end[1 : 1 + len(offsets)] + offsets
        values = [*velocities, *end[1 + len(velocities) :]]
        return ", ".join(f"{name} = {float(value):.9g}" for name, value in zip(layout.names, values, strict=False))
    inner = layout.most_inner
    z = [f"z{k}" for k in range(inner)] if inner > 1 else ["z"] * inner
    values = [float(end[0]), float(end[1] + offsets[0]), *map(float, end[2 : 2 + inner])]
    return ", ".join(f"{name} = {value:.9g}" for name, value in zip(["x [m]", "v [m/s]", *z], values, strict=True))


def run_to_end(todo: Request, tableau: lanes.AnySteps, rtol: float) -> tuple[Summary, Any, Any, Any, Any]:
    """The summary of a batch, and of every case at its end x, v (cases,), the law's inner states (cases, states) and its memories."""
    check_period(todo.model, todo.machine)
    kernel = lanes.kernel_of(todo.model, tableau, record=False)
    table = CaseTable(todo.model, kernel, todo.start, todo.span)
    results = lanes.run(kernel, table.rows, table.start, _job(todo, rtol))
    summary = gather(todo, _method(tableau), [((0, todo.cases), _raw(todo, results, kernel, table))], 1)
    _, v, z = table.ends(results)
    return summary, results.end[:, 0], v[:, 0], z, results.memory


def _method(tableau: lanes.AnySteps) -> str:
    return "exact" if tableau is None else tableau.name


def _job(todo: Request, rtol: float, most: float = math.inf) -> lanes.Job:
    """The task for every case, which may take so many steps at most."""
    budget = min(most, budget_of(todo.model, todo.periods, todo.machine))
    return lanes.Job(todo.periods, todo.settle, todo.auto and todo.keep == "summary", rtol, todo.slip_ratio, budget)


def budget_of(model: Model, periods: int, machine: MachineAdapter | None = None) -> int:
    """Steps that a case may take in so many periods; the model's adapter may be given."""
    budget = BUDGET_APERIODIC if model.period is None else BUDGET * periods
    return min(budget, max(BUDGET_WITH_STOPS * periods, LEAST_WITH_STOPS)) if (machine or machine_of(model)).mechanics.stops else budget


def _parts(todo: Request, kernel: lanes.Kernel, job: lanes.Job, rest: tuple[Any, lanes.Kernel, lanes.Job] | None = None) -> Any:
    """Raw results chunk by chunk; threads share the chunks. With `rest` the cases that it does not name go by another kernel."""
    bounds = _bounds(todo.cases, todo.workers)
    begun = [0] * len(bounds)

    def work(i: int) -> RawResults:
        first, last = bounds[i]

        def tell(count: int) -> None:
            begun[i] = count
            todo.progress(sum(begun), todo.cases)

        cases = slice(first, last)
        machine = todo.flat if todo.flat is not None and len(bounds) == 1 else todo.machine
        own = todo.numbers_of(cases)
        table = CaseTable(todo.model, kernel, todo.start[cases], todo.span[cases], which=cases, machine=machine, own=own)

        def made(kernel: lanes.Kernel, job: lanes.Job, some: Any = slice(None)) -> lanes.Results:
            return lanes.run(kernel, table.rows[some], table.start[some], job, progress=tell, partial=todo.partial)

        if rest is None or rest[0][cases].all():
            results = made(kernel, job)
        elif not rest[0][cases].any():
            results = made(*rest[1:])
        else:
            mine = rest[0][cases]
            results = lanes.joined(made(kernel, job, mine), made(*rest[1:], ~mine), mine)
        return _raw(todo, results, kernel, table)

    for i, raw in handed_out(work, range(len(bounds)), todo.workers if len(bounds) > 1 else 1, all_parts=todo.partial):
        yield bounds[i], raw


def _parts_watched(todo: Request, kernel: lanes.Kernel, job: lanes.Job, method: str) -> Any:
    """Raw results case by case, each with its dense output, in which a user's events are looked for; threads share the cases."""

    def work(k: int) -> RawResults:
        one = slice(k, k + 1)
        own = todo.numbers_of(one)
        table = CaseTable(todo.model, kernel, todo.start[one], todo.span[one], which=one, machine=todo.machine, own=own)
        results = lanes.run(kernel, table.rows, table.start, job, keep_pieces=True, partial=todo.partial)
        todo.watched.note(k, method, _pieces(results.pieces, kernel, table, todo.periods), int(results.status[0]))
        return _raw(todo, results, kernel, table)

    for done, (k, raw) in enumerate(handed_out(work, range(todo.cases), todo.workers, all_parts=todo.partial), start=1):
        todo.progress(done, todo.cases)
        yield (k, k + 1), raw


def _bounds(cases: int, workers: int) -> list[tuple[int, int]]:
    """Chunks of cases: large enough for full lanes, small enough that threads finish together."""
    size = min(CHUNK, max(128, -(-cases // (workers * 2)))) if workers > 1 else CHUNK
    return [(i, min(i + size, cases)) for i in range(0, cases, size)]


def _raw(todo: Request, r: lanes.Results, kernel: lanes.Kernel, table: CaseTable) -> RawResults:
    carried = table.carried * table.span
    for case in np.flatnonzero(r.status == Status.BUDGET).tolist():
        r.status[case] = stopped.rattling(Status.BUDGET, _changes(r, case))
    return RawResults(
        displacement=r.displacement + carried * r.window, window=r.window, period=r.period, periods_run=r.periods_run, status=r.status,
        limit=r.limit + carried,
        parts=_raw_contact(r, table) if r.parts is None else _raw_parts(r, kernel, table, carried * r.window),
        observed={name: _reduced(r, each.reduce, f"u.{name}", table.span) for name, each in todo.observe},
        failures=_failures(todo, r, kernel, table),
    )  # fmt: skip


def _reduced(r: lanes.Results, reduce: str, signal: str, span: Numeric) -> Any:
    """A user's observable."""
    assert r.parts is not None
    values = r.parts.reduced[signal][:, {"max": 1, "min": 2, "last": 2}.get(reduce, 0)]
    return values / (span * np.maximum(r.period, 1)) if reduce == "mean" else values


def _raw_contact(r: lanes.Results, table: CaseTable) -> RawParts:
    """Results of lanes for one body on one contact, of which no signals are noted: what they keep of its slip velocity."""
    rest, way, slip_max, slip_min = table.offsets, r.displacement[:, None], r.v_max[:, None], r.v_min[:, None]
    part = (r.window * table.span)[:, None]
    return RawParts(
        displacement=way + table.carried[:, None] * part, v_max=slip_max + rest, v_min=slip_min + rest,
        wide_max=r.wide_max[:, None] + rest, wide_min=r.wide_min[:, None] + rest, slip_max=slip_max, slip_min=slip_min,
        slipped=way + (table.carried[:, None] - rest) * part, slipped_over=r.window,
        seg_count=r.seg_count[:, :1], seg_time=r.seg_time[:, None], seg_code=r.seg_code[:, None],
        margin_force=np.full((len(way), 1), np.inf), friction_power=r.friction_power[:, None],
    )  # fmt: skip


def _raw_parts(r: lanes.Results, kernel: lanes.Kernel, table: CaseTable, carried: Any) -> RawParts:
    """Results of lanes for each body, contact and stop, by the names of their signals."""
    parts, offsets, periods = r.parts, table.offsets, np.maximum(r.period, 1)
    assert parts is not None

    def stacked(letters: str, which: int) -> Any:
        """One number of all signals that begin with one of these letters; NaN of those that have another letter than the first."""
        named = [name for name in kernel.signals if name[0] in letters]
        columns = [parts.reduced[name][:, which] if name[0] == letters[0] else np.full(len(r.status), np.nan) for name in named]
        return np.stack(columns, axis=1) if columns else np.empty((len(r.status), 0))

    difference = 0.0 if kernel.arms else offsets[:, list(kernel.bodies)]  # the states of lanes are less than the velocities by this
    stops = {name: values[:, 0] for name, values in parts.reduced.items() if name[0] in "JF"}
    shape = (len(r.status), kernel.contacts, SEGMENTS)
    return RawParts(
        displacement=parts.moved[:, list(kernel.bodies)] + carried[:, None],
        v_max=stacked("v", 1), v_min=stacked("v", 2), wide_max=parts.wide_max + difference, wide_min=parts.wide_min + difference,
        slip_max=stacked("w", 1), slip_min=stacked("w", 2), slipped=stacked("w", 0), slipped_over=periods,
        seg_count=r.seg_count, seg_time=r.seg_time.reshape(shape), seg_code=r.seg_code.reshape(shape),
        margin_force=np.full(shape[:2], np.inf), friction_power=stacked("P", 0) / (table.span * periods)[:, None],
        hits=np.stack(list(stops.values()), axis=1) if stops else np.empty((len(r.status), 0)),
        impulse_max=stacked("JF", 1), stop_force_max=stacked("FJ", 1),
    )  # fmt: skip


def _pieces(pieces: Any, kernel: lanes.Kernel, table: CaseTable, periods: int) -> PolynomialPieces:
    """The recorded steps of one case as dense output."""
    period = float(table.span[0])
    number, to = pieces[:, 0], pieces[:, 2]
    t = np.zeros(len(pieces) + 1)
    t[1:] = np.where(to >= period, (number + 1) * period, number * period + to)
    good = (t[1:] > t[:-1]) & (number < periods)
    if not good.all():
        pieces, t = pieces[good], np.concatenate([t[:1], t[1:][good]])
    first = 4 + kernel.contacts + kernel.modes
    coefficients = np.array(pieces[:, first:]).reshape(len(pieces), kernel.states, kernel.degree + 1)
    coefficients[:, : len(kernel.owners), 0] += table.offsets[0]
    memory = pieces[:, 4 + kernel.contacts : first].astype(np.int32)
    ways = pieces[:, 3:4] + table.carried[0] * t[:-1, None] if kernel.layout.ways else np.empty((len(pieces), 0))
    return PolynomialPieces(t, pieces[:, 4 : 4 + kernel.contacts].astype(np.int8), ways, coefficients, memory, kernel.layout)
