"""HDF5, netCDF and MATLAB 7.3: arrays in groups, with attributes."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from stickslip.errors import InputError
from stickslip.records.matlab import vectors
from stickslip.records.raw import Column, Raw

__all__ = ["parse_hdf5", "parse_netcdf3"]

_MOST = 2**28  # numbers of one array: a damaged file may claim any size


def parse_hdf5(data: bytes) -> Raw:
    """The vectors of an HDF5 file, which a netCDF4 or MATLAB 7.3 file is too."""
    import h5py

    raw = Raw("MATLAB 7.3" if data.startswith(b"MATLAB") else "HDF5", table=True)
    try:
        with h5py.File(io.BytesIO(data), "r") as file:
            if "_NCProperties" in file.attrs:
                raw.format = "netCDF4"
            raw.info |= {str(name): _plain(value) for name, value in file.attrs.items() if not str(name).startswith("_")}
            _check_length(data, raw.notes)
            _group(file, raw, "", 0)
    except InputError:
        raise
    except MemoryError:
        raise _broken("it asks for more memory than there is") from None
    except Exception as error:  # a damaged file meets the library at any place
        raise _broken(f"{type(error).__name__}: {str(error)[:120]}") from None
    if not raw.columns:
        raise InputError("read", ["the HDF5 file holds no vector of numbers; save the time and the channels as vectors"])
    return raw


def _check_length(data: bytes, notes: list[str]) -> None:
    """The file says how long it is; where bytes were added within it, everything behind them is shifted."""
    start = 512 if data[512:520] == b"\x89HDF\r\n\x1a\n" else 0
    place = start + (40 if data[start + 8] < 2 else 28)
    says = int.from_bytes(data[place : place + 8], "little")
    if len(data) not in (says, says + start):
        notes.append(f"the file has {len(data)} bytes and says {says}: bytes were added or lost, and numbers may be shifted")


def _broken(why: str) -> InputError:
    return InputError("read", [f"the file is damaged ({why}); save it again"])


def _plain(value: Any) -> Any:
    value = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
    return value.item() if getattr(value, "size", 0) == 1 else str(value)[:4000]


def _group(group: Any, raw: Raw, prefix: str, depth: int) -> None:
    import h5py

    for name in group:
        if name.startswith("#") or name == "pieces" or depth > 8:  # MATLAB's own store; the dense output of our runs
            continue
        item = group.get(name)
        if item is None:
            raw.notes.append(f"{prefix}{name} cannot be opened and is left out: the file is damaged")
        elif isinstance(item, h5py.Group):
            _group(item, raw, f"{prefix}{name}.", depth + 1)
        elif isinstance(item, h5py.Dataset):
            _dataset(item, raw, prefix + name)


def _dataset(item: Any, raw: Raw, name: str) -> None:
    if item.size is None or item.size > _MOST:
        raw.notes.append(f"{name} is left out: it says that it has {item.size} numbers")
        return
    unit = next((_plain(item.attrs[key]) for key in ("units", "unit", "Units", "Unit") if key in item.attrs), None)
    kind = _plain(item.attrs["MATLAB_class"]) if "MATLAB_class" in item.attrs else None
    if kind == "char":
        raw.info[name] = "".join(chr(int(c)) for c in np.ravel(item[()])[:4000])
    elif item.dtype.names == ("real", "imag"):
        value = item[()]
        vectors({name: value["real"] + 1j * value["imag"]}, {name: unit} if unit else {}, raw)
    elif item.dtype.kind in "biuf":
        vectors({name: _scaled(item)}, {name: unit} if unit else {}, raw)
    elif h5_text(item):
        raw.info[name] = str(_plain(item[()]))[:4000]
    else:
        raw.notes.append(f"{name} is left out: it is no array of numbers")


def h5_text(item: Any) -> bool:
    """Whether a dataset holds one text."""
    return item.dtype.kind in "OS" and item.shape == ()


def _scaled(item: Any) -> Any:
    """Numbers as the conventions of netCDF mean them: fill values are NaN; scale and offset are applied."""
    value = np.asarray(item[()])
    fill = [item.attrs[key] for key in ("_FillValue", "missing_value") if key in item.attrs]
    if fill or "scale_factor" in item.attrs or "add_offset" in item.attrs:
        value = value.astype(float)
        for mark in fill:
            value[np.isin(value, np.asarray(mark, float))] = np.nan
        value = value * float(np.ravel(item.attrs.get("scale_factor", 1.0))[0]) + float(np.ravel(item.attrs.get("add_offset", 0.0))[0])
    return value


class _Watched(io.BytesIO):
    """Bytes that remember how far they were read."""

    furthest = 0

    def read(self, size: int | None = -1) -> bytes:
        """As usual."""
        found = super().read(size)
        self.furthest = max(self.furthest, self.tell())
        return found


def parse_netcdf3(data: bytes) -> Raw:
    """The vectors of a classic netCDF file."""
    from scipy.io import netcdf_file

    raw, watched = Raw("netCDF3", table=True), _Watched(data)
    try:
        with netcdf_file(watched, "r", mmap=False) as file:
            for name, variable in file.variables.items():
                unit = getattr(variable, "units", None)
                values = np.array(variable[:], float) if variable.shape else np.array(float(variable.getValue()))
                for mark in ("_FillValue", "missing_value"):
                    values = np.where(values == getattr(variable, mark, np.nan), np.nan, values)
                values = values * float(getattr(variable, "scale_factor", 1.0)) + float(getattr(variable, "add_offset", 0.0))
                if values.ndim == 1 and values.size > 1:
                    raw.columns.append(Column(name, None if unit is None else str(_plain(unit)), values))
                elif values.size == 1:
                    raw.info[name] = values.item()
    except MemoryError:
        raise _broken("it asks for more memory than there is") from None
    except Exception as error:  # a damaged file meets the library at any place
        raise _broken(f"{type(error).__name__}: {str(error)[:120]}") from None
    if not raw.columns:
        raise InputError("read", ["the netCDF file holds no vector of numbers"])
    if len(data) - watched.furthest > 3:  # variables are padded to four bytes
        more = len(data) - watched.furthest
        raw.notes.append(f"the file has {more} bytes behind its last variable: bytes were added, and numbers may be shifted")
    return raw
