"""The lines of a text, decoded when they are asked for, within bounds: a text of many short lines costs little more than its bytes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, overload

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError

#: Bounds of a table in text, far beyond those of any instrument: characters of a line and of a number, columns, and characters in which
#: its dialect is looked for, and its first row.
MOST_LINE, MOST_NUMBER, MOST_COLUMNS, SNIFFED, MOST_PREAMBLE = 200_000, 1000, 4096, 1 << 16, 1 << 20
_PIECE = 1 << 18  # characters in which line ends are looked for at once, and lines that are measured at once
_SHORT = 4  # characters: where lines are shorter on average, blank ones are left out
_TOGETHER = 4096  # lines that are decoded at once


class TextLines(Sequence[str]):
    r"""The lines of a text.

    Parameters
    ----------
    data : bytes
        UTF-8, in which lines end with a line feed.
    starts : array of int, optional
        Where each line begins, and where one after the last would; found by default.
    numbers : int or array of int
        Which line of the file the first is, counted from 0, or each, where blank lines are left out.

    Examples
    --------
    >>> lines = TextLines(b"t,v\n1,2\n3,4")
    >>> len(lines), lines[1], lines[1:].data
    (3, '1,2', b'1,2\n3,4')
    """

    def __init__(self, data: bytes, starts: Array | None = None, numbers: Any = 0):
        self._data, self._numbers = data, numbers
        if starts is None:
            starts = np.empty(data.count(b"\n") + 2, np.int32 if len(data) < 2**31 - 2 else np.int64)
            starts[0], starts[-1], letters, at = 0, len(data) + 1, np.frombuffer(data, np.uint8), 1
            for begin in range(0, len(data), _PIECE):  # places of all at once would take eight times the memory of the text
                ends = np.flatnonzero(letters[begin : begin + _PIECE] == ord("\n")) + (begin + 1)
                starts[at : at + len(ends)] = ends
                at += len(ends)
        self._starts = starts

    @classmethod
    def of_text(cls, text: str) -> TextLines:
        """The lines of a text, whose ends may be those of any system; of one of mostly blank lines those that are not."""
        if "\r" in text:
            text = text.replace("\r\n", "\n").replace("\r", "\n")
        data = text.encode("utf-8", "surrogatepass")
        if _SHORT * data.count(b"\n") > len(data):
            data, numbers = _without_blanks(data)
            return cls(data, numbers=numbers)
        return cls(data)

    def number(self, index: int) -> int:
        """Which line of the file a line is, counted from 1."""
        return 1 + (self._numbers + index if isinstance(self._numbers, int) else int(self._numbers[index]))

    def replaced(self, data: bytes) -> TextLines:
        """As many other lines, which have the numbers of these."""
        return TextLines(data, numbers=self._numbers)

    @property
    def data(self) -> bytes:
        """The bytes of these lines."""
        return self._data[self._starts[0] : self._starts[-1] - 1]

    @property
    def starts(self) -> Array:
        """Where each line begins in `data`, and where one after the last would: array (lines + 1,)."""
        return self._starts - self._starts[0]

    @property
    def size(self) -> int:
        """Bytes of these lines."""
        return int(self._starts[-1]) - 1 - int(self._starts[0])

    def __len__(self) -> int:
        return len(self._starts) - 1

    @overload
    def __getitem__(self, index: int) -> str: ...

    @overload
    def __getitem__(self, index: slice) -> Sequence[str]: ...

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            first, last, step = index.indices(len(self))
            return self.part(first, max(first, last)) if step == 1 else [self[i] for i in range(first, last, step)]
        index = range(len(self))[index]
        return self._data[self._starts[index] : self._starts[index + 1] - 1].decode("utf-8", "surrogatepass")

    def __iter__(self) -> Iterator[str]:
        for first in range(0, len(self), _TOGETHER):
            last = min(first + _TOGETHER, len(self))
            yield from self._data[self._starts[first] : self._starts[last] - 1].decode("utf-8", "surrogatepass").split("\n")

    def from_line(self, first: int) -> TextLines:
        """The lines from one on."""
        return self.part(first, len(self))

    def part(self, first: int, last: int) -> TextLines:
        """Some of the lines."""
        numbers = self._numbers + first if isinstance(self._numbers, int) else self._numbers[first:last]
        return TextLines(self._data, self._starts[first : last + 1], numbers)

    def check(self) -> None:
        """Raise an `InputError` for a line that no table has."""
        for first in range(0, len(self), _PIECE):
            sizes = np.diff(self._starts[first : first + _PIECE + 1]) - 1
            if sizes.max() > MOST_LINE:
                longest = int(sizes.argmax())
                why = f"line {self.number(first + longest)} of the text has {int(sizes[longest])} characters; allowed are {MOST_LINE}"
                raise InputError(
                    "read", [f"{why}; write a table with a line for each instant, or a binary format such as .mat, .tdms or .h5"]
                )

    def beginning(self, most: int, characters: int = SNIFFED) -> int:
        """How many of the first `most` lines lie within the first characters; one at least."""
        within = int(np.searchsorted(self._starts, int(self._starts[0]) + characters, side="right"))
        return max(min(within, most, len(self)), min(len(self), 1))

    def sample(self, first: int, most: int) -> list[str]:
        """Up to `most` lines spread evenly over those from `first` on, of which fewer are taken where they are long."""
        each = max((int(self._starts[-1]) - int(self._starts[min(first, len(self))])) / max(len(self) - first, 1), 1.0)
        count = max(min(most, int(SNIFFED / each)), 4)
        chosen, length = [], 0
        for i in range(first, len(self), max((len(self) - first) // count, 1)):
            line = self[i]
            if line.strip():
                chosen.append(line)
                length += len(line)
            if length > 2 * SNIFFED:
                break
        return chosen


def _without_blanks(data: bytes) -> tuple[bytes, Any]:
    """The lines that are not blank, and the last one, with their numbers from 0; a piece at a time."""
    kept, numbers, begin, count = list[bytes](), list[Array](), 0, 0
    while begin < len(data):
        end = data.find(b"\n", min(begin + _PIECE, len(data)))
        if end < 0:
            end = data.rfind(b"\n", begin)
        if end < 0:
            break
        letters = np.frombuffer(data, np.uint8, end + 1 - begin, begin)
        ends = np.flatnonzero(letters == ord("\n"))
        filled = np.diff(np.cumsum(~np.isin(letters, _BLANK), dtype=np.int32)[ends], prepend=0) > 0
        kept.append(letters[np.repeat(filled, np.diff(ends, prepend=-1))].tobytes())
        numbers.append((count + np.flatnonzero(filled)).astype(np.int64 if len(data) >= 2**31 else np.int32))
        begin, count = end + 1, count + len(ends)
    if sum(map(len, numbers)) == count:
        return data, 0
    return b"".join([*kept, data[begin:]]), np.concatenate([*numbers, [count]])


_BLANK = np.frombuffer(b" \t\f\n", np.uint8)


def check_columns(count: int, what: str = "the text") -> None:
    """Raise an `InputError` for more columns than any table has."""
    if count > MOST_COLUMNS:
        raise InputError(
            "read", [f"{what} has {count} columns; allowed are {MOST_COLUMNS}; write a line for each instant, a column for each channel"]
        )
