"""Flows that switch: each stretch by Taylor steps from switch to switch, as a run or as the columns of a batch."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.batch import cases_of
from stickslip.basics.contracts import Array
from stickslip.basics.errors import SolveError
from stickslip.basics.interruption import is_stopped, look, partial_result
from stickslip.basics.status import Status
from stickslip.engine.texts import recurrence
from stickslip.results.flow_drift import repeats_after
from stickslip.results.flow_pieces import FlowPieces, extremes, polynomials
from stickslip.results.summary import Summary
from stickslip.results.trajectory import Trajectory
from stickslip.solvers.flow_engine import FlowSolution, FlowStart, follow_flow, steps_of_flow
from stickslip.solvers.gather import summary, trajectory
from stickslip.solvers.settings import Request


def run(todo: Request) -> Trajectory | Summary:
    """Solve as asked, case by case."""
    if todo.keep == "summary":
        return _summary(todo)
    flow, length = todo.model, float(todo.lengths[0])
    done = follow_flow(flow, FlowStart(todo.start[0], todo.modes[0]), length, growth=False, partial=todo.partial, traced=todo.equations)
    return run_of_parts(todo, [done], Status.NOT_COMPUTED if is_stopped() and done.time < length else 0)


def run_of_parts(todo: Request, parts: list[FlowSolution], status: int = 0) -> Trajectory:
    """The run of one case whose stretches follow one another."""
    counts = {"steps": sum(part.steps for part in parts)}
    return trajectory(todo, steps_of_flow(todo.model)[0], pieces_of(todo.model, parts), counts, status)


def pieces_of(flow: Any, parts: list[FlowSolution]) -> FlowPieces:
    """The dense output of stretches that follow one another."""
    last, places = parts[-1], {mode: k for k, mode in enumerate(flow.modes)}
    switches = [event for part in parts for event in part.events]
    changes = [(places[event.before], places[event.after]) for event in switches]
    return FlowPieces(
        t=_joined([part.nodes if k == 0 else part.nodes[1:] for k, part in enumerate(parts)]),
        mode=_joined([part.modes for part in parts]),
        coefficients=_joined([part.coefficients for part in parts]),
        end=last.state,
        end_mode=places[last.mode],
        passed=_joined([part.passed for part in parts]),
        switch_times=np.array([event.t for event in switches]),
        switch_modes=np.array(changes, int).reshape(-1, 2),
    )


def _joined(arrays: list[Array]) -> Array:
    """Arrays one behind the other; a single one as it is, not copied."""
    joined: Array = arrays[0] if len(arrays) == 1 else np.concatenate(arrays)
    return joined


def _summary(todo: Request) -> Summary:
    rows: list[dict[str, Any]] = []
    failures: dict[int, str] = {}
    settled, method = todo.settle * todo.span + todo.left_out, steps_of_flow(todo.model)[0]
    with partial_result() as ending:
        for k, flow in enumerate(cases_of(todo.model)):
            look()
            why, parts = list[str](), list[FlowSolution]()
            rows.append(flow_columns(flow, todo.start[k], todo.modes[k], float(todo.lengths[k]), float(settled[k]), why, parts))
            if why:
                failures[k] = why[0]
            if todo.watched is not None:
                todo.watched.note_run(k, None) if why else todo.watched.note(k, method, pieces_of(flow, parts), 0)
            todo.progress(k + 1, todo.cases)
    ending.needs(rows)
    lacking = dict.fromkeys(rows[0], np.nan) | {n: -1 for n in ("end_mode", "switches") if n in rows[0]}
    rows += [lacking | {"status": Status.NOT_COMPUTED} for _ in range(todo.cases - len(rows))]
    columns = {name: np.array([row[name] for row in rows]).reshape(todo.labels.shape) for name in rows[0]}
    return summary(todo, method, columns, failures)


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
