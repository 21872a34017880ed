"""The axis of a table's columns: times, frequencies, or sample numbers."""

from __future__ import annotations

import dataclasses
import re
from itertools import pairwise

import numpy as np

from stickslip.basics.contracts import ArrayLike
from stickslip.basics.units import quantity_of
from stickslip.records.raw import Raw, RawColumn

_TIME = re.compile(r"((t|time|times|zeit|x_value)[ _.]*\(?\d*\)?|seconds|elapsed( time)?|time[ _].*|.*[ _.]time|t[ _]?s|timestamp)", re.I)
_FREQUENCY = re.compile(r"(f|freq.*|frequency.*)", re.I)


def by_own_times(columns: list[RawColumn], notes: list[str]) -> list[RawColumn]:
    """Columns with the times before them as their axis, where several columns of times are each followed by others."""
    at = [i for i, c in enumerate(columns) if c.axis is None and _tells_time(c) and _rises(c.values[np.isfinite(c.values)])]
    if len(at) < 2 or at[0] != 0 or any(b - a < 2 for a, b in pairwise([*at, len(columns)])):
        return columns
    columns_with_axes = []
    for begin, end in pairwise([*at, len(columns)]):
        times = columns[begin]
        count = 1 + int(np.flatnonzero(np.isfinite(times.values))[-1])
        axis = dataclasses.replace(times, values=times.values[:count])
        columns_with_axes += [dataclasses.replace(c, values=c.values[:count], axis=axis) for c in columns[begin + 1 : end]]
    notes.append(f"{len(at)} columns of times: each is that of the columns after it ({', '.join(columns[i].name for i in at)})")
    return columns_with_axes


def _tells_time(c: RawColumn) -> bool:
    return quantity_of(c.unit) == "time" or (c.unit is None and _TIME.fullmatch(c.name) is not None)


def counted(c: RawColumn, rate: float | None, notes: list[str]) -> RawColumn:
    """An axis for a channel that has none: times from the given rate, or sample numbers."""
    count = np.arange(len(c.values), dtype=float)
    if rate is not None:
        count /= rate
    count.setflags(write=False)  # nobody else has it: the channel takes it as it is
    if rate is not None:
        return RawColumn("time", "s", count)
    notes.append(f"{c.name} has no time axis: its samples are counted; type rate=... [Hz] for times")
    return RawColumn("sample", None, count)


def table_axes(raw: Raw) -> dict[int, RawColumn]:
    """For each length of columns, the one that is their axis."""
    axes: dict[int, RawColumn] = {}
    for length in dict.fromkeys(len(c.values) for c in raw.columns):
        group = [c for c in raw.columns if c.axis is None and len(c.values) == length and c.values.dtype.kind == "f"]
        axis = _axis_of(group, raw.notes)
        if axis is not None and length > 1:
            axes[length] = axis
    return axes


def _axis_of(group: list[RawColumn], notes: list[str]) -> RawColumn | None:
    for c in group:
        if _tells_time(c):
            return c
    for c in group:
        if _FREQUENCY.fullmatch(c.name) and quantity_of(c.unit) in (None, "frequency") and _rises(c.values):
            return c
    if len(group) > 1 and re.fullmatch(r"column 1", group[0].name) and _rises(group[0].values):
        rest = '"v [mm/s]"' if len(group) == 2 else "..."
        notes.append(
            f'{group[0].name} rises throughout and is taken as the time axis; type columns=["t [s]", {rest}] with the right names and units'
        )
        return group[0]
    return None


def _rises(values: ArrayLike) -> bool:
    steps = np.diff(values)
    return bool(len(steps)) and bool(np.mean(steps > 0) > 0.99)
