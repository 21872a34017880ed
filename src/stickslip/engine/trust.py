"""Folders that may hold compiled kernels: kernels are executed, so nobody else may be able to write there."""

from __future__ import annotations

import atexit
import functools
import os
import shutil
import stat
import tempfile
from pathlib import Path

#: Set to 1, this environment variable says that a cache folder of other users is meant.
SHARED = "STICKSLIP_CACHE_SHARED"
_ROOT = 0


def unsafe(kernels: Path) -> str | None:
    """Why kernels in this folder must not be run, or None.

    A folder that everybody may write, or that belongs to a user who is neither oneself nor root, is not
    safe. Nor is one below a folder where everybody may rename it, unless that one is sticky, as /tmp is. The group may write: with
    umask 002 it always may. Windows has no such bits, and keeps the user's cache folder to the user by itself.
    """
    if _unchecked():
        return None
    if (status := _status(kernels)) is not None:
        if status.st_uid not in (os.geteuid(), _ROOT):
            return f"belongs to another user ({_user(status.st_uid)})"
        if status.st_mode & stat.S_IWOTH:
            return "may be written by every user"
    for above in Path(os.path.realpath(kernels)).parents:
        status = _status(above)
        if status is not None and status.st_mode & stat.S_IWOTH and not status.st_mode & stat.S_ISVTX:
            return f"lies in {above}, which every user may write"
    return None


def is_foreign(path: Path) -> bool:
    """Whether a file was put there by somebody else, such as at a time when its folder was not safe."""
    status = None if _unchecked() else _status(path, follow=False)
    return status is not None and (status.st_uid not in (os.geteuid(), _ROOT) or stat.S_ISLNK(status.st_mode))


def make_folder(path: Path) -> None:
    """Make a folder, and those above it, that not everybody may write, whatever the umask."""
    for folder in (*reversed(path.parents), path):
        if not folder.exists():
            folder.mkdir(mode=0o775, exist_ok=True)


@functools.cache
def private_folder() -> Path:
    """A folder of one's own below the system's temporary folder: the same one every time where that is safe, else a new one."""
    if os.name == "nt":  # the temporary folder is the user's own
        return Path(tempfile.gettempdir()) / "stickslip"
    path = Path(tempfile.gettempdir()) / f"stickslip-{os.geteuid()}"
    try:
        path.mkdir(mode=0o700, exist_ok=True)
        status = path.lstat()
        if stat.S_ISDIR(status.st_mode) and status.st_uid == os.geteuid() and not status.st_mode & 0o077 and unsafe(path) is None:
            return path
    except OSError:
        pass
    path = Path(tempfile.mkdtemp(prefix="stickslip-"))
    atexit.register(shutil.rmtree, path, ignore_errors=True)
    return path


def _unchecked() -> bool:
    return os.name == "nt" or os.environ.get(SHARED, "") not in ("", "0")


def _status(path: Path, follow: bool = True) -> os.stat_result | None:
    try:
        return path.stat() if follow else path.lstat()
    except OSError:
        return None


def _user(number: int) -> str:
    try:
        import pwd

        return pwd.getpwuid(number).pw_name
    except (ImportError, KeyError):
        return f"number {number}"
