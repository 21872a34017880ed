"""Compiled kernels on disk: one file of machine code for each, named by the hash of its source and of what compiles it.

A changed kernel has another name, and so has one for another processor. Machine code is run as it stands in its file, so a damaged file
crashes or computes something else: its first bytes are the checksum of the others, and one that does not agree is compiled again.
"""

from __future__ import annotations

import errno
import hashlib
import os
import sys
import threading
from functools import lru_cache
from pathlib import Path

from stickslip.basics.interruption import held_together
from stickslip.basics.notices import notify
from stickslip.basics.whole_files import write_whole
from stickslip.engine.kernel_text import KernelSource
from stickslip.engine.machine_code import Compiled, machine_code, versions
from stickslip.engine.trust import SHARED, is_foreign, make_folder, private_folder, unsafe

#: How many kernels that can be loaded from their files again are kept in memory; each takes some 40 kB.
KEPT = 256
#: Ends the name of a kernel's file.
ENDING = ".kernel"
_CHECKSUM = 32  # bytes

_loaded: dict[str, tuple[Compiled, bool]] = {}  # the least recently used first
_lock = threading.RLock()
_reported: set[str] = set()


def folder() -> Path:
    """Where kernels are kept: STICKSLIP_CACHE_DIR, else XDG_CACHE_HOME/stickslip, else the platform's cache folder.

    Kernels are code that is run. A folder that others may write is not used, but a private one in the temporary folder instead, unless
    STICKSLIP_CACHE_SHARED=1 says that sharing is meant.
    """
    try:
        chosen = _chosen()
    except RuntimeError:  # a container whose user is in no list of users has no home
        chosen = None
    reason = "has no place, as there is no home folder" if chosen is None else unsafe(chosen)
    if chosen is not None and reason is None:
        return chosen
    own = private_folder()
    what = "the cache folder" if chosen is None else f"the cache folder {chosen}"
    _say(
        f"{what} {reason}; {own} is used instead, since kernels are code that is run; "
        f"set STICKSLIP_CACHE_DIR to a folder of your own, or {SHARED}=1 if sharing is meant"
    )
    return own


def _chosen() -> Path:
    """The folder that the environment or the platform names."""
    own = os.environ.get("STICKSLIP_CACHE_DIR")
    if own:
        return Path(own).expanduser()
    xdg = os.environ.get("XDG_CACHE_HOME")
    if xdg:
        return Path(xdg).expanduser() / "stickslip"
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local") / "stickslip"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "stickslip"
    return Path.home() / ".cache" / "stickslip"


def load(source: KernelSource, name: str, label: str) -> Compiled:
    """The compiled kernel of a source.

    Parameters
    ----------
    source : KernelSource
    name : str
        Start of the file's name.
    label : str
        What a person is told while it compiles, such as ``"LuGre × Harmonic"``.
    """
    with held_together():
        key = f"{name}_{source.digest}"
        with _lock:
            kernel, kept = _loaded.pop(key, None) or _brought(source, key, label)
            _loaded[key] = kernel, kept
            _forget()
            return kernel


def _forget() -> None:
    """Let go of kernels that were not used for long. Those without a file stay: they would be compiled again."""
    if len(_loaded) > KEPT:
        from_files = [key for key, (_, kept) in _loaded.items() if kept]
        for key in from_files[: len(_loaded) - KEPT]:
            del _loaded[key]


@lru_cache(1)
def _machine() -> str:
    """The end of a file's name: a checksum of the compiler's version and of the processor."""
    return hashlib.sha256(versions().encode()).hexdigest()[:8] + ENDING


def _brought(source: KernelSource, key: str, label: str) -> tuple[Compiled, bool]:
    """A kernel, from its file or compiled, and whether there is a file."""
    try:
        path = _place(key)
        content = _content(path)
    except OSError as error:  # nothing can be written, or something else stands where a file should be
        return _in_memory(source, key, label, error)
    if content is None:
        _say(f"compiling {label}, once …")
    else:
        code = content[_CHECKSUM:]
        if hashlib.sha256(code).digest() == content[:_CHECKSUM]:
            return Compiled(source, code, key), True
        _say(f"the compiled kernel {path.name} is damaged; compiling {label} again …")
    code = machine_code(source)
    try:
        write_whole(path, hashlib.sha256(code).digest() + code, lambda _, error: error)
    except OSError as error:  # such as on a full disk
        _not_kept(key, label, error)
        return Compiled(source, code, key), False
    return Compiled(source, code, key), True


def _in_memory(source: KernelSource, key: str, label: str, error: OSError) -> tuple[Compiled, bool]:
    """A kernel without a file, and what is wrong with it."""
    _not_kept(key, label, error)
    return Compiled(source, machine_code(source), key), False


def _not_kept(key: str, label: str, error: OSError) -> None:
    """Say why there is no file."""
    cache = folder()
    blocked = [Path(name) for name in (error.filename, error.filename2) if isinstance(name, str) and key in Path(name).name]
    blocked = [file for file in blocked if file.is_dir()]
    if blocked:
        why = f"is damaged: {blocked[0]} is a folder where a file should be; delete it"
    elif cache.exists() and not cache.is_dir():
        why = "is not a folder; delete it, or set STICKSLIP_CACHE_DIR to a folder of yours"
    else:
        why = f"cannot be written ({error.strerror or error})"
    _say(f"the cache folder {cache} {why}; compiling {label} in memory for this process only …")


def _place(key: str) -> Path:
    """Where a kernel's file stands or will stand; OSError where that cannot be."""
    path = folder() / f"{key}_{_machine()}"
    make_folder(path.parent)
    if is_foreign(path):  # somebody else has put it there
        path.unlink()
    elif path.is_dir():
        try:
            path.rmdir()
        except OSError as error:  # it holds something: not for us to delete
            raise IsADirectoryError(error.errno, os.strerror(error.errno or errno.EISDIR), str(path)) from None
    if not path.exists() and not os.access(path.parent, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path.parent))
    return path


def _content(path: Path) -> bytes | None:
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return None


def _say(sentence: str) -> None:
    if sentence not in _reported:
        _reported.add(sentence)
        notify(sentence)
