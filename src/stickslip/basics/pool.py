"""Work handed out in chunks, in turn, to threads, or to an executor: one door, which an error or an interruption closes."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from types import TracebackType
from typing import Any, TypeVar

from stickslip.basics.executors import LOOK, Elsewhere, Lost, Workers
from stickslip.basics.interruption import FAILED, Interrupted, in_threads, look

P = TypeVar("P")
T = TypeVar("T")


def handed_out(work: Callable[[P], T], parts: Iterable[P], workers: int | Workers = 1, all_parts: bool = False) -> Iterator[tuple[P, T]]:
    """Each part and what `work` makes of it: in order by one thread, as they become ready by several or by an executor.

    Parts are taken a few at a time, so that memory does not grow with their number. An error ends it. So does an interruption of the
    call (see `stickslip.basics.interruption`): no part is begun then, those at work end when they look, what is ready is yielded, and
    `Interrupted` is raised. A part that an executor lost is handed out again, after the others.

    Parameters
    ----------
    work : callable
        Takes a part. For an executor it is pickled, and so are the parts and what it returns.
    parts : iterable
    workers : int or Workers
        Threads, or an executor.
    all_parts : bool
        Whether all parts are begun after an interruption too: `work` looks for itself, and returns what it has.

    Examples
    --------
    >>> sorted(handed_out(lambda n: n * n, range(4), workers=2))
    [(0, 0), (1, 1), (2, 4), (3, 9)]
    """
    workers = workers if isinstance(workers, Workers) else Workers(workers)
    if workers.elsewhere:
        return _by(Elsewhere(workers, work), parts, False)
    return _in_turn(work, parts, all_parts) if workers.threads == 1 else _by(_Threads(workers.threads, work), parts, all_parts)


def _in_turn(work: Callable[[P], T], parts: Iterable[P], all_parts: bool) -> Iterator[tuple[P, T]]:
    for part in parts:
        if not all_parts:
            look()
        yield part, work(part)


def _by(crew: Elsewhere | _Threads, parts: Iterable[P], all_parts: bool) -> Iterator[tuple[P, Any]]:
    fresh, again = enumerate(parts), deque[tuple[int, P]]()
    running: dict[Any, tuple[int, P]] = {}
    with crew:
        try:
            while True:
                if crew.stop and not all_parts:
                    crew.recall(running)
                else:
                    for number, part in _next(fresh, again, crew.room() - len(running)):
                        running[crew.begin(number, part)] = number, part
                if not running:
                    break
                for future in crew.ready(running):
                    number, part = running.pop(future)
                    try:
                        result = crew.result(number, future)
                    except Lost:
                        again.append((number, part))
                    except Interrupted:
                        if not crew.stop:
                            raise
                    else:
                        yield part, result
        finally:
            if running:
                crew.stop.set(FAILED)
                crew.recall(running)
    if not all_parts:
        look()


def _next(fresh: Iterator[tuple[int, P]], again: deque[tuple[int, P]], count: int) -> Iterator[tuple[int, P]]:
    """The next parts with their numbers, at most so many: first those that were never handed out."""
    for _ in range(count):
        each = next(fresh, None) or (again.popleft() if again else None)
        if each is None:
            return
        yield each


class _Threads:
    """Threads of this process, which carry the context of the call."""

    def __init__(self, threads: int, work: Callable[[Any], Any]):
        self.stop, self._run = in_threads()
        self._work, self._threads = work, threads

    def __enter__(self) -> _Threads:
        self._pool = ThreadPoolExecutor(self._threads)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._pool.shutdown(wait=True, cancel_futures=True)

    def room(self) -> int:
        """How many parts may be handed out at once."""
        return 2 * self._threads

    def begin(self, number: int, part: Any) -> Future[Any]:
        """Begin a part."""
        return self._pool.submit(self._run, self._work, part)

    def ready(self, running: Collection[Future[Any]]) -> Collection[Future[Any]]:
        """Those that are done; it waits for the first, but not for long."""
        return wait(running, timeout=LOOK, return_when=FIRST_COMPLETED).done

    def result(self, number: int, future: Future[Any]) -> Any:
        """The result of a part that is done."""
        return future.result()

    def recall(self, running: dict[Future[Any], Any]) -> None:
        """Nothing is dropped: parts that were begun end when they look."""
