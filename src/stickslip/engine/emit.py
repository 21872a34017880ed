"""Lines of straight text as LLVM instructions: all lanes of a kernel as one vector, or plain numbers for one lane.

Numba needs most of a step's compile time to read its lines, LLVM little to compile them. So Numba sees one call, of an intrinsic that
writes the instructions itself (`steptext.py`). A kernel's file holds this text from the imports on, and needs nothing else.

The lines are Python and mean what Python means by them, on floats, 64-bit whole numbers and conditions: ``name = expression``, and, for
one lane, ``if condition:`` around some. Every decision inside an expression is one select instruction, and nothing is fused or
reordered that is not written so: the bits do not depend on the number of lanes.
"""

from __future__ import annotations

import ast
import math
from typing import Any

from llvmlite import ir

REAL = {ast.Add: "fadd", ast.Sub: "fsub", ast.Mult: "fmul", ast.Div: "fdiv"}
WHOLE = {ast.Add: "add", ast.Sub: "sub", ast.LShift: "shl", ast.RShift: "ashr", ast.BitXor: "xor"}
JOIN = {ast.And: "and_", ast.Or: "or_"}
COMPARE = {ast.Gt: ">", ast.Lt: "<", ast.GtE: ">=", ast.LtE: "<=", ast.Eq: "==", ast.NotEq: "!="}
FUNCTIONS = {"fma": "llvm.fma", "abs": "llvm.fabs", "math.sqrt": "llvm.sqrt"}
TAKES = {"fma": 3, "abs": 1, "math.sqrt": 1}
CASTS = {"as_bits": ("bitcast", "real", "whole"), "as_float": ("bitcast", "whole", "real"), "np.int64": ("fptosi", "real", "whole")}


