"""Taylor coefficients of a solution by a loop over the orders: one line for each expression of the graph, at any order.

The coefficients follow from one another order by order: those of the states from the slopes, those of a product by Cauchy's rule, those
of a function from its differential equation (Moore 1966; Jorba and Zou 2005). Beyond the first, the coefficients of a sum, of a multiple
and of what differs from an expression by a number are linear in those of others: every expression is written as a `Form`, a sum of *terms*
with factors that do not vary, and only terms have lines. A term whose earlier coefficients are asked for has a row of them in memory, all
else is a name that lives for an order. Whatever multiplies earlier coefficients alone, which of all products is everything but the two
outermost terms, is summed for all expressions in one loop at the beginning of an order.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from stickslip.engine.linear_systems import Equation, LinearSystem, Turning, equations_of
from stickslip.engine.symbols import Sym, TraceError, is_zero, slope_of
from stickslip.engine.write import Writer

ZERO = "0.0"


@dataclass(frozen=True)
class Form:
    """The coefficients of an expression, from the first on: a sum of terms, each with a factor; `pure` if its value is that sum too."""

    terms: tuple[tuple[Sym, Sym], ...]  # (term, factor)
    pure: bool


def write_rows(y: Sequence[Sym], f: Sequence[Sym], wanted: Iterable[Sym], w: Writer, start: dict[str, str], order: int) -> dict[int, str]:
    """Write the coefficients of t^m, m = 1 … `order` (t counted from the start of the step), of states and of what is wanted besides.

    Returns the names of their rows by the numbers of the nodes; what does not vary has none. A row's place 0 is left as it is: an
    expression's value is among the lines before the loop.
    """
    rows = RowWriter(y, f, wanted, w, start, order)
    rows.write()
    return rows.rows


class RowWriter:
    """The same in two parts: values at the start of the step, which are written at once, and the coefficients, where `write` is called.

    `known` are expressions that have their rows already; where these last, new ones are `called` otherwise. Written `out`, the loop is one
    round after another, and its rows need no memory. Of what is wanted `later` the terms have rows, and of `multiples` those of which they
    are multiples (`multiple`), if there are such.
    """

    def __init__(
        self, y: Sequence[Sym], f: Sequence[Sym], wanted: Iterable[Sym], w: Writer, start: dict[str, str], order: int,
        known: dict[int, str] | None = None, out: bool = False, called: str = "_r",
        multiples: Sequence[Sym] = (), later: Sequence[Sym] = (),
    ):  # fmt: skip
        self.graph, self.w, self.start, self.order, self.out = y[0].graph, w, start, order, out
        self._states = {state.number: i for i, state in enumerate(y)}
        self._slopes = {state.number: slope for state, slope in zip(y, f, strict=False)}
        self._equations = dict[LinearSystem, tuple[Equation, ...]]()
        self._turned = dict[int, Turning]()  # by number of a sine or cosine the angle, where both follow from their products with its rate
        self._given, self._called = known or {}, called
        self._forms: dict[int, Form] = {}
        self.rows: dict[int, str] = dict(self._given)
        self._rates: dict[int, str] = {}  # rows of m times the coefficient
        self._sums: dict[tuple[str, str], str] = {}  # of products of two rows
        self._sums_ahead: dict[tuple[str, str], str] = {}  # those of the next order, as far as they are known
        self._ahead: dict[int, tuple[str, str]] = {}  # names and first coefficients of terms that are known an order ahead, by number
        self._lines: dict[int, list[tuple[str, str]]] = {}  # of an order, by the term whose coefficient they end with
        self._names: dict[int, str] = {}
        self._carried: dict[str, tuple[str, str]] = {}  # names that an order takes from the one before: first value, value for the next
        self._order: list[Sym] = []  # terms, arguments before what is made of them
        self._waiting: list[Sym] = []  # terms of which earlier coefficients are asked for
        kept = [node for node in (*y, *wanted) if self._varies(node)]
        self._users = self._counted([*kept, *f, *multiples, *later])
        self._wanted = {node.number for node in (*kept, *multiples)}
        kept += [node for node in multiples if self._varies(node) and not self._is_multiple(node)]
        for node in kept:
            self.rows.setdefault(node.number, f"{self._called}{len(self.rows)}")
        texts = [self._linear(self._form(node)) for node in kept]
        for term in (*(self._form(node).terms[0][0] for node in multiples if self._is_multiple(node)), *self._terms_within(later)):
            self._row(term)
            self._coefficient(term)
        texts += [self._linear(self._form(node)) for node in f]
        while self._waiting:
            self._coefficient(self._waiting.pop())
        self._kept = {node.number: text for node, text in zip(kept, texts, strict=False)}
        for i, (slope, text) in enumerate(zip(f, texts[len(kept) :], strict=True)):
            self._carried[f"_f{i}"] = self._value(slope), text

    # ---- what there is to write ----
    def _varies(self, node: Sym) -> bool:
        return bool(self.graph.varies(node))

    def _counted(self, roots: Iterable[Sym]) -> Counter[int]:
        """In how many others an expression stands; a root counts twice."""
        uses, waiting = Counter[int](), list(roots)
        for node in waiting:
            uses[node.number] += 2
        visited: set[int] = set()
        while waiting:
            node = waiting.pop()
            if node.number not in visited:
                visited.add(node.number)
                parts = self._parts(node)
                uses.update(a.number for a in parts)
                waiting += parts
        return uses

    def _parts(self, node: Sym) -> tuple[Sym, ...]:
        """What the series of an expression is made of: its arguments, or those of the linear equations that it solves."""
        system = self.graph.linear.get(node.number)
        return node.args if system is None else tuple(part for equation in self._solving(system) for part in equation.parts)

    def _solving(self, system: LinearSystem) -> tuple[Equation, ...]:
        """The equations of a system, with the rates of products where its unknowns are those by which the states move."""
        if system not in self._equations:
            turning = {}
            for angle, rate in ((y, w) for y, w in self._slopes.items() if w.number in self._slopes and self._in_halves):
                slope = self._slopes[rate.number]
                turning |= {k: Turning(self.graph.nodes[angle], rate) for k, x in enumerate(system.unknowns) if x is slope}
            self._equations[system] = equations_of(system, turning)
            for equation in self._equations[system]:
                for _, turned, of in equation.rates:
                    self._turned |= {self.graph.call(op, turned.args[0]).number: of for op in ("sin", "cos")}
        return self._equations[system]

    def _turns(self, node: Sym) -> bool:
        """Whether it is a sine or cosine of what is linear in time."""
        if node.op not in ("sin", "cos") or self.graph.varies(node) != {"t"}:
            return False
        return not self._varies(self._rate_in_time(node.args[0]))

    def _rate_in_time(self, node: Sym) -> Sym:
        return self.graph.derivative(node, self.graph.variable("t"))

    # ---- forms ----
    def _form(self, node: Sym) -> Form:
        if node.number not in self._forms:
            self._forms[node.number] = self._formed(node) if self._varies(node) else Form((), pure=False)
        return self._forms[node.number]

    def _formed(self, node: Sym) -> Form:
        one = self.graph.constant(1.0)
        itself = Form(((node, one),), pure=True)
        if node.number in self._states or node.number in self._given:
            return itself
        if node.number in self.graph.linear:
            return itself
        if node.op in ("add", "subtract"):
            total = self._total(node)
            return total if len(total.terms) < 2 or self._users[node.number] < 2 else itself
        if node.op == "select":
            return self._chosen(node) or itself
        if node.op == "exp" and node.number not in self._wanted:
            return Form(((node, node),), pure=False)  # in parts of its value
        if node.op != "multiply":
            return itself
        a, b = node.args
        if not (self._varies(a) and self._varies(b)):
            held, other = (a, b) if self._varies(b) else (b, a)
            form = self._form(other)
            return Form(tuple((term, held * factor) for term, factor in form.terms), form.pure)
        first, second = self._single(a), self._single(b)
        if b.op == "reciprocal" or a.op == "reciprocal":
            above, below = (a, b) if b.op == "reciprocal" else (b, a)
            term, factor = self._single(above)
            return itself if term is above else Form(((self.graph.multiply(term, below), factor),), pure=True)
        if first[0] is a and second[0] is b:
            return itself
        return Form(((first[0] * second[0], first[1] * second[1]),), pure=True)

    def _single(self, node: Sym) -> tuple[Sym, Sym]:
        """The term and the factor of an expression that is a multiple of a term; else itself and one."""
        form = self._form(node)
        return form.terms[0] if form.pure and len(form.terms) == 1 else (node, self.graph.constant(1.0))

    def _is_multiple(self, node: Sym) -> bool:
        """Whether an expression's coefficients are multiples of those of a term that is another one."""
        terms = self._form(node).terms
        return len(terms) == 1 and terms[0][0] is not node

    def multiple(self, node: Sym) -> tuple[str, Sym]:
        """The row of which an expression's coefficients are multiples, and the factor; of what does not vary there is none."""
        if node.number in self.rows or not self._varies(node):
            return self.rows.get(node.number, ""), self.graph.constant(1.0)
        term, factor = self._of_term(node)
        return self.rows[term.number], factor

    def _terms_within(self, nodes: Sequence[Sym]) -> list[Sym]:
        """What expressions, and the choices of which they are made, are sums of."""
        parts, sums = list(nodes), list[Sym]()
        for node in parts:
            if node.op == "select" and node.number not in self.graph.linear:
                parts += node.args[1:]
            else:
                sums.append(node)
        return [term for node in sums for term, _ in self._form(node).terms]

    def _total(self, node: Sym) -> Form:
        """A sum or a difference."""
        factors: dict[int, tuple[Sym, Sym]] = {}
        for arg, sign in zip(node.args, (1.0, 1.0 if node.op == "add" else -1.0), strict=True):
            for term, factor in self._form(arg).terms:
                before = factors[term.number][1] if term.number in factors else self.graph.constant(0.0)
                factors[term.number] = term, before + sign * factor
        terms = tuple(pair for pair in factors.values() if not is_zero(pair[1]))
        return Form(terms, pure=all(self._form(arg).pure for arg in node.args))

    def _chosen(self, node: Sym) -> Form | None:
        """A choice of two multiples of one term, by what is held."""
        held, yes, no = node.args
        if self._varies(held):
            raise TraceError("a select on what is not held stands in an equation of motion")
        (a, b) = (self._form(each) for each in (yes, no))
        if self._in_halves and len(a.terms) + len(b.terms) == 1:  # one of them does not vary
            zero, ((term, factor),) = self.graph.constant(0.0), (*a.terms, *b.terms)
            return Form(((term, self.graph.select(held, *((factor, zero) if a.terms else (zero, factor)))),), pure=False)
        if len(a.terms) != 1 or len(b.terms) != 1 or a.terms[0][0] is not b.terms[0][0]:
            return None
        return Form(((a.terms[0][0], self.graph.select(held, a.terms[0][1], b.terms[0][1])),), a.pure and b.pure)

    # ---- names ----
    def _value(self, node: Sym) -> str:
        """An expression's value at the start of the step."""
        return self.w.value(node, self.start)

    def _linear(self, form: Form) -> str:
        """The sum of a form's terms at the present order, the term that is ready last added last."""
        named = [(self._coefficient(term), factor) for term, factor in form.terms]
        rank = {self._names[term.number]: k for k, term in enumerate(self._order)}
        text = ""
        for name, factor in sorted(named, key=lambda pair: rank[pair[0]]):
            one = {1.0: "", -1.0: "-"}.get(factor.value) if factor.op == "constant" else None
            held = "" if one is not None else self._value(factor)
            if not text:
                text = f"{held} * {name}" if held else f"{one}{name}"
            else:
                text = f"fma({held}, {name}, {text})" if held else f"({text} {one or '+'} {name})"
        return text or ZERO

    def _coefficient(self, term: Sym) -> str:
        """The name of a term's coefficient of the present order; its lines are written down where they were not before."""
        if term.number not in self._names:
            name = f"_n{len(self._names)}"
            self._names[term.number] = name
            lines = self._lines.setdefault(term.number, [])
            if text := self._rule(term)(term):
                lines.append((name, text))
            self._order.append(term)
        return self._names[term.number]

    def _rule(self, term: Sym) -> Callable[[Sym], str]:
        if term.number in self._given:
            return lambda term: f"1.0 * {self._given[term.number]}[m]"
        if term.number in self.graph.linear:
            return self._solved
        if term.number in self._turned:
            return self._with_the_angle
        return self._turning if self._turns(term) else getattr(self, f"_{term.op}", self._by_slope)

    def _row(self, term: Sym) -> str:
        """The row of a term's coefficients."""
        if term.number not in self._names:
            self._waiting.append(term)
        return self.rows.setdefault(term.number, f"{self._called}{len(self.rows)}")

    def _of_term(self, node: Sym) -> tuple[Sym, Sym]:
        """The term of which an expression's coefficients are multiples, and the factor; an expression of several terms is one itself."""
        form = self._form(node)
        return form.terms[0] if len(form.terms) == 1 else (node, self.graph.constant(1.0))

    def rate(self, term: Sym) -> str:
        """The row of m times a term's coefficients."""
        return self._rates.setdefault(term.number, f"_d{len(self._rates)}")

    def _sum(self, first: str, second: str) -> str:
        """The sum of first[j] second[m - j] for 0 < j < m."""
        first, second = sorted((first, second), key=lambda row: (row[1] != "d", row))
        return self._sums.setdefault((first, second), f"_s{len(self._sums)}")

    def _scaled(self, factor: Sym, text: str) -> str:
        """A multiple of what is a name or in brackets."""
        return text if factor.op == "constant" and factor.value == 1.0 else f"{self._value(factor)} * {text}"

    # ---- the coefficients of an order ----
    def _variable(self, node: Sym) -> str:
        if node.number in self._states:
            return f"_inverse * _f{self._states[node.number]}"
        self._carried[self._names[node.number]] = "1.0", ZERO  # time
        return ""

    def _add(self, node: Sym) -> str:
        return self._linear(self._total(node))

    _subtract = _add

    def _multiply(self, node: Sym) -> str:
        a, b = node.args
        if not (self._varies(a) and self._varies(b)):  # a multiple of a sum
            return self._linear(self._form(node))
        if a.op == "reciprocal" or b.op == "reciprocal":
            return self._quotient(node, *((a, b) if b.op == "reciprocal" else (b, a)))
        (first, by), (second, times) = self._of_term(a), self._of_term(b)
        between = self._sum(self._row(first), self._row(second))
        factor = by * times
        held = between if factor.op == "constant" and factor.value == 1.0 else f"{self._value(factor)} * {between}"
        if a is b:
            return f"fma({self._value(2.0 * by * a)}, {self._coefficient(first)}, {held})"
        ends = f"fma({self._value(by * b)}, {self._coefficient(first)}, {held})"
        return f"fma({self._value(times * a)}, {self._coefficient(second)}, {ends})"

    def _quotient(self, node: Sym, above: Sym, below: Sym) -> str:
        """q = a / b: b q = a."""
        term, factor = self._of_term(below.args[0])
        between = self._sum(self._row(term), self._row(node))
        rest = f"fma({self._value(node)}, {self._coefficient(term)}, {between})"
        apart = Form(tuple((part, by * below) for part, by in self._form(above).terms), pure=False)
        return f"fma(-{self._value(factor * below)}, {rest}, {self._linear(apart)})"

    def _bracketed(self, form: Form) -> str:
        text = self._linear(form)
        return text if text.startswith("fma(") or text.isidentifier() else f"({text})"

    def _select(self, node: Sym) -> str:
        held, yes, no = node.args
        return f"{self._bracketed(self._form(yes))} if {self._value(held)} > 0.0 else {self._bracketed(self._form(no))}"

    def _reciprocal(self, node: Sym) -> str:
        """y a = 1."""
        term, factor = self._of_term(node.args[0])
        between = self._sum(self._row(term), self._row(node))
        return f"-{self._value(factor * node)} * fma({self._coefficient(term)}, {self._value(node)}, {between})"

    def _by_slope(self, node: Sym) -> str:
        """A function y(a): m y_m is the sum of j a_j s_(m-j) with its slope s = dy/da, which needs no coefficient of y beyond m - 1."""
        slope = slope_of(node)
        (a, factor), (s, times) = self._of_term(node.args[0]), self._of_term(slope)
        self._coefficient(a)
        between = self._sum(self.rate(a), self._row(s))
        inverse = self._scaled(factor * times, "_inverse")
        return f"fma({self._coefficient(a)}, {self._value(factor * slope)}, {inverse} * {between})"

    def _exp(self, node: Sym) -> str:
        """y' = y a', in parts of y at the start of the step, which may be next to nothing."""
        if node.number in self._wanted:
            return self._by_slope(node)
        a, factor = self._of_term(node.args[0])
        self._coefficient(a)
        between = self._sum(self.rate(a), self._row(node))
        return self._scaled(factor, f"fma(_inverse, {between}, {self._coefficient(a)})")

    def _log(self, node: Sym) -> str:
        """a y' = a'."""
        (a, factor), slope = self._of_term(node.args[0]), slope_of(node)
        between = self._sum(self.rate(node), self._row(a))
        return f"{self._value(factor * slope)} * fma(-_inverse, {between}, {self._coefficient(a)})"

    def _sqrt(self, node: Sym) -> str:
        """y y = a."""
        between = self._sum(self._row(node), self._row(node))
        return f"{self._value(slope_of(node))} * ({self._bracketed(self._form(node.args[0]))} - {between})"

    def _turning(self, node: Sym) -> str:
        """sin and cos of one argument that is linear in time, both at once: each needs the last coefficient of the other."""
        sine, cosine = (self.graph.call(op, node.args[0]) for op in ("sin", "cos"))
        other = cosine if node is sine else sine
        if other.number in self._lines:
            return ""
        self._names[other.number] = f"{self._names[node.number]}o"
        self._lines[other.number] = []
        self._order.append(other)
        s, c = self._names[sine.number], self._names[cosine.number]
        self._carried[s], self._carried[c] = (self._value(sine), s), (self._value(cosine), c)
        turn = f"{s}t"
        ahead = [(turn, f"_inverse * {self._value(self._rate_in_time(node.args[0]))}"), (f"{turn}c", f"{turn} * {c}")]
        self._lines[node.number] += [*ahead, (c, f"-{turn} * {s}"), (s, f"{turn}c")]
        return ""

    def _with_the_angle(self, node: Sym) -> str:
        """sin q and cos q, both at once and an order ahead, from the series of their products with w = q'.

        Of these the next coefficients are known too, but for what that of w gives, and so their rates: `rate_of`.
        """
        turning = self._turned[node.number]
        sine, cosine = (self.graph.call(op, node.args[0]) for op in ("sin", "cos"))
        other = cosine if node is sine else sine
        if other.number in self._lines:
            return ""
        own = self._names[node.number]
        self._names[other.number] = f"{own}o"
        self._lines[other.number] = []
        self._order.append(other)
        w, row, lines = self._value(turning.rate), self._row(turning.rate), []
        for each, then, sign in ((sine, cosine, "-"), (cosine, sine, "")):  # w sin q, and so cos q
            name, at = self._names[each.number], self._value(each)
            first = f"{sign}({w} * {at})"
            self._ahead[then.number] = self._names[then.number], first
            lines.append((f"{name}w", f"fma({self._coefficient(turning.rate)}, {at}, {name}r)"))
            self._carried[self._names[then.number]] = first, f"{self._names[then.number]}a"
        for each, then, sign in ((sine, cosine, "-"), (cosine, sine, "")):
            lines.append((f"{self._names[then.number]}a", f"{sign}(_ahead * {self._names[each.number]}w)"))
        for each, then, sign in ((sine, cosine, ""), (cosine, sine, "-")):
            name = self._names[each.number]
            self.rows.setdefault(each.number, f"{self._called}{len(self.rows)}")
            between = self._sums_ahead.setdefault((row, self.rows[each.number]), f"_a{len(self._sums_ahead)}")
            lines.append((f"{name}b", f"fma({self._coefficient(turning.rate)}, {self.rows[each.number]}[1], {between})"))
            lines.append((f"{name}q", f"fma({w}, {name}a, {name}b)"))
            lines.append((f"{name}d", f"fma({sign}{w}, {self._names[then.number]}w, _next * {name}b)"))
            self._carried[f"{name}r"] = f"{w} * {self._names[each.number]}", f"{name}q"
        self._lines[node.number] += lines
        return ""

    def rate_of(self, turned: Sym) -> str:
        """The coefficient of the rate of w sin q or w cos q, but for what the rate of w gives."""
        self._coefficient(turned)
        return f"{self._names[turned.number]}d"

    def _solved(self, node: Sym) -> str:
        """The solution of linear equations A x = b, all of it at once: A_0 x_m is b_m without the products of A's coefficients and x's."""
        system, left = self.graph.linear[node.number], []
        equations, rates = self._solving(system), dict[str, dict[int, Sym]]()
        for i, equation in enumerate(equations):
            text = self._linear(self._form(equation.right))
            for factor, turned, _ in equation.rates:
                of_rate = rates.setdefault(self.rate_of(turned), {})
                of_rate[i] = of_rate[i] + factor if i in of_rate else factor
            for entry, x in zip(equation.entries, system.unknowns, strict=True):
                if self._varies(entry):
                    term, factor = self._of_term(entry)
                    held = f"fma(-{self._value(factor * x)}, {self._coefficient(term)}, {text})"
                    text = f"fma(-{self._value(factor)}, {self._sum(self._row(term), self._row(x))}, {held})"
            left.append((f"{self._names[node.number]}b{len(left)}", text))
        lines = self._lines[node.number]
        lines += [(name, text) for name, text in left if text != ZERO]
        for k, x in enumerate(system.unknowns):
            if x is not node:
                self._names[x.number] = f"{self._names[node.number]}x{k}"
                self._lines[x.number] = []
                self._order.append(x)
            text = ZERO
            for of, (name, rest) in zip(system.inverse[k], left, strict=True):
                if not is_zero(of) and rest != ZERO:
                    text = f"{self._value(of)} * {name}" if text == ZERO else f"fma({self._value(of)}, {name}, {text})"
            for name, factors in rates.items():  # known last
                of = sum((system.inverse[k][i] * factor for i, factor in factors.items()), self.graph.constant(0.0))
                text = text if is_zero(of) else f"fma(-{self._value(of)}, {name}, {text})"
            lines.append((self._names[x.number], text))
        return ""

    # ---- the loop ----
    def write(self) -> None:
        """Write the coefficients."""
        w = self.w
        for row in (*self.rows.values(), *self._rates.values()):
            if row not in self._given.values():
                w.line(row, f"row({self.order + 1 + bool(self._ahead)})")
        for name, (first, _) in self._carried.items():
            w.line(name, f"1.0 * {first}")
        for row in dict.fromkeys(row for rows in (*self._sums, *self._sums_ahead) for row in rows) if self._in_halves else ():
            w.line(f"{row}[0]", ZERO)
            if row not in self._given.values():
                w.line(f"{row}[1]", ZERO)
        for row in dict.fromkeys(row for row, _ in self._sums_ahead):
            w.line(f"{row}[2]", ZERO)
        for number, (name, _) in self._ahead.items():
            w.line(f"{self.rows[number]}[1]", f"1.0 * {name}")
        for name in ("_next", "_ahead") if self._ahead else ():
            w.line(name, "1.0")
        w.begin(f"for m in {'each' if self.out else 'range'}(1, {self.order + 1})")
        w.line("_inverse", "1.0 * _ahead" if self._ahead else "1 / m")
        if self._ahead:
            w.line("_next", "_next + 1.0")
            w.line("_ahead", "1.0 / _next")
        self._write_sums()
        for term in self._order:
            for name, text in self._lines[term.number]:
                w.line(name, text)
        for term in self._order:
            self._keep(term)
        for number, text in self._kept.items():
            if number not in self._names:
                w.line(f"{self.rows[number]}[m]", f"1.0 * {text}")
        for name, (_, following) in self._carried.items():
            if name != following:
                w.line(name, following)
        w.end()

    def _write_sums(self) -> None:
        """Lines that depend on earlier coefficients alone."""
        w = self.w
        if self._in_halves:
            self._write_halves()
            return
        for name in self._sums.values():
            w.line(name, ZERO)
        squares = {rows: name for rows, name in self._sums.items() if rows[0] == rows[1] and self.out}
        self._write_products("outwards" if self.out else "range", {k: name for k, name in self._sums.items() if k not in squares})
        self._write_products("halves", squares)
        for name in squares.values():
            w.line(name, f"{name} + {name}")
        self._write_products("middle", squares)

    @property
    def _in_halves(self) -> bool:
        """Whether sums of products are two halves at once, which do not wait for one another: of long series, where sums are few."""
        return bool(self.graph.linear) and not self.out

    def _write_halves(self) -> None:
        """The same from the middle, m // 2, to both ends: there one product or, where m is odd, a pair, and then pairs.

        The coefficients that are known last come last. Rows begin with zeros: there is nothing for m = 1, and no pair where m is even.
        """
        w, middle, odd = self.w, "m >> 1", "(m - (m >> 1) - (m >> 1))"
        if not self._sums and not self._sums_ahead:
            return
        for (first, second), name in self._sums.items():
            w.line(name, ZERO if first == second else f"{first}[{middle}] * {second}[m - ({middle})]")
            if first != second:
                w.line(f"{name}o", f"{first}[m - ({middle})] * {second}[{odd} * ({middle})]")
        for (first, second), name in self._sums_ahead.items():  # the outermost two are not among them
            w.line(name, f"{first}[({middle}) + 1] * {second}[{odd} * (({middle}) + 1)]")
            w.line(f"{name}o", ZERO)
        w.begin(f"for j in range(1, {middle})")
        for (first, second), name in self._sums.items():
            w.line(name, f"fma({first}[({middle}) - j], {second}[m - ({middle}) + j], {name})")
            if first != second:
                w.line(f"{name}o", f"fma({first}[m - ({middle}) + j], {second}[({middle}) - j], {name}o)")
        for (first, second), name in self._sums_ahead.items():
            w.line(name, f"fma({first}[({middle}) - j + 1], {second}[m - ({middle}) + j], {name})")
            w.line(f"{name}o", f"fma({first}[m - ({middle}) + j], {second}[({middle}) - j + 1], {name}o)")
        w.end()
        for (first, second), name in self._sums.items():
            if first == second:
                w.line(name, f"fma({first}[{middle}] + {first}[{odd} * ({middle})], {first}[m - ({middle})], {name} + {name})")
            else:
                w.line(name, f"{name} + {name}o")
        for (first, second), name in self._sums_ahead.items():
            w.line(name, f"fma({first}[1], {second}[m], {name} + {name}o)")

    def _write_products(self, over: str, sums: dict[tuple[str, str], str]) -> None:
        w = self.w
        if sums:
            w.begin(f"for j in {over}(1, m)")
            for (first, second), name in sums.items():
                w.line(name, f"fma({first}[j], {second}[m - j], {name})")
            w.end()

    def _keep(self, term: Sym) -> None:
        name = self._names[term.number]
        if term.number in self._ahead:
            self.w.line(f"{self.rows[term.number]}[m + 1]", f"1.0 * {name}a")
        elif term.number in self.rows and term.number not in self._given:
            self.w.line(f"{self.rows[term.number]}[m]", name)
        if term.number in self._rates:
            state = self._states.get(term.number)
            self.w.line(f"{self._rates[term.number]}[m]", f"m * {name}" if state is None else f"1.0 * _f{state}")
