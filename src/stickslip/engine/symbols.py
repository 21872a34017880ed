"""Symbols with which the engine calls a law in order to record its equations.

An expression is a node of a graph in which equal expressions are one node, so common subexpressions are shared by
construction. Nodes know how to differentiate themselves. Conditions on the state become guards: named flags of value
+1 or -1 that a step holds fixed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from stickslip.basics import maths
from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import StickslipError
from stickslip.basics.time_rates import defers_to_jets

_BLUNT = 1e-24  # a power that is singular at 0 is rounded off below the root of this; polynomials of order 16 bear no less
_BLUNT_LESS = 1e-32  # the same where slopes alone are wanted, also of deflections of a nanometre

#: What an equation may have of `stickslip.maths`, each a node with a slope, a Taylor series and lines of its own.
FUNCTIONS = ("exp", "log", "sqrt", "sin", "cos", "atan", "sinh", "cosh", "tanh", "asinh")
_POSITIVE, _ODD = ("exp", "sqrt", "cosh", "bell"), ("atan", "sinh", "tanh", "asinh")

CONSTANT, CASE, STATE = 0, 1, 2  # what a node depends on: nothing, the case's numbers, the state or time


class TraceError(StickslipError, TypeError):
    """A law or drive does with a symbol what only a number can do; the message says what to write."""


@defers_to_jets
class Sym:
    """One node of the expression graph."""

    __slots__ = ("args", "graph", "level", "name", "number", "op", "value")
    __array_ufunc__ = None  # NumPy scalars leave the operation to us

    def __init__(self, graph: Graph, op: str, args: tuple[Sym, ...], level: int, name: str = "", value: float = 0.0):
        self.graph, self.op, self.args, self.level, self.name, self.value = graph, op, args, level, name, value
        self.number = len(graph.nodes)
        graph.nodes.append(self)

    def _with(self, other: Numeric) -> Sym:
        if not isinstance(other, Sym):
            return self.graph.constant(other)
        if other.graph is not self.graph:
            raise TraceError(_STORED)
        return other

    def __add__(self, other: Numeric) -> Sym:
        return self.graph.add(self, self._with(other))

    __radd__ = __add__

    def __sub__(self, other: Numeric) -> Sym:
        return self.graph.subtract(self, self._with(other))

    def __rsub__(self, other: Numeric) -> Sym:
        return self.graph.subtract(self._with(other), self)

    def __mul__(self, other: Numeric) -> Sym:
        return self.graph.multiply(self, self._with(other))

    __rmul__ = __mul__

    def __truediv__(self, other: Numeric) -> Sym:
        return self.graph.divide(self, self._with(other))

    def __rtruediv__(self, other: Numeric) -> Sym:
        return self.graph.divide(self._with(other), self)

    def __neg__(self) -> Sym:
        return self.graph.multiply(self.graph.constant(-1.0), self)

    def __pos__(self) -> Sym:
        return self

    def __pow__(self, power: Numeric) -> Sym:
        return self.graph.power(self, power)

    def __rpow__(self, base: Numeric) -> Sym:
        return self.graph.call("exp", self * self._with(maths.log(base)))

    def __abs__(self) -> Sym:
        if self.level < STATE:
            return self.graph.select(self, self, -self)
        return self.graph.sign(self) * self

    def __gt__(self, other: Numeric) -> Condition:
        return Condition(self - other)

    def __ge__(self, other: Numeric) -> Condition:
        return Condition(self - other, weak=True)

    def __lt__(self, other: Numeric) -> Condition:
        return Condition(other - self)

    def __le__(self, other: Numeric) -> Condition:
        return Condition(other - self, weak=True)

    def __eq__(self, other: object) -> Any:
        raise TraceError("a law asks whether a symbol equals something (==); friction is traced, so write where(v > 0, a, b)")

    __hash__ = object.__hash__

    def __bool__(self) -> bool:
        raise TraceError(_IF)

    def __float__(self) -> float:
        raise TraceError(
            "a law, or a force or load of a machine, turns a symbol into a number; call exp, log, sqrt, sin, cos, tanh … from "
            "stickslip.maths, not from math or numpy"
        )

    __int__ = __index__ = __float__  # type: ignore[assignment]

    def __ss_sqrt__(self) -> Sym:
        return self.graph.power(self, 0.5)

    def __ss_is_zero__(self) -> bool:
        return is_zero(self)

    def __ss_solved__(self, matrix: Any, right: Any) -> tuple[Any, ...]:
        from stickslip.engine.linear_systems import solution

        return solution(matrix, right)

    def __ss_within__(self, period: Any) -> Sym:
        if not self.graph.begins_anew and self.graph.varies(self):
            raise TraceError("time goes on here and never begins anew with a period, so within(t, period) is not known; write sin and cos")
        if self.op == "variable" or self.level < STATE:
            return self  # the engine's time begins anew with each period
        return self._with(maths.wrapped(self, period))  # what is ahead of it, or behind

    def __repr__(self) -> str:
        return self._shown(3)

    def _shown(self, depth: int) -> str:
        """The expression as text, so many operations deep: whole it may be longer than memory holds."""
        if self.op == "constant" or self.name:
            return self.name or repr(self.value)
        return f"{self.op}({', '.join(arg._shown(depth - 1) for arg in self.args)})" if depth else "…"


def _hook(name: str) -> Callable[[Sym], Sym]:
    return lambda self: self.graph.call(name, self)


for _name in set(FUNCTIONS) - {"sqrt"}:
    setattr(Sym, f"__ss_{_name}__", _hook(_name))


_STORED = (
    "a value that an earlier call stored is used again; allowed are functions of their arguments alone: what has to be remembered is a "
    "state, of a law (rate) or of a controller (controllers())"
)
_IF = "a law uses `if`, `and`, `or`, `min` or `max` on a symbol; write where(condition, yes, no), maximum or minimum from stickslip.maths"


class Condition:
    """`difference > 0`, or where it is weak `difference >= 0`, not decided; `where` turns it into a select on a held flag."""

    def __init__(self, difference: Sym, weak: bool = False):
        self.difference, self.weak = difference, weak

    def __bool__(self) -> bool:
        return self.difference.graph.decided(self)

    def __ss_where__(self, yes: Any, no: Any) -> Sym:
        graph = self.difference.graph
        if graph.at_once:
            held, yes, no = self.difference, self.difference._with(yes), self.difference._with(no)
            return graph.select(-held, no, yes) if self.weak else graph.select(held, yes, no)
        held = graph.sign(self.difference) if graph.varies(self.difference) else self.difference
        return graph.select(held, self.difference._with(yes), self.difference._with(no))

    def __and__(self, other: Condition) -> _Both:
        return _Both(self, other, both=True)

    def __or__(self, other: Condition) -> _Both:
        return _Both(self, other, both=False)

    def __invert__(self) -> Condition:
        return Condition(-self.difference, not self.weak)


class _Both(Condition):
    """Two conditions joined by & or |."""

    def __init__(self, first: Condition, second: Condition, both: bool):
        self.first, self.second, self.both = first, second, both

    def __bool__(self) -> bool:
        return bool(self.first and self.second) if self.both else bool(self.first or self.second)

    def __ss_where__(self, yes: Any, no: Any) -> Sym:
        if self.both:
            return self.first.__ss_where__(self.second.__ss_where__(yes, no), no)
        return self.first.__ss_where__(yes, self.second.__ss_where__(yes, no))

    def __invert__(self) -> Condition:
        return _Both(~self.first, ~self.second, both=not self.both)


class Graph:
    """Makes nodes, each expression once, and simplifies what is plain."""

    def __init__(self) -> None:
        self.nodes: list[Sym] = []
        self._known: dict[Any, Sym] = {}
        self.guards: list[Sym] = []  # guards[k] is the expression whose sign the flag b<k> holds
        self.clocks: list[Sym] = []  # clocks[k] is linear in time, and its sign is the flag clk<k>
        self.units: dict[str, Sym] = {}  # typical sizes of variables, by name
        self.assumed: dict[int, float] = {}  # signs that are not asked for: number of a node -> +1 or -1
        self.begins_anew = True  # time is 0 at the beginning of each period
        self.at_once = False  # conditions are those of one instant: nothing is held, so that no flag is made
        self.linear: dict[int, Any] = {}  # of expressions that solve linear equations, by their numbers: these (`linear_systems`)
        self.solved: dict[tuple[int, ...], Any] = {}  # of solutions, by the numbers of all: matrix and right-hand side
        self._derivatives: dict[tuple[int, int], Sym] = {}
        self._varies: dict[int, frozenset[str]] = {}

    def _node(self, op: str, args: tuple[Sym, ...], level: int | None = None, name: str = "", value: float = 0.0) -> Sym:
        key = (op, tuple(a.number for a in args), name, value.hex())
        if key not in self._known:
            self._known[key] = Sym(self, op, args, max((a.level for a in args), default=0) if level is None else level, name, value)
        return self._known[key]

    def decided(self, condition: Condition) -> bool:
        """The answer to plain Python code that asks whether a condition holds."""
        raise TraceError(_IF)

    def constant(self, value: Any) -> Sym:
        """A literal number."""
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise TraceError(
                f"{value!r} of type {type(value).__name__} stands in an equation; allowed are numbers, fields of the law, v, z and load"
            )
        if not math.isfinite(value):
            raise TraceError(f"{value!r} stands in an equation; allowed are finite numbers; type a large one, such as 1e6")
        return self._node("constant", (), CONSTANT, value=float(value))

    def case(self, name: str) -> Sym:
        """A number of the case."""
        return self._node("case", (), CASE, name)

    def variable(self, name: str) -> Sym:
        """Time or a state."""
        return self._node("variable", (), STATE, name)

    def mode(self, name: str) -> Sym:
        """A whole number that a step holds fixed."""
        return self._node("flag", (), STATE, name)

    def varies(self, node: Sym) -> frozenset[str]:
        """The variables (time and states) that a node depends on; held flags do not count."""
        if node.number not in self._varies:
            names = frozenset((node.name,)) if node.op == "variable" else frozenset().union(*(self.varies(a) for a in node.args))
            self._varies[node.number] = names
        return self._varies[node.number]

    def add(self, a: Sym, b: Sym) -> Sym:
        """a + b."""
        if a.op == b.op == "constant":
            return self.constant(a.value + b.value)
        if a.op == "constant" and a.value == 0:
            return b
        if b.op == "constant" and b.value == 0:
            return a
        return self._node("add", (a, b) if a.number <= b.number else (b, a))

    def subtract(self, a: Sym, b: Sym) -> Sym:
        """a - b."""
        if a is b:
            return self.constant(0.0)
        if b.op == "constant":
            return self.add(a, self.constant(-b.value))
        if a.op == "constant" and a.value == 0:
            return self.multiply(self.constant(-1.0), b)
        return self._node("subtract", (a, b))

    def multiply(self, a: Sym, b: Sym) -> Sym:
        """a * b; constants gather in front."""
        if b.op == "constant":
            a, b = b, a
        if a.op == "constant":
            if b.op == "constant":
                return self.constant(a.value * b.value)
            if a.value == 0:
                return a
            if a.value == 1:
                return b
            if b.op == "multiply" and b.args[0].op == "constant":
                return self.multiply(self.constant(a.value * b.args[0].value), b.args[1])
            return self._node("multiply", (a, b))
        for one, other in ((a, b), (b, a)):  # keep what depends on the case alone together: it is computed once per case
            if one.level < STATE and other.level == STATE and other.op == "multiply" and other.args[0].level < STATE:
                return self.multiply(self.multiply(one, other.args[0]), other.args[1])
        if a.level > b.level or (a.level == b.level and a.number > b.number):
            a, b = b, a
        return self._node("multiply", (a, b))

    def divide(self, a: Sym, b: Sym) -> Sym:
        """a / b, as a times the reciprocal that all quotients by b share."""
        if b.op == "constant":
            if b.value == 0:
                raise TraceError("an equation divides by zero")
            return self.multiply(self.constant(1.0 / b.value), a)
        if a is b and a.level == STATE:  # of numbers of the case 0/0 is none, and must show
            return self.constant(1.0)
        for whole, part in ((a, b), (b, a)):  # v / abs(v) is the side of v, also where v is zero
            if part.level == STATE and whole.op == "multiply" and any(part is x for x in whole.args):
                other = whole.args[0] if whole.args[1] is part else whole.args[1]
                return other if whole is a or is_sign(other) else self._node("reciprocal", (other,))
        if b.op == "multiply" and b.args[0].level < STATE <= b.args[1].level:
            return self.multiply(self.divide(self.constant(1.0), b.args[0]), self.divide(a, b.args[1]))
        return self.multiply(a, self._node("reciprocal", (b,)))

    def power(self, a: Sym, power: Any) -> Sym:
        """a to a power: whole ones by multiplication, halves by the square root, others by exp and log.

        Other powers than whole ones may have no slope where a base such as abs(v) touches zero: there they are rounded off.
        """
        if isinstance(power, (int, float)) and float(power).is_integer() and abs(power) <= 16:
            if power < 0:
                return self.divide(self.constant(1.0), self.power(a, -power))
            result, square, n = self.constant(1.0), a, int(power)
            while n:
                result, square, n = (result * square if n & 1 else result), (square * square if n > 1 else square), n >> 1
            return result
        if is_zero(a):
            return self.select(self.constant(power) if not isinstance(power, Sym) else power, a, self.constant(1.0))
        if a.op == "multiply" and a.args[0] is a.args[1]:
            return self.power(abs(a.args[0]), 2.0 * power)
        side = self._side(a)
        if side == "touches zero" or (side == "a choice" and isinstance(power, Sym)):
            blunt = (_BLUNT if self.assumed else _BLUNT_LESS) * self._size(a) ** 2
            return a * self.call("exp", 0.5 * (power - 1.0) * self.call("log", a * a + blunt))
        if isinstance(power, Sym):
            if side == "both signs":
                raise TraceError(
                    f"a law takes what has the sign of {' '.join(sorted(self.varies(a)))} to a power that is a field; only what is never "
                    "negative has such powers; write abs(v)**self.p, or v * abs(v)**(self.p - 1) where the sign is to stay"
                )
        elif power == 0.5:
            return self.call("sqrt", a)
        return self.call("exp", self.call("log", a) * power)

    def _side(self, a: Sym) -> str:
        """The known part of a product's sign: "touches zero" from above, as abs(v); "both signs", as v; or "a choice", as where makes."""
        factors, sign = [a], 1.0
        odd: list[Sym] = []  # factors that change sign and have no partner of the same sign
        while factors:
            factor = factors.pop()
            if factor.op == "multiply":
                factors += factor.args
            elif factor.op == "constant" or factor.number in self.assumed:
                sign *= math.copysign(1.0, self.assumed.get(factor.number, factor.value))
            elif factor.level == STATE:
                flag = factor.op == "flag" and factor.name[0] == "b"
                of = self.guards[int(factor.name[1:])] if flag else factor
                odd = [o for o in odd if o is not of] if any(o is of for o in odd) else [*odd, of]
        if not odd and self.varies(a):
            return "touches zero" if sign > 0 else "both signs"
        if odd and all(o.op == "select" for o in odd):
            return "a choice"
        return "both signs" if odd and all(o.op == "variable" and o.name != "t" for o in odd) else ""

    def _size(self, a: Sym) -> Sym:
        """The size of a product for typical sizes of its variables, as far as these are known."""
        if a.op == "multiply":
            return self.multiply(self._size(a.args[0]), self._size(a.args[1]))
        return self.units.get(a.name, self.constant(1.0)) if a.level == STATE else a

    def call(self, name: str, a: Sym) -> Sym:
        """A function of one argument."""
        if a.op == "constant":
            return self.constant(1.0 / math.cosh(a.value) ** 2 if name == "bell" else getattr(maths, name)(a.value))
        return self._node(name, (a,))

    def select(self, held: Sym, yes: Sym, no: Sym) -> Sym:
        """`yes` where held > 0, else `no`."""
        if held.op == "constant":
            return yes if held.value > 0 else no
        return yes if yes is no or (is_zero(yes) and is_zero(no)) else self._node("select", (held, yes, no))

    def by_side(self, a: Sym, forwards: Sym, backwards: Sym, neither: Sym) -> Sym:
        """`forwards` where a > 0, `backwards` where a < 0, else `neither`: what a mode of +1, -1 or 0 chooses, or a velocity."""
        return self.select(a, forwards, self.select(-a, backwards, neither))

    def sign(self, a: Sym) -> Sym:
        """The held sign of an expression of the state: a flag, or a product of flags for a product."""
        if a.number in self.assumed:
            return self.constant(self.assumed[a.number])
        if a.op == "multiply":
            first, second = a.args
            if first.op == "constant":
                return self.multiply(self.constant(math.copysign(1.0, first.value)), self.sign(second))
            if first is second:
                return self.constant(1.0)
            return self.multiply(self.sign(first), self.sign(second))
        if a.op in _POSITIVE:
            return self.constant(1.0)
        if a.op == "reciprocal" or a.op in _ODD:
            return self.sign(a.args[0])
        if not self.varies(a) or self.at_once:
            return a if is_sign(a) else self.select(a, self.constant(1.0), self.constant(-1.0))
        if self.varies(a) == {"t"} and not self.varies(self.derivative(a, self.variable("t"))):
            return self._clock(a)
        if a.op == "subtract" and a.args[0].number > a.args[1].number:  # b - a has the opposite sign of a - b: one guard
            other = self._known.get(("subtract", (a.args[1].number, a.args[0].number), "", (0.0).hex()))
            if other is not None and any(other is g for g in self.guards):
                return -self.sign(other)
        for k, known in enumerate(self.guards):
            if known is a:
                return self._node("flag", (), STATE, f"b{k}")
        self.guards.append(a)
        return self._node("flag", (), STATE, f"b{len(self.guards) - 1}")

    def _clock(self, a: Sym) -> Sym:
        """The held sign of an expression that is linear in time: it changes at an instant that is known beforehand."""
        for k, known in enumerate(self.clocks):
            if known is a:
                return self._node("flag", (), STATE, f"clk{k}")
        self.clocks.append(a)
        return self._node("flag", (), STATE, f"clk{len(self.clocks) - 1}")

    def derivative(self, node: Sym, by: Sym) -> Sym:
        """Partial derivative; held flags are constant."""
        key = (node.number, by.number)
        if key not in self._derivatives:
            self._derivatives[key] = self._differentiate(node, by)
        return self._derivatives[key]

    def _differentiate(self, node: Sym, by: Sym) -> Sym:
        zero = self.constant(0.0)
        if node is by:
            return self.constant(1.0)
        if node is not by and by.name not in self.varies(node):
            return zero
        if node.op == "select":
            held, yes, no = node.args
            return self.select(held, self.derivative(yes, by), self.derivative(no, by))
        d = [self.derivative(a, by) for a in node.args]
        a = node.args
        if node.op == "add":
            return d[0] + d[1]
        if node.op == "subtract":
            return d[0] - d[1]
        if node.op == "multiply":
            return d[0] * a[1] + a[0] * d[1]
        if d[0] is zero:
            return zero
        return d[0] * slope_of(node)


