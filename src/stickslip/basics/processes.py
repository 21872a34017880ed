"""Processes of this computer as an executor: each alone in a pool, so that one that is killed costs what it was computing, and no more."""

from __future__ import annotations

import multiprocessing
import threading
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor
from functools import partial
from typing import Any

from stickslip.basics.errors import StickslipError

_WHY = "killed, perhaps for its memory; or the script has no `if __name__ == '__main__':` before its calls, which new processes need"


class WorkerLost(StickslipError):
    """The process that computed a chunk is gone."""


class Processes:
    """An executor of processes, which are begun when they are needed, and one by one begun anew.

    A call goes to the process that has the fewest. The pool of `concurrent.futures` ends all of its processes when one is killed.

    Parameters
    ----------
    count : int

    Examples
    --------
    >>> Processes(2).shutdown()  # nothing was begun
    """

    def __init__(self, count: int):
        self._pools: list[ProcessPoolExecutor | None] = [None] * count
        self._calls = [0] * count
        self._lock = threading.RLock()

    def submit(self, function: Callable[..., Any], /, *args: Any) -> Future[Any]:
        """Begin a call, and return its future; it raises `WorkerLost` if its process is killed."""
        with self._lock:
            k = self._calls.index(min(self._calls))
            pool = self._pools[k] or self._renewed(k)
            try:
                inner = pool.submit(function, *args)
            except BrokenExecutor:  # killed since its last call
                pool = self._renewed(k)
                inner = pool.submit(function, *args)
            self._calls[k] += 1
        outer = _Call(inner)
        inner.add_done_callback(partial(self._ended, k, pool, outer))
        return outer

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes."""
        for pool in filter(None, self._pools):
            pool.shutdown(wait=wait, cancel_futures=cancel_futures)

    def _renewed(self, k: int) -> ProcessPoolExecutor:
        # "spawn": a fork after threads of OpenMP hangs
        self._pools[k] = made = ProcessPoolExecutor(1, multiprocessing.get_context("spawn"))
        return made

    def _ended(self, k: int, pool: ProcessPoolExecutor, outer: _Call, inner: Future[Any]) -> None:
        error = None if inner.cancelled() else inner.exception()
        with self._lock:
            self._calls[k] -= 1
            if isinstance(error, BrokenExecutor) and self._pools[k] is pool:
                self._pools[k] = None
                pool.shutdown(wait=False)
        outer.follow(inner, WorkerLost(f"its process is gone ({_WHY})") if isinstance(error, BrokenExecutor) else error)


class _Call(Future[Any]):
    """The future of a call, which another one stands for."""

    def __init__(self, inner: Future[Any]):
        super().__init__()
        self._inner: Future[Any] | None = inner

    def cancel(self) -> bool:
        """Drop it if it has not begun."""
        return self._inner is not None and self._inner.cancel()

    def follow(self, inner: Future[Any], error: BaseException | None) -> None:
        """End as the other one did, and let go of it: two that hold one another would keep their results until Python looks for such."""
        self._inner = None
        if inner.cancelled():
            super().cancel()
            self.set_running_or_notify_cancel()
        elif error is not None:
            self.set_exception(error)
        else:
            self.set_result(inner.result())
