"""Formats whose readers come with ``pip install "stickslip[io]"``: TDMS and XLSX."""

from __future__ import annotations

import contextlib
import importlib
import io
import logging
from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.errors import InputError
from stickslip.records.raw import Column, Raw
from stickslip.records.text import table

__all__ = ["parse_tdms", "parse_xlsx"]


def _library(name: str, what: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        raise InputError("read", [f'{what} files are read by {name}, which is not installed; type pip install "stickslip[io]"']) from None


def _broken(what: str, error: Exception) -> InputError:
    return InputError("read", [f"the {what} file is damaged ({type(error).__name__}: {str(error)[:120]}); export it again"])


def parse_tdms(data: bytes) -> Raw:
    """The channels of a TDMS file, each over the time that its properties give."""
    nptdms, raw = _library("nptdms", "TDMS"), Raw("TDMS")
    try:
        with _heard("nptdms", raw.notes):
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
                raw.columns.append(Column(name, unit, values.astype(float), _waveform_axis(channel, len(values))))
    except InputError:
        raise
    except Exception as error:  # a damaged file meets the library at any place
        raise _broken("TDMS", error) from None
    _check_segments(data, raw.notes)
    raw.table = all(column.axis is None for column in raw.columns)
    if not raw.columns:
        raise InputError("read", ["the TDMS file holds no channel of numbers"])
    return raw


def _check_segments(data: bytes, notes: list[str]) -> None:
    """Each segment says where the next one begins; where bytes were added within one, its numbers are shifted."""
    place = 0
    while data[place : place + 4] == b"TDSm" and place + 28 <= len(data):
        place += 28 + int.from_bytes(data[place + 12 : place + 20], "little")
    if place != len(data):
        notes.append(f"the segments of the file end at byte {min(place, 2**63)} and it has {len(data)}: bytes were added or lost")


@contextlib.contextmanager
def _heard(name: str, notes: list[str]) -> Iterator[None]:
    """What a library writes to its log becomes notes, instead of lines on the terminal."""
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


def _waveform_axis(channel: Any, count: int) -> Column | None:
    step = channel.properties.get("wf_increment")
    if not step:
        return None
    return Column("time", "s", float(channel.properties.get("wf_start_offset", 0.0)) + float(step) * np.arange(count))


def parse_xlsx(data: bytes) -> Raw:
    """The table on the first sheet of an Excel file."""
    openpyxl, raw = _library("openpyxl", "XLSX"), Raw("XLSX", table=True)
    try:
        book = openpyxl.load_workbook(io.BytesIO(data), read_only=True, data_only=True)
        rows = [list(row) for row in book.worksheets[0].iter_rows(values_only=True)]
        if len(book.worksheets) > 1:
            raw.notes.append(f"the file has {len(book.worksheets)} sheets; the first one, {book.worksheets[0].title!r}, is read")
    except Exception as error:  # a damaged file meets the library at any place
        raise _broken("XLSX", error) from None
    raw.columns = table([row for row in rows if any(cell is not None for cell in row)], raw.notes)
    return raw
