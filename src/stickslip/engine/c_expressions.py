"""Expressions of Python text as C99, on plain numbers: what `expressions.py` writes as LLVM instructions, with the same bits.

A value knows its type, and its number where that is known: conditions on known numbers are decided here, so that what a machine does not
have is not in its C. Nothing is fused or reordered that is not written so; the C is compiled without contraction.
"""

from __future__ import annotations

import ast
import math
import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from typing import Any, NoReturn

REAL, WHOLE, TRUTH, SMALL = "double", "int64_t", "bool", "int8_t"
_SIGNS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.BitAnd: "&", ast.BitOr: "|", ast.BitXor: "^"}
_SHIFTS = {ast.LShift: "shifted_left", ast.RShift: "shifted_right"}
_COMPARED = {ast.Gt: ">", ast.Lt: "<", ast.GtE: ">=", ast.LtE: "<=", ast.Eq: "==", ast.NotEq: "!="}
_DECIDED: dict[str, Callable[[Any, Any], bool]] = {
    ">": lambda a, b: a > b, "<": lambda a, b: a < b, ">=": lambda a, b: a >= b, "<=": lambda a, b: a <= b,
    "==": lambda a, b: a == b, "!=": lambda a, b: a != b,
}  # fmt: skip
_FOLDED: dict[str, Callable[[Any, Any], Any]] = {"+": lambda a, b: a + b, "-": lambda a, b: a - b, "*": lambda a, b: a * b}
_CONSTANTS = {"math.nan": math.nan, "np.nan": math.nan, "math.inf": math.inf}
#: Functions of floats, by their names in the text: what they are in C, and how many numbers they take.
_FUNCTIONS = {
    "fma": ("fma", 3), "abs": ("fabs", 1), "math.sqrt": ("sqrt", 1), "math.floor": ("floor", 1), "math.log2": ("log2", 1),
    "math.copysign": ("copysign", 2), "math.expm1": ("expm1", 1),
}  # fmt: skip

_KEYWORDS = {
    "auto", "bool", "break", "case", "char", "const", "continue", "default", "do", "double", "else", "enum", "extern", "false", "float",
    "for", "goto", "if", "inline", "int", "long", "register", "restrict", "return", "short", "signed", "sizeof", "static", "struct",
    "switch", "true", "typedef", "union", "unsigned", "void", "volatile", "while",
}  # fmt: skip

_WORDS = re.compile(r"[A-Za-z_]\w*")

#: What the expressions call besides the functions of mathematics.
HELPERS = """\
static int64_t as_bits(double x) { int64_t bits; memcpy(&bits, &x, sizeof bits); return bits; }
static double as_float(int64_t bits) { double x; memcpy(&x, &bits, sizeof x); return x; }
static int64_t shifted_left(int64_t bits, int64_t by) { return (int64_t)((uint64_t)bits << by); }
static int64_t shifted_right(int64_t bits, int64_t by) { return bits >> by; }
static int64_t whole_of(double x) { return x >= -9.2e18 && x <= 9.2e18 ? (int64_t)x : INT64_MIN; }
"""


@dataclass(frozen=True)
class Value:
    """A number, or a truth value: its C, its type, and what it is where that is known."""

    text: str
    kind: str
    known: Any = None

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class View:
    """An array: where its first number stands, the type of its numbers, and how many there are along each axis."""

    data: str
    kind: str
    shape: tuple[Value, ...]


def constant(value: Any) -> Value:
    """A number that is known.

    Examples
    --------
    >>> str(constant(0.5)), str(constant(-3)), str(constant(True))
    ('0.5', '(-3)', 'true')
    """
    if isinstance(value, bool):
        return Value("true" if value else "false", TRUTH, value)
    if isinstance(value, int):
        text = str(value) if abs(value) < 1 << 31 else f"INT64_C({value})"
        return Value(text if value >= 0 else f"({text})", WHOLE, value)
    text = "NAN" if math.isnan(value) else ("INFINITY" if value > 0 else "(-INFINITY)") if math.isinf(value) else repr(float(value))
    return Value(f"({text})" if text.startswith("-") else text, REAL, float(value))


def c_name(name: str) -> str:
    """A name of the text as one in C, whose keywords are others.

    Examples
    --------
    >>> c_name("case"), c_name("lane")
    ('case_', 'lane')
    """
    return f"{name}_" if name in _KEYWORDS else name


