"""Export of a study, a run, or any labelled dataset: netCDF4, Zarr, MATLAB, CSV, Excel or Parquet, block by block where possible."""

from __future__ import annotations

import csv
import io
import json
import math
import os
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, as_path
from stickslip.basics.optional import library
from stickslip.basics.status import STATUS
from stickslip.basics.whole_files import for_hdf5, unwritable, whole_file
from stickslip.basics.workbooks import write_workbook
from stickslip.studies.blocks import ROWS, slabs
from stickslip.studies.opening import open_study
from stickslip.studies.result_columns import COLUMNS, TYPES, attributes_in_files, characters, coded, unwritten
from stickslip.studies.zarr_stores import ENDING, is_url, to_zarr

_ROW = "row of a file"
_MAT = 2**31 - 1  # bytes of one variable in a MATLAB file of version 5


@explains_arguments
def export(study: Any, path: str | Path) -> Path | str:
    """Write the results of a sweep, a batch or a run to one file, or one store; the extension selects the format.

    Parameters
    ----------
    study : path, Dataset, Trajectory or Summary
        A study folder; a result of `sweep`, also with additional columns; any other dataset, such as a bifurcation diagram; or a result of
        `solve`.
    path : path
        ``.nc`` (netCDF4, read by MATLAB's ncread and by xarray), ``.mat`` (MATLAB version 5), ``.csv``, ``.xlsx`` (Excel) or ``.parquet``
        (one row for each case, words as text), or ``.zarr`` (a store that `xarray.open_zarr` opens lazily: a folder, or a URL that fsspec
        knows, such as ``s3://bucket/grid.zarr``). Runs have no ``.parquet`` and no ``.zarr``.

    Returns
    -------
    Path or str
        Where it was written. An existing file is replaced in a single step at the end.

    Examples
    --------
    >>> import stickslip as ss
    >>> grid = ss.sweep(ss.presets.piezo_rig, amplitude=[3e-4, 6e-4], tilt_deg=1.7, law="coulomb")
    >>> print(ss.studies.export(grid, "grid.csv").read_text().splitlines()[1][:14])
    0.0003,1.7,7.8
    """
    if is_url(path) and not str(path).endswith(ENDING):
        raise InputError("export", [f"{path!r} is a URL; allowed there is a Zarr store; type for example s3://bucket/grid{ENDING}"])
    target = Path(str(path)) if is_url(path) else as_path(path, "export", "grid.nc")
    if hasattr(study, "to_xarray") and hasattr(study, "save"):  # a run has its own file formats
        return Path(study.save(target))
    if target.suffix.lower() == ENDING:
        return to_zarr(path, partial(_stored, _opened(study)))
    write = FORMATS.get(target.suffix.lower())
    if write is None:
        raise InputError(
            "export", [f"{str(path)!r} ends in {target.suffix!r}; allowed are {', '.join((*FORMATS, ENDING))}; type for example grid.nc"]
        )
    data = _opened(study)
    if target.suffix.lower() in (".csv", ".xlsx", ".parquet"):
        data = one_row_a_case(data)
    with whole_file(target, unwritable("export")) as file:
        write(data, file)
    return target


def _opened(study: Any) -> Any:
    """The dataset to be written."""
    what = f"{study!r} is given" if study is None or isinstance(study, (int, float)) else f"a {type(study).__name__} is given"
    if isinstance(study, (str, os.PathLike)):
        study = open_study(Path(study))
    elif hasattr(study, "to_xarray") and hasattr(study, "labels"):  # a batch
        study = study.to_xarray()
    if not hasattr(study, "data_vars"):
        raise InputError(
            "export",
            [
                f"{what}; allowed is a study folder, what sweep or solve returned, or another labelled dataset, such as the points of a "
                "branch; type for example export('study', 'grid.nc') or export(branch.points, 'branch.xlsx')"
            ],
        )
    if not study.data_vars:
        raise InputError("export", ["the dataset has no columns; allowed is what sweep returned, or a part of it that has some"])
    return study


def _dims(data: Any) -> tuple[str, ...]:
    """The dimensions in the order of the rows: those of the column with most dimensions, then others."""
    most = max(data.data_vars, key=lambda name: data[name].ndim)
    return tuple(map(str, dict.fromkeys([*data[most].dims, *data.dims])))


def _is_sweep(data: Any) -> bool:
    """Whether a dataset holds results of a sweep, which `open_study` can open again."""
    return "mean_velocity" in data.data_vars and ("status" in data.data_vars or "maker" in data.attrs)


