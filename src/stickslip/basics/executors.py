"""Chunks of a long computation on an executor: process pools, batch queues and clusters behind ``submit(function, *arguments)``.

A chunk travels as bytes that this module makes: the function, which is the same for all of them, and the numbers of this chunk. They are
restored inside the worker's own call, so a class that the worker cannot import is a sentence, not a broken pool. The worker compares the
function, with the models in it, to the fingerprint of the caller's, so that an older copy of a module on another machine is noticed.
While the call goes on, an empty folder of its own lies in the folder of temporary files; workers on the same machine end when it is gone.
"""

from __future__ import annotations

import contextlib
import functools
import importlib.util
import os
import pickle
import signal
import socket
import tempfile
import threading
import time
import traceback
from collections.abc import Callable, Collection, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from dataclasses import dataclass, replace
from types import TracebackType
from typing import Any, NamedTuple

from stickslip.basics.contracts import EXECUTORS, is_executor, process_count
from stickslip.basics.errors import InputError, Problems, StickslipError
from stickslip.basics.fingerprints import fingerprint
from stickslip.basics.interruption import CTRL_C, Interrupted, StopRequest, in_threads
from stickslip.basics.processes import Processes

LOOK = 0.2  # how often it looks whether the call is to end [s]
_PATIENCE = 5.0  # how long chunks at work are waited for after an interruption [s]
_POLL = 0.001, 0.1  # pauses between looks at futures that cannot be waited for: the first and the longest [s]
_RECALL = 0.05  # how often a worker looks whether its chunk is still wanted [s]
_AT_ONCE = 64  # chunks handed out at once, where the number of workers is not known
_DONE, _WRONG, _RECALLED, _UNREADABLE, _OTHER = "done", "wrong", "recalled", "unreadable", "other"
_BY_VALUE = 'write it into a module (a .py file that the workers can import), or type "pip install cloudpickle"'


class Lost(Exception):
    """A chunk without a result, which is handed out again."""


@dataclass(frozen=True, eq=False)
class Workers:
    """Where the chunks of a long computation are computed.

    Parameters
    ----------
    threads : int
        Threads of this process; with an executor, the number of its workers: twice as many chunks are handed out at once.
    executor : Executor, callable or str, optional
        An executor, or a function that makes one; it is asked again if the pool breaks, as a process pool does when a worker is killed. Or
        "processes:8" for eight processes of this computer, of which each is begun again if it is killed; it says the number of workers.
    retries : int
        How often a chunk that was lost with its worker is handed out again, and how often a pool that breaks is made again without a
        chunk finished in between.
    at_once : callable, optional
        Says how many chunks are handed out at once.
    """

    threads: int = 1
    executor: Any = None
    retries: int = 3
    at_once: Callable[[], int] | None = None

    def __post_init__(self) -> None:
        if (count := process_count(self.executor)) is not None:
            object.__setattr__(self, "executor", functools.partial(Processes, count))
            object.__setattr__(self, "threads", count)

    @property
    def elsewhere(self) -> bool:
        """Whether chunks leave this process's own threads."""
        return self.executor is not None

    @property
    def count(self) -> int:
        """Workers among which cases are divided."""
        return _AT_ONCE // 2 if self.elsewhere and self.threads == 1 else self.threads

    @contextlib.contextmanager
    def kept(self) -> Iterator[Workers]:
        """A block of many computations by the same workers: a pool that is made for it is made once."""
        if not callable(self.executor):
            yield self
            return
        pool = _Made(self.executor)
        try:
            yield replace(self, executor=pool)
        finally:
            pool.close()

    def note(self, problems: Problems) -> None:
        """Note what is wrong with the arguments `workers` and `executor` of a public function."""
        problems.whole("workers", self.threads, 1, example=2)
        problems.whole("retries", self.retries, 0, example=3)
        if not is_executor(self.executor):
            problems.add(f"executor = {self.executor!r}; allowed is {EXECUTORS}")


#: One thread of this process.
HERE = Workers()


class _Made:
    """A pool that a function makes: when it is needed, and again after it broke."""

    def __init__(self, make: Callable[[], Any]):
        self._make, self.generation, self.is_left = make, 0, False
        self._pool: Any = None

    def submit(self, function: Callable[..., Any], /, *args: Any) -> Any:
        """Begin a call, and return a future."""
        if self._pool is None:
            self._pool = self._make()
        return self._pool.submit(function, *args)

    def renew(self) -> None:
        """Let go of a broken pool."""
        self.close(wait=False)
        self.generation += 1

    def close(self, wait: bool = True) -> None:
        """End the workers, after those chunks that they have begun; chunks that were called back in vain are not waited for."""
        if self._pool is not None:
            self._pool.shutdown(wait=wait and not self.is_left)
        self._pool = None


