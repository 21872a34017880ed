"""A sweep of a switching flow, with its numbers and its initial state as axes."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.interruption import partial_result
from stickslip.basics.jsontext import as_plain
from stickslip.basics.pool import shared
from stickslip.basics.status import STATUS, Status
from stickslip.solvers.flow_solving import asked_of, check_others, flow_columns
from stickslip.studies.progress import Watch
from stickslip.studies.space import Space, space_of

if TYPE_CHECKING:
    from stickslip.basics.progress import Reported
    from stickslip.models.switching_flow import SwitchingFlow


_START = "start."


def sweep_of_flow(
    flow: Any, designs: Sequence[Any], axes: dict[str, Any], rtol: float, workers: int, progress: Reported | bool | None,
    of_machines: dict[str, Any], **arguments: Any,
) -> Any:  # fmt: skip
    """The dataset: for each case the result of `solve` with ``keep="summary"``."""
    import xarray as xr

    problems = Problems("sweep")
    check_others(rtol, workers, of_machines, problems)
    problems.check()
    space = space_of(flow, designs, axes)
    case = _cases(flow, space, arguments)
    watch, rows = Watch(space.cases, progress), [dict[str, Any]() for _ in range(space.cases)]
    with partial_result() as ending:
        for k, columns in shared(case, range(space.cases), workers):
            rows[k] = columns
            watch.finished(k, np.array([columns["status"]]))
    whole = {name: _column(rows, name).reshape(space.shape) for name in next((c for c in rows if len(c) > 1), {"status": 0})}
    data = {name: (space.dims, values, _attributes(name)) for name, values in whole.items()}
    coords = {name: (column.dims, column.values) for name, column in space.coords.items()}
    coords |= {name: ((), float(value)) for name, value in flow.numbers.items() if name not in coords and np.ndim(value) == 0}
    attributes = {"settings": json.dumps(as_plain(arguments | {"start": str(arguments["start"])}))}
    if ending.interrupted:
        attributes["notes"] = json.dumps({ending.note(Status.NOT_COMPUTED.sentence): sum(not columns for columns in rows)})
    return xr.Dataset(data, coords, attributes)


def _cases(flow: SwitchingFlow, space: Space, arguments: dict[str, Any]) -> Callable[[int], dict[str, Any]]:
    """The function that computes the columns of one case."""
    varying, fixed = space.at(np.arange(space.cases)), space.fixed
    numbers, first = ({name: value for name, value in of.items() if not name.startswith(_START)} for of in (varying, fixed))
    starts, begun = ({name.removeprefix(_START): v for name, v in of.items() if name.startswith(_START)} for of in (varying, fixed))
    flow, start = flow.replace(first), arguments["start"]
    if (starts or begun) and start is not None and not isinstance(start, dict):
        raise InputError("sweep", [f"start = {start!r} beside axes of the start; allowed is a dict; type start={{'x': 0.1}}"])

    def asked(k: int) -> Any:
        own = {**(start or {}), **begun, **{name: float(values[k]) for name, values in starts.items()}} if starts or begun else start
        return asked_of(flow.replace({name: float(values[k]) for name, values in numbers.items()}), **{**arguments, "start": own})

    def case(k: int) -> dict[str, Any]:
        try:
            todo = asked(k)
        except InputError:
            return {"status": Status.BAD_INPUT}
        return flow_columns(todo.flow, todo.states[0], todo.mode, float(todo.spans[0]), float(todo.settled[0]))

    good = np.flatnonzero(np.all([np.isfinite(values) for values in varying.values()], axis=0)) if varying else range(space.cases)
    if len(good):
        asked(int(good[0]))  # errors in the arguments are reported before the work
    return case


def _column(rows: list[dict[str, Any]], name: str) -> Array:
    """A column over all cases; unsolved or missing cases are NaN, -1, or their status."""
    if name == "status":
        return np.array([columns.get("status", Status.NOT_COMPUTED) for columns in rows], np.int8)
    known = [columns[name] for columns in rows if name in columns]
    whole = all(isinstance(value, (int, np.integer)) for value in known)
    return np.array([columns.get(name, -1 if whole else np.nan) for columns in rows])


def _attributes(name: str) -> dict[str, str]:
    """The attributes of a column."""
    what, _, state = name.partition("_")
    long = {
        "mean": f"mean of {state}", "min": f"smallest {state}", "max": f"largest {state}", "end": f"{state} at the end",
        "switches": "number of switches", "period": "periods of the forcing until it repeats (0: none seen)",
    }  # fmt: skip
    if name == "status":
        return {"long_name": "how the run ended", "flag_meanings": "; ".join(f"{k}: {said}" for k, said in STATUS.items())}
    return {"long_name": long[what]}
