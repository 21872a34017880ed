"""The only door for writing: a file is written beside its place and moved there when it is whole.

Whatever happens meanwhile, the file that stood there before is intact, nothing is left beside it, and the error is a sentence.
"""

from __future__ import annotations

import contextlib
import errno
import io
import os
import secrets
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, BinaryIO, cast

from stickslip.basics.errors import InputError

#: Ends the name of a file that is being written; only a process that was killed leaves one behind.
PART = ".part"
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)

Failed = Callable[[Path, OSError], Exception]


@contextlib.contextmanager
def moved_into_place(path: Path, failed: Failed, new: bool = False, ending: str | None = None) -> Iterator[Path]:
    """A path beside `path` to write to, which takes its place if all went well.

    Parameters
    ----------
    path : Path
        A link is followed; a folder, a device and a file without permission to write are refused.
    failed : callable
        Makes the exception from `path` and an `OSError`.
    new : bool
        Leave a file that stands at `path` alone, with `FileExistsError`.
    ending : str, optional
        End of the temporary name; by default that of `path`.
    """
    target = Path(os.path.realpath(path)) if path.is_symlink() else path
    part = target.with_name(f".{target.name}.{secrets.token_hex(6)}{target.suffix if ending is None else ending}")
    try:
        _check_target(path, target)
        os.close(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o664))  # not for everybody to change, whatever the umask
        yield part
        _move(part, target, new)
    except FileExistsError as error:
        raise error if new else failed(path, error) from None
    except OSError as error:
        raise failed(path, error) from None
    finally:
        with contextlib.suppress(OSError):
            part.unlink()


@contextlib.contextmanager
def whole_file(path: Path, failed: Failed, new: bool = False) -> Iterator[BinaryIO]:
    """An open file that takes the place of `path` when it is closed, if all went well; see `moved_into_place`.

    Examples
    --------
    >>> with whole_file(Path("numbers.txt"), unwritable("save")) as file:
    ...     _ = file.write(b"1 2 3")
    >>> Path("numbers.txt").read_text()
    '1 2 3'
    """
    with moved_into_place(path, failed, new, PART) as part:
        file = part.open("w+b")
        try:
            yield cast(BinaryIO, file)
            file.flush()
            os.fsync(file.fileno())
        finally:
            with contextlib.suppress(OSError):  # what has failed fails again when its buffer is flushed
                file.close()


@contextlib.contextmanager
def whole_folder(path: Path, failed: Failed) -> Iterator[Path]:
    """A new folder beside `path` to fill, which takes its place if all went well; a folder that stands there is removed then.

    Between the two steps of the exchange neither is there; whoever interrupts it finds the old one beside its place.
    """
    token = secrets.token_hex(6)
    part, old = (path.with_name(f".{path.name}.{token}{ending}") for ending in (PART, ".old"))
    try:
        if path.exists() and not path.is_dir():
            raise NotADirectoryError(errno.ENOTDIR, "it is a file")
        part.mkdir()
        yield part
        if path.exists():
            os.replace(path, old)
        os.replace(part, path)
    except OSError as error:
        raise failed(path, error) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)
        if path.exists():
            shutil.rmtree(old, ignore_errors=True)


def write_whole(path: Path, content: str | bytes, failed: Failed) -> Path:
    """Write text (UTF-8) or bytes to a file; returns its path."""
    with whole_file(path, failed) as file:
        file.write(content.encode("utf-8") if isinstance(content, str) else content)
    return path


def unwritable(doing: str) -> Callable[[Path, OSError], InputError]:
    """The message, with a suggestion, for a file that cannot be written."""

    def failed(path: Path, error: OSError) -> InputError:
        why = (error.strerror or str(error)) if path.parent.exists() else "that folder does not exist; make it first"
        advice = (
            "free some space, or give a path on another disk"
            if error.errno in _NO_ROOM
            else "give a path in a folder that you may write to"
        )
        return InputError(doing, [f"cannot write {str(path)!r}: {why}; {advice}"])

    return failed


def _check_target(path: Path, target: Path) -> None:
    """Raise an `OSError` for what must not be replaced by a file."""
    if not path.name or target.is_dir():
        raise IsADirectoryError(errno.EISDIR, "it is a folder")
    if target.exists() and not target.is_file():
        raise OSError(errno.EINVAL, "it is a device or a pipe")
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, "it is there already and must not be changed")


