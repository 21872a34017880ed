"""Text files: separator, decimal mark, headings and units are detected; inconsistencies are reported."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.units import heading, unit_of
from stickslip.basics.unpacking import Allowance
from stickslip.records.columns_of_words import LeftOut, without_words
from stickslip.records.dialects import MOST_BAD, Dialect, heading_cells, sniffed
from stickslip.records.formats import formats_in_words
from stickslip.records.labview import with_its_header
from stickslip.records.raw import Column, Raw, unmarked
from stickslip.records.stamps import STAMP_UNIT, Stamped, stamped
from stickslip.records.tables_of_values import parse_json
from stickslip.records.text_lines import MOST_NUMBER, Lines

Table = tuple[Lines, Stamped | None, Dialect, int]
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
    raw, ended = Raw("text", table=True), text.endswith(("\n", "\r")) or not text.strip()
    lines = Lines.of_text(text)  # they end at line breaks, and at no control character that damage may bring
    del text
    lines.check()
    lines, times, dialect, first = _table(lines, separator, decimal, raw.notes)
    names = _headings(lines[:first], dialect, raw)
    body = lines.from_line(first)
    values = _fast(body, dialect)
    values = _slow(body, first, dialect, raw.notes) if values is None else values
    raw.info["dialect"] = dialect.words
    if not ended:
        raw.notes.append("the last line does not end with a line break: if the file was cut short, its last number is cut too")
    raw.columns = [Column(*(names[i] if names else ("", None)), values[:, i]) for i in range(dialect.width)]
    if times is not None:
        at = len(dialect.all_cells(f"{times.before}0")) - 1
        _in_seconds(raw, times, at - sum(k < at for k in dialect.left_out))
    with_its_header(raw)
    return raw


def _table(lines: Lines, separator: str | None, decimal: str | None, notes: list[str]) -> Table:
    """The lines, timestamps as numbers, with their dialect and the first row of numbers; columns of words only if they can be read."""
    try:
        return _numbered(lines, separator, decimal, notes, None)
    except InputError as error:
        left = without_words(lines, separator)
        if left is None:
            raise error from None
        notes.append(left.words)
        return _numbered(lines, left.separator, decimal, notes, left)


def _numbered(lines: Lines, separator: str | None, decimal: str | None, notes: list[str], left: LeftOut | None) -> Table:
    times = stamped(lines, words=left is not None)
    lines = lines if times is None else times.lines
    more = () if left is None else (left.columns, left.whole)
    return lines, times, *sniffed(lines, separator, decimal, notes, *more)


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
_NUMBERS = re.compile(r"\s*\[[\s\d,.eE+-]*\]\s*", re.A)


def is_json(text: str) -> bool:
    """Whether a text is an object or a list of JSON, whole or cut short; a heading in brackets, and a number in them, is neither."""
    return bool(_JSON.match(text) or _NUMBERS.fullmatch(text))


# ---- headings ----
def _headings(lines: Sequence[str], dialect: Dialect, raw: Raw) -> list[tuple[str, str | None]] | None:
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
_PLAIN = b"0123456789eE+-.,;\t \nnNaAiIfFtTyY"  # with the letters of nan and inf
_DIGITS = re.compile(rb"(?<!\d)\d{%d}" % MOST_NUMBER)


def _fast(lines: Lines, dialect: Dialect) -> Any:
    """All rows at once, if every one of them is as expected and made of digits only, but for columns that are left out."""
    data = lines.data
    if b'"' in data and not dialect.left_out and len(dialect.separator) == 1:
        if not (_even(data, ord('"'))) or not _same_width(data, dialect, dialect.width):
            return None
        data = data.replace(b'"', b"")  # no separator stands within them
    strange = data.translate(None, _PLAIN)
    if (
        len(dialect.separator) != 1
        or (strange and (not dialect.left_out or b'"' in strange or not data.isascii()))
        or (dialect.decimal == "," and b"." in data)
        or (dialect.decimal == "." and dialect.separator != "," and b"," in data)
        or _DIGITS.search(data)
        or (dialect.left_out and not _same_width(data, dialect, dialect.whole))
    ):
        return None
    del strange
    plain = data.replace(b",", b".") if dialect.decimal == "," else data
    used = [k for k in range(dialect.whole) if k not in dialect.left_out] if dialect.left_out else None
    delimiter = None if dialect.separator == " " else dialect.separator
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            values = np.loadtxt(io.BytesIO(plain), delimiter=delimiter, comments=None, ndmin=2, usecols=used, encoding="latin-1")
    except (ValueError, UserWarning):
        return None
    return values if values.shape[1] == dialect.width else None


def _same_width(data: bytes, dialect: Dialect, width: int) -> bool:
    """Whether every line that is not empty has so many cells."""
    if dialect.separator == " ":
        return False
    counts = _in_each_line(data, ord(dialect.separator))
    return bool(np.all((counts == width - 1) | (counts == 0)))


def _even(data: bytes, letter: int) -> bool:
    """Whether every line has an even number of a letter."""
    return not (_in_each_line(data, letter) % 2).any()


def _in_each_line(data: bytes, letter: int) -> Any:
    """How often a letter stands in each line."""
    letters = np.frombuffer(data, np.uint8)
    starts = np.concatenate([[0], np.flatnonzero(letters == ord("\n")) + 1])
    return np.add.reduceat(letters == letter, starts[starts < len(letters)], dtype=np.int32)


_TOGETHER = 4096  # lines, one of which is wrong, that are read one by one
_ROWS = 65536  # rows that are lists before they become an array


def _slow(lines: Lines, first: int, dialect: Dialect, notes: list[str]) -> Any:
    """Row by row: short and long rows are left out, cells that are not numbers become NaN, and both are noted."""
    parts: list[Any] = []
    rows: list[float] = []
    wrong: list[tuple[int, str]] = []
    strange: list[tuple[int, str]] = []
    damaged, counted, number_of = 0, 0, _Numbers(dialect)
    plain = dialect.decimal == "." and not dialect.grouped and lines.data.isascii() and b"_" not in lines.data
    for begin in range(0, len(lines), _TOGETHER):
        some = lines.part(begin, begin + _TOGETHER)
        if (read := _fast(some, dialect)) is not None:
            counted += len(read)
            parts += [np.array(rows, float), read.ravel()]
            rows = []
            continue
        for number, line in enumerate(some, first + begin + 1):
            if not line.strip():
                continue
            if (bad := len(wrong) + damaged) > MOST_BAD * len(lines) + 1:
                raise InputError("read", [f"more than {bad} of {len(lines)} lines are damaged, {_shown(wrong or strange)}; {_MIXED}"])
            cells = dialect.cells(line)
            if len(cells) != dialect.width:
                wrong.append((number, f"{len(cells)} of {dialect.width} cells"))
                continue
            counted += 1
            try:
                if not plain or len(line) > MOST_NUMBER:
                    raise ValueError
                rows += [*map(float, cells)]  # of a plain text it takes what a dialect takes, and faster
            except ValueError:
                values = [number_of[cell] for cell in cells]
                if None in values:
                    damaged += 1
                    strange += [(number, cell[:41]) for cell, x in zip(cells, values, strict=True) if x is None]
                rows += [np.nan if x is None else x for x in values]
            if len(rows) > _ROWS:
                parts.append(np.array(rows, float))
                rows = []
    bad = len(wrong) + damaged
    if bad > MOST_BAD * (counted + len(wrong)) and bad > 1:
        raise InputError("read", [f"{bad} of {counted + len(wrong)} lines are damaged, {_shown(wrong or strange)}; {_MIXED}"])
    if wrong:
        notes.append(f"{len(wrong)} lines are left out, {_shown(wrong)}")
    if strange:
        notes.append(f"{len(strange)} cells are not numbers and became NaN, {_shown(strange)}; {_MIXED}")
    return np.concatenate([*parts, np.array(rows, float)]).reshape(-1, dialect.width)


class _Numbers(dict[str, float | None]):
    """The numbers in cells; each text is looked at once."""

    def __init__(self, dialect: Dialect):
        super().__init__()
        self._dialect = dialect

    def __missing__(self, cell: str) -> float | None:
        value = self._dialect.number(cell)
        if len(self) > _ROWS:
            self.clear()
        self[cell] = value
        return value


_MIXED = 'if the decimal mark was taken for another, type ss.read(path, separator=";", decimal=",") with what the file uses'


def _shown(found: list[tuple[int, str]]) -> str:
    return f"the first is line {found[0][0]}: {found[0][1][:40]!r}"
