"""Compiled kernels on disk: one source file per kernel, named by the hash of its content.

Numba's own cache does not see edits in imported functions, and never hits for closures. So everything that a kernel
needs stands in one file in the user's cache folder; a changed kernel has another name. The file's first lines import
what it needs; every function in it has an explicit signature, so that importing it compiles it or loads it.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
import tempfile
import threading
import types
from pathlib import Path

__all__ = ["folder", "load"]

_loaded: dict[str, types.ModuleType] = {}
_lock = threading.RLock()
_told: set[str] = set()


def folder() -> Path:
    """Where kernels are kept: STICKSLIP_CACHE_DIR, else XDG_CACHE_HOME/stickslip, else the platform's cache folder."""
    own = os.environ.get("STICKSLIP_CACHE_DIR")
    if own:
        return Path(own)
    xdg = os.environ.get("XDG_CACHE_HOME")
    if xdg:
        return Path(xdg) / "stickslip"
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local")) / "stickslip"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "stickslip"
    return Path.home() / ".cache" / "stickslip"


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
    key = f"{name}_{_digest(source)}"
    with _lock:
        if key not in _loaded:
            _loaded[key] = _import(source, key, label)
        return _loaded[key]


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
    except Exception:
        if not _compiled(path):  # not a bad cache: the source itself fails
            raise
        _say(f"the cached kernel {path.name} cannot be read; compiling {label} again …")
        for file in (path.parent / "__pycache__").glob(f"{path.stem}*"):
            file.unlink(missing_ok=True)
        return _execute(source, key, path)


def _written(source: str, key: str) -> Path | None:
    """The kernel's file, written whole or not at all; None where the folder cannot be written."""
    path = folder() / f"{key}.py"
    text = "CACHE = True\n" + source
    try:
        if path.exists() and path.read_text(encoding="utf-8") == text:
            probe = path.parent / "__pycache__"
            return path if _compiled(path) or os.access(probe if probe.exists() else path.parent, os.W_OK) else None
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=".tmp")
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(temporary, path)
    except OSError:
        return None
    return path


def _compiled(path: Path) -> bool:
    return any((path.parent / "__pycache__").glob(f"{path.stem}*.nbi"))


def _execute(source: str, key: str, path: Path | None) -> types.ModuleType:
    name = f"stickslip_kernel_{key}"
    if path is None:
        module = types.ModuleType(name)
        exec(compile("CACHE = False\n" + source, f"<{key}>", "exec"), module.__dict__)
        return module
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # Numba pickles functions by module name
    try:
        spec.loader.exec_module(module)
    except BaseException:
        sys.modules.pop(name, None)
        raise
    return module


def _say(sentence: str) -> None:
    if sentence not in _told:
        _told.add(sentence)
        print(sentence, file=sys.stderr, flush=True)