# ---- grids ----
def _netcdf(data: Any, file: BinaryIO) -> None:
    """Write a sweep block by block, so that memory does not grow with it; other datasets are written by xarray."""
    import h5netcdf
    from xarray.backends import H5NetCDFStore

    if not _is_sweep(data):
        try:
            with for_hdf5(file) as target, h5netcdf.File(target, "w") as whole:
                data.dump_to_store(H5NetCDFStore(whole))
        except (TypeError, ValueError) as error:
            raise InputError(
                "export", [f"the dataset cannot be kept in a netCDF file: {error}; leave out what is not a number and no word"]
            ) from None
        return
    with for_hdf5(file) as target, h5netcdf.File(target, "w") as whole:
        _grid(data, whole, target.check)


def _stored(data: Any, store: Any) -> None:
    """Write a dataset to a Zarr store: a sweep block by block, with a chunk for each block."""
    if _is_sweep(data):
        _grid(data, store)
        return
    try:
        store.take(data)
    except (TypeError, ValueError) as error:
        raise InputError(
            "export", [f"the dataset cannot be kept in a Zarr store: {error}; leave out what is not a number and no word"]
        ) from None


def _grid(data: Any, whole: Any, check: Callable[[], None] = lambda: None) -> None:
    """Write a sweep to an open file, or to a store that takes the same calls."""
    problems = Problems("export")
    for name in data.variables:
        if data[name].dtype.kind not in "iufbOSU":
            problems.add(
                f"{name} holds {data[name].dtype}; a file of a sweep keeps numbers, words, True and False; type drop_vars({name!r})"
            )
    problems.check()
    whole.dimensions = {**{str(d): n for d, n in data.sizes.items()}, "character": 32}
    whole.attrs.update({k: v for k, v in data.attrs.items() if isinstance(v, (str, int, float))})
    whole.attrs.update({"stickslip_content": "sweep", "Conventions": "CF-1.11"})
    labels = [str(name) for name in data.coords if name not in data.dims]
    if labels:
        whole.attrs["coordinates"] = " ".join(labels)
    for name in map(str, data.variables):
        check()
        if name in COLUMNS and name in data.data_vars:
            _column(whole, name, data[name])
        else:
            _own(whole, name, data[name])


def _column(file: Any, name: str, values: Any) -> None:
    """Write one of our columns, with words as codes."""
    kind = unwritten(name)
    more = ("character",) if kind.ndim > 1 else ()
    made = file.create_variable(name, (*values.dims, *more), kind.dtype)
    made.attrs.update(attributes_in_files(name))
    made.attrs["units"] = str(values.attrs.get("units", made.attrs["units"]))
    for block in slabs(values.shape):
        made[block] = coded(name, np.asarray(values[block].values))


def _own(file: Any, name: str, values: Any) -> None:
    """Write a coordinate, or a user-defined column."""
    array, dims, kept = np.asarray(values.values), values.dims, None
    if array.dtype.kind not in "iuf":
        array, kept = characters(array)
        dims = (*dims, f"{name}_characters")
        file.dimensions[dims[-1]] = array.shape[-1]
    made = file.create_variable(name, dims, data=array)
    made.attrs.update({k: v if isinstance(v, (int, float)) else str(v) for k, v in values.attrs.items()})
    made.attrs.update({} if kept is None else {"kept_as": kept, "_Encoding": "utf-8"})


def _matlab(data: Any, file: BinaryIO) -> None:
    from scipy.io import savemat

    kept = {}
    for name in [*map(str, data.coords), *map(str, data.data_vars)]:
        values = np.asarray(data[name].values)
        if values.dtype.kind in "OSU":
            values = coded(name, values) if name == "motion_type" else _cells(values)
        if values.nbytes > _MAT:
            raise InputError("export", [f"{name} has {values.nbytes / 1e9:.1f} GB; a .mat file allows 2 GB; type export(study, 'grid.nc')"])
        kept[name.replace(".", "_")] = values
    units = {name.replace(".", "_"): str(data[name].attrs.get("units", "1")) for name in map(str, [*data.coords, *data.data_vars])}
    types = {"motion_types": np.array(TYPES, object)} if "motion_type" in data.data_vars else {}
    about = {str(k): v for k, v in data.attrs.items() if isinstance(v, (str, int, float))}
    meanings = {"dimensions": np.array(_dims(data), object), "units": units, **types, "study" if _is_sweep(data) else "about": about}
    savemat(file, {**kept, **meanings}, oned_as="column", long_field_names=True)


def _cells(values: Array) -> Array:
    """Values that a cell array can hold: words, numbers, and empty cells."""
    cells = np.empty(values.shape, object)
    for index, value in np.ndenumerate(values):
        cells[index] = np.zeros((0, 0)) if value is None else value if isinstance(value, (str, int, float)) else str(value)
    return cells


