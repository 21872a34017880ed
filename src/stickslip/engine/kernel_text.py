"""What a kernel is made of: functions on plain numbers with their types, which `machine_code.py` compiles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from hashlib import sha256
from importlib import resources

#: What the driver calls by address, and their types: to `signals` in a law's kernel. `look` does what its first argument says (LOOKS).
FUNCTIONS = {
    "prelude": "void(f1, f1)",  # row, constants
    # what, row, t, y, clock, mode, out
    "look": "void(int64, f1, float64, f1, f1, f1, f1)",
    "work": "float64(int64, f1, f1)",  # lane, S, row
    "step": "void(f1, float64, float64)",  # S, rtol, budget
    "switched": "int64(int64, int64, f1)",  # which, lane, S
    "slopes": "void(int64, f1, f1)",  # lane, S, instants and states; none where a Taylor step hides nothing
    "sizes": "void(int64, f1, f1)",  # lane, S, sizes of the terms of rates (roundings.py)
    "signals": "void(f1, float64, f1, f1, f1)",  # row, t, y, what the step held, out
    "land": "void(f1, float64, i1)",  # S, budget, table; the same for all laws that go by Taylor steps
    # reducing.py, for machines of several parts: lane, S, row, W, table
    "begin_parts": "void(int64, f1, int64, i1)",
    "begin_signals": "void(int64, int64, i1)",
    "hold": "void(int64, f1, int64, i1)",
    "reduce_step": "void(int64, f1, f1, int64, i1)",
    "widen": "void(int64, f1, f1, int64, i1)",
    "widen_all": "void(f1, int64, i1)",
    "note_parts": "void(int64, int64, f1, int64, i1)",
    # changes.py, for tangents
    "rates_now": "void(int64, float64, f1, f1, f1, i1)",
    "settle_changes": "void(int64, f1, f1, i1)",
    "note_late": "boolean(int64, f1, f1, i1)",
    "shift_changes": "void(int64, boolean, boolean, f1, f1, f1, f1, i1)",
}
LOOKS = ("CLOCK_SIGNS", "FIRST_MODES", "GUARD_VALUES", "PASSED_REST", "RATES", "RESTING_CHANGES", "SAMPLE")

#: What compiles the texts of kernels.
_COMPILER = ("addresses", "emit", "entries", "expressions", "function_body", "functions", "instructions", "machine_code", "signatures")


@dataclass(frozen=True)
class StepLines:
    """The lines of a step, and where they have what they read and write (`emit.py` writes them as instructions)."""

    lines: str
    lanes: int
    group: int  # lanes of one call of the lines
    width: int  # lanes of a vector
    reads: dict[str, int]  # where the fields of names stand
    rows: dict[str, int]
    writes: dict[str, int]


@dataclass(frozen=True)
class KernelSource:
    """What is compiled as one piece.

    Parameters
    ----------
    text : str
        Functions and constants (`functions.py`).
    entries : dict
        Functions that are called from outside, by Python or, at their addresses, by the driver, with their types.
    step : StepLines, optional
        What the function `step` is made of.
    calls, shared : dict
        What the text calls at addresses and takes of shared arrays (`addresses.py`), with their types.
    short_loops : bool
        Its loops have few rounds over numbers that stand apart, which vectors gather far more slowly than they are read one by one.
    """

    text: str
    entries: dict[str, str]
    step: StepLines | None = None
    calls: dict[str, str] = field(default_factory=dict)
    shared: dict[str, str] = field(default_factory=dict)
    short_loops: bool = False

    @cached_property
    def digest(self) -> str:
        """A checksum of all this and of what compiles it."""
        return sha256(f"{compiler()}{self!r}".encode()).hexdigest()[:20]


@lru_cache(1)
def compiler() -> str:
    """A checksum of what compiles the texts of kernels."""
    folder = resources.files("stickslip.engine")
    return sha256(b"".join((folder / f"{name}.py").read_bytes() for name in _COMPILER)).hexdigest()[:16]


def function(name: str, takes: str, lines: Sequence[str], kind: str = "") -> str:
    """The text of one function, made of lines; what the driver calls is of the type that it has there."""
    body = [f"    {line}" for line in lines or ["return"]]
    return "\n".join([f"@typed({kind or FUNCTIONS[name]})", f"def {name}({takes}):", *body, ""])


def kernel_text(name: str) -> str:
    """One of the texts of kernels."""
    return (resources.files("stickslip.engine") / "kernels" / f"{name}.py").read_text("utf-8")
