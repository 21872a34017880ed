"""Progress of a sweep, for a callback that can also stop it."""

from __future__ import annotations

import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stickslip.basics.interruption import PROGRESS, is_stopped, look, stop_call, takes_some_cases
from stickslip.basics.progress import progress_callback
from stickslip.basics.status import STATUS, code_counts

PAUSE = 0.1  # shortest time between two reports [s]


@dataclass(frozen=True)
class Progress:
    """Progress of a computation.

    Parameters
    ----------
    done : float
        Finished cases, plus those started in the running tiles.
    cases : int
        Total number of cases.
    statuses : dict
        Finished cases by the sentence of their status.
    seconds : float
        Time since the sweep began [s].
    resumed : int
        Cases from an earlier run.

    Examples
    --------
    >>> now = Progress(done=250, cases=1000, seconds=5.0)
    >>> now.rate, now.left, now.line()
    (50.0, 15.0, '25 %, 250 of 1000 cases, 50 per second, 15 s left')
    """

    done: float
    cases: int
    statuses: dict[str, int] = field(default_factory=dict)
    seconds: float = 0.0
    resumed: int = 0

    @property
    def rate(self) -> float:
        """Cases per second."""
        return (self.done - self.resumed) / self.seconds if self.seconds > 0 else 0.0

    @property
    def left(self) -> float:
        """Time left [s]."""
        return (self.cases - self.done) / self.rate if self.rate > 0 else np.inf

    def line(self) -> str:
        """A summary in one line."""
        share = int(100 * self.done / self.cases) if self.cases else 100
        parts = [f"{share} %, {int(self.done)} of {self.cases} cases"]
        if self.rate > 0:
            parts += [f"{self.rate:.3g} per second", f"{_duration(self.left)} left"]
        unusual = {text: n for text, n in self.statuses.items() if text not in (STATUS[0], STATUS[1])}
        return ", ".join(parts + [f"{n} {text}" for text, n in unusual.items()])


def _duration(seconds: float) -> str:
    if not np.isfinite(seconds):
        return "?"
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


class Watch:
    """Collects the progress of tiles and threads for the callback, at most ten times a second and at the end; False ends the call."""

    def __init__(self, cases: int, callback: Callable[[Progress], Any] | bool | None):
        self.cases, self.callback = cases, progress_callback(callback, "progress")
        self._begun: dict[int, int] = {}
        self._statuses = Counter[str]()
        self._finished, self._resumed, self._began, self._reported = 0, 0, time.monotonic(), 0.0
        self._lock = threading.Lock()

    def __reduce__(self) -> tuple[Any, ...]:
        # In another process nobody watches.
        return type(self), (self.cases, None)

    def resumed(self, cases: int) -> None:
        """Count cases from an earlier run."""
        self._finished = self._resumed = cases

    def begun(self, tile: int, cases: int) -> None:
        """Count the cases of a tile that have been started."""
        self._begun[tile] = cases
        self._tell(PAUSE)

    def at_work(self, tile: int, cases: int) -> None:
        """As `begun`, called during the work; raises `Interrupted` if the call is to end."""
        self.begun(tile, cases)
        if not takes_some_cases():
            look()

    def finished(self, tile: int, status: Any) -> None:
        """Count a finished tile."""
        self._begun.pop(tile, None)
        self._finished += len(status)
        self._statuses.update(code_counts(status))
        self._tell(PAUSE if self._finished < self.cases else 0.0)

    def now(self) -> Progress:
        """The present progress."""
        done = self._finished + sum(list(self._begun.values()))
        return Progress(min(done, self.cases), self.cases, dict(self._statuses), time.monotonic() - self._began, self._resumed)

    def _tell(self, pause: float) -> None:
        if self.callback is None or is_stopped():
            return
        with self._lock:
            if time.monotonic() - self._reported < pause:
                return
            self._reported = time.monotonic()
            if self.callback(self.now()) is False and self._finished < self.cases:
                stop_call(PROGRESS)
