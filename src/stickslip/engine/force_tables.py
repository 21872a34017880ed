"""Forces of many parts as tables: parts whose traced forces differ in numbers alone share one text, and each is a row of numbers.

A machine of a thousand blocks has a thousand contacts under one law. Its equations are not written out: the law is traced for each
contact with its numbers as they are, what is traced is stripped of its numbers, and contacts with the same remainder are rows of one table.
So the text of a kernel, and the time that it takes to compile, do not grow with the number of parts (`kernels/local_events.py`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from stickslip.engine.kernel_text import function
from stickslip.engine.symbols import STATE, Graph, Sym, TraceError, slope_of
from stickslip.engine.values import needed_by
from stickslip.engine.write import Writer

#: Operations by which the coefficients of a force follow from those of one argument at the same order.
_LINEAR = ("variable", "case", "constant", "add", "subtract")


@dataclass(frozen=True)
class ForceForm:
    """A force without its numbers, as an expression of variables and of the numbers c0, c1, … of a row."""

    key: tuple[Any, ...]  # equal for forces that differ in numbers alone
    root: Sym
    inputs: tuple[Sym, ...]
    numbers: tuple[float, ...]  # of the part that was traced

    @property
    def operations(self) -> set[str]:
        """The operations of which it is made."""
        return {node.op for node in needed_by([self.root])}

    @property
    def is_linear(self) -> bool:
        """Whether it is linear in its variables, so that its series holds at any distance."""
        return all(node.op in _LINEAR or (node.op == "multiply" and min(a.level for a in node.args) < STATE) for node in _nodes(self.root))


def traced(inputs: tuple[str, ...], force: Callable[..., Any], side: float = 0.0) -> ForceForm:
    """A force as a function of variables; with a side the sign of the first one is known.

    Raises
    ------
    TraceError
        If it has conditions on its variables, or cannot be traced.

    Examples
    --------
    >>> first, second = (traced(("d", "r"), lambda d, r, k=k: k * (d - 0.1)) for k in (3.0, 5.0))
    >>> first.key == second.key, sorted(first.numbers), sorted(second.numbers), first.is_linear
    (True, [-0.1, 3.0], [-0.1, 5.0], True)
    """
    graph = Graph()
    graph.begins_anew = False
    variables = tuple(map(graph.variable, inputs))
    if side:
        graph.assumed[variables[0].number] = side
    value = force(*variables)
    root = value if isinstance(value, Sym) else graph.constant(float(value))
    held = [node for node in needed_by([root]) if node.op in ("flag", "select")]
    if graph.guards or graph.clocks or held:
        raise TraceError("a force of many parts has conditions on the state or on time")
    return _stripped(root, inputs)


def _stripped(root: Sym, inputs: tuple[str, ...]) -> ForceForm:
    """A traced force with a number of its own in each place where one stands."""
    graph = Graph()
    graph.begins_anew = False
    variables = tuple(map(graph.variable, inputs))
    made: dict[int, Sym] = {}
    places: dict[int, int] = {}
    key: list[Any] = [inputs]
    numbers: list[float] = []
    for node in needed_by([root]):
        if node.op == "constant":
            continue
        if node.op == "variable":
            made[node.number] = variables[inputs.index(node.name)]
            places[node.number] = inputs.index(node.name)
            continue
        args, shape = [], []
        for arg in node.args:
            if arg.op == "constant":
                args.append(graph.case(f"c{len(numbers)}"))
                shape.append(-1)
                numbers.append(arg.value)
            else:
                args.append(made[arg.number])
                shape.append(places[arg.number])
        places[node.number] = len(inputs) + len(made)
        made[node.number] = graph._node(node.op, tuple(args))
        key.append((node.op, places[node.number], *shape))
    if root.op == "constant":
        made[root.number] = graph.case("c0")
        numbers, key = [root.value], [inputs, "constant"]
    return ForceForm((*key, places.get(root.number, -1)), made[root.number], variables, tuple(numbers))


def _nodes(root: Sym) -> list[Sym]:
    """An expression's nodes that vary, with the slopes that their series need, arguments before what is made of them."""
    known: dict[int, Sym] = {}
    waiting = [root]
    while waiting:
        for node in needed_by([waiting.pop()]):
            if node.number not in known and node.level == STATE:
                known[node.number] = node
                if node.op not in ("variable", "add", "subtract", "multiply", "reciprocal", "exp"):
                    waiting.append(slope_of(node))
    return sorted(known.values(), key=lambda node: node.number)


class _ValueWriter(Writer):
    """Lines of values whose numbers may have any sign."""

    def __init__(self) -> None:
        super().__init__(prefix="p")

    def _exp(self, x: str, falling: bool) -> str:
        return super()._exp(x, falling=False)


