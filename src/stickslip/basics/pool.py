"""Work shared by threads: the one pool, which an error or an interruption ends."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from itertools import islice
from typing import TypeVar

from stickslip.basics.interruption import FAILED, Interrupted, in_threads, look

P = TypeVar("P")
T = TypeVar("T")
_LOOK = 0.2  # how often it looks whether the call is to end [s]


def shared(work: Callable[[P], T], parts: Iterable[P], workers: int = 1, all_parts: bool = False) -> Iterator[tuple[P, T]]:
    """Each part and what `work` makes of it: in order by one worker, as they become ready by several.

    Parts are taken a few at a time, so that memory does not grow with their number. An error ends it. So does an interruption of the
    call (see `stickslip.basics.interruption`): no part is begun then, those at work end when they look, what is ready is yielded, and
    `Interrupted` is raised.

    Parameters
    ----------
    work : callable
        Takes a part.
    parts : iterable
    workers : int
        Threads.
    all_parts : bool
        Whether all parts are begun after an interruption too: `work` looks for itself, and returns what it has.

    Examples
    --------
    >>> sorted(shared(lambda n: n * n, range(4), workers=2))
    [(0, 0), (1, 1), (2, 4), (3, 9)]
    """
    return _in_turn(work, parts, all_parts) if workers == 1 else _in_threads(work, parts, workers, all_parts)


def _in_turn(work: Callable[[P], T], parts: Iterable[P], all_parts: bool) -> Iterator[tuple[P, T]]:
    for part in parts:
        if not all_parts:
            look()
        yield part, work(part)


def _in_threads(work: Callable[[P], T], parts: Iterable[P], workers: int, all_parts: bool) -> Iterator[tuple[P, T]]:
    rest = iter(parts)
    stop, run = in_threads()
    with ThreadPoolExecutor(workers) as pool:
        running: dict[Future[T], P] = {}
        try:
            while True:
                for part in islice(rest, 0 if stop and not all_parts else 2 * workers - len(running)):
                    running[pool.submit(run, work, part)] = part
                if not running:
                    break
                for ready in wait(running, timeout=_LOOK, return_when=FIRST_COMPLETED).done:
                    part = running.pop(ready)
                    if not (stop and isinstance(ready.exception(), Interrupted)):
                        yield part, ready.result()
        finally:
            if running:
                stop.set(FAILED)
            pool.shutdown(wait=True, cancel_futures=True)
    if not all_parts:
        look()
