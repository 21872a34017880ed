"""Linear algebra of small matrices in one thread, because synchronising several threads costs more than it saves."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import cache, wraps
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


def in_one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function so that the libraries under NumPy and SciPy use one thread for linear algebra while it runs.

    The singular values of a matrix of a few columns then take some 0.1 ms; with several threads, on a machine whose cores are busy, they
    take hundreds of ms. When the last of several such functions that run side by side has ended, the number of threads is as before.

    Examples
    --------
    >>> import numpy as np
    >>> in_one_thread(np.linalg.norm)([3.0, 4.0])
    np.float64(5.0)
    """

    @wraps(function)
    def alone(*args: P.args, **kwargs: P.kwargs) -> R:
        _limit.begin()
        try:
            return function(*args, **kwargs)
        finally:
            _limit.end()

    return alone


class _Limit:
    """One thread for linear algebra from when the first of several functions begins until the last one ends."""

    def __init__(self) -> None:
        self._lock, self._count = threading.Lock(), 0
        self._kept: Any = None

    def begin(self) -> None:
        """Another function begins."""
        with self._lock:
            self._kept = self._kept or _libraries().limit(limits=1, user_api="blas")
            self._count += 1

    def end(self) -> None:
        """A function ends."""
        with self._lock:
            self._count -= 1
            if self._count == 0:
                self._kept, kept = None, self._kept
                kept.restore_original_limits()


_limit = _Limit()


@cache
def _libraries() -> Any:
    import scipy.linalg  # noqa: F401  has its own library, which must be loaded to be found
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
