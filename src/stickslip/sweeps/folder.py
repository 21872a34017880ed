"""A study folder: its manifest, its axes, and one file for each tile, each written beside its place and then moved there.

Whatever happens to the process, a tile is there as a whole or not at all; the folder itself is the record of what is done.
"""

from __future__ import annotations

import errno
import io
import json
import os
import secrets
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.errors import InputError, StickslipError
from stickslip.sweeps.axes import Column
from stickslip.sweeps.columns import characters, coded, described, empty, flags
from stickslip.sweeps.datasets import labels_of
from stickslip.sweeps.manifest import FORMAT, differences, manifest
from stickslip.sweeps.planning import Plan

__all__ = ["StorageError", "Study", "file_of", "put", "read_manifest", "shard_of", "tile_is_good", "unwritable", "written"]

Array = Any
MANIFEST, AXES, TILES = "manifest.json", "axes.nc", "tiles"


class StorageError(StickslipError, OSError):
    """A folder that cannot be written to any more; what is in it stays, and the study can be resumed."""


# ---- bytes on the disk ----
def put(path: Path, content: bytes, new: bool = False) -> bool:
    """Write a file at once or not at all. With `new` an existing one stays, and False is returned."""
    beside = path.with_name(f".{path.name}.{secrets.token_hex(6)}.part")
    try:
        with beside.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if not new:
            os.replace(beside, path)
            return True
        try:
            os.link(beside, path)
            return True
        except FileExistsError:
            return False
        except OSError:  # a file system without links
            if path.exists():
                return False
            os.replace(beside, path)
            return True
    except OSError as error:
        raise unwritable(path, error) from None
    finally:
        beside.unlink(missing_ok=True) if beside.exists() else None


def unwritable(path: Path, error: OSError) -> StickslipError:
    """What to say, and to type, where a file could not be written."""
    if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
        what = "the disk is full" if error.errno == errno.ENOSPC else "the quota is used up"
        return StorageError(f"sweep: {what}, {str(path)!r} could not be written; free some space and type resume=True (--resume) to go on")
    if error.errno in (errno.EROFS, errno.EACCES, errno.EPERM):
        return InputError("sweep", [f"{str(path.parent)!r} cannot be written to ({error.strerror}); give a folder that you may write to"])
    return StorageError(f"sweep: {str(path)!r} could not be written: {error.strerror or error}")


def written(variables: dict[str, tuple[tuple[str, ...], Array, dict[str, Any]]], attributes: dict[str, Any]) -> bytes:
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


def axes_file(labels: dict[str, Column]) -> bytes:
    """The coordinates as a netCDF4 file; words as fixed-length characters."""
    variables = {}
    for i, (name, column) in enumerate(labels.items()):
        values, dims, attrs = np.asarray(column.values), column.dims, {"coordinate": name}
        if values.dtype.kind not in "iuf":
            values, kept = characters(values)
            dims, attrs = (*dims, f"characters_{i}"), {**attrs, "kept_as": kept}
        variables[name.replace(".", "_") if name not in dims else name] = (dims, values, attrs)
    return written(variables, {"stickslip_content": "axes of a study"})


# ---- the folder ----
def file_of(folder: Path, k: int) -> Path:
    """Where tile k is."""
    return folder / TILES / f"{k:07d}.nc"


def read_manifest(folder: str | Path) -> dict[str, Any]:
    """The manifest of a study folder; `InputError` if it is none."""
    path = Path(folder).expanduser() / MANIFEST
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        version = int(found["stickslip_format"])
    except FileNotFoundError:
        raise InputError(
            "study", [f"{str(folder)!r} is no study folder: it has no {MANIFEST}; give the folder of a sweep with out="]
        ) from None
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError("study", [f"{str(path)!r} cannot be read: {error}"]) from None
    if version > FORMAT:
        raise InputError("study", [f"{str(folder)!r} has format {version}, this stickslip reads up to {FORMAT}; install a newer stickslip"])
    return found


def shard_of(shard: Any) -> tuple[int, int] | None:
    """(i, n) from a pair or from "i/n"."""
    if shard is None:
        return None
    try:
        i, n = (int(part) for part in (shard.split("/") if isinstance(shard, str) else shard))
        if 1 <= i <= n:
            return i, n
    except (TypeError, ValueError):
        pass
    raise InputError("sweep", [f"shard = {shard!r}; allowed is i/n with i from 1 to n; type for example shard=(1, 7), or --shard 1/7"])


def tile_is_good(path: Path, study: str) -> bool:
    """Whether a file is a whole tile of this study."""
    import h5py

    try:
        with h5py.File(path, "r") as file:
            text = file.attrs.get("study", b"")
            return (text.decode() if isinstance(text, bytes) else str(text)) == study
    except (OSError, RuntimeError):
        return False


