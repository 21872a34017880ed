"""A log that was dropped on the page, in the process that reads files: what it is taken for, and its record for the process that fits."""

from __future__ import annotations

import io
import json
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError, StickslipError
from stickslip.basics.units import quantity_of
from stickslip.inverse.logs.kinds import kinds_for
from stickslip.inverse.logs.plan import Plan, plan_of
from stickslip.records import Record
from stickslip.records.candidates import candidate_unit, without_unit
from stickslip.records.channel import ROLES, UNUSED, Channel
from stickslip.show.explorer.dropped_records import file_name, read_upload
from stickslip.show.explorer.frames import encoded
from stickslip.show.explorer.log_choices import Choices, choices_of
from stickslip.show.explorer.responses import without_python

_SUGGESTED = "suggested by its name and its size: check it"
_ORIGIN = ("format", "bytes", "sha256", "dialect")


def plan_response(name: str, data: bytes, wish: Any) -> bytes:
    r"""The response to a log: what each channel is taken for, the machines that it suits, and what is missing.

    Channels without a unit have one suggested, which the page shows as a field to check, and sends back as typed.

    Examples
    --------
    >>> from stickslip.show.explorer.frames import unpacked
    >>> header, _ = unpacked(plan_response("rig.csv", b"time_s,pos_mm,F\n0,0,1\n1,2,-1\n2,0,1\n", {}))
    >>> header["machine"], [(c["name"], c["role"], c["unit"]) for c in header["channels"]], header["units"]
    ('rig', [('time_s', 'time', 's'), ('pos_mm', 'position', 'mm'), ('F', 'force', 'N')], {'F': 'N'})
    """
    choices = choices_of(wish)
    record, suggested = _record(name, data, choices)
    plan = plan_of([record], choices.units | suggested, choices.roles, choices.machine, choices.numbers)
    kinds = [[each, kind.words] for each, kind in plan.able.items()]
    problem, assumed = plan.problem, {}
    try:
        assumed = plan.assumed
    except StickslipError as error:
        problem = problem or str(error)
    laws = [] if plan.kind is None else [*plan.kind.laws, *plan.kind.richer]
    notes = [without_python(note) for note in record.notes]
    return encoded({
        "kind": "plan", "channels": _axes(record, suggested) + _channels(plan, record, suggested), "roles": [*ROLES, UNUSED],
        "units": choices.units | suggested, "machine": plan.kind.name if plan.kind else "", "machines": kinds, "why": plan.why,
        "numbers": _numbers(plan, assumed), "laws": laws, "beside": _belongs_beside_curves(plan, record),
        "problem": without_python(problem), "notes": notes,
    })  # fmt: skip


def _belongs_beside_curves(plan: Plan, record: Record) -> bool:
    """Whether a log has a velocity that the page draws beside those of its robot: of a slider or a rig too, but not of a joint."""
    over_motion = plan.kind is not None and plan.kind.over_motion
    return not over_motion or any(quantity_of(c.unit) == "velocity" for c in record.channels.values())


def _record(name: str, data: bytes, choices: Choices) -> tuple[Record, dict[str, str]]:
    """The record, and units that are suggested for channels without one, where they do not make two channels of one role."""
    record = read_upload(name, data, units=choices.units, roles=choices.roles)
    candidates = {each: candidate_unit(each, values) for each, values in without_unit(record.channels.values()).items()}
    suggested = {each: unit for each, unit in candidates.items() if unit != "1"}
    if not suggested:
        return record, {}
    try:
        with_units = read_upload(name, data, units=choices.units | suggested, roles=choices.roles)
        kinds_for([with_units])
    except InputError:
        return record, {}
    return with_units, suggested


def _axes(record: Record, suggested: dict[str, str]) -> list[dict[str, Any]]:
    axes = dict.fromkeys((c.axis_name or "time", c.axis_unit) for c in record.channels.values() if c.axis_name != "sample")
    return [_field(name, "time", unit, "", suggested, None) for name, unit in axes]


def _field(name: str, role: str, unit: str | None, why: str, suggested: dict[str, str], spread: list[float] | None) -> dict[str, Any]:
    said = _SUGGESTED if name in suggested else why
    return {"name": name, "role": role, "unit": unit or "", "why": said, "suggested": name in suggested, "range": spread}


def _channels(plan: Plan, record: Record, suggested: dict[str, str]) -> list[dict[str, Any]]:
    why = {p.what: p.why for p in plan.channels}
    return [_field(c.name, c.role or UNUSED, c.unit, why[c.name], suggested, _range(c)) for c in record.channels.values()]


def _range(c: Channel) -> list[float] | None:
    """The least and the greatest value of a channel, as in the file."""
    numbers = np.real(c.values)[np.isfinite(c.values)]
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
        }
        for name, words in plan.kind.takes.items()
    ]  # fmt: skip


# ---- for the process that fits ----
def record_response(name: str, data: bytes, wish: Any) -> bytes:
    r"""The record of a log as `unpacked_record` reads it: numbers, names and units, and nothing else of the file.

    Examples
    --------
    >>> sent = record_response("rig.csv", b"time_s,pos_mm,F_N\n0,0,1\n1,2,-1\n2,0,1\n", {"roles": {"F_N": "force"}})
    >>> record = unpacked_record(sent)
    >>> record["force"].si.tolist(), record["force"].time.tolist(), record.source["path"]
    ([1.0, -1.0, 1.0], [0.0, 1.0, 2.0], 'rig.csv')
    """
    choices = choices_of(wish)
    record = read_upload(name, data, units=choices.units, roles=choices.roles)
    arrays: dict[str, Any] = {}
    axes: dict[int, str] = {}
    channels = []
    for k, c in enumerate(record.channels.values()):
        axis = axes.setdefault(id(c.t), f"t{k}")
        arrays[axis], arrays[f"v{k}"] = np.asarray(c.t, float), np.asarray(np.real(c.values), float)
        channels.append([c.name, c.unit, axis, f"v{k}", c.axis_name, c.axis_unit, c.role])
    source = {"path": file_name(name)} | {k: v for k, v in record.source.items() if k in _ORIGIN}
    head = {"channels": channels, "notes": record.notes, "source": source, "synthetic": record.synthetic}
    packed = io.BytesIO()
    np.savez(packed, head=np.frombuffer(json.dumps(head, default=str).encode("utf-8", "replace"), np.uint8), **arrays)
    return packed.getvalue()


def unpacked_record(data: bytes) -> Record:
    """The record that `record_response` has sent."""
    with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
        head = json.loads(arrays["head"].tobytes())
        axes: dict[str, Any] = {}
        channels = {}
        for name, unit, axis, values, axis_name, axis_unit, role in head["channels"]:
            t = axes.setdefault(axis, arrays[axis])
            channels[name] = Channel(name, arrays[values], unit, t, axis_name, axis_unit, role)
    return Record(channels, tuple(head["notes"]), head["source"], head["synthetic"])
