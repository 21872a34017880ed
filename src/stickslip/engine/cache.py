"""Compiled kernels on disk: one source file per kernel, named by the hash of its content.

Numba's own cache does not see edits in imported functions, and never hits for closures. So everything that a kernel needs stands in one
file in the user's cache folder, or, of the compiler that it imports, a checksum; a changed kernel has another name. The file's first lines
import what it needs; every function in it has an explicit signature, so that importing it compiles it or loads it.

Compiled code is run as it stands in its files, so a damaged file crashes or computes something else. Beside them stands
a list of their checksums; what does not agree with it is deleted and compiled again.
"""

from __future__ import annotations

import contextlib
import errno
import gc
import hashlib
import importlib.util
import json
import os
import sys
import threading
import types
import weakref
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

from stickslip.basics.interruption import held_together
from stickslip.basics.notices import notify
from stickslip.basics.whole_files import write_whole
from stickslip.engine.trust import SHARED, is_foreign, make_folder, private_folder, unsafe

#: How many modules that can be loaded from their files again are kept in memory; each takes some 40 kB.
KEPT = 256

_loaded: dict[str, types.ModuleType] = {}  # the least recently used first
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
            module = _loaded.pop(key, None) or _import(source, key, label)
            _loaded[key] = module
            _forget()
            return module


def _forget() -> None:
    """Let go of modules that were not used for long. Those without a file stay: they would be compiled again."""
    if len(_loaded) > KEPT:
        from_files = [key for key, module in _loaded.items() if getattr(module, "__file__", None)]
        for key in from_files[: len(_loaded) - KEPT]:
            module = _loaded.pop(key)
            sys.modules.pop(module.__name__, None)
            _release(module)


def _release(module: types.ModuleType) -> None:
    """Make Numba let go of a module's compiled functions, so that they are freed with the last who holds one of them.

    Numba keeps each in a table, and takes it out when its dispatcher is freed; but what does that holds, by the function's globals, the
    dispatcher itself, which is therefore never freed. So it is done here.
    """
    functions = {id(part): part for part in vars(module).values() if hasattr(part, "overloads") and hasattr(part, "targetctx")}
    for function in functions.values():
        for compiled in function.overloads.values():
            with contextlib.suppress(KeyError):
                function.targetctx.remove_user_function(compiled.entry_point)
    for finalizer in list(getattr(weakref.finalize, "_registry", ())):
        alive = finalizer.peek()
        if alive is not None and id(alive[0]) in functions:
            finalizer.detach()


@lru_cache(64)
def _digest(source: str) -> str:
    import llvmlite
    import numba

    versions = f"{numba.__version__} {llvmlite.__version__} {sys.version_info[:2]}"
    return hashlib.sha256((versions + source).encode()).hexdigest()[:20]


def _import(source: str, key: str, label: str) -> types.ModuleType:
    try:
        path = _written(source, key)
        files = _compilation(path)
        if _is_damaged(path, files):
            _say(f"the compiled kernel {path.name} is damaged; compiling {label} again …")
            _remove(files)
            files = []
        elif not _compiled(files):
            _say(f"compiling {label}, once …")
    except OSError as error:  # nothing can be written, or something else stands where a file should be
        return _in_memory(source, key, label, error)
    try:
        return _sealed(source, key, path, files)
    except OSError as error:  # Numba could not write what it has compiled, such as on a full disk
        return _in_memory(source, key, label, error)
    except Exception:
        if not _compiled(_compilation(path)):  # not a bad cache: the source itself fails
            raise
    _say(f"the cached kernel {path.name} cannot be read; compiling {label} again …")
    try:
        _remove(_compilation(path))
        return _sealed(source, key, path, [])
    except OSError as error:
        return _in_memory(source, key, label, error)


def _in_memory(source: str, key: str, label: str, error: OSError) -> types.ModuleType:
    """The module without files, and what is wrong with them."""
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
    return _execute(source, key, None)