@dataclass(frozen=True, eq=False)
class Study:
    """A study folder that is being worked on.

    Parameters
    ----------
    folder : Path
    plan : Plan
    manifest : dict
    shard : (int, int), optional
        The part of the tiles that is ours.
    """

    folder: Path
    plan: Plan
    manifest: dict[str, Any]
    shard: tuple[int, int] | None = None

    @classmethod
    def begin(cls, folder: Path, plan: Plan, resume: bool = False, shard: Any = None) -> Study:
        """A new folder for a plan, or the one that is there, if it is of the same study and may be gone on with."""
        folder, mine, part = folder.expanduser(), manifest(plan), shard_of(shard)
        study = cls(folder, plan, mine, part)
        if (folder / MANIFEST).exists():
            study._check_same(read_manifest(folder))
            if not resume and any(True for _ in study.done):
                what = "results of this shard" if part else "results of this study"
                raise InputError(
                    "sweep", [f"{str(folder)!r} holds {what} already; type resume=True (--resume) to go on, or give another folder"]
                )
        else:
            study._make()
        study._sweep_up()
        return study

    def _make(self) -> None:
        if self.folder.exists() and (
            not self.folder.is_dir() or any(p.name not in (TILES, AXES) for p in self.folder.iterdir() if p.suffix != ".part")
        ):
            raise InputError("sweep", [f"{str(self.folder)!r} is there and is no study folder; give a new or an empty folder"])
        try:
            (self.folder / TILES).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise unwritable(self.folder, error) from None
        put(self.folder / AXES, axes_file(labels_of(self.plan)))
        if not put(self.folder / MANIFEST, json.dumps(self.manifest, indent=1, ensure_ascii=False).encode(), new=True):
            self._check_same(read_manifest(self.folder))  # another shard was first

    def _check_same(self, theirs: dict[str, Any]) -> None:
        if theirs.get("study") != self.manifest["study"]:
            told = differences(self.manifest["identity"], theirs.get("identity", {}))
            raise InputError("sweep", [f"{str(self.folder)!r} is the folder of another study: {reason}" for reason in told] or ["unknown"])

    def _sweep_up(self) -> None:
        """Remove what a killed process left half written of our tiles."""
        ours = {f".{file_of(self.folder, k).name}" for k in self.ours}
        try:
            for path in (self.folder / TILES).glob(".*.part"):
                if path.name.split(".nc.")[0] + ".nc" in ours:
                    path.unlink(missing_ok=True)
        except OSError as error:
            raise unwritable(self.folder / TILES / "x", error) from None

    @property
    def ours(self) -> range:
        """The tiles of our shard."""
        i, n = self.shard or (1, 1)
        return range(i - 1, self.plan.tiles, n)

    @cached_property
    def done(self) -> tuple[int, ...]:
        """Our tiles that are there."""
        names = {p.name for p in (self.folder / TILES).iterdir()} if (self.folder / TILES).exists() else set()
        study = self.manifest["study"]
        return tuple(k for k in self.ours if (p := file_of(self.folder, k)).name in names and tile_is_good(p, study))

    @property
    def todo(self) -> Iterable[int]:
        """Our tiles that are not."""
        done = set(self.done)
        return [k for k in self.ours if k not in done]

    def write(self, k: int, columns: dict[str, Array], notes: dict[str, int]) -> None:
        """Keep a tile."""
        import h5py

        first, last = self.plan.bounds(k)
        kept = io.BytesIO(self._template(last - first))
        with h5py.File(kept, "r+") as file:
            file["case"][...] = np.arange(first, last)
            for name in self.manifest["columns"]:
                file[name][...] = coded(name, columns[name])
            file.attrs["tile"] = k
            if notes:
                file.attrs["notes"] = json.dumps(notes, ensure_ascii=False, sort_keys=True)
        put(file_of(self.folder, k), kept.getvalue())

    @cached_property
    def _templates(self) -> dict[int, bytes]:
        return {}

    def _template(self, count: int) -> bytes:
        """A tile of this many cases without results: all but the numbers is the same in each, and slow to write."""
        if count not in self._templates:
            variables: dict[str, Any] = {
                "case": (("case",), np.zeros(count, "i8"), {"long_name": "number of the case, from 0, in C order"})
            }
            blank = empty(count)
            for name in self.manifest["columns"]:
                values = coded(name, blank[name])
                attrs = {n: v for n, v in described(name).items() if n != "flag_meanings"}
                variables[name] = (("case", "character")[: values.ndim], values, {**attrs, **flags(name)})
            self._templates[count] = written(variables, {"stickslip_content": "tile of a study", "study": self.manifest["study"]})
        return self._templates[count]

    def finish(self) -> None:
        """Nothing is left to do but to be sure that the names are on the disk."""
        if hasattr(os, "O_DIRECTORY"):
            handle = os.open(self.folder / TILES, os.O_RDONLY | os.O_DIRECTORY)
            try:
                os.fsync(handle)
            except OSError:
                pass
            finally:
                os.close(handle)
