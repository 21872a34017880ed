"""Plain Python that kernels share with the rest: the text of a module, its functions compiled as they stand."""

from __future__ import annotations

import re
from functools import lru_cache
from importlib import resources
from typing import Any

from stickslip.basics.status import Status
from stickslip.engine import cache

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
    """The functions of `stickslip.results.recurrence`, for a kernel that has imported njit and named its OPTIONS."""
    text = (resources.files("stickslip.results") / "recurrence.py").read_text(encoding="utf-8")
    body = text[text.index("\nLONGEST") :]
    for name, signature in _RECURRENCE.items():
        body = re.sub(rf"^def {name}\(", f'@njit("{signature}", **OPTIONS)\ndef {name}(', body, flags=re.MULTILINE)
    return "Any = object\n" + body


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
def emit_text() -> str:
    """The compiler of a step's lines, `stickslip.engine.emit`, for a kernel's file below `functions_text`."""
    return _from_imports("emit")


@lru_cache(1)
def functions_text() -> str:
    """The compiler of functions, `stickslip.engine.functions`, for a kernel's file."""
    return _from_imports("functions")


def _from_imports(name: str) -> str:
    """The text of a module of the engine from its imports on, without what it has from other modules of ours."""
    text = (resources.files("stickslip.engine") / f"{name}.py").read_text(encoding="utf-8")
    return re.sub(r"^from stickslip.*\n", "", text[text.index("\nimport ast") + 1 :], flags=re.MULTILINE)


@lru_cache(1)
def recurrence() -> Any:
    """The functions of `stickslip.results.recurrence`, compiled."""
    head = 'from numba import njit\n\nOPTIONS = {"cache": CACHE, "error_model": "numpy", "nogil": True}\n'
    return cache.load(head + recurrence_text(), "recurrence", "the test of strobe points")
