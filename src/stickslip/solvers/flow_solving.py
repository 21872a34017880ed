"""Runs of a switching flow: one with its dense output, or numbers of every case of a batch."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.batch import cases_of
from stickslip.basics.contracts import Array
from stickslip.basics.errors import SolveError
from stickslip.basics.interruption import is_stopped, look, partial_result
from stickslip.basics.status import Status, interrupted_at
from stickslip.engine.texts import recurrence
from stickslip.results.flow_drift import repeats_after
from stickslip.results.flow_pieces import FlowPieces, extremes, polynomials
from stickslip.results.flow_run import FlowRun
from stickslip.results.summary import Summary
from stickslip.solvers.flow_engine import FlowSolution, FlowStart, follow_flow, steps_of_flow
from stickslip.solvers.settings import Request, versions
from stickslip.solvers.stopped import FAILURES


def run(todo: Request) -> Any:
    """A `FlowRun` of one case, or the `Summary` of a batch."""
    return _run(todo) if todo.keep == "trajectory" else _summary(todo)


def _run(todo: Request) -> FlowRun:
    flow, y, length = todo.model, todo.start[0], float(todo.lengths[0])
    done = follow_flow(flow, FlowStart(y, todo.modes[0]), length, growth=False, partial=todo.partial, traced=todo.equations)
    status, (method, tolerance) = Status.FINISHED.sentence, steps_of_flow(flow)
    if is_stopped() and done.time < length:
        status = interrupted_at(done.time)
    pieces = FlowPieces(done.nodes, done.modes, done.coefficients, done.passed, done.events, done.state, done.mode)
    return _run_with(todo, flow, pieces, done.steps, status, method, tolerance)


def _run_with(todo: Request, flow: Any, pieces: FlowPieces, steps: int, status: str, method: str, tolerance: float) -> FlowRun:
    return FlowRun(
        model=flow,
        pieces=pieces,
        periods=None if todo.duration is not None else todo.periods,
        settle=todo.settle,
        rtol=tolerance,
        method=method,
        status=status,
        samples=todo.samples,
        start=todo.given_start,
        provenance={"versions": versions()},
        counts={"steps": steps},
    )


def run_of_parts(todo: Request, flow: Any, parts: list[FlowSolution]) -> FlowRun:
    """One run of stretches that follow one another."""
    first, last = parts[0], parts[-1]
    nodes = np.concatenate([first.nodes, *(part.nodes[1:] for part in parts[1:])])
    modes, coefficients, passed = (np.concatenate([getattr(part, of) for part in parts]) for of in ("modes", "coefficients", "passed"))
    pieces = FlowPieces(nodes, modes, coefficients, passed, [event for part in parts for event in part.events], last.state, last.mode)
    return _run_with(todo, flow, pieces, sum(part.steps for part in parts), Status.FINISHED.sentence, *steps_of_flow(flow))


def _summary(todo: Request) -> Summary:
    rows: list[dict[str, Any]] = []
    failures: dict[tuple[int, ...], str] = {}
    settled = todo.settle * todo.span + todo.left_out
    with partial_result() as ending:
        for k, flow in enumerate(cases_of(todo.model)):
            look()
            why, parts = list[str](), list[FlowSolution]()
            rows.append(flow_columns(flow, todo.start[k], todo.modes[k], float(todo.lengths[k]), float(settled[k]), why, parts))
            if todo.watched is not None:
                todo.watched.note_run(k, None if why else run_of_parts(todo, flow, parts))
            if why and len(failures) < FAILURES:
                failures[tuple(map(int, np.unravel_index(k, todo.labels.shape)))] = why[0]
            todo.progress(k + 1, todo.cases)
    ending.needs(rows)
    lacking = dict.fromkeys(rows[0], np.nan) | {n: -1 for n in ("end_mode", "switches") if n in rows[0]}
    rows += [lacking | {"status": Status.NOT_COMPUTED} for _ in range(todo.cases - len(rows))]
    columns = {name: np.array([row[name] for row in rows]).reshape(todo.labels.shape) for name in rows[0]}
    settings = {
        "periods": None if todo.duration is not None else todo.periods,
        "settle": todo.settle,
        "method": steps_of_flow(todo.model)[0],
    }
    return Summary(todo.model, todo.labels, columns, {"settings": settings}, failures)


def flow_columns(
    flow: Any, y: Array, mode: Any, span: float, settled: float, why: list[str] | None = None, parts: list[FlowSolution] | None = None
) -> dict[str, Any]:
    """The numbers of one case: mean, smallest and largest value of each state after settling, the switches there, and where it ends.

    The message of a case that could not be followed is added to `why`, and the stretches that were followed to `parts`.
    """
    names, followed = flow.names(len(y)), [] if parts is None else parts
    try:
        start = FlowStart(y, mode)
        if settled > 0.0:
            before = follow_flow(flow, start, settled, growth=False)
            start = FlowStart(before.state, before.mode, settled)
            followed.append(before)
        done = follow_flow(flow, start, span - settled, growth=False)
        followed.append(done)
    except SolveError as error:
        if why is not None:
            why.append(str(error))
        unsolved = {f"{what}_{name}": np.nan for what in ("mean", "min", "max", "end") for name in names}
        unsolved |= {"mean_velocity": np.nan} if flow.cyclic else {}
        counts = {"end_mode": -1, "switches": -1} | ({"period": 0} if flow.period is not None else {})
        return unsolved | counts | {"status": Status.FAILED if error.status is None else error.status}
    nodes, c, end = done.nodes, done.coefficients, done.state
    low, high = extremes(c, np.vstack([done.passed, end]))
    powers = np.arange(1, c.shape[-1] + 1)
    mean = (np.diff(nodes)[:, None] * (c / powers).sum(axis=-1)).sum(axis=0) / (nodes[-1] - nodes[0])
    columns = {f"mean_{name}": mean[i] for i, name in enumerate(names)}
    columns |= {f"min_{name}": low[i] for i, name in enumerate(names)} | {f"max_{name}": high[i] for i, name in enumerate(names)}
    columns |= {f"end_{name}": end[i] for i, name in enumerate(names)}
    columns |= {"end_mode": list(flow.modes).index(done.mode), "switches": len(done.events)}
    if flow.drifts:
        columns["mean_velocity"] = float((end - c[0, :, 0])[flow.drifts.places[0]] / (nodes[-1] - nodes[0]))
    if flow.period is not None:
        columns["period"] = _period(flow, nodes, c, end)
    return columns | {"status": 0}


def _period(flow: Any, nodes: Array, c: Array, end: Array) -> int:
    """After how many periods of the forcing the motion repeats; 0 if it does not repeat within the run."""
    T = float(flow.period)
    t = nodes[0] + np.arange(int((nodes[-1] - nodes[0]) / T + 1e-9) + 1) * T
    if len(t) < 3:
        return 0
    t = np.minimum(t, nodes[-1])
    index = np.clip(np.searchsorted(nodes, t, side="right") - 1, 0, len(c) - 1)
    y = polynomials(c[index], (t - nodes[index]) / (nodes[index + 1] - nodes[index]))
    y[-1] = end
    return repeats_after(flow, y, recurrence())
