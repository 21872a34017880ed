"""A machine as C99: a held lane (`held_lane.py`) that needs no Python, from the texts of its kernel, and functions of what it holds."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.engine import driver
from stickslip.engine.c_expressions import HELPERS, REAL, WHOLE, View, constant
from stickslip.engine.c_function_body import CFunction
from stickslip.engine.c_functions import AT_POINTS, CProgram
from stickslip.engine.c_lines import c_step
from stickslip.engine.kernel_text import function
from stickslip.engine.kernels import columns
from stickslip.engine.plain_kernels import PlainKernel
from stickslip.engine.symbols import Sym
from stickslip.engine.write import Writer

#: What a function of what a lane holds takes, and the type of each argument.
_HELD = {"row": "f1", "t": "float64", "way": "float64", "y": "f1", "clock": "f1", "mode": "f1", "side": "f1", "seed": "f1", "out": "f1"}
_GOALS = 5  # columns of GOAL (kernels/advancing.py)


@dataclass(frozen=True)
class CMachine:
    """A machine as C.

    Parameters
    ----------
    text : str
        The type ``Lane``, constants, and static functions.
    takes : dict of tuple of str
        Of each further function the names of the arguments that it takes.
    entries : str
        Functions of a lane: ``machine_advance`` makes steps, ``machine_arrive`` passes a known instant, ``machine_constants`` computes
        what depends on the numbers alone.
    """

    text: str
    takes: dict[str, tuple[str, ...]]
    entries: str


def c_machine(k: PlainKernel, further: dict[str, dict[str, Sym]]) -> CMachine:
    """The C of a kernel's held lane, and of further functions.

    Parameters
    ----------
    k : PlainKernel
    further : dict of dict
        By the name of a function what it puts where: expressions of what a lane holds, by the places that get them, such as ``out[0]``.
        A variable that is none of the system's is an argument, or a part of ``seed``, by its name.
    """
    sizes = _sizes(k)
    shared = {
        name: View(f"W->{name}", WHOLE if name in ("JOB", "N") else REAL, tuple(map(constant, shape))) for name, shape in sizes.items()
    }
    plain = driver.plain_texts(k.step.degree)
    texts = {"law_": "\n".join([k.text, *(_text(k, *each) for each in further.items())])}
    texts |= ({"land_": plain["landing"]} if k.layout["SERIES"] else {}) | {"do_": plain["driver"]}
    program = CProgram(texts, shared, {"lane": constant(0)}, k.table, outside={"step": "step"})
    advance, arrive, prelude = (program.function(*each) for each in (("do_", "advance_to"), ("do_", "arrive"), ("law_", "prelude")))
    takes = {name: tuple(list(_HELD)[which] for which, _ in program.function("law_", name).takes) for name in further}
    lines, used = "\n".join(k.step.lines), "\n".join(program.written)
    helpers = "\n".join(line for line in HELPERS.splitlines() if _is_used(line, used + lines)) + "\n"
    parts = [helpers, *([AT_POINTS] if "at_points(" in used else []), _types(k, sizes), c_step(lines, *k.places), *program.written]
    entries = [
        _entry("int64_t machine_advance(Lane *W, int64_t calls)", "return {};", advance, ("W->S", "calls", "W", "")),
        _entry("void machine_arrive(Lane *W)", "{};", arrive, ("0", "W->S", "W", "")),
        _entry("void machine_constants(Lane *W)", "{};", prelude, ("W->PARAM", "W->S + AT_CONSTANTS")),
    ]
    return CMachine("\n".join(parts), takes, "\n".join(entries))


def _entry(head: str, body: str, function: CFunction, given: tuple[str, ...]) -> str:
    call = f"{function.name}({', '.join(given[which] for which, _ in function.takes)})"
    unused = [f"    (void){word};" for word in ("W", "calls") if f" {word}" in f" {head}".replace("*", " ") and word not in call]
    return "\n".join([f"static {head}", "{", *unused, f"    {body.format(call)}", "}", ""])


def _is_used(helper: str, text: str) -> bool:
    name = helper.partition("(")[0].split()[-1]
    written_as = {"shifted_left": "<<", "shifted_right": ">>", "whole_of": "np.int64("}
    return f"{name}(" in text or written_as.get(name, name) in text


def _sizes(k: PlainKernel) -> dict[str, tuple[int, ...]]:
    """The shapes of the arrays that the driver's functions share."""
    n, kept = k.eq.states, k.eq.memories
    return {
        "JOB": (columns.WHOLE + 1,),
        "LIMITS": (columns.BUDGET_OF_STEPS + 1,),
        "N": (1, columns.SEGMENTS),
        "K": (1, columns.SINCE + 1),
        "PARAM": (1, max(len(k.eq.names), 1)),
        "START": (1, 1 + n + kept),
        "PIECES": (1, 4 + k.eq.sides + kept + n * (k.step.degree + 1)),
        "GOAL": (_GOALS,),
    }


