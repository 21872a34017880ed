"""XLSX: the table on the first sheet. It is a ZIP archive of XML, read in a process of its own, as either can be a bomb."""

from __future__ import annotations

import io
import warnings
import zipfile
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.units import unit_of_heading
from stickslip.basics.unpacking import Allowance
from stickslip.records.extras import damage_reported, library
from stickslip.records.raw import Raw, RawColumn
from stickslip.records.tables_of_values import is_plain_number, number_in

#: Bytes in memory for a byte of XML and for a cell, and most rows, which are Excel's.
_PER_BYTE, _PER_CELL, _MOST_ROWS = 10, 32, 2**20
_Row = tuple[Any, ...]


def parse_xlsx(data: bytes, allowance: Allowance) -> Raw:
    """The table on the first sheet of an Excel file."""
    openpyxl, raw = library("openpyxl", "XLSX"), Raw("XLSX", table=True)
    with damage_reported("XLSX"):
        _check_archive(data, allowance)
        with warnings.catch_warnings(action="ignore"):  # of styles and the like, which are not read
            book = openpyxl.load_workbook(io.BytesIO(data), read_only=True, data_only=True)
            sheet = book.worksheets[0]
            sheet.reset_dimensions()  # which the file may declare at will
            rows = _rows(sheet, allowance)
        if len(book.worksheets) > 1:
            raw.notes.append(f"the file has {len(book.worksheets)} sheets; the first one, {sheet.title!r}, is read")
        raw.columns = _table(rows, raw.notes, allowance)
    return raw


def _check_archive(data: bytes, allowance: Allowance) -> None:
    """Refuse an archive that unpacks to too much at once (no more than it declares is ever unpacked), not after a minute of reading."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        allowance.take(_PER_BYTE * sum(part.file_size for part in archive.infolist()), "its XML")


def _rows(sheet: Any, allowance: Allowance) -> list[_Row]:
    """The rows of a sheet that hold anything, without the empty cells at their ends."""
    rows = []
    for number, row in enumerate(sheet.iter_rows(values_only=True), start=1):
        if number > _MOST_ROWS:
            raise InputError("read", [f"the sheet has more than {_MOST_ROWS} rows, as no sheet of Excel has; save it again"])
        width = max((i for i, cell in enumerate(row, start=1) if cell is not None), default=0)
        if width:
            allowance.take(8 * width, "its first sheet")
            rows.append(row[:width])
    return rows


def _table(rows: list[_Row], notes: list[str], allowance: Allowance) -> list[RawColumn]:
    """The columns of a sheet whose cells are numbers, text or None."""
    width = max((len(row) for row in rows), default=0)
    allowance.take(_PER_CELL * width * len(rows), "its first sheet")
    numeric = [sum(is_plain_number(cell) for cell in row) for row in rows]
    most = max(numeric, default=0)
    if most == 0:
        raise InputError("read", ["the sheet holds no row of numbers; export the sheet with the data as its first one"])
    first = next(i for i, n in enumerate(numeric) if n >= 0.5 * most)
    heads = ["" if cell is None else str(cell) for cell in rows[first - 1]] if first else []
    heads += [""] * (width - len(heads)) if first else []
    values = np.full((len(rows) - first, width), np.nan)
    for i, row in enumerate(rows[first:]):
        values[i, : len(row)] = [_cell(cell) for cell in row]
    strange = sum(isinstance(cell, str) and bool(cell.strip()) for row in rows[first:] for cell in row)
    if strange:
        notes.append(f"{strange} cells of the sheet are text where numbers are expected and became NaN")
    kept = [i for i in range(width) if not np.isnan(values[:, i]).all()]
    return [RawColumn(*(unit_of_heading(heads[i]) if heads else ("", None)), values[:, i]) for i in kept]


def _cell(cell: Any) -> float:
    value = number_in(cell) if is_plain_number(cell) else None
    return np.nan if value is None else value
