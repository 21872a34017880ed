"""A sweep of a switching flow: its numbers, and where it starts, as axes."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from stickslip.errors import InputError, Problems
from stickslip.jsontext import plain
from stickslip.solvers.flow_solving import asked_of, columns_of
from stickslip.solvers.flows import STATUSES
from stickslip.sweeps.axes import Space, space_of
from stickslip.sweeps.columns import BAD, UNDONE
from stickslip.sweeps.progress import Watch

__all__ = ["sweep_of_flow"]

Array = Any
_START = "start."
#: Arguments of `sweep` that are of machines, with the values that say nothing.
_OF_MACHINES = {"continue_along": None, "out": None, "resume": False, "shard": None, "client": None}


def sweep_of_flow(
    flow: Any, designs: Sequence[Any], axes: dict[str, Any], workers: int, progress: Any, others: dict[str, Any], **arguments: Any
) -> Any:
    """The dataset: of every case what `solve` says of it with ``keep="summary"``."""
    import xarray as xr

    problems = Problems("sweep")
    problems.whole("workers", workers, 1, example=2)
    for name in [name for name, nothing in _OF_MACHINES.items() if others.get(name, nothing) is not nothing]:
        problems.add(f"{name} is not known of a flow, whose sweeps are kept in memory; leave it out")
    problems.check()
    space = space_of(flow, designs, axes)
    case = _cases(flow, space, arguments)
    watch, found = Watch(space.cases, progress), [dict[str, Any]() for _ in range(space.cases)]
    with ThreadPoolExecutor(workers) as pool:
        parts = map(case, range(space.cases)) if workers == 1 else pool.map(case, range(space.cases))
        for k, columns in enumerate(parts):
            found[k] = columns
            watch.finished(k, np.array([columns["status"]]))
            if watch.stopped:
                pool.shutdown(wait=True, cancel_futures=True)
                break
    whole = {name: _column(found, name).reshape(space.shape) for name in next((c for c in found if len(c) > 1), {"status": 0})}
    data = {name: (space.dims, values, _told(name)) for name, values in whole.items()}
    coords = {name: (column.dims, column.values) for name, column in space.coords.items()}
    coords |= {name: ((), float(value)) for name, value in flow.numbers.items() if name not in coords and np.ndim(value) == 0}
    return xr.Dataset(data, coords, {"settings": json.dumps(plain(arguments | {"start": str(arguments["start"])}))})


def _cases(flow: Any, space: Space, arguments: dict[str, Any]) -> Callable[[int], dict[str, Any]]:
    """What gives the columns of one case."""
    varying = space.at(np.arange(space.cases))
    fixed = {name: value for name, value in space.fixed.items() if not name.startswith(_START)}
    begun = {name.removeprefix(_START): value for name, value in space.fixed.items() if name.startswith(_START)}
    first = flow.replace(fixed)
    start = arguments["start"]
    if begun or any(name.startswith(_START) for name in varying):
        if start is not None and not isinstance(start, dict):
            raise InputError("sweep", [f"start = {start!r} beside axes of the start; allowed is a dict; type start={{'x': 0.1}}"])
        start = {**(start or {}), **begun}

    def case(k: int) -> dict[str, Any]:
        own = {name: float(values[k]) for name, values in varying.items()}
        numbers = {name: value for name, value in own.items() if not name.startswith(_START)}
        starts = {name.removeprefix(_START): value for name, value in own.items() if name.startswith(_START)}
        if not np.all(np.isfinite(list(own.values()))):
            return {"status": BAD}
        try:
            one = first.replace(numbers)
        except InputError:
            return {"status": BAD}
        asked = asked_of(one, **arguments | {"start": {**start, **starts} if starts else start})
        return columns_of(one, asked.states[0], asked.mode, float(asked.spans[0]), float(asked.settled[0]))

    if space.cases:
        asked_of(first.replace({n: float(v[0]) for n, v in varying.items() if not n.startswith(_START) and np.isfinite(v[0])}), **arguments | {
            "start": {**start, **{n.removeprefix(_START): float(v[0]) for n, v in varying.items() if n.startswith(_START)}}
            if isinstance(start, dict) else start
        })  # fmt: skip
    return case


def _column(found: list[dict[str, Any]], name: str) -> Array:
    """A column over all cases; what was not solved or not computed is not a number, -1, or its status."""
    if name == "status":
        return np.array([columns.get("status", UNDONE) for columns in found], np.int8)
    known = [columns[name] for columns in found if name in columns]
    whole = all(isinstance(value, (int, np.integer)) for value in known)
    return np.array([columns.get(name, -1 if whole else np.nan) for columns in found])


def _told(name: str) -> dict[str, str]:
    """What a column is."""
    what, _, state = name.partition("_")
    long = {
        "mean": f"mean of {state}", "min": f"smallest {state}", "max": f"largest {state}", "end": f"{state} at the end",
        "switches": "number of switches", "period": "periods of the forcing until it repeats (0: none seen)",
    }  # fmt: skip
    if name == "status":
        return {"long_name": "how the run ended", "flag_meanings": "; ".join(f"{k}: {said}" for k, said in STATUSES.items())}
    return {"long_name": long[what]}
