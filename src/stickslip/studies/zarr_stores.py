"""Results as a Zarr store, which xarray opens lazily and many programs read side by side, on a disk or behind a URL.

On a disk a store is written beside its place and moved there. Behind a URL it is filled in place: what is not there yet, or was lost,
is NaN and has the status "not computed".
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError, as_path
from stickslip.basics.optional import library
from stickslip.basics.whole_files import unwritable, whole_folder
from stickslip.studies.blocks import shape_of_slab
from stickslip.studies.result_columns import COLUMNS, unwritten

ENDING = ".zarr"
_FORMAT = 3  # whose chunks may have checksums
_GROUP = "zarr.json"
_MISSING = 'a Zarr store needs zarr; type pip install "stickslip[zarr]", or take a .nc file instead'


def is_url(path: Any) -> bool:
    """Whether a path is a URL of fsspec.

    Examples
    --------
    >>> is_url("s3://bucket/study.zarr"), is_url("study.zarr")
    (True, False)
    """
    return isinstance(path, str) and "://" in path


def is_store(path: Path) -> bool:
    """Whether a folder is a Zarr store, of this format or the one before."""
    return any((path / name).is_file() for name in (_GROUP, ".zgroup"))


def to_zarr(path: Any, fill: Callable[[Group], None]) -> Path | str:
    """Write a Zarr store with `fill`; an existing one on the disk is replaced at the end.

    Parameters
    ----------
    path : path or str
        A folder, or a URL that fsspec knows, such as ``s3://bucket/study.zarr``.
    fill : callable
        Takes the open group, with the methods of an `h5netcdf.File` that are used here.

    Raises
    ------
    InputError
        Without zarr, for a folder that is no Zarr store, and for a place that cannot be written.
    """
    zarr = library("export", "zarr", _MISSING)
    if is_url(path):
        _filled(zarr, _remote(path), fill)
        return str(path)
    target = as_path(path, "export", "grid.zarr")
    if target.exists() and not is_store(target):
        raise InputError("export", [f"{str(target)!r} is there and is no Zarr store; give a new path"])
    with whole_folder(target, unwritable("export")) as part:
        _filled(zarr, part, fill)
    return target


def opened(path: Any) -> Any:
    """A Zarr store as xarray reads it."""
    import xarray as xr

    library("study", "zarr", _MISSING)
    return xr.open_zarr(_remote(path) if is_url(path) else path, consolidated=None, chunks=None)


def _remote(url: str) -> Any:
    try:
        return library("export", "zarr.storage", _MISSING).FsspecStore.from_url(url)
    except (ImportError, ValueError) as error:
        raise InputError("export", [f"{url!r} cannot be opened: {error}; install what fsspec needs for it, or give a folder"]) from None


def _filled(zarr: Any, store: Any, fill: Callable[[Group], None]) -> None:
    group = zarr.open_group(store, mode="w", zarr_format=_FORMAT)
    fill(Group(group))
    with warnings.catch_warnings():  # the specification has no such summary yet; xarray warns where there is none
        warnings.filterwarnings("ignore", "Consolidated metadata")
        zarr.consolidate_metadata(group.store)


class Attributes:
    """Attributes of a group or an array, from values as netCDF has them."""

    def __init__(self, kept: Any):
        self._kept = kept

    def update(self, given: dict[str, Any]) -> None:
        """Set some."""
        self._kept.attrs.update({str(name): _plain(value) for name, value in given.items() if name != "_Encoding"})  # of letters

    def __getitem__(self, name: str) -> Any:
        return self._kept.attrs[name]

    def __setitem__(self, name: str, value: Any) -> None:
        self.update({name: value})


class Variable:
    """An array that is filled block by block; letters along a last dimension are texts there."""

    def __init__(self, array: Any, letters: bool):
        self._array, self._letters, self.attrs = array, letters, Attributes(array)

    def __setitem__(self, block: Any, values: Any) -> None:
        self._array[block] = _texts(values) if self._letters else values


def _texts(letters: Any) -> Any:
    """Texts from their UTF-8 letters along the last dimension."""
    flat = np.ascontiguousarray(letters).view(f"S{letters.shape[-1]}")[..., 0]
    return np.char.decode(flat, "utf-8").astype(object)


class Group:
    """A group of a Zarr store with the methods of an `h5netcdf.File` that export uses: what is written there can be written here."""

    def __init__(self, group: Any):
        self._group, self.attrs, self.dimensions = group, Attributes(group), dict[str, int]()

    def create_variable(self, name: str, dims: tuple[str, ...], dtype: Any = None, data: Any = None) -> Variable:
        """Make an array with named dimensions: with its data, or with a chunk for each block in which it is written."""
        values = None if data is None else np.asarray(data)
        shape = tuple(self.dimensions[dim] for dim in dims) if values is None else values.shape
        kind = np.dtype(dtype) if values is None else values.dtype
        letters = kind.kind == "S"
        shape, dims = (shape[:-1], dims[:-1]) if letters else (shape, dims)
        chunks = shape_of_slab(shape) if values is None else tuple(max(n, 1) for n in shape)
        array = self._group.create_array(
            name, shape=shape, chunks=chunks, dtype=str if letters else kind, dimension_names=dims, compressors=_codecs(),
            fill_value="" if letters else unwritten(name)[0] if name in COLUMNS else np.nan if kind.kind == "f" else 0,
        )  # fmt: skip
        made = Variable(array, letters)
        if values is not None:
            made[...] = values
        return made

    def take(self, data: Any) -> None:
        """Write a dataset as xarray does."""
        words = {name: data[name].astype(object) for name in data.variables if data[name].dtype.kind == "U"}
        data = data.assign({name: of for name, of in words.items() if name not in data.coords}).assign_coords(
            {name: of for name, of in words.items() if name in data.coords}
        )
        how = {name: {"compressors": _codecs()} for name in data.variables}
        data.to_zarr(self._group.store, mode="a", zarr_format=_FORMAT, consolidated=False, encoding=how)


def _codecs() -> list[Any]:
    """Compressed, with a checksum: a chunk that is damaged is refused by whoever reads it."""
    codecs = library("export", "zarr.codecs", _MISSING)
    return [codecs.ZstdCodec(level=3), codecs.Crc32cCodec()]


def _plain(value: Any) -> Any:
    """A value of an attribute as JSON has it."""
    return json.loads(json.dumps(value, default=_of_numpy))


def _of_numpy(value: Any) -> Any:
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else str(value)
