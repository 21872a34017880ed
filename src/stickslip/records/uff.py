"""Universal file format, data set 58 (functions at nodal points): ASCII and binary, single and double, even and uneven, ragged."""

from __future__ import annotations

import re
import warnings
from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.records.raw import Raw, RawColumn, unmarked
from stickslip.records.text_lines import MOST_NUMBER, check_columns

_DELIMITER = re.compile(rb"^ {4}-1[ \t]*\r?$", re.M)
_NUMBER = re.compile(rb"[+-]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][+-]?\d+)?|[+-]?(?:nan|inf(?:inity)?)", re.I)
#: Ordinate data type -> (bytes of one number, numbers for one value).
_TYPES = {2: (4, 1), 4: (8, 1), 5: (4, 2), 6: (8, 2)}
_MOST_OTHERS = 10_000
_HEADER = 11  # lines before the data


@dataclass(frozen=True)
class _Head:
    """The eleven header lines of the data."""

    words: tuple[str, ...]
    name: str
    size: int
    parts: int
    count: int
    even: bool
    first: float
    step: float
    axis: tuple[str, str | None]
    ordinate: tuple[str, str | None]


def parse(data: bytes, byte_order: str | None = None) -> Raw:
    """The functions of a universal file.

    Parameters
    ----------
    data : bytes
        The whole file.
    byte_order : {"little", "big"}, optional
        Overrules what a binary data set says of itself.
    """
    raw, offset, others = Raw("UFF58"), 0, Counter[int]()
    while (start := _DELIMITER.search(data, offset)) is not None:
        offset = start.end() + 1
        line, after = _line(data, offset)
        kind = line[:7].strip().lower()
        if kind in (b"58", b"58b"):
            check_columns(len(raw.columns) + 1, "the universal file")
            offset = _function(data, line, after, raw, byte_order)
            continue
        end = _DELIMITER.search(data, offset)
        others[int(kind) if kind.isdigit() else 0] += 1
        if others.total() > _MOST_OTHERS:
            raise InputError(
                "read", [f"the universal file has more than {_MOST_OTHERS} data sets that are no functions; export them alone"]
            )
        offset = end.end() + 1 if end else len(data)
    for number, count in others.items():
        if number:
            times = f" ({count} times)" if count > 1 else ""
            raw.notes.append(f"data set {number} of the file is left out{times}: only functions (data set 58) are read")
    if not raw.columns:
        raise InputError("read", ["the universal file holds no data set 58 (function at nodal points); export the time histories as UFF58"])
    return raw


def _line(data: bytes, start: int) -> tuple[bytes, int]:
    """The line that begins at `start`, and where the next one begins."""
    end = data.find(b"\n", start)
    return (data[start:], len(data)) if end < 0 else (data[start:end].rstrip(b"\r"), end + 1)


def _function(data: bytes, first: bytes, offset: int, raw: Raw, byte_order: str | None) -> int:
    lines = []
    for _ in range(_HEADER):
        line, offset = _line(data, offset)
        lines.append(unmarked(line))
    number = len(raw.columns) + 1
    head = _head(lines, number)
    if first[:7].strip().lower() == b"58b":
        values, offset = _binary(data, first, offset, head, number, raw.notes, byte_order)
    else:
        values, offset = _ascii(data, offset, head, number, raw.notes)
    raw.columns.append(_column(head, values, number, raw.notes))
    raw.info[f"function {number}"] = "; ".join(head.words)
    return offset


