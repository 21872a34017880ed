"""The `progress` argument: a function, or True for a line on the terminal or in the notebook."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from typing import Any

from stickslip.basics.errors import InputError
from stickslip.basics.interruption import PROGRESS, stop_call

#: A progress callback, called with (what, done, total) or (done, total); returning False stops the work.
Reported = Callable[..., Any]

PAUSE = 5.0  # before the first line in a log [s]; the intervals between later lines grow
EACH = 0.05  # between two lines in place [s]
WIDTH = 24  # of the bar, in characters


def progress_callback(progress: Any, what: str) -> Callable[..., Any] | None:
    """The progress callback: the given function, a line on stderr for True, None for None and False.

    Parameters
    ----------
    progress : callable, bool or None
    what : str
        Name of the caller, for the error message.

    Returns
    -------
    callable or None

    Raises
    ------
    InputError
        For any other value.

    Examples
    --------
    >>> progress_callback(print, "solve") is print, progress_callback(False, "solve")
    (True, None)
    """
    if progress is None or progress is False:
        return None
    if progress is True:
        return ProgressLine()
    if callable(progress):
        return progress
    allowed = "a function that is called as the work goes on, True for a line on the terminal, or None"
    raise InputError(what, [f"progress = {progress!r}; allowed is {allowed}; type progress=True"])


def reporting(progress: Any, what: str) -> Reported:
    """A function that is called with the latest item, the number done and the total, and passes them to the progress callback if any.

    If that returns False before all is done, the call that runs is to end (see `stickslip.basics.interruption`).

    Examples
    --------
    >>> reporting(None, "continuation")("amplitude = 4e-4", 3, 400)
    >>> reporting(lambda *state: print(state), "continuation")("amplitude = 4e-4", 3, 400)
    ('amplitude = 4e-4', 3, 400)
    """
    call = progress_callback(progress, what)

    def report(*state: Any) -> None:
        if call is not None and call(*state) is False and state[-2] < state[-1]:
            stop_call(PROGRESS)

    return report


def _is_watched(out: Any) -> bool:
    """Whether a line can be overwritten: on a terminal, and below a notebook cell, which is not a terminal."""
    return (bool(out.isatty()) and os.environ.get("TERM") != "dumb") or type(out).__module__.startswith("ipykernel.")


class ProgressLine:
    """Progress in one line: a bar that is updated in place on a terminal and in a notebook; in a log, a line from time to time.

    Parameters
    ----------
    of : str
        Name of the counted items, for calls with numbers only.
    out : file, optional
        Output file; stderr by default.
    """

    def __init__(self, of: str = "", out: Any = None):
        self.of, self.out, self._last, self._began, self._next = of, out or sys.stderr, 0, time.monotonic(), PAUSE
        self._shown: tuple[str | None, float] = (None, 0.0)  # the item, and when

    def __call__(self, *state: Any) -> None:
        """Show the progress given as one object with a ``line()``, as (done, total), or as (what, done, total)."""
        *names, done, whole = state if len(state) > 1 else (state[0].done, state[0].cases)
        of = ": ".join(map(str, names)) or self.of
        text = state[0].line() if len(state) == 1 else f"{of + ', ' if of else ''}{done} of {whole}"
        seconds = time.monotonic() - self._began
        if _is_watched(self.out):
            if done < whole and of == self._shown[0] and seconds < self._shown[1] + EACH:
                return
            self._shown = of, seconds
            full = int(WIDTH * done / max(whole, 1))
            text = f"[{'#' * full}{'.' * (WIDTH - full)}] {text}"
            print(f"\r{text:<{self._last}}", end="\n" if done >= whole else "", file=self.out, flush=True)
            self._last = 0 if done >= whole else len(text)
        elif seconds >= self._next:
            self._next = max(self._next + 1.0, 1.5 * seconds)
            print(text, file=self.out, flush=True)