def _types(k: PlainKernel, sizes: dict[str, tuple[int, ...]]) -> str:
    """The constants, and what a lane holds."""
    at = k.layout
    named = {
        "STATES": k.eq.states, "COORDINATES": at["COORDINATES"], "CONTACTS": k.eq.sides, "MEMORIES": k.eq.memories,
        "DEGREE": k.step.degree, "NUMBERS": len(k.eq.names), "IMPULSES": len(k.eq.impulses),
        "AT_T": at["F_T"], "AT_END": at["F_TEND"], "AT_WAY": at["F_X"], "AT_Y": at["F_Y"], "AT_SIDE": max(at["F_B"], 0),
        "AT_MODE": max(at["F_MODE"], 0), "AT_CLOCK": max(at["F_CLK"], 0), "AT_PERIOD": at["F_C"] + at["PERIOD"],
        "AT_SPEED": at["F_C"] + at["PERIOD"] + 1,
        "AT_CONSTANTS": at["F_C"],
    }  # fmt: skip
    columns_of = {name: getattr(columns, name) for name in ("CASE", "DONE", "STATUS", "WRITTEN", "RTOL", "SLIP_RATIO", "BUDGET_OF_STEPS")}
    fields = []
    for name, shape in sizes.items():
        length = 1
        for each in shape:
            length *= each
        fields.append(f"    {'int64_t' if name in ('JOB', 'N') else 'double'} {name}[{length}];")
    lines = [f"#define {name} {value}" for name, value in {**named, **columns_of}.items()]
    goals = ("GOAL_PERIOD", "GOAL_TIME", "RENEWED", "EACH_STEP", "BEGUN_ANEW")
    lines += [f"#define {name} {i}" for i, name in enumerate(goals)]
    lines += ["enum { THERE, UNDER_WAY, ENDED };", "", "typedef struct {", f"    double S[{at['FIELDS']}];", *fields, "} Lane;", ""]
    return "\n".join(lines)


def _text(k: PlainKernel, name: str, ends: dict[str, Sym]) -> str:
    """The Python text of one function of what a lane holds."""
    eq, w = k.eq, Writer(prefix="p")
    bind = {number: f"row[{i}]" for i, number in enumerate(eq.names)} | {"t": "t", "way": "way"}
    bind |= {s.name: f"y[{i}]" for i, s in enumerate(eq.y)} | {s.name: f"mode[{i}]" for i, s in enumerate(eq.modes)}
    bind |= {f"b{i}": f"side[{i}]" for i in range(eq.signs)} | {f"clk{i}": f"clock[{i}]" for i in range(len(eq.clocks))}
    bind |= {f"seed{i}": f"seed[{i}]" for i in range(1 + eq.states + len(eq.names))}
    lines = [f"{target} = 1.0 * {w.value(node, bind)}" for target, node in ends.items()]
    return function(name, ", ".join(_HELD), [*w.lines, *lines], f"void({', '.join(_HELD.values())})")
