"""A study folder as a dataset that reads its tiles on access."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from xarray.backends import BackendArray
from xarray.core import indexing

from stickslip.basics import hdf5
from stickslip.basics.arguments import explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, as_path
from stickslip.basics.unpacking import Allowance
from stickslip.studies.folder import read_manifest
from stickslip.studies.labelling import assembled, labels_of_parts, with_units
from stickslip.studies.manifest import UNCHECKED, has_checksums, has_models
from stickslip.studies.result_columns import COLUMNS, base_of, column_type, dim_of, from_characters, part_columns, unflattened, words
from stickslip.studies.space import Column
from stickslip.studies.space_file import read_labels
from stickslip.studies.tiles import read_tile, tile_notes
from stickslip.studies.zarr_stores import is_store, is_url, opened

if TYPE_CHECKING:
    import xarray as xr

_OLD = "kept by an earlier stickslip, without checksums: damage to the file may go unseen"


@explains_arguments
def open_study(folder: str | Path) -> xr.Dataset:
    """The results in a study folder as a dataset; for an unfinished study, the results so far.

    Only the axes are read at once; values are read from the tiles on access, so a study may be larger than the memory. Motion types are
    text here; the files hold small integers with flag_values and flag_meanings.

    Parameters
    ----------
    folder : path
        The `out` of a `sweep`, or a .nc file or a .zarr store that `export` wrote (which is read as a whole; `xarray.open_zarr` is lazy).

    Returns
    -------
    xarray.Dataset
        As from `sweep`. Cases not yet computed have the status 101, "not computed".

    Examples
    --------
    >>> import stickslip as ss
    >>> _ = ss.sweep(ss.presets.piezo_rig, amplitude=[3e-4, 6e-4], tilt_deg=1.7, law="coulomb", out="study")
    >>> ss.open_study("study").motion_type.values.tolist()
    ['II', 'III']
    """
    given, folder = folder, as_path(folder, "open_study", "grid")
    if is_url(given) or is_store(folder):
        return _in_words(_whole_store(given if is_url(given) else folder), str(given))
    if folder.is_file():
        return _in_words(_whole_file(folder), str(folder))
    manifest = read_manifest(folder)
    import xarray as xr

    parts, columns = manifest.get("parts", {}), {}
    for name in dict.fromkeys(map(base_of, manifest["columns"])):
        dim = dim_of(name, parts)
        dims = (*manifest["dims"], *([dim] if dim else []))
        columns[name] = dims, xr.Variable(dims, indexing.LazilyIndexedArray(_Tiled(folder, manifest, name)))._data
    grid = assembled(columns, read_labels(folder, manifest) | labels_of_parts(parts), manifest["attributes"])
    grid.attrs["provenance"] = json.dumps(manifest["provenance"])
    with_units(grid, manifest.get("observed", {}))
    grid.attrs["study"] = manifest["study"]
    notes = tile_notes(folder, manifest) | dict.fromkeys(_remarks(manifest), manifest["cases"])
    if notes:
        grid.attrs["notes"] = json.dumps(notes, ensure_ascii=False)
    return grid


def _remarks(manifest: dict[str, Any]) -> list[str]:
    """What the folder does not know of itself: its damage, or parts of its models."""
    old = [*([] if has_checksums(manifest) else [_OLD]), *([] if has_models(manifest) else [UNCHECKED])]
    return [*old, *manifest.get("unchecked", [])]


def _whole_file(path: Path) -> Any:
    """The content of a file that `export` wrote."""
    import xarray as xr

    try:
        with hdf5.checked_file(path, "study", Allowance("study", path.stat().st_size), for_others=True):
            pass
        return xr.load_dataset(path, engine="h5netcdf")
    except InputError:
        raise
    except Exception as error:  # the library may fail anywhere on damaged bytes
        raise InputError(
            "study", [f"{str(path)!r} cannot be read: {error}; give a study folder, or a .nc file that export wrote"]
        ) from None


def _whole_store(path: Path | str) -> Any:
    """The content of a Zarr store that `export` wrote."""
    try:
        return opened(path).load()
    except InputError:
        raise
    except Exception as error:  # a chunk that is damaged, or a store elsewhere that does not answer
        raise InputError("study", [f"{str(path)!r} cannot be read: {error}; give a study folder, or a store that export wrote"]) from None


def _in_words(grid: Any, path: str) -> Any:
    """A grid written by `export`, with its words as text."""
    content = grid.attrs.pop("stickslip_content", None)
    if content != "sweep":
        what = "is a run; type ss.load(path)" if content == "trajectory" else "was not written by export; open it with xarray.open_dataset"
        raise InputError("study", [f"{path!r} {what}"])
    grid.attrs.pop("Conventions", None)
    read = {str(name): (tuple(map(str, grid[name].dims)), _decoded(str(name), grid[name])) for name in grid.variables}
    labels = {name: Column(dims, values) for name, (dims, values) in read.items() if name in grid.coords}
    dataset = assembled({name: column for name, column in read.items() if name not in labels}, labels, dict(grid.attrs))
    for name in dataset.data_vars:
        dataset[name].attrs = dataset[name].attrs or {k: v for k, v in grid[name].attrs.items() if k != "kept_as"}
    return dataset


def _decoded(name: str, variable: Any) -> Array:
    """Text decoded from characters or codes in a file."""
    values = variable.values
    if "kept_as" in variable.attrs:
        return from_characters(values, variable.attrs["kept_as"])
    if values.dtype.kind in "SOT":  # of a netCDF file, and of a Zarr store
        return (np.char.decode(values) if values.dtype.kind == "S" else values).astype(COLUMNS[name])
    return words(name, values)


class _Tiled(BackendArray):
    """One column of a study as an array that reads its tiles on access."""

    def __init__(self, folder: Path, manifest: dict[str, Any], name: str):
        self.folder, self.manifest, self.name = folder, manifest, name
        self.parts = manifest.get("parts", {})
        dim = dim_of(name, self.parts)
        self.cases = tuple(manifest["shape"])
        self.shape = (*self.cases, *([len(self.parts[dim])] if dim else []))
        self.dtype = np.dtype(column_type(name))

    def __getitem__(self, key: Any) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.BASIC, self._read)

    def _read(self, key: tuple[Any, ...]) -> Any:
        of_parts = key[len(self.cases) :]
        ranges = [np.arange(n)[k] for n, k in zip(self.cases, key, strict=False)]
        shape = tuple(len(r) for r in ranges if np.ndim(r))
        if not self.cases:
            return self._values(np.zeros(1, np.int64))[0][of_parts]
        flat = np.ravel_multi_index(np.ix_(*map(np.atleast_1d, ranges)), self.cases).ravel()
        values = self._values(flat)[(slice(None), *of_parts)]
        return values.reshape((*shape, *values.shape[1:]))

    def _values(self, flat: Array) -> Array:
        """Values of some cases, given by their indices."""
        each = max(int(self.manifest["cases_per_tile"]), 1)
        names = part_columns(self.name, self.parts)
        result, tiles = np.empty((len(flat), *self.shape[len(self.cases) :]), self.dtype), flat // each
        for k in np.unique(tiles):
            at = np.flatnonzero(tiles == k)
            columns = read_tile(self.folder, self.manifest, int(k), [*names])
            result[at] = unflattened(self.name, columns, self.parts)[flat[at] - k * each]
        return result
