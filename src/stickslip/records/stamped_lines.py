"""Lines with timestamps: they become whole nanoseconds since the first, before a table is looked for.

Nearly all lines of a file have their timestamps in a few forms (which letters are digits), and lines of one form are read at once.
"""

from __future__ import annotations

import io
import re
from dataclasses import dataclass

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.records.stamps import DAY, SECOND, date_cell, date_groups, day_number, time_of, timestamp_in
from stickslip.records.text_lines import MOST_PREAMBLE, TextLines

_LINES = 2000  # of which one must have a timestamp
_TOGETHER, _LETTERS = 8192, 1 << 20  # lines, and their characters, that are read at once
_FORMS = 12  # that are remembered


@dataclass(frozen=True)
class Stamped:
    """The lines with whole numbers in place of timestamps.

    Parameters
    ----------
    lines : TextLines
    before : str
        What stands before the first of these numbers in its line.
    dated : bool
        Whether a column of dates is before it, which holds zeros now.
    begin : str
        The first timestamp, as it was written.
    """

    lines: TextLines
    before: str
    dated: bool
    begin: str


def stamped(lines: TextLines, words: bool = False) -> Stamped | None:
    """The same lines with whole nanoseconds for timestamps; None where the text has none beside its numbers, or `words`."""
    for comma in (True, False):  # a comma before the fraction of a second is one where commas part no columns
        begin = next(
            (i for i, line in enumerate(lines[: lines.beginning(_LINES, MOST_PREAMBLE)]) if timestamp_in(line, comma, words) is not None),
            None,
        )
        if begin is None:
            continue
        if comma and not re.search(r"[;\t]", lines[begin]):
            continue
        return _replaced(lines, begin, comma, words)
    return None


def _replaced(lines: TextLines, begin: int, comma: bool, words: bool) -> Stamped:
    first = timestamp_in(lines[begin], comma, words)
    assert first is not None
    day_first = bool(first["a"]) and _order_of_days(lines.from_line(begin))
    reader, count, made, rest = _Reader(comma, words, day_first), _Count(), io.BytesIO(), lines.from_line(begin)
    made.writelines(line.encode("utf-8", "surrogatepass") + b"\n" for line in lines[:begin])
    while len(rest):
        some = rest.part(0, rest.beginning(_TOGETHER, _LETTERS))
        rest = rest.from_line(len(some))
        texts, times = some.data.split(b"\n"), reader.times_of(some)
        numbers = count.since_first(times)
        for which, start, end, cell in times.places:
            for at in which.tolist():
                text = texts[at]
                texts[at] = b"%s%s%d%s" % (text[:start], cell, numbers[at], text[end:])
        made.writelines((b"\n".join(texts), b"\n" * (len(rest) > 0)))
    date = date_cell(first)
    return Stamped(lines.replaced(made.getvalue()), lines[begin][: first.start()] + date, bool(date), first[0].strip('"'))


class _Count:
    """Nanoseconds since the first timestamp, over midnights where times have no dates."""

    def __init__(self) -> None:
        self._first: tuple[int, int] | None = None
        self._last: tuple[int, int] | None = None
        self._turns = 0

    def since_first(self, times: _Times) -> dict[int, int]:
        """Numbers by line, for those that have a time."""
        which = np.flatnonzero(times.known)
        if not len(which):
            return {}
        day, part = times.day[which], times.part[which]
        self._first = self._first or (int(day[0]), int(part[0]))
        last = self._last or (int(day[0]), int(part[0]))
        self._last = int(day[-1]), int(part[-1])
        steps = np.diff(day, prepend=last[0]) * float(DAY) + np.diff(part, prepend=last[1])
        turns = self._turns + np.cumsum(~times.dated[which] & (steps < -DAY / 2))  # a time of day, after midnight
        self._turns = int(turns[-1])
        days = day - self._first[0] + turns
        if abs(days).max() > 100_000:  # centuries, in numbers of any length
            days, part = days.astype(object), part.astype(object)
        return dict(zip(which.tolist(), (days * DAY + (part - self._first[1])).tolist(), strict=True))


# ---- many lines at once ----
@dataclass
class _Times:
    """The times of some lines.

    Parameters
    ----------
    known, dated : array (n,) of bool
        Whether a line has a time, and a date with it.
    day, part : array (n,) of int
        Number of the day, and nanoseconds within it.
    places : list
        Lines, where their timestamps begin and end [bytes], and what stands for a column of dates.
    """

    known: Array
    dated: Array
    day: Array
    part: Array
    places: list[tuple[Array, int, int, bytes]]

    def put(self, which: Array, dated: bool, day: Array, part: Array, cell: tuple[int, int, bytes]) -> None:
        """Add the times of some lines."""
        self.known[which], self.dated[which], self.day[which], self.part[which] = True, dated, day, part
        self.places.append((which, *cell))


class _Reader:
    """Reads the timestamps of lines, those of each form at once."""

    def __init__(self, comma: bool, words: bool, day_first: bool):
        self._comma, self._words, self._day_first = comma, words, day_first
        self._forms: list[_Form] = []

    def times_of(self, lines: TextLines) -> _Times:
        """The times of some lines."""
        count, some = len(lines), _Letters(lines, self._words)
        times = _Times(np.zeros(count, bool), np.zeros(count, bool), np.zeros(count, np.int64), np.zeros(count, np.int64), [])
        left = np.unique(np.searchsorted(some.ends, np.flatnonzero(some.letters == ord(":"))))
        for form in self._forms:
            left = form.read(some, left, times)
        while len(left):
            at, left = int(left[0]), left[1:]
            match = timestamp_in(lines[at], self._comma, self._words)
            if match is None:
                continue
            time = time_of(match, self._day_first)
            if time is not None:
                start, end = (len(match.string[:span].encode("utf-8", "surrogatepass")) for span in match.span())
                span = (start, end, date_cell(match).encode())
                times.put(np.array([at]), match["between"] is not None, np.array(time[:1]), np.array(time[1:]), span)
            if len(self._forms) < _FORMS and match.string[: match.end()].isascii():
                self._forms.append(_Form(match, self._comma, self._day_first))
                left = self._forms[-1].read(some, left, times)
        return times


