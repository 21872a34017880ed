"""The file of a study's coordinates."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.studies.result_columns import characters, from_characters
from stickslip.studies.seals import Damaged, attribute_text, read_sealed, sealed_bytes
from stickslip.studies.space import Column
from stickslip.studies.tiles import mark_of, netcdf_bytes

AXES = "axes.nc"


def axes_bytes(labels: dict[str, Column], manifest: dict[str, Any]) -> bytes:
    """The coordinates as a netCDF4 file; words as fixed-length characters."""
    variables = {}
    for i, (name, column) in enumerate(labels.items()):
        values, dims, attrs = np.asarray(column.values), column.dims, {"coordinate": name}
        if values.dtype.kind not in "iuf":
            values, kept = characters(values)
            dims, attrs = (*dims, f"characters_{i}"), {**attrs, "kept_as": kept}
        variables[name.replace(".", "_") if name not in dims else name] = (dims, values, attrs)
    return sealed_bytes(netcdf_bytes(variables, {"stickslip_content": "axes of a study"}), str(mark_of(manifest, "axes")))


def read_labels(folder: Path, manifest: dict[str, Any]) -> dict[str, Column]:
    """The coordinates of a study."""
    path = folder / AXES
    sizes = dict(zip(manifest["dims"], manifest["shape"], strict=True))

    def columns(file: Any) -> dict[str, Column]:
        stored = [_label(variable, variable[...]) for variable in file.values()]
        labels = {name: column for name, column in stored if name}
        for name, column in labels.items():
            if np.shape(column.values) != tuple(sizes[dim] for dim in column.dims):
                raise Damaged(f"{name} has shape {np.shape(column.values)}")
        return labels

    try:
        return read_sealed(path, mark_of(manifest, "axes"), columns)
    except FileNotFoundError:
        what = f"{str(path)!r} is missing"
    except Damaged as error:
        what = f"{str(path)!r} is damaged ({error}); delete it"
    raise InputError("study", [f"{what}; type the sweep again with resume=True (--resume), which writes it anew"])


def _label(variable: Any, values: Any) -> tuple[str, Column]:
    """Name and values of a coordinate; the name is empty if a variable is only a dimension."""
    if "coordinate" not in variable.attrs:
        return "", Column((), values)
    dims = tuple(_dim(variable, i) for i in range(variable.ndim))
    if "kept_as" in variable.attrs:
        dims, texts = dims[:-1], np.ascontiguousarray(values).view(f"S{values.shape[-1]}")[..., 0]
        values = from_characters(texts, attribute_text(variable.attrs["kept_as"]))
    return attribute_text(variable.attrs["coordinate"]), Column(dims, values)


def _dim(variable: Any, i: int) -> str:
    """Name of a dimension of a netCDF4 variable: that of the attached scale, or of the variable itself."""
    scales = variable.dims[i]
    return str(scales[0].name if len(scales) else variable.name).lstrip("/")
