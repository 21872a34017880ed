"""Taylor coefficients of a solution by a loop over the orders: each expression of the graph has one line in it, whatever the order.

The coefficients follow from one another order by order: those of the states from the slopes, those of a product by Cauchy's rule, those
of a function from its differential equation (Moore 1966; Jorba and Zou 2005). An expression whose earlier coefficients are asked for
has a row of them in memory, all else is a name that lives for an order. Whatever multiplies earlier coefficients alone, which of all
products is everything but the two outermost terms, is summed for all expressions in one loop at the beginning of an order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from stickslip.engine.symbols import Sym, TraceError, slope_of
from stickslip.engine.write import Writer

__all__ = ["write_rows"]

ZERO = "0.0"


def write_rows(y: Sequence[Sym], f: Sequence[Sym], wanted: Iterable[Sym], w: Writer, start: dict[str, str], order: int) -> dict[int, str]:
    """Write the coefficients of t^m, m = 1 … `order` (t counted from the start of the step), of states and of what is wanted besides.

    Returns the names of their rows by the numbers of the nodes; what does not vary has none. A row's place 0 is left as it is: an
    expression's value is among the lines before the loop.
    """
    return _Rows(y, f, wanted, w, start, order).rows


class _Rows:
    def __init__(self, y: Sequence[Sym], f: Sequence[Sym], wanted: Iterable[Sym], w: Writer, start: dict[str, str], order: int):
        self.graph, self.w, self.start, self.order = y[0].graph, w, start, order
        self._states = {state.number: i for i, state in enumerate(y)}
        self.rows: dict[int, str] = {}
        self._rates: dict[int, str] = {}  # rows of m times the coefficient
        self._sums: dict[tuple[str, str], str] = {}  # of products of two rows
        self._lines: dict[int, list[tuple[str, str]]] = {}  # of an order, by the node whose coefficient they end with
        self._names: dict[int, str] = {}
        self._carried: dict[str, tuple[str, str]] = {}  # names that an order takes from the one before: first value, value for the next
        kept = [node for node in (*y, *wanted) if self._varies(node)]
        for node in kept:
            self._row(node)
        nodes = self._needed([*kept, *f])
        for node in nodes:
            self._lines.setdefault(node.number, [])
            self._names[node.number] = self._rule(node)(node)
        for i, slope in enumerate(f):
            self._carried[f"_f{i}"] = self._value(slope), self._coefficient(slope)
        self._write(nodes)

    # ---- what there is to write ----
    def _varies(self, node: Sym) -> bool:
        return bool(self.graph.varies(node))

    def _needed(self, roots: Iterable[Sym]) -> list[Sym]:
        """All that varies in some expressions and in the slopes of their functions, arguments before what is made of them."""
        found: dict[int, Sym] = {}
        waiting = list(roots)
        while waiting:
            node = waiting.pop()
            if node.number not in found and self._varies(node):
                found[node.number] = node
                waiting += self._made_of(node)
        return [found[number] for number in sorted(found)]

    def _made_of(self, node: Sym) -> list[Sym]:
        """The expressions whose coefficients its own are made of."""
        if self._turns(node):
            return [self.graph.call(op, node.args[0]) for op in ("sin", "cos")]
        return [*node.args, slope_of(node)] if self._rule(node) == self._by_slope else list(node.args)

    def _turns(self, node: Sym) -> bool:
        """Whether it is a sine or cosine of what is linear in time."""
        if node.op not in ("sin", "cos") or self.graph.varies(node) != {"t"}:
            return False
        return not self._varies(self._rate_in_time(node.args[0]))

    def _rate_in_time(self, node: Sym) -> Sym:
        return self.graph.derivative(node, self.graph.variable("t"))

    def _rule(self, node: Sym) -> Callable[[Sym], str]:
        if self._turns(node):
            return self._turning
        return getattr(self, f"_{node.op}", self._by_slope)

    # ---- names ----
    def _value(self, node: Sym) -> str:
        """An expression's value at the start of the step."""
        return self.w.value(node, self.start)

    def _coefficient(self, node: Sym) -> str:
        """Its coefficient of the present order: a name, or a literal 0.0."""
        return self._names[node.number] if self._varies(node) else ZERO

    def _row(self, node: Sym) -> str:
        return self.rows.setdefault(node.number, f"_r{node.number}")

    def _rate(self, node: Sym) -> str:
        return self._rates.setdefault(node.number, f"_d{node.number}")

    def _sum(self, first: str, second: str) -> str:
        """The sum of first[j] second[m - j] for 0 < j < m."""
        return self._sums.setdefault((first, second), f"_s{len(self._sums)}")

    def _line(self, node: Sym, text: str) -> str:
        """A coefficient that is a line of its own."""
        self._lines.setdefault(node.number, []).append((f"_n{node.number}", text))
        return f"_n{node.number}"

    # ---- the coefficients of an order ----
    def _variable(self, node: Sym) -> str:
        if node.number in self._states:
            return self._line(node, f"_inverse * _f{self._states[node.number]}")
        self._carried[f"_n{node.number}"] = "1.0", ZERO  # time
        return f"_n{node.number}"

    def _add(self, node: Sym) -> str:
        a, b = map(self._coefficient, node.args)
        return b if a == ZERO else a if b == ZERO else self._line(node, f"{a} + {b}")

    def _subtract(self, node: Sym) -> str:
        a, b = map(self._coefficient, node.args)
        return a if b == ZERO else self._line(node, f"-{b}" if a == ZERO else f"{a} - {b}")

    def _multiply(self, node: Sym) -> str:
        a, b = node.args
        if not (self._varies(a) and self._varies(b)):
            factor, other = (a, b) if self._varies(b) else (b, a)
            held, c = self._value(factor), self._coefficient(other)
            return self._line(node, f"-{c}" if held == "(-1.0)" else f"{held} * {c}")
        between = self._sum(self._row(a), self._row(b))
        ends = f"fma({self._value(b)}, {self._coefficient(a)}, {between})"
        return self._line(node, f"fma({self._value(a)}, {self._coefficient(b)}, {ends})")

    def _select(self, node: Sym) -> str:
        held, yes, no = node.args
        if self._varies(held):
            raise TraceError("a select on what is not held stands in an equation of motion")
        a, b = self._coefficient(yes), self._coefficient(no)
        return a if a == b else self._line(node, f"{a} if {self._value(held)} > 0.0 else {b}")

    def _reciprocal(self, node: Sym) -> str:
        """y a = 1."""
        a, y = node.args[0], self._value(node)
        between = self._sum(self._row(a), self._row(node))
        return self._line(node, f"-{y} * fma({self._coefficient(a)}, {y}, {between})")

    def _by_slope(self, node: Sym) -> str:
        """A function y(a): m y_m is the sum of j a_j s_(m-j) with its slope s = dy/da, which needs no coefficient of y beyond m - 1."""
        a, slope = node.args[0], slope_of(node)
        between = self._sum(self._rate(a), self._row(slope))
        return self._line(node, f"fma({self._coefficient(a)}, {self._value(slope)}, _inverse * {between})")

    def _log(self, node: Sym) -> str:
        """a y' = a'."""
        a, slope = node.args[0], slope_of(node)
        between = self._sum(self._rate(node), self._row(a))
        return self._line(node, f"{self._value(slope)} * fma(-_inverse, {between}, {self._coefficient(a)})")

    def _sqrt(self, node: Sym) -> str:
        """y y = a."""
        between = self._sum(self._row(node), self._row(node))
        return self._line(node, f"{self._value(slope_of(node))} * ({self._coefficient(node.args[0])} - {between})")

    def _turning(self, node: Sym) -> str:
        """sin and cos of one argument that is linear in time, both at once: each needs the last coefficient of the other."""
        sine, cosine = (self.graph.call(op, node.args[0]) for op in ("sin", "cos"))
        s, c, turn = f"_n{sine.number}", f"_n{cosine.number}", f"_w{node.args[0].number}"
        if s not in self._carried:
            self._carried[s], self._carried[c] = (self._value(sine), s), (self._value(cosine), c)
            ahead = [(turn, f"_inverse * {self._value(self._rate_in_time(node.args[0]))}"), (f"{turn}c", f"{turn} * {c}")]
            self._lines.setdefault(node.number, []).extend([*ahead, (c, f"-{turn} * {s}"), (s, f"{turn}c")])
        return s if node is sine else c

    # ---- the loop ----
    def _write(self, nodes: list[Sym]) -> None:
        w = self.w
        for row in (*self.rows.values(), *self._rates.values()):
            w.line(row, f"row({self.order + 1})")
        for name, (first, _) in self._carried.items():
            w.line(name, f"1.0 * {first}")
        w.begin(f"for m in range(1, {self.order + 1})")
        w.line("_inverse", "1 / m")
        self._write_sums()
        for node in nodes:
            for name, text in self._lines[node.number]:
                w.line(name, text)
            self._keep(node)
        for name, (_, following) in self._carried.items():
            if name != following:
                w.line(name, following)
        w.end()

    def _write_sums(self) -> None:
        """What earlier coefficients alone give."""
        w = self.w
        for name in self._sums.values():
            w.line(name, ZERO)
        if self._sums:
            w.begin("for j in range(1, m)")
            for (first, second), name in self._sums.items():
                w.line(name, f"fma({first}[j], {second}[m - j], {name})")
            w.end()

    def _keep(self, node: Sym) -> None:
        name = self._names[node.number]
        if node.number in self.rows:
            self.w.line(f"{self.rows[node.number]}[m]", name)
        if node.number in self._rates:
            self.w.line(f"{self._rates[node.number]}[m]", f"m * {name}")
