"""Uploaded records are read in a process of their own (`stickslip.basics.child_process`); a failure ends only that process.

One process is ready before the first file arrives, so that a file need not wait for imports; one that ended is replaced immediately.
"""

from __future__ import annotations

import contextlib
from typing import Any

from stickslip.basics.child_process import ChildEnded, ChildProcess, serve
from stickslip.basics.errors import InputError, without_advice
from stickslip.show.explorer.frames import encoded

#: Memory of a reading process beside its libraries [bytes].
_MEMORY = 3 << 30


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
        self._seconds, self._child = seconds, ChildProcess("stickslip.show.explorer.upload_reading")
        self._prepared()

    def read(self, what: str, name: str, data: bytes, choices: Any = None) -> bytes:
        """The response to a file; blocks until it is available or the deadline has passed.

        Parameters
        ----------
        what : {"velocity", "drive", "plan", "record"}
        name : str
            Name of the file.
        data : bytes
        choices : dict, optional
            What the page has typed of a log.
        """
        try:
            return self._child.ask({"what": what, "name": name, "choices": choices}, data, self._seconds, _MEMORY)
        except OSError as error:
            return _problem(f"no process could be started to read the record: {error.strerror}")
        except ChildEnded as ended:
            self._prepared()
            if ended.late:
                return _problem("the record was not read in time; cut it, or read it with stickslip.read, which has no deadline")
            return _problem("the process that read the record crashed: the file is damaged or malicious; export it again")

    def end(self) -> None:
        """End the process."""
        self._child.end()

    def _prepared(self) -> None:
        """A process that is ready before a file arrives; if there is none, the next file tries again, and reports it."""
        with contextlib.suppress(OSError, ChildEnded):
            self._child.start()


# ---- in the process ----
def _answer(wish: dict[str, Any], data: bytes) -> bytes:
    from stickslip.show.explorer.dropped_records import drive_response, velocity_response
    from stickslip.show.explorer.log_uploads import plan_response, record_response

    of_logs = {"plan": plan_response, "record": record_response}
    try:
        if wish["what"] in of_logs:
            return of_logs[wish["what"]](wish["name"], data, wish["choices"])
        return {"velocity": velocity_response, "drive": drive_response}[wish["what"]](wish["name"], data)
    except InputError as error:
        problems = [without_advice(p) for p in error.problems]
    except MemoryError:
        problems = ["the record needs more memory than is allowed here; cut it, or read it with stickslip.read"]
    except Exception as error:  # an internal error is reported, and the page stays usable
        problems = [f"{type(error).__name__}: {error}. This is an error of stickslip itself"]
    return _problem(*problems)


def _prepare() -> None:
    """Load the libraries for all formats before the first file."""
    from stickslip.show.explorer.dropped_records import drive_response

    for module in ("h5py", "scipy.signal", "openpyxl", "nptdms"):
        with contextlib.suppress(ImportError):
            __import__(module)
    with contextlib.suppress(InputError):
        drive_response("ready.csv", b"t [ms],drive [m/s]\n0,0\n1,1\n2,0\n3,-1\n4,0\n5,1\n6,0\n7,-1\n")


if __name__ == "__main__":
    serve(_answer, _prepare)
