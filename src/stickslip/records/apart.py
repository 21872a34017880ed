"""Formats whose libraries may crash on a damaged file, or go on for ever, are read by a process with limits of memory and time."""

from __future__ import annotations

import functools
import importlib.util
import io
import json
import math
import os
from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.basics.child_process import ChildEnded, ChildProcess
from stickslip.basics.errors import InputError
from stickslip.basics.unpacking import VARIABLE, Allowance
from stickslip.records.extras import missing
from stickslip.records.formats import Format
from stickslip.records.raw import Raw, RawColumn

#: Time for a file [s], and for each byte of it: a file of a gigabyte takes ten seconds.
_SECONDS, _PER_BYTE = 60.0, 1e-7
#: How often the process has what it unpacks in memory: as the library has it, as columns, and twice as bytes.
_COPIES = 5
_COMPLEX = "complex number"  # no name of a variable has a blank


def read_apart(known: Format, data: bytes) -> Raw:
    """What the reader of a format makes of bytes, in a process of its own; `InputError` where that ends or has not the time."""
    name, limit = known.names[0], Allowance("read", len(data)).limit
    if known.library and importlib.util.find_spec(known.library) is None:
        raise missing(known.library, name)
    wish, memory = {"format": name, "largest": os.environ.get(VARIABLE, "")}, _COPIES * limit + 2 * len(data)
    try:
        answer = _child().ask(wish, data, _SECONDS + _PER_BYTE * len(data), memory)
    except ChildEnded as ended:
        why = "reading it has no end" if ended.late else "the process that reads it crashes"
        raise InputError("read", [f"the {name} file is damaged ({why}); export it again"]) from None
    except OSError as error:
        raise InputError("read", [f"no process could be started to read the {name} file: {error.strerror}; free some memory"]) from None
    line, arrays = answer.partition(b"\n")[::2]
    head = json.loads(line, object_hook=lambda d: complex(*d[_COMPLEX]) if set(d) == {_COMPLEX} else d)
    if head["problems"]:
        raise InputError("read", head["problems"])
    numbers = io.BytesIO(arrays)
    columns = [_column(described, numbers) for described in head["columns"]]
    return Raw(head["format"], columns, head["info"], head["notes"], head["table"])


@functools.cache
def _child() -> ChildProcess:
    return ChildProcess("stickslip.records.apart_process")


def _column(described: list[Any] | None, numbers: io.BytesIO) -> Any:
    if described is None:
        return None
    name, unit, kind, shape, axis, role = described
    size = np.dtype(kind).itemsize * math.prod(shape)
    values = np.frombuffer(numbers.read(size), kind).reshape(shape)
    return RawColumn(name, unit, values, _column(axis, numbers), role)


# ---- in the process ----
def packed(raw: Raw) -> bytes:
    """A line of JSON, and the numbers of the columns one after the other.

    Examples
    --------
    >>> packed(Raw("XLSX", [RawColumn("v", "m/s", np.zeros(0))], {"gain": 2j}))[:62]
    b'{"problems": [], "format": "XLSX", "columns": [["v", "m/s", "<'
    """
    head = {"problems": [], **vars(raw), "columns": [_described(c) for c in raw.columns]}
    line = json.dumps(head, default=lambda number: {_COMPLEX: [number.real, number.imag]}).encode()
    return b"\n".join([line, b"".join(part for c in raw.columns for part in _numbers(c))])


def _described(c: RawColumn | None) -> list[Any] | None:
    return None if c is None else [c.name, c.unit, c.values.dtype.str, c.values.shape, _described(c.axis), c.role]


def _numbers(c: RawColumn) -> Iterator[bytes]:
    yield c.values.tobytes()
    if c.axis is not None:
        yield from _numbers(c.axis)
