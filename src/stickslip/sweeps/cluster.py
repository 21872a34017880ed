"""Tiles as tasks of an existing Dask cluster: workers may die and join; no scheduler of our own.

A task carries the maker's name, arguments and numbers, and gives back columns: nothing of a user's class is pickled. The folder, if
there is one, is written here, so workers need not see it.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.datasets import jsonable
from stickslip.errors import InputError
from stickslip.sweeps.axes import Column, Space
from stickslip.sweeps.planning import Plan
from stickslip.sweeps.progress import Watch

__all__ = ["connected", "from_message", "message", "tiles_from", "work"]

Array = Any


def connected(address: str) -> Any:
    """A client of the scheduler at this address."""
    try:
        from dask.distributed import Client
    except ImportError:
        raise InputError("sweep", ['a cluster needs Dask; type pip install "stickslip[dask]"']) from None
    try:
        return Client(address, timeout=10)
    except (OSError, ValueError) as error:
        raise InputError("sweep", [f"no Dask scheduler answers at {address!r} ({error}); start one with `dask scheduler`"]) from None


def message(plan: Plan) -> dict[str, Any]:
    """A plan without its classes: names, plain values and arrays."""
    space = plan.space
    return {
        "make": _named(plan.make),
        "sizes": dict(space.sizes),
        "columns": {name: (c.dims, c.values.tolist() if c.is_words else c.values) for name, c in space.columns.items()},
        "fixed": {name: _plain(name, value) for name, value in space.fixed.items()},
        "options": dict(plan.options),
        "start": dict(plan.start),
        "along": plan.along,
        "tile": plan.tile,
    }


def _named(make: Any) -> dict[str, Any]:
    """Where a worker finds the maker: by import, or as the TOML text of a robot."""
    if not callable(make):
        try:
            return {"toml": make.to_toml()}
        except InputError as error:
            advice = "write a function that makes it, in a module that the workers can import, and sweep that"
            raise InputError("sweep", [f"the robot cannot be sent to a cluster: {error.problems[0]}; {advice}"]) from None
    module, name = getattr(make, "__module__", None), getattr(make, "__qualname__", "")
    if module in (None, "__main__") or "<" in name:
        what = f"the maker {name or make!r} cannot be found by name on another machine"
        raise InputError("sweep", [f"{what}; put it into a module (a .py file that the workers can import) and import it from there"])
    return {"module": module, "name": name}


def _plain(name: str, value: Any) -> Any:
    if isinstance(value, (str, int, float, bool, type(None), np.generic)):
        return jsonable(value)
    raise InputError("sweep", [f"{name} is a {type(value).__name__}, which a cluster is not sent; let the maker make it from numbers and words"])


def from_message(told: dict[str, Any]) -> Plan:
    """The plan again, on a worker."""
    columns = {}
    for name, (dims, values) in told["columns"].items():
        if isinstance(values, list):
            words = np.empty(len(values), object)
            words[:] = values
            values = words
        columns[name] = Column(tuple(dims), values)
    space = Space(dict(told["sizes"]), columns, dict(told["fixed"]), {})
    return Plan(_found(told["make"]), space, told["options"], told["start"], told["along"], told["tile"])


def _found(make: dict[str, Any]) -> Any:
    if "toml" in make:
        from stickslip.robot import Robot

        return Robot.from_toml(make["toml"])
    found: Any = importlib.import_module(make["module"])
    for part in make["name"].split("."):
        found = getattr(found, part)
    return found


def work(told: dict[str, Any], k: int) -> tuple[dict[str, Array], dict[str, int]]:
    """One tile, on a worker."""
    from stickslip.sweeps.solving import solved

    return solved(from_message(told), k, 1)


def tiles_from(plan: Plan, todo: list[int], client: Any, retries: int, watch: Watch) -> Iterator[tuple[int, dict[str, Array], dict[str, int]]]:
    """The tiles as the cluster finishes them; a few more than its threads are under way at a time."""
    try:
        from dask.distributed import as_completed
    except ImportError:
        raise InputError("sweep", ['a cluster needs Dask; type pip install "stickslip[dask]"']) from None
    [told] = client.scatter([message(plan)], broadcast=False, hash=False)
    rest, numbers, ready = iter(todo), {}, as_completed()

    def send(k: int) -> None:
        future = client.submit(work, told, k, retries=retries, pure=False, key=f"stickslip-{id(watch)}-{k}")
        numbers[future.key] = k
        ready.add(future)

    for k, _ in zip(rest, range(_room(client)), strict=False):
        send(k)
    try:
        for future in ready:
            k = numbers.pop(future.key)
            yield (k, *future.result())
            if watch.stopped:
                return
            for next_one, _ in zip(rest, range(max(_room(client) - len(numbers), 0)), strict=False):
                send(next_one)
    finally:
        for future in list(ready.futures) if hasattr(ready, "futures") else []:
            future.cancel()


def _room(client: Any) -> int:
    """How many tiles to have under way: two for each thread that the cluster has now."""
    return max(2 * sum(client.nthreads().values()), 4)
