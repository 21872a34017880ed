"""A study as one file: netCDF4, MATLAB, CSV or Parquet, written tile by tile where the format allows it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.errors import InputError
from stickslip.storage import moved_into_place
from stickslip.sweeps.columns import COLUMNS, STATUSES, coded, described, empty, flags
from stickslip.sweeps.folder import unwritable
from stickslip.sweeps.opening import open_study

__all__ = ["FORMATS", "blocks_of", "export"]

Array = Any
_ROWS = 65536  # cases at a time
_MAT = 2**31 - 1  # bytes of one variable in a MATLAB file of version 5


def export(study: Any, path: str | Path) -> Path:
    """Write the results of a sweep to one file; the ending of its name says in which format.

    Parameters
    ----------
    study : path or Dataset
        A study folder, or what `sweep` returned.
    path : path
        ``.nc`` (netCDF4, read by MATLAB's ncread and by xarray), ``.mat`` (MATLAB version 5), ``.csv`` or ``.parquet`` (one row for
        each case, words as text).

    Returns
    -------
    Path
        Where it was written. An existing file is replaced, at the end and at once.

    Examples
    --------
    >>> import stickslip as ss
    >>> grid = ss.sweep(ss.presets.piezo_rig, amplitude=[3e-4, 6e-4], tilt_deg=1.7, law="coulomb")
    >>> print(ss.export(grid, "grid.csv").read_text().splitlines()[1][:14])
    0.0003,1.7,7.8
    """
    target = Path(path).expanduser()
    write = FORMATS.get(target.suffix.lower())
    if write is None:
        raise InputError("export", [f"{str(path)!r} ends in {target.suffix!r}; allowed are {', '.join(FORMATS)}; type for example grid.nc"])
    grid = study if hasattr(study, "data_vars") else open_study(study)
    with moved_into_place(target, unwritable) as beside:
        write(grid, beside)
    return target


def blocks_of(first: int, last: int, shape: tuple[int, ...]) -> Iterator[tuple[slice, ...]]:
    """The cases from number `first` to before `last`, in C order, as rectangular blocks of an array of this shape.

    Examples
    --------
    >>> list(blocks_of(2, 7, (3, 3)))
    [(slice(0, 1, None), slice(2, 3, None)), (slice(1, 2, None), slice(0, 3, None)), (slice(2, 3, None), slice(0, 1, None))]
    """
    if not shape:
        yield ()
        return
    inner = int(np.prod(shape[1:], dtype=np.int64))
    while first < last:
        row, rest = divmod(first, inner)
        if rest == 0 and last - first >= inner:
            rows = (last - first) // inner
            yield (slice(row, row + rows), *(slice(0, n) for n in shape[1:]))
            first += rows * inner
        else:
            end = min(last, (row + 1) * inner)
            for block in blocks_of(rest, rest + end - first, shape[1:]):
                yield (slice(row, row + 1), *block)
            first = end


def _dims(grid: Any) -> tuple[str, ...]:
    """The dimensions in the order of the results."""
    return tuple(str(d) for d in grid["mean_velocity"].dims)


def _size(grid: Any) -> int:
    return int(np.prod([grid.sizes[d] for d in _dims(grid)], dtype=np.int64))


# ---- grids ----
def _netcdf(grid: Any, path: Path) -> None:
    """A grid, block by block, so that memory does not grow with it."""
    import h5netcdf

    dims = _dims(grid)
    shape = tuple(grid.sizes[d] for d in dims)
    with h5netcdf.File(path, "w") as file:
        file.dimensions = {**{d: n for d, n in zip(dims, shape, strict=True)}, "character": 32}
        file.attrs.update({k: v for k, v in grid.attrs.items() if isinstance(v, (str, int, float))})
        file.attrs.update({"stickslip_content": "sweep", "Conventions": "CF-1.11"})
        for name in grid.coords:
            _coordinate(file, str(name), grid[name])
        for name in map(str, grid.data_vars):
            kind = coded(name, empty(1)[name] if name in COLUMNS else np.zeros(1, grid[name].dtype))
            made = file.create_variable(name, (*dims, *(("character",) if kind.ndim > 1 else ())), kind.dtype)
            made.attrs.update({n: v for n, v in described(name).items() if n != "flag_meanings"} | flags(name))
            made.attrs["units"] = str(grid[name].attrs.get("units", "1"))
            for first in range(0, _size(grid), _ROWS):
                for block in blocks_of(first, min(first + _ROWS, _size(grid)), shape):
                    made[(*block, *((slice(None),) if kind.ndim > 1 else ()))] = coded(name, np.asarray(grid[name][block].values))


def _coordinate(file: Any, name: str, values: Any) -> None:
    array = np.asarray(values.values)
    if array.dtype.kind in "OSU":
        array = array.astype("S")
        length = max(array.dtype.itemsize, 1)
        dim = f"{name}_characters"
        file.dimensions[dim] = length
        made = file.create_variable(name, (*values.dims, dim), data=array.astype(f"S{length}").view("S1").reshape(*array.shape, length))
    else:
        made = file.create_variable(name, values.dims, data=array)
    made.attrs.update({k: str(v) for k, v in values.attrs.items()})


def _matlab(grid: Any, path: Path) -> None:
    from scipy.io import savemat

    dims, kept = _dims(grid), {}
    for name in [*map(str, grid.coords), *map(str, grid.data_vars)]:
        values = np.asarray(grid[name].values)
        if values.dtype.kind in "OSU":
            values = coded(name, values) if name == "motion_type" else values.astype(object)
        if values.nbytes > _MAT:
            raise InputError("export", [f"{name} has {values.nbytes / 1e9:.1f} GB; a .mat file allows 2 GB; type export(study, 'grid.nc')"])
        kept[name.replace(".", "_")] = values
    units = {name.replace(".", "_"): str(grid[name].attrs.get("units", "1")) for name in [*grid.coords, *grid.data_vars]}
    types = list(flags("motion_type")["flag_meanings"].split())
    info = {k: v for k, v in grid.attrs.items() if isinstance(v, (str, int, float))}
    meanings = {"dimensions": np.array(list(dims), object), "units": units, "motion_types": np.array(types, object), "study": info}
    savemat(path, {**kept, **meanings}, oned_as="column", appendmat=False, long_field_names=True)


# ---- rows ----
def _rows(grid: Any) -> Iterator[dict[str, Array]]:
    """Coordinates and columns of some cases at a time, flat."""
    dims = _dims(grid)
    shape = tuple(grid.sizes[d] for d in dims)
    for first in range(0, _size(grid), _ROWS):
        numbers = np.arange(first, min(first + _ROWS, _size(grid)))
        index = dict(zip(dims, np.unravel_index(numbers, shape), strict=True)) if dims else {}
        part: dict[str, Array] = {}
        for name in _columns(grid):
            if name in grid.coords:
                values = np.asarray(grid[name].values)
                part[name] = np.broadcast_to(values[tuple(index[str(d)] for d in grid[name].dims)], numbers.shape)
            else:
                blocks = [np.asarray(grid[name][b].values).ravel() for b in blocks_of(first, first + len(numbers), shape)]
                part[name] = np.concatenate(blocks) if blocks else np.zeros(0)
        yield part


def _columns(grid: Any) -> list[str]:
    dims = _dims(grid)
    return [*dims, *(str(n) for n in grid.coords if n not in dims), *(str(n) for n in grid.data_vars)]


def _headed(grid: Any, name: str) -> str:
    unit = grid[name].attrs.get("units", "1")
    return name if unit in ("", "1") else f"{name} [{unit}]"


def _sentences(codes: Array) -> list[str]:
    """What status codes say; both ways to finish with a period count as settled."""
    told = STATUSES | {1: "settled"}
    return [told.get(int(code), f"status {code}") for code in codes]


def _csv(grid: Any, path: Path) -> None:
    import csv

    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([_headed(grid, name) for name in _columns(grid)])
        for part in _rows(grid):
            columns = [_sentences(values) if name == "status" else values.tolist() for name, values in part.items()]
            writer.writerows(zip(*columns, strict=True))


def _parquet(grid: Any, path: Path) -> None:
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        raise InputError("export", ['Parquet needs pyarrow; type pip install "stickslip[parquet]", or give a .csv or .nc path']) from None
    units = {name.encode(): str(grid[name].attrs.get("units", "1")).encode() for name in _columns(grid)}
    about = {b"stickslip": json.dumps({k: str(v) for k, v in grid.attrs.items()}).encode(), **{b"unit " + k: v for k, v in units.items()}}
    writer = None
    try:
        for part in _rows(grid):
            arrays = [_sentences(v) if n == "status" else v.tolist() if v.dtype.kind in "OSU" else v for n, v in part.items()]
            rows = pa.table(arrays, names=list(part)).replace_schema_metadata(about)
            writer = writer or pq.ParquetWriter(path, rows.schema)
            writer.write_table(rows)
    finally:
        if writer is not None:
            writer.close()


#: Ending of a file's name -> what writes it.
FORMATS: dict[str, Callable[[Any, Path], None]] = {".nc": _netcdf, ".mat": _matlab, ".csv": _csv, ".parquet": _parquet}