def _move(part: Path, target: Path, new: bool) -> None:
    """Move a whole file to its place, with the permissions of the one that stood there."""
    if new:
        try:
            os.link(part, target)
            return
        except FileExistsError:
            raise
        except OSError:  # a file system without hard links
            if target.exists():
                raise FileExistsError(errno.EEXIST, "it is there already") from None
    elif target.exists():
        with contextlib.suppress(OSError):
            os.chmod(part, target.stat().st_mode & 0o777)
    os.replace(part, target)


_PAGE = 1 << 16  # bytes that are kept together


class Deferred(io.RawIOBase):
    """A binary file whose first failed write is kept for later, for a library that cannot end well after one, such as HDF5.

    After a failure nothing more is written to the disk: what the library writes then is kept in memory, so that it reads what it wrote.
    `check` raises the error.
    """

    def __init__(self, file: BinaryIO):
        super().__init__()
        self._raw = getattr(file, "raw", file)  # without a buffer a write succeeds or fails when it is made
        self._error: OSError | None = None
        self._position = self._size = 0
        self._pages: dict[int, bytearray] = {}  # of what is not on the disk

    def check(self) -> None:
        """Raise the first error, if there was one."""
        if self._error is not None:
            raise self._error

    def readable(self) -> bool:
        """Yes."""
        return True

    def writable(self) -> bool:
        """Yes."""
        return True

    def seekable(self) -> bool:
        """Yes."""
        return True

    def readinto(self, buffer: Any) -> int:
        """Read bytes into a buffer."""
        view = memoryview(buffer).cast("B")
        count = max(0, min(len(view), self._size - self._position))
        view[:count] = self._on_disk(self._position, count)
        for page, within, part in _pages_of(self._position, count):
            if page in self._pages:
                view[part] = self._pages[page][within]
        self._position += count
        return count

    def write(self, data: Any) -> int:
        """Write bytes."""
        view = memoryview(data).cast("B")
        if self._error is None:
            try:
                self._raw.seek(self._position)
                done = 0
                while done < len(view):
                    done += self._raw.write(view[done:]) or 0
            except OSError as error:
                self._error = error
        if self._error is not None:
            for page, within, part in _pages_of(self._position, len(view)):
                if page not in self._pages:
                    self._pages[page] = bytearray(self._on_disk(page * _PAGE, _PAGE))
                self._pages[page][within] = view[part]
        self._position += len(view)
        self._size = max(self._size, self._position)
        return len(view)

    def seek(self, offset: int, whence: int = 0) -> int:
        """Go to a place."""
        self._position = offset + (0, self._position, self._size)[whence]
        return self._position

    def tell(self) -> int:
        """The place."""
        return self._position

    def truncate(self, size: int | None = None) -> int:
        """Set the length."""
        self._size = self._position if size is None else size
        if self._error is None:
            try:
                self._raw.truncate(self._size)
            except OSError as error:
                self._error = error
        return self._size

    def _on_disk(self, offset: int, count: int) -> bytes:
        """Bytes of the file on the disk, with zeros for what it does not have."""
        data = b""
        with contextlib.suppress(OSError):
            self._raw.seek(offset)
            while len(data) < count and (more := self._raw.read(count - len(data))):
                data += more
        return data.ljust(count, b"\0")


def _pages_of(offset: int, count: int) -> Iterator[tuple[int, slice, slice]]:
    """The pages that some bytes lie on: the number of each, the part of the page, and the part of the bytes."""
    done = 0
    while done < count:
        page, first = divmod(offset + done, _PAGE)
        size = min(_PAGE - first, count - done)
        yield page, slice(first, first + size), slice(done, done + size)
        done += size


@contextlib.contextmanager
def for_hdf5(file: BinaryIO) -> Iterator[Deferred]:
    """A file to which HDF5 writes: a failed write ends the block with its `OSError`, without messages of the library."""
    deferred = Deferred(file)
    try:
        yield deferred
    except Exception:
        deferred.check()  # what the library says after a failed write follows from it
        raise
    deferred.check()
