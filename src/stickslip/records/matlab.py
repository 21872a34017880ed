"""MATLAB files of versions 4 to 7.2 (version 7.3 is HDF5)."""

from __future__ import annotations

import io
import warnings
from typing import Any

import numpy as np

from stickslip.errors import InputError
from stickslip.records.raw import Column, Raw

__all__ = ["parse", "vectors"]


def parse(data: bytes) -> Raw:
    """The vectors of a MATLAB file; single numbers and texts are kept as what else the file says."""
    from scipy.io import loadmat

    raw = Raw("MATLAB", table=True)
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found = loadmat(io.BytesIO(data), squeeze_me=False, struct_as_record=True, chars_as_strings=True)
    except MemoryError:
        raise _broken("it asks for more memory than there is") from None
    except Exception as error:  # a damaged file meets scipy at any place
        raise _broken(f"{type(error).__name__}: {str(error)[:120]}") from None
    raw.notes += [f"the file is unusual: {w.message}" for w in caught]
    head = found.pop("__header__", b"")
    raw.info["header"] = head.decode("latin-1").strip() if isinstance(head, bytes) else str(head)
    units = _units(found.pop("units", None))
    vectors({name: value for name, value in found.items() if not name.startswith("__")}, units, raw)
    if not raw.columns:
        raise InputError("read", ["the MATLAB file holds no vector of numbers; save the time and the channels as vectors"])
    return raw


def _broken(why: str) -> InputError:
    return InputError("read", [f"the MATLAB file is damaged ({why}); save it again"])


def vectors(found: dict[str, Any], units: dict[str, str], raw: Raw, prefix: str = "") -> None:
    """Add every vector to the columns, and every single number or text to what else the file says."""
    for name, value in found.items():
        array, full = np.asarray(value), prefix + name
        if array.dtype.names:
            for field in array.dtype.names:
                if array.size == 1:
                    vectors({field: array.ravel()[0][field]}, units, raw, f"{full}.")
        elif array.dtype.kind in "US":
            raw.info[full] = " ".join(str(part) for part in array.ravel())[:4000]
        elif array.dtype.kind not in "biufc":
            raw.notes.append(f"{full} is left out: it is no array of numbers")
        elif array.size == 1:
            raw.info[full] = array.ravel()[0].item()
        elif array.ndim == 2 and min(array.shape) > 1:
            rows = array if array.shape[0] >= array.shape[1] else array.T
            raw.columns += [Column(f"{full} {i + 1}", units.get(full), _numbers(rows[:, i])) for i in range(rows.shape[1])]
        elif array.size and max(array.shape) == array.size:
            raw.columns.append(Column(full, units.get(full), _numbers(array.ravel())))
        elif array.size:
            raw.notes.append(f"{full} is left out: an array of shape {array.shape} is no time history")


def _numbers(array: Any) -> Any:
    return array.astype(complex if array.dtype.kind == "c" else float)


def _units(value: Any) -> dict[str, str]:
    """Units that the file keeps as a struct named units."""
    array = np.asarray(value)
    if value is None or not array.dtype.names or array.size != 1:
        return {}
    return {name: " ".join(str(x) for x in np.ravel(array.ravel()[0][name])) for name in array.dtype.names}
