"""HDF5, netCDF and MATLAB 7.3: arrays in groups, with attributes."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import Any

import numpy as np

from stickslip.basics import hdf5
from stickslip.basics.errors import InputError
from stickslip.basics.unpacking import Allowance
from stickslip.records.extras import damage_reported
from stickslip.records.matlab_files import vectors
from stickslip.records.raw import Raw, RawColumn

_DEEPEST = 8  # groups within groups


def parse_hdf5(data: bytes, allowance: Allowance) -> Raw:
    """The vectors of an HDF5 file, which a netCDF4 or MATLAB 7.3 file is too."""
    raw = Raw("MATLAB 7.3" if data.startswith(b"MATLAB") else "HDF5", table=True)
    with damage_reported(raw.format), hdf5.checked_file(io.BytesIO(data), "read", allowance) as file:
        attributes = hdf5.plain_attributes(file, allowance, len(data))
        if "_NCProperties" in attributes:
            raw.format = "netCDF4"
        raw.info |= {str(name): _plain(value) for name, value in attributes.items() if not str(name).startswith("_")}
        _check_length(data, raw.notes)
        for name, item in _datasets(file, raw.notes):
            _dataset(item, hdf5.plain_attributes(item, allowance, len(data)), raw, name)
    if not raw.columns:
        raise InputError("read", ["the HDF5 file holds no vector of numbers; save the time and the channels as vectors"])
    return raw


def _check_length(data: bytes, notes: list[str]) -> None:
    """The file says how long it is; where bytes were added within it, everything behind them is shifted."""
    start = 512 if data[512:520] == b"\x89HDF\r\n\x1a\n" else 0
    offset = start + (40 if data[start + 8] < 2 else 28)
    says = int.from_bytes(data[offset : offset + 8], "little")
    if len(data) not in (says, says + start):
        notes.append(f"the file has {len(data)} bytes and says {says}: bytes were added or lost, and numbers may be shifted")


def _plain(value: Any) -> Any:
    value = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
    return value.item() if getattr(value, "size", 0) == 1 else str(value)[:4000]


def _datasets(group: Any, notes: list[str], prefix: str = "", above: tuple[int, ...] = ()) -> Iterator[tuple[str, Any]]:
    """The datasets of a group and of the groups in it, each once, with their names."""
    import h5py

    for name, item in hdf5.members(group, "read"):
        if name.startswith("#") or name == "pieces":  # MATLAB's own store; the dense output of our runs
            continue
        if isinstance(item, h5py.Dataset):
            yield prefix + name, item
        elif not isinstance(item, h5py.Group):
            notes.append(f"{prefix}{name} is left out: it is a link to another place of the file, or damaged")
        elif (address := hdf5.address_of(item)) in above or len(above) > _DEEPEST:
            notes.append(f"{prefix}{name} is left out: its groups have no end")
        else:
            yield from _datasets(item, notes, f"{prefix}{name}.", (*above, address))


def _dataset(item: Any, attrs: dict[str, Any], raw: Raw, name: str) -> None:
    import h5py

    if item.size is None:
        raw.notes.append(f"{name} is left out: it holds nothing")
        return
    unit = next((_plain(attrs[key]) for key in ("units", "unit", "Units", "Unit") if key in attrs), None)
    kind = _plain(attrs["MATLAB_class"]) if "MATLAB_class" in attrs else None
    if kind == "char":
        raw.info[name] = "".join(chr(int(c)) for c in np.ravel(hdf5.dataset_values(item))[:4000])
    elif item.dtype.names == ("real", "imag"):
        value = hdf5.dataset_values(item)
        vectors({name: value["real"] + 1j * value["imag"]}, {name: unit} if unit else {}, raw)
    elif item.dtype.kind in "biuf":
        vectors({name: _scaled(item, attrs)}, {name: unit} if unit else {}, raw)
    elif item.shape == () and h5py.check_string_dtype(item.dtype) is not None:
        raw.info[name] = str(_plain(item[()]))[:4000]
    else:
        raw.notes.append(f"{name} is left out: it is not an array of numbers")


def _scaled(item: Any, attrs: dict[str, Any]) -> Any:
    """Numbers as the conventions of netCDF mean them: fill values are NaN; scale and offset are applied."""
    value = np.asarray(hdf5.dataset_values(item))
    fill = [attrs[key] for key in ("_FillValue", "missing_value") if key in attrs]
    if fill or "scale_factor" in attrs or "add_offset" in attrs:
        value = value.astype(float)
        for mark in fill:
            value[np.isin(value, np.asarray(mark, float))] = np.nan
        value = value * float(np.ravel(attrs.get("scale_factor", 1.0))[0]) + float(np.ravel(attrs.get("add_offset", 0.0))[0])
    return value


class _Watched(io.BytesIO):
    """Bytes that remember how far they were read, and may be read only as often as the allowance says: variables may overlap."""

    furthest = 0

    def __init__(self, data: bytes, allowance: Allowance):
        super().__init__(data)
        self._allowance = allowance

    def read(self, size: int | None = -1) -> bytes:
        """As usual."""
        data = super().read(size)
        self._allowance.take(8 * len(data), "a variable")  # a byte may become a number of eight
        self.furthest = max(self.furthest, self.tell())
        return data


def parse_netcdf3(data: bytes, allowance: Allowance) -> Raw:
    """The vectors of a classic netCDF file."""
    from scipy.io import netcdf_file

    raw, watched = Raw("netCDF3", table=True), _Watched(data, allowance)
    with damage_reported("netCDF"), netcdf_file(watched, "r", mmap=False) as file:
        for name, variable in file.variables.items():
            unit = getattr(variable, "units", None)
            values = np.array(variable[:], float) if variable.shape else np.array(float(variable.getValue()))
            for mark in ("_FillValue", "missing_value"):
                values = np.where(values == getattr(variable, mark, np.nan), np.nan, values)
            values = values * float(getattr(variable, "scale_factor", 1.0)) + float(getattr(variable, "add_offset", 0.0))
            if values.ndim == 1 and values.size > 1:
                raw.columns.append(RawColumn(name, None if unit is None else str(_plain(unit)), values))
            elif values.size == 1:
                raw.info[name] = values.item()
    if not raw.columns:
        raise InputError("read", ["the netCDF file holds no vector of numbers"])
    if len(data) - watched.furthest > 3:  # variables are padded to four bytes
        more = len(data) - watched.furthest
        raw.notes.append(f"the file has {more} bytes behind its last variable: bytes were added, and numbers may be shifted")
    return raw
