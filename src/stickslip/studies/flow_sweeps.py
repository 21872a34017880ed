"""A sweep of a switching flow, with its numbers and its initial state as axes."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.interruption import partial_result
from stickslip.basics.jsontext import as_plain
from stickslip.basics.pool import shared
from stickslip.basics.status import STATUS, Status
from stickslip.solvers import solve
from stickslip.solvers.flow_requests import flow_request
from stickslip.solvers.flow_solving import flow_columns
from stickslip.solvers.named_events import event_columns, events_of_model, refuse_terminal
from stickslip.solvers.settings import Settings, check_rtol
from stickslip.studies.execution import Execution
from stickslip.studies.progress import Watch
from stickslip.studies.self_excited import flow_motion_columns, settled_after
from stickslip.studies.space import Space, space_of

if TYPE_CHECKING:
    from stickslip.models.switching_flow import SwitchingFlow


_START = "start."


#: Arguments of sweeps that are of machines alone.
_IN_MEMORY, _OF_MACHINES = ("out", "resume", "shard"), ("tile", "client", "retries", "slip_ratio", "dwell", "observe")


def sweep_of_flow(
    flow: Any, designs: Sequence[Any], axes: dict[str, Any], settings: Settings, how: Execution, along: str | None = None
) -> Any:
    """The dataset: for each case the result of `solve` with ``keep="summary"``."""
    import xarray as xr

    _check(settings, how, along)
    space = space_of(flow, designs, axes)
    settle = settled_after("sweep", flow, settings.settle, settings.duration)
    case = _cases(flow, space, settings if settle is None else replace(settings, settle=None), settle)
    watch, rows = Watch(space.cases, how.progress), [dict[str, Any]() for _ in range(space.cases)]
    with partial_result() as ending:
        for k, columns in shared(case, range(space.cases), how.workers):
            rows[k] = columns
            watch.finished(k, np.array([columns["status"]]))
    whole = {name: _column(rows, name).reshape(space.shape) for name in max(rows, key=len, default={}) or {"status": 0}}
    data = {name: (space.dims, values, _attributes(name)) for name, values in whole.items()}
    coords = {name: (column.dims, column.values) for name, column in space.coords.items()}
    coords |= {name: ((), float(value)) for name, value in flow.numbers.items() if name not in coords and np.ndim(value) == 0}
    told = {name: getattr(settings, name) for name in ("periods", "settle", "method", "duration")}
    attributes = {"settings": json.dumps(as_plain(told | {"start": str(settings.start)}))}
    if ending.interrupted:
        attributes["notes"] = json.dumps({ending.note(Status.NOT_COMPUTED.sentence): sum(not columns for columns in rows)})
    return xr.Dataset(data, coords, attributes)


def _check(settings: Settings, how: Execution, along: str | None) -> None:
    """Note everything that is not of flows, together with what is wrong."""
    problems, named = Problems("sweep"), ["continue_along"] if along is not None else []
    check_rtol(settings.rtol, problems)
    problems.whole("workers", how.workers, 1, example=2)
    named += [name for name in (*settings.differing(), *how.differing()) if name in (*_IN_MEMORY, *_OF_MACHINES)]
    for name in named:
        why = ", whose sweeps are kept in memory" if name in _IN_MEMORY else ""
        problems.add(f"{name} is not known of a flow{why}; leave it out")
    problems.check()


def _cases(flow: SwitchingFlow, space: Space, settings: Settings, settle: float | None) -> Callable[[int], dict[str, Any]]:
    """The function that computes the columns of one case; with `settle`, those of its motion after that time too."""
    varying, fixed = space.at(np.arange(space.cases)), space.fixed
    numbers, first = ({name: value for name, value in of.items() if not name.startswith(_START)} for of in (varying, fixed))
    starts, begun = ({name.removeprefix(_START): v for name, v in of.items() if name.startswith(_START)} for of in (varying, fixed))
    flow, start, watched = flow.replace(first), settings.start, events_of_model("sweep", flow, settings.events)
    refuse_terminal("sweep", watched)
    if (starts or begun) and start is not None and not isinstance(start, dict):
        raise InputError("sweep", [f"start = {start!r} beside axes of the start; allowed is a dict; type start={{'x': 0.1}}"])

    def asked(k: int) -> Any:
        own = {**(start or {}), **begun, **{name: float(values[k]) for name, values in starts.items()}} if starts or begun else start
        return flow_request(flow.replace({name: float(values[k]) for name, values in numbers.items()}), replace(settings, start=own))

    def case(k: int) -> dict[str, Any]:
        try:
            todo = asked(k)
        except InputError:
            return {"status": Status.BAD_INPUT}
        start, length = todo.start[0], float(todo.lengths[0])
        columns = flow_columns(todo.model, start, todo.modes[0], length, float((todo.settle * todo.span)[0]) if settle is None else settle)
        if columns["status"] != 0 or (settle is None and not watched):
            return columns
        run = solve(todo.model, duration=length, start=start, mode=todo.modes[0], keep="trajectory")
        columns |= event_columns(run, watched)
        return columns if settle is None else columns | flow_motion_columns(run, settle, todo.model.modes)

    good = np.flatnonzero(np.all([np.isfinite(values) for values in varying.values()], axis=0)) if varying else range(space.cases)
    if len(good):
        asked(int(good[0]))  # errors in the arguments are reported before the work
    return case


def _column(rows: list[dict[str, Any]], name: str) -> Array:
    """A column over all cases; unsolved or missing cases are NaN, -1, or their status."""
    if name == "status":
        return np.array([columns.get("status", Status.NOT_COMPUTED) for columns in rows], np.int8)
    known = [columns[name] for columns in rows if name in columns]
    if any(isinstance(value, str) for value in known):
        return np.array([columns.get(name, "unsolved") for columns in rows])
    whole = all(isinstance(value, (int, np.integer)) for value in known)
    return np.array([columns.get(name, -1 if whole else np.nan) for columns in rows])


def _attributes(name: str) -> dict[str, str]:
    """The attributes of a column."""
    if name == "motion_type":
        return {"long_name": "periodic, steady or not settled"}
    what, _, state = name.partition("_")
    long = {
        "duration": "time until it repeats", "amplitude": f"half of the range of {state} in a cycle",
        "fraction": f"part of the time in mode {state}",
        "mean": f"mean of {state}", "min": f"smallest {state}", "max": f"largest {state}", "end": f"{state} at the end",
        "switches": "number of switches", "first": f"first instant of {state}", "number": f"how often {state} happens",
        "period": "periods of the forcing, or turns without one, until it repeats (0: none seen)",
    }  # fmt: skip
    if name == "status":
        return {"long_name": "how the run ended", "flag_meanings": "; ".join(f"{k}: {said}" for k, said in STATUS.items())}
    return {"long_name": long.get(what, f"{what} {state}"), "units": "1"}
