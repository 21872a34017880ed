"""`read`: from a file of any known format to a `Record`. The format is recognised from the content, not from the name."""

from __future__ import annotations

import dataclasses
import hashlib
import os
import stat
from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from stickslip.basics.arguments import Recorded, explains_arguments
from stickslip.basics.errors import InputError, Problems, as_path, did_you_mean, is_whole
from stickslip.basics.units import quantity_of, unit_named, unit_of_heading
from stickslip.basics.unpacking import Allowance
from stickslip.records.apart import read_apart
from stickslip.records.axes import by_own_times, counted, table_axes
from stickslip.records.channel import MEASURED, ROLES, UNUSED, Channel
from stickslip.records.formats import format_of
from stickslip.records.raw import Raw, RawColumn
from stickslip.records.record import Record
from stickslip.records.roles import OURS, remark_range, remarks, roles_of
from stickslip.records.saving import SYNTHETIC, roles_in
from stickslip.records.scaling import scaled
from stickslip.records.tables_of_values import is_frame, raw_of_frame


@explains_arguments
def read(
    path: Recorded,
    *,
    units: dict[str, str] | None = None,
    columns: Sequence[str] | None = None,
    roles: dict[str, str] | None = None,
    rate: float | None = None,
    scale: dict[str, Any] | None = None,
    separator: str | None = None,
    decimal: str | None = None,
    byte_order: str | None = None,
    episode: int | None = None,
) -> Record:
    r"""Read a measured record: CSV, TSV, TXT, JSON, UFF58, MATLAB (v4 to v7.3), TDMS, netCDF, HDF5 or XLSX; or a data frame.

    Robot logs are read too: MCAP, ROS bag, ROS 2 bag, Parquet (LeRobot) and BAM's JSON.

    Separator, decimal mark, headings and units are recognised. Units are never guessed: a channel without one is read with ``unit=None``
    and a line in `Record.notes`; the first step that needs the unit stops and shows what to type.

    Parameters
    ----------
    path : str, Path or data frame
        A file; or columns by name, as a data frame of pandas or a mapping of arrays, with units in the names, such as ``"v [mm/s]"``. An
        index of timestamps, or one that has a name, is a column too.
    units : dict, optional
        Units of channels (or of the time column) by name, such as ``{"LDV": "m/s"}``.
    columns : sequence of str, optional
        Headings of all columns of a table, with units: ``["t [ms]", "v [mm/s]"]``.
    roles : dict, optional
        Roles of the channels, by name: one of "velocity" (of the body), "absolute velocity" (of the inner mass), "position", "force",
        "load", "drive", "acceleration", "pressure", "voltage"; or "unused", of a channel that is to have none. Otherwise the role follows
        from name and unit, if these are unambiguous.
    rate : float, optional
        Samples per second of a file without a time axis [Hz].
    scale : dict, optional
        Sensitivities of sensors by channel, for numbers that are volts: ``{"LDV": "25 mm/s/V"}`` or ``{"acc": "100 mV/g"}`` (in which g
        is gravity); or plain factors, ``{"F": 4.7}``, after which the unit is that of the file or of `units`.
    separator, decimal : str, optional
        For a text file in which they are not recognised correctly.
    byte_order : {"little", "big"}, optional
        For a binary UFF58 file that specifies the wrong one.
    episode : int, optional
        Of a LeRobot table of several, by its number there; by default the first.

    Returns
    -------
    Record

    Raises
    ------
    InputError
        The file cannot be read or is damaged beyond use. Smaller damage is reported in `Record.notes`.

    Examples
    --------
    >>> import stickslip as ss
    >>> with open("run.csv", "w") as file:
    ...     _ = file.write("t [ms];v [mm/s];F\n0;1,5;2\n1;2,5;2\n2;3,5;3\n")
    >>> rec = ss.read("run.csv", units={"F": "N"})
    >>> rec["velocity"].values.tolist(), rec["velocity"].unit, rec["velocity"].rate
    ([1.5, 2.5, 3.5], 'mm/s', 1000.0)
    """
    options: dict[str, Any] = {"units": units or {}, "columns": columns, "roles": roles or {}, "rate": rate, "scale": scale or {}}
    if is_frame(path):
        return _record("", b"", raw_of_frame(path), **options)
    path = as_path(path, "read", "run.csv")
    return read_bytes(_bytes(path), str(path), separator, decimal, byte_order, episode, **options)


