"""An existing Dask cluster as an executor: its workers may fail and join; there is no scheduler of our own.

The folder of a study, if there is one, is written by this process, so the workers need no access to it.
"""

from __future__ import annotations

from typing import Any

from stickslip.basics.errors import InputError
from stickslip.basics.executors import Workers
from stickslip.basics.optional import library


def _distributed() -> Any:
    return library("sweep", "dask.distributed", 'a cluster needs Dask; type pip install "stickslip[dask]"')


def connected(address: str) -> Any:
    """A client of the scheduler at this address."""
    dask = _distributed()
    try:
        return dask.Client(address, timeout=10)
    except (OSError, ValueError) as error:
        raise InputError("sweep", [f"no Dask scheduler answers at {address!r} ({error}); start one with `dask scheduler`"]) from None


def workers_of(client: Any, threads: int, retries: int) -> Workers:
    """The workers of a cluster: twice as many tasks as they have threads, at least 4, are in progress; they may join meanwhile."""

    def at_once() -> int:
        return max(2 * sum(client.nthreads().values()), 4)

    return Workers(threads, client.get_executor(pure=False, retries=retries), retries, at_once)