@dataclass
class Tables:
    """The forces of one sort of part, such as all links: distinct texts, and the rows of numbers of all parts one after another."""

    name: str
    inputs: tuple[str, ...]
    forces: list[ForceForm] = field(default_factory=list)
    _known: dict[tuple[Any, ...], int] = field(default_factory=dict)

    def kind(self, force: ForceForm) -> int:
        """The number of a force's text."""
        if force.key not in self._known:
            self._known[force.key] = len(self.forces)
            self.forces.append(force)
        return self._known[force.key]

    @property
    def rows(self) -> int:
        """Rows of coefficients that a part needs: its inputs, its force, and what its force is made of."""
        return max((len(self.inputs) + 1 + len(_nodes(force.root)) for force in self.forces), default=1)

    def text(self, orders: int) -> str:
        """Functions for the value of a force, `<name>_value`, and the coefficient m of its series, `<name>_series`.

        A series has `orders` coefficients in each row of an array W: the rows of the inputs come first, then that of the force.
        """
        takes = ", ".join(self.inputs)
        parts, values, series = [], [], []
        for k, force in enumerate(self.forces):
            parts += [self._value(k, force), self._series(k, force, orders)]
            values += [f"if kind == {k}:", f"    return {self.name}_value_{k}(NUM, at, {takes})"]
            series += [f"if kind == {k}:", f"    {self.name}_series_{k}(m, NUM, at, W)"]
        kinds = ", ".join(["float64"] * len(self.inputs))
        parts.append(
            function(f"{self.name}_value", f"kind, NUM, at, {takes}", [*values, "return 0.0"], f"float64(int64, f1, int64, {kinds})")
        )
        parts.append(function(f"{self.name}_series", "kind, m, NUM, at, W", [*series, "return"], "void(int64, int64, f1, int64, f1)"))
        return "\n".join(parts)

    def _bind(self, force: ForceForm) -> dict[str, str]:
        return {f"c{i}": f"NUM[at + {i}]" for i in range(len(force.numbers))}

    def _value(self, k: int, force: ForceForm) -> str:
        w = _ValueWriter()
        value = w.value(force.root, self._bind(force) | {name: name for name in self.inputs})
        kinds = ", ".join(["float64"] * len(self.inputs))
        takes = f"NUM, at, {', '.join(self.inputs)}"
        return function(f"{self.name}_value_{k}", takes, [*w.lines, f"return 1.0 * {value}"], f"float64(f1, int64, {kinds})")

    def _series(self, k: int, force: ForceForm, orders: int) -> str:
        nodes, count = _nodes(force.root), len(self.inputs)
        row = {node.number: (count + 1 + i) * orders for i, node in enumerate(nodes)}
        row |= {node.number: self.inputs.index(node.name) * orders for node in nodes if node.op == "variable"}
        w = _ValueWriter()
        bind = self._bind(force) | {name: f"W[{i * orders}]" for i, name in enumerate(self.inputs)}
        first = [f"W[{row[n.number]}] = 1.0 * {w.value(n, bind)}" for n in nodes if n.op != "variable"]
        out, root = count * orders, force.root
        first.append(f"W[{out}] = 1.0 * {w.value(root, bind)}")
        lines = ["if m == 0:", *(f"    {line}" for line in [*w.lines, *first]), "    return"]
        later = _ValueWriter()

        def term(node: Sym) -> str:
            return f"W[{row[node.number]} + m]" if node.level == STATE else ""

        for node in nodes:
            rule = _rule(node, row, term, lambda case: later.value(case, bind))
            if rule:
                later.lines.append(f"{term(node)} = {rule}")
        last = term(root) or "0.0"
        return function(
            f"{self.name}_series_{k}", "m, NUM, at, W", [*lines, *later.lines, f"W[{out} + m] = {last}"], "void(int64, f1, int64, f1)"
        )


def _rule(node: Sym, row: dict[int, int], term: Callable[[Sym], str], number: Callable[[Sym], str]) -> str:
    """The coefficient of order m > 0 of an expression, from those of its arguments."""
    a = node.args
    match node.op:
        case "variable":
            return ""
        case "add" | "subtract":
            first, second = map(term, a)
            sign = "+" if node.op == "add" else "-"
            return f"{first} {sign} {second}" if first and second else first or (second if sign == "+" else f"-{second}")
        case "multiply":
            if term(a[0]) and term(a[1]):
                return f"product(W, {row[a[0].number]}, {row[a[1].number]}, m)"
            held, other = (a[1], a[0]) if term(a[0]) else (a[0], a[1])
            return f"{number(held)} * {term(other)}"
        case "reciprocal":
            return f"-W[{row[node.number]}] * rest(W, {row[a[0].number]}, {row[node.number]}, m)"
        case "exp":
            return f"chain(W, {row[a[0].number]}, {row[node.number]}, m)"
    slope = slope_of(node)
    return f"chain(W, {row[a[0].number]}, {row[slope.number]}, m)"