def is_sign(a: Sym) -> bool:
    """Whether a node is a flag of value +1 or -1."""
    return a.op == "flag" and not a.name.startswith("mode")


def is_zero(a: Sym) -> bool:
    """Whether a node is the number 0."""
    return a.op == "constant" and a.value == 0.0


def slope_of(node: Sym) -> Sym:
    """Derivative of a function of one argument by that argument."""
    graph, a = node.graph, node.args[0]
    match node.op:
        case "exp":
            return node
        case "log":
            return graph.divide(graph.constant(1.0), a)
        case "sqrt":
            return graph.divide(graph.constant(0.5), node)
        case "sin":
            return graph.call("cos", a)
        case "cos":
            return -graph.call("sin", a)
        case "atan":
            return 1.0 / (1.0 + a * a)
        case "sinh":
            return graph.call("cosh", a)
        case "cosh":
            return graph.call("sinh", a)
        case "tanh":
            return graph.call("bell", a)
        case "bell":  # 1/cosh^2, which is not 1 - tanh^2 once that has lost all its digits
            return -2.0 * (graph.call("tanh", a) * node)
        case "asinh":
            return 1.0 / graph.call("sqrt", 1.0 + a * a)
        case "reciprocal":
            return -(node * node)
    raise TraceError(f"no derivative is known for {node.op}")
