"""One change to a formula, in the syntax of its file: what `mutants` tests."""

from __future__ import annotations

import ast
import hashlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "src" / "stickslip"
FORMULAS = tuple(
    f"models/{part}.py" for part in ("friction/*", "drives/*", "machines/*_*", "machines/mechanism", "forces", "robot", "tracks/*")
)
WORDS = (
    "notes",
    "_check",
    "check",
    "given",
    "record",
    "take_damping",
    "together",
    "__repr__",
    "example",
)  # functions of sentences and checks
OTHER = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult, ast.USub: ast.UAdd, ast.And: ast.Or}
OTHER |= {ast.Lt: ast.Gt, ast.Gt: ast.Lt, ast.LtE: ast.Gt, ast.GtE: ast.Lt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.Or: ast.And}
NAMES = {"sin": "cos", "cos": "sin", "maximum": "minimum", "minimum": "maximum", "u1": "u2", "t1": "t2", "a1": "a2", "w1": "w2", "w3": "w1"}


@dataclass(frozen=True)
class Mutant:
    """Change number `change` of a file; `name` says where and what."""

    file: str
    change: int
    name: str


def changes(node: Any) -> Iterator[tuple[str, Any]]:
    """What may be changed about a node of the syntax: a field, and its new value."""
    if any(isinstance(getattr(side, "value", None), str) for side in (getattr(node, "left", None), getattr(node, "right", None))):
        return  # words that are put together are not formulas
    if isinstance(node, (ast.BinOp, ast.UnaryOp, ast.BoolOp)) and type(node.op) in OTHER:
        yield "op", OTHER[type(node.op)]()
    elif isinstance(node, ast.Compare) and type(node.ops[0]) in OTHER:
        yield "ops", [OTHER[type(node.ops[0])](), *node.ops[1:]]
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
        yield "value", node.value * 10 or 1
    elif isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("where", "by_side"):
        yield "args", [node.args[0], node.args[2], node.args[1]]
    elif isinstance(node, ast.Name) and node.id in NAMES and isinstance(node.ctx, ast.Load):
        yield "id", NAMES[node.id]
    elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
        stem, _, side = node.attr.rpartition("_")
        if stem and side in ("plus", "minus"):
            yield "attr", f"{stem}_{'minus' if side == 'plus' else 'plus'}"
        elif node.attr in NAMES:
            yield "attr", NAMES[node.attr]
    elif isinstance(node, ast.Return) and isinstance(node.value, ast.Tuple) and len(node.value.elts) == 2:
        yield "value", ast.Tuple(node.value.elts[::-1], ast.Load())


def places(node: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Nodes of the formulas below one, with the name of the function they stand in; no annotations, messages, f-strings."""
    for child in ast.iter_child_nodes(node):
        inside = path + "." + child.name if isinstance(child, (ast.FunctionDef, ast.ClassDef)) else path
        message = isinstance(child, ast.Call) and getattr(child.func, "attr", "") in ("add", "append")
        if message or isinstance(child, (ast.Raise, ast.JoinedStr, ast.arguments, ast.AnnAssign)) or getattr(child, "name", "") in WORDS:
            continue
        if isinstance(node, ast.FunctionDef) and child in (node.returns, *node.decorator_list):
            continue
        if path and not isinstance(node, ast.ClassDef):
            yield path[1:], child
        yield from places(child, inside)


def mutated(file: str, wanted: int) -> tuple[ast.Module, str]:
    """The syntax of a file with one change, and what it is; `IndexError` beyond the last."""
    tree = ast.parse((SOURCE / file).read_text(encoding="utf-8"))
    found = [(where, node, change) for where, node in places(tree) for change in changes(node)]
    where, node, (field, value) = found[wanted]
    before = ast.unparse(node)
    setattr(node, field, value)
    return ast.fix_missing_locations(tree), f"{file} {where}: {before} -> {ast.unparse(node)}"


def every() -> list[Mutant]:
    """All mutants there are, in an order that depends on nothing but their names."""
    found, seen = [], Counter[str]()
    for file in sorted(str(p.relative_to(SOURCE)) for glob in FORMULAS for p in SOURCE.glob(glob)):
        for change in range(10_000):
            try:
                name = mutated(file, change)[1]
            except IndexError:
                break
            seen[name] += 1
            found.append(Mutant(file, change, name if seen[name] == 1 else f"{name} ({seen[name]})"))
    return sorted(found, key=lambda m: hashlib.sha256(m.name.encode()).digest())
