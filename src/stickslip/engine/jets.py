"""Taylor coefficients of a solution, written out: each expression of the graph becomes the series of its values in time.

The series follow from one another order by order: those of the states from the slopes, those of a product by Cauchy's
rule, those of a function from its differential equation (Moore 1966; Jorba and Zou 2005).
"""

from __future__ import annotations

from collections.abc import Callable

from stickslip.engine.symbols import Sym, TraceError, slope_of
from stickslip.engine.trace import Equations
from stickslip.engine.write import Writer, literal

__all__ = ["Jets"]

ZERO = "0.0"


class Jets:
    """Names of Taylor coefficients (of t^m, t counted from the start of the step); each is written when first asked for."""

    def __init__(self, eq: Equations, w: Writer, start: dict[str, str]):
        self.w, self.start = w, start
        self._slope = {y.number: f for y, f in zip(eq.y, eq.f, strict=True)}
        self._graph = eq.graph
        self._known: dict[tuple[int, int], str] = {}

    def coefficient(self, node: Sym, m: int) -> str:
        """The m-th Taylor coefficient of an expression: a name, or a literal 0.0."""
        if m == 0:
            return self.w.value(node, self.start)
        if not self._graph.varies(node):
            return ZERO
        key = (node.number, m)
        if key not in self._known:
            self._known[key] = self._rules(node)(node, m)
        return self._known[key]

    def _rules(self, node: Sym) -> Callable[[Sym, int], str]:
        if node.op == "variable":
            return self._variable
        return getattr(self, f"_{node.op}", self._by_slope)

    def _line(self, text: str) -> str:
        return ZERO if text == ZERO else self.w.line(self.w.fresh(), text)

    def _variable(self, node: Sym, m: int) -> str:
        if node.number not in self._slope:  # time
            return "1.0" if m == 1 else ZERO
        return self._line(_scaled(self.coefficient(self._slope[node.number], m - 1), 1.0 / m))

    def _add(self, node: Sym, m: int) -> str:
        a, b = (self.coefficient(x, m) for x in node.args)
        return b if a == ZERO else a if b == ZERO else self._line(f"{a} + {b}")

    def _subtract(self, node: Sym, m: int) -> str:
        a, b = (self.coefficient(x, m) for x in node.args)
        return a if b == ZERO else self._line(f"-{b}" if a == ZERO else f"{a} - {b}")

    def _multiply(self, node: Sym, m: int) -> str:
        a, b = node.args
        if a is b:
            return self._square(a, m)
        if not self._graph.varies(a):
            return self._line(_product(self.coefficient(a, 0), self.coefficient(b, m)))
        return self._line(_dot([(self.coefficient(a, j), self.coefficient(b, m - j), 1.0) for j in range(m + 1)]))

    def _square(self, a: Sym, m: int) -> str:
        terms = [(self.coefficient(a, j), self.coefficient(a, m - j), 2.0 if 2 * j < m else 1.0) for j in range(m // 2 + 1)]
        return self._line(_dot(terms))

    def _select(self, node: Sym, m: int) -> str:
        held, yes, no = node.args
        if self._graph.varies(held):
            raise TraceError("a select on what is not held stands in an equation of motion")
        a, b = self.coefficient(yes, m), self.coefficient(no, m)
        return a if a == b else self._line(f"{a} if {self.coefficient(held, 0)} > 0.0 else {b}")

    def _reciprocal(self, node: Sym, m: int) -> str:
        a = node.args[0]
        tail = _dot([(self.coefficient(a, j), self.coefficient(node, m - j), 1.0) for j in range(1, m + 1)])
        return ZERO if tail == ZERO else self._line(f"-{self.coefficient(node, 0)} * ({tail})")

    def _by_slope(self, node: Sym, m: int) -> str:
        """A function y(a): m y_m is the sum of j a_j s_(m-j) with its slope s = dy/da, which needs no coefficient of y beyond m - 1."""
        a, slope = node.args[0], slope_of(node)
        return self._line(_dot([(self.coefficient(a, j), self.coefficient(slope, m - j), j / m) for j in range(1, m + 1)]))

    def _log(self, node: Sym, m: int) -> str:
        a = node.args[0]
        tail = _dot([(self.coefficient(node, j), self.coefficient(a, m - j), j / m) for j in range(1, m)])
        top = self.coefficient(a, m)
        if tail != ZERO:
            top = self._line(f"{top} - ({tail})")
        return ZERO if top == ZERO else self._line(f"{top} / {self.coefficient(a, 0)}")

    def _sqrt(self, node: Sym, m: int) -> str:
        a = node.args[0]
        tail = _dot([(self.coefficient(node, j), self.coefficient(node, m - j), 1.0) for j in range(1, m)])
        top = self.coefficient(a, m)
        if tail != ZERO:
            top = self._line(f"{top} - ({tail})")
        return ZERO if top == ZERO else self._line(f"0.5 * {top} / {self.coefficient(node, 0)}")

    def _sin(self, node: Sym, m: int) -> str:
        return self._turning(node, self._graph.call("cos", node.args[0]), 1.0, m)

    def _cos(self, node: Sym, m: int) -> str:
        return self._turning(node, self._graph.call("sin", node.args[0]), -1.0, m)

    def _turning(self, node: Sym, other: Sym, sign: float, m: int) -> str:
        """sin and cos of one argument, each the other's slope."""
        a = node.args[0]
        terms = [(self.coefficient(a, j), self.coefficient(other, m - j), sign * j / m) for j in range(1, m + 1)]
        return self._line(_dot(terms))


def _scaled(a: str, factor: float) -> str:
    return a if factor == 1.0 or a == ZERO else f"{literal(factor)} * {a}"


def _product(a: str, b: str) -> str:
    if ZERO in (a, b):
        return ZERO
    return b if a == "1.0" else a if b == "1.0" else f"-{b}" if a == "(-1.0)" else f"{a} * {b}"


def _dot(terms: list[tuple[str, str, float]]) -> str:
    """Sum of factor a b as fused multiply-adds; terms with a literal zero are left out."""
    text = ""
    for a, b, factor in terms:
        if ZERO in (a, b):
            continue
        first = a if factor == 1.0 else f"({literal(factor)} * {a})" if a != "1.0" else literal(factor)
        text = f"fma({first}, {b}, {text})" if text else _product(first, b)
    return text or ZERO
