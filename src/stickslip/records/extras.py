"""TDMS, and how the libraries of ``pip install "stickslip[io]"`` and ``"stickslip[robot]"`` are called."""

from __future__ import annotations

import contextlib
import io
import logging
import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.basics import optional
from stickslip.basics.errors import InputError
from stickslip.basics.unpacking import Allowance
from stickslip.records.raw import Raw, RawColumn

_MISSING = '{what} files are read by {name}, which is not installed; type pip install "stickslip[{extra}]"'
_SCALE, _MOST_SCALES = re.compile(r"NI_Number_Of_Scales$|NI_Scale\[(\d+)\]"), 1000


def library(name: str, what: str, extra: str = "io") -> Any:
    """The library that reads a format; an error that says what to type where it is not installed."""
    return optional.library("read", name, _MISSING.format(what=what, name=name.partition(".")[0], extra=extra))


def missing(name: str, what: str) -> InputError:
    """The error of a format whose library is not installed."""
    return InputError("read", [_MISSING.format(what=what, name=name, extra="io")])


@contextlib.contextmanager
def damage_reported(what: str) -> Iterator[None]:
    """Whatever goes wrong inside is said of the file, which is damaged: a damaged file meets a library at any place."""
    try:
        yield
    except InputError:
        raise
    except Exception as error:
        why = "it asks for more memory than there is" if isinstance(error, MemoryError) else f"{type(error).__name__}: {str(error)[:120]}"
        raise InputError("read", [f"the {what} file is damaged ({why}); export it again"]) from None


def parse_tdms(data: bytes, allowance: Allowance) -> Raw:
    """The channels of a TDMS file, each over the time that its properties give."""
    nptdms, raw = library("nptdms", "TDMS"), Raw("TDMS")
    with damage_reported("TDMS"):
        with _heard("nptdms", raw.notes):
            _check_declared(nptdms.TdmsFile.read_metadata(io.BytesIO(data)), allowance)
            file = nptdms.TdmsFile.read(io.BytesIO(data))
        several = len(file.groups()) > 1
        raw.info |= {str(name): str(value) for name, value in file.properties.items()}
        for group in file.groups():
            for channel in group.channels():
                values = np.asarray(channel[:])
                if values.dtype.kind not in "biufc" or values.size == 0:
                    raw.notes.append(f"{channel.name} is left out: it holds no numbers")
                    continue
                name = f"{group.name}.{channel.name}" if several else channel.name
                unit = channel.properties.get("unit_string") or None
                raw.columns.append(RawColumn(name, unit, values.astype(float), _waveform_axis(channel, len(values))))
    _check_segments(data, raw.notes)
    raw.table = all(column.axis is None for column in raw.columns)
    if not raw.columns:
        raise InputError("read", ["the TDMS file holds no channel of numbers"])
    return raw


def _check_declared(file: Any, allowance: Allowance) -> None:
    """Refuse channels that declare more numbers than the file may unpack to, or scalings without end."""
    for channel in (channel for group in file.groups() for channel in group.channels()):
        allowance.take(16 * max(len(channel), 0), repr(channel.name))  # once as stored, once scaled
        for name, value in channel.properties.items():
            if (match := _SCALE.match(name)) and int(match[1] or value) > _MOST_SCALES:
                raise InputError("read", [f"{channel.name!r} says that it is scaled {int(match[1] or value)} times; export the file again"])


def _check_segments(data: bytes, notes: list[str]) -> None:
    """Each segment says where the next one begins; where bytes were added within one, its numbers are shifted."""
    offset = 0
    while data[offset : offset + 4] == b"TDSm" and offset + 28 <= len(data):
        offset += 28 + int.from_bytes(data[offset + 12 : offset + 20], "little")
    if offset != len(data):
        notes.append(f"the segments of the file end at byte {min(offset, 2**63)} and it has {len(data)}: bytes were added or lost")


@contextlib.contextmanager
def _heard(name: str, notes: list[str]) -> Iterator[None]:
    """Turns a library's log messages into notes, instead of lines on the terminal."""
    handler = logging.Handler(logging.WARNING)
    handler.emit = lambda record: notes.append(f"{name}: {record.getMessage()[:160]}")  # type: ignore[method-assign]
    all_names = [name, *(n for n in logging.root.manager.loggerDict if n.startswith(f"{name}."))]
    loggers = [logging.getLogger(n) for n in all_names]
    before = [(logger.handlers, logger.propagate) for logger in loggers]
    for logger in loggers:
        logger.handlers, logger.propagate = [handler], False
    try:
        yield
    finally:
        for logger, (handlers, propagate) in zip(loggers, before, strict=True):
            logger.handlers, logger.propagate = handlers, propagate


def _waveform_axis(channel: Any, count: int) -> RawColumn | None:
    step = channel.properties.get("wf_increment")
    if not step:
        return None
    return RawColumn("time", "s", float(channel.properties.get("wf_start_offset", 0.0)) + float(step) * np.arange(count))
