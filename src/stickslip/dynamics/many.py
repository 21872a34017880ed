"""Many cases at once: parts of a batch in threads, in order, watched, and ended cleanly when somebody says stop."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from typing import Any, TypeVar

import numpy as np

from stickslip.batch import labels_of, rows_of
from stickslip.fields import leaves, replace_leaf
from stickslip.sweeps.progress import Progress, Watch

__all__ = ["Report", "parts_of", "picked", "shared"]

Array = Any
T = TypeVar("T")
#: What a caller may give as `progress`: it is called with a `Progress`, and says stop by returning False.
Report = Callable[[Progress], Any] | bool
PART = 128  # cases that run together: enough for full lanes, few enough that threads finish together


class _Stopped(Exception):
    """Somebody said stop."""


def parts_of(cases: int, size: int = PART) -> list[slice]:
    """The cases in parts; their size does not depend on the number of threads.

    Examples
    --------
    >>> parts_of(5, 2)
    [slice(0, 2, None), slice(2, 4, None), slice(4, 5, None)]
    """
    return [slice(i, min(i + size, cases)) for i in range(0, cases, size)]


def picked(model: Any, at: Any) -> Any:
    """Some cases of a batch, by a slice or by their numbers (which may repeat), as a batch of one dimension.

    Examples
    --------
    >>> import stickslip as ss
    >>> picked(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[4e-4, 5e-4, 6e-4]), [2, 0, 0]).drive.amplitude.tolist()
    [0.0006, 0.0004, 0.0004]
    """
    if not labels_of(model).shape:
        return model
    names = tuple(name for name, _ in leaves(model))
    rows = rows_of(model, names)[at]
    return replace_leaf(model, {name: np.ascontiguousarray(rows[:, k]) for k, name in enumerate(names)})


def shared(
    cases: int, work: Callable[[slice, Callable[[float], None]], T], workers: int, progress: Report | None, size: int = PART
) -> Iterator[tuple[slice, T]]:
    """What `work` makes of every part, as they become ready: the same for any number of threads.

    Parameters
    ----------
    cases : int
        How many there are.
    work : callable
        Takes a part and a function to be called now and then with the share of it that is done (0 to 1).
    workers : int
        Threads.
    progress : callable or bool, optional
        True for a line on the terminal, or what is called with a `Progress`; parts that had not ended when it returned False are missing
        from the results.
    size : int
        Cases in a part.

    Examples
    --------
    >>> dict((part.start, part.stop) for part, _ in shared(5, lambda part, tell: part.stop, 1, None, 2))
    {0: 2, 2: 4, 4: 5}
    """
    watch = Watch(cases, progress)

    def done(part: slice) -> T:
        def tell(share: float) -> None:
            watch.begun(part.start, int(share * (part.stop - part.start)))
            if watch.stopped:
                raise _Stopped

        tell(0.0)
        return work(part, tell)

    todo, tried = parts_of(cases, size), _quietly(done)

    def found() -> Iterator[tuple[slice, T | None]]:
        yield tried(todo[0])  # compiles what all of them need
        yield from map(tried, todo[1:]) if workers == 1 else _in_threads(todo[1:], tried, workers, watch)

    for part, result in found() if todo else ():
        if result is not None:
            watch.finished(part.start, np.zeros(part.stop - part.start, int))
            yield part, result


def _quietly(done: Callable[[slice], T]) -> Callable[[slice], tuple[slice, T | None]]:
    """The same, with nothing for a part that was told to stop."""

    def tried(part: slice) -> tuple[slice, T | None]:
        try:
            return part, done(part)
        except _Stopped:
            return part, None

    return tried


def _in_threads(
    todo: list[slice], tried: Callable[[slice], tuple[slice, T | None]], workers: int, watch: Watch
) -> Iterator[tuple[slice, T | None]]:
    with ThreadPoolExecutor(workers) as pool:
        running: set[Future[tuple[slice, T | None]]] = {pool.submit(tried, part) for part in todo}
        try:
            while running:
                ready, running = wait(running, timeout=0.2, return_when=FIRST_COMPLETED)
                for future in ready:
                    yield future.result()
        finally:
            watch.stopped = watch.stopped or bool(running)  # an error or Ctrl-C: let the threads end soon
            pool.shutdown(wait=True, cancel_futures=True)