def read_bytes(
    data: bytes, name: str, separator: str | None = None, decimal: str | None = None, byte_order: str | None = None,
    episode: int | None = None, **options: Any,
) -> Record:  # fmt: skip
    """The record in the bytes of a file; `name` is where it says that it comes from."""
    with np.errstate(all="ignore"):  # a damaged file holds any number
        raw = _parsed(data, {"separator": separator, "decimal": decimal, "byte_order": byte_order, "episode": episode})
        return _record(name, data, raw, **({"units": {}, "columns": None, "roles": {}, "rate": None, "scale": {}} | options))


def _record(
    path: str, data: bytes, raw: Raw, units: dict[str, str], columns: Sequence[str] | None, roles: dict[str, str], rate: float | None,
    scale: dict[str, Any],
) -> Record:  # fmt: skip
    """The record of what a format's reader found, with what the user says about it."""
    problems = Problems("read")
    _rename(raw, columns, problems)
    _give_units(raw, units, problems)
    scaled(raw, scale, problems)
    in_preamble = roles_in(raw.info.get("preamble", ""))
    raw.columns = [dataclasses.replace(c, role=in_preamble.get(c.name, c.role)) for c in raw.columns]
    _check_roles(raw, roles, problems)
    if rate is not None and not rate > 0:
        problems.add(f"rate = {rate!r}; allowed is a positive number [Hz]; type for example rate=1280.0")
    problems.check()
    channels = _channels(raw, rate, roles)
    source = {"path": path, "format": raw.format, "bytes": len(data), "sha256": hashlib.sha256(data).hexdigest(), **raw.info}
    ours = set(OURS) <= {c.name for c in channels}
    notes = ["the columns are those of a run of stickslip: computed, not measured"] if ours else []
    if said := SYNTHETIC in raw.info.get("preamble", ""):
        notes.append("the file says that it is a synthetic record: computed, not measured")
    if not (ours or said):  # what is computed has no sensor
        for c in channels:
            remark_range(c, raw.notes)
    return Record({c.name: c for c in channels}, (*notes, *raw.notes), source, synthetic=ours or said)


def _bytes(path: Path) -> bytes:
    """The bytes of a file or a pipe, no more than are allowed; a device has no end."""
    try:
        with path.open("rb") as file:
            kind = os.fstat(file.fileno())
            Allowance("read", kind.st_size).check_file()
            if stat.S_ISREG(kind.st_mode):
                return file.read()
            if stat.S_ISFIFO(kind.st_mode):
                return _piped(file)
        why = "it is not a file"
    except InputError:
        raise
    except (OSError, ValueError) as error:  # a zero byte in a name is a ValueError
        why = getattr(error, "strerror", None) or str(error)
    raise InputError("read", [f"{str(path)!r} cannot be read: {why}; give the path of a record"])


def _piped(file: BinaryIO) -> bytes:
    data = bytearray()
    while part := file.read(1 << 20):
        data += part
        Allowance("read", len(data)).check_file()
    return bytes(data)


def _parsed(data: bytes, typed: dict[str, Any]) -> Raw:
    """The output of the format's reader, with what was typed for some of the formats."""
    if not data.strip():
        raise InputError("read", ["the file is empty"])
    given, known, episode = {"allowance": Allowance("read", len(data))} | typed, format_of(data), typed["episode"]
    if episode is not None and ("episode" not in known.takes or not is_whole(episode)):
        raise InputError("read", [f"episode = {episode!r}; allowed is the number of an episode in a LeRobot table (Parquet); leave it out"])
    return read_apart(known, data) if known.apart else known.reader()(data, *(given[name] for name in known.takes))


# ---- what the user adds ----
def _rename(raw: Raw, columns: Sequence[str] | None, problems: Problems) -> None:
    if columns is None:
        return
    if len(columns) != len(raw.columns):
        problems.add(
            f'columns names {len(columns)} columns; the file has {len(raw.columns)}; name every one, such as columns=["t [ms]", ...]'
        )
        return
    raw.columns = [RawColumn(*unit_of_heading(text), c.values, c.axis) for text, c in zip(columns, raw.columns, strict=True)]


