"""A machine in C with one interface for all machines: functions ``machine_…`` of a ``Lane``, for whoever steps it (`c_machine.py`)."""

from __future__ import annotations

import re
from collections.abc import Sequence

from stickslip.engine.c_machine import CMachine, c_machine
from stickslip.engine.c_quantities import Quantities, Quantity, along_seeds
from stickslip.engine.plain_kernels import PlainKernel
from stickslip.engine.symbols import Sym
from stickslip.engine.taylor import watched

_GIVEN = {
    "row": "W->PARAM", "t": "W->S[AT_T]", "way": "way", "y": "W->S + AT_Y", "clock": "W->S + AT_CLOCK", "mode": "W->S + AT_MODE",
    "side": "W->S + AT_SIDE", "seed": "seed", "out": "out",
}  # fmt: skip


def interface(k: PlainKernel, read: Quantities, outputs: Sequence[Quantity]) -> str:
    """The C of a machine: its values are its states, their rates, and these outputs."""
    eq = k.eq
    values = [*(state.node for state in read.states), *read.rates, *(output.node for output in outputs)]
    along, guards = along_seeds(eq, eq.cyclic), watched(eq)
    held = [eq.graph.multiply(eq.graph.mode(f"b{g}"), eq.guards[g]) if g < eq.signs else eq.guards[g] for g in guards]
    rates = [
        eq.graph.multiply(eq.graph.mode(f"b{g}"), eq.guard_rates[g]) if g < eq.signs else eq.guard_rates[g] for g in guards
    ]  # fmt: skip
    further = {
        "offsets": _out(eq.offsets), "values": _out(values), "tangent": _out(list(map(along.of, values))),
        "held_guards": _out(held), "held_guard_rates": _out(rates), "nominals": _out(read.sizes),
    }  # fmt: skip
    for which, g in enumerate(guards):
        if g in eq.switches:
            news = enumerate([*eq.switches[g].modes, *eq.switches[g].states])
            further[f"outcome_{which}"] = {f"out[{i}]": new for i, new in news if new is not None}
    made = c_machine(k, further)
    functions = [
        _function(made, "offsets", "machine_offsets", "double *row, double *out", {"row": "row"}),
        _function(made, "values", "machine_values", "Lane *W, double way, double *out"),
        _function(made, "tangent", "machine_tangent", "Lane *W, double way, double *seed, double *out"),
        _function(made, "held_guards", "machine_guards", "Lane *W, double *out"),
        _function(made, "held_guard_rates", "machine_guard_rates", "Lane *W, double *out"),
        _function(made, "nominals", "machine_nominals", "Lane *W, double *out"),
        _switches(k, made, guards),
        made.entries,
    ]
    return "\n".join([f"#define N_WATCHED {len(guards)}", made.text, *functions])


def _out(nodes: Sequence[Sym]) -> dict[str, Sym]:
    return {f"out[{i}]": node for i, node in enumerate(nodes)}


def _function(made: CMachine, law: str, name: str, takes: str, given: dict[str, str] | None = None) -> str:
    """A function that calls one of the law's with what a lane holds."""
    call = f"law_{law}({', '.join((_GIVEN | (given or {}))[each] for each in made.takes[law])});"
    words = [part.split()[-1].lstrip("*") for part in takes.split(", ")]
    unused = [word for word in words if not re.search(rf"\b{word}\b", call)]
    return "\n".join([f"static void {name}({takes})", "{", *(f"    (void){word};" for word in unused), f"    {call}", "}", ""])


def _switches(k: PlainKernel, made: CMachine, guards: Sequence[int]) -> str:
    """What the zero of each guard does: modes and states, or its flag; the status of a run that ends there."""
    eq, lines = k.eq, list[str]()
    for which, g in enumerate(guards):
        lines.append(f"    case {which}:")
        switch = eq.switches.get(g)
        if switch is not None:
            given = ", ".join(_GIVEN[each] for each in made.takes[f"outcome_{which}"])
            lines.append(f"        law_outcome_{which}({given});")
            modes = [i for i, (old, new) in enumerate(zip(eq.modes, switch.modes, strict=True)) if new is not old]
            lines += [f"        W->S[AT_MODE + {i}] = out[{i}];" for i in modes]
            states = [i for i, new in enumerate(switch.states) if new is not None]
            lines += [f"        W->S[AT_Y + {i}] = out[{len(eq.modes) + i}];" for i in states]
        if g < eq.signs:
            lines.append(f"        W->S[AT_SIDE + {g}] = -W->S[AT_SIDE + {g}];")
        lines.append(f"        return {0 if switch is None else int(switch.status)};")
    return "\n".join(
        [
            "static int machine_switch(Lane *W, int which)",
            "{",
            f"    double out[{max(len(eq.modes) + eq.states, 1)}];",
            "    (void)out, (void)W;",
            "    switch (which) {",
            *lines,
            "    default:",
            "        return 0;",
            "    }",
            "}",
            "",
        ]
    )
