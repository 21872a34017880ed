"""Uploaded records are read in a separate process with a time limit and a memory limit; a failure ends only that process.

One process is ready before the first file arrives, so that a file need not wait for imports; one that ended is replaced immediately.
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
from collections.abc import Callable
from typing import Any

from stickslip.basics.errors import InputError
from stickslip.show.explorer.frames import encoded
from stickslip.show.explorer.kernels import killed
from stickslip.show.explorer.responses import without_python

#: Address space of a reading process [bytes]: its libraries take half a GB of it.
_MEMORY = 4 << 30
#: Time limit for its start [s], imports included, on a busy machine.
_START = 120.0


def _problem(*sentences: str) -> bytes:
    return encoded({"kind": "problems", "problems": sentences})


class Reader:
    """A process that reads one record at a time, and is replaced when it has ended.

    Parameters
    ----------
    seconds : float
        Time limit for one record.
    """

    def __init__(self, seconds: float):
        self._seconds, self._lock, self._ended = seconds, threading.Lock(), False
        self._process: _Process | None = None
        with contextlib.suppress(OSError):  # the next file tries again, and reports it
            self._start()

    def read(self, what: str, name: str, data: bytes) -> bytes:
        """The response to a file; blocks until it is available or the deadline has passed.

        Parameters
        ----------
        what : {"velocity", "drive"}
        name : str
            Name of the file.
        data : bytes
        """
        with self._lock:
            try:
                process = self._process if self._process is not None and self._process.is_alive() else self._start()
            except OSError as error:
                return _problem(f"no process could be started to read the record: {error.strerror}")
            answer = process.ask(what, name, data, self._seconds)
            if answer is None:
                why = process.end()
                if not self._ended:
                    with contextlib.suppress(OSError):
                        self._start()
                return _problem(why)
            return answer

    def end(self) -> None:
        """End the process."""
        self._ended = True
        if self._process is not None:
            self._process.end()

    def _start(self) -> _Process:
        """A process that is ready before a file arrives."""
        if self._process is not None:
            self._process.end()
        self._process = _Process()
        if self._ended:
            self._process.end()
        return self._process


class _Process:
    """One reading process."""

    def __init__(self) -> None:
        command = [sys.executable, "-P", "-m", "stickslip.show.explorer.upload_reading"]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        self._late = self._started = False

    def is_alive(self) -> bool:
        return self._process.poll() is None

    def ask(self, what: str, name: str, data: bytes, seconds: float) -> bytes | None:
        """The response, or None if the process ended, by itself or at the deadline."""
        if not self._started and self._within(_START, self._sent) is None:
            return None
        self._started = True
        return self._within(seconds, lambda: self._sent(json.dumps({"what": what, "name": name, "seconds": seconds}).encode(), data))

    def _sent(self, *parts: bytes) -> bytes | None:
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
        finally:
            timer.cancel()

    def _expire(self) -> None:
        self._late = True
        self._process.kill()

    def end(self) -> str:
        """End the process; returns a sentence on why it had ended, for the waiting client."""
        killed(self._process)
        if self._late:
            return "the record was not read in time; cut it, or read it with stickslip.read, which has no deadline"
        return "the process that read the record crashed: the file is damaged or malicious; export it again"


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
def main() -> None:
    """Run the reading process: it reads records from its input and answers each."""
    asked, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    with open(os.devnull, "r+b") as nothing:  # libraries must not read our input or write into our responses
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
    from stickslip.show.explorer.dropped_records import drive_response, velocity_response

    try:
        return {"velocity": velocity_response, "drive": drive_response}[what](name, data)
    except InputError as error:
        problems = [without_python(p) for p in error.problems]
    except MemoryError:
        problems = ["the record needs more memory than is allowed here; cut it, or read it with stickslip.read"]
    except Exception as error:  # an internal error is reported, and the page stays usable
        problems = [f"{type(error).__name__}: {error}. This is an error of stickslip itself"]
    return _problem(*problems)


def _prepare() -> None:
    """Load the libraries for all formats before the first file."""
    from stickslip.show.explorer.dropped_records import drive_response

    for module in ("h5py", "scipy.io", "scipy.signal", "openpyxl", "nptdms"):
        with contextlib.suppress(ImportError):
            __import__(module)
    with contextlib.suppress(InputError):
        drive_response("ready.csv", b"t [ms],drive [m/s]\n0,0\n1,1\n2,0\n3,-1\n4,0\n5,1\n6,0\n7,-1\n")


def _limit_memory() -> None:
    """Limit memory and file size, where the system supports it."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        for kind, most in ((resource.RLIMIT_FSIZE, 0), (resource.RLIMIT_CORE, 0), (resource.RLIMIT_AS, _MEMORY)):
            with contextlib.suppress(OSError, ValueError):
                resource.setrlimit(kind, (most, most))


def _limit_time(seconds: float) -> None:
    """Limit the CPU time, in case the parent process cannot end this one."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        most = resource.getrlimit(resource.RLIMIT_CPU)[1]
        resource.setrlimit(resource.RLIMIT_CPU, (int(time.process_time() + seconds) + 2, most))


if __name__ == "__main__":
    main()
