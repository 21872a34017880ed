"""The lines of a step as one loop over the lanes of a kernel; of a Taylor step only its series (the rest is ``kernels/arcs.py``)."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from stickslip.engine.rosenbrock import Step

__all__ = ["Layout", "step_text", "used", "without_branches"]

_NAME = re.compile(r"(?<![\w.])_(?=[A-Za-z])")


@dataclass(frozen=True)
class Layout:
    """Where a lane's fields and its case's numbers stand."""

    width: int  # lanes of a vector
    groups: int  # vectors whose lines are written in turn
    offsets: dict[str, int]
    constants: int

    @property
    def lanes(self) -> int:
        """All lanes."""
        return self.width * self.groups

    def place(self, name: str) -> str:
        """A field of the lane at hand."""
        return f"S[{self.offsets[name]} + l@]"


def step_text(step: Step, at: Layout) -> str:
    """The source of `step`; of a Taylor step it only writes the series (the driver finds where it ends)."""
    if step.series:
        return _series(step, at)
    writes = _writes(at, [f for f in step.fields if f != "tend"])
    lines = [*_reads(step, at, step.fields, [*step.lines, *writes]), *step.lines, *writes]
    return _function("step", "S, rtol, budget", lines, at)


def _series(step: Step, at: Layout) -> str:
    made = set(_made(step.lines))
    inputs = [f for f in step.fields if f not in made]
    return _function(
        "step",
        "S, rtol, budget",
        [*_reads(step, at, inputs, step.lines), *step.lines, *_writes(at, [f for f in step.fields if f in made])],
        at,
    )


# ---- lines ----
def _reads(step: Step, at: Layout, fields: Iterable[str], lines: Sequence[str]) -> list[str]:
    asked = used(lines)
    reads = [f"_{name} = {at.place(name)}" for name in fields if name in asked]
    return reads + [f"_c{i} = S[{at.constants + i * at.lanes} + l@]" for i in range(len(step.case_nodes)) if f"c{i}" in asked]


def _writes(at: Layout, fields: Iterable[str]) -> list[str]:
    return [f"{at.place(name)} = _{name}" for name in fields]


def _made(lines: Sequence[str]) -> list[str]:
    """Names that lines give a value to, each once."""
    return list(dict.fromkeys(m.group(1) for line in lines if (m := re.match(r"\s*_(\w+) = ", line))))


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


# ---- functions ----
def _function(name: str, arguments: str, lines: Sequence[str], at: Layout) -> str:
    """A loop over the lanes of a vector, with the lines of all vectors in turn: their chains hide each other's latency."""
    types = ", ".join("float64[::1]" if a == "S" else "float64" for a in arguments.split(", "))
    text = [f'@njit("void({types})", **OPTIONS)', f"def {name}({arguments}):", f"    for l in range({at.width}):"]
    for line in lines:
        for g in range(at.groups):
            renamed = _NAME.sub(f"_{'abcd'[g]}_", line)
            text.append("        " + renamed.replace("l@", "l" if g == 0 else f"l + {g * at.width}"))
    return without_branches("\n".join(text))


class _Selects(ast.NodeTransformer):
    """Decisions inside expressions as calls that are one instruction each: the compiler then sees no branches to join again."""

    def visit_IfExp(self, node: ast.IfExp) -> ast.AST:
        self.generic_visit(node)
        return ast.Call(ast.Name("choose", ast.Load()), [node.test, node.body, node.orelse], [])

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.AST:
        self.generic_visit(node)
        joined = node.values[0]
        for value in node.values[1:]:
            joined = ast.BinOp(joined, ast.BitAnd() if isinstance(node.op, ast.And) else ast.BitOr(), value)
        return joined


def without_branches(text: str) -> str:
    """A text with all decisions inside expressions turned into such calls."""
    return ast.unparse(ast.fix_missing_locations(_Selects().visit(ast.parse(text))))
