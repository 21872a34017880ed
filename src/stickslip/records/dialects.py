"""Which separator and which decimal mark a text file uses. What numbers and headings leave open is an error that shows what to type."""

from __future__ import annotations

import csv
import dataclasses
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.units import unit_named, unit_of_heading
from stickslip.records.text_lines import MOST_NUMBER, MOST_PREAMBLE, TextLines, check_columns

_NUMBER = {
    ".": re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eEdD][+-]?\d+)?"),
    ",": re.compile(r"[+-]?(?:\d*,\d+|\d+)(?:[eEdD][+-]?\d+)?"),
}
#: Numbers with marks between thousands; understood only where the user has typed the decimal mark.
_GROUPED = {
    ".": re.compile(r"[+-]?\d{1,3}(?:[, ']\d{3})+(?:\.\d*)?"),
    ",": re.compile(r"[+-]?\d{1,3}(?:[. ']\d{3})+(?:,\d*)?"),
}
#: What stands in a cell without a number.
MISSING = {"", "nan", "-nan", "+nan", "na", "n/a", "#n/a", "-", "--", "null", "none", "nan(ind)", "-nan(ind)"}
_INFINITE = {"inf": np.inf, "+inf": np.inf, "-inf": -np.inf, "infinity": np.inf, "-infinity": -np.inf}
_NO_COLUMN = ("", "Comment")  # last headings without a column: LabVIEW names its comments, of which most rows have none
_BLANK = " \t\f\xa0\x1a"
_EXPONENT = str.maketrans("dD", "ee")
SEPARATORS = {"tab": "\t", "semicolon": ";", "comma": ",", "space": " "}
#: A file with more than this part of damaged rows is refused.
MOST_BAD = 0.1
_SAMPLED = 400
_PREAMBLE = 1000  # lines that may stand before the numbers
_FIGURES = re.compile(r"[0-9eE+\-.,;\t \r\n]*")
_COMMA_TOKEN = re.compile(r"(?<![\d,.])[+-]?(\d*),(\d+)(?![\d,])([eEdD]?)")
_POINT_TOKEN = re.compile(r"(?<![\d,.])[+-]?(\d*)\.(\d*)(?![\d.])([eEdD]?)")


@dataclass(frozen=True)
class Dialect:
    """How a text file writes its numbers.

    Parameters
    ----------
    separator, decimal : str
    width : int
        Numbers in a row.
    grouped : bool
        Whether thousands may be marked: with the other mark, a blank or an apostrophe.
    left_out : tuple of int
        Columns of the file that are not read; `width` does not count them.
    whole : int
        Columns of the file, where some are left out.
    """

    separator: str
    decimal: str
    width: int
    grouped: bool = False
    left_out: tuple[int, ...] = ()
    whole: int = -1

    def cells(self, line: str) -> list[str]:
        """The cells of a line that are read; none where columns are left out and the line has more or fewer than the file."""
        cells = self.all_cells(line)
        if not self.left_out:
            return cells
        return [cell for i, cell in enumerate(cells) if i not in self.left_out] if len(cells) == self.whole else []

    def all_cells(self, line: str) -> list[str]:
        """The cells of a line."""
        if self.separator == " ":
            return re.findall(r"[^ \t]+", line)
        parts = self._quoted(line) if '"' in line and len(self.separator) == 1 else line.split(self.separator)
        cells = [part.strip(_BLANK) for part in parts]
        return cells[:-1] if len(cells) == max(self.width, self.whole) + 1 and cells[-1] == "" else cells

    def _quoted(self, line: str) -> list[str]:
        """The parts of a line with quotes; where one is not closed, or a part is longer than the csv module takes, they part nothing."""
        if line.count('"') % 2:
            return line.split(self.separator)
        bare = line.strip(" ")
        if self.separator not in line and bare[0] == '"' and '"' not in (inner := bare.strip('"')):
            return [inner]
        try:
            return next(csv.reader([line], delimiter=self.separator, skipinitialspace=True), [])
        except csv.Error:
            return line.split(self.separator)

    def number(self, cell: str) -> float | None:
        """The number in a cell; NaN for a missing value, None if it is not a number."""
        if len(cell) > MOST_NUMBER:
            return None
        if _NUMBER[self.decimal].fullmatch(cell):
            return float(cell.replace(",", ".").translate(_EXPONENT))
        if self.grouped and _GROUPED[self.decimal].fullmatch(cell):
            return float(re.sub(rf"[^\d+\-{self.decimal}]", "", cell).replace(",", "."))
        word = cell.lower()
        return np.nan if word in MISSING else _INFINITE.get(word)

    def numbers(self, line: str) -> list[float | None]:
        """All cells of a line as numbers."""
        return [self.number(cell) for cell in self.cells(line)]

    def row(self, line: str) -> list[float | None] | None:
        """A line as numbers, if it is nothing else, and holds at least one that was measured."""
        if not line.strip() or self._begins_with_words(line):
            return None
        row: list[float | None] = []
        for cell in self.cells(line):
            number = self.number(cell)
            if number is None:
                return None
            row.append(number)
        return row if any(np.isfinite(x) for x in row) else None  # type: ignore[arg-type]

    def _begins_with_words(self, line: str) -> bool:
        """Whether the first cell is no number, which spares the others of a long line."""
        if self.left_out or '"' in line or self.separator == " ":
            return False
        return self.number(line.split(self.separator, 1)[0].strip(_BLANK)) is None

    @property
    def words(self) -> str:
        """The dialect in words."""
        name = next((name for name, mark in SEPARATORS.items() if mark == self.separator), repr(self.separator))
        return f"separator {name}, decimal {'point' if self.decimal == '.' else 'comma'}"


