"""Global heaps of a file, where its texts lie: the HDF5 library goes round without end in a damaged one, so each is gone through before.

A heap begins with GCOL, a version and its size; its objects follow, each with a number, a size and its bytes, padded to eight. The number 0
says that the rest is free (HDF5 File Format Specification 3.0, III.E).
"""

from __future__ import annotations

import struct
from typing import Any

_BEGIN, _HEAD = b"GCOL\x01\x00\x00\x00", 16


def check_heaps(data: Any) -> None:
    """That every heap in the bytes of a file has an end; `ValueError` where one has none."""
    place = -1
    while (place := data.find(_BEGIN, place + 1)) >= 0:
        (size,) = struct.unpack("<Q", data[place + 8 : place + _HEAD].ljust(8, b"\0"))
        if not _HEAD <= size <= len(data) - place:
            raise ValueError(f"a heap of its texts declares {size} bytes")
        _check_objects(data, place + _HEAD, place + size)


def _check_objects(data: Any, place: int, end: int) -> None:
    while place + _HEAD <= end:
        number, _, _, size = struct.unpack("<HHIQ", data[place : place + _HEAD])
        if number == 0:
            if size != end - place:
                raise ValueError("a heap of its texts does not end where declared")
            return
        place += _HEAD + -(-size // 8) * 8
    if place > end:
        raise ValueError("a heap of its texts does not end where declared")