def _head(lines: list[str], number: int) -> _Head:
    try:
        kind, count, spacing = (int(float(word)) for word in lines[6].split()[:3])
        first, step = (float(word.replace("D", "E")) for word in lines[6].split()[3:5])
    except (ValueError, IndexError, OverflowError):
        raise _broken(number, f"its seventh line {lines[6][:60]!r} does not say type, count and spacing") from None
    if kind not in _TYPES or spacing not in (0, 1) or not 0 <= count < 2**40:
        raise _broken(number, f"data type {kind}, {count} values, spacing {spacing}; allowed are types 2, 4, 5 and 6, spacing 0 or 1")
    if spacing == 1 and not (np.isfinite(first) and np.isfinite(step)):
        raise _broken(number, f"its abscissa begins at {first} with step {step}")
    size, parts = _TYPES[kind]
    axis, ordinate = _label(lines[7], "abscissa"), _label(lines[8], "")
    entity = re.sub(r"\s+", " ", lines[5][31:41]).strip()
    name = next((n for n in (entity, ordinate[0], lines[0].strip()) if n and n.upper() != "NONE"), "")
    words = tuple(w.strip() for w in lines[:5] if w.strip() and w.strip().upper() != "NONE")
    return _Head(words, name, size, parts, count, spacing == 1, first, step, axis, ordinate)


def _label(line: str, otherwise: str) -> tuple[str, str | None]:
    """Name and unit of an axis (records 8 and 9)."""
    known = {"17": "time", "18": "frequency"}.get(line[:10].strip(), otherwise)
    name, unit = line[26:46].strip(), line[46:67].strip()
    return (name if name.upper() not in ("", "NONE") else known), (unit if unit.upper() not in ("", "NONE") else None)


def _broken(number: int, why: str) -> InputError:
    return InputError("read", [f"function {number} of the universal file is damaged: {why}; export the file again"])


def _numbers(head: _Head) -> int:
    """How many numbers the data hold."""
    return head.count * (head.parts + (0 if head.even else 1))


def _ascii(data: bytes, offset: int, head: _Head, number: int, notes: list[str]) -> tuple[Any, int]:
    end = _DELIMITER.search(data, offset)
    block = data[offset : end.start() if end else len(data)]
    if end is None:  # the last number may be cut anywhere
        block = block[: max(block.rstrip().rfind(b" "), block.rstrip().rfind(b"\n"), 0)]
    values = _in_text(block, number)
    if end is None:
        notes.append(f"function {number} has no closing line -1: the file is cut short")
    return _counted(values, head, number, notes), (end.end() + 1 if end else len(data))


_PIECE = 1 << 20  # characters that are read at once
_TOO_LONG = re.compile(rb"(?<![0-9.])[0-9.]{%d}" % MOST_NUMBER)


def _in_text(block: bytes, number: int) -> Any:
    """The numbers of a text, which may stand without blanks between them where each has a sign."""
    if _TOO_LONG.search(block):
        raise _broken(number, f"one of its numbers has more than {MOST_NUMBER} characters")
    parts, offset = [np.empty(0)], 0
    while offset < len(block):
        end = offset + _PIECE
        end = (
            next((i for i in range(end, min(end + 4 * MOST_NUMBER, len(block))) if block[i : i + 1].isspace()), end)
            if end < len(block)
            else end
        )
        piece = block[offset:end]
        offset = end
        if not piece.translate(None, _PLAIN):
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("error")
                    parts.append(np.fromstring(piece.decode("ascii"), sep=" "))  # ten times faster than one by one
                continue
            except (ValueError, DeprecationWarning):
                pass
        rest = _NUMBER.sub(b"", piece).translate(None, b" \t\r\n")
        if rest:
            raise _broken(number, f"{unmarked(rest[:20])!r} stands among its numbers")
        words = _NUMBER.findall(piece.translate(_EXPONENTS))
        parts.append(np.fromiter(map(float, words), float, len(words)))
    return np.concatenate(parts)


_PLAIN = b"0123456789.eE+- \t\r\n"
_EXPONENTS = bytes.maketrans(b"Dd", b"Ee")


def _counted(values: Array, head: _Head, number: int, notes: list[str]) -> Any:
    """The numbers as many as the head says; what is missing or too much is noted."""
    wanted = _numbers(head)
    if len(values) < wanted:
        notes.append(
            f"function {number} says {head.count} values and holds {len(values) * head.count // max(wanted, 1)}: the file is cut short"
        )
    elif len(values) > wanted:
        notes.append(f"function {number} says {head.count} values and holds {len(values) - wanted} numbers more, which are left out")
    return values[:wanted]