# ---- the caller ----
class _Errand(NamedTuple):
    """How a worker learns that its chunk is not wanted any more: an empty folder that is there while the call goes on."""

    folder: str
    host: str
    process: int


class Elsewhere:
    """The workers of an executor, while a call hands out its chunks."""

    def __init__(self, workers: Workers, work: Callable[[Any], Any]):
        self.stop = in_threads()[0]
        self._workers = workers
        self._work = packed(work)
        self._print = _print_of(self._work)
        self._pool = workers.executor if isinstance(workers.executor, _Made) or not callable(workers.executor) else _Made(workers.executor)
        self._generations: dict[Any, int] = {}
        self._broken, self._breaks = "", 0
        self._tries: dict[int, int] = {}
        self._recalled_at = 0.0

    def __enter__(self) -> Elsewhere:
        self._errand = _Errand(tempfile.mkdtemp(prefix="stickslip-call-"), socket.gethostname(), os.getpid())
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._dismiss()
        if isinstance(self._pool, _Made):
            self._pool.is_left = self._pool.is_left or bool(self._generations)
            if self._pool is not self._workers.executor:
                self._pool.close()

    def room(self) -> int:
        """How many chunks may be handed out at once."""
        if self._workers.at_once is not None:
            return self._workers.at_once()
        return 2 * self._workers.count

    def begin(self, number: int, part: Any) -> Any:
        """Hand out a chunk; returns its future."""
        message = packed(part)
        if self._broken:
            self._renew()
        try:
            future = self._pool.submit(_computed, self._work, self._print, message, self._errand)
        except BrokenExecutor as error:
            self._breaks_by(error)
            self._renew()
            future = self._pool.submit(_computed, self._work, self._print, message, self._errand)
        self._generations[future] = self._generation
        return future

    def ready(self, running: Collection[Any]) -> list[Any]:
        """Those futures that are done, as they were handed out; it waits for the first, but not for long."""
        if all(isinstance(each, Future) for each in running):
            ended = wait(running, timeout=LOOK, return_when=FIRST_COMPLETED).done
            return [each for each in running if each in ended]
        pause, until = _POLL[0], time.monotonic() + LOOK
        while not (done := [each for each in running if each.done()]) and time.monotonic() < until:
            time.sleep(pause)
            pause = min(2 * pause, _POLL[1])
        return done

    def result(self, number: int, future: Any) -> Any:
        """The result of a chunk that is done; `Lost` if it has to be handed out again."""
        generation = self._generations.pop(future)
        try:
            error = future.exception()
        except CancelledError as cancelled:
            error = cancelled
        if error is not None and self.stop:
            raise Interrupted
        if isinstance(error, BrokenExecutor):
            if generation == self._generation and not self._broken:
                self._breaks_by(error)
            raise Lost
        kind, value = ("lost", f"{type(error).__name__}: {error}") if error is not None else future.result()
        if kind == _DONE:
            self._breaks = 0
            self._tries.pop(number, None)
            return value
        if kind == _RECALLED:
            raise Interrupted if self.stop else Lost
        if kind == _UNREADABLE:
            raise InputError("executor", [f"a worker cannot restore its task ({value}); {_BY_VALUE}"])
        if kind == _OTHER:
            what = "a worker has other models than this process: its modules, or something that they use, are others there"
            raise InputError("executor", [f"{what} ({value}); restart the workers with the modules that you use"])
        if isinstance(value, Exception) and not isinstance(value, (OSError, MemoryError)):
            raise value
        self._try_again(number, str(value))
        raise Lost

    def recall(self, running: dict[Any, Any]) -> None:
        """Call back what was handed out, after an interruption: what has not begun is dropped, and in the end all the rest."""
        self._dismiss()
        self._recalled_at = self._recalled_at or time.monotonic()
        late = time.monotonic() - self._recalled_at > _PATIENCE
        for future in [each for each in running if each.cancel() or late]:
            del running[future]
            if not late:
                self._generations.pop(future, None)

    def _dismiss(self) -> None:
        if os.path.exists(self._errand.folder):
            os.rmdir(self._errand.folder)

    def _breaks_by(self, error: BaseException) -> None:
        """A pool broke: its futures all fail, and it takes no more."""
        self._broken = f"{type(error).__name__}: {error}"
        self._breaks += 1
        what = f"the workers of the executor are gone ({self._broken})"
        if not isinstance(self._pool, _Made):
            how = "executor=lambda: ProcessPoolExecutor(8), with which the pool is made again and its chunks are handed out again"
            raise StickslipError(f"{what}; look at their messages (memory?), and give a function that makes the executor: {how}")
        if self._breaks > self._workers.retries:
            raise StickslipError(f"{what}, {self._breaks} times without a chunk finished in between; look at their messages (memory?)")

    @property
    def _generation(self) -> int:
        return self._pool.generation if isinstance(self._pool, _Made) else 0

    def _renew(self) -> None:
        self._pool.renew()
        self._broken = ""

    def _try_again(self, number: int, why: str) -> None:
        self._tries[number] = self._tries.get(number, 0) + 1
        if self._tries[number] > self._workers.retries:
            what = f"chunk {number} was lost with its worker {self._tries[number]} times ({why})"
            raise StickslipError(f"executor: {what}; look at the messages of the workers (memory?)")


