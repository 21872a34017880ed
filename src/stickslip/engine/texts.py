"""Plain Python that kernels share with the rest: numbers and functions of a module, compiled as they stand."""

from __future__ import annotations

import inspect
from functools import lru_cache
from typing import Any

from stickslip.basics.status import Status
from stickslip.engine import cache
from stickslip.engine.kernel_text import header, kernel_text, written
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
    functions = [
        f'@njit("{signature}", **OPTIONS)\n{inspect.getsource(getattr(recurrences, name))}' for name, signature in _RECURRENCE.items()
    ]
    return "\n".join([*_numbers(), *functions])


def _numbers() -> list[str]:
    return ["Any = object", *(f"{name} = {value!r}" for name, value in vars(recurrences).items() if isinstance(value, (int, float)))]


def _asked(*names: str) -> str:
    """Some functions of the test of strobe points, as one piece each with all that they call."""
    kinds = {name: _RECURRENCE[name].replace("float64[:, ::1]", "f2").replace("float64[::1]", "f1") for name in names}
    return written(kinds, recurrence_text())


@lru_cache(1)
def status_text() -> str:
    """The names of `stickslip.basics.status.Status`, for a kernel."""
    return "\n".join(f"{status.name} = {status}" for status in Status)


@lru_cache
def coulomb_text(*names: str) -> str:
    """The mode machine of ``kernels/coulomb_harmonic.py``, and other texts after it."""
    return "\n\n".join([header("Coulomb × Harmonic"), status_text(), *map(kernel_text, ("coulomb_harmonic", *names))])


@lru_cache(1)
def coulomb_runs_text() -> str:
    """The mode machine, the test of strobe points and the runs that ask for it."""
    each_period = f'@njit("{_RECURRENCE["apart"]}", **OPTIONS)\n{inspect.getsource(recurrences.apart)}'
    first, runs = coulomb_text("coulomb_harmonic_looks"), kernel_text("coulomb_harmonic_runs")
    return "\n\n".join([first, *_numbers(), _asked("period_number", "outcome"), each_period, runs])


@lru_cache(1)
def recurrence() -> Any:
    """The functions of `stickslip.results.recurrence`, compiled."""
    text = header("the test of strobe points") + _asked("period_number", "approach", "outcome")
    return cache.load(text, "recurrence", "the test of strobe points")
