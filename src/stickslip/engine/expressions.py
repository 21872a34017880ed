"""Expressions of Python text as LLVM instructions, on plain numbers or on vectors with one number for each lane.

Functions (`functions.py`) and the lines of steps (`emit.py`) share this: what numbers, conditions and operations mean. They differ in
statements, in names, and in what decides: a branch in a function, a select instruction in a step, whose lanes go on together.
"""

from __future__ import annotations

import ast
import math
from collections import Counter, deque
from collections.abc import Iterator
from typing import Any, NoReturn

from stickslip.engine.instructions import DOUBLE, Constant, function_type, integer, vector_of

INT64, FLOAT64, BOOL, INT8 = integer(64), DOUBLE, integer(1), integer(8)
ON_FLOATS = {ast.Add: "fadd", ast.Sub: "fsub", ast.Mult: "fmul", ast.Div: "fdiv"}
ON_INTEGERS = {
    ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.LShift: "shl", ast.RShift: "ashr", ast.BitAnd: "and", ast.BitOr: "or",
    ast.BitXor: "xor",
}  # fmt: skip
COMPARED = {ast.Gt: ">", ast.Lt: "<", ast.GtE: ">=", ast.LtE: "<=", ast.Eq: "==", ast.NotEq: "!="}
#: Of floats: the intrinsic function of LLVM, and how many numbers it takes.
INTRINSICS = {"fma": ("llvm.fma", 3), "abs": ("llvm.fabs", 1), "math.sqrt": ("llvm.sqrt", 1)}
_CONSTANTS = {"math.nan": math.nan, "np.nan": math.nan, "math.inf": math.inf, "math.pi": math.pi}


