"""The text of a step: its lines, and the fields that they read and write; `emit.py` writes it as instructions.

Of a Taylor step the lines are only its series (the rest is ``kernels/arcs.py``). A row that a lane holds stands in the fields
``name_0``, ``name_1`` and so on.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from stickslip.engine.kernel_text import StepLines
from stickslip.engine.rosenbrock_step import Step
from stickslip.engine.system import System


@dataclass(frozen=True)
class Layout:
    """Where a lane's fields and its case's numbers stand."""

    lanes: int
    group: int  # lanes of one call of the lines
    width: int  # lanes of a vector
    offsets: dict[str, int]
    constants: int


def step_text(step: Step, at: Layout) -> StepLines:
    """The lines of a step: they read what they ask for, and write those fields of a lane to which they give a value."""
    reads, rows, writes = places_of(step, at)
    return StepLines("\n".join(step.lines), at.lanes, at.group, at.width, reads, rows, writes)


def places_of(step: Step, at: Layout) -> tuple[dict[str, int], dict[str, int], dict[str, int]]:
    """Where a lane has what the lines of a step ask for, the rows that they read and write, and the fields to which they give a value."""
    offsets = {f"_{name}": at.offsets[name] for name in step.fields}
    numbers = {f"_c{i}": at.constants + i * at.lanes for i in range(len(step.case_nodes))}
    rows = {name: offsets[f"{name}_0"] for name in _rows(step.lines)}
    asked, made = {f"_{name}" for name in used(step.lines)} - rows.keys(), _made(step.lines)
    if unknown := asked - offsets.keys() - numbers.keys():
        raise AssertionError(f"the lines of a step ask for {', '.join(sorted(unknown))}, which neither they nor a lane hold")
    reads = {name: offset for name, offset in (offsets | numbers).items() if name in asked}
    return reads, rows, {name: offset for name, offset in offsets.items() if name in made}


# ---- lines ----
def _made(lines: Sequence[str]) -> set[str]:
    """Names that lines give a value to."""
    return {m.group(1) for line in lines if (m := re.match(r"\s*(_\w+) = ", line))}


def _rows(lines: Sequence[str]) -> list[str]:
    """Names of the rows that a lane holds: lines read and write their numbers, and did not make them."""
    names = {name: None for line in lines for name in re.findall(r"(?<![\w.])(_\w+)\[", line)}
    return [name for name in names if name not in _made(lines)]


def used(lines: Sequence[str]) -> set[str]:
    """Names that lines ask for before they give them a value themselves."""
    asked: set[str] = set()
    made: set[str] = set()
    for line in lines:
        name, equals, text = line.strip().partition(" = ")
        asked |= {n[1:] for n in re.findall(r"(?<![\w.])_[A-Za-z]\w*", text if equals else line)} - made
        if equals:
            made.add(name[1:])
    return asked


def bound(eq: System) -> dict[str, str]:
    """The names that lines have for time, states, modes and flags as a lane holds them."""
    names = {"t": "_t"} | {s.name: f"_y{i}" for i, s in enumerate(eq.y)} | {s.name: f"_{s.name}" for s in eq.modes}
    return names | {f"b{k}": f"_b{k}" for k in range(eq.signs)} | {f"clk{k}": f"_clk{k}" for k in range(len(eq.clocks))}


def held(step: Step, lanes: int, lines: Sequence[str]) -> list[str]:
    """Lines that read what others ask for of a lane, from the array S."""
    names = [*(f"_{name}" for name in step.fields), *(f"_c{j}" for j in range(len(step.case_nodes)))]
    asked = used(lines)
    return [f"{name} = S[{i * lanes} + lane]" for i, name in enumerate(names) if name[1:] in asked]