def packed(thing: Any) -> bytes:
    """An object as bytes, by cloudpickle where it is installed: then functions and classes of a notebook travel too.

    Raises
    ------
    InputError
        If it cannot travel; it says what, and what to do.

    Examples
    --------
    >>> pickle.loads(packed({"mu": 0.3}))
    {'mu': 0.3}
    """
    try:
        if importlib.util.find_spec("cloudpickle") is not None:
            import cloudpickle

            return bytes(cloudpickle.dumps(thing))
        return pickle.dumps(thing)
    except Exception as error:  # whatever an object raises that cannot be pickled
        raise InputError("executor", [_cannot_travel(error)]) from None


def _print_of(work: bytes) -> str:
    """The fingerprint of what a worker will restore."""
    try:
        return _restored(work)[1]
    except Exception as error:  # whatever an object raises that does not come back
        raise InputError("executor", [_cannot_travel(error)]) from None


def _cannot_travel(error: Exception) -> str:
    what = f"the model, or a function in it, cannot be sent to another process ({type(error).__name__}: {error})"
    return f"{what}; {_BY_VALUE}; workers=2 computes in threads, where nothing is sent"


# ---- the worker ----
@functools.lru_cache(maxsize=8)
def _restored(work: bytes) -> tuple[Any, str]:
    """The function of a call, restored, and its fingerprint: on either side that of a restored one, without what a process keeps."""
    function = pickle.loads(work)
    return function, fingerprint(function).digest


def _computed(work: bytes, mine: str, message: bytes, errand: _Errand) -> tuple[str, Any]:
    """Compute one chunk, in a worker: how it ended, and its result or why there is none."""
    if errand.process != os.getpid():
        _leave_ctrl_c_to_the_caller()
    try:
        function, theirs = _restored(work)
        part = pickle.loads(message)
    except Exception as error:  # such as a module that the worker does not have
        return _UNREADABLE, f"{type(error).__name__}: {error}"
    if mine != theirs:
        return _OTHER, f"on {socket.gethostname()}"
    run = in_threads(_Recall(errand))[1]
    try:
        return _DONE, run(function, part)
    except Interrupted:
        return _RECALLED, None
    except Exception as error:  # goes on in the caller
        return _WRONG, _sendable(error)


def _leave_ctrl_c_to_the_caller() -> None:
    """Ctrl-C of a terminal goes to the workers too; they end when the caller calls them back."""
    if threading.current_thread() is threading.main_thread() and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def _sendable(error: Exception) -> Exception:
    """An error as it is, or in words if it cannot be pickled."""
    error.add_note("".join(traceback.format_exception(error)))
    try:
        return error if type(pickle.loads(pickle.dumps(error))) is type(error) else StickslipError(str(error))
    except Exception:  # whatever an error of a user's own raises there
        return StickslipError(f"{type(error).__name__}: {error}")


class _Recall(StopRequest):
    """Ends a chunk in a worker if the call that handed it out is over."""

    def __init__(self, errand: _Errand):
        super().__init__()
        self._folder, self._look_at = errand.folder, 0.0
        self._sees_it = errand.host == socket.gethostname() or os.path.exists(errand.folder)

    @property
    def why(self) -> str:
        """What asked for the end; "" while nothing has."""
        now = time.monotonic()
        if not self._why and self._sees_it and now > self._look_at:
            self._look_at = now + _RECALL
            if not os.path.exists(self._folder):
                self.set(CTRL_C)
        return self._why
