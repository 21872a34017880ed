"""Numerical values of the expressions that a law returns for the engine's symbols."""

from __future__ import annotations

from typing import Any

from stickslip.basics.contracts import Law
from stickslip.engine.symbols import Graph, Sym
from stickslip.engine.values import values_of


def traced(law: Law, load: Any, v: float, z: tuple[float, ...], mode: tuple[int, ...], applied: float) -> tuple[Any, ...]:
    """Force and rates of a law called with symbols, as numbers."""
    from stickslip.analysis.bench.probe import Probe
    from stickslip.basics.fields import leaves, replace_leaf

    graph, numbers = Graph(), dict(leaves(law))
    known: dict[str, float] = {f"law.{name}": value for name, value in numbers.items()}
    symbolic = replace_leaf(law, {name: graph.case(f"law.{name}") for name in numbers})
    known |= {"load": load, "v": v, "applied": applied}
    known |= {f"z{i}": value for i, value in enumerate(z)} | {f"mode{i}": value for i, value in enumerate(mode)}
    probe = Probe(symbolic, graph.case("load"))
    state = graph.variable("v"), tuple(graph.variable(f"z{i}") for i in range(len(z)))
    held = tuple(graph.case(f"mode{i}") for i in range(len(mode)))
    force, rates = probe.response(*state, held, graph.variable("applied"))
    values = values_of(graph, known)
    return tuple(float(values[node.number]) if isinstance(node, Sym) else node for node in (force, *rates))
