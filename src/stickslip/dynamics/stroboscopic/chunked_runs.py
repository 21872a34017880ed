"""Runs a batch in chunks, on threads or an executor, with progress and cancellation."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import chain
from typing import Any, TypeVar

import numpy as np

from stickslip.basics.executors import Workers
from stickslip.basics.pool import handed_out
from stickslip.studies.progress import Progress, Watch

P = TypeVar("P")
T = TypeVar("T")
#: Called now and then during a chunk with the share of it that is done (0 to 1).
Tell = Callable[[float], None]
#: What a caller may give as `progress`: it is called with a `Progress`, and says stop by returning False.
Report = Callable[[Progress], Any] | bool
PART = 128  # cases that run together: enough for full lanes, few enough that threads finish together


def chunks_of(cases: int, size: int = PART) -> list[slice]:
    """The cases in parts; their size does not depend on the number of threads.

    Examples
    --------
    >>> chunks_of(5, 2)
    [slice(0, 2, None), slice(2, 4, None), slice(4, 5, None)]
    """
    return [slice(i, min(i + size, cases)) for i in range(0, cases, size)]


def over_chunks(
    cases: int, numbers: Callable[[slice], P], work: Callable[[P, Tell], T], workers: Workers, progress: Report | None, size: int = PART
) -> Iterator[tuple[slice, T]]:
    """The results of `work` for every chunk, as they become ready; independent of the number of threads, and of who computes it.

    Parameters
    ----------
    cases : int
        How many there are.
    numbers : callable
        The numbers of a chunk, from the slice of its cases: they are what is sent to another process.
    work : callable
        Takes these numbers and a function to be called now and then with the share of the chunk that is done (0 to 1). For an executor
        it is pickled, so it refers to nothing of the whole batch.
    workers : Workers
        Threads, or an executor.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with a `Progress`; where it returns False, the parts that are done
        are yielded, and `Interrupted` is raised.
    size : int
        Cases in a part.

    Examples
    --------
    >>> chunks = over_chunks(5, lambda part: part.stop, lambda stop, tell: 10 * stop, Workers(), None, 2)
    >>> dict((part.start, tens) for part, tens in chunks)
    {0: 20, 2: 40, 4: 50}
    """
    watch = Watch(cases, progress)
    todo = chunks_of(cases, size)
    several = handed_out(partial(_watched, watch, work), ((part, numbers(part)) for part in todo[0 if workers.elsewhere else 1 :]), workers)
    if not workers.elsewhere:  # the first one compiles what all of them need
        several = chain(handed_out(partial(_watched, watch, work), ((part, numbers(part)) for part in todo[:1])), several)
    for (part, _), result in several:
        watch.finished(part.start, np.zeros(part.stop - part.start, int))
        yield part, result


def _watched(watch: Watch, work: Callable[[P, Tell], T], chunk: tuple[slice, P]) -> T:
    """Compute a chunk; in another process nobody watches."""
    part, numbers = chunk

    def tell(share: float) -> None:
        watch.at_work(part.start, int(share * (part.stop - part.start)))

    tell(0.0)
    return work(numbers, tell)