@dataclass(frozen=True)
class _Tried:
    """A dialect, the part of the lines that it can read, and the first row of numbers."""

    part: float
    dialect: Dialect
    first: int


def sniffed(
    lines: TextLines, separator: str | None, decimal: str | None, notes: list[str], left_out: tuple[int, ...] = (), whole: int = -1
) -> tuple[Dialect, int]:
    """The dialect in which a text is a table, and its first row of numbers.

    Where numbers can be read in two ways, the headings decide by how many columns they name; where they do not, it is an error. What the
    user typed is not doubted.
    """
    tried = _all_tried(lines, separator, decimal, left_out, whole)
    able = _distinct([t for t in tried if t.part >= 1 - MOST_BAD], lines)
    if not able:
        best = max(tried, key=lambda t: t.part, default=None)
        raise InputError("read", [f"no table of numbers was found in the text: {_why_not(lines, best)}"])
    if len(able) > 1:
        able = _by_heading(able, lines, notes)
    if len(able) > 1:
        most = max(t.part for t in able)
        able = [t for t in able if t.part == most]
    if len(able) > 1:
        raise InputError("read", [_two_ways(able, lines)])
    chosen = able[0]
    check_columns(chosen.dialect.width)
    body = lines.from_line(chosen.first)
    if separator is None and decimal is None:
        _check_columns(chosen, lines, body, notes)
    if decimal is None:
        _check_thousands(chosen.dialect, body, notes)
    return chosen.dialect, chosen.first


def _all_tried(lines: TextLines, separator: str | None, decimal: str | None, left_out: tuple[int, ...], whole: int) -> list[_Tried]:
    quoted = any('"' in line for line in lines[: lines.beginning(_PREAMBLE + 2)])
    tried = []
    for mark in [separator] if separator else SEPARATORS.values():
        for point in [decimal] if decimal else (".", ","):
            if mark != point or quoted:
                one = _tried(lines, Dialect(mark, point, -1, decimal is not None and mark not in ", ", left_out, whole))
                tried += [one] if one else []
    return tried


def _tried(lines: TextLines, loose: Dialect) -> _Tried | None:
    """How much of the text is a table in one dialect."""
    beginning = lines[: lines.beginning(_PREAMBLE, MOST_PREAMBLE)]
    widths = Counter(len(row) for row in (loose.row(line) for line in lines.sample(0, _SAMPLED)) if row)
    widths = widths or Counter(len(row) for row in (loose.row(line) for line in beginning) if row)
    if not widths:
        return None
    width = max(widths, key=lambda w: (widths[w], w))
    dialect = dataclasses.replace(loose, width=width)
    first = next((i for i, line in enumerate(beginning) if len(dialect.row(line) or ()) == width), None)
    if first is None:
        return None
    sample = lines.sample(first, _SAMPLED)
    good = sum(len(dialect.row(line) or ()) == width for line in sample)
    before = sum(bool(line.strip()) and bool(_FIGURES.fullmatch(line)) for line in lines[:first])  # rows that this dialect cannot read
    return _Tried(good / (len(sample) + before), dialect, first)


