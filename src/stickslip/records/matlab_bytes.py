"""The bytes of MATLAB files of versions 4 to 7.2, every length checked: the usual library can crash the process on damaged ones."""

from __future__ import annotations

import zlib
from typing import Any

import numpy as np

from stickslip.basics.unpacking import Allowance

_KINDS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8", 16: "u1", 17: "u2", 18: "u4"}
_MATRIX, _COMPRESSED = 14, 15
_STRUCT, _CHAR, _NUMERIC = 2, 4, range(6, 16)
#: Class of an array -> types in which its numbers may be stored: its own, or a shorter whole number.
_SHORT = (1, 2, 3, 4, 5, 6)
_STORED = {_CHAR: (1, 2, 3, 4, 16, 17, 18), 6: (*_SHORT, 9), 7: (*_SHORT, 7)} | {k: (*_SHORT, 12, 13) for k in range(8, 16)}
_OLD = {0: "f8", 1: "f4", 2: "i4", 3: "i2", 4: "u2", 5: "u1"}


def version5(data: bytes, notes: list[str], allowance: Allowance) -> dict[str, Any]:
    """The variables of a version 5 file by name: arrays, texts, and dicts for structs. `ValueError` where the bytes make no sense."""
    order = {b"IM": "<", b"MI": ">"}.get(data[126:128])
    if order is None:
        raise ValueError("its header does not say the byte order")
    variables: dict[str, Any] = {}
    offset = 128
    while offset + 8 <= len(data):
        kind, body, offset = _element(data, offset, order)
        if kind == _COMPRESSED:
            body = _inflated(body, order, allowance)
            kind, body, _ = _element(body, 0, order)
        if kind != _MATRIX:
            raise ValueError(f"an element of type {kind} stands where a variable should")
        name, value = _matrix(body, order, allowance, 0)
        if value is None:
            notes.append(f"{name} is left out: it is not an array of numbers")
        else:
            variables[name] = value
    if data[offset:].strip(b"\0"):
        raise ValueError(f"{len(data) - offset} bytes are left over at its end")
    return variables


def _inflated(body: bytes, order: str, allowance: Allowance) -> bytes:
    """The variable in a compressed element, which begins by saying how long it is; no more than that is unpacked."""
    machine = zlib.decompressobj()
    try:
        tag = machine.decompress(body, 8)
        size = int(np.frombuffer(tag[4:8], f"{order}u4")[0]) if len(tag) == 8 else 0
        allowance.take(size, "a compressed variable")
        unpacked = tag + machine.decompress(machine.unconsumed_tail, size + 8)  # padded to eight bytes
        unpacked += machine.decompress(machine.unconsumed_tail, 1)  # where it ends, the sum is checked now
    except zlib.error as error:
        raise ValueError(f"a compressed variable is damaged, {error}") from None
    if not machine.eof or machine.unused_data:  # only at its end does a stream check its own sum
        raise ValueError("a compressed variable does not end where it should")
    return unpacked


