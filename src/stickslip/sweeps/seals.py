"""Checksums of the files of a study: of all bytes, and of the part of the study that each file holds.

A disk that flips a bit, a tile under the number of another and a file of another study are found before anything else reads the file,
since the HDF5 library may crash on damaged bytes. The checksum stands behind the end of the netCDF4 file, where its readers do not look.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from stickslip import hdf5
from stickslip.errors import InputError
from stickslip.unpacking import Allowance

#: The checksum of a manifest in it.
SEAL = "checksum"
_BEFORE, _AFTER, _SIZE = b"\nstickslip checksum ", b"\n", 32
#: Files that were found intact, by what changes when a file does: they are looked at column by column.
_intact: set[tuple[Any, ...]] = set()


class Damaged(ValueError):
    """A file of a study is not as it was written; the sentence says how that shows."""


def of_manifest(manifest: dict[str, Any]) -> str:
    """Checksum of a manifest but for the checksum in it."""
    rest = {name: value for name, value in manifest.items() if name != SEAL}
    return _hash("manifest", json.dumps(json.loads(json.dumps(rest)), sort_keys=True).encode()).decode()


def sealed(content: bytes, mark: str) -> bytes:
    """The bytes of a file with their checksum; `mark` says which part of which study it is."""
    return content + _BEFORE + _hash(mark, content) + _AFTER


def _hash(mark: str, content: bytes) -> bytes:
    made = hashlib.blake2b(mark.encode() + b"\n", digest_size=_SIZE // 2)
    made.update(content)
    return made.hexdigest().encode()


def text_of(attribute: Any) -> str:
    """An attribute of an HDF5 file as text."""
    return attribute.decode() if isinstance(attribute, bytes) else str(attribute)


def _check(path: Path, mark: str | None) -> None:
    """That a file is as it was written, and holds all its numbers itself; looked at once for each file."""
    about = path.stat()
    key = (mark, str(path), about.st_ino, about.st_size, about.st_mtime_ns)
    if key in _intact:
        return
    if mark is not None:
        _check_seal(path.read_bytes(), mark)
    with hdf5.opened(os.fspath(path), "study", Allowance("study", about.st_size), for_others=True):
        pass
    if len(_intact) > 100_000:
        _intact.clear()
    _intact.add(key)


def _check_seal(content: bytes, mark: str) -> None:
    end = len(content) - len(_BEFORE) - _SIZE - len(_AFTER)
    if end < 0 or content[end:] != _BEFORE + _hash(mark, content[:end]) + _AFTER:
        raise Damaged("its checksum does not fit")


def read_sealed(path: Path, mark: str | None, read: Callable[[Any], Any]) -> Any:
    """The result of `read` for an open HDF5 file whose checksum matches; files without a mark have none.

    Raises
    ------
    FileNotFoundError
        Where there is no such file.
    Damaged
        Where the file is not as it was written, whatever shows it.
    """
    import h5py

    try:
        _check(path, mark)
        with h5py.File(os.fspath(path), "r") as file:
            return read(file)
    except (FileNotFoundError, Damaged):
        raise
    except InputError as error:
        raise Damaged("; ".join(error.problems)) from None
    except Exception as error:  # h5py raises almost anything over damaged bytes
        raise Damaged(str(error) or type(error).__name__) from None
