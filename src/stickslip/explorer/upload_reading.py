"""Uploaded records are read in a separate process with a time limit and a memory limit; a failure ends that process alone.

One is ready before the first file comes, so that a file need not wait for imports; one that ended is replaced at once.
"""

from __future__ import annotations

import contextlib
import json
import os
import queue
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

from stickslip.errors import InputError
from stickslip.explorer.frames import written
from stickslip.explorer.kernels import killed
from stickslip.explorer.responses import sentence

#: Address space of a process that reads [bytes]: its libraries take half a GB of it.
_MEMORY = 4 << 30
#: Time in which it starts [s], imports included, on a machine that is busy.
_START = 120.0


def _problem(*sentences: str) -> bytes:
    return written({"kind": "problems", "problems": sentences})


class Readers:
    """Processes that read records, each one at a time.

    Parameters
    ----------
    seconds : float
        Time for one record.
    count : int
        Most records at once.
    """

    def __init__(self, seconds: float, count: int = 2):
        self._seconds, self._free = seconds, threading.BoundedSemaphore(count)
        self._ready: queue.SimpleQueue[_Reader] = queue.SimpleQueue()
        self._all: set[_Reader] = set()
        self._ended = False
        self._add()

    def read(self, what: str, name: str, data: bytes) -> bytes:
        """The answer to a file; blocks until it is there, no longer than the deadline.

        Parameters
        ----------
        what : {"velocity", "drive"}
        name : str
            Of the file.
        data : bytes
        """
        with self._free:
            try:
                reader = self._taken()
            except OSError as error:
                return _problem(f"no process could be started to read the record: {error.strerror}")
            answer = reader.ask(what, name, data, self._seconds)
            if answer is None:
                why = self._drop(reader)
                self._add()
                return _problem(why)
            self._ready.put(reader)
            return answer

    def end(self) -> None:
        """End the processes."""
        self._ended = True
        for reader in [*self._all]:
            reader.end()

    def _taken(self) -> _Reader:
        """A process that is ready; where none is, one that soon will be."""
        with contextlib.suppress(queue.Empty):
            while True:
                reader = self._ready.get_nowait()
                if reader.is_alive():
                    return reader
                self._drop(reader)
        self._all.add(reader := _Reader())
        return reader

    def _add(self) -> None:
        """One more that will be ready; where there is none to be had, a file will say so."""
        if not self._ended:
            with contextlib.suppress(OSError):
                self._all.add(reader := _Reader())
                self._ready.put(reader)

    def _drop(self, reader: _Reader) -> str:
        self._all.discard(reader)
        return reader.end()


class _Reader:
    """One process."""

    def __init__(self) -> None:
        command = [sys.executable, "-P", "-m", "stickslip.explorer.upload_reading"]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        self._late = self._started = False

    def is_alive(self) -> bool:
        return self._process.poll() is None

    def ask(self, what: str, name: str, data: bytes, seconds: float) -> bytes | None:
        """Its answer, or None where it ended, by itself or by the deadline."""
        if not self._started and self._within(_START, self._sent) is None:
            return None
        self._started = True
        return self._within(seconds, lambda: self._sent(json.dumps({"what": what, "name": name, "seconds": seconds}).encode(), data))

    def _sent(self, *parts: bytes) -> bytes | None:
        """The answer to some messages, or the first word of a process."""
        for part in parts:
            _put(self._process.stdin, part)
        return _got(self._process.stdout)

    def _within(self, seconds: float, talk: Callable[[], bytes | None]) -> bytes | None:
        """The answer of the process; None if it ended, by itself or after its deadline."""
        timer = threading.Timer(seconds, self._expire)
        timer.start()
        try:
            return talk()
        except (OSError, ValueError):  # it ended while it was written to
            return None
        finally:
            timer.cancel()

    def _expire(self) -> None:
        self._late = True
        self._process.kill()

    def end(self) -> str:
        """End it; returns a sentence on why it had ended before, for whoever waits for an answer."""
        killed(self._process)
        if self._late:
            return "the record was not read in time; cut it, or read it with stickslip.read, which has no deadline"
        return "the process that read the record crashed: the file is damaged or malicious; export it again"


def _put(pipe: Any, data: bytes) -> None:
    pipe.write(struct.pack("<Q", len(data)) + data)
    pipe.flush()


def _got(pipe: Any) -> bytes | None:
    """The message received, or None if there are no more."""
    head = pipe.read(8)
    if len(head) < 8:
        return None
    (size,) = struct.unpack("<Q", head)
    data = pipe.read(size)
    return bytes(data) if len(data) == size else None


# ---- in the process ----
def main() -> None:
    """The process: reads records from its input and answers each."""
    asked, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    with open(os.devnull, "r+b") as nothing:  # nobody else reads our input or writes into our answers
        os.dup2(nothing.fileno(), 0)
        os.dup2(nothing.fileno(), 1)
    _prepare()
    _limit_memory()
    _put(answers, b"ready")
    while (head := _got(asked)) is not None and (data := _got(asked)) is not None:
        wish = json.loads(head)
        _limit_time(wish["seconds"])
        _put(answers, _answer(wish["what"], wish["name"], data))


def _answer(what: str, name: str, data: bytes) -> bytes:
    from stickslip.explorer.dropped_records import drive_of, velocity_of

    try:
        return {"velocity": velocity_of, "drive": drive_of}[what](name, data)
    except InputError as error:
        problems = [sentence(p) for p in error.problems]
    except MemoryError:
        problems = ["the record needs more memory than is allowed here; cut it, or read it with stickslip.read"]
    except Exception as error:  # an error of ours: said, and the page lives on
        problems = [f"{type(error).__name__}: {error}. This is an error of stickslip itself"]
    return _problem(*problems)


def _prepare() -> None:
    """Load what formats need, before a file waits for it."""
    from stickslip.explorer.dropped_records import drive_of

    for module in ("h5py", "scipy.io", "scipy.signal", "openpyxl", "nptdms"):
        with contextlib.suppress(ImportError):
            __import__(module)
    with contextlib.suppress(InputError):
        drive_of("ready.csv", b"t [ms],drive [m/s]\n0,0\n1,1\n2,0\n3,-1\n4,0\n5,1\n6,0\n7,-1\n")


def _limit_memory() -> None:
    """Bounds of memory and of files, where the system has them."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        for kind, most in ((resource.RLIMIT_FSIZE, 0), (resource.RLIMIT_CORE, 0), (resource.RLIMIT_AS, _MEMORY)):
            with contextlib.suppress(OSError, ValueError):
                resource.setrlimit(kind, (most, most))


def _limit_time(seconds: float) -> None:
    """End this process if whoever asked cannot."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        most = resource.getrlimit(resource.RLIMIT_CPU)[1]
        resource.setrlimit(resource.RLIMIT_CPU, (int(time.process_time() + seconds) + 2, most))


if __name__ == "__main__":
    main()
