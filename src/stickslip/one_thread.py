"""Small problems of linear algebra are solved in one thread: threads that wait for one another cost more than they save."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, wraps
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


def in_one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """A function during which the libraries under NumPy and SciPy do linear algebra in one thread.

    The singular values of a table of a few columns take some .1 ms so, and on a machine whose cores are busy hundreds of ms where several
    threads share them. Afterwards there are as many threads as before.

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
    import scipy.linalg  # noqa: F401  brings its own library, which has to be there to be found
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()