def _written(source: str, key: str) -> Path:
    """The kernel's file, written whole or not at all; OSError where the folder cannot be written."""
    path, text = folder() / f"{key}.py", "CACHE = True\n" + source
    compiled = path.parent / "__pycache__"
    if path.parent.is_dir() and not compiled.is_dir() and (compiled.exists() or compiled.is_symlink()):
        compiled.unlink()  # a file, or a link that leads nowhere
    _remove_foreign(path)
    if path.is_dir():
        _remove([path])
    if not (path.exists() and _text_of(path) == text):
        make_folder(compiled)
        write_whole(path, text, lambda _, error: error)
    elif not (os.access(compiled if compiled.exists() else path.parent, os.W_OK) or _compiled(_compilation(path))):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(compiled))
    return path


def _text_of(path: Path) -> str | None:
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return None


def _is_damaged(path: Path, files: list[Path]) -> bool:
    """Whether the compiled files of a kernel, all that there are, are others than those whose checksums were noted when they were compiled.

    Files without a list, of an earlier version or of a process that compiles them now, are taken; if they cannot be read they are
    compiled again, and their list is written once they have been loaded.
    """
    if any(file.is_dir() for file in files):
        return True
    try:
        noted = json.loads(_list_of(path).read_bytes())
    except FileNotFoundError:
        return False
    except ValueError:
        return True
    return not isinstance(noted, dict) or any(noted.get(name) != code for name, code in _checksums(files).items())


def _sealed(source: str, key: str, path: Path, files: list[Path]) -> types.ModuleType:
    """The module, loaded from its files or compiled; the checksums of files that are new are noted."""
    before = _stamps(files)
    module = _execute(source, key, path)
    files = _compilation(path)
    if _stamps(files) != before or not _list_of(path).exists():
        with contextlib.suppress(OSError):
            write_whole(_list_of(path), json.dumps(_checksums(files), indent=1), lambda _, error: error)
    return module


def _list_of(path: Path) -> Path:
    """The file of checksums of a kernel."""
    return path.parent / "__pycache__" / f"{path.stem}.sums.json"


def _code_files(files: list[Path]) -> list[Path]:
    return [file for file in files if file.suffix in (".nbi", ".nbc", ".pyc")]


def _checksums(files: list[Path]) -> dict[str, str]:
    """SHA-256 of each compiled file among these, by its name."""
    return {file.name: hashlib.sha256(file.read_bytes()).hexdigest() for file in _code_files(files)}


def _stamps(files: list[Path]) -> dict[str, tuple[int, int]]:
    stats = {file.name: file.stat() for file in _code_files(files)}
    return {name: (stat.st_mtime_ns, stat.st_size) for name, stat in stats.items()}


def _remove(files: list[Path]) -> None:
    """Delete files, and empty folders that stand in their place; OSError where that cannot be done."""
    for file in files:
        if file.is_dir() and not file.is_symlink():
            try:
                file.rmdir()
            except OSError as error:  # it holds something: not for us to delete
                raise IsADirectoryError(error.errno, os.strerror(error.errno or errno.EISDIR), str(file)) from None
        else:
            file.unlink(missing_ok=True)


def _remove_foreign(path: Path) -> None:
    """Delete what somebody else has put in place of a kernel; OSError where that cannot be done."""
    for file in (path, *_compilation(path)):
        if is_foreign(file):
            file.unlink()


def _compilation(path: Path) -> list[Path]:
    """Files that Python and Numba keep of a kernel's file."""
    compiled, stem = path.parent / "__pycache__", path.stem
    names = os.listdir(compiled) if compiled.is_dir() else ()  # of all kernels: nothing slower than this is asked of each
    return [compiled / name for name in names if name.startswith(stem)]


def _compiled(files: list[Path]) -> bool:
    return any(file.suffix == ".nbi" for file in files)


def _execute(source: str, key: str, path: Path | None) -> types.ModuleType:
    name = f"stickslip_kernel_{key}"
    spec = None if path is None else importlib.util.spec_from_file_location(name, path)
    module = types.ModuleType(name) if spec is None else importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # Numba pickles functions by module name, and classes look for their module there
    try:
        with _numba_as_asked(source), _without_collections():
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


@contextlib.contextmanager
def _without_collections() -> Iterator[None]:
    """Compiling makes a million objects that live until it is done: looking for garbage among them takes up to a fifth of its time."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


def _say(sentence: str) -> None:
    if sentence not in _reported:
        _reported.add(sentence)
        notify(sentence)
