"""Compiled kernels on disk: one source file per kernel, named by the hash of its content.

Numba's own cache does not see edits in imported functions, and never hits for closures. So everything that a kernel
needs stands in one file in the user's cache folder; a changed kernel has another name. The file's first lines import
what it needs; every function in it has an explicit signature, so that importing it compiles it or loads it.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib.util
import os
import sys
import threading
import types
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

from stickslip.basics.interruption import held_together
from stickslip.basics.whole_files import write_whole
from stickslip.engine.trust import SHARED, is_foreign, make_folder, private_folder, unsafe

_loaded: dict[str, types.ModuleType] = {}
_lock = threading.RLock()
_told: set[str] = set()


def folder() -> Path:
    """Where kernels are kept: STICKSLIP_CACHE_DIR, else XDG_CACHE_HOME/stickslip, else the platform's cache folder.

    Kernels are code that is run. A folder that others may write is not used, but a private one in the temporary folder instead, unless
    STICKSLIP_CACHE_SHARED=1 says that sharing is meant.
    """
    try:
        place = _chosen()
    except RuntimeError:  # a container whose user is in no list of users has no home
        place = None
    reason = "has no place, as there is no home folder" if place is None else unsafe(place)
    if place is not None and reason is None:
        return place
    own = private_folder()
    what = "the cache folder" if place is None else f"the cache folder {place}"
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


#: In a source: its loops have few rounds over numbers that stand apart, which vectors gather far more slowly than they are read one by one.
SHORT_LOOPS = "# loops: short"


def load(source: str, name: str, label: str) -> types.ModuleType:
    """The compiled module of a kernel's source.

    Parameters
    ----------
    source : str
        The whole text. It uses the name CACHE for Numba's ``cache=`` argument.
    name : str
        Start of the file's name.
    label : str
        What a person is told while it compiles, such as ``"LuGre × Harmonic"``.
    """
    with held_together():
        key = f"{name}_{_digest(source)}"
        with _lock:
            if key not in _loaded:
                _loaded[key] = _import(source, key, label)
            return _loaded[key]


@lru_cache(64)
def _digest(source: str) -> str:
    import llvmlite
    import numba

    versions = f"{numba.__version__} {llvmlite.__version__} {sys.version_info[:2]}"
    return hashlib.sha256((versions + source).encode()).hexdigest()[:20]


def _import(source: str, key: str, label: str) -> types.ModuleType:
    path = _written(source, key)
    if path is None:
        _say(f"the cache folder {folder()} cannot be written; compiling {label} in memory for this process only …")
        return _execute(source, key, None)
    if not _compiled(path):
        _say(f"compiling {label}, once …")
    try:
        return _execute(source, key, path)
    except OSError as error:  # Numba could not write what it has compiled, such as on a full disk
        _say(f"the cache folder {folder()} cannot be written ({error.strerror}); compiling {label} in memory for this process only …")
        return _execute(source, key, None)
    except Exception:
        if not _compiled(path):  # not a bad cache: the source itself fails
            raise
        _say(f"the cached kernel {path.name} cannot be read; compiling {label} again …")
        for file in _compilation(path):
            file.unlink(missing_ok=True)
        return _execute(source, key, path)


def _written(source: str, key: str) -> Path | None:
    """The kernel's file, written whole or not at all; None where the folder cannot be written."""
    path = folder() / f"{key}.py"
    text = "CACHE = True\n" + source
    try:
        _remove_foreign(path)
        if path.exists() and path.read_text(encoding="utf-8") == text:
            probe = path.parent / "__pycache__"
            return path if _compiled(path) or os.access(probe if probe.exists() else path.parent, os.W_OK) else None
        make_folder(path.parent / "__pycache__")
        write_whole(path, text, lambda _, error: error)
    except OSError:
        return None
    return path


def _remove_foreign(path: Path) -> None:
    """Delete what somebody else has put in place of a kernel; OSError where that cannot be done."""
    for file in (path, *_compilation(path)):
        if is_foreign(file):
            file.unlink()


def _compilation(path: Path) -> list[Path]:
    """Files that Python and Numba keep of a kernel's file."""
    beside = path.parent / "__pycache__"  # of a cache with many kernels: no pattern is matched against all of its names
    return [beside / name for name in (os.listdir(beside) if beside.is_dir() else ()) if name.startswith(path.stem)]


def _compiled(path: Path) -> bool:
    return any(file.suffix == ".nbi" for file in _compilation(path))


def _execute(source: str, key: str, path: Path | None) -> types.ModuleType:
    name = f"stickslip_kernel_{key}"
    spec = None if path is None else importlib.util.spec_from_file_location(name, path)
    module = types.ModuleType(name) if spec is None else importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # Numba pickles functions by module name, and classes look for their module there
    try:
        with _numba_as_asked(source):
            if spec is None:
                exec(compile("CACHE = False\n" + source, f"<{key}>", "exec"), module.__dict__)
            else:
                assert spec.loader is not None
                spec.loader.exec_module(module)
    except BaseException:
        sys.modules.pop(name, None)
        raise
    return module


@contextlib.contextmanager
def _numba_as_asked(source: str) -> Iterator[None]:
    """Numba keeps what it makes beside the file, whatever NUMBA_CACHE_DIR says, and leaves loops as they are where a source says so."""
    from numba.core import config

    before = config.CACHE_DIR, config.LOOP_VECTORIZE
    config.CACHE_DIR = ""
    if SHORT_LOOPS in source:
        config.LOOP_VECTORIZE = 0
    try:
        yield
    finally:
        config.CACHE_DIR, config.LOOP_VECTORIZE = before


def _say(sentence: str) -> None:
    if sentence not in _told:
        _told.add(sentence)
        print(sentence, file=sys.stderr, flush=True)
