"""Text files: separator, decimal mark, headings and units are detected; inconsistencies are reported."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.units import unit_named, unit_of_heading
from stickslip.basics.unpacking import Allowance
from stickslip.records.columns_of_words import LeftOut, without_words
from stickslip.records.dialects import MISSING, MOST_BAD, Dialect, heading_cells, sniffed
from stickslip.records.formats import formats_in_words
from stickslip.records.labview import with_its_header
from stickslip.records.raw import Raw, RawColumn, unmarked
from stickslip.records.stamped_lines import Stamped, stamped
from stickslip.records.stamps import STAMP_UNIT
from stickslip.records.tables_of_values import parse_json
from stickslip.records.text_lines import MOST_NUMBER, TextLines

Table = tuple[TextLines, Stamped | None, Dialect, int]
_PREAMBLE = 20_000  # characters before the table that are kept


_MARK = b"\xef\xbb\xbf"  # of bytes that are UTF-8, or were until another program added some that are not


def decoded(data: bytes) -> str:
    """The text that the bytes hold; an error if they are none."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return data[: len(data) // 2 * 2].decode("utf-16", "replace")
    while data.startswith(_MARK):  # once, or again where a file was saved by another program
        data = data[len(_MARK) :]
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
    lines = TextLines.of_text(text)  # they end at line breaks, and at no control character that damage may bring
    del text
    lines.check()
    _check_quotes(lines)
    lines, times, dialect, first = _table(lines, separator, decimal, raw.notes)
    names = _headings(lines[:first], dialect, raw)
    body = lines.from_line(first)
    values = _values(body, dialect, raw.notes)
    raw.info["dialect"] = dialect.words
    if not ended:
        raw.notes.append("the last line does not end with a line break: if the file was cut short, its last number is cut too")
    raw.columns = [RawColumn(*(names[i] if names else ("", None)), values[:, i]) for i in range(dialect.width)]
    if times is not None:
        at = len(dialect.all_cells(f"{times.before}0")) - 1
        _in_seconds(raw, times, at - sum(k < at for k in dialect.left_out))
    with_its_header(raw)
    return raw


def _table(lines: TextLines, separator: str | None, decimal: str | None, notes: list[str]) -> Table:
    """The lines, timestamps as numbers, with their dialect and the first row of numbers; columns of words only if they can be read."""
    try:
        return _numbered(lines, separator, decimal, notes, None)
    except InputError as error:
        left = without_words(lines, separator)
        if left is None:
            raise error from None
        notes.append(left.words)
        return _numbered(lines, left.separator, decimal, notes, left)


def _numbered(lines: TextLines, separator: str | None, decimal: str | None, notes: list[str], left: LeftOut | None) -> Table:
    times = stamped(lines, words=left is not None)
    lines = lines if times is None else times.lines
    more = () if left is None else (left.columns, left.whole)
    return lines, times, *sniffed(lines, separator, decimal, notes, *more)


def _in_seconds(raw: Raw, times: Stamped, at: int) -> None:
    """The column of timestamps as seconds since the first; a column of dates beside it is gone."""
    if at >= len(raw.columns):
        return
    old = raw.columns[at]
    raw.columns[at] = RawColumn(old.name or "time", "s", old.values * STAMP_UNIT)
    if times.dated:
        del raw.columns[at - 1]
    raw.notes.append(f"times are counted from the first timestamp, {times.begin}")


_JSON = re.compile(r"""\s*(\{\s*["}]|\[\s*[\[{"\]])""")
_NUMBERS = re.compile(r"\s*\[[\s\d,.eE+-]*\]\s*", re.A)


def is_json(text: str) -> bool:
    """Whether a text is an object or a list of JSON, whole or cut short; a heading in brackets, and a number in them, is neither."""
    return bool(_JSON.match(text) or _NUMBERS.fullmatch(text))


_OPEN = re.compile(r'(?:^|[,;\t])[ ]*"[^"]*$')


def _check_quotes(lines: TextLines) -> None:
    """Raise an `InputError` where lines open quotes that they do not close; a damaged line or a heading may."""
    sample = lines.sample(0, 400)
    opened = [line for line in sample if line.count('"') % 2 and _OPEN.search(line)]
    if len(opened) > MOST_BAD * len(sample) + 3:
        why = f"{len(opened)} of {len(sample)} lines open a quote that they do not close, such as {opened[0][:40]!r}"
        raise InputError("read", [f"{why}; a table has a whole row on each line: export it again"])


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
    units = [unit_named(cell.strip("[]()")) for cell in last]
    known = [u is not None for u, cell in zip(units, last, strict=True) if cell]
    if len(fitting) > 1 and known and all(known) and not any(u is not None and u.text == "1" for u in units):
        names = fitting[-2]
        used = 2
        headings = [(name, unit.text.strip("[]()") if unit else None) for name, unit in zip(names, units, strict=True)]
    else:
        used, headings = 1, [unit_of_heading(cell) for cell in last]
    if len(rest) > used:
        raw.info["preamble"] = "\n".join(rest[:-used])[:_PREAMBLE]
    return headings