def _binary(data: bytes, first: bytes, offset: int, head: _Head, number: int, notes: list[str], byte_order: str | None) -> tuple[Any, int]:
    try:
        order, kind, lines, size = (int(word) for word in first[7:].split()[:4])
    except ValueError:
        raise _broken(number, f"its first line {unmarked(first[:60])!r} does not describe binary data") from None
    if order not in (1, 2) or kind != 2 or lines != _HEADER or size < 0:
        raise _broken(number, f"byte order {order}, number format {kind}, {lines} header lines; allowed are 1 or 2, 2 (IEEE) and {_HEADER}")
    wanted = _numbers(head) * head.size if head.even else head.count * (head.parts * head.size + 4)
    if size != wanted:
        notes.append(f"function {number} says {size} bytes, but {head.count} values take {wanted}")
    block = data[offset : offset + min(size, wanted)]
    order_name = byte_order or {1: "little", 2: "big"}[order]
    values = _as_numbers(block, head.size, order_name, number, byte_order is None) if head.even else _pairs(block, head, order_name)
    _check_end(data, offset + size, number, notes)
    return _counted(values, head, number, notes), offset + size


_END = re.compile(rb"[ \t\r\n\0]*-1[ \t]*(?:\r?\n|$)")


def _check_end(data: bytes, end: int, number: int, notes: list[str]) -> None:
    """Behind binary numbers the closing line -1 stands; where it does not, bytes were lost or added and the numbers are shifted."""
    if _END.match(data, end):
        return
    if data[end:].strip():
        raise _broken(number, "no closing line -1 stands behind its numbers, so bytes were lost or added within it")
    notes.append(f"function {number} has no closing line -1: bytes were lost, and its numbers may be shifted")


def _as_numbers(block: bytes, size: int, order: str, number: int, checked: bool) -> Any:
    """IEEE numbers; an error where only the other byte order makes sense."""
    block = block[: len(block) // size * size]
    here, other = (np.frombuffer(block, f"{sign}f{size}").astype(float) for sign in (("<", ">") if order == "little" else (">", "<")))
    if checked and _senseless(here) > 0.1 and _senseless(other) < 0.01:
        swapped = "big" if order == "little" else "little"
        raise InputError(
            "read",
            [f"function {number} says its bytes are {order}-endian, but only {swapped}-endian they make sense; "
             f'type ss.read(path, byte_order="{swapped}")'],
        )  # fmt: skip
    return here


def _senseless(values: Array) -> float:
    """The fraction of numbers that no sensor gives."""
    with np.errstate(invalid="ignore"):
        size = abs(values)
        return float(np.mean(~((size < 1e18) & ((size > 1e-18) | (size == 0))))) if len(values) else 0.0


def _pairs(block: bytes, head: _Head, order: str) -> Any:
    """Uneven binary data: each value behind its abscissa, which is a single-precision number."""
    sign = "<" if order == "little" else ">"
    kind = np.dtype([("x", f"{sign}f4"), ("y", f"{sign}f{head.size}", (head.parts,))])
    pairs = np.frombuffer(block[: len(block) // kind.itemsize * kind.itemsize], kind)
    return np.column_stack([pairs["x"].astype(float), pairs["y"].astype(float)]).ravel()


def _column(head: _Head, numbers: Any, number: int, notes: list[str]) -> RawColumn:
    width = head.parts + (0 if head.even else 1)
    rows = numbers[: len(numbers) // width * width].reshape(-1, width)
    values = rows[:, -1] if head.parts == 1 else rows[:, -2] + 1j * rows[:, -1]
    x = head.first + head.step * np.arange(len(rows)) if head.even else rows[:, 0]
    if head.even and not head.step > 0 and len(rows) > 1:
        notes.append(f"function {number} has abscissa step {head.step:g}; allowed is a positive step")
    return RawColumn(head.name, head.ordinate[1], values, RawColumn(head.axis[0], head.axis[1], x))
