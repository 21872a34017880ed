"""A study folder: its manifest, its axes, and one file for each tile, each written under a temporary name and then renamed.

Whatever happens to the process, a tile exists completely or not at all; the folder itself is the record of the finished tiles.
"""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, StickslipError, as_path
from stickslip.basics.whole_files import whole_file
from stickslip.studies.labelling import coordinates_of_grid
from stickslip.studies.manifest import FORMAT, SECONDS, differences_between, flaw, manifest
from stickslip.studies.model_identity import ModelIdentities
from stickslip.studies.planning import Plan
from stickslip.studies.space_file import AXES, axes_bytes, read_labels
from stickslip.studies.tiles import TILES, file_of, tile_bytes, tile_is_good

MANIFEST = "manifest.json"
#: The shell command that began the study.
COMMAND = "command.json"


class StorageError(StickslipError, OSError):
    """A folder has become unwritable; its contents are kept, and the study can be resumed."""


# ---- bytes on the disk ----
def put_file(path: Path, content: bytes, new: bool = False) -> bool:
    """Write a file atomically. With `new`, an existing file is kept, and False is returned."""
    try:
        with whole_file(path, unwritable_error, new) as file:
            file.write(content)
    except FileExistsError:
        return False
    return True


_NO_ROOM = {
    errno.ENOSPC: "the disk is full", errno.EDQUOT: "the quota is used up",
    errno.EFBIG: "a file would be larger than the file system or `ulimit -f` allows",
}  # fmt: skip


def unwritable_error(path: Path, error: OSError) -> StickslipError:
    """The error, with advice, for a file that could not be written."""
    if error.errno in _NO_ROOM:
        what = _NO_ROOM[error.errno]
        return StorageError(f"sweep: {what}, {str(path)!r} could not be written; free some space and type resume=True (--resume) to go on")
    if error.errno in (errno.EROFS, errno.EACCES, errno.EPERM):
        return InputError("sweep", [f"{str(path.parent)!r} cannot be written to ({error.strerror}); give a folder that you may write to"])
    return StorageError(f"sweep: {str(path)!r} could not be written: {error.strerror or error}")


# ---- the folder ----
def check_new(what: str, folder: Path, known: tuple[str, ...], kind: str) -> None:
    """Raise an `InputError` if the folder exists and contains anything but the known names."""
    if folder.exists() and (not folder.is_dir() or any(p.name not in known for p in folder.iterdir() if p.suffix != ".part")):
        raise InputError(what, [f"{str(folder)!r} is there and is not {kind}; give a new or an empty folder"])


def make_study_folder(folder: Path, inside: str = "") -> None:
    """Create a folder with its parents, and one inside it."""
    try:
        (folder / inside).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable_error(folder, error) from None


def read_manifest(folder: str | Path) -> dict[str, Any]:
    """The manifest of a study folder; `InputError` if the folder is not one."""
    path = as_path(folder, "open_study", "grid") / MANIFEST
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
        version = int(manifest["stickslip_format"])
    except FileNotFoundError:
        raise InputError(
            "study", [f"{str(folder)!r} is not a study folder: it has no {MANIFEST}; give the folder of a sweep with out="]
        ) from None
    except (OSError, ValueError, KeyError, TypeError, OverflowError, RecursionError) as error:
        raise InputError("study", [f"{str(path)!r} cannot be read: {error}; {_ANEW}"]) from None
    if manifest.get("content") == "atlas":
        raise InputError(
            "study", [f"{str(folder)!r} is the folder of an atlas; type ss.atlas(..., out=, resume=True), or stickslip resume"]
        )
    if version > FORMAT:
        raise InputError("study", [f"{str(folder)!r} has format {version}, this stickslip reads up to {FORMAT}; install a newer stickslip"])
    if (what := flaw(manifest)) is not None:
        raise InputError("study", [f"{str(path)!r} is damaged: {what}; {_ANEW}"])
    return manifest


_ANEW = "delete it and type the sweep again with resume=True (--resume), which writes it anew and keeps the tiles"


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


