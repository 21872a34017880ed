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
    rows = Rows(y, f, wanted, w, start, order)
    rows.write()
    return rows.rows


class Rows:
    """The same in two parts: values at the start of the step, which are written at once, and the coefficients, where `write` is called.

    `known` are expressions that have their rows already. Written `out`, the loop is one round after another, and its rows need no memory.
    """

    def __init__(
        self, y: Sequence[Sym], f: Sequence[Sym], wanted: Iterable[Sym], w: Writer, start: dict[str, str], order: int,
        known: dict[int, str] | None = None, out: bool = False,
    ):  # fmt: skip
        self.graph, self.w, self.start, self.order, self.out = y[0].graph, w, start, order, out
        self._states = {state.number: i for i, state in enumerate(y)}
        self._given = known or {}
        self.rows: dict[int, str] = dict(self._given)
        self._rates: dict[int, str] = {}  # rows of m times the coefficient
        self._sums: dict[tuple[str, str], str] = {}  # of products of two rows
        self._lines: dict[int, list[tuple[str, str]]] = {}  # of an order, by the node whose coefficient they end with
        self._names: dict[int, str] = {}
        self._carried: dict[str, tuple[str, str]] = {}  # names that an order takes from the one before: first value, value for the next
        kept = [node for node in (*y, *wanted) if self._varies(node)]
        for node in kept:
            self._row(node)
        nodes = self._needed([*kept, *f])
        self._fused = self._to_be_fused(nodes, f) if out else set()
        for node in nodes:
            self._lines.setdefault(node.number, [])
            self._names[node.number] = self._rule(node)(node)
        for i, slope in enumerate(f):
            self._carried[f"_f{i}"] = self._value(slope), self._coefficient(slope)
        self._nodes = nodes

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

    def _to_be_fused(self, nodes: list[Sym], f: Sequence[Sym]) -> set[int]:
        """The products by a number that are part of one sum and of nothing else: they are added in one operation."""
        users: dict[int, list[Sym]] = {slope.number: [slope, slope] for slope in f}
        for node in nodes:
            for arg in self._made_of(node):
                users.setdefault(arg.number, []).append(node)
        scaled = [n for n in nodes if n.op == "multiply" and sum(map(self._varies, n.args)) == 1 and n.number not in self.rows]
        sums = ("add", "subtract")
        return {n.number for n in scaled if [user.op in sums for user in users.get(n.number, [])] == [True] and not self._is_minus(n)}

    def _is_minus(self, node: Sym) -> bool:
        return any(arg.op == "constant" and arg.value == -1.0 for arg in node.args)

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
        if node.number in self._given:
            return self._line(node, f"1.0 * {self._given[node.number]}[m]")
        self._carried[f"_n{node.number}"] = "1.0", ZERO  # time
        return f"_n{node.number}"

    def _add(self, node: Sym) -> str:
        a, b = map(self._coefficient, node.args)
        return b if a == ZERO else a if b == ZERO else self._line(node, self._total(node, "", f"{a} + {b}"))

    def _subtract(self, node: Sym) -> str:
        a, b = map(self._coefficient, node.args)
        return a if b == ZERO else self._line(node, f"-{b}" if a == ZERO else self._total(node, "-", f"{a} - {b}"))

    def _total(self, node: Sym, sign: str, plain: str) -> str:
        """A sum or difference, with a product that is a part of nothing else in the same operation."""
        a, b = node.args
        if b.number in self._fused:
            factor, c = self._scaled(b)
            return f"fma({sign}{factor}, {c}, {self._coefficient(a)})"
        if a.number in self._fused:
            factor, c = self._scaled(a)
            return f"fma({factor}, {c}, {sign}{self._coefficient(b)})"
        return plain

    def _scaled(self, node: Sym) -> tuple[str, str]:
        """Of a product by a number, this number and the coefficient of the rest."""
        factor, other = node.args if self._varies(node.args[1]) else reversed(node.args)
        return self._value(factor), self._coefficient(other)

    def _multiply(self, node: Sym) -> str:
        a, b = node.args
        if not (self._varies(a) and self._varies(b)):
            held, c = self._scaled(node)
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
    def write(self) -> None:
        """Write the coefficients."""
        w = self.w
        for row in (*self.rows.values(), *self._rates.values()):
            if row not in self._given.values():
                w.line(row, f"row({self.order + 1})")
        for name, (first, _) in self._carried.items():
            w.line(name, f"1.0 * {first}")
        w.begin(f"for m in {'each' if self.out else 'range'}(1, {self.order + 1})")
        w.line("_inverse", "1 / m")
        self._write_sums()
        for node in self._nodes:
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
        squares = {rows: name for rows, name in self._sums.items() if rows[0] == rows[1] and self.out}
        self._write_products("outwards" if self.out else "range", {k: name for k, name in self._sums.items() if k not in squares})
        self._write_products("halves", squares)
        for name in squares.values():
            w.line(name, f"{name} + {name}")
        self._write_products("middle", squares)

    def _write_products(self, over: str, sums: dict[tuple[str, str], str]) -> None:
        w = self.w
        if sums:
            w.begin(f"for j in {over}(1, m)")
            for (first, second), name in sums.items():
                w.line(name, f"fma({first}[j], {second}[m - j], {name})")
            w.end()

    def _keep(self, node: Sym) -> None:
        name = self._names[node.number]
        if node.number in self.rows and node.number not in self._given:
            self.w.line(f"{self.rows[node.number]}[m]", name)
        if node.number in self._rates:
            self.w.line(f"{self._rates[node.number]}[m]", f"m * {name}")
