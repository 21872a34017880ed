"""Timestamps in text: dates with times, and times of day, become whole nanoseconds since the first, before a table is looked for."""

from __future__ import annotations

import datetime
import functools
import io
import re
from dataclasses import dataclass

from stickslip.basics.errors import InputError
from stickslip.records.text_lines import MOST_PREAMBLE, Lines

#: What one of the whole numbers is [s].
STAMP_UNIT = 1e-9
_DAY, _SECOND = 86_400_000_000_000, 1_000_000_000
_YEAR_FIRST = r"(?P<y>\d{4})[-/](?P<m>\d\d?)[-/](?P<d>\d\d?)"
_DATE = rf"(?:{_YEAR_FIRST}|(?P<dd>\d\d?)\.(?P<dm>\d\d?)\.(?P<dy>\d{{4}})|(?P<a>\d\d?)/(?P<b>\d\d?)/(?P<ay>\d{{4}}))"
_CLOCK = r"(?P<H>\d\d?):(?P<M>\d\d):(?P<S>\d\d)(?:[.,:](?P<f>\d{1,9}))?"
_TIME = _CLOCK + r"(?:\s*(?P<half>[AaPp][Mm]))?(?:\s*(?P<zone>Z|UTC|[+-]\d\d:?\d\d))?"
_LOOSE = {comma: _TIME.replace("[.,:]", "[.,:]" if comma else "[.:]") for comma in (True, False)}
_CELL = {comma: re.compile(rf'"?(?:{_DATE}(?P<between>"?\s*[,;\t]\s*"?|T| +))?{time}"?') for comma, time in _LOOSE.items()}
_REST = re.compile(r'[\d\s.,;+\-eE"|naNA/]*')
_LINES = 2000  # of which one must have a timestamp


@dataclass(frozen=True)
class Stamped:
    """The lines with whole numbers in place of timestamps.

    Parameters
    ----------
    lines : Lines
    before : str
        What stands before the first of these numbers in its line.
    dated : bool
        Whether a column of dates is before it, which holds zeros now.
    begin : str
        The first timestamp, as it was written.
    """

    lines: Lines
    before: str
    dated: bool
    begin: str


def stamped(lines: Lines, words: bool = False) -> Stamped | None:
    """The same lines with whole nanoseconds for timestamps; None where the text has none beside its numbers, or `words`."""
    for comma in (True, False):  # a comma before the fraction of a second is one where commas part no columns
        begin = next(
            (i for i, line in enumerate(lines[: lines.beginning(_LINES, MOST_PREAMBLE)]) if _found(line, comma, words) is not None), None
        )
        if begin is None:
            continue
        if comma and not re.search(r"[;\t]", lines[begin]):
            continue
        return _replaced(lines, begin, comma, words)
    return None


def _found(line: str, comma: bool, words: bool) -> re.Match[str] | None:
    """The timestamp of a line whose rest is numbers, or whatever it is."""
    if ":" not in line:
        return None
    found = _CELL[comma].search(line)
    if found is None or not (words or (_REST.fullmatch(line[: found.start()]) and _REST.fullmatch(line[found.end() :]))):
        return None
    before = line[: found.start()].rstrip(" ")
    alone = (not before.strip() or before[-1] in ",;\t") and re.match(r"\s*([,;\t ]|$)", line[found.end() :])
    return found if alone else None


def _replaced(lines: Lines, begin: int, comma: bool, words: bool) -> Stamped:
    first = _found(lines[begin], comma, words)
    assert first is not None
    day_first = bool(first["a"]) and _order_of_days(lines.from_line(begin))
    made, last, turns, zero = io.StringIO(), None, 0, None
    made.writelines(f"{line}\n" for line in lines[:begin])
    for i, line in enumerate(lines.from_line(begin)):
        made.write("\n" * (i > 0))
        match = _found(line, comma, words)
        at = None if match is None else _whole(match, day_first)
        if match is None or at is None:
            made.write(line)
            continue
        if match["between"] is None and last is not None and at + turns < last - _DAY // 2:  # a time of day, after midnight
            turns += _DAY
        at += turns
        last, zero = at, at if zero is None else zero
        made.write(f"{line[: match.start()]}{_date_cell(match)}{at - zero}{line[match.end() :]}")
    return Stamped(
        Lines.of_text(made.getvalue()), lines[begin][: first.start()] + _date_cell(first), bool(_date_cell(first)), first[0].strip('"')
    )


