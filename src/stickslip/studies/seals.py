"""Checksums of the files of a study: of all bytes, and of the identity of the part of the study in each file.

Flipped bits, a tile under the number of another, and a file of another study are detected before anything else reads the file, since
the HDF5 library may crash on damaged bytes. The checksum follows the end of the netCDF4 data, which its readers ignore.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from stickslip.basics import hdf5
from stickslip.basics.errors import InputError
from stickslip.basics.unpacking import Allowance

#: The key of the checksum in a manifest.
SEAL = "checksum"
_BEFORE, _AFTER, _SIZE = b"\nstickslip checksum ", b"\n", 32
#: Before the checksum stands the identity of the models whose results the file holds.
_MODELS = b"\nstickslip models "
#: Files that were found intact, with the properties that change when a file does: they are read column by column.
_intact: set[tuple[Any, ...]] = set()


class Damaged(ValueError):
    """A file of a study differs from what was written; the message gives the evidence."""


def of_manifest(manifest: dict[str, Any]) -> str:
    """Checksum of a manifest without its own entry."""
    rest = {name: value for name, value in manifest.items() if name != SEAL}
    return _hash("manifest", json.dumps(json.loads(json.dumps(rest)), sort_keys=True).encode()).decode()


def sealed_bytes(content: bytes, mark: str, models: str = "") -> bytes:
    """The bytes of a file with their checksum; `mark` identifies the study and the part, `models` the models of a tile."""
    content += _MODELS + models.encode() if models else b""
    return content + _BEFORE + _hash(mark, content) + _AFTER


def is_intact(path: Path, mark: str, models: str = "") -> bool:
    """Whether a file exists, is as it was written, and holds results of these models; it is not opened with the HDF5 library."""
    try:
        _check_seal(path.read_bytes(), mark, models)
    except (FileNotFoundError, Damaged):
        return False
    return True


def _hash(mark: str, content: bytes) -> bytes:
    made = hashlib.blake2b(mark.encode() + b"\n", digest_size=_SIZE // 2)
    made.update(content)
    return made.hexdigest().encode()


def attribute_text(attribute: Any) -> str:
    """An attribute of an HDF5 file as text."""
    return attribute.decode() if isinstance(attribute, bytes) else str(attribute)


def _check(path: Path, mark: str | None, models: str) -> None:
    """Check that a file is as it was written, and that it contains all its data; done once for each file."""
    about = path.stat()
    key = (mark, models, str(path), about.st_ino, about.st_size, about.st_mtime_ns)
    if key in _intact:
        return
    if mark is not None:
        _check_seal(path.read_bytes(), mark, models)
    with hdf5.checked_file(os.fspath(path), "study", Allowance("study", about.st_size), for_others=True):
        pass
    if len(_intact) > 100_000:
        _intact.clear()
    _intact.add(key)


def _check_seal(content: bytes, mark: str, models: str) -> None:
    end = len(content) - len(_BEFORE) - _SIZE - len(_AFTER)
    if end < 0 or content[end:] != _BEFORE + _hash(mark, content[:end]) + _AFTER:
        raise Damaged("its checksum does not fit")
    if models and not content[:end].endswith(_MODELS + models.encode()):
        raise Damaged("it holds results of other models than the study")


def read_sealed(path: Path, mark: str | None, read: Callable[[Any], Any], models: str = "") -> Any:
    """The result of `read` for an open HDF5 file with a valid checksum; without a mark the file has none.

    If `models` is given, the file must be a tile with the results of these models.

    Raises
    ------
    FileNotFoundError
        If the file does not exist.
    Damaged
        If the file is not as it was written.
    """
    import h5py

    try:
        _check(path, mark, models)
        with h5py.File(os.fspath(path), "r") as file:
            return read(file)
    except (FileNotFoundError, Damaged):
        raise
    except InputError as error:
        raise Damaged("; ".join(error.problems)) from None
    except Exception as error:  # h5py may raise almost anything on damaged bytes
        raise Damaged(str(error) or type(error).__name__) from None