_KIND = np.arange(256, dtype=np.uint8)
_KIND[ord("0") : ord("9") + 1] = ord("0")
_STRANGE = np.ones(256, bool)  # letters that do not stand in a row of numbers
_STRANGE[[*b'0123456789 \t.,;+-eE"|naNA/']] = False


class _Letters:
    """The letters of some lines, where each line begins and ends, and how many letters before each are strange in a row of numbers."""

    def __init__(self, lines: TextLines, words: bool):
        self.letters = np.frombuffer(lines.data + b"\n\n", np.uint8)
        self.starts, self.ends = lines.starts[:-1], lines.starts[1:] - 1
        self._strange = None if words else np.concatenate([[0], np.cumsum(_STRANGE[self.letters], dtype=np.int32)])

    def is_plain(self, which: Array, start: int) -> Array:
        """Whether nothing but numbers follows in these lines."""
        if self._strange is None:
            return np.ones(len(which), bool)
        return self._strange[self.ends[which]] == self._strange[self.starts[which] + start]


class _Form:
    """Where a line has digits up to the end of its timestamp, and which other letters: what is read of one such line is read of all."""

    def __init__(self, match: re.Match[str], comma: bool, day_first: bool):
        self._spans = {name: match.span(name) for name, text in match.groupdict().items() if text}
        self._date, self._dated = date_groups(match, day_first), match["between"] is not None
        self._time_at = (*match.span(), date_cell(match).encode())
        self._ends = b"\n;" if comma else b"\n;,"
        self._kinds = self._kinds_of(np.frombuffer(match.string[: match.end()].encode(), np.uint8)[None])

    def _kinds_of(self, letters: Array) -> Array:
        """Digits are alike, and so are AM and PM."""
        kinds = _KIND[letters]
        if "half" in self._spans:
            half = kinds[:, self._spans["half"][0]]
            half[half == ord("P")], half[half == ord("p")] = ord("A"), ord("a")
        return kinds

    def read(self, some: _Letters, left: Array, times: _Times) -> Array:
        """Put the times of those lines that have this form, and return the others."""
        width = self._kinds.shape[1]
        long = some.ends[left] - some.starts[left] >= width
        which = left[long]
        letters = some.letters[some.starts[which][:, None] + np.arange(width + 2)]
        after, then = letters[:, width], letters[:, width + 1]
        closed = np.isin(after, [*self._ends]) | (np.isin(after, [*b" \t"]) & (_KIND[then] == ord("0")))  # neither PM nor a zone follows
        fits = (self._kinds_of(letters[:, :width]) == self._kinds).all(axis=1) & closed & some.is_plain(which, width)
        day, part = self._times(letters[fits])
        good = (day >= 0) & (part >= -DAY)
        times.put(which[fits][good], self._dated, day[good], part[good], self._time_at)
        long[long] = fits
        return left[~long]

    def _times(self, letters: Array) -> tuple[Array, Array]:
        """Days and nanoseconds within them; -1 for a day that there is not, less than -DAY for a time."""

        def number(begin: int, end: int) -> Array:
            return (letters[:, begin:end].astype(np.int64) - ord("0")) @ 10 ** np.arange(end - begin)[::-1]

        spans = self._spans
        hour, minute, second = (number(*spans[name]) for name in "HMS")
        if "half" in spans:
            hour = hour % 12 + 12 * np.isin(letters[:, spans["half"][0]], [*b"Pp"])
        part = (3600 * hour + 60 * minute + second) * SECOND
        if "f" in spans:
            begin, end = spans["f"]
            part += number(begin, end) * 10 ** (9 - (end - begin))
        if "zone" in spans and self._kinds[0, spans["zone"][0]] in b"+-":
            begin, end = spans["zone"]
            ahead = (3600 * number(begin + 1, begin + 3) + 60 * number(end - 2, end)) * SECOND
            part += ahead if self._kinds[0, begin] == ord("-") else -ahead
        part[(hour > 24) | (minute > 59) | (second > 60)] = -10 * DAY
        if self._date is None:
            return np.zeros(len(letters), np.int64), part
        year, month, day = (number(*spans[name]) for name in self._date)
        dates, at = np.unique(np.stack([year, month, day]), axis=1, return_inverse=True)
        days = [day_number(*date) for date in dates.T.tolist()]
        return np.array([-1 if day is None else day for day in days], np.int64)[at.ravel()], part


# ---- dates with strokes ----
_STROKES = re.compile(rb"(?<![\d/])(\d\d?)/(\d\d?)/\d{4}(?!\d)")


def _order_of_days(lines: TextLines) -> bool:
    """Whether 03/04/2026 is the third of April; an error where days go on and nothing tells."""
    pairs = {(int(match[1]), int(match[2])) for match in {m[0]: m for m in _STROKES.finditer(lines.data)}.values()}
    first, second = any(a > 12 for a, _ in pairs), any(b > 12 for _, b in pairs)
    if len(pairs) > 1 and first == second:
        shown = "/".join(map(str, min(pairs)))
        raise InputError("read", [f"the date {shown} may name the day first or the month; write dates as 2026-03-01"])
    return first
