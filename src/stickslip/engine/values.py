"""The value of traced expressions for given numbers: one case, or arrays of them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from stickslip.engine.symbols import Graph, Sym


def values_of(graph: Graph, known: dict[str, Any], roots: Iterable[Sym] | None = None) -> dict[int, Any]:
    """The values of the nodes that some roots need (of all nodes if none are named), by their numbers; flags are set by their guards.

    Parameters
    ----------
    known : dict
        Numbers, or arrays that broadcast, by the names of the case's numbers and of the variables.

    Examples
    --------
    >>> graph = Graph()
    >>> product = graph.case("a") * graph.case("b")
    >>> values_of(graph, {"a": 2.0, "b": np.array([3.0, 4.0])})[product.number].tolist()
    [6.0, 8.0]
    """
    with np.errstate(all="ignore"):  # in a branch that is not taken
        return Arithmetic(known).values(graph.nodes if roots is None else needed_by(roots))


def needed_by(roots: Iterable[Sym]) -> list[Sym]:
    """The nodes that some roots are made of, arguments before what is made of them."""
    needed: dict[int, Sym] = {}
    waiting = [(root, False) for root in roots]
    while waiting:
        node, ready = waiting.pop()
        if ready:
            needed[node.number] = node
        elif node.number not in needed:
            waiting.append((node, True))
            waiting += [(a, False) for a in (*node.args, *(held_by(node) if node.op == "flag" else ()))]
    return list(needed.values())


def held_by(flag: Sym) -> list[Sym]:
    """The condition whose sign a flag holds: one on time alone, or a guard; None for a mode."""
    graph, name = flag.graph, flag.name
    if name.startswith("clk"):
        return [graph.clocks[int(name[3:])]]
    return [] if name.startswith("mode") else [graph.guards[int(name[1:])]]


class Arithmetic:
    """The operations of traced expressions on numbers and arrays; other kinds of number override them.

    Parameters
    ----------
    known : dict
        Numbers by the names of the case's numbers and of the variables.
    """

    def __init__(self, known: dict[str, Any]):
        self.known = known

    def values(self, nodes: Iterable[Sym]) -> dict[int, Any]:
        """The values of nodes, arguments before what is made of them, by their numbers."""
        computed: dict[int, Any] = {}
        for node in nodes:
            computed[node.number] = self._value(node, computed)
        return computed

    def _value(self, node: Sym, values: dict[int, Any]) -> Any:
        a = [values[arg.number] for arg in node.args]
        match node.op:
            case "constant":
                return self.constant(node.value)
            case "case" | "variable":
                return self.named(node.name)
            case "flag":
                held = held_by(node)
                return np.where(values[held[0].number] > 0, 1.0, -1.0) if held else self.named(node.name)
            case "add":
                return a[0] + a[1]
            case "subtract":
                return a[0] - a[1]
            case "multiply":
                below = next((k for k in (1, 0) if node.args[k].op == "reciprocal"), None)  # a quotient is rounded once
                return a[0] * a[1] if below is None else a[1 - below] / values[node.args[below].args[0].number]
            case "select":
                return self.select(*a)
            case "reciprocal":
                return self.one / a[0]
        return self.function(node.op, a[0])

    one: Any = np.float64(1.0)

    def constant(self, value: Any) -> Any:
        """A number of the expression."""
        return value

    def named(self, name: str) -> Any:
        """A number of the case, or a variable."""
        return self.known[name]

    def select(self, condition: Any, above: Any, below: Any) -> Any:
        """One of two values, as a condition is above zero or not."""
        return np.where(condition > 0, above, below)

    def function(self, name: str, x: Any) -> Any:
        """A function of one number, by NumPy's name."""
        return getattr(np, name)(x)
