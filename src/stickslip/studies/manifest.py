"""The identity of a study, which must be the same for all its tiles."""

from __future__ import annotations

import hashlib
import json
import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.basics.contracts import Model
from stickslip.basics.fingerprints import fingerprint
from stickslip.basics.jsontext import as_plain
from stickslip.basics.references import References
from stickslip.studies.labelling import attributes_of, maker_of, provenance_of, user_columns
from stickslip.studies.model_identity import ModelIdentities, model_differences
from stickslip.studies.planning import Plan
from stickslip.studies.result_columns import COLUMNS, column_type, part_columns
from stickslip.studies.seals import SEAL, of_manifest
from stickslip.studies.solving import kept_columns

#: Version of the folder's layout: 2 has checksums, 3 has the identities of the models of each tile.
FORMAT = 3
_LIBRARIES = ("numpy", "llvmlite")  # of which another minor version may change the last bit of a result
#: What is said of folders of formats 1 and 2.
UNCHECKED = "kept by an earlier stickslip, which did not record the models of each tile: whether all results are of one model is unchecked"


def digest(value: Any) -> str:
    """Hash of plain values and arrays."""
    return hashlib.sha256(json.dumps(value, sort_keys=True, default=_hashed, separators=(",", ":")).encode()).hexdigest()


def _hashed(value: Any) -> Any:
    array = np.asarray(value)
    if array.dtype.kind in "biuf":
        return [list(array.shape), hashlib.sha256(np.ascontiguousarray(array, "<f8").tobytes()).hexdigest()]
    return [str(v) for v in array.ravel().tolist()] if array.ndim else str(value)


def identity(plan: Plan, every: int, models: list[str]) -> dict[str, str]:
    """The parts that identify a study, each as text that can be compared and reported; `models` are the identities of its tiles' models.

    If not `every` model is compared, the code of the maker is a part too.
    """
    versions = provenance_of(plan)["versions"]
    axes = {name: [list(c.dims), c.values] for name, c in plan.space.columns.items()}
    parts: dict[str, Any] = {f"axis {name}": digest(value) for name, value in axes.items()}
    parts |= {name: as_plain(value) for name, value in plan.space.fixed.items()}
    parts |= {f"option {name}": value for name, value in plan.options.items() if name not in ("observe", "events")}
    parts |= {f"observe {name}": each.fingerprint for name, each in (plan.options.get("observe") or {}).items()}
    parts |= {f"event {name}": fingerprint(each).digest for name, each in (plan.options.get("events") or {}).items()}
    parts |= {"version of stickslip": versions["stickslip"]}
    parts |= {f"version of {name}": ".".join(versions[name].split(".")[:2]) for name in _LIBRARIES}
    parts |= {"maker": maker_of(plan.make), "robot": digest(models), "start": digest(plan.start)}
    parts |= {} if every == 1 else {"compared models": f"every {every}th", "code of the maker": fingerprint(plan.make).digest}
    parts |= {"dimensions": " x ".join(f"{d} {n}" for d, n in zip(plan.dims, plan.shape, strict=True)) or "none"}
    parts |= {"continue_along": plan.along, "tile": plan.tile, "format": FORMAT, "columns": ", ".join(kept_columns(plan))}
    parts |= {f"names of dimension {dim}": ", ".join(names) for dim, names in plan.parts.items()}
    return {name: value if isinstance(value, str) else json.dumps(value, default=str) for name, value in parts.items()}


def manifest(plan: Plan, there: dict[str, Any] | None = None, compared: ModelIdentities | None = None) -> dict[str, Any]:
    """The manifest of a study folder; `there` is the manifest of the folder that is continued, if it exists already.

    The identities of the plan may be given.
    """
    compared, code = compared or ModelIdentities(plan), code_of(plan.make)
    models = _models_there(plan, compared, code, there) or compared.of_tiles(range(plan.tiles))
    parts = identity(plan, compared.every, models)
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
        "models": models,
        "compared": compared.every,
        "code": code,
        "unchecked": unchecked(compared),
        "columns": {each: column_type(each) for name in kept_columns(plan) for each in part_columns(name, plan.parts)},
        **({"observed": user_columns(plan)} if plan.observed else {}),
        **({"parts": {dim: list(names) for dim, names in plan.parts.items()}} if plan.parts else {}),
        "attributes": attributes_of(plan),
        "provenance": provenance_of(plan),
        "begun": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
    }
    return {**made, SEAL: of_manifest(made)}


def code_of(make: Model | Callable[..., Any]) -> str:
    """The fingerprint of a maker that makes the same models whenever it is called: of all that it reads; empty if something is unknown.

    Examples
    --------
    >>> import time
    >>> mass = 0.06
    >>> code_of(lambda mu: mu * mass) == code_of(lambda mu: mu * mass) != "", code_of(lambda mu: mu * time.time())
    (True, '')
    """
    if not callable(make) or not (read := References(make)).complete or read.patched:
        return ""
    content = fingerprint(make)
    return "" if content.unchecked else content.digest