def _of_other_columns(row: list[str], dialect: Dialect) -> bool:
    """Whether the last line before the numbers names more or fewer columns, so that none before it names these."""
    return len(row) > 1 and len(row) != dialect.width and all(cell and dialect.number(cell) is None for cell in row)


# ---- numbers ----
_PLAIN = b"0123456789eE+-.,;\t \nnNaAiIfFtTyY"  # with the letters of nan and inf
_DIGITS = re.compile(rb"(?<!\d)\d{%d}" % MOST_NUMBER)
_ASCII = bytes(i if 32 <= i < 127 or i in b"\t\n" else ord("?") for i in range(256))
_BLANK_LINES = re.compile(rb"^[ \t]+$", re.MULTILINE)
_EXPONENTS = re.compile(rb"(?<=[\d.])d(?=[+-]?\d)")
_TOGETHER = 16384  # lines that are read at once


def _values(lines: TextLines, dialect: Dialect, notes: list[str]) -> Any:
    """All rows: short and long ones are left out, cells that are not numbers become NaN, and both are noted."""
    most = min(len(lines), lines.size // max(dialect.width - 1, 1) + 1)  # rows: each has a separator between two cells
    values, filled = np.empty((most, dialect.width)), 0
    wrong: list[tuple[int, str]] = []
    strange: list[tuple[int, str]] = []
    damaged, counted, number_of, plain = 0, 0, _Numbers(dialect), _Plain(dialect)
    for begin in range(0, len(lines), _TOGETHER):
        some = lines.part(begin, begin + _TOGETHER)
        data = some.data
        if not data.strip():
            continue
        read = plain.all_rows(data)
        if read is not None:
            counted += len(read)
            values[filled : filled + len(read)] = read
            filled += len(read)
            continue
        which, read = plain.rows(data)
        simple = dialect.decimal == "." and not dialect.grouped and data.isascii() and b"_" not in data
        left = np.ones(len(some), bool)
        left[which] = False
        places, rows = [], []
        for at in np.flatnonzero(left).tolist():
            line, number = some[at], some.number(at)
            if not line.strip():
                continue
            if (bad := len(wrong) + damaged) > MOST_BAD * len(lines) + 1:
                raise InputError("read", [f"more than {bad} of {len(lines)} lines are damaged, {_shown(wrong or strange)}; {_MIXED}"])
            cells = dialect.cells(line)
            if len(cells) != dialect.width:
                wrong.append((number, f"{len(dialect.all_cells(line))} of {max(dialect.width, dialect.whole)} cells"))
                continue
            places.append(at)
            try:
                if not simple or len(line) > MOST_NUMBER:
                    raise ValueError
                rows.append([*map(float, cells)])  # of a plain text it takes what a dialect takes, and faster
            except ValueError:
                numbers = [number_of[cell] for cell in cells]
                if None in numbers:
                    damaged += 1
                    strange += [(number, cell[:41]) for cell, x in zip(cells, numbers, strict=True) if x is None]
                rows.append([np.nan if x is None else x for x in numbers])
        counted += len(which) + len(rows)
        order = np.argsort(np.concatenate([which, np.array(places, int)]), kind="stable")
        values[filled : filled + len(order)] = np.concatenate([read, np.array(rows, float).reshape(-1, dialect.width)])[order]
        filled += len(order)
    bad = len(wrong) + damaged
    if bad > MOST_BAD * (counted + len(wrong)) and bad > 1:
        raise InputError("read", [f"{bad} of {counted + len(wrong)} lines are damaged, {_shown(wrong or strange)}; {_MIXED}"])
    if wrong:
        notes.append(f"{len(wrong)} lines are left out, {_shown(wrong)}")
    if strange:
        notes.append(f"{len(strange)} cells are not numbers and became NaN, {_shown(strange)}; {_MIXED}")
    return values[:filled]


class _Plain:
    """Rows as they are in almost all files: digits between separators, and NaN where a cell is missing; many are read at once."""

    def __init__(self, dialect: Dialect):
        self._dialect = dialect
        self._able = len(dialect.separator) == 1 and dialect.separator != dialect.decimal
        whole = dialect.whole if dialect.left_out else dialect.width
        self._used = [k for k in range(whole) if k not in dialect.left_out] if dialect.left_out else None
        blank = b" \t" if dialect.separator in " ;," else b" "
        number = rb"[+-]?+(?:\d{1,%d}+(?:\.\d*+)?+|\.\d++)(?:e[+-]?+\d++)?+" % MOST_NUMBER
        mark = re.escape(dialect.separator.encode())
        number = rb"(?:%s|nan|[+-]?+inf)" % number
        if dialect.separator == " ":
            cells, word, between, edge = number, rb'[^ \t\n"]++', rb"[ \t]++", rb"[ \t]*+"
        else:
            cells = rb'(?:"%s"|[%s]*+%s[%s]*+)' % (number, blank, number, blank)
            word, between, edge = rb'(?:"[^"\n]*+(?:""[^"\n]*+)*+"|[^"\n%s]*+)' % mark, mark, b""
        kinds = [word if k in dialect.left_out else cells for k in range(max(whole, 1))] if self._able else [b""]
        self._row = re.compile(rb"^%s%s%s$" % (edge, between.join(kinds), edge), re.MULTILINE)

    def all_rows(self, data: bytes) -> Any:
        """The rows of some lines, if all are made of digits only; else None."""
        dialect = self._dialect
        if (
            not self._able
            or self._used
            or data.translate(None, _PLAIN)
            or (dialect.decimal == "," and b"." in data)
            or (dialect.decimal == "." and dialect.separator != "," and b"," in data)
            or _DIGITS.search(data)
        ):
            return None
        return self._loaded(data.replace(b",", b".") if dialect.decimal == "," else data)

    def rows(self, data: bytes) -> tuple[Any, Any]:
        """Which of some lines are plain, and their rows."""
        nothing = np.empty(0, int), np.empty((0, self._dialect.width))
        if not self._able:
            return nothing
        data = self._prepared(data)
        if not (self._used or data.translate(None, _PLAIN) or _DIGITS.search(data) or b"\n\n" in data):
            read, count = self._loaded(data), data.count(b"\n") + 1
            if read is not None and len(read) == count:  # only numbers were missing
                return np.arange(count), read
        plain = list(self._row.finditer(data))
        if not plain:
            return nothing
        read = self._loaded(b"\n".join([match[0] for match in plain]))
        if read is None or len(read) != len(plain):
            return nothing
        ends = np.flatnonzero(np.frombuffer(data, np.uint8) == ord("\n"))
        return np.searchsorted(ends, [match.start() for match in plain]), read

    def _prepared(self, data: bytes) -> bytes:
        """The same lines, with points as decimal marks and NaN for what is missing."""
        mark = self._dialect.separator.encode()
        data = b"\n%s\n" % data.translate(_ASCII).lower()
        if self._dialect.decimal == ",":
            data = data.replace(b".", b"?").replace(b",", b".")
        if b"d" in data and not self._used:
            data = _EXPONENTS.sub(b"e", data)
        if mark == b" ":
            return data[1:-1]
        data = data.replace(mark + b' "', mark + b'"')
        if mark == b"\t":
            data = _BLANK_LINES.sub(b"", data)  # they are no rows of missing numbers
        words = [word.encode().replace(b",", b".") for word in MISSING if word != "nan"]
        for word in [*words, *(b'"%s"' % word for word in words if word or b'""' in data)]:
            if word in data:
                data = data.replace(mark + word + mark, mark + b"nan" + mark).replace(mark + word + mark, mark + b"nan" + mark)
                data = data.replace(mark + word + b"\n", mark + b"nan\n").replace(b"\n" + word + mark, b"\nnan" + mark)
        return data[1:-1]

    def _loaded(self, data: bytes) -> Any:
        delimiter, quote = None if self._dialect.separator == " " else self._dialect.separator, '"' if b'"' in data else None
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                values = np.loadtxt(
                    io.BytesIO(data), delimiter=delimiter, comments=None, ndmin=2, usecols=self._used, encoding="latin-1", quotechar=quote
                )
        except (ValueError, UserWarning):
            return None
        return values if values.shape[1] == self._dialect.width else None


_ROWS = 65536  # texts of cells that are remembered


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


def _shown(lines: list[tuple[int, str]]) -> str:
    return f"the first is line {lines[0][0]}: {lines[0][1][:40]!r}"
