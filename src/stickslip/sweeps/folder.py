"""A study folder: its manifest, its axes, and one file for each tile, each written beside its place and then moved there.

Whatever happens to the process, a tile is there as a whole or not at all; the folder itself is the record of what is done.
"""

from __future__ import annotations

import errno
import json
import os
import secrets
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from stickslip.contracts import Array
from stickslip.errors import InputError, StickslipError, as_path
from stickslip.sweeps.labelling import labels_of
from stickslip.sweeps.manifest import FORMAT, differences, flaw, manifest
from stickslip.sweeps.planning import Plan
from stickslip.sweeps.space_file import AXES, axes_bytes, read_labels
from stickslip.sweeps.tiles import TILES, file_of, tile_bytes, tile_is_good

MANIFEST = "manifest.json"
#: What was typed in the shell to begin the study.
COMMAND = "command.json"


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


_NO_ROOM = {
    errno.ENOSPC: "the disk is full", errno.EDQUOT: "the quota is used up",
    errno.EFBIG: "a file would be larger than the file system or `ulimit -f` allows",
}  # fmt: skip


def unwritable(path: Path, error: OSError) -> StickslipError:
    """The message, with a suggestion, for a file that could not be written."""
    if error.errno in _NO_ROOM:
        what = _NO_ROOM[error.errno]
        return StorageError(f"sweep: {what}, {str(path)!r} could not be written; free some space and type resume=True (--resume) to go on")
    if error.errno in (errno.EROFS, errno.EACCES, errno.EPERM):
        return InputError("sweep", [f"{str(path.parent)!r} cannot be written to ({error.strerror}); give a folder that you may write to"])
    return StorageError(f"sweep: {str(path)!r} could not be written: {error.strerror or error}")


# ---- the folder ----
def check_new(what: str, folder: Path, known: tuple[str, ...], kind: str) -> None:
    """`InputError` for a folder that is there, and holds something else than what is known."""
    if folder.exists() and (not folder.is_dir() or any(p.name not in known for p in folder.iterdir() if p.suffix != ".part")):
        raise InputError(what, [f"{str(folder)!r} is there and is not {kind}; give a new or an empty folder"])


def make_folder(folder: Path, inside: str = "") -> None:
    """Make a folder, those above it, and one in it."""
    try:
        (folder / inside).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(folder, error) from None


def read_manifest(folder: str | Path) -> dict[str, Any]:
    """The manifest of a study folder; `InputError` if it is none."""
    path = as_path(folder, "open_study", "grid") / MANIFEST
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        version = int(found["stickslip_format"])
    except FileNotFoundError:
        raise InputError(
            "study", [f"{str(folder)!r} is not a study folder: it has no {MANIFEST}; give the folder of a sweep with out="]
        ) from None
    except (OSError, ValueError, KeyError, TypeError, OverflowError, RecursionError) as error:
        raise InputError("study", [f"{str(path)!r} cannot be read: {error}; {_ANEW}"]) from None
    if found.get("content") == "atlas":
        raise InputError(
            "study", [f"{str(folder)!r} is the folder of an atlas; type ss.atlas(..., out=, resume=True), or stickslip resume"]
        )
    if version > FORMAT:
        raise InputError("study", [f"{str(folder)!r} has format {version}, this stickslip reads up to {FORMAT}; install a newer stickslip"])
    if (what := flaw(found)) is not None:
        raise InputError("study", [f"{str(path)!r} is damaged: {what}; {_ANEW}"])
    return found


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
            study._mend_axes()
        else:
            study._make()
        study._sweep_up()
        return study

    def _make(self) -> None:
        check_new("sweep", self.folder, (TILES, AXES, COMMAND), "a study folder")
        make_folder(self.folder, TILES)
        self._mend_axes()
        if not put(self.folder / MANIFEST, json.dumps(self.manifest, indent=1, ensure_ascii=False).encode(), new=True):
            self._check_same(read_manifest(self.folder))  # another shard was first

    def _mend_axes(self) -> None:
        """Write the axes where they are damaged or missing."""
        try:
            read_labels(self.folder, self.manifest)
        except InputError:
            put(self.folder / AXES, axes_bytes(labels_of(self.plan), self.manifest))

    def _check_same(self, theirs: dict[str, Any]) -> None:
        if theirs["stickslip_format"] != FORMAT:
            what = f"{str(self.folder)!r} was begun by an earlier stickslip (format {theirs['stickslip_format']}, today's is {FORMAT})"
            raise InputError("sweep", [f"{what}: it can be opened and exported, but not gone on with; give another folder"])
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
        """Our tiles that are there, as they were written."""
        names = {p.name for p in (self.folder / TILES).iterdir()} if (self.folder / TILES).exists() else set()
        return tuple(k for k in self.ours if file_of(self.folder, k).name in names and tile_is_good(self.folder, k, self.manifest))

    @property
    def todo(self) -> Iterable[int]:
        """Our tiles that are not."""
        return sorted(set(self.ours) - set(self.done))

    def write(self, k: int, columns: dict[str, Array], notes: dict[str, int]) -> None:
        """Keep a tile."""
        put(file_of(self.folder, k), tile_bytes(self.manifest, k, self.plan.bounds(k)[0], columns, notes))

    def finish(self) -> None:
        """Nothing is left to do but to be sure that the names are on the disk."""
        if hasattr(os, "O_DIRECTORY"):
            handle = os.open(self.folder / TILES, os.O_RDONLY | os.O_DIRECTORY)
            with suppress(OSError):
                os.fsync(handle)
            os.close(handle)
