"""Long tables within a JSON text, read a piece at a time: only some of their rows are objects at once.

A row as an object of Python takes some thirty times the memory of its text. A table may be the text itself, or stand within objects: a list
of rows or of numbers, an object of rows or of numbers by the row's name, or an object on each line. What is no long table is read as it is.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Any

from stickslip.records.rows_of_values import ByName, Numbers, Rows, labels_a_row
from stickslip.records.text_lines import TextLines, check_columns

_TOGETHER, _PIECE = 4096, 1 << 17  # lines of JSON, and characters of a table, that are objects at once
_DEEPEST = 8  # objects within one another in which tables are looked for
_SPACE = re.compile(r"[ \t\r\n]*")
_KEY = re.compile(r'[ \t\r\n]*("(?:[^"\\]|\\.)*+")[ \t\r\n]*:[ \t\r\n]*')
_LIST, _FLAT = re.compile(r"\[[ \t\r\n]*(?=[\[{])"), re.compile(r"\[[ \t\r\n]*(?=[\dnN.-])")
_COMMA = re.compile(r"(?<=[\dlNy])[ \t\r\n]*,")
_NAMED = re.compile(r'\{[ \t\r\n]*(?="([^"\\]*)"[ \t\r\n]*:[ \t\r\n]*([{\dnN.-]))')
_BETWEEN_ROWS = {"{": re.compile(r"\}[ \t\r\n]*,[ \t\r\n]*(?=\{)"), "[": re.compile(r"\][ \t\r\n]*,[ \t\r\n]*(?=\[)")}
_BETWEEN_NAMED = {
    "{": re.compile(r'\}[ \t\r\n]*,[ \t\r\n]*(?=")'), "": re.compile(r'(?<=[\dlNy])[ \t\r\n]*,[ \t\r\n]*(?=")'),
}  # fmt: skip
_DECODER = json.JSONDecoder()


def in_pieces(text: str) -> Any:
    """What a JSON text holds, with long tables as columns or arrays; `ValueError` where it is none."""
    value, end = _value(text, _after_space(text, 0), _DEEPEST)
    if _after_space(text, end) < len(text):
        raise ValueError("the text goes on after its table")
    return value


def of_lines(lines: TextLines) -> ByName | None:
    """The columns of a text with an object on each line; what a row does not have is missing. None for a text of one line."""
    rows = Rows()
    for begin in range(0, len(lines), _TOGETHER):
        some = [part for line in lines.part(begin, begin + _TOGETHER) if (part := line.strip())]
        together = all(line[0] == "{" and line[-1] == "}" for line in some)  # many times faster than one by one
        values_of_rows = json.loads(f"[{','.join(some)}]") if together else [json.loads(line) for line in some]
        if len(values_of_rows) != len(some):
            raise ValueError
        rows.add(values_of_rows)
    return rows.columns()


def _after_space(text: str, at: int) -> int:
    space = _SPACE.match(text, at)
    return at if space is None else space.end()


def _value(text: str, at: int, depth: int) -> tuple[Any, int]:
    """The value that begins at a place, and where it ends."""
    if len(text) - at >= 2 * _PIECE:
        if (opening := _LIST.match(text, at)) is not None:
            return _rows(text, at, opening.end())
        if (opening := _NAMED.match(text, at)) is not None and labels_a_row(opening[1]):
            return _named(text, at, opening.end(), opening[2])
        if depth < _DEEPEST and (opening := _FLAT.match(text, at)) is not None:
            return _numbers(text, at, opening.end())
        if text[at : at + 1] == "{" and depth:
            return _members(text, at, depth)
    return _DECODER.raw_decode(text, at)


def _members(text: str, at: int, depth: int) -> tuple[dict[str, Any], int]:
    """An object of few members, each of which may be a long table."""
    members, cursor = dict[str, Any](), at + 1
    while (key := _KEY.match(text, cursor)) is not None:
        members[json.loads(key[1])], cursor = _value(text, key.end(), depth - 1)
        cursor = _after_space(text, cursor)
        if text[cursor : cursor + 1] != ",":
            break
        cursor += 1
        check_columns(len(members), "the JSON")
    if text[cursor : cursor + 1] != "}" or text[cursor - 1] == ",":
        raise json.JSONDecodeError("Expecting ',' delimiter", text, cursor)
    return members, cursor + 1


def _rows(text: str, at: int, first: int) -> tuple[Any, int]:
    """The columns of a list of rows; the list itself where these do not make up a table."""
    rows = Rows()
    try:
        end = _taken(text, first, "[]", _BETWEEN_ROWS[text[first]], rows.add)
        columns = rows.columns()
    except ValueError:  # a seam within a row or a text, or damage, of which the whole says more
        columns = None
    return _DECODER.raw_decode(text, at) if columns is None else (columns, end)


def _numbers(text: str, at: int, first: int) -> tuple[Any, int]:
    """A list of numbers as an array; the list where others are among them."""
    numbers = Numbers()
    try:
        end = _taken(text, first, "[]", _COMMA, numbers.add)
    except ValueError:
        return _DECODER.raw_decode(text, at)
    return numbers.values(), end


def _named(text: str, at: int, first: int, begins: str) -> tuple[Any, int]:
    """The columns of an object of rows, or the values of one of numbers, by the names of rows; the object where there are others."""
    rows, numbers = Rows(), Numbers()

    def add(some: dict[str, Any]) -> None:
        if not all(map(labels_a_row, some)):
            raise ValueError("names of no rows")
        (rows if begins == "{" else numbers).add(list(some.values()))

    try:
        end = _taken(text, first, "{}", _BETWEEN_NAMED["{" if begins == "{" else ""], add)
        values: Any = rows.columns() if begins == "{" else numbers.values()
    except ValueError:
        values = None
    return _DECODER.raw_decode(text, at) if values is None else (values, end)


def _taken(text: str, cursor: int, brackets: str, seam: re.Pattern[str], add: Callable[[Any], None]) -> int:
    """Give the members of a list or an object to a function, some at a time; where it ends. A seam is one where they are JSON before it."""
    while True:
        between = seam.search(text, cursor + _PIECE)
        stop = len(text) if between is None else between.start() + (text[between.start()] in "}]")
        piece = f"{brackets[0]}{text[cursor:stop]}{brackets[1]}"
        some, end = _DECODER.raw_decode(piece)
        add(some)
        if end < len(piece):  # the list ends here, and the text goes on
            return cursor + end - 1
        if between is None:
            raise ValueError("it has no end")
        cursor = between.end()
