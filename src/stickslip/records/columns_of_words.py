"""Columns that are not numbers in tables of numbers, such as flags or the state of a logger: cells are judged by column."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from stickslip.records.dialects import SEPARATORS, Dialect, heading_cells
from stickslip.records.stamps import is_clock, is_date
from stickslip.records.text_lines import MOST_COLUMNS, TextLines

_SAMPLED = 400
_MOST = 0.9  # part of the rows in which a column of numbers holds numbers


@dataclass(frozen=True)
class LeftOut:
    """Columns that are not read, of a table with a known separator.

    Parameters
    ----------
    separator : str
    whole : int
        Columns in all.
    columns : tuple of int
    words : str
        Which they are, with the line and the cell of the first that is not a number.
    """

    separator: str
    whole: int
    columns: tuple[int, ...]
    words: str


def without_words(lines: TextLines, separator: str | None) -> LeftOut | None:
    """The columns of a table that do not hold numbers, beside some that do; None where there are none."""
    sampled = lines.sample(0, _SAMPLED)
    for mark in [separator] if separator else SEPARATORS.values():
        loose = Dialect(mark, ".", -1)
        parted = [loose.all_cells(line) for line in sampled]
        widths = Counter(map(len, parted))
        width = max(widths, key=lambda w: widths[w], default=1)
        rows = [row for row in parted if len(row) == width]
        if not 1 < width <= MOST_COLUMNS or len(rows) < _MOST * len(sampled):
            continue
        numbers = [_of_numbers([row[k] for row in rows]) for k in range(width)]
        clocks = [_part(is_clock, [row[k] for row in rows]) for k in range(width)]
        dates = [_part(is_date, [row[k] for row in rows]) and any(clocks[k + 1 : k + 2]) for k in range(width)]
        wrong = [k for k in range(width) if not (numbers[k] or clocks[k] or dates[k])]
        if wrong and sum(numbers) > 0:
            return LeftOut(mark, width, tuple(wrong), _in_words(lines, loose, width, wrong))
    return None


def _of_numbers(cells: list[str]) -> bool:
    """Whether the cells of a column are numbers, in one way or the other; a column of gaps is one of numbers where some are."""
    filled = [cell for cell in cells if cell]
    return any(sum(way.number(cell) is not None for cell in filled) >= _MOST * len(filled) for way in _WAYS) and bool(filled)


def _part(holds: object, cells: list[str]) -> bool:
    return sum(map(holds, cells)) >= _MOST * len(cells)  # type: ignore[call-overload]


_WAYS = (Dialect(";", ".", -1), Dialect(";", ",", -1))


def _in_words(lines: TextLines, loose: Dialect, width: int, wrong: Sequence[int]) -> str:
    """The names of columns that are left out, and the first cell that is not a number."""
    beginning = lines.part(0, lines.beginning(1000))
    rows = [(i, cells) for i, line in enumerate(beginning, 1) if len(cells := loose.all_cells(line)) == width]
    body = next((at for at, (_, cells) in enumerate(rows) if any(_is_number(c) for k, c in enumerate(cells) if k not in wrong)), 0)
    titles = heading_cells(beginning[rows[body - 1][0] - 1], Dialect(loose.separator, ".", width)) if body else []
    names = [titles[k] if k < len(titles) and titles[k] else f"number {k + 1}" for k in wrong]
    shown = ", ".join(names[:6]) + (", ..." if len(names) > 6 else "")
    line, cells = rows[body] if rows else (1, [""] * width)
    cell = next((cells[k] for k in wrong if cells[k] and not _is_number(cells[k])), cells[wrong[0]])
    where = f"line {beginning.number(line - 1)} has {cell[:40]!r}"
    return f"column{'s' * (len(names) > 1)} {shown} left out: {where}, which is not a number; words are not read"


def _is_number(cell: str) -> bool:
    return bool(cell) and re.search(r"\d", cell) is not None and any(way.number(cell.strip()) is not None for way in _WAYS)