class CExpressions(ast.NodeVisitor):
    """Writes expressions; `where` says in errors what cannot be written."""

    where: str

    def visit_Constant(self, node: ast.Constant) -> Any:
        """A number, or a truth value."""
        return constant(node.value) if isinstance(node.value, (bool, int, float)) else self.refuse(node)

    def visit_Attribute(self, node: ast.Attribute) -> Any:
        """NaN or infinity."""
        name = ast.unparse(node)
        return constant(_CONSTANTS[name]) if name in _CONSTANTS else self.refuse(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> Any:
        """Minus, and not."""
        x = self.condition(node.operand) if isinstance(node.op, ast.Not) else self.visit(node.operand)
        if isinstance(node.op, ast.Not):
            return constant(not x.known) if x.known is not None else Value(f"(!{x})", TRUTH)
        if not isinstance(node.op, ast.USub):
            return self.refuse(node)
        return constant(-x.known) if x.known is not None else Value(f"(-{x})", x.kind)

    def visit_BinOp(self, node: ast.BinOp) -> Any:
        """An operation on two numbers."""
        return self.operation(node, node.op, self.visit(node.left), self.visit(node.right))

    def operation(self, node: ast.AST, op: ast.operator, a: Value, b: Value) -> Value:
        """An operation on two values."""
        if isinstance(op, ast.Pow) and b.known == 0.5:
            return Value(f"sqrt({self.as_kind(node, a, REAL)})", REAL)
        if type(op) in _SHIFTS:
            return Value(f"{_SHIFTS[type(op)]}({a}, {b})", WHOLE)
        if type(op) not in _SIGNS:
            self.refuse(node)
        sign = _SIGNS[type(op)]
        kind = REAL if REAL in (a.kind, b.kind) or sign == "/" else WHOLE
        a, b = self.as_kind(node, a, kind), self.as_kind(node, b, kind)
        if kind == WHOLE and sign in _FOLDED:
            if a.known is not None and b.known is not None:
                return constant(_FOLDED[sign](a.known, b.known))
            if sign in "+-" and b.known == 0:
                return a
            if sign == "+" and a.known == 0:
                return b
            if sign == "*" and (a.known == 1 or b.known == 1):
                return b if a.known == 1 else a
            if sign == "*" and 0 in (a.known, b.known):
                return constant(0)
        return Value(f"({a} {sign} {b})", kind)

    def visit_Compare(self, node: ast.Compare) -> Any:
        """A comparison of two numbers; of what is not a number only != holds."""
        if len(node.ops) > 1 or type(node.ops[0]) not in _COMPARED:
            self.refuse(node)
        return self.compared(node, _COMPARED[type(node.ops[0])], self.visit(node.left), self.visit(node.comparators[0]))

    def compared(self, node: ast.AST, sign: str, a: Value, b: Value) -> Value:
        """A comparison of two values."""
        if a.known is not None and b.known is not None:
            return constant(_DECIDED[sign](a.known, b.known))
        kind = REAL if REAL in (a.kind, b.kind) else TRUTH if a.kind == b.kind == TRUTH else WHOLE
        return Value(f"({self.as_kind(node, a, kind)} {sign} {self.as_kind(node, b, kind)})", TRUTH)

    def visit_BoolOp(self, node: ast.BoolOp) -> Any:
        """What is known to decide, decides; what does not is left out."""
        deciding, sign = (False, " && ") if isinstance(node.op, ast.And) else (True, " || ")
        undecided = []
        for each in node.values:
            value = self.condition(each)
            if value.known is None:
                undecided.append(value)
            elif value.known == deciding:
                return constant(deciding)  # what stands further left changes nothing: it is looked at
        if len(undecided) < 2:
            return undecided[0] if undecided else constant(not deciding)
        return Value(f"({sign.join(map(str, undecided))})", TRUTH)

    def visit_IfExp(self, node: ast.IfExp) -> Any:
        """One of two values."""
        test = self.condition(node.test)
        if test.known is not None:
            return self.visit(node.body if test.known else node.orelse)
        yes, no = self.visit(node.body), self.visit(node.orelse)
        kind = self.common(yes, no)
        return Value(f"({test} ? {self.as_kind(node, yes, kind)} : {self.as_kind(node, no, kind)})", kind)

    def function(self, node: ast.Call, name: str, args: list[Value]) -> Value:
        """A function of numbers."""
        if name in ("max", "min"):
            return reduce(lambda a, b: self.extreme(node, ">" if name == "max" else "<", a, b), args)
        if name in ("np.int64", "np.uint64"):
            return Value(f"whole_of({args[0]})", WHOLE) if args[0].kind == REAL else self.as_kind(node, args[0], WHOLE)
        if name == "np.float64":
            return self.as_kind(node, args[0], REAL)
        if name in ("as_bits", "as_float"):
            return Value(f"{name}({args[0]})", WHOLE if name == "as_bits" else REAL)
        if name == "abs" and args[0].kind == WHOLE:
            return Value(f"({args[0]} < 0 ? -{args[0]} : {args[0]})", WHOLE)
        own, takes = _FUNCTIONS.get(name, ("", -1))
        if len(args) != takes:
            self.refuse(node)
        return Value(f"{own}({', '.join(str(self.as_kind(node, arg, REAL)) for arg in args)})", REAL)

    def extreme(self, node: ast.AST, sign: str, a: Value, b: Value) -> Value:
        """The larger or the smaller of two numbers: the first where they are equal, or where one is no number."""
        kind = self.common(a, b)
        a, b = self.as_kind(node, a, kind), self.as_kind(node, b, kind)
        if a.known is not None and b.known is not None:
            return b if _DECIDED[sign](b.known, a.known) else a
        return Value(f"({b} {sign} {a} ? {b} : {a})", kind)

    def condition(self, node: ast.expr) -> Value:
        """A truth value, or whether a number is not zero."""
        value = self.visit(node)
        if value.kind == TRUTH:
            return value  # type: ignore[no-any-return]
        return constant(value.known != 0) if value.known is not None else Value(f"({value} != 0)", TRUTH)

    def common(self, a: Value, b: Value) -> str:
        """The type of either of two values."""
        return REAL if REAL in (a.kind, b.kind) else TRUTH if a.kind == b.kind == TRUTH else WHOLE

    def as_kind(self, node: ast.AST, x: Value, kind: str) -> Value:
        """A value as one of another type that can hold it."""
        if x.kind == kind:
            return x
        if kind == REAL and x.kind in (WHOLE, TRUTH):
            return constant(float(x.known)) if x.known is not None else Value(f"(double){x}", REAL)
        if kind == WHOLE and x.kind == TRUTH:
            return constant(int(x.known)) if x.known is not None else Value(f"(int64_t){x}", WHOLE)
        return self.refuse(node, f"would make a number of type {x.kind} one of type {kind}")

    def refuse(self, node: ast.AST, what: str = "is not among what can be written as C") -> NoReturn:
        """Say what cannot be written."""
        raise TypeError(f"{ast.unparse(node)!r} in {self.where} {what}")

    generic_visit = refuse


def bare(value: Value) -> str:
    """A value's text without parentheses around all of it: a condition, or the right side of an assignment.

    Examples
    --------
    >>> bare(Value("(a > b)", "bool")), bare(Value("(a) + (b)", "double"))
    ('a > b', '(a) + (b)')
    """
    text = value.text
    if not (text.startswith("(") and text.endswith(")")):
        return text
    depth = 0
    for k, letter in enumerate(text):
        depth += (letter == "(") - (letter == ")")
        if depth == 0 and k < len(text) - 1:
            return text
    return text[1:-1]


def without_unread(lines: list[str], names: dict[str, str]) -> tuple[list[str], dict[str, str]]:
    """Lines without what gives a value to a name that no other line reads, unless it calls something; and the names that are left.

    Examples
    --------
    >>> without_unread(["a = 1;", "b = a;", "return 2;"], {"a": "int64_t", "b": "int64_t"})
    (['return 2;'], {})
    """
    parts = []
    for line in lines:
        name, equals, text = line.strip().partition(" = ")
        gives = name if equals and name in names else ""
        parts.append((gives, _WORDS.findall(text if gives else line)))
    kept = [True] * len(lines)
    reads = Counter(word for _, read in parts for word in read)
    while True:
        gone = [
            k
            for k, (gives, read) in enumerate(parts)
            if kept[k] and gives and reads[gives] == read.count(gives) and not any(w.startswith(("do_", "law_")) for w in read)
        ]
        if not gone:
            break
        for k in gone:
            kept[k] = False
            reads.subtract(parts[k][1])
    left = [line for line, keep in zip(lines, kept, strict=True) if keep]
    used = {word for line in left for word in _WORDS.findall(line)}
    return left, {name: kind for name, kind in names.items() if name in used}