def _date_cell(match: re.Match[str]) -> str:
    """A cell for the date, where it has a column of its own."""
    parted = re.search(r"[,;\t]", match["between"] or "")
    return f"0{parted[0]}" if parted else ""


_STROKES = re.compile(rb"(?<![\d/])(\d\d?)/(\d\d?)/\d{4}(?!\d)")


def _order_of_days(lines: Lines) -> bool:
    """Whether 03/04/2026 is the third of April; an error where days go on and nothing tells."""
    pairs = {(int(match[1]), int(match[2])) for match in {m[0]: m for m in _STROKES.finditer(lines.data)}.values()}
    first, second = any(a > 12 for a, _ in pairs), any(b > 12 for _, b in pairs)
    if len(pairs) > 1 and first == second:
        shown = "/".join(map(str, min(pairs)))
        raise InputError("read", [f"the date {shown} may name the day first or the month; write dates as 2026-03-01"])
    return first


def _whole(match: re.Match[str], day_first: bool) -> int | None:
    """Nanoseconds since the beginning of the calendar, or since midnight; None where there is no such date or time."""
    hour, minute, second = int(match["H"]), int(match["M"]), int(match["S"])
    if match["half"]:
        hour = hour % 12 + (12 if match["half"].lower() == "pm" else 0)
    if hour > 24 or minute > 59 or second > 60:
        return None
    day = _day(match, day_first)
    if day is None:
        return None
    fraction = int((match["f"] or "0").ljust(9, "0"))
    return day * _DAY + (3600 * hour + 60 * minute + second) * _SECOND + fraction - _offset(match["zone"]) * _SECOND


def _day(match: re.Match[str], day_first: bool) -> int | None:
    if not (match["y"] or match["dy"] or match["ay"]):
        return 0
    if match["y"]:
        parts = match["y"], match["m"], match["d"]
    elif match["dy"]:
        parts = match["dy"], match["dm"], match["dd"]
    else:
        parts = (match["ay"], match["b"], match["a"]) if day_first else (match["ay"], match["a"], match["b"])
    return _ordinal(*parts)


@functools.lru_cache(64)
def _ordinal(*parts: str) -> int | None:
    """The number of a day in the calendar; None where there is no such day."""
    try:
        return datetime.date(*map(int, parts)).toordinal()
    except ValueError:
        return None


def _offset(zone: str | None) -> int:
    if not zone or zone in ("Z", "UTC"):
        return 0
    sign = -1 if zone[0] == "-" else 1
    return sign * (3600 * int(zone[1:3]) + 60 * int(zone[-2:]))


def nanoseconds(text: str) -> int | None:
    """The time of a text that is only a date with a time (month first where strokes separate them); None for other texts.

    Examples
    --------
    >>> nanoseconds("2026-03-01T12:00:00.25Z") - nanoseconds("2026-03-01 12:00:00+00:00")
    250000000
    """
    found = _CELL[True].fullmatch(text.strip())
    return None if found is None else _whole(found, day_first=False)


def is_clock(cell: str) -> bool:
    """Whether a cell is a time of day, or a date with one."""
    return ":" in cell and _CELL[True].fullmatch(cell.strip()) is not None


_DAY_ALONE = re.compile(_DATE)


def is_date(cell: str) -> bool:
    """Whether a cell is a date without a time."""
    return _DAY_ALONE.fullmatch(cell.strip()) is not None
