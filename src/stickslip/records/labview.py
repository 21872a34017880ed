"""LabVIEW's measurement files (.lvm): what their headers say of units and of the steps of X_Value."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from stickslip.records.raw import Column, Raw

__all__ = ["with_its_header"]


def with_its_header(raw: Raw) -> None:
    """Give the columns of a LabVIEW file their units and axes; other files stay as they are."""
    told = _told(str(raw.info.get("preamble", "")))
    values = [c for c in raw.columns if c.name != "X_Value" and not (c.name == "Comment" and np.isnan(c.values).all())]
    if "X0" not in told or not values:
        return
    time = all(word in ("Time", "") for word in told.get("X_Dimension", ["Time"]))
    one = next((c for c in raw.columns if c.name == "X_Value" and not np.isnan(c.values).all()), None)
    columns = [c for c in raw.columns if c in values or (c.name == "X_Value" and c is one) or (c.name == "X_Value" and _holds(c))]
    for k, column in enumerate(values):
        at = columns.index(column)
        unit = column.unit or _entry(told, "Y_Unit_Label", k) or None
        axis = None if one is not None else _counted(told, k, len(column.values), time)
        columns[at] = dataclasses.replace(column, unit=unit, axis=axis)
    raw.columns = [dataclasses.replace(c, unit="s") if c.name == "X_Value" and c.unit is None and time else c for c in columns]


def _holds(column: Column) -> bool:
    return not bool(np.isnan(column.values).all())


def _told(preamble: str) -> dict[str, list[str]]:
    """The lines of the header by their first word; nothing where it is not one of LabVIEW."""
    if not preamble.startswith("LabVIEW Measurement"):
        return {}
    return {cells[0]: [cell.strip() for cell in cells[1:]] for cells in (line.split("\t") for line in preamble.splitlines())}


def _entry(told: dict[str, list[str]], name: str, k: int) -> str:
    found = told.get(name, [])
    return found[k] if k < len(found) else ""


def _counted(told: dict[str, list[str]], k: int, count: int, time: bool) -> Any:
    """The axis that begin and step in the header make."""
    try:
        begin, step = (float(_entry(told, name, k).replace(",", ".")) for name in ("X0", "Delta_X"))
    except ValueError:
        return None
    return Column("time" if time else "X_Value", "s" if time else None, begin + step * np.arange(count))
