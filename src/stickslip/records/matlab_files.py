"""MATLAB files of versions 4 to 7.2 (version 7.3 is HDF5)."""

from __future__ import annotations

import io
import warnings
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.unpacking import Allowance
from stickslip.records.extras import damage_reported
from stickslip.records.raw import Raw, RawColumn


def parse(data: bytes, allowance: Allowance) -> Raw:
    """The vectors of a MATLAB file; single numbers and texts are kept as what else the file says."""
    from scipy.io.matlab import loadmat

    raw = Raw("MATLAB", table=True)
    with damage_reported("MATLAB"), warnings.catch_warnings():
        warnings.simplefilter("error")  # SciPy warns of variables that it cannot read
        loaded = loadmat(io.BytesIO(data))
        variables = {name: _plain(value, allowance) for name, value in loaded.items() if not name.startswith("__")}
    if data[126:128] in (b"IM", b"MI"):
        raw.info["header"] = data[:116].decode("latin-1").strip(" \0")
    units = variables.get("units")
    units = variables.pop("units") if isinstance(units, dict) else {}
    vectors(variables, {name: str(unit) for name, unit in units.items()}, raw)
    if not raw.columns:
        raise InputError("read", ["the MATLAB file holds no vector of numbers; save the time and the channels as vectors"])
    return raw


def _plain(value: Any, allowance: Allowance) -> Any:
    """Numbers and texts as they are, a struct as a dict, and None for what is neither."""
    value = np.asarray(value)
    if value.dtype.kind == "U":
        return " ".join(text.rstrip() for text in value.ravel().tolist())
    if value.dtype.names is not None and value.size == 1:
        return {name: _plain(field, allowance) for name, field in zip(value.dtype.names, value.item(), strict=True)}
    if value.dtype.kind not in "biufc":
        return None
    allowance.take(value.size * (16 if value.dtype.kind == "c" else 8), "a variable")
    return value


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
            raw.columns += [RawColumn(f"{full} {i + 1}", units.get(full), _numbers(rows[:, i])) for i in range(rows.shape[1])]
        elif array.size and max(array.shape) == array.size:
            raw.columns.append(RawColumn(full, units.get(full), _numbers(array.ravel())))
        elif array.size:
            raw.notes.append(f"{full} is left out: an array of shape {array.shape} is not a time history")


def _numbers(array: Any) -> Any:
    return array.astype(complex if array.dtype.kind == "c" else float)