@dataclass(frozen=True, eq=False)
class StudyFolder:
    """A study folder in use.

    Parameters
    ----------
    folder : Path
    plan : Plan
    manifest : dict
    shard : (int, int), optional
        The shard of the tiles to compute.
    """

    folder: Path
    plan: Plan
    manifest: dict[str, Any]
    shard: tuple[int, int] | None = None
    identities: ModelIdentities | None = None

    @classmethod
    def begin(cls, folder: Path, plan: Plan, resume: bool = False, shard: Any = None, keep: bool = False) -> StudyFolder:
        """Begin a new folder for a plan, or continue an existing one if it belongs to the same study and may be resumed.

        With `keep` the models that are made are kept for the tiles that are to be solved.
        """
        folder, part = folder.expanduser(), shard_of(shard)
        there = read_manifest(folder) if (folder / MANIFEST).exists() else None
        identities = ModelIdentities(plan, keep=keep)
        study = cls(folder, plan, manifest(plan, there, identities), part, identities)
        if there is not None:
            study._check_same(there)
            if not resume and any(True for _ in study.done):
                what = "results of this shard" if part else "results of this study"
                raise InputError(
                    "sweep", [f"{str(folder)!r} holds {what} already; type resume=True (--resume) to go on, or give another folder"]
                )
            study._mend_axes()
        else:
            study._make()
        study._sweep_up()
        identities.keep_only(study.todo)
        return study

    @property
    def unmade(self) -> str:
        """A note on tiles that are there and whose models were not made again; "" if there are none."""
        left = len(set(self.identities.left_out if self.identities else ()) & set(self.done))
        if not left:
            return ""
        of = f"unchecked when this study was resumed: the models of {left} of {len(self.done)} finished tiles"
        return f"{of}, which were not made again within {SECONDS:g} s; the maker's code and all models that were made are the same"

    def _make(self) -> None:
        check_new("sweep", self.folder, (TILES, AXES, COMMAND, MANIFEST), "a study folder")  # with a manifest, another process was faster
        make_study_folder(self.folder, TILES)
        self._mend_axes()
        if not put_file(self.folder / MANIFEST, json.dumps(self.manifest, indent=1, ensure_ascii=False).encode(), new=True):
            self._check_same(read_manifest(self.folder))  # another shard was faster

    def _mend_axes(self) -> None:
        """Write the axes if they are damaged or missing."""
        try:
            read_labels(self.folder, self.manifest)
        except InputError:
            put_file(self.folder / AXES, axes_bytes(coordinates_of_grid(self.plan), self.manifest))

    def _check_same(self, theirs: dict[str, Any]) -> None:
        if theirs["stickslip_format"] != FORMAT:
            what = f"{str(self.folder)!r} was begun by an earlier stickslip (format {theirs['stickslip_format']}, today's is {FORMAT})"
            why = "which did not record the models of each tile"
            raise InputError("sweep", [f"{what}, {why}: it can be opened, merged and exported, but not gone on with; give another folder"])
        if theirs.get("study") != self.manifest["study"]:
            differences = differences_between(self.manifest, theirs)
            raise InputError(
                "sweep", [f"{str(self.folder)!r} is the folder of another study: {reason}" for reason in differences] or ["unknown"]
            )

    def _sweep_up(self) -> None:
        """Remove incomplete files that a killed process left for our tiles."""
        ours = {f".{file_of(self.folder, k).name}" for k in self.ours}
        try:
            for path in (self.folder / TILES).glob(".*.part"):
                if path.name.split(".nc.")[0] + ".nc" in ours:
                    path.unlink(missing_ok=True)
        except OSError as error:
            raise unwritable_error(self.folder / TILES / "x", error) from None

    @property
    def ours(self) -> range:
        """The tiles of our shard."""
        i, n = self.shard or (1, 1)
        return range(i - 1, self.plan.tiles, n)

    @cached_property
    def done(self) -> tuple[int, ...]:
        """Our tiles that exist undamaged."""
        names = {p.name for p in (self.folder / TILES).iterdir()} if (self.folder / TILES).exists() else set()
        return tuple(k for k in self.ours if file_of(self.folder, k).name in names and tile_is_good(self.folder, k, self.manifest))

    @property
    def todo(self) -> Iterable[int]:
        """Our tiles that are still to be computed."""
        return sorted(set(self.ours) - set(self.done))

    def write(self, k: int, columns: dict[str, Array], notes: dict[str, int], models: str) -> None:
        """Store a tile; `models` is the identity of the models with which it was computed."""
        self.check_models(k, models)
        put_file(file_of(self.folder, k), tile_bytes(self.manifest, k, self.plan.bounds(k)[0], columns, notes))

    def check_models(self, k: int, models: str) -> None:
        """Raise an `InputError` if tile k was computed with other models than the study has."""
        if models != self.manifest["models"][k]:
            each = self.manifest["cases_per_tile"]
            where = f"cases {k * each} to {min((k + 1) * each, self.manifest['cases']) - 1}"
            what = f"{where} were computed with other models than those of the study in {str(self.folder)!r}, and are not kept"
            why = "the maker gives other models from call to call, or on another machine; let it depend on its arguments only"
            raise InputError("sweep", [f"{what}: {why}"])

    def finish(self) -> None:
        """Flush the folder, so that the file names are on the disk."""
        if hasattr(os, "O_DIRECTORY"):
            handle = os.open(self.folder / TILES, os.O_RDONLY | os.O_DIRECTORY)
            with suppress(OSError):
                os.fsync(handle)
            os.close(handle)
