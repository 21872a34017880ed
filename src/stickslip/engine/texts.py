"""Plain Python that kernels share with the rest: numbers and functions of a module, compiled as they stand."""

from __future__ import annotations

import inspect
from functools import lru_cache
from importlib import resources
from typing import Any

from stickslip.basics.status import Status
from stickslip.engine import cache
from stickslip.results import recurrence as recurrences

_POINTS = "float64[:, ::1], int64"
_RECURRENCE = {
    "apart": f"float64({_POINTS}, int64, int64, float64[::1])",
    "stretch": f"int64({_POINTS}, int64, int64, float64[::1], float64)",
    "closing": f"UniTuple(float64, 2)({_POINTS}, int64, int64, float64[::1])",
    "dying": f"boolean({_POINTS}, int64, int64, float64[::1])",
    "heading": f"float64({_POINTS}, int64, int64, float64[::1])",
    "exact": f"int64({_POINTS}, int64, int64, float64[::1], float64)",
    "period_number": f"UniTuple(int64, 2)({_POINTS}, int64, int64, float64[::1], float64, float64)",
    "approach": f"int64({_POINTS}, int64, int64, float64[::1])",
    "limit": f"float64({_POINTS}, int64, int64, float64[::1], boolean)",
    "steady": "boolean(float64, float64, float64, float64)",
    "outcome": f"Tuple((int64, float64))({_POINTS}, int64, int64, float64[::1], float64, float64)",
}


@lru_cache(1)
def recurrence_text() -> str:
    """The numbers and functions of `stickslip.results.recurrence`, for a kernel that has imported njit and named its OPTIONS."""
    numbers = [f"{name} = {value!r}" for name, value in vars(recurrences).items() if isinstance(value, (int, float))]
    functions = [
        f'@njit("{signature}", **OPTIONS)\n{inspect.getsource(getattr(recurrences, name))}' for name, signature in _RECURRENCE.items()
    ]
    return "\n".join(["Any = object", *numbers, *functions])


@lru_cache(1)
def status_text() -> str:
    """The names of `stickslip.basics.status.Status`, for a kernel."""
    return "\n".join(f"{status.name} = {status}" for status in Status)


@lru_cache
def coulomb_text(*names: str) -> str:
    """The mode machine of ``kernels/coulomb_harmonic.py``, the test of strobe points, and other texts after them."""
    folder = resources.files("stickslip.engine") / "kernels"
    first, *more = ((folder / f"{name}.py").read_text(encoding="utf-8") for name in ("coulomb_harmonic", *names))
    return "\n\n".join([first, status_text(), recurrence_text(), *more])


@lru_cache(1)
def recurrence() -> Any:
    """The functions of `stickslip.results.recurrence`, compiled."""
    head = 'from numba import njit\n\nOPTIONS = {"cache": CACHE, "error_model": "numpy", "nogil": True}\n'
    return cache.load(head + recurrence_text(), "recurrence", "the test of strobe points")
