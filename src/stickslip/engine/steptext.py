"""The text of a step as its kernel's file holds it: lines, what they read and write of a lane, and the one call that Numba sees.

The lines are not read by Numba; `emit.py` turns them into instructions. Of a Taylor step they are only its series (the rest is
``kernels/arcs.py``). A row that a lane holds stands in the fields ``name_0``, ``name_1`` and so on.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Sequence
from dataclasses import dataclass

from stickslip.engine.rosenbrock import Step
from stickslip.engine.texts import emit_text

__all__ = ["Layout", "step_text", "used", "without_branches"]

_STEP = """
@intrinsic
def instructions(typingctx, S, rtol, budget):
    def emit(context, builder, sig, args):
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        write(builder, data, L, WIDTH, {"rtol": args[1], "budget": args[2]}, READS, ROWS, LINES, WRITES)
        return context.get_dummy_value()
    return types.void(S, types.float64, types.float64), emit


@njit("void(float64[::1], float64, float64)", **OPTIONS)
def step(S, rtol, budget):
    instructions(S, rtol, budget)
"""


@dataclass(frozen=True)
class Layout:
    """Where a lane's fields and its case's numbers stand."""

    lanes: int
    width: int  # lanes of a vector
    offsets: dict[str, int]
    constants: int


def step_text(step: Step, at: Layout) -> str:
    """The source of `step`: it reads what its lines ask for, and writes those fields of a lane to which they give a value."""
    places = {f"_{name}": at.offsets[name] for name in step.fields}
    numbers = {f"_c{i}": at.constants + i * at.lanes for i in range(len(step.case_nodes))}
    asked, made = {f"_{name}" for name in used(step.lines)}, _made(step.lines)
    if unknown := asked - places.keys() - numbers.keys():
        raise AssertionError(f"the lines of a step ask for {', '.join(sorted(unknown))}, which neither they nor a lane hold")
    reads = {name: place for name, place in (places | numbers).items() if name in asked}
    writes = {name: place for name, place in places.items() if name in made}
    lines = "\n".join(step.lines)
    rows = {name: places[f"{name}_0"] for name in _rows(step.lines)}
    tables = [_table("READS", reads), _table("ROWS", rows), _table("WRITES", writes)]
    return "\n".join([emit_text(), f"WIDTH = {at.width}", f'LINES = """\n{lines}\n"""', *tables, _STEP])


def _table(name: str, places: dict[str, int]) -> str:
    """A table of places, a line for each."""
    return "\n".join([f"{name} = {{", *(f'    "{field}": {place},' for field, place in places.items()), "}"])


# ---- lines ----
def _made(lines: Sequence[str]) -> set[str]:
    """Names that lines give a value to."""
    return {m.group(1) for line in lines if (m := re.match(r"\s*(_\w+) = ", line))}


def _rows(lines: Sequence[str]) -> list[str]:
    """Names of the rows that a lane holds: lines put numbers into them which they did not make themselves."""
    filled = {m.group(1): None for line in lines if (m := re.match(r"\s*(_\w+)\[", line))}
    return [name for name in filled if name not in _made(lines)]


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


# ---- what Numba reads ----
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
