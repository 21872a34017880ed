"""The lines of a step as C99: what `emit.py` writes as LLVM instructions, for one lane, from the same text and with the same bits."""

from __future__ import annotations

import ast
from typing import Any

from stickslip.engine.c_expressions import REAL, WHOLE, CExpressions, Value, bare, constant, without_unread
from stickslip.engine.emit import ROUNDS


def c_step(text: str, reads: dict[str, int], rows: dict[str, int], writes: dict[str, int]) -> str:
    r"""The function ``step`` of some lines: it reads fields of the array S, and writes those to which lines give a value.

    Parameters
    ----------
    text : str
        The lines.
    reads, rows, writes : dict of int
        Where in S a field, or the first of a row of fields, stands, by the names that lines have for it.

    Examples
    --------
    >>> print(c_step("_y = _x * rtol\n", {"_x": 3}, {}, {"_y": 4}))
    static void step(double *S, double rtol, double budget)
    {
        double _x = 0.0, _y = 0.0;
        (void)budget;
        _x = S[3];
        _y = _x * rtol;
        S[4] = _y;
    }
    <BLANKLINE>
    """
    return _Lines(text, reads, rows, writes).whole()


class _Lines(CExpressions):
    where = "a line of a step"

    def __init__(self, text: str, reads: dict[str, int], rows: dict[str, int], writes: dict[str, int]):
        self.kinds = dict.fromkeys((*reads, *writes), REAL) | {"rtol": REAL, "budget": REAL}
        self.own = {name: REAL for name in (*reads, *writes)}
        self.counters = dict[str, Value]()
        self.rows = {name: f"S[{at}" for name, at in rows.items()}
        self.rooms, self.lines, self.indent, self.count = list[str](), list[str](), "    ", 0
        for name in dict.fromkeys((*reads, *(name for name in writes if name in reads))):
            self.line(f"{name} = S[{reads[name]}];")
        self.write(ast.parse(text).body)
        for name, at in writes.items():
            self.line(f"S[{at}] = {name};")

    def whole(self) -> str:
        """All of it."""
        lines, own = without_unread(self.lines, self.own)
        slots = []
        for kind, blank in ((REAL, "0.0"), (WHOLE, "0"), ("bool", "false")):
            names = [f"{name} = {blank}" for name, of in own.items() if of == kind]
            slots += [f"    {kind} {', '.join(names[k : k + 8])};" for k in range(0, len(names), 8)]
        body = "\n".join(lines)
        unused = [f"    (void){name};" for name in ("rtol", "budget") if name not in body]
        rooms = [f"    {room}" for room in self.rooms]
        return "\n".join(["static void step(double *S, double rtol, double budget)", "{", *rooms, *slots, *unused, *lines, "}", ""])

    def line(self, text: str) -> None:
        self.lines.append(f"{self.indent}{text}")

    def write(self, statements: list[ast.stmt]) -> None:
        for statement in statements:
            self.visit(statement)

    def block(self, head: str, statements: list[ast.stmt]) -> None:
        self.line(f"{head} {{")
        self.indent += "    "
        self.write(statements)
        self.indent = self.indent[:-4]
        self.line("}")

    def visit_Assign(self, node: ast.Assign) -> None:
        (target,) = node.targets
        if isinstance(target, ast.Subscript):
            self.line(f"{self.in_row(target)} = {bare(self.as_kind(node, self.visit(node.value), REAL))};")
        elif isinstance(node.value, ast.Call) and ast.unparse(node.value.func) == "row":
            name = target.id  # type: ignore[attr-defined]
            own = f"row{len(self.rooms)}{name}"
            self.rooms.append(f"double {own}[{self.visit(node.value.args[0])}];")
            self.rows[name] = f"{own}["
        else:
            self.give(target.id, self.visit(node.value), node)  # type: ignore[attr-defined]

    def give(self, name: str, value: Value, node: ast.AST) -> None:
        if self.kinds.setdefault(name, value.kind) != value.kind:
            value = self.as_kind(node, value, self.kinds[name])
        self.own.setdefault(name, self.kinds[name])
        self.line(f"{name} = {bare(value)};")

    def in_row(self, node: ast.Subscript) -> str:
        """The place of one number of a row."""
        begin, at = self.rows[ast.unparse(node.value)], self.visit(node.slice)
        held = begin.removeprefix("S[") if begin.startswith("S[") else ""
        if not held:
            return f"{begin}{bare(at)}]"
        return f"S[{int(held) + at.known}]" if at.known is not None else f"S[{held} + {at}]"

    def visit_If(self, node: ast.If) -> None:
        test = node.test
        if isinstance(test, ast.Call) and ast.unparse(test.func) == "more":  # of one lane: whether it wants this
            test = test.args[0]
        self.block(f"if ({bare(self.condition(test))})", node.body)

    def visit_For(self, node: ast.For) -> None:
        called, name = node.iter, node.target.id  # type: ignore[attr-defined]
        over, args = ast.unparse(called.func), called.args  # type: ignore[attr-defined]
        before = self.counters.get(name)
        if over in ROUNDS:
            for k in ROUNDS[over](*(self.visit(each).known for each in args)):
                self.counters[name] = constant(k)
                self.write(node.body)
        else:
            self.count += 1
            counter = f"n{self.count}"
            first, end = (constant(0), self.visit(args[1])) if over == "while_any" else map(self.visit, args)
            self.counters[name] = Value(counter, WHOLE)
            head = f"for (int64_t {counter} = {bare(first)}; {counter} < {end}; {counter}++)"
            if over == "while_any":
                self.line(f"{head} {{")
                self.indent += "    "
                self.line(f"if (!({bare(self.condition(args[0]))})) {{ break; }}")
                self.write(node.body)
                self.indent = self.indent[:-4]
                self.line("}")
            else:
                self.block(head, node.body)
        self.counters.pop(name, None)
        if before is not None:
            self.counters[name] = before

    def visit_Name(self, node: ast.Name) -> Any:
        if node.id in self.counters:
            return self.counters[node.id]
        return Value(node.id, self.kinds[node.id]) if node.id in self.kinds else self.refuse(node, "has no value")

    def visit_Subscript(self, node: ast.Subscript) -> Any:
        return Value(self.in_row(node), REAL)

    def visit_Call(self, node: ast.Call) -> Any:
        name, args = ast.unparse(node.func), [self.visit(each) for each in node.args]
        if name == "bits":  # a truth value of each lane in one number: of one lane the number 1 as bits
            return Value(f"as_float((int64_t){args[0]})", REAL)
        return self.function(node, name, args)