def _give_units(raw: Raw, units: dict[str, str], problems: Problems) -> None:
    _name_all(raw)
    known = [c.name for c in raw.columns] + [c.axis.name for c in raw.columns if c.axis is not None]
    for name, text in units.items():
        if name not in known:
            problems.add(f"units names {name!r}; {did_you_mean(name, dict.fromkeys(known))}")
        elif unit_named(text) is None:
            problems.add(f'the unit {text!r} of {name!r} is not known; allowed are SI units with prefixes, such as "mm/s", "uN", "bar"')

    for c in {id(c): c for c in (*raw.columns, *(c.axis for c in raw.columns if c.axis is not None))}.values():
        old, new = quantity_of(c.unit), quantity_of(units.get(c.name))
        if old and new and old != new:
            raw.notes.append(
                f"{c.name}: the unit {c.unit!r} of the file, of {old}, is replaced by {units[c.name]!r}, of {new}, as was typed"
            )

    def with_unit(c: RawColumn) -> RawColumn:
        axis = None if c.axis is None else with_unit(c.axis)
        return RawColumn(c.name, units.get(c.name, c.unit), c.values, axis, c.role)

    raw.columns = [with_unit(c) for c in raw.columns]


def _name_all(raw: Raw) -> None:
    """A name for every column, and no name twice."""
    wanted = [c.name or f"column {i}" for i, c in enumerate(raw.columns, start=1)]
    taken, counts, again = set(wanted), dict.fromkeys(wanted, 0), []
    for i, (c, name) in enumerate(zip(raw.columns, wanted, strict=True)):
        counts[name] += 1
        while counts[name] > 1 and (called := f"{name} ({counts[name]})") in taken:
            counts[name] += 1
        if counts[name] > 1:
            again.append(called)
            taken.add(called)
        raw.columns[i] = dataclasses.replace(c, name=called if counts[name] > 1 else name)
    if again:
        shown = ", ".join(repr(n) for n in again[:6]) + (", ..." if len(again) > 6 else "")
        raw.notes.append(f"names stand over several columns: the later ones are called {shown}")


def _check_roles(raw: Raw, roles: dict[str, str], problems: Problems) -> None:
    for name, role in roles.items():
        if name not in [c.name for c in raw.columns]:
            problems.add(f"roles names {name!r}; {did_you_mean(name, [c.name for c in raw.columns])}")
        if role not in (*ROLES, UNUSED, "convected velocity"):
            problems.add(f"the role {role!r} of {name!r} is not known; {did_you_mean(role, ROLES)}")
    for c in raw.columns:
        role = {"convected velocity": "velocity"}.get(roles.get(c.name, ""), roles.get(c.name, ""))
        measures = quantity_of(c.unit)
        if role in ROLES and measures not in (None, "ratio", *MEASURED.get(role, (role,))):
            problems.add(f"{c.name!r} is in {c.unit}, a unit of {measures}, and cannot be the {role}; give another channel this role")


# ---- axes ----
def _channels(raw: Raw, rate: float | None, roles: dict[str, str]) -> list[Channel]:
    if raw.table:
        raw.columns = by_own_times(raw.columns, raw.notes)
    axes = table_axes(raw) if raw.table else {}
    used = {id(axis) for axis in axes.values()}
    for c in raw.columns:
        for part in (c, c.axis) if c.axis else (c,):
            part.values.setflags(write=False)  # nobody else has these arrays: channels share them
    named, channels = roles_of([c for c in raw.columns if id(c) not in used], roles), []
    for c in raw.columns:
        if id(c) in used:
            continue
        axis = c.axis or axes.get(len(c.values)) or counted(c, rate, raw.notes)
        channels.append(Channel(c.name, c.values, c.unit, axis.values, axis.name, axis.unit, named.get(c.name)))
    for axis in axes.values():
        if all(len(axis.values) != len(c) for c in channels) and channels:
            raw.notes.append(f"{axis.name} has {len(axis.values)} values and no other column as many: it is not used")
    if not channels and raw.columns:
        c = raw.columns[0]
        channels = [Channel(c.name, c.values, c.unit, np.arange(len(c.values), dtype=float), "sample", None, None)]
    raw.notes += remarks(channels)
    return channels
