"""Tables as Excel workbooks: a sheet with the numbers, one with the meaning of each column, and one that says where they come from."""

from __future__ import annotations

import contextlib
import io
import json
import math
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, BinaryIO

from stickslip.basics.errors import InputError
from stickslip.basics.optional import library

#: Rows and columns of a sheet, and characters of a cell: Excel's own limits.
_ROWS, _COLUMNS, _TEXT = 2**20, 2**14, 32767
_NARROW, _WIDE, _SENTENCE = 12, 36, 80  # widths of columns, in characters


def write_workbook(
    file: BinaryIO,
    columns: Sequence[tuple[str, str, str]],
    rows: Iterable[Sequence[Any]],
    count: int,
    about: Mapping[str, Any],
    doing: str,
) -> None:
    """Write a table of `count` rows and what is to be known `about` it as an Excel workbook to an open file.

    Each of the `columns` has a heading, a unit and a meaning. Numbers that are none (NaN) are empty cells. `InputError` of `doing` where
    openpyxl is missing or a sheet cannot hold so many rows.
    """
    _check(count, len(columns), doing)
    openpyxl = library(doing, "openpyxl", 'Excel files need openpyxl; type pip install "stickslip[io]", or give a .csv path')
    book, made = openpyxl.Workbook(write_only=True), io.BytesIO()
    try:
        head = [heading for heading, _, _ in columns]
        data = _sheet(openpyxl, book, "data", head, [min(max(_NARROW, len(text) + 4), _WIDE) for text in head], rows)
        data.auto_filter.ref = f"A1:{openpyxl.utils.get_column_letter(len(head))}{count + 1}"
        _sheet(openpyxl, book, "columns", ("column", "unit", "meaning"), (_WIDE, _NARROW, _SENTENCE), columns)
        _sheet(openpyxl, book, "about", ("name", "value", "unit", "meaning"), (_WIDE, _WIDE, _NARROW, _SENTENCE), _facts(about))
        with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
            openpyxl.writer.excel.ExcelWriter(book, archive).save()
    except BaseException:
        _abandon(book)
        raise
    file.write(made.getbuffer())


def _abandon(book: Any) -> None:
    """Remove the temporary files of a workbook that could not be made, such as where there is no room for them."""
    for sheet in book.worksheets:
        for act in (lambda sheet=sheet: sheet.close(), lambda sheet=sheet: sheet._writer.cleanup()):
            with contextlib.suppress(Exception):
                act()


def _sheet(openpyxl: Any, book: Any, name: str, head: Sequence[str], widths: Sequence[int], rows: Iterable[Sequence[Any]]) -> Any:
    """A sheet with a bold first line that stays in sight, and columns wide enough for it."""
    sheet = book.create_sheet(name)
    sheet.freeze_panes = "A2"
    for i, width in enumerate(widths, 1):
        sheet.column_dimensions[openpyxl.utils.get_column_letter(i)].width = width
    sheet.append([_bold(openpyxl, sheet, text) for text in head])
    for row in rows:
        sheet.append([*map(_cell, row)])
    return sheet


def _bold(openpyxl: Any, sheet: Any, text: str) -> Any:
    cell = openpyxl.cell.WriteOnlyCell(sheet, text)
    cell.font = openpyxl.styles.Font(bold=True)
    return cell


def _facts(about: Mapping[str, Any]) -> Iterator[tuple[Any, ...]]:
    """Name, value, unit and meaning of each fact; a fact that is JSON of several has a row for each of them."""
    described = _opened(about.get("described", ""))
    described = described if isinstance(described, dict) else {}
    for name, value in about.items():
        if name == "described":
            continue
        for path, one in _leaves(name, _opened(value)):
            meaning, unit = described.get(path.partition(".")[2], ("", ""))
            yield path, one, unit, meaning


def _opened(value: Any) -> Any:
    """The value of a JSON text; any other value unchanged."""
    if not isinstance(value, str) or not value.startswith("{"):
        return value
    try:
        return json.loads(value)
    except json.JSONDecodeError:
        return value


def _leaves(path: str, value: Any) -> Iterator[tuple[str, Any]]:
    if not isinstance(value, dict):
        yield path, value
        return
    for name, inner in value.items():
        yield from _leaves(f"{path}.{name}", inner)


def _check(rows: int, columns: int, doing: str) -> None:
    if rows >= _ROWS or columns > _COLUMNS:
        limit = f"a sheet of Excel holds {_ROWS - 1} rows and {_COLUMNS} columns, and this is {rows} rows and {columns} columns"
        raise InputError(doing, [f"{limit}; type a .csv, .nc or .parquet path, or give a part of it"])


def _cell(value: Any) -> Any:
    """A value that a cell can hold: Excel has neither NaN nor infinity."""
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value if isinstance(value, (int, float)) or value is None else str(value)[:_TEXT]
