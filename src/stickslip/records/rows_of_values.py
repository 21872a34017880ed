"""Rows and numbers of Python, which come some at a time, as columns."""

from __future__ import annotations

import contextlib
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.records.stamps import nanoseconds
from stickslip.records.text_lines import check_columns

FORMS = (
    'allowed are [{"t [s]": 0.0, "v [mm/s]": 1.0}, ...], {"t [s]": [...], "v [mm/s]": [...]}, '
    '{"columns": [...], "data": [[...], ...]} and one object a line'
)


class ByName(dict[str, Any]):
    """Columns by name that were rows: arrays of numbers, or lists of whatever they hold."""


class Rows:
    """Rows, which come some at a time, as columns."""

    def __init__(self) -> None:
        self._parts: dict[str, list[Any]] = {}
        self._sizes: dict[str, int] = {}
        self._count = self._given = 0

    def add(self, rows: list[Any]) -> None:
        """Rows that follow: objects, or lists that are as long as those before; `ValueError` where these are not."""
        if not rows:
            return
        if self._parts and isinstance(rows[0], list):
            names, added = list(self._parts), rows
            if not all(isinstance(row, list) and len(row) == len(names) for row in rows):
                raise ValueError("rows of different lengths")
        else:
            names, added = rows_of(rows)
        self._given += sum(map(len, rows))
        width = len({*self._parts, *names})
        check_columns(width, "the JSON")
        _check_filled(self._given, width, max(self._count + len(added), 1))
        for name, values in by_column(names, added).items():
            self._fill(name)
            numbers = array_of(values)
            self._parts[name].append(values if numbers is None else numbers)
            self._sizes[name] += len(values)
        self._count += len(added)

    def _fill(self, name: str) -> None:
        """What the rows so far do not have in a column is missing."""
        parts, size = self._parts.setdefault(name, []), self._sizes.get(name, 0)
        if size < self._count:
            parts.append(np.full(self._count - size, np.nan))
        self._sizes[name] = self._count

    def columns(self) -> ByName | None:
        """The columns, if there is more than one row."""
        columns = ByName()
        for name in self._parts:
            self._fill(name)
            parts, self._parts[name] = self._parts[name], []
            numbers = all(isinstance(part, np.ndarray) for part in parts)
            columns[name] = (
                np.concatenate(parts) if numbers else [x for part in parts for x in (part if type(part) is list else part.tolist())]
            )
        return columns if self._count > 1 else None


class Numbers:
    """Numbers, which come some at a time, as an array."""

    def __init__(self) -> None:
        self._parts: list[Array] = []

    def add(self, some: list[Any]) -> None:
        """Numbers that follow; `ValueError` where others are among them."""
        array = array_of(some)
        if array is None:
            raise ValueError("values that are no numbers")
        self._parts.append(array)

    def values(self) -> Array:
        """All of them."""
        parts, self._parts = self._parts, []
        return np.concatenate(parts)


def rows_of(rows: list[Any]) -> tuple[list[str], list[Any]]:
    """Names and rows of a list of objects or lists; what a row does not have is missing."""
    if rows and all(isinstance(row, dict) for row in rows):
        names = list(dict.fromkeys(name for row in rows for name in row))
        check_columns(len(names), "the JSON")
        _check_filled(sum(map(len, rows)), len(names), len(rows))
        return names, [[row.get(name) for name in names] for row in rows]
    if rows and all(isinstance(row, list) for row in rows):
        head = rows[0] if rows[0] and all(isinstance(cell, str) for cell in rows[0]) else None
        check_columns(width := max(map(len, rows)), "the JSON")
        return (list(head) if head else numbered(width)), rows[1:] if head else rows
    raise InputError("read", [f"the JSON is a list of {type(rows[0]).__name__ if rows else 'nothing'}; {FORMS}"])


def _check_filled(given: int, columns: int, rows: int) -> None:
    """Raise an `InputError` for rows that name so different columns that the table is empty but for a few cells."""
    if columns * rows > 20 * given + 1_000_000:
        raise InputError(
            "read", [f"the rows of the JSON name {columns} columns and {given / rows:.3g} each: no table is as empty; {FORMS}"]
        )


def numbered(count: int) -> list[str]:
    """Names of columns that have none."""
    return [f"column {i + 1}" for i in range(count)]


def of_other_length(count: int) -> InputError:
    """The error of rows that do not have as many values as there are columns."""
    return InputError("read", [f"rows of the JSON have not {count} values each, as its columns are; {FORMS}"])


def by_column(names: list[str], rows: list[Any]) -> dict[str, Any]:
    """Lists by name of a table by rows."""
    if not all(isinstance(row, list) and len(row) == len(names) for row in rows):
        raise of_other_length(len(names))
    return {name: [row[i] for row in rows] for i, name in enumerate(names)}


def labels_a_row(name: str) -> bool:
    """Whether the name within an object counts rows, or tells their times."""
    return name.lstrip("-").isdigit() or nanoseconds(name) is not None


def array_of(values: Any) -> Any:
    """Values as an array where all are numbers of JSON, or are missing; else None."""
    if isinstance(values, np.ndarray):
        return values
    if _NUMBERS.issuperset(map(type, values)):
        with contextlib.suppress(OverflowError):  # of hundreds of digits
            return np.array(values, float)
    return None


_NUMBERS = {int, float, type(None)}
