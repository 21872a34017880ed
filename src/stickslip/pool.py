"""Work shared by threads: the one pool, with progress, Ctrl-C and a way to say stop."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from itertools import islice
from typing import Any, Protocol, TypeVar

P = TypeVar("P")
T = TypeVar("T")
_NOTHING: Any = object()
_LOOK = 0.2  # how often it looks whether somebody said stop [s]


class Cancelled(Exception):
    """Work that noticed that it was told to stop."""


class Stoppable(Protocol):
    """A flag that threads check for cancellation."""

    stopped: bool


class _Unwatched:
    stopped = False


def shared(work: Callable[[P], T], parts: Iterable[P], workers: int = 1, watch: Stoppable | None = None) -> Iterator[tuple[P, T]]:
    """Each part and what `work` makes of it: in order by one worker, as they become ready by several.

    Parts are taken a few at a time, so that memory does not grow with their number. An error ends it; so does Ctrl-C, within a
    fraction of a second if the work lets go of the interpreter.

    Parameters
    ----------
    work : callable
        Takes a part. Where there is a watch it may raise `Cancelled`: there is then no result of this part.
    parts : iterable
    workers : int
        Threads.
    watch : optional
        What knows whether to stop. No part is begun after that, and it is told where an error or Ctrl-C ends the work.

    Examples
    --------
    >>> sorted(shared(lambda n: n * n, range(4), workers=2))
    [(0, 0), (1, 1), (2, 4), (3, 9)]
    """
    tried = work if watch is None else _tried(work)
    made = _in_turn(tried, parts, watch or _Unwatched()) if workers == 1 else _in_threads(tried, parts, workers, watch or _Unwatched())
    return ((part, result) for part, result in made if result is not _NOTHING)


def _tried(work: Callable[[P], T]) -> Callable[[P], T]:
    """The same, with nothing where it noticed that it was told to stop."""

    def tried(part: P) -> T:
        try:
            return work(part)
        except Cancelled:
            return _NOTHING

    return tried


def _in_turn(work: Callable[[P], T], parts: Iterable[P], watch: Stoppable) -> Iterator[tuple[P, T]]:
    for part in parts:
        if watch.stopped:
            return
        yield part, work(part)


def _in_threads(work: Callable[[P], T], parts: Iterable[P], workers: int, watch: Stoppable) -> Iterator[tuple[P, T]]:
    rest = iter(parts)
    with ThreadPoolExecutor(workers) as pool:
        running: dict[Future[T], P] = {}
        try:
            while True:
                for part in islice(rest, 0 if watch.stopped else 2 * workers - len(running)):
                    running[pool.submit(work, part)] = part
                if not running:
                    return
                for ready in wait(running, timeout=_LOOK, return_when=FIRST_COMPLETED).done:
                    yield running.pop(ready), ready.result()
        finally:
            watch.stopped = watch.stopped or bool(running)
            pool.shutdown(wait=True, cancel_futures=True)
