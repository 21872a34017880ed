"""Distinguishes our own exceptions from those raised by the code that a command was asked to run."""

from __future__ import annotations

import sysconfig
import traceback
from pathlib import Path


def in_your_code(error: BaseException) -> str | None:
    """Location and kind of an error in the user's own code, as a sentence; None if the error is ours.

    The innermost frame outside this package, Python and its libraries decides. A name that a module of this package lacks is an error
    of the code that asks for it.

    Parameters
    ----------
    error : exception
        With its traceback.

    Examples
    --------
    >>> in_your_code(KeyError("nobody raised this")) is None
    True
    """
    how = f"{type(error).__name__}: {error}"
    if isinstance(error, SyntaxError) and error.filename and _is_yours(error.filename):
        return _sentence(error.filename, error.lineno, f": {type(error).__name__}: {error.msg}")
    for frame in reversed(_frames(error)):
        if _within(frame.filename, _OURS):
            return None
        if _is_yours(frame.filename):
            return _sentence(frame.filename, frame.lineno, f", in {frame.name}: {how}")
    return None


def _frames(error: BaseException) -> list[traceback.FrameSummary]:
    """The frames of an error, without those in which a module looks for a name that it lacks."""
    frames = list(traceback.extract_tb(error.__traceback__))
    while isinstance(error, AttributeError) and frames and frames[-1].name == "__getattr__":
        frames.pop()
    return frames


def in_our_code(error: BaseException) -> str:
    """File and line of an error in this package: of the innermost frame there, or of what Python cannot read."""
    if isinstance(error, SyntaxError) and error.filename:
        return f"{error.filename}, line {error.lineno}"
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if _within(frame.filename, _OURS)]
    return f"{frames[-1].filename}, line {frames[-1].lineno}" if frames else "this package"


def _sentence(file: str, line: int | None, what: str) -> str:
    return f"your code: {file}, line {line}{what}; correct it there, or set STICKSLIP_TRACEBACK=1 to see how it was called"


_OURS = (str(Path(__file__).resolve().parents[2]),)


def _is_yours(file: str) -> bool:
    """Whether a file belongs neither to this package nor to Python or an installed library."""
    paths = sysconfig.get_paths()
    libraries = tuple(paths[name] for name in ("stdlib", "platstdlib", "purelib", "platlib"))
    return not file.startswith("<") and not _within(file, (*_OURS, *libraries))


def _within(file: str, folders: tuple[str, ...]) -> bool:
    path = Path(file).resolve()
    return any(path.is_relative_to(Path(folder).resolve()) for folder in folders)
