"""Processes of this computer as an executor: one that is killed costs what it was computing, and no more.

The pool of `concurrent.futures` ends all of its processes when one is killed, and waits for ever for one that is killed while it sends a
result. Here each process has a pipe of its own, of which the other end is closed with it.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import queue
import signal
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Future
from multiprocessing.connection import Connection
from typing import Any

from stickslip.basics.errors import StickslipError

_PATIENCE = 5.0  # how long a process is waited for that was asked to end [s]
_WHY = "killed, perhaps for its memory; or the script has no `if __name__ == '__main__':` before its calls, which new processes need"


#: Processes are copies of one that has no threads and has loaded what they need, where the system makes such: they begin at little cost.
_COPIED = "forkserver" in multiprocessing.get_all_start_methods()
_LOADED = frozenset({"stickslip", "llvmlite"})  # packages of which it loads what this process has loaded


class WorkerLost(StickslipError):
    """The process that computed a chunk is gone."""


class Processes:
    """An executor of processes, which are begun when they are needed, and one by one begun anew.

    Parameters
    ----------
    count : int

    Examples
    --------
    >>> Processes(2).shutdown()  # nothing was begun
    """

    def __init__(self, count: int):
        self._count = count
        self._calls: queue.SimpleQueue[tuple[Future[Any], Any] | None] = queue.SimpleQueue()
        self._threads: list[threading.Thread] = []

    def submit(self, function: Callable[..., Any], /, *args: Any) -> Future[Any]:
        """Begin a call, and return its future; it raises `WorkerLost` if its process is killed."""
        future = Future[Any]()
        self._calls.put((future, (function, args)))
        if len(self._threads) < self._count:
            self._threads.append(threading.Thread(target=self._hand_over, daemon=True))
            self._threads[-1].start()
        return future

    def shutdown(self, wait: bool = True) -> None:
        """End the processes, after the calls that were begun."""
        for _ in self._threads:
            self._calls.put(None)
        for thread in self._threads if wait else ():
            thread.join()

    def _hand_over(self) -> None:
        """Hand calls to one process, in a thread that waits for it."""
        process = None
        while (call := self._calls.get()) is not None:
            future, asked = call
            if future.set_running_or_notify_cancel():
                process = process or _Process()
                if not process.answers(future, asked):
                    process.end()
                    process = None
            del call, future, asked  # a result is not kept until the next call
        if process is not None:
            process.end()


class _Process:
    """A process, and the pipe to it."""

    _beginning = threading.Lock()

    def __init__(self) -> None:
        new: Any = multiprocessing.get_context("forkserver" if _COPIED else "spawn")  # a fork of this process, which has threads, hangs
        self._pipe, theirs = new.Pipe()
        self._process = new.Process(target=_serve, args=(theirs, dict(os.environ)), daemon=True)
        with self._beginning:
            if _COPIED:
                new.set_forkserver_preload([name for name in [*sys.modules] if name.partition(".")[0] in _LOADED])
            self._process.start()
        theirs.close()

    def answers(self, future: Future[Any], asked: Any) -> bool:
        """Let a call be computed and give its future what comes of it; False if the process is gone."""
        try:
            self._pipe.send(asked)
            is_done, value = self._pipe.recv()
        except (EOFError, OSError):  # closed, also in the middle of a result
            future.set_exception(WorkerLost(f"its process is gone ({_WHY})"))
            return False
        except Exception as error:  # what cannot be sent, or does not come back
            future.set_exception(error)
            return True
        if is_done:
            future.set_result(value)
        else:
            future.set_exception(value)
        return True

    def end(self) -> None:
        """Let it end, and wait for it."""
        self._pipe.close()
        self._process.join(_PATIENCE)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()


def _serve(pipe: Connection, environment: dict[str, str]) -> None:
    """Compute calls until the pipe is closed; Ctrl-C of a terminal is the caller's, and so is the environment."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ.clear()
    os.environ.update(environment)
    with contextlib.suppress(EOFError, OSError):
        while True:
            try:
                asked = pipe.recv()
            except (EOFError, OSError):
                return
            except Exception as error:  # such as a module that is not here
                pipe.send((False, _sendable(error)))
                continue
            answer = _answer(*asked)
            try:
                pipe.send(answer)
            except (EOFError, OSError):
                return
            except Exception as error:  # a result that cannot be sent
                pipe.send((False, _sendable(error)))


def _answer(function: Callable[..., Any], args: tuple[Any, ...]) -> tuple[bool, Any]:
    """Whether a call was computed, and what came of it."""
    try:
        return True, function(*args)
    except Exception as error:  # goes on in the caller
        return False, _sendable(error)


def _sendable(error: Exception) -> StickslipError:
    """An error in words, which any process can read."""
    return StickslipError(f"{type(error).__name__}: {error}")
