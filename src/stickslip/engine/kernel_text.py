"""Parts of a kernel's file: its header, and functions on plain numbers with their types (`functions.py` compiles them)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
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

#: What compiles the texts of kernels: their files import it.
_COMPILER = ("addresses", "emit", "expressions", "function_body", "functions")
#: The top of every kernel's file. What the driver calls at an address needs no wrapper for Python.
_HEADER = '''"""Written by stickslip: {label}."""
from numba import boolean, float64, int64, njit, types, void
from numba.extending import intrinsic

from stickslip.engine.addresses import outside
from stickslip.engine.emit import write
from stickslip.engine.functions import b1, b2, f1, f2, f3, i1, i2, write_addressed, write_functions  # {compiler}

CALLED = {{"cache": CACHE, "error_model": "numpy", "nogil": True, "boundscheck": False}}
BORROWING = {{"_nrt": False}}  # the caller owns all arrays, so that Numba need not count who holds them, in atomic steps, at each call
OPTIONS = CALLED | BORROWING | {{"no_cpython_wrapper": True, "no_cfunc_wrapper": True}}
'''

#: What a file needs besides, some of whose functions return several numbers.
_TUPLES = """from numba.core import cgutils

Tuple, UniTuple = types.Tuple, types.UniTuple
"""


#: Functions that stand in one compiled unit (`functions.write_addressed`): of each, Numba would ask as much work as of them all.
_ADDRESSED = """
KINDS = {{
{kinds}}}


@intrinsic
def written(typingctx):
    def emit(context, builder, sig, args):
        return write_addressed(context, builder, KINDS, TEXT, {outside})
    return void(), emit


@njit(void(), **OPTIONS)
def addressed():
    written()
"""


def header(label: str) -> str:
    """The top of a kernel's file: what it imports, and by a checksum with which compiler, so that one file never means two things."""
    return _HEADER.format(label=label, compiler=_compiler())


@lru_cache(1)
def _compiler() -> str:
    folder = resources.files("stickslip.engine")
    return sha256(b"".join((folder / f"{name}.py").read_bytes() for name in _COMPILER)).hexdigest()[:16]


def function(name: str, takes: str, lines: Sequence[str], kind: str = "") -> str:
    """The text of one function, made of lines; what the driver calls is of the type that it has there."""
    body = [f"    {line}" for line in lines or ["return"]]
    return "\n".join([f"@njit({kind or FUNCTIONS[name]})", f"def {name}({takes}):", *body, ""])


def written(functions: dict[str, str], text: str, outside: str = "{}") -> str:
    """The source of some functions of a text that Python calls, each with its types, below the header."""
    several = [_TUPLES] if any("Tuple" in kind for kind in functions.values()) else []
    return "\n\n".join([*several, _held(text), *(_written(*each, outside) for each in functions.items())])


def addressed(names: Iterable[str], text: str, outside: str = "{}") -> str:
    """The source of some of `FUNCTIONS`, of a text or of `outside`: the driver calls them, and Numba compiles them all as one."""
    kinds = "".join(f'    "{name}": {FUNCTIONS[name]},\n' for name in names)
    return "\n\n".join([_held(text), _ADDRESSED.format(kinds=kinds, outside=outside)])


def _held(text: str) -> str:
    """A text in the file of a kernel."""
    held = text.replace("\\", "\\\\")
    return f"TEXT = '''{held}'''"


def kernel_text(name: str) -> str:
    """One of the texts of kernels."""
    return (resources.files("stickslip.engine") / "kernels" / f"{name}.py").read_text("utf-8")


def _written(name: str, kind: str, outside: str) -> str:
    """A function that Python calls."""
    result, _, given = kind.rpartition("(")
    takes = ", ".join(f"a{i}" for i in range(given.count(",") + 1))
    call = f'write_functions(context, builder, sig, args, "{name}", TEXT, {outside})'
    if "Tuple" in result:
        call = f"context.make_tuple(builder, sig.return_type, cgutils.unpack_tuple(builder, {call}))"
    return f"""
@intrinsic
def written_{name}(typingctx, {takes}):
    def emit(context, builder, sig, args):
        return {call}
    return {kind}, emit


@njit({kind}, **CALLED, **BORROWING)
def {name}({takes}):
    return written_{name}({takes})
"""
