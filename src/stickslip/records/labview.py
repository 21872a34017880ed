"""LabVIEW's measurement files (.lvm): what their headers say of units and of the steps of X_Value."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from stickslip.records.raw import Raw, RawColumn


def with_its_header(raw: Raw) -> None:
    """Give the columns of a LabVIEW file their units and axes; other files stay as they are."""
    header = _header(str(raw.info.get("preamble", "")))
    if not header:
        return
    counts = [c for c in raw.columns if c.name == "X_Value" and not np.isnan(c.values).all()]
    raw.columns = [c for c in raw.columns if c.name not in ("X_Value", "Comment") or not np.isnan(c.values).all()]
    if "X0" not in header or len(counts) == len(raw.columns):
        return
    time, k = all(word in ("Time", "") for word in header.get("X_Dimension", ["Time"])), 0
    for at, column in enumerate(raw.columns):
        if column in counts:
            raw.columns[at] = dataclasses.replace(column, unit=column.unit or ("s" if time else None))
            continue
        axis = None if counts else _counted(header, k, len(column.values), time)
        raw.columns[at] = dataclasses.replace(column, unit=column.unit or _entry(header, "Y_Unit_Label", k) or None, axis=axis)
        k += 1


def _header(preamble: str) -> dict[str, list[str]]:
    """The lines of the header by their first word; nothing where it is not one of LabVIEW."""
    if not preamble.startswith("LabVIEW Measurement"):
        return {}
    return {cells[0]: [cell.strip() for cell in cells[1:]] for cells in (line.split("\t") for line in preamble.splitlines())}


def _entry(header: dict[str, list[str]], name: str, k: int) -> str:
    entries = header.get(name, [])
    return entries[k] if k < len(entries) else ""


def _counted(header: dict[str, list[str]], k: int, count: int, time: bool) -> Any:
    """The axis that begin and step in the header make."""
    try:
        begin, step = (float(_entry(header, name, k).replace(",", ".")) for name in ("X0", "Delta_X"))
    except ValueError:
        return None
    return RawColumn("time" if time else "X_Value", "s" if time else None, begin + step * np.arange(count))