class _Vector(ast.NodeVisitor):
    """Writes lines as instructions on one vector of lanes; `known` has the value of each name."""

    def __init__(self, builder: Any, data: Any, first: int, lanes: int) -> None:
        self.builder, self.data, self.first, self.lanes, self.known = builder, data, first, lanes, {}
        kinds = (ir.DoubleType(), ir.IntType(64), ir.IntType(1))
        self.real, self.whole, self.truth = kinds if lanes == 1 else (ir.VectorType(kind, lanes) for kind in kinds)

    # ---- numbers in and out ----
    def spread(self, name: str, number: Any) -> None:
        """One number for all lanes."""
        if self.lanes > 1:
            nothing, zero = ir.Constant(self.real, ir.Undefined), ir.IntType(32)
            first = self.builder.insert_element(nothing, number, ir.Constant(zero, 0))
            number = self.builder.shuffle_vector(first, nothing, ir.Constant(ir.VectorType(zero, self.lanes), [0] * self.lanes))
        self.known[name] = number

    def read(self, name: str, at: int) -> None:
        """What the lanes have in the field that begins at `at`."""
        self.known[name] = self.builder.load(self.place(at), align=8)

    def keep(self, name: str, at: int) -> None:
        """Put it there."""
        self.builder.store(self.known[name], self.place(at), align=8)

    def place(self, at: int) -> Any:
        place = self.builder.gep(self.data, [ir.Constant(ir.IntType(64), at + self.first)])
        return self.builder.bitcast(place, self.real.as_pointer())

    def constant(self, kind: Any, value: Any) -> Any:
        return ir.Constant(kind, value if self.lanes == 1 else [value] * self.lanes)

    # ---- statements ----
    def visit_Assign(self, node: ast.Assign) -> None:
        (target,) = node.targets
        if not isinstance(target, ast.Name):
            self.generic_visit(node)
        self.known[target.id] = self.visit(node.value)

    def visit_If(self, node: ast.If) -> None:
        """A branch; a name that had a value before has one of two after it."""
        if self.lanes > 1 or node.orelse:
            self.generic_visit(node)
        condition, before, start = self.visit(node.test), self.known, self.builder.block
        self.known = dict(before)
        with self.builder.if_then(condition):
            for statement in node.body:
                self.visit(statement)
            end = self.builder.block
        within, self.known = self.known, before
        for name in [name for name, value in before.items() if within[name] is not value]:
            joined = self.builder.phi(before[name].type)
            joined.add_incoming(before[name], start)
            joined.add_incoming(within[name], end)
            self.known[name] = joined

    # ---- expressions ----
    def visit_Constant(self, node: ast.Constant) -> Any:
        kind = {bool: self.truth, int: self.whole, float: self.real}.get(type(node.value))
        return self.generic_visit(node) if kind is None else self.constant(kind, node.value)

    def visit_Name(self, node: ast.Name) -> Any:
        return self.known[node.id] if node.id in self.known else self.generic_visit(node, "has no value")

    def visit_Attribute(self, node: ast.Attribute) -> Any:
        values = {"math.nan": math.nan, "math.inf": math.inf}
        name = ast.unparse(node)
        return self.constant(self.real, values[name]) if name in values else self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> Any:
        x = self.visit(node.operand)
        if isinstance(node.op, ast.Not) and x.type == self.truth:
            return self.builder.xor(x, self.constant(self.truth, True))
        if isinstance(node.op, ast.USub) and isinstance(node.operand, ast.Constant) and x.type != self.truth:
            return self.visit(ast.Constant(-node.operand.value))
        return self.builder.fneg(x) if isinstance(node.op, ast.USub) and x.type == self.real else self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> Any:
        a, b = self.alike(node, self.visit(node.left), self.visit(node.right))
        name = {self.real: REAL, self.whole: WHOLE}.get(a.type, {}).get(type(node.op))
        return getattr(self.builder, name)(a, b) if name else self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> Any:
        a, b = self.alike(node, self.visit(node.left), self.visit(node.comparators[0]))
        sign = COMPARE.get(type(node.ops[0]))
        if len(node.ops) > 1 or sign is None or a.type != self.real:
            self.generic_visit(node)
        return (self.builder.fcmp_unordered if sign == "!=" else self.builder.fcmp_ordered)(sign, a, b)

    def visit_BoolOp(self, node: ast.BoolOp) -> Any:
        joined, *others = (self.visit(value) for value in node.values)
        for value in others:
            if {joined.type, value.type} != {self.truth}:
                self.generic_visit(node)
            joined = getattr(self.builder, JOIN[type(node.op)])(joined, value)
        return joined

    def visit_IfExp(self, node: ast.IfExp) -> Any:
        test = self.visit(node.test)
        yes, no = self.alike(node, self.visit(node.body), self.visit(node.orelse))
        return self.builder.select(test, yes, no) if test.type == self.truth else self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> Any:
        name, args = ast.unparse(node.func), [self.visit(a) for a in node.args]
        if name in FUNCTIONS and len(args) == TAKES[name]:
            return self.builder.call(self.function(FUNCTIONS[name], len(args)), [self.as_real(node, a) for a in args])
        cast, given, wanted = CASTS.get(name, ("", "", ""))
        if not cast or [a.type for a in args] != [getattr(self, given)]:
            self.generic_visit(node)
        return getattr(self.builder, cast)(args[0], getattr(self, wanted))

    def function(self, name: str, count: int) -> Any:
        kind = ir.FunctionType(self.real, [self.real] * count)
        return self.builder.module.declare_intrinsic(f"{name}.{'f64' if self.lanes == 1 else f'v{self.lanes}f64'}", (), kind)

    def alike(self, node: ast.expr, a: Any, b: Any) -> tuple[Any, Any]:
        """Two values of one type: a whole number beside a float becomes one."""
        return (a, b) if a.type == b.type else (self.as_real(node, a), self.as_real(node, b))

    def as_real(self, node: ast.expr, x: Any) -> Any:
        if x.type == self.truth:
            self.generic_visit(node)
        return self.builder.sitofp(x, self.real) if x.type == self.whole else x

    def generic_visit(self, node: ast.AST, what: str = "is not among what can be written as instructions") -> Any:
        raise TypeError(f"{ast.unparse(node)!r} in a line of a step {what}")


def write(builder: Any, data: Any, lanes: int, width: int, numbers: Any, reads: Any, text: str, keeps: Any) -> None:
    """Read fields, write all lines, keep fields.

    Each line is written for all vectors of `width` lanes in turn: their chains of operations hide each other's latency. `numbers` are
    the same for all lanes; `reads` and `keeps` say where the field of a name begins.
    """
    vectors = [_Vector(builder, data, first, width) for first in range(0, lanes, width)]
    for vector in vectors:
        for name, number in numbers.items():
            vector.spread(name, number)
        for name, at in reads.items():
            vector.read(name, at)
    for statement in ast.parse(text).body:
        for vector in vectors:
            vector.visit(statement)
    for vector in vectors:
        for name, at in keeps.items():
            vector.keep(name, at)
