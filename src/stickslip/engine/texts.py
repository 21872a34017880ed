"""Plain Python that kernels share with the rest: numbers and functions of a module, compiled as they stand."""

from __future__ import annotations

import inspect
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

from stickslip.basics.status import Status
from stickslip.engine import cache
from stickslip.engine.kernel_text import KernelSource, kernel_text
from stickslip.results import recurrence as recurrences

_POINTS = "f2, int64"
_RECURRENCE = {
    "difference": "float64(float64, float64, float64, float64)",
    "apart": f"float64({_POINTS}, int64, int64, f1)",
    "stretch": f"int64({_POINTS}, int64, int64, f1, float64)",
    "closing": f"UniTuple(float64, 2)({_POINTS}, int64, int64, f1)",
    "dying": f"boolean({_POINTS}, int64, int64, f1)",
    "heading": f"float64({_POINTS}, int64, int64, f1)",
    "exact": f"int64({_POINTS}, int64, int64, f1, float64)",
    "period_number": f"UniTuple(int64, 2)({_POINTS}, int64, int64, f1, float64, float64)",
    "approach": f"int64({_POINTS}, int64, int64, f1)",
    "limit": f"float64({_POINTS}, int64, int64, f1, boolean)",
    "steady": "boolean(float64, float64, float64, float64)",
    "outcome": f"Tuple((int64, float64))({_POINTS}, int64, int64, f1, float64, float64)",
}


@lru_cache(1)
def recurrence_text() -> str:
    """The numbers and functions of `stickslip.results.recurrence`, for a kernel."""
    functions = [f'@typed("{signature}")\n{inspect.getsource(getattr(recurrences, name))}' for name, signature in _RECURRENCE.items()]
    return "\n".join([*_numbers(), *functions])


def _numbers() -> list[str]:
    return ["Any = object", *(f"{name} = {value!r}" for name, value in vars(recurrences).items() if isinstance(value, (int, float)))]


@lru_cache(1)
def status_text() -> str:
    """The names of `stickslip.basics.status.Status`, for a kernel."""
    return "\n".join(f"{status.name} = {status}" for status in Status)


def _coulomb(functions: dict[str, str], *texts: str) -> KernelSource:
    """Functions of the mode machine of ``kernels/coulomb_harmonic.py`` and of the texts after it, for Python."""
    machine = map(kernel_text, ("coulomb_harmonic", "coulomb_harmonic_looks"))
    return KernelSource("\n\n".join([status_text(), *machine, *texts]), functions)


@lru_cache(1)
def coulomb_orbits_text() -> KernelSource:
    """The mode machine and its periodic motions by formula."""
    return _coulomb({"orbits": "void(f2, i1, int64, int64, float64, f2, i2, f2, b2)"}, kernel_text("coulomb_orbits"))


@lru_cache(1)
def coulomb_runs_text() -> KernelSource:
    """The mode machine, the test of strobe points and the runs that ask for it."""
    functions = {
        "run": "void(f2, int64, int64, int64, int64, boolean, boolean, float64, f2, i2, f2, b2)",
        "record": "UniTuple(int64, 2)(f1, f1, int64, int64, i1, f2, i1)",
    }
    return _coulomb(functions, recurrence_text(), kernel_text("coulomb_harmonic_runs"))


@lru_cache(1)
def recurrence() -> Any:
    """The functions of `stickslip.results.recurrence`, compiled."""
    names = ("period_number", "approach", "outcome")
    source = KernelSource(recurrence_text(), {name: _RECURRENCE[name] for name in names})
    kernel = cache.load(source, "recurrence", "the test of strobe points")
    return SimpleNamespace(**{name: kernel[name] for name in names})
