"""Operations on traced expressions as a whole: directional derivatives and substitution."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable

from stickslip.engine.symbols import CONSTANT, Graph, Sym, TraceError, is_zero, slope_of


class _Walk(ABC):
    """Expressions made of expressions, arguments first; each is made once."""

    def __init__(self, graph: Graph, leaves: dict[str, Sym]):
        self.graph, self.leaves = graph, leaves
        self._known: dict[int, Sym] = {}

    def of(self, node: Sym) -> Sym:
        """The transformed expression."""
        waiting = [node]
        while waiting:
            now = waiting[-1]
            missing = [] if now.number in self._known else [a for a in now.args if a.number not in self._known]
            if missing:
                waiting += missing
                continue
            waiting.pop()
            if now.number not in self._known:
                self._known[now.number] = self._made(now, [self._known[a.number] for a in now.args])
        return self._known[node.number]

    @abstractmethod
    def _made(self, node: Sym, args: list[Sym]) -> Sym:
        """The transformed node for transformed arguments."""


class Along(_Walk):
    """Derivatives along a direction, whose parts in the variables and the numbers of the case are given by name; flags are held.

    Examples
    --------
    >>> graph = Graph()
    >>> x, y, dx = graph.variable("x"), graph.variable("y"), graph.variable("dx")
    >>> Along(graph, {"x": dx}).of(x * x + y) is 2.0 * (x * dx) or Along(graph, {"x": dx}).of(3.0 * x) is 3.0 * dx
    True
    """

    def _made(self, node: Sym, args: list[Sym]) -> Sym:
        graph, a = self.graph, node.args
        match node.op:
            case "constant" | "flag":
                return graph.constant(0.0)
            case "case" | "variable":
                return self.leaves.get(node.name, graph.constant(0.0))
            case "add":
                return args[0] + args[1]
            case "subtract":
                return args[0] - args[1]
            case "multiply":
                return args[0] * a[1] + a[0] * args[1]
            case "select":
                return graph.select(a[0], args[1], args[2])
        return args[0] if is_zero(args[0]) else args[0] * slope_of(node)


class Substituted(_Walk):
    """The same expressions of other variables, flags and numbers, which are given by name.

    Examples
    --------
    >>> graph = Graph()
    >>> x, y = graph.variable("x"), graph.variable("y")
    >>> Substituted(graph, {"x": y}).of(3.0 * x + y) is 3.0 * y + y
    True
    """

    def _made(self, node: Sym, args: list[Sym]) -> Sym:
        graph = self.graph
        if not args:
            return self.leaves.get(node.name, node) if node.op != "constant" else node
        if all(new is old for new, old in zip(args, node.args, strict=True)):
            return node
        return _again(graph, node, args)


class Copied(_Walk):
    """The same expressions in another graph; what is given by name is another expression there.

    Examples
    --------
    >>> first, second = Graph(), Graph()
    >>> x = second.variable("x")
    >>> Copied(second, {"x": -x}).of(2.0 * first.variable("x") + first.case("a")) is -2.0 * x + second.case("a")
    True
    """

    def _made(self, node: Sym, args: list[Sym]) -> Sym:
        graph = self.graph
        if args:
            return _again(graph, node, args)
        if node.op == "constant":
            return graph._node("constant", (), CONSTANT, value=node.value)
        new: Callable[[str], Sym] = {"case": graph.case, "variable": graph.variable, "flag": graph.mode}[node.op]
        return self.leaves[node.name] if node.name in self.leaves else new(node.name)


def _again(graph: Graph, node: Sym, args: list[Sym]) -> Sym:
    """The operation of a node, on other arguments."""
    match node.op:
        case "add" | "subtract" | "multiply" | "select":
            made: Callable[..., Sym] = getattr(graph, node.op)
            return made(*args)
        case "reciprocal":
            return graph._node("reciprocal", (args[0],))
    try:
        return graph.call(node.op, args[0])
    except (TraceError, ArithmeticError, ValueError):  # no number, in a branch that is not taken there
        return graph._node(node.op, (args[0],))
