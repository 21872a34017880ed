"""Linear algebra of small matrices in one thread, because synchronising several threads costs more than it saves."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, wraps
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


def in_one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function so that the libraries under NumPy and SciPy use one thread for linear algebra while it runs.

    The singular values of a matrix of a few columns then take some 0.1 ms; with several threads, on a machine whose cores are busy, they
    take hundreds of ms. Afterwards the number of threads is as before.

    Examples
    --------
    >>> import numpy as np
    >>> in_one_thread(np.linalg.norm)([3.0, 4.0])
    np.float64(5.0)
    """

    @wraps(function)
    def alone(*args: P.args, **kwargs: P.kwargs) -> R:
        with _libraries().limit(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return alone


@cache
def _libraries() -> Any:
    import scipy.linalg  # noqa: F401  has its own library, which must be loaded to be found
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
