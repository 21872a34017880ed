"""Tables as Excel workbooks: a sheet with the numbers, units in its first line, and a sheet that says where they come from."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from stickslip.errors import InputError
from stickslip.optional import library

__all__ = ["write_workbook"]

#: Rows and columns of a sheet, and characters of a cell: Excel's own limits.
_ROWS, _COLUMNS, _TEXT = 2**20, 2**14, 32767


def write_workbook(
    path: Path, head: Sequence[str], rows: Iterable[Sequence[Any]], count: int, about: Mapping[str, Any], doing: str
) -> None:
    """Write a table of `count` rows under its `head`, and what is to be known `about` it, to an .xlsx file.

    Numbers that are none (NaN) are empty cells. `InputError` of `doing` where openpyxl is missing or a sheet cannot hold so many rows.
    """
    _check(count, len(head), doing)
    openpyxl = library(doing, "openpyxl", 'Excel files need openpyxl; type pip install "stickslip[io]", or give a .csv path')
    book = openpyxl.Workbook(write_only=True)
    sheet, told = book.create_sheet("data"), book.create_sheet("about")
    sheet.freeze_panes = "A2"
    sheet.append(list(head))
    for row in rows:
        sheet.append([*map(_cell, row)])
    for name, value in about.items():
        told.append([str(name), str(value)[:_TEXT]])
    book.save(path)


def _check(rows: int, columns: int, doing: str) -> None:
    if rows >= _ROWS or columns > _COLUMNS:
        told = f"a sheet of Excel holds {_ROWS - 1} rows and {_COLUMNS} columns, and this is {rows} rows and {columns} columns"
        raise InputError(doing, [f"{told}; type a .csv, .nc or .parquet path, or give a part of it"])


def _cell(value: Any) -> Any:
    """What a cell can hold: there is no NaN in Excel, and no infinity but its name."""
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value if isinstance(value, (str, int, float)) or value is None else str(value)
