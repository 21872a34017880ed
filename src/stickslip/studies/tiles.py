"""The tiles of a study as files: written atomically with number and checksums, and verified on reading."""

from __future__ import annotations

import io
import json
from collections import Counter
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.studies.manifest import has_checksums, has_models
from stickslip.studies.result_columns import attributes_in_files, coded, empty, unwritten, words
from stickslip.studies.seals import Damaged, attribute_text, is_intact, read_sealed, sealed_bytes

TILES = "tiles"


def file_of(folder: Path, k: int) -> Path:
    """The path of tile k."""
    return folder / TILES / f"{k:07d}.nc"


def mark_of(manifest: dict[str, Any], part: str) -> str | None:
    """The prefix of the checksums for a part of a study; None in a folder of format 1, which has none."""
    return f"{manifest['study']} {part}" if has_checksums(manifest) else None


# ---- writing ----
def netcdf_bytes(variables: dict[str, tuple[tuple[str, ...], Array, dict[str, Any]]], attributes: dict[str, Any]) -> bytes:
    """A netCDF4 file as bytes; the same content gives the same bytes."""
    import h5netcdf

    kept = io.BytesIO()
    with h5netcdf.File(kept, "w") as file:
        for dims, values, _ in variables.values():
            for dim, size in zip(dims, np.shape(values), strict=True):
                if dim not in file.dimensions:
                    file.dimensions[dim] = size
        for name, (dims, values, attrs) in variables.items():
            made = file.create_variable(name, dims, data=values)
            made.attrs.update(attrs)
        file.attrs.update(attributes)
    return kept.getvalue()


def models_of(manifest: dict[str, Any], k: int) -> str:
    """The identity of the models of tile k; empty in a folder of format 1 or 2, which does not have it."""
    return str(manifest["models"][k]) if has_models(manifest) else ""


def tile_bytes(manifest: dict[str, Any], k: int, first: int, columns: dict[str, Array], notes: dict[str, int]) -> bytes:
    """Tile k, whose first case has the index `first`, as a netCDF4 file."""
    import h5py

    count = len(next(iter(columns.values())))
    kept = io.BytesIO(_template(manifest["study"], tuple(manifest["columns"]), count))
    with h5py.File(kept, "r+") as file:
        file["case"][...] = np.arange(first, first + count)
        for name in manifest["columns"]:
            file[name][...] = coded(name, columns[name])
        file.attrs["tile"] = k
        if notes:
            file.attrs["notes"] = json.dumps(notes, ensure_ascii=False, sort_keys=True)
    return sealed_bytes(kept.getvalue(), str(mark_of(manifest, f"tile {k}")), models_of(manifest, k))


@lru_cache(8)
def _template(study: str, names: tuple[str, ...], count: int) -> bytes:
    """A tile of this size without results: everything but the numbers is the same in all tiles, and slow to write."""
    variables: dict[str, Any] = {"case": (("case",), np.zeros(count, "i8"), {"long_name": "number of the case, from 0, in C order"})}
    for name in names:
        values = unwritten(name, count)
        variables[name] = (("case", "character")[: values.ndim], values, attributes_in_files(name))
    return netcdf_bytes(variables, {"stickslip_content": "tile of a study", "study": study})


# ---- reading ----
def _read(folder: Path, manifest: dict[str, Any], k: int, names: list[str]) -> dict[str, Array]:
    """Columns of a tile from its file; `Damaged` if this is not tile k of this study as it was written."""
    first, last = _cases(manifest, k)

    def columns(file: Any) -> dict[str, Array]:
        if attribute_text(file.attrs.get("study", "")) != manifest["study"]:
            raise Damaged("it is of another study")
        if int(file.attrs["tile"]) != k or int(file["case"].shape[0]) != last - first or (last > first and int(file["case"][0]) != first):
            raise Damaged(f"it is tile {int(file.attrs['tile'])} under the name of another")
        return {name: _decoded(name, file[name], last - first) for name in names}

    return read_sealed(file_of(folder, k), mark_of(manifest, f"tile {k}"), columns, models_of(manifest, k))


def _decoded(name: str, variable: Any, count: int) -> Array:
    like = unwritten(name)
    if variable.shape != (count, *like.shape[1:]) or variable.dtype != like.dtype:
        raise Damaged(f"{name} has shape {variable.shape} and type {variable.dtype}")
    return words(name, variable[...])


def _cases(manifest: dict[str, Any], k: int) -> tuple[int, int]:
    """Index of the first case of a tile and of the one after its last."""
    each = int(manifest["cases_per_tile"])
    return k * each, min((k + 1) * each, int(manifest["cases"]))


def tile_is_good(folder: Path, k: int, manifest: dict[str, Any]) -> bool:
    """Whether tile k of this study exists undamaged, with the results of its models."""
    mark = mark_of(manifest, f"tile {k}")
    if mark is not None:
        return is_intact(file_of(folder, k), mark, models_of(manifest, k))
    try:
        _read(folder, manifest, k, [*manifest["columns"]])
    except (FileNotFoundError, Damaged):
        return False
    return True


def read_tile(folder: Path, manifest: dict[str, Any], k: int, names: list[str]) -> dict[str, Array]:
    """Columns of a tile, decoded; empty ones if the tile does not exist."""
    try:
        return _read(folder, manifest, k, names)
    except FileNotFoundError:
        first, last = _cases(manifest, k)
        return empty(last - first, names)
    except Damaged as error:
        what = f"{str(file_of(folder, k))!r} is damaged ({error})"
        raise InputError("study", [f"{what}; delete it and resume the sweep (resume=True, --resume), which computes it again"]) from None


#: The note of `open_study` on cases of tiles that do not exist.
MISSING = "not computed yet; resume=True (--resume) goes on"


def tile_notes(folder: Path, manifest: dict[str, Any]) -> dict[str, int]:
    """Errors and remarks, counted over all tiles, and the number of cases that are not computed yet."""
    notes = Counter[str]()
    for k in range(int(manifest["tiles"])):
        try:
            notes.update(read_sealed(file_of(folder, k), mark_of(manifest, f"tile {k}"), _notes_in, models_of(manifest, k)))
        except FileNotFoundError:
            first, last = _cases(manifest, k)
            notes[MISSING] += last - first
        except Damaged:  # reported when its numbers are read
            continue
    return notes


def _notes_in(file: Any) -> dict[str, int]:
    return dict(json.loads(file.attrs.get("notes", "{}")))
