"""Logs that were dropped on the page, in the process that reads files: what they are taken for, and their records for a fit."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from itertools import accumulate
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError, StickslipError, without_advice
from stickslip.basics.units import quantity_of
from stickslip.inverse.logs.joints import of_first_joint
from stickslip.inverse.logs.kinds import kinds_for
from stickslip.inverse.logs.plan import Plan, plan_of
from stickslip.records import Record
from stickslip.records.candidates import candidate_unit, without_unit
from stickslip.records.channel import ROLES, UNUSED, Channel
from stickslip.show.explorer.dropped_records import file_name, read_upload
from stickslip.show.explorer.frames import encoded
from stickslip.show.explorer.log_choices import Choices, choices_of

_SUGGESTED = "suggested by its name and its size: check it"
_ORIGIN = ("format", "bytes", "sha256", "dialect")


def plan_response(name: str, data: bytes, wish: Any) -> bytes:
    r"""The response to logs: what each channel is taken for, the machines that they suit, and what is missing.

    Channels without a unit have one suggested, which the page shows as a field to check, and sends back as typed.

    Examples
    --------
    >>> from stickslip.show.explorer.frames import unpacked
    >>> header, _ = unpacked(plan_response("rig.csv", b"time_s,pos_mm,F\n0,0,1\n1,2,-1\n2,0,1\n", {}))
    >>> header["machine"], [(c["name"], c["role"], c["unit"]) for c in header["channels"]], header["units"]
    ('rig', [('time_s', 'time', 's'), ('pos_mm', 'position', 'mm'), ('F', 'force', 'N')], {'F': 'N'})
    """
    choices = choices_of(wish)
    records, suggested = _records(_files(name, data, choices), choices)
    plan = plan_of(records, choices.units | suggested, choices.roles, choices.machine, choices.numbers)
    kinds = [[each, kind.words] for each, kind in plan.able.items()]
    problem, assumed = plan.problem, {}
    try:
        assumed = plan.assumed
    except StickslipError as error:
        problem = problem or str(error)
    laws = [] if plan.kind is None else [*plan.kind.laws, *plan.kind.richer]
    notes = dict.fromkeys(without_advice(note) for record in records for note in record.notes)
    return encoded({
        "kind": "plan", "channels": _axes(records, suggested) + _channels(plan, suggested), "roles": [*ROLES, UNUSED],
        "units": choices.units | suggested, "machine": plan.kind.name if plan.kind else "", "machines": kinds, "why": plan.why,
        "numbers": _numbers(plan, assumed), "laws": laws, "beside": _belongs_beside_curves(plan, records[0]),
        "problem": without_advice(problem), "notes": list(notes),
    })  # fmt: skip


def _files(name: str, data: bytes, choices: Choices) -> list[tuple[str, bytes]]:
    """The files in some bytes, with their names: one, or several one behind the other."""
    if not choices.files:
        return [(name, data)]
    ends = [*accumulate(size for _, size in choices.files)]
    if ends[-1] != len(data):
        raise InputError("record", ["the files have other lengths than the page has said; drop them again"])
    return [(each, data[end - size : end]) for (each, size), end in zip(choices.files, ends, strict=True)]


def _belongs_beside_curves(plan: Plan, record: Record) -> bool:
    """Whether a log has a velocity that the page draws beside those of its robot: of a slider or a rig too, but not of a joint."""
    over_motion = plan.kind is not None and plan.kind.over_motion
    return not over_motion or any(quantity_of(c.unit) == "velocity" for c in record.channels.values())


def _records(files: list[tuple[str, bytes]], choices: Choices) -> tuple[list[Record], dict[str, str]]:
    """The records, and units that are suggested for channels without one, where they do not make two channels of one role."""
    records = [read_log(*each, choices) for each in files]
    bare = {name: values for record in records for name, values in without_unit(record.channels.values()).items()}
    suggested = {each: unit for each, values in bare.items() if (unit := candidate_unit(each, values)) != "1"}
    if not suggested:
        return records, {}
    try:
        with_units = [read_log(*each, replace(choices, units=choices.units | suggested)) for each in files]
        kinds_for(of_first_joint(with_units, choices.roles)[0])
    except InputError:
        return records, {}
    return with_units, suggested


def read_log(name: str, data: bytes, choices: Choices) -> Record:
    """The record of a file, with the units and roles that were typed for columns that it has."""
    try:
        return read_upload(name, data, units=choices.units, roles=choices.roles)
    except InputError as error:
        if not choices.files:
            raise
        try:
            own = choices.of(names_of(read_upload(name, data)))
            return read_upload(name, data, units=own.units, roles=own.roles)
        except InputError:
            raise InputError("record", [f"{file_name(name)}: {problem}" for problem in error.problems]) from None


def names_of(record: Record) -> set[str]:
    """The names of the columns of a record, its time axes included."""
    return {*record.channels} | {c.axis_name for c in record.channels.values() if c.axis_name is not None}


def _axes(records: list[Record], suggested: dict[str, str]) -> list[dict[str, Any]]:
    channels = [c for record in records for c in record.channels.values()]
    axes = dict.fromkeys((c.axis_name or "time", c.axis_unit) for c in channels if c.axis_name != "sample")
    return [_field(name, "time", unit, "", suggested, None) for name, unit in axes]


def _field(name: str, role: str, unit: str | None, why: str, suggested: dict[str, str], spread: list[float] | None) -> dict[str, Any]:
    said = _SUGGESTED if name in suggested else why
    return {"name": name, "role": role, "unit": unit or "", "why": said, "suggested": name in suggested, "range": spread}


def _channels(plan: Plan, suggested: dict[str, str]) -> list[dict[str, Any]]:
    """A field for each channel; one for those of the same name in several files."""
    why, alike = {p.what: p.why for p in plan.channels}, dict[str, list[Channel]]()
    for c in (c for record in plan.records for c in record.channels.values()):
        alike.setdefault(c.name, []).append(c)
    why |= {name: f"of another joint; to fit that one set its role to {role}" for name, role in plan.joint.others.items()}
    unused = {name for name, cs in alike.items() if cs[0].role is None} - set(plan.joint.others)
    why |= dict.fromkeys(unused, "not used")
    return [_field(name, cs[0].role or UNUSED, cs[0].unit, why[name], suggested, _range(cs)) for name, cs in alike.items()]


def _range(channels: list[Channel]) -> list[float] | None:
    """The least and the greatest value of channels, as in the files."""
    values = np.concatenate([np.real(c.values) for c in channels])
    numbers = values[np.isfinite(values)]
    return [float(numbers.min()), float(numbers.max())] if len(numbers) else None


def _numbers(plan: Plan, assumed: dict[str, tuple[str, str]]) -> list[dict[str, Any]]:
    """A field for each number that the machine takes: its words, what was typed, and what is assumed otherwise."""
    if plan.kind is None:
        return []
    missing = plan.kind.missing(plan.records, {})
    return [
        {
            "name": name, "words": words, "typed": plan.given.get(name), "needed": name in missing,
            "assumed": assumed.get(name, ("", ""))[0], "why": assumed.get(name, ("", ""))[1], "example": plan.kind.needs.get(name, ""),
            "each": len(plan.records) > 1 and name in plan.kind.by_file,
        }
        for name, words in plan.kind.takes.items()
    ]  # fmt: skip


# ---- for the process that fits ----
def record_response(name: str, data: bytes, wish: Any) -> bytes:
    r"""The records of logs as `unpacked_records` reads them: numbers, names and units, and nothing else of the files.

    Examples
    --------
    >>> sent = record_response("rig.csv", b"time_s,pos_mm,F_N\n0,0,1\n1,2,-1\n2,0,1\n", {"roles": {"F_N": "force"}})
    >>> (record,) = unpacked_records(sent)
    >>> record["force"].si.tolist(), record["force"].time.tolist(), record.source["path"]
    ([1.0, -1.0, 1.0], [0.0, 1.0, 2.0], 'rig.csv')
    """
    choices = choices_of(wish)
    arrays: dict[str, Any] = {}
    heads = [_head(read_log(*each, choices), each[0], f"file {k} ", arrays) for k, each in enumerate(_files(name, data, choices))]
    packed = io.BytesIO()
    np.savez(packed, heads=np.frombuffer(json.dumps(heads, default=str).encode("utf-8", "replace"), np.uint8), **arrays)
    return packed.getvalue()


def _head(record: Record, name: str, before: str, arrays: dict[str, Any]) -> dict[str, Any]:
    """What a record has besides its arrays, which are put among the others."""
    axes: dict[int, str] = {}
    channels = []
    for k, c in enumerate(record.channels.values()):
        axis, values = axes.setdefault(id(c.t), f"{before}axis {k}"), f"{before}values {k}"
        arrays[axis], arrays[values] = np.asarray(c.t, float), np.asarray(np.real(c.values), float)
        channels.append([c.name, c.unit, axis, values, c.axis_name, c.axis_unit, c.role])
    source = {"path": file_name(name)} | {k: v for k, v in record.source.items() if k in _ORIGIN}
    return {"channels": channels, "notes": record.notes, "source": source, "synthetic": record.synthetic}


def unpacked_records(data: bytes) -> list[Record]:
    """The records that `record_response` has sent."""
    with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
        return [_unpacked(head, arrays) for head in json.loads(arrays["heads"].tobytes())]


def _unpacked(head: dict[str, Any], arrays: Any) -> Record:
    axes: dict[str, Any] = {}
    channels = {}
    for name, unit, axis, values, axis_name, axis_unit, role in head["channels"]:
        t = axes.setdefault(axis, arrays[axis])
        channels[name] = Channel(name, arrays[values], unit, t, axis_name, axis_unit, role)
    return Record(channels, tuple(head["notes"]), head["source"], head["synthetic"])
