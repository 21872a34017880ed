"""Columns of words in tables of numbers, such as the state of a logger, which are left out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from stickslip.records.dialects import SEPARATORS, Dialect, heading_cells

_SAMPLED = 400
_MOST = 0.9  # part of the rows in which a column holds what it holds


def without_words(lines: list[str], separator: str | None) -> tuple[list[str], str] | None:
    """The lines of a table without the columns that hold words in nearly all rows, and which these are; None where there are none."""
    filled = [line for line in lines if line.strip()]
    sampled = filled[:: max(len(filled) // _SAMPLED, 1)]
    for mark in [separator] if separator else [mark for mark in SEPARATORS.values() if mark != " "]:
        widths = Counter(line.count(mark) + 1 for line in sampled)
        width = max(widths, key=lambda w: widths[w], default=1)
        rows = [line.split(mark) for line in sampled if line.count(mark) + 1 == width]
        words = [k for k in range(width) if _part(_is_word, [row[k] for row in rows]) >= _MOST]
        numbers = [k for k in range(width) if _part(_is_number, [row[k] for row in rows]) >= _MOST]
        if words and numbers and len(rows) >= _MOST * len(sampled):
            return _left_out(lines, mark, width, words)
    return None


def _left_out(lines: list[str], mark: str, width: int, words: list[int]) -> tuple[list[str], str]:
    parted = [line.split(mark) for line in lines]
    kept = [mark.join(c for k, c in enumerate(row) if k not in words) if len(row) == width else mark.join(row) for row in parted]
    title = next((row for row in parted if len(row) == width), [""] * width)
    cells = heading_cells(mark.join(title), Dialect(mark, ".", width))
    names = [cells[k] if k < len(cells) and cells[k] != "" else f"number {k + 1}" for k in words]
    return kept, f"column{'s' * (len(names) > 1)} {', '.join(names)} left out"


def _part(holds: Callable[[str], bool], cells: list[str]) -> float:
    return sum(map(holds, cells)) / max(len(cells), 1)


_WAYS = (Dialect(";", ".", -1), Dialect(";", ",", -1))


def _is_number(cell: str) -> bool:
    return any(way.number(cell.strip()) is not None for way in _WAYS)


def _is_word(cell: str) -> bool:
    """Whether a cell holds letters and no number: no time of day, no date."""
    return not _is_number(cell) and any(c.isalpha() for c in cell) and not any(c.isdigit() for c in cell)