def _element(data: bytes, offset: int, order: str) -> tuple[int, bytes, int]:
    """Type and bytes of an element, and where the next begins."""
    if offset + 8 > len(data):
        raise ValueError("it ends within a variable")
    first, size = (int(x) for x in np.frombuffer(data[offset : offset + 8], f"{order}u4"))
    if first >> 16:  # a small element: four bytes of data within the tag
        kind, size = first & 0xFFFF, first >> 16
        if size > 4:
            raise ValueError("a small element is too long")
        return kind, data[offset + 4 : offset + 4 + size], offset + 8
    start = offset + 8
    if start + size > len(data):
        raise ValueError(f"a variable says {size} bytes where {len(data) - start} are left")
    end = start + size
    return first, data[start:end], end if first == _COMPRESSED else min(start + -(-size // 8) * 8, max(len(data), end))


def _matrix(body: bytes, order: str, allowance: Allowance, depth: int) -> tuple[str, Any]:
    """Name and value of a variable."""
    if depth > 16:
        raise ValueError("structs are nested too deeply")
    if not body:
        return "", np.empty(0)
    _, flags, offset = _element(body, 0, order)
    word = int(np.frombuffer(flags[:4], f"{order}u4")[0]) if len(flags) >= 4 else 0
    _, dims, offset = _element(body, offset, order)
    shape = tuple(int(n) for n in np.frombuffer(dims[: len(dims) // 4 * 4], f"{order}i4"))
    _, label, offset = _element(body, offset, order)
    name, kind = label.decode("latin-1"), word & 0xFF
    if any(n < 0 for n in shape):
        raise ValueError(f"{name!r} has shape {shape}")
    if kind in _NUMERIC or kind == _CHAR:
        value, offset = _numbers(body, offset, order, shape, _STORED[kind], allowance)
        if kind == _CHAR:
            return name, "".join(chr(int(c)) for c in value.ravel(order="F")[:4000])
        if word & 0x0800:
            imaginary, offset = _numbers(body, offset, order, shape, _STORED[kind], allowance)
            value = value + 1j * imaginary
        return name, value
    return (name, _struct(body, offset, order, allowance, depth)) if kind == _STRUCT and shape == (1, 1) else (name, None)


def _numbers(
    body: bytes, offset: int, order: str, shape: tuple[int, ...], stored: tuple[int, ...], allowance: Allowance
) -> tuple[Any, int]:
    kind, raw, offset = _element(body, offset, order)
    if kind not in stored:
        raise ValueError(f"numbers of type {kind} in an array that cannot be stored so")
    kept = np.dtype(f"{order}{_KINDS[kind]}")
    count = 1
    for n in shape:
        count *= n
    if count * kept.itemsize != len(raw):
        raise ValueError(f"{len(raw)} bytes for an array of shape {shape}")
    allowance.take(16 * count, "a variable")  # complex where it has an imaginary part
    return np.frombuffer(raw, kept).astype(float).reshape(shape, order="F"), offset


def _struct(body: bytes, offset: int, order: str, allowance: Allowance, depth: int) -> dict[str, Any]:
    _, width, offset = _element(body, offset, order)
    _, names, offset = _element(body, offset, order)
    size = int(np.frombuffer(width[:4], f"{order}i4")[0]) if len(width) >= 4 else 0
    if not 0 < size <= 256:
        raise ValueError(f"field names of {size} bytes")
    fields = [names[i : i + size].split(b"\0")[0].decode("latin-1") for i in range(0, len(names), size)]
    values = {}
    for field in fields:
        _, part, offset = _element(body, offset, order)
        value = _matrix(part, order, allowance, depth + 1)[1]
        if value is not None:
            values[field] = value
    return values


def version4(data: bytes, allowance: Allowance) -> dict[str, Any]:
    """The matrices of a version 4 file by name."""
    variables: dict[str, Any] = {}
    offset = 0
    while offset < len(data):
        if offset + 20 > len(data):
            raise ValueError("it ends within a header")
        order = "<" if 0 <= int(np.frombuffer(data[offset : offset + 4], "<i4")[0]) < 5000 else ">"
        kind, rows, cols, imaginary, length = (int(x) for x in np.frombuffer(data[offset : offset + 20], f"{order}i4"))
        number = _OLD.get(kind // 10 % 10)
        if (
            number is None
            or kind not in (kind % 100, 1000 + kind % 100)
            or kind % 10 > 1
            or min(rows, cols, length) < 0
            or imaginary not in (0, 1)
        ):
            raise ValueError(f"a header of type {kind}, {rows} x {cols}")
        kept = np.dtype(order + number)
        start = offset + 20 + length
        offset = start + rows * cols * kept.itemsize * (1 + imaginary)
        if offset > len(data):
            raise ValueError(f"{rows} x {cols} numbers where {len(data) - start} bytes are left")
        name = data[start - length : start].split(b"\0")[0].decode("latin-1")
        allowance.take(16 * rows * cols, name or "a matrix")
        parts = np.frombuffer(data[start:offset], kept).astype(float).reshape(1 + imaginary, cols, rows)
        value = parts[0].T + (1j * parts[1].T if imaginary else 0.0)
        variables[name] = (
            "".join(chr(int(c)) for c in value.ravel()) if kind % 10 == 1 and (value >= 0).all() and (value < 65536).all() else value
        )
    return variables
