"""Runs a batch in chunks on a thread pool, with progress and cancellation."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import chain
from typing import Any, TypeVar

import numpy as np

from stickslip.basics.pool import handed_out
from stickslip.studies.progress import Progress, Watch

T = TypeVar("T")
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
    cases: int, work: Callable[[slice, Callable[[float], None]], T], workers: int, progress: Report | None, size: int = PART
) -> Iterator[tuple[slice, T]]:
    """The results of `work` for every chunk, as they become ready; independent of the number of threads.

    Parameters
    ----------
    cases : int
        How many there are.
    work : callable
        Takes a part and a function to be called now and then with the share of it that is done (0 to 1).
    workers : int
        Threads.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with a `Progress`; where it returns False, the parts that are done
        are yielded, and `Interrupted` is raised.
    size : int
        Cases in a part.

    Examples
    --------
    >>> dict((part.start, part.stop) for part, _ in over_chunks(5, lambda part, tell: part.stop, 1, None, 2))
    {0: 2, 2: 4, 4: 5}
    """
    watch = Watch(cases, progress)

    def done(part: slice) -> T:
        def tell(share: float) -> None:
            watch.at_work(part.start, int(share * (part.stop - part.start)))

        tell(0.0)
        return work(part, tell)

    todo = chunks_of(cases, size)
    first = handed_out(done, todo[:1], 1)  # compiles what all of them need
    for part, result in chain(first, handed_out(done, todo[1:], workers)):
        watch.finished(part.start, np.zeros(part.stop - part.start, int))
        yield part, result
