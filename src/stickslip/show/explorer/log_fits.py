"""Fits of logs that pages ask for, each in a process of its own, which is ended when the page no longer waits for it.

What arrives there is what `log_uploads.record_response` makes of files: numbers with names and units. No file of anybody is opened.
"""

from __future__ import annotations

import contextlib
import threading
from typing import Any

from stickslip.basics.child_process import ChildEnded, ChildProcess, serve
from stickslip.basics.errors import StickslipError, without_advice
from stickslip.show.explorer.frames import encoded

#: Time limit of a fit [s], the memory of its process [bytes] beside its libraries, and how many are under way at once.
LONGEST, _MEMORY, MOST = 300.0, 6 << 30, 2
_MODULE = "stickslip.show.explorer.log_fits"


class Fitters:
    """Processes that fit: one is kept for the next fit, so that it need not wait for imports."""

    def __init__(self) -> None:
        self._lock, self._closed = threading.Lock(), False
        self._idle: list[ChildProcess] = []
        self._busy: list[ChildProcess] = []

    def prepare(self) -> None:
        """A process for the next fit; blocks until it has been started."""
        with self._lock:
            if self._idle or self._busy or self._closed:
                return
            self._idle.append(child := ChildProcess(_MODULE))
        with contextlib.suppress(OSError, ChildEnded):
            child.start()

    def taken(self) -> ChildProcess | None:
        """A process for one fit; None while `MOST` fits are under way."""
        with self._lock:
            if self._closed or len(self._busy) >= MOST:
                return None
            child = self._idle.pop() if self._idle else ChildProcess(_MODULE)
            self._busy.append(child)
            return child

    def fit(self, child: ChildProcess, wish: dict[str, Any], record: bytes) -> bytes:
        """The response with the fit of some records; blocks until it is there, the deadline has passed, or the process is ended.

        Parameters
        ----------
        child : ChildProcess
            From `taken`; it goes back.
        wish : dict
            The choices of the page, and the name of the file.
        record : bytes
            As `record_response` sends it.
        """
        whole = False
        try:
            answer = child.ask(wish, record, LONGEST, _MEMORY)
            whole = True
            return answer
        except OSError as error:
            return problems(f"no process could be started for the fit: {error.strerror}")
        except ChildEnded as ended:
            late = f"the fit was not ready within {LONGEST:g} s; choose one law, or fit it with stickslip fit, which has no deadline"
            return problems(late if ended.late else "the fit was stopped, or needed more memory than is allowed here")
        finally:
            self._back(child, whole)

    def _back(self, child: ChildProcess, whole: bool) -> None:
        with self._lock:
            self._busy.remove(child)
            if whole and not self._idle and not self._closed:
                self._idle.append(child)
                return
        child.end()

    def close(self) -> None:
        """End all processes."""
        with self._lock:
            self._closed = True
            children = [*self._idle, *self._busy]
        for child in children:
            child.end()


def problems(*sentences: str) -> bytes:
    """A response that says what is wrong."""
    return encoded({"kind": "problems", "problems": sentences})


# ---- in the process ----
def _answer(wish: dict[str, Any], data: bytes) -> bytes:
    try:
        return encoded(_fitted(wish, data))
    except StickslipError as error:
        return problems(*(without_advice(p.partition("\n")[0]) for p in getattr(error, "problems", [str(error)])))
    except MemoryError:
        return problems("the fit needs more memory than is allowed here; cut the record, or fit it with stickslip fit")
    except Exception as error:  # an internal error is reported, and the page stays usable
        return problems(f"{type(error).__name__}: {error}. This is an error of stickslip itself")


def _fitted(wish: dict[str, Any], data: bytes) -> dict[str, Any]:
    from stickslip.inverse.logs.fitting import fit_plan, written
    from stickslip.inverse.logs.plan import plan_of
    from stickslip.show.explorer.log_choices import choices_of
    from stickslip.show.explorer.log_results import result_of
    from stickslip.show.explorer.log_uploads import names_of, unpacked_records

    choices, records = choices_of(wish), unpacked_records(data)
    plan = plan_of(records, choices.units, choices.roles, choices.machine, choices.numbers)
    own = [choices.of(names_of(record)) for record in records]
    readings = [written(str(rec.source["path"]), of.units, of.roles | plan.joint.roles, {}) for rec, of in zip(records, own, strict=True)]
    return result_of(fit_plan(plan, readings, choices.law, choices.asymmetric))


def _prepare() -> None:
    """Load the libraries before the first fit."""
    for module in ("scipy.optimize", "matplotlib.figure", "stickslip.inverse.logs.fitting", "stickslip.show.explorer.log_results"):
        __import__(module)


if __name__ == "__main__":
    serve(_answer, _prepare, writes=True)
