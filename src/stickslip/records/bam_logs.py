"""Logs of BAM's pendulum bench: JSON with the bench's numbers and a list of entries, whose units are those of its recorder."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.unpacking import Allowance
from stickslip.records.raw import Raw, RawColumn, unmarked

#: Units and roles of what an entry holds; a load of the servo's own is no force in a unit, and a goal is what was commanded.
_ENTRY: dict[str, tuple[str | None, str | None]] = {
    "position": ("rad", None), "speed": ("rad/s", "velocity"), "goal_position": ("rad", "command"),
    "input_volts": ("V", ""), "volts": ("V", ""),
    "torque": ("N m", None), "current": ("A", None), "load": (None, ""), "temp": (None, ""), "control": (None, ""),
}  # fmt: skip
_BEGINNING = 4096  # bytes in which the first entry begins


def is_log(data: bytes) -> bool:
    """Whether bytes begin as a log of BAM's bench does.

    Examples
    --------
    >>> is_log(b'{"mass": 0.5, "entries": [{"position": 0.1, "goal_position": 0.2}]}'), is_log(b'{"entries": [1, 2]}')
    (True, False)
    """
    beginning = data[:_BEGINNING]
    return beginning.lstrip()[:1] == b"{" and b'"entries"' in beginning and b'"goal_position"' in beginning and b'"position"' in beginning


def parse(data: bytes, allowance: Allowance) -> Raw:
    """The columns of a log, over its times; what it says of the bench is kept."""
    allowance.take(8 * len(data), "the entries")
    try:
        whole = json.loads(unmarked(data))
    except (ValueError, RecursionError) as error:
        raise InputError("read", [f"the log of a bench is cut short or damaged ({error}); record it again, or export it whole"]) from None
    entries = whole.get("entries") if isinstance(whole, dict) else None
    if not (isinstance(entries, list) and entries and all(isinstance(row, dict) for row in entries)):
        raise InputError("read", ['"entries" is no list of objects, as in a log of BAM\'s bench; export it again'])
    raw = Raw("BAM's JSON", table=True, info={name: str(value) for name, value in whole.items() if name != "entries"})
    for name in dict.fromkeys(name for row in entries for name in row):
        values = [row.get(name) for row in entries]
        if any(isinstance(value, (bool, str, list, dict)) for value in values):
            raw.notes.append(f"{name} left out: {_first_word(values)!r} is not a number")
            continue
        unit, role = ("s", None) if name == "timestamp" else _ENTRY.get(name, (None, ""))
        raw.columns.append(RawColumn(name, unit, np.array([_number(value) for value in values]), role=role))
    _time(raw, whole.get("dt"), len(entries))
    return raw


def _first_word(values: list[Any]) -> Any:
    return str(next(value for value in values if isinstance(value, (bool, str, list, dict))))[:40]


def _number(value: Any) -> float:
    try:
        return float(value) if value is not None else math.nan
    except OverflowError:
        return math.nan


def _time(raw: Raw, step: Any, count: int) -> None:
    """Times from the step of a log that was resampled, in place of none."""
    if any(c.name == "timestamp" for c in raw.columns) or not isinstance(step, (int, float)) or isinstance(step, bool) or not step > 0:
        return
    raw.columns.insert(0, RawColumn("timestamp", "s", float(step) * np.arange(count)))
