"""Tiles as tasks of an existing Dask cluster: workers may fail and join; there is no scheduler of our own.

A task contains the maker's name, arguments and numbers, and returns columns; user classes are not pickled. The folder, if there is
one, is written by this process, so the workers need no access to it.
"""

from __future__ import annotations

import pkgutil
import secrets
import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, StickslipError
from stickslip.basics.interruption import look
from stickslip.basics.jsontext import as_plain
from stickslip.basics.optional import library
from stickslip.results.storage import from_text
from stickslip.studies.model_identity import ModelIdentities
from stickslip.studies.models_of_points import starts_at
from stickslip.studies.planning import Plan
from stickslip.studies.progress import Watch
from stickslip.studies.space import Column, Space

_LOOK = 0.02  # how often it looks for a tile that is ready [s]


def _distributed() -> Any:
    return library("sweep", "dask.distributed", 'a cluster needs Dask; type pip install "stickslip[dask]"')


def connected(address: str) -> Any:
    """A client of the scheduler at this address."""
    dask = _distributed()
    try:
        return dask.Client(address, timeout=10)
    except (OSError, ValueError) as error:
        raise InputError("sweep", [f"no Dask scheduler answers at {address!r} ({error}); start one with `dask scheduler`"]) from None


def tile_message(plan: Plan, k: int, every: int = 1) -> dict[str, Any]:
    """A tile without its classes: names, plain values and the rows of its own cases; every so-many-th of its models is compared."""
    points = plan.points(k)
    dims = ("case",) if plan.along is None else ("line", plan.along)
    start = starts_at(plan.start, points)
    return {
        "make": _named(plan.make),
        "sizes": dict(zip(dims, points.shape, strict=True)),
        "columns": {name: (dims, v.tolist() if v.dtype.kind != "f" else v) for name, v in plan.space.at(points).items()},
        "fixed": {name: _plain(name, value) for name, value in plan.space.fixed.items()},
        "options": dict(plan.options),
        "start": {name: value if np.ndim(value) == 0 else value.ravel() for name, value in start.items()},
        "along": plan.along,
        "every": every,
    }


def _named(make: Any) -> dict[str, Any]:
    """Where a worker finds the maker: by import, or from the TOML text of a robot or a mechanism."""
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
        return as_plain(value)
    raise InputError(
        "sweep", [f"{name} is a {type(value).__name__}, which a cluster is not sent; let the maker make it from numbers and words"]
    )


def from_message(message: dict[str, Any]) -> Plan:
    """Restore a tile on a worker: a plan of its own with one tile."""
    columns = {}
    for name, (dims, values) in message["columns"].items():
        if isinstance(values, list):
            words = np.empty(list(message["sizes"].values()), object)
            words[...] = np.array(values, object).reshape(words.shape)
            values = words
        columns[name] = Column(tuple(dims), values)
    space = Space(dict(message["sizes"]), columns, dict(message["fixed"]), {})
    return Plan(_maker(message["make"]), space, message["options"], message["start"], message["along"], max(space.cases, 1))


def _maker(make: dict[str, Any]) -> Any:
    if "toml" in make:
        return from_text(make["toml"])
    return pkgutil.resolve_name(f"{make['module']}:{make['name']}")


def compute_tile(message: dict[str, Any]) -> tuple[dict[str, Array], dict[str, int], str]:
    """Compute one tile on a worker: its columns, its notes, and the identity of the models as they are there."""
    from stickslip.studies.solving import solved_models

    plan = from_message(message)
    return solved_models(plan, 0, 1, None, ModelIdentities(plan, message["every"]))


def _check_models(k: int, mine: str, theirs: str) -> None:
    """Raise an `InputError` if a worker has other models than this process."""
    if mine != theirs:
        what = f"a worker computed tile {k} with other models than the maker gives here"
        why = "its module, or something that it uses, is another there"
        raise InputError(
            "sweep", [f"{what}: {why}; restart the workers with the module that you use, and type resume=True if out= is given"]
        )


def tiles_from(
    plan: Plan, todo: list[int], client: Any, retries: int, watch: Watch, identities: ModelIdentities
) -> Iterator[tuple[int, dict[str, Array], dict[str, int], str]]:
    """The tiles in the order in which the cluster finishes them; up to twice as many as its threads, at least 4, are in progress.

    The models of each are compared with those that the maker gives in this process. A tile that failed, or whose result was lost with
    its worker, is submitted again, up to `retries` times.
    """
    rest, running, tries = iter(todo), dict[Any, int](), dict[int, int]()
    ready = _distributed().as_completed(with_results=False)

    def send(k: int) -> None:
        tries[k] = tries.get(k, 0) + 1
        key = f"stickslip-{secrets.token_hex(4)}-{k}"
        future = client.submit(compute_tile, tile_message(plan, k, identities.every), retries=retries, pure=False, key=key)
        running[future] = k
        ready.add(future)

    try:
        while True:
            look()
            for _, k in zip(range(max(2 * sum(client.nthreads().values()), 4) - len(running)), rest, strict=False):
                send(k)
            if not running:
                return
            future = _next(ready)
            if future is None:  # the remaining tiles were lost with their workers
                lost, running = list(running.values()), {}
                for k in lost:
                    if tries[k] > retries:
                        raise StickslipError(
                            f"sweep: tile {k} was lost with its worker {tries[k]} times; look at the workers' logs (memory?)"
                        )
                    send(k)
                continue
            k = running.pop(future)
            columns, notes, models = future.result()
            _check_models(k, identities.of_tiles([k])[0], models)
            yield k, columns, notes, models
    finally:
        for future in running:
            future.cancel()


def _next(ready: Any) -> Any:
    """The next future that is ready, or None where none is left; it looks meanwhile whether the call is to end."""
    while not ready.is_empty() and not ready.has_ready():
        look()
        time.sleep(_LOOK)
    return next(ready, None)