def _models_there(plan: Plan, compared: ModelIdentities, code: str, there: dict[str, Any] | None) -> list[str]:
    """The identities in the manifest of a folder, if the code of the maker and all of its arguments are the same; else empty.

    The models of as many tiles as a second allows are made nevertheless, in an order that spreads them over the study; of which not,
    `compared.left_out` says. Those of each tile that is still to be solved are made when its turn comes.
    """
    if there is None or not code or there.get("code") != code or there.get("unchecked") or there["tiles"] != plan.tiles:
        return []
    models = [str(each) for each in there.get("models", ())]
    if len(models) != plan.tiles or plan.tiles <= _TILES or identity(plan, compared.every, models) != there["identity"]:
        return []
    order, begun, count, each = _spread(plan.tiles), time.perf_counter(), 0, _TILES
    while count < plan.tiles and (count < _TILES or time.perf_counter() - begun < SECONDS):
        some = order[count : count + each]
        if compared.of_tiles(some) != [models[k] for k in some] or compared.unchecked:
            return []
        count += len(some)
        left = SECONDS - (spent := time.perf_counter() - begun)
        each = int(np.clip(count * 0.5 * left / max(spent, 1e-9), 1, plan.tiles))  # as many as take half of what is left
    compared.left_out = tuple(sorted(order[count:]))
    return models


_TILES = 3  # whose models are made in any case
SECONDS = 1.0  # in which the models of as many tiles as possible are made again


def _spread(count: int) -> list[int]:
    """All numbers below a count: the ends and the middle first, then each far from those before."""
    golden = np.argsort(np.arange(count) * 0.5 * (5**0.5 - 1) % 1.0)
    return list(dict.fromkeys([0, count // 2, count - 1, *golden.tolist()]))


def unchecked(compared: ModelIdentities) -> list[str]:
    """What is not part of the identity of a study, in sentences."""
    some = f"all but every {compared.every}th model, and the last one, of a tile"
    maker = () if compared.every == 1 else (some, *fingerprint(compared.plan.make).unchecked)
    return [f"{_NOT_SEEN}: {what}" for what in dict.fromkeys([*compared.unchecked, *maker])]


_NOT_SEEN = "unchecked when this study is resumed or merged"


def has_models(manifest: dict[str, Any]) -> bool:
    """Whether the identities of the models of each tile are recorded."""
    return int(manifest["stickslip_format"]) >= 3


def has_checksums(manifest: dict[str, Any]) -> bool:
    """Whether the files of a study have checksums."""
    return int(manifest["stickslip_format"]) >= 2


def flaw(manifest: Any) -> str | None:
    """The error in a manifest that was read from a file; None if it is valid."""
    missing = [name for name, kind in _KINDS.items() if not isinstance(manifest.get(name), kind)]
    if missing:
        return f"{' and '.join(missing)} cannot be read"
    if has_checksums(manifest) and manifest.get(SEAL) != of_manifest(manifest):
        return "its checksum does not fit"
    if len(manifest["dims"]) != len(manifest["shape"]) or not all(type(n) is int and n >= 0 for n in manifest["shape"]):
        return f"shape is {manifest['shape']}"
    each, cases = manifest["cases_per_tile"], math.prod(manifest["shape"])
    if manifest["cases"] != cases or each < 0 or manifest["tiles"] != (-(-cases // each) if each else 0):
        return f"{cases} cases in {manifest['tiles']} tiles of {each} do not fit"
    parts = manifest.get("parts", {})
    if not isinstance(parts, dict) or not all(isinstance(names, list) for names in parts.values()):
        return f"parts is {parts!r}"
    allowed = {each for name in COLUMNS for each in (name, *part_columns(name, parts))}
    unknown = [name for name in manifest["columns"] if name not in allowed | set(manifest.get("observed", {}))]
    if unknown:
        return f"it has columns that are not known: {', '.join(unknown)}"
    return _flaw_of_models(manifest) if has_models(manifest) else None


def _flaw_of_models(manifest: dict[str, Any]) -> str | None:
    for name, count in (("models", manifest["tiles"]), ("unchecked", None)):
        words = manifest.get(name)
        if not isinstance(words, list) or not all(isinstance(word, str) for word in words) or count not in (None, len(words)):
            return f"{name} cannot be read"
    return None


_KINDS = {
    "stickslip_format": int, "study": str, "identity": dict, "dims": list, "shape": list, "cases": int, "tiles": int,
    "cases_per_tile": int, "columns": dict, "attributes": dict, "provenance": dict,
}  # fmt: skip


def differences_between(mine: dict[str, Any], theirs: dict[str, Any]) -> list[str]:
    """The differences between two studies that are given by their manifests, in sentences."""
    return differences(mine["identity"], theirs.get("identity", {}), lambda: _model_differences(mine, theirs))


def _model_differences(mine: dict[str, Any], theirs: dict[str, Any]) -> list[str]:
    if "models" not in mine or "models" not in theirs or mine["cases_per_tile"] != theirs["cases_per_tile"]:
        return []
    return model_differences(mine["models"], theirs["models"], mine["cases_per_tile"])


def differences(mine: dict[str, str], theirs: dict[str, str], of_models: Callable[[], list[str]] = list) -> list[str]:
    """The differences between two identities, in sentences; `of_models` gives those between the models."""
    differing = []
    for name in dict.fromkeys([*theirs, *mine]):
        a, b = theirs.get(name), mine.get(name)
        if a != b:
            if name.startswith("axis ") and a and b:
                differing.append(f"the values of {name[5:]} are others")
            elif name == "robot" and a and b:
                differing += of_models() or ["the robot has other numbers or another kind"]
            elif name == "start" and a and b:
                differing.append("the start has other numbers")
            elif name == "code of the maker" and a and b:
                differing.append("the code of the maker, or what it refers to, is another")
            else:
                differing.append(f"{name} was {a or 'not there'}, now it is {b or 'not there'}")
    return differing
