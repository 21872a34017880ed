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
    at = -1
    while (at := data.find(_BEGIN, at + 1)) >= 0:
        (size,) = struct.unpack("<Q", data[at + 8 : at + _HEAD].ljust(8, b"\0"))
        if not _HEAD <= size <= len(data) - at:
            raise ValueError(f"a heap of its texts declares {size} bytes")
        _check_objects(data, at + _HEAD, at + size)


def _check_objects(data: Any, at: int, end: int) -> None:
    while at + _HEAD <= end:
        number, _, _, size = struct.unpack("<HHIQ", data[at : at + _HEAD])
        if number == 0:
            if size != end - at:
                raise ValueError("a heap of its texts does not end where declared")
            return
        at += _HEAD + -(-size // 8) * 8
    if at > end:
        raise ValueError("a heap of its texts does not end where declared")
