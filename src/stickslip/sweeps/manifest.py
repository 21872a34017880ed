"""The identity of a study, which must be the same for all of its tiles."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import inspect
import json
import math
import sys
import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.fields import is_array, leaves
from stickslip.jsontext import plain
from stickslip.sweeps.labelling import about, attributes_of, maker_of, provenance_of
from stickslip.sweeps.planning import Plan
from stickslip.sweeps.result_columns import COLUMNS, kind_of, part_columns
from stickslip.sweeps.seals import SEAL, of_manifest
from stickslip.sweeps.solving import kept_columns

#: Version of the folder's layout: 2 has checksums.
FORMAT = 2
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
    parts |= {name: plain(value) for name, value in plan.space.fixed.items()}
    parts |= {f"option {name}": value for name, value in plan.options.items() if name != "observe"}
    parts |= {f"observe {name}": each.fingerprint for name, each in (plan.options.get("observe") or {}).items()}
    parts |= {f"version of {name}": versions[name] for name in _DECISIVE}
    parts |= {"maker": maker_of(plan.make), "robot": _robot(plan), "start": digest(plan.start)}
    parts |= {"dimensions": " x ".join(f"{d} {n}" for d, n in zip(plan.dims, plan.shape, strict=True)) or "none"}
    parts |= {"continue_along": plan.along, "tile": plan.tile, "format": FORMAT, "columns": ", ".join(kept_columns(plan))}
    parts |= {f"names of dimension {dim}": ", ".join(names) for dim, names in plan.parts.items()}
    return {name: value if isinstance(value, str) else json.dumps(value, default=str) for name, value in parts.items()}


def _robot(plan: Plan) -> str:
    """The first robot's kind and numbers, and the text of every class and function in it that is not ours, as a hash."""
    if plan.sample is None:
        return "none"
    parts = list(leaves(plan.sample, kinds=True))
    told = [[name, _text(_first(value))] for name, value in parts]
    things = [plan.make, *(thing for _, value in parts if not is_array(value) for thing in _within(value))]
    foreign = dict.fromkeys(part for thing in things for part in _parts_of(thing) if not _known(part))
    return digest(told + [_source(part) for part in foreign])


def _within(value: Any) -> Iterator[Any]:
    """A value, and what is in it if it is a list."""
    yield value
    for item in value if isinstance(value, (list, tuple)) else ():
        if dataclasses.is_dataclass(item) and not isinstance(item, type):
            yield from (thing for _, part in leaves(item, kinds=True) for thing in _within(part))
        else:
            yield from _within(item)


def _first(value: Any) -> Any:
    return np.asarray(value).ravel()[0] if is_array(value) else value


def _text(value: Any) -> str:
    """A value as text that is the same in every process."""
    if isinstance(value, type) or inspect.isroutine(value):
        return f"{value.__module__}.{value.__qualname__}"
    if isinstance(value, (list, tuple)):
        return str([_text(item) for item in value])
    if type(value).__repr__ is object.__repr__:  # which says an address
        return f"{_text(type(value))} {sorted(vars(value).items()) if hasattr(value, '__dict__') else ''}"
    return str(value)


def _parts_of(thing: Any) -> tuple[Any, ...]:
    """The classes and functions whose text says what a thing does: a function itself, of anything else its class and those under it."""
    if isinstance(thing, functools.partial):
        return _parts_of(thing.func)
    if inspect.isroutine(thing):
        return (thing,)
    return (thing if isinstance(thing, type) else type(thing)).__mro__


def _known(part: Any) -> bool:
    """Whether a class or a function is ours or Python's, whose versions are noted."""
    module = str(getattr(part, "__module__", None) or "builtins").partition(".")[0]
    return module in ("stickslip", "numpy") or module in sys.stdlib_module_names


def _source(part: Any) -> str:
    try:
        return inspect.getsource(part)
    except (OSError, TypeError):
        return ""


def manifest(plan: Plan) -> dict[str, Any]:
    """All that the folder says about its study."""
    parts = identity(plan)
    made = {
        "stickslip_format": FORMAT,
        "content": "study",
        "study": digest(parts),
        "identity": parts,
        "dims": list(plan.dims),
        "shape": list(plan.shape),
        "cases": plan.cases,
        "tiles": plan.tiles,
        "cases_per_tile": plan.bounds(0)[1] if plan.tiles else 0,
        "columns": {each: kind_of(each) for name in kept_columns(plan) for each in part_columns(name, plan.parts)},
        **({"observed": about(plan)} if plan.observed else {}),
        **({"parts": {dim: list(names) for dim, names in plan.parts.items()}} if plan.parts else {}),
        "attributes": attributes_of(plan),
        "provenance": provenance_of(plan),
        "begun": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
    }
    return {**made, SEAL: of_manifest(made)}


def has_checksums(manifest: dict[str, Any]) -> bool:
    """Whether the files of a study have checksums."""
    return int(manifest["stickslip_format"]) >= 2


def flaw(found: Any) -> str | None:
    """The error in a manifest read from a file; None if it is valid."""
    missing = [name for name, kind in _KINDS.items() if not isinstance(found.get(name), kind)]
    if missing:
        return f"{' and '.join(missing)} cannot be read"
    if has_checksums(found) and found.get(SEAL) != of_manifest(found):
        return "its checksum does not fit"
    if len(found["dims"]) != len(found["shape"]) or not all(type(n) is int and n >= 0 for n in found["shape"]):
        return f"shape is {found['shape']}"
    each, cases = found["cases_per_tile"], math.prod(found["shape"])
    if found["cases"] != cases or each < 0 or found["tiles"] != (-(-cases // each) if each else 0):
        return f"{cases} cases in {found['tiles']} tiles of {each} do not fit"
    parts = found.get("parts", {})
    if not isinstance(parts, dict) or not all(isinstance(names, list) for names in parts.values()):
        return f"parts is {parts!r}"
    allowed = {each for name in COLUMNS for each in (name, *part_columns(name, parts))}
    unknown = [name for name in found["columns"] if name not in allowed | set(found.get("observed", {}))]
    return f"it has columns that are not known: {', '.join(unknown)}" if unknown else None


_KINDS = {
    "stickslip_format": int, "study": str, "identity": dict, "dims": list, "shape": list, "cases": int, "tiles": int,
    "cases_per_tile": int, "columns": dict, "attributes": dict, "provenance": dict,
}  # fmt: skip


def differences(mine: dict[str, str], theirs: dict[str, str]) -> list[str]:
    """The differences between two identities, in sentences."""
    found = []
    for name in dict.fromkeys([*theirs, *mine]):
        a, b = theirs.get(name), mine.get(name)
        if a != b:
            if name.startswith("axis ") and a and b:
                found.append(f"the values of {name[5:]} are others")
            elif name in ("robot", "start") and a and b:
                edited = ", or the text of a class or a function of your own is another" if name == "robot" else ""
                found.append(f"the {name} has other numbers or another kind{edited}")
            else:
                found.append(f"{name} was {a or 'not there'}, now it is {b or 'not there'}")
    return found
