"""What a sweep of a switching flow has beside the columns of every model: numbers of its states, by their names."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.basics.batch import cases_of, shape_of
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.pool import handed_out
from stickslip.basics.status import Status
from stickslip.solvers.flow_engine import FlowSolution
from stickslip.solvers.flow_requests import flow_request
from stickslip.solvers.flow_solving import flow_columns, run_of_parts
from stickslip.solvers.named_events import event_columns, events_of_model
from stickslip.solvers.settings import Settings
from stickslip.studies.models_of_points import starts_at
from stickslip.studies.result_columns import COLUMNS, unknown
from stickslip.studies.self_excited import flow_motion_columns, settled_after


def start_of_flow(flow: Any, start: Any, problems: Problems) -> dict[str, Any]:
    """Initial values by the names of the states; of a flow without names by their places."""
    if start is None or isinstance(start, dict):
        return dict(start or {})
    values = np.asarray(start, float) if isinstance(start, (list, tuple, np.ndarray)) else np.zeros(())
    names = tuple(map(str, range(len(values)))) if values.ndim and flow.states is None else (*(flow.states or ()), *flow.inner)
    if values.ndim != 1 or len(values) not in (len(names), len(flow.states or names)):
        problems.add(f"start = {start!r}; allowed is a dict, or a list of one number for each state; type start={{'x': 0.1}}")
        return {}
    return {name: float(value) for name, value in zip(names, values, strict=False)}


def own_columns(flow: Any, start: dict[str, Any], options: dict[str, Any]) -> tuple[str, ...]:
    """The names of all columns of a flow, in their order."""
    names = flow.names(len(start) + len(flow.inner) if flow.states is None else len(flow.states) + len(flow.inner))
    columns = [f"{what}_{name}" for what in ("mean", "min", "max", "end") for name in names]
    columns += ["end_mode", "switches", *(["mean_velocity"] if flow.cyclic else [])]
    cycles = settled_after("sweep", flow, options["settle"], options["duration"]) is not None
    columns += ["period"] if flow.period is not None or cycles else []
    if cycles:
        columns += ["motion_type", "duration"]
        columns += [*(f"amplitude_{name}" for name in names), *(f"fraction_{mode}" for mode in flow.modes)]
    return (*columns, "status")


def columns_of_flows(flow: Any, start: dict[str, Any], options: dict[str, Any], workers: int, count: int) -> dict[str, Array]:
    """The columns of a batch, or of one flow: for each case the result of `solve` with ``keep="summary"``, and of its cycle and events."""
    settle = settled_after("sweep", flow, options["settle"], options["duration"])
    flows = cases_of(flow) if shape_of(flow) else [flow] * count
    case = _case(flow, start, options, settle)
    rows: list[dict[str, Any]] = [{} for _ in flows]
    for k, columns in handed_out(lambda k: case(flows[k], k), range(len(flows)), workers):
        rows[k] = columns
    return {name: _column(rows, name) for name in dict.fromkeys(name for row in rows for name in row)}


def _case(flow: Any, start: dict[str, Any], options: dict[str, Any], settle: float | None) -> Callable[[Any, int], dict[str, Any]]:
    """The function that computes the columns of one case; with `settle`, those of its motion after that time too."""
    settings, watched = settings_of_flow(options, settle), events_of_model("sweep", flow, options.get("events"))

    def case(one: Any, k: int) -> dict[str, Any]:
        try:
            todo = flow_request(one, replace(settings, start=begun_at(one, starts_at(start, np.array([k])))))
        except InputError:
            return {"status": Status.BAD_INPUT}
        begun, length = todo.start[0], float(todo.lengths[0])
        left, parts = float((todo.settle * todo.span)[0]) if settle is None else settle, list[FlowSolution]()
        columns = flow_columns(todo.model, begun, todo.modes[0], length, left, parts=parts)
        if columns["status"] != 0 or (settle is None and not watched):
            return columns
        run = run_of_parts(todo, todo.model, parts)
        columns |= event_columns(run, watched)
        return columns if settle is None else columns | flow_motion_columns(run, settle, todo.model.modes)

    return case


def settings_of_flow(options: dict[str, Any], settle: float | None) -> Settings:
    """The settings of `solve` for options of a sweep, of which a time to settle is none of its own."""
    known = {name: value for name, value in options.items() if name != "events"}
    known |= {} if options["duration"] is None or options["periods"] != 200 else {"periods": None}
    return Settings(**known | ({} if settle is None else {"settle": None}))


def begun_at(flow: Any, start: dict[str, Any]) -> Any:
    """Initial values of one case as `solve` takes them."""
    one = {name: float(np.ravel(value)[0]) for name, value in start.items()}
    return (one or None) if flow.states is not None else [one[name] for name in sorted(one, key=int)] or None


def _column(rows: list[dict[str, Any]], name: str) -> Array:
    """A column over all cases; those that lack it have no result there."""
    lacking = unknown(name, 1)[0]
    return np.array([columns.get(name, lacking) for columns in rows])


def attributes_of_column(name: str) -> dict[str, str]:
    """The attributes of a column."""
    what, _, state = name.partition("_")
    long = {
        "amplitude": f"half of the range of {state} in a cycle",
        "fraction": f"part of the time in mode {state}",
        "mean": f"mean of {state}", "min": f"smallest {state}", "max": f"largest {state}", "end": f"{state} at the end",
        "switches": "number of switches", "first": f"first instant of {state}", "number": f"how often {state} happens",
    }  # fmt: skip
    return {"long_name": long.get(what, f"{what} {state}"), "units": "1"}


def described_columns(names: tuple[str, ...]) -> dict[str, dict[str, str]]:
    """Units and meanings of the columns that only flows have."""
    return {name: attributes_of_column(name) for name in names if name not in COLUMNS}
