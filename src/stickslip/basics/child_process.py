"""Bytes from anywhere are answered by a process of their own, with limits of memory and time: what crashes there ends only that process.

The process answers one message at a time. One that has ended is replaced when the next message comes.
"""

from __future__ import annotations

import contextlib
import json
import os
import struct
import subprocess
import sys
import threading
import time
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import Any

#: Address space of a process [bytes] beside what a message allows it: its libraries take half a GB.
_LIBRARIES = 1 << 30
#: Time limit for its start [s], imports included, on a busy machine.
_START = 120.0
_ROOT = str(Path(__file__).resolve().parents[2])


class ChildEnded(Exception):
    """The process ended before it had answered; `late` says whether that was at the deadline."""

    def __init__(self, late: bool):
        super().__init__()
        self.late = late


class ChildProcess:
    """A process that runs ``serve`` of a module, and is replaced when it has ended.

    Parameters
    ----------
    module : str
        A module that calls `serve` when it is run.

    Examples
    --------
    >>> child = ChildProcess("stickslip.records.apart_process")
    >>> child.ask({"format": "MATLAB", "largest": ""}, b"no file", seconds=60.0, memory=1e8)[:45]
    b'{"problems": ["the MATLAB file is damaged (Ma'
    >>> child.end()
    """

    def __init__(self, module: str):
        self._module, self._lock, self._closed = module, threading.Lock(), False
        self._running: _Running | None = None

    def start(self) -> None:
        """Start the process now, so that the first message need not wait for imports; `OSError` where the system has none left."""
        with self._lock:
            self._started()

    def ask(self, wish: dict[str, Any], data: bytes, seconds: float, memory: float) -> bytes:
        """The answer to some bytes and what is wished of them.

        Parameters
        ----------
        wish : dict
            What JSON can hold.
        data : bytes
        seconds : float
            Time limit.
        memory : float
            Bytes that the process may take beside those of its libraries, where the system has such a limit.

        Raises
        ------
        ChildEnded
            If the process ended, by itself or at the deadline.
        OSError
            If none could be started.
        """
        with self._lock:
            running = self._started()
            try:
                return running.ask(wish, data, seconds, memory)
            except (ChildEnded, OSError):
                self._running = None
                raise

    def end(self) -> None:
        """End the process for good, also while it answers."""
        self._closed = True
        if self._running is not None:
            self._running.end()

    def _started(self) -> _Running:
        if self._running is None or not self._running.is_alive():
            if self._running is not None:
                self._running.end()
            self._running = _Running(self._module)
        if self._closed:
            self._running.end()
            raise ChildEnded(late=False)
        return self._running


class _Running:
    """One process; it belongs to the process that started it, not to forks of that."""

    def __init__(self, module: str):
        command = [sys.executable or "python", "-P", "-m", module]
        paths = os.pathsep.join([_ROOT, *filter(None, [os.environ.get("PYTHONPATH")])])
        environment = {**os.environ, "PYTHONPATH": paths, "OPENBLAS_NUM_THREADS": "1"}
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
        self._process = subprocess.Popen(command, env=environment, **pipes)  # type: ignore[call-overload]
        self._owner, self._late, self._ready = os.getpid(), False, False
        self.end = weakref.finalize(self, _end, self._process, self._owner)

    def is_alive(self) -> bool:
        return os.getpid() == self._owner and self.end.alive and self._process.poll() is None

    def ask(self, wish: dict[str, Any], data: bytes, seconds: float, memory: float) -> bytes:
        if not self._ready and self._within(_START, self._answered) is None:
            self.end()
            raise OSError(0, "it ended while it started")
        self._ready = True
        head = json.dumps({**wish, "seconds": seconds, "memory": memory}).encode()
        answer = self._within(seconds, lambda: self._answered(head, data))
        if answer is None:
            self.end()
            raise ChildEnded(self._late)
        return answer

    def _answered(self, *parts: bytes) -> bytes | None:
        """The reply to some messages, or the first message of a process."""
        for part in parts:
            _put(self._process.stdin, part)
        return _got(self._process.stdout)

    def _within(self, seconds: float, talk: Callable[[], bytes | None]) -> bytes | None:
        """The result of an exchange; None if the process ended, by itself or because it took too long."""
        timer = threading.Timer(seconds, self._expire)
        timer.start()
        try:
            return talk()
        except (OSError, ValueError):  # the process ended during writing
            return None
        except BaseException:  # Ctrl-C: what it would answer is no longer waited for
            self.end()
            raise
        finally:
            timer.cancel()

    def _expire(self) -> None:
        self._late = True
        self._process.kill()


def _end(process: subprocess.Popen[bytes], owner: int) -> None:
    if os.getpid() == owner:
        process.kill()
        process.wait()
    for pipe in (process.stdin, process.stdout):
        with contextlib.suppress(OSError):
            pipe.close()  # type: ignore[union-attr]


def _put(pipe: Any, data: bytes) -> None:
    pipe.write(struct.pack("<Q", len(data)) + data)
    pipe.flush()


def _got(pipe: Any) -> bytes | None:
    """The next message, or None at the end of the stream."""
    head = pipe.read(8)
    if len(head) < 8:
        return None
    (size,) = struct.unpack("<Q", head)
    data = pipe.read(size)
    return bytes(data) if len(data) == size else None


# ---- in the process ----
def serve(answer: Callable[[dict[str, Any], bytes], bytes], prepare: Callable[[], object] = lambda: None, writes: bool = False) -> None:
    """Run the process: it answers messages from its input until that ends.

    Parameters
    ----------
    answer : callable
        The answer to a wish and its bytes. What it raises ends the process.
    prepare : callable
        What is done once, before there are limits.
    writes : bool
        Whether it may write files, as what is compiled is kept.
    """
    asked, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    with open(os.devnull, "r+b") as nothing:  # libraries must not read our input or write into our answers
        os.dup2(nothing.fileno(), 0)
        os.dup2(nothing.fileno(), 1)
    prepare()
    if not writes:
        _limit("RLIMIT_FSIZE", 0)
    _limit("RLIMIT_CORE", 0)
    _put(answers, b"ready")
    while (head := _got(asked)) is not None and (data := _got(asked)) is not None:
        wish = json.loads(head)
        _limit("RLIMIT_AS", _LIBRARIES + int(wish["memory"]))
        _limit("RLIMIT_CPU", int(time.process_time() + wish["seconds"]) + 2)  # in case the parent cannot end this process
        _put(answers, answer(wish, data))


def _limit(kind: str, most: int) -> None:
    """A limit of the system, where it has one."""
    with contextlib.suppress(ImportError, AttributeError, OSError, ValueError):
        import resource

        resource.setrlimit(getattr(resource, kind), (most, resource.getrlimit(getattr(resource, kind))[1]))