# ---- rows ----
def one_row_a_case(data: Any) -> Any:
    """A dataset in which quantities of bodies, contacts and stops have a column for each part, by its name."""
    if not _is_sweep(data):
        return data
    dims = data["mean_velocity"].dims
    table = data.drop_vars([n for n in data.variables if not set(data[n].dims) <= set(dims)])
    for name in map(str, data.data_vars):
        further = [dim for dim in data[name].dims if dim not in dims]
        if len(further) == 1 and further[0] in data.coords:
            parts = data[further[0]].values.tolist()
            unit = str(data[name].attrs.get("units", ""))
            units = each if len(each := unit.split(", ")) == len(parts) else [unit] * len(parts)
            one = [data[name].isel({further[0]: i}, drop=True).assign_attrs({"units": own} if own else {}) for i, own in enumerate(units)]
            table = table.assign({f"{name}.{part}": column for part, column in zip(parts, one, strict=True)})
    return table


def _rows(data: Any) -> Iterator[dict[str, Array]]:
    """Flat coordinates and columns of blocks of cases."""
    dims = _dims(data)
    shape = tuple(data.sizes[d] for d in dims)
    count, columns = math.prod(shape), _columns(data)
    data = data.assign_coords({dim: np.arange(data.sizes[dim]) for dim in dims if dim not in data.coords})
    for first in range(0, count, ROWS):
        index = np.unravel_index(np.arange(first, min(first + ROWS, count)), shape) if dims else ()
        some = data.isel({dim: (_ROW, at) for dim, at in zip(dims, index, strict=True)})
        yield {name: np.broadcast_to(some[name].values, some.sizes.get(_ROW, 1)) for name in columns}


def _columns(data: Any) -> list[str]:
    dims = _dims(data)
    return [*dims, *(str(n) for n in data.coords if n not in dims), *(str(n) for n in data.data_vars)]


def _headed(data: Any, name: str) -> str:
    unit = data[name].attrs.get("units", "1")
    return name if unit in ("", "1") else f"{name} [{unit}]"


def _sentences(codes: Array) -> list[str]:
    """The meanings of status codes; a repeating strobe point is "settled"."""
    sentences = STATUS | {1: "settled"}
    return [sentences.get(int(code), f"status {code}") for code in codes]


def _texts(name: str, values: Array) -> list[str | None]:
    return list(_sentences(values)) if name == "status" else [None if v is None else str(v) for v in values.tolist()]


def _lines(data: Any) -> Iterator[tuple[Any, ...]]:
    """The rows one by one, with status codes as sentences."""
    for part in _rows(data):
        yield from zip(*(_sentences(values) if name == "status" else values.tolist() for name, values in part.items()), strict=True)


def _csv(data: Any, file: BinaryIO) -> None:
    text = io.TextIOWrapper(file, encoding="utf-8", newline="")
    writer = csv.writer(text)
    writer.writerow([_headed(data, name) for name in _columns(data)])
    writer.writerows(_lines(data))
    text.detach()  # flushed, and not closed


def _excel(data: Any, file: BinaryIO) -> None:
    count = math.prod(data.sizes[d] for d in _dims(data))
    write_workbook(file, [_explained(data, name) for name in _columns(data)], _lines(data), count, data.attrs, "export")


def _explained(data: Any, name: str) -> tuple[str, str, str]:
    """Heading, unit and meaning of a column, with the meanings of its codes, except for the status, which is written in words."""
    attributes = data[name].attrs
    codes = f" ({attributes['flag_meanings']})" if "flag_meanings" in attributes and name != "status" else ""
    return _headed(data, name), str(attributes.get("units", "1")), f"{attributes.get('long_name', '')}{codes}"


def _parquet(data: Any, file: BinaryIO) -> None:
    missing = 'Parquet needs pyarrow; type pip install "stickslip[parquet]", or give a .csv or .nc path'
    pa, pq = (library("export", name, missing) for name in ("pyarrow", "pyarrow.parquet"))
    units = {name.encode(): str(data[name].attrs.get("units", "1")).encode() for name in _columns(data)}
    about = {b"stickslip": json.dumps({k: str(v) for k, v in data.attrs.items()}).encode(), **{b"unit " + k: v for k, v in units.items()}}
    writer = None
    try:
        for part in _rows(data):
            arrays = [pa.array(_texts(n, v), pa.string()) if n == "status" or v.dtype.kind in "OSU" else v for n, v in part.items()]
            rows = pa.table(arrays, names=list(part)).replace_schema_metadata(about)
            writer = writer or pq.ParquetWriter(file, rows.schema)
            writer.write_table(rows)
    finally:
        if writer is not None:
            writer.close()


#: File extension -> writer.
FORMATS: dict[str, Callable[[Any, BinaryIO], None]] = {".nc": _netcdf, ".mat": _matlab, ".csv": _csv, ".xlsx": _excel, ".parquet": _parquet}