def _why_not(lines: TextLines, best: _Tried | None) -> str:
    if best is None:
        searched = lines.beginning(_PREAMBLE, MOST_PREAMBLE)
        if searched < len(lines) and any(re.search(r"\d", line) for line in lines.sample(searched, _SAMPLED)):
            return f"none of its first {searched} lines is a row of numbers; remove most of what stands before the table"
        example = next((line.strip()[:60] for line in lines if line.strip()), "")
        return f"it begins with {example!r}; {_TYPE} with what the file uses"
    return (
        f"with {best.dialect.words} only {100 * best.part:.0f} % of the lines have {best.dialect.width} numbers "
        f"(mixed decimal marks, marks between thousands, or a damaged file?); {_TYPE} with what the file uses"
    )


_TYPE = 'type ss.read(path, separator=";", decimal=",")'


def _distinct(able: list[_Tried], lines: TextLines) -> list[_Tried]:
    """One of those that read the same numbers; where decimal marks come only later in the file, the one that can read them."""
    distinct: dict[str, _Tried] = {}
    for t in able:
        key = repr([t.dialect.numbers(line) for line in lines.sample(t.first, _SAMPLED)])
        other = distinct.setdefault(key, t)
        if other is not t and other.dialect.separator == t.dialect.separator != "," and t.dialect.decimal == ",":
            body = lines.from_line(t.first).data
            if b"," in body and b"." not in body:
                distinct[key] = t
    return list(distinct.values())


# ---- what headings say ----
def heading_cells(line: str, dialect: Dialect) -> list[str]:
    """The names in a line of headings: separators within brackets and quotes part nothing, and a unit in brackets belongs to its name."""
    if dialect.separator == " ":
        line = line.strip(" #%;!")
        wide = [cell.strip() for cell in re.split(r"\t|\s{2,}", line)]
        return _kept(wide if len(wide) == max(dialect.width, dialect.whole) else re.split(r"\s+(?![\[(])", line) if line else [], dialect)
    line = line.lstrip("#%! " if dialect.separator == ";" else "#%;! ")
    cells = [cell.strip().strip('"').strip().replace('""', '"') for cell in _parted(line, dialect.separator)]  # CSV doubles a quote
    cells = cells[:-1] if len(cells) == max(dialect.width, dialect.whole) + 1 and cells[-1] in _NO_COLUMN else cells
    return _kept(cells, dialect)


def _kept(cells: list[str], dialect: Dialect) -> list[str]:
    """The cells whose columns are read."""
    return [cell for i, cell in enumerate(cells) if i not in dialect.left_out] if len(cells) == dialect.whole else cells


_CLOSED = {'"': '"', "[": "]", "(": ")"}


def _parted(line: str, separator: str) -> list[str]:
    """The parts of a line between separators that stand outside of quotes and brackets; what is not closed opens nothing."""
    marks = re.compile(rf'["\[(]|{re.escape(separator)}')
    parts, begin, at, unclosed = [], 0, 0, set[str]()
    while (mark := marks.search(line, at)) is not None:
        at = mark.end()
        if mark[0] == separator:
            parts.append(line[begin : mark.start()])
            begin = at
        elif mark[0] not in unclosed:
            end = line.find(_CLOSED[mark[0]], at)
            if end < 0:
                unclosed.add(mark[0])
            else:
                at = end + 1
    return [*parts, line[begin:]]


def _heading_line(lines: Sequence[str]) -> str | None:
    """The last line before the numbers that says something."""
    return next((line for line in reversed(lines) if line.strip()), None)


def _names(t: _Tried, lines: TextLines) -> list[str]:
    line = _heading_line(lines[: t.first])
    return [] if line is None else heading_cells(line, t.dialect)


def _by_heading(able: list[_Tried], lines: TextLines, notes: list[str]) -> list[_Tried]:
    """Those whose columns are as many as the headings name."""
    fitting = [t for t in able if len(_names(t, lines)) == t.dialect.width]
    wide, single = [t for t in fitting if t.dialect.width > 1], [t for t in fitting if t.dialect.width == 1]
    if wide and single:  # "time, s" over "1,5" is one name with its unit, or two names
        line, last = str(_heading_line(lines[: wide[0].first])), _names(wide[0], lines)[-1]
        return fitting if ", " in line and unit_named(last) is not None else wide
    if len(single) == 1:
        name = _names(single[0], lines)[0]
        notes.append(f'{name!r} names one column, so the commas are read as decimal marks; if they part columns, type separator=","')
    return fitting or able


def _two_ways(able: list[_Tried], lines: TextLines) -> str:
    ways = " or ".join(
        f"as {_columns(t.dialect.width)} with {t.dialect.words} "
        f"({', '.join(f'{x:g}' for x in t.dialect.numbers(lines[t.first])[:6] if x is not None)}{', ...' * (t.dialect.width > 6)})"
        for t in able
    )
    options = " or ".join(
        f'separator="{t.dialect.separator}"' if t.dialect.width > 1 else f'decimal="{t.dialect.decimal}"'
        for t in sorted(able, key=lambda t: -t.dialect.width)
    )
    return f"{lines[able[0].first].strip()[:40]!r} can be read {ways}, and no headings decide it; type ss.read(path, {options})"


