"""Every period made: what a motion costs that is not told to be the same again."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial


@contextmanager
def whole() -> Iterator[None]:
    """Every period is made, as integrators do it, also of motions that have come back to the same bits."""
    from stickslip.solvers import stepping

    before = stepping.lanes.Job
    stepping.lanes.Job = partial(before, whole=True)  # type: ignore[assignment,misc]
    try:
        yield
    finally:
        stepping.lanes.Job = before  # type: ignore[misc]
