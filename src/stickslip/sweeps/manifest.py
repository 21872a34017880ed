"""What a study is: the one thing that must be the same for its tiles to belong together."""

from __future__ import annotations

import hashlib
import inspect
import json
import time
from typing import Any

import numpy as np

from stickslip.datasets import jsonable
from stickslip.fields import is_array, leaves
from stickslip.sweeps.columns import COLUMNS
from stickslip.sweeps.datasets import attributes_of, maker_of, provenance_of
from stickslip.sweeps.planning import Plan
from stickslip.sweeps.solving import kept_columns

__all__ = ["FORMAT", "differences", "digest", "identity", "manifest"]

#: Version of the folder's layout.
FORMAT = 1
_DECISIVE = ("stickslip", "numpy", "numba")  # versions that may change the last bit


def digest(value: Any) -> str:
    """Hash of plain values and arrays."""
    return hashlib.sha256(json.dumps(value, sort_keys=True, default=_hashed, separators=(",", ":")).encode()).hexdigest()


def _hashed(value: Any) -> Any:
    array = np.asarray(value)
    if array.dtype.kind in "biuf":
        return [list(array.shape), hashlib.sha256(np.ascontiguousarray(array, "<f8").tobytes()).hexdigest()]
    return [str(v) for v in array.ravel().tolist()] if array.ndim else str(value)


def identity(plan: Plan) -> dict[str, str]:
    """The parts that make a study the one it is, each as text that can be compared and told."""
    versions = provenance_of(plan)["versions"]
    axes = {name: [list(c.dims), c.values] for name, c in plan.space.columns.items()}
    parts: dict[str, Any] = {f"axis {name}": digest(value) for name, value in axes.items()}
    parts |= {name: jsonable(value) for name, value in plan.space.fixed.items()}
    parts |= {f"option {name}": value for name, value in plan.options.items()}
    parts |= {f"version of {name}": versions[name] for name in _DECISIVE}
    parts |= {"maker": maker_of(plan.make), "robot": _robot(plan), "start": digest(plan.start)}
    parts |= {"dimensions": " x ".join(f"{d} {n}" for d, n in zip(plan.dims, plan.shape, strict=True)) or "none"}
    parts |= {"continue_along": plan.along, "tile": plan.tile, "format": FORMAT, "columns": ", ".join(kept_columns(plan))}
    return {name: value if isinstance(value, str) else json.dumps(value, default=str) for name, value in parts.items()}


def _robot(plan: Plan) -> str:
    """The first robot's kind and numbers, and the text of a law or maker that is not ours, as a hash."""
    if plan.sample is None:
        return "none"
    robot = plan.sample[0]
    told = [(name, _first(value)) for name, value in leaves(robot, kinds=True)]
    foreign = [thing for thing in (type(robot.friction), type(robot.drive), plan.make) if not _ours(thing)]
    return digest([[name, str(value)] for name, value in told] + [_source(thing) for thing in foreign])


def _first(value: Any) -> Any:
    if isinstance(value, type):
        return f"{value.__module__}.{value.__qualname__}"
    return np.asarray(value).ravel()[0] if is_array(value) else value


def _ours(thing: Any) -> bool:
    return str(getattr(thing, "__module__", type(thing).__module__)).partition(".")[0] == "stickslip"


def _source(thing: Any) -> str:
    try:
        return inspect.getsource(thing)
    except (OSError, TypeError):
        return ""


def manifest(plan: Plan) -> dict[str, Any]:
    """All that the folder says about its study."""
    parts = identity(plan)
    return {
        "stickslip_format": FORMAT,
        "content": "study",
        "study": digest(parts),
        "identity": parts,
        "dims": list(plan.dims),
        "shape": list(plan.shape),
        "cases": plan.cases,
        "tiles": plan.tiles,
        "cases_per_tile": plan.bounds(0)[1] if plan.tiles else 0,
        "columns": {name: COLUMNS[name] for name in kept_columns(plan)},
        "attributes": attributes_of(plan),
        "provenance": provenance_of(plan),
        "begun": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
    }


def differences(mine: dict[str, str], theirs: dict[str, str]) -> list[str]:
    """What is not the same in two identities, in sentences."""
    found = []
    for name in dict.fromkeys([*theirs, *mine]):
        a, b = theirs.get(name), mine.get(name)
        if a != b:
            if name.startswith("axis ") and a and b:
                found.append(f"the values of {name[5:]} are others")
            elif name in ("robot", "start") and a and b:
                found.append(f"the {name} has other numbers or another kind")
            else:
                found.append(f"{name} was {a or 'not there'}, now it is {b or 'not there'}")
    return found
