"""Text files: separator, decimal mark, headings and units are detected; inconsistencies are reported."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from stickslip.errors import InputError
from stickslip.records.columns_of_words import without_words
from stickslip.records.dialects import MOST_BAD, Dialect, heading_cells, sniffed
from stickslip.records.formats import formats_in_words
from stickslip.records.labview import with_its_header
from stickslip.records.raw import Column, Raw, unmarked
from stickslip.records.stamps import STAMP_UNIT, Stamped, stamped
from stickslip.records.tables_of_values import parse_json
from stickslip.units import heading, unit_of
from stickslip.unpacking import Allowance

Table = tuple[list[str], Stamped | None, Dialect, int]
_PREAMBLE = 20_000  # characters before the table that are kept


def decoded(data: bytes) -> str:
    """The text that the bytes hold; an error if they are none."""
    for mark, code in ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16")):
        if data.startswith(mark):
            try:
                return data.decode(code)
            except UnicodeDecodeError:
                break
    strange = len(data.translate(None, bytes(range(32, 256)) + b"\t\r\n\f\x1a"))
    if strange > 0.01 * len(data) + 2:
        raise InputError(
            "read", [f"the file is not text ({strange} control characters) and of no format known here; allowed are {formats_in_words()}"]
        )
    return unmarked(data)


def parse(data: bytes, separator: str | None = None, decimal: str | None = None) -> Raw:
    """The columns of a text file.

    Parameters
    ----------
    data : bytes
        The whole file.
    separator, decimal : str, optional
        Overrule what is found out.
    """
    text = decoded(data)
    if is_json(text):
        return parse_json(text, Allowance("read", len(data)))
    raw, lines = Raw("text", table=True), re.split(r"\r\n|\n|\r", text)  # and at no control character that damage may bring
    lines, times, dialect, first = _table(lines, separator, decimal, raw.notes)
    names = _headings(lines[:first], dialect, raw)
    values = _fast(lines[first:], dialect)
    values = _slow(lines[first:], first, dialect, raw.notes) if values is None else values
    raw.info["dialect"] = dialect.words
    if not text.endswith(("\n", "\r")) and text.strip():
        raw.notes.append("the last line does not end with a line break: if the file was cut short, its last number is cut too")
    raw.columns = [Column(*(names[i] if names else ("", None)), values[:, i]) for i in range(dialect.width)]
    if times is not None:
        _in_seconds(raw, times, len(dialect.cells(f"{times.before}0")) - 1)
    with_its_header(raw)
    return raw


def _table(lines: list[str], separator: str | None, decimal: str | None, notes: list[str]) -> Table:
    """The lines, timestamps as numbers, with their dialect and the first row of numbers; columns of words only if they can be read."""
    try:
        return _numbered(lines, separator, decimal, notes)
    except InputError as error:
        kept = without_words(lines, separator)
        if kept is None:
            raise error from None
        notes.append(f"{kept[1]}: words are not read")
        return _numbered(kept[0], separator, decimal, notes)


def _numbered(lines: list[str], separator: str | None, decimal: str | None, notes: list[str]) -> Table:
    times = stamped(lines)
    lines = lines if times is None else times.lines
    return lines, times, *sniffed(lines, separator, decimal, notes)


def _in_seconds(raw: Raw, times: Stamped, at: int) -> None:
    """The column of timestamps as seconds since the first; a column of dates beside it is gone."""
    if at >= len(raw.columns):
        return
    old = raw.columns[at]
    raw.columns[at] = Column(old.name or "time", "s", old.values * STAMP_UNIT)
    if times.dated:
        del raw.columns[at - 1]
    raw.notes.append(f"times are counted from the first timestamp, {times.begin}")


_JSON = re.compile(r"""\s*(\{\s*["}]|\[\s*[\[{"\]])""")
_NUMBERS = re.compile(r"\s*\[[\s\d,.eE+-]*\]\s*")


def is_json(text: str) -> bool:
    """Whether a text is an object or a list of JSON, whole or cut short; a heading in brackets, and a number in them, is neither."""
    return bool(_JSON.match(text) or _NUMBERS.fullmatch(text))


# ---- headings ----
def _headings(lines: list[str], dialect: Dialect, raw: Raw) -> list[tuple[str, str | None]] | None:
    """Names and units from the lines before the numbers; what else stands there is kept as text."""
    rows = [heading_cells(line, dialect) for line in lines if line.strip()]
    fitting = [row for row in rows if len(row) == dialect.width]
    rest = [line.strip() for line in lines if line.strip()]
    if not fitting or _of_other_columns(rows[-1], dialect):
        if rest:
            raw.info["preamble"] = "\n".join(rest)[:_PREAMBLE]
        return None
    last = fitting[-1]
    units = [unit_of(cell.strip("[]()")) for cell in last]
    known = [u is not None for u, cell in zip(units, last, strict=True) if cell]
    if len(fitting) > 1 and known and all(known) and not any(u is not None and u.text == "1" for u in units):
        names = fitting[-2]
        used = 2
        found = [(name, unit.text.strip("[]()") if unit else None) for name, unit in zip(names, units, strict=True)]
    else:
        used, found = 1, [heading(cell) for cell in last]
    if len(rest) > used:
        raw.info["preamble"] = "\n".join(rest[:-used])[:_PREAMBLE]
    return found


def _of_other_columns(row: list[str], dialect: Dialect) -> bool:
    """Whether the last line before the numbers names more or fewer columns, so that none before it names these."""
    return len(row) > 1 and len(row) != dialect.width and all(cell and dialect.number(cell) is None for cell in row)


# ---- numbers ----
_PLAIN = re.compile(r"[0-9eE+\-.,;\t \r\n]*")


def _fast(lines: list[str], dialect: Dialect) -> Any:
    """All rows at once, if every one of them is as expected and made of digits only."""
    text = "\n".join(lines)
    if (
        len(dialect.separator) != 1
        or not _PLAIN.fullmatch(text)
        or (dialect.decimal == "," and "." in text)
        or (dialect.decimal == "." and dialect.separator != "," and "," in text)
    ):
        return None
    plain = text.replace(",", ".") if dialect.decimal == "," else text
    try:
        values = np.loadtxt(plain.split("\n"), delimiter=None if dialect.separator == " " else dialect.separator, comments=None, ndmin=2)
    except ValueError:
        return None
    return values if values.shape[1] == dialect.width else None


def _slow(lines: list[str], first: int, dialect: Dialect, notes: list[str]) -> Any:
    """Row by row: short and long rows are left out, cells that are not numbers become NaN, and both are noted."""
    rows: list[list[float]] = []
    wrong: list[tuple[int, str]] = []
    strange: list[tuple[int, str]] = []
    for number, line in ((n, line) for n, line in enumerate(lines, first + 1) if line.strip()):
        cells = dialect.cells(line)
        if len(cells) != dialect.width:
            wrong.append((number, f"{len(cells)} of {dialect.width} cells"))
            continue
        values = [dialect.number(cell) for cell in cells]
        strange += [(number, cell) for cell, x in zip(cells, values, strict=True) if x is None]
        rows.append([np.nan if x is None else x for x in values])
    bad = len(wrong) + len({n for n, _ in strange})
    if bad > MOST_BAD * (len(rows) + len(wrong)) and bad > 1:
        raise InputError("read", [f"{bad} of {len(rows) + len(wrong)} lines are damaged, {_shown(wrong or strange)}; {_MIXED}"])
    if wrong:
        notes.append(f"{len(wrong)} lines are left out, {_shown(wrong)}")
    if strange:
        notes.append(f"{len(strange)} cells are not numbers and became NaN, {_shown(strange)}; {_MIXED}")
    return np.array(rows, float).reshape(-1, dialect.width)


_MIXED = 'if the decimal mark was taken for another, type ss.read(path, separator=";", decimal=",") with what the file uses'


def _shown(found: list[tuple[int, str]]) -> str:
    return f"the first is line {found[0][0]}: {found[0][1][:40]!r}"