def all_statements(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    """The statements of a body and those within its branches and loops, level by level; of expressions nothing is walked through."""
    waiting = deque(body)
    while waiting:
        statement = waiting.popleft()
        yield statement
        if isinstance(statement, (ast.For, ast.If, ast.While)):
            waiting.extend(statement.body)
            waiting.extend(statement.orelse)


def names_given(statement: ast.stmt) -> list[str]:
    """The names to which a statement itself gives a value."""
    targets = statement.targets if isinstance(statement, ast.Assign) else [getattr(statement, "target", None)]
    each = [part for target in targets for part in (target.elts if isinstance(target, ast.Tuple) else [target])]
    return [part.id for part in each if isinstance(part, ast.Name)]


def settled_names(text: ast.FunctionDef) -> set[str]:
    """The names that a function gives a value once, for all that follows: in no branch, in no loop."""
    whole = [arg.arg for arg in text.args.args]
    given = Counter(whole)
    given.update(name for each in all_statements(text.body) for name in names_given(each))
    whole += [name for each in text.body if isinstance(each, ast.Assign) for name in names_given(each)]
    return {name for name in whole if given[name] == 1}


class Expressions(ast.NodeVisitor):
    """Writes expressions on numbers of `lanes` lanes; a whole number that is the same for all lanes is an `INT64`.

    `where` says in errors what cannot be written.
    """

    where: str

    def __init__(self, builder: Any, lanes: int) -> None:
        self.builder, self.lanes = builder, lanes
        kinds = (FLOAT64, INT64, BOOL)
        self.real, self.whole, self.truth = kinds if lanes == 1 else (vector_of(kind, lanes) for kind in kinds)
        self._constants = dict[tuple[bool, str], Any]()

    def constant(self, kind: Any, value: Any) -> Any:
        """A constant, of each lane; one object for each value, since an object writes its text once."""
        key = kind is self.truth, repr(value)
        if key not in self._constants:
            self._constants[key] = Constant(kind, value if self.lanes == 1 else [value] * self.lanes)
        return self._constants[key]

    def spread(self, x: Any) -> Any:
        """One number for all lanes."""
        if self.lanes == 1 or x.type not in (FLOAT64, INT64):
            return x
        kind = self.real if x.type == FLOAT64 else self.whole
        if isinstance(x, Constant):
            return self.constant(kind, x.constant)
        return self.builder.spread(x, kind)

    # ---- expressions ----
    def visit_Constant(self, node: ast.Constant) -> Any:
        """A number, or a truth value."""
        if type(node.value) is int:
            return Constant(INT64, node.value)
        kind = {bool: self.truth, float: self.real}.get(type(node.value))
        return self.refuse(node) if kind is None else self.constant(kind, node.value)

    def visit_Attribute(self, node: ast.Attribute) -> Any:
        """NaN, infinity or pi."""
        name = ast.unparse(node)
        return self.constant(self.real, _CONSTANTS[name]) if name in _CONSTANTS else self.refuse(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> Any:
        """Minus, not, and the bits turned over."""
        if isinstance(node.op, ast.Not):
            return self.builder.xor(self.condition(node.operand), self.constant(self.truth, True))
        x = self.visit(node.operand)
        if isinstance(node.op, ast.Invert):
            return self.builder.not_(x) if x.type == INT64 else self.refuse(node)
        if isinstance(node.operand, ast.Constant) and x.type != self.truth:
            return self.visit(ast.Constant(-node.operand.value))  # type: ignore[operator]
        return self.builder.fneg(x) if x.type == self.real else self.negative(node, x)

    def visit_BinOp(self, node: ast.BinOp) -> Any:
        """An operation on two numbers."""
        return self.operation(node, node.op, self.visit(node.left), self.visit(node.right))

    def operation(self, node: ast.AST, op: ast.operator, a: Any, b: Any) -> Any:
        """The instruction of an operation."""
        a, b = self.alike(node, a, b)
        if isinstance(op, ast.Div):
            a, b = self.as_real(node, a), self.as_real(node, b)
        names = ON_FLOATS if a.type in (self.real, FLOAT64) else ON_INTEGERS if a.type in (self.whole, INT64) else {}
        put = self.builder.on_floats if names is ON_FLOATS else self.builder.on_integers
        return put(names[type(op)], a, b) if type(op) in names else self.refuse(node)

    def visit_Compare(self, node: ast.Compare) -> Any:
        """A comparison of two numbers."""
        if len(node.ops) > 1 or type(node.ops[0]) not in COMPARED:
            self.refuse(node)
        a, b = self.alike(node, self.visit(node.left), self.visit(node.comparators[0]))
        return self.compared(node, COMPARED[type(node.ops[0])], a, b)

    def compared(self, node: ast.AST, sign: str, a: Any, b: Any) -> Any:
        """The instruction of a comparison; of what is not a number only != holds."""
        a, b = self.spread(a), self.spread(b)
        if a.type == self.real:
            return (self.builder.fcmp_unordered if sign == "!=" else self.builder.fcmp_ordered)(sign, a, b)
        return self.builder.icmp_signed(sign, a, b)

    def intrinsic(self, node: ast.AST, name: str, args: list[Any]) -> Any:
        """A function of floats."""
        function, takes = INTRINSICS[name]
        if len(args) != takes:
            self.refuse(node)
        return self.of_reals(node, f"{function}.{'f64' if self.lanes == 1 else f'v{self.lanes}f64'}", args)

    def of_reals(self, node: ast.AST, name: str, args: list[Any]) -> Any:
        """A call of a function of LLVM."""
        function = self.builder.module.declared(name, function_type(self.real, (self.real,) * len(args)))
        return self.builder.call(function, [self.as_real(node, arg) for arg in args])

    # ---- types ----
    def condition(self, node: ast.expr) -> Any:
        """A truth value."""
        value = self.visit(node)
        return value if value.type == self.truth else self.refuse(node)

    def negative(self, node: ast.AST, x: Any) -> Any:
        """Minus what is not a float."""
        return self.refuse(node)

    def alike(self, node: ast.AST, a: Any, b: Any) -> tuple[Any, Any]:
        """Two values of one type: a whole number beside a float becomes one, and what is the same for all lanes is so for each."""
        if {a.type, b.type} & {self.real, FLOAT64}:
            a, b = self.as_real(node, a), self.as_real(node, b)
        return (a, b) if a.type == b.type else (self.spread(a), self.spread(b))

    def as_real(self, node: ast.AST, x: Any) -> Any:
        """A number as a float."""
        if isinstance(x, Constant) and x.type == INT64:
            return Constant(FLOAT64, float(x.constant))
        return self.builder.sitofp(x, FLOAT64 if x.type == INT64 else self.real) if x.type in (INT64, self.whole) else x

    def refuse(self, node: ast.AST, what: str = "is not among what can be written as instructions") -> NoReturn:
        """Say what cannot be written."""
        raise TypeError(f"{ast.unparse(node)!r} in {self.where} {what}")

    generic_visit = refuse
