"""A timestamp in text: a date with a time, or a time of day, as a day and nanoseconds within it."""

from __future__ import annotations

import datetime
import functools
import re

#: What one of the whole numbers is [s].
STAMP_UNIT = 1e-9
DAY, SECOND = 86_400_000_000_000, 1_000_000_000
_YEAR_FIRST = r"(?P<y>\d{4})[-/](?P<m>\d\d?)[-/](?P<d>\d\d?)"
_DATE = rf"(?:{_YEAR_FIRST}|(?P<dd>\d\d?)\.(?P<dm>\d\d?)\.(?P<dy>\d{{4}})|(?P<a>\d\d?)/(?P<b>\d\d?)/(?P<ay>\d{{4}}))"
_CLOCK = r"(?P<H>\d\d?):(?P<M>\d\d):(?P<S>\d\d)(?:[.,:](?P<f>\d{1,9}))?"
_TIME = _CLOCK + r"(?:\s*(?P<half>[AaPp][Mm]))?(?:\s*(?P<zone>Z|UTC|[+-]\d\d:?\d\d))?"
_LOOSE = {comma: _TIME.replace("[.,:]", "[.,:]" if comma else "[.:]") for comma in (True, False)}
_CELL = {comma: re.compile(rf'"?(?:{_DATE}(?P<between>"?\s*[,;\t]\s*"?|T| +))?{time}"?') for comma, time in _LOOSE.items()}
_REST = re.compile(r'[\d\s.,;+\-eE"|naNA/]*')


def timestamp_in(line: str, comma: bool, words: bool) -> re.Match[str] | None:
    """The timestamp of a line whose rest is numbers, or whatever it is."""
    if ":" not in line:
        return None
    match = _CELL[comma].search(line)
    if match is None or not (words or (_REST.fullmatch(line[: match.start()]) and _REST.fullmatch(line[match.end() :]))):
        return None
    before = line[: match.start()].rstrip(" ")
    alone = (not before.strip() or before[-1] in ",;\t") and re.match(r"\s*([,;\t ]|$)", line[match.end() :])
    return match if alone else None


def date_cell(match: re.Match[str]) -> str:
    """A cell for the date, where it has a column of its own."""
    parted = re.search(r"[,;\t]", match["between"] or "")
    return f"0{parted[0]}" if parted else ""


def time_of(match: re.Match[str], day_first: bool) -> tuple[int, int] | None:
    """Number of the day in the calendar, 0 where there is no date, and nanoseconds since its midnight; None where there is no such time."""
    hour, minute, second = int(match["H"]), int(match["M"]), int(match["S"])
    if match["half"]:
        hour = hour % 12 + (12 if match["half"].lower() == "pm" else 0)
    if hour > 24 or minute > 59 or second > 60:
        return None
    day = _day(match, day_first)
    if day is None:
        return None
    fraction = int((match["f"] or "0").ljust(9, "0"))
    return day, (3600 * hour + 60 * minute + second) * SECOND + fraction - _offset(match["zone"]) * SECOND


def date_groups(match: re.Match[str], day_first: bool) -> tuple[str, str, str] | None:
    """The groups of year, month and day; None for a time of day."""
    if match["y"]:
        return "y", "m", "d"
    if match["dy"]:
        return "dy", "dm", "dd"
    if match["ay"]:
        return ("ay", "b", "a") if day_first else ("ay", "a", "b")
    return None


def _day(match: re.Match[str], day_first: bool) -> int | None:
    groups = date_groups(match, day_first)
    return 0 if groups is None else day_number(*(int(match[group]) for group in groups))


@functools.lru_cache(64)
def day_number(year: int, month: int, day: int) -> int | None:
    """The number of a day in the calendar; None where there is no such day."""
    try:
        return datetime.date(year, month, day).toordinal()
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
    match = _CELL[True].fullmatch(text.strip())
    time = None if match is None else time_of(match, day_first=False)
    return None if time is None else time[0] * DAY + time[1]


def is_clock(cell: str) -> bool:
    """Whether a cell is a time of day, or a date with one."""
    return ":" in cell and _CELL[True].fullmatch(cell.strip()) is not None


_DAY_ALONE = re.compile(_DATE)


def is_date(cell: str) -> bool:
    """Whether a cell is a date without a time."""
    return _DAY_ALONE.fullmatch(cell.strip()) is not None
