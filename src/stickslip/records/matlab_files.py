"""MATLAB files of versions 4 to 7.2 (version 7.3 is HDF5)."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.unpacking import Allowance
from stickslip.records.matlab_bytes import version4, version5
from stickslip.records.raw import Column, Raw


def parse(data: bytes, allowance: Allowance) -> Raw:
    """The vectors of a MATLAB file; single numbers and texts are kept as what else the file says."""
    raw = Raw("MATLAB", table=True)
    old = data[126:128] not in (b"IM", b"MI") and data[:6] != b"MATLAB"
    try:
        variables = version4(data, allowance) if old else version5(data, raw.notes, allowance)
    except InputError:
        raise
    except MemoryError:
        raise _broken("it asks for more memory than there is") from None
    except ValueError as error:
        raise _broken(str(error)) from None
    if not old:
        raw.info["header"] = data[:116].decode("latin-1").strip(" \0")
    units = variables.get("units")
    units = variables.pop("units") if isinstance(units, dict) else {}
    vectors(variables, {name: str(unit) for name, unit in units.items()}, raw)
    if not raw.columns:
        raise InputError("read", ["the MATLAB file holds no vector of numbers; save the time and the channels as vectors"])
    return raw


def _broken(why: str) -> InputError:
    return InputError("read", [f"the MATLAB file is damaged ({why}); save it again"])


def vectors(variables: dict[str, Any], units: dict[str, str], raw: Raw, prefix: str = "") -> None:
    """Add every vector to the columns, and every single number or text to what else the file says."""
    for name, value in variables.items():
        array, full = np.asarray(value), prefix + name
        if isinstance(value, dict):
            vectors(value, units, raw, f"{full}.")
        elif array.dtype.kind in "US":
            raw.info[full] = " ".join(str(part) for part in array.ravel())[:4000]
        elif array.dtype.kind not in "biufc":
            raw.notes.append(f"{full} is left out: it is not an array of numbers")
        elif array.size == 1:
            raw.info[full] = array.ravel()[0].item()
        elif array.ndim == 2 and min(array.shape) > 1:
            rows = array if array.shape[0] >= array.shape[1] else array.T
            raw.columns += [Column(f"{full} {i + 1}", units.get(full), _numbers(rows[:, i])) for i in range(rows.shape[1])]
        elif array.size and max(array.shape) == array.size:
            raw.columns.append(Column(full, units.get(full), _numbers(array.ravel())))
        elif array.size:
            raw.notes.append(f"{full} is left out: an array of shape {array.shape} is not a time history")


def _numbers(array: Any) -> Any:
    return array.astype(complex if array.dtype.kind == "c" else float)