def _columns(count: int) -> str:
    return f"{count} column{'s' if count > 1 else ''}"


def _check_columns(t: _Tried, lines: TextLines, body: TextLines, notes: list[str]) -> None:
    """Headings that name fewer columns, and whole numbers with zeros before them, speak of commas or blanks within numbers."""
    names, dialect = _names(t, lines), t.dialect
    named = len(names) > 1 or (len(names) == 1 and unit_named(unit_of_heading(names[0])[1]) is not None)
    words = named and all(name and dialect.number(name) is None for name in names)
    fewer = words and len(names) < dialect.width and dialect.width % len(names) == 0
    if dialect.separator == " ":
        parts = len(names) if fewer else _tabbed(body[0])
        if _grouped_by_blanks(dialect, body[: body.beginning(_SAMPLED)], parts):
            raise InputError("read", [f"{body[0].strip()[:40]!r} may have blanks between thousands; {_TYPE_BLANKS}"])
    whole = dialect.separator == "," and b"." not in body.data and b'"' not in body.data
    if whole and fewer:
        raise InputError("read", [
            f"the headings name {_columns(len(names))} and {body[0].strip()[:40]!r} has {dialect.width} numbers with {dialect.words}: "
            f"are commas decimal marks too? {_SPLIT}"
        ])  # fmt: skip
    if len(names) > 1 and words and len(names) != dialect.width:
        notes.append(f"the line before the numbers names {len(names)} columns and the rows have {dialect.width}: its names are not used")
    if len(names) != dialect.width and whole and dialect.width % 2 == 0:
        _doubt_commas(dialect, body, notes)


def _doubt_commas(dialect: Dialect, body: TextLines, notes: list[str]) -> None:
    """Whole numbers without headings: the commas may be decimal marks and separators at once."""
    if re.search(rb"(?<!\d)[+-]?0\d", body.data):
        raise InputError("read", [
            f"every number is whole, and some begin with a zero, in {_columns(dialect.width)} with {dialect.words}: are the commas decimal "
            f"marks too? {_SPLIT}"
        ])  # fmt: skip
    notes.append('every number is a whole number and the separator is the comma; if the commas are decimal marks, type decimal=","')


def _tabbed(line: str) -> int:
    """Cells between tabs."""
    return len(line.strip().split("\t"))


def _grouped_by_blanks(dialect: Dialect, lines: Sequence[str], parts: int) -> bool:
    """Whether rows of blanks are `part_runs` numbers with blanks between thousands."""
    if not 0 < parts < dialect.width or dialect.width % parts:
        return False
    size = dialect.width // parts
    cells = [dialect.cells(line) for line in lines if line.strip()]
    return all(re.fullmatch(r"\d{3}(?:[.,]\d*)?", cell) for row in cells for i, cell in enumerate(row) if i % size)


_TYPE_BLANKS = 'type separator="\\t" or what parts the columns, and decimal="."; if blanks part all columns, type separator=" "'
_SPLIT = (
    'type ss.read(path, separator=",") if not; else export with another separator, or type separator=", ", decimal="," if that parts them'
)


def _check_thousands(dialect: Dialect, body: TextLines, notes: list[str]) -> None:
    """Commas that all stand before three digits may be decimal marks or marks between thousands: nothing in the file tells."""
    if dialect.decimal == "," and _always_three(_COMMA_TOKEN, body):
        raise InputError("read", [
            "every comma stands before exactly three digits: a decimal mark, or a mark between thousands? "
            'Type ss.read(path, decimal=",") or ss.read(path, decimal=".")'
        ])  # fmt: skip
    if dialect.separator == ";" and dialect.decimal == "." and _always_three(_POINT_TOKEN, body[: body.beginning(_SAMPLED)]):
        notes.append(
            "every point stands before exactly three digits and is read as the decimal mark; "
            'if points are between thousands, type decimal=","'
        )


def _always_three(token: re.Pattern[str], lines: Iterable[str]) -> bool:
    """Whether all tokens look like thousands, and there is one."""
    matched = False
    for line in lines:
        for whole, part, exponent in token.findall(line):
            if len(part) != 3 or not 0 < len(whole) < 4 or whole.startswith("0") or exponent:
                return False
            matched = True
    return matched
