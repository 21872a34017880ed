"""The value of what a law writes down when it is called with the engine's symbols."""

from __future__ import annotations

import math
from typing import Any

from stickslip.engine.symbols import Graph, Sym

__all__ = ["traced", "values_of"]


def traced(law: Any, load: float, v: float, z: tuple[float, ...], mode: tuple[int, ...], applied: float) -> tuple[Any, ...]:
    """Force and rates of a law called with symbols, as numbers."""
    from stickslip.fields import leaves, replace_leaf
    from stickslip.friction.probe import Probe

    graph, numbers = Graph(), dict(leaves(law))
    known: dict[str, float] = {f"law.{name}": value for name, value in numbers.items()}
    symbolic = replace_leaf(law, {name: graph.case(f"law.{name}") for name in numbers})
    known |= {"load": load, "v": v, "applied": applied}
    known |= {f"z{i}": value for i, value in enumerate(z)} | {f"mode{i}": value for i, value in enumerate(mode)}
    probe = Probe(symbolic, graph.case("load"))
    state = graph.variable("v"), tuple(graph.variable(f"z{i}") for i in range(len(z)))
    held = tuple(graph.case(f"mode{i}") for i in range(len(mode)))
    found = [probe.force(*state, held, graph.variable("applied")), *probe.rate(*state, held)]
    values = values_of(graph, known)
    return tuple(values[node.number] if isinstance(node, Sym) else node for node in found)


def values_of(graph: Graph, known: dict[str, float]) -> list[float]:
    """The value of every node of a graph, its flags set by their guards."""
    values: list[float] = []
    for node in graph.nodes:
        values.append(_value(node, values, known, graph))
    return values


def _value(node: Sym, values: list[float], known: dict[str, float], graph: Graph) -> float:
    a = [values[arg.number] for arg in node.args]
    match node.op:
        case "constant":
            return node.value
        case "case" | "variable":
            return known[node.name]
        case "flag":  # of a condition on time alone, or of a guard
            held = graph.clocks[int(node.name[3:])] if node.name.startswith("clk") else graph.guards[int(node.name[1:])]
            return 1.0 if values[held.number] > 0 else -1.0
        case "add":
            return a[0] + a[1]
        case "subtract":
            return a[0] - a[1]
        case "multiply":
            return a[0] * a[1]
        case "select":
            return a[1] if a[0] > 0 else a[2]
        case "reciprocal":
            return 1.0 / a[0] if a[0] else math.copysign(math.inf, a[0])
    try:
        return getattr(math, node.op)(a[0])
    except (ValueError, OverflowError):  # in a branch that is not taken
        return math.nan
