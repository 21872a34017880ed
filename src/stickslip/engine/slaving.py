"""Whether the inner state of a law can be slaved to the velocity, decided from the traced equations; and the slaved equations."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.engine.graphs import Substituted
from stickslip.engine.symbols import STATE, Graph, Sym, is_sign
from stickslip.engine.system import System
from stickslip.engine.values import needed_by


@dataclass(frozen=True)
class Slaving:
    """An inner state z whose rate is p + J z: what z and the acceleration are by the velocity and z's rate."""

    rate: Sym  # the variable that stands for z'
    z: Sym  # (z' - p) / J
    braked: Sym  # acceleration with this z
    slope: Sym  # J
    weight: Sym  # what the acceleration changes by with z', z slaved
    deflection: Sym  # a typical z, that of steady slip at the velocity that the body would have without friction

    def not_of_rate(self, graph: Graph) -> list[Sym]:
        """The parts of these expressions that do not depend on z'."""
        nodes = [node for node in needed_by([self.z, self.braked, self.weight]) if node.level == STATE and node.args]
        return [node for node in nodes if self.rate.name not in graph.varies(node)]


def slaving(eq: System) -> Slaving | str:
    """The slaved equations of a law's inner state; or the reason why the method does not accept a machine."""
    why = _lacks(eq)
    if why:
        return why
    graph, (v, z), (_, rate) = eq.graph, eq.y, eq.f
    slope = graph.derivative(rate, z)
    if z.name in graph.varies(slope):
        return "the rate of the inner state is not affine in it"
    if v.name not in graph.varies(slope):
        return "the inner state does not relax faster the faster it slips"
    braked, dz = eq.apart  # type: ignore[misc]
    rest = Substituted(graph, {z.name: graph.constant(0.0)}).of(rate)
    steady = _quotient(rest, slope)  # less
    slaved = dz * _quotient(graph.constant(1.0), slope) - steady
    forwards = {v.name: eq.free_velocity, eq.t.name: graph.constant(0.0), "b0": graph.constant(1.0)}
    deflection = abs(Substituted(graph, forwards).of(steady))
    if deflection.level == STATE:
        return "the inner state of steady slip depends on more than the velocity"
    weight = graph.derivative(braked, z) * _quotient(graph.constant(1.0), slope) + graph.derivative(braked, dz)
    to = Substituted(graph, {z.name: slaved})
    return Slaving(dz, slaved, to.of(braked), slope, to.of(weight), deflection)


def _lacks(eq: System) -> str:
    """Features that the steps do not support."""
    if eq.apart is None or len(eq.contacts) != 1 or eq.states != 2 or not eq.cyclic:
        return "it is for one body on one contact under a law with one inner state, whose place does not matter"
    if len(eq.guards) != 1 or eq.switches or eq.modes:
        return "it knows no conditions but the side of the velocity"
    if eq.passive or eq.signals or eq.sampling or eq.contacts[0].balances or eq.contacts[0].creep_velocity is not None:
        return "it does not note what is asked for"
    if eq.t.name not in eq.graph.varies(eq.f[0]) and not eq.clocks and not eq.impulses:
        return "nothing drives the body"
    return ""


def _quotient(a: Sym, b: Sym) -> Sym:
    """a / b of products: equal factors cancel, the quotient of a quotient is none, and what is held as a sign is its own reciprocal."""
    graph, above, below = a.graph, list[Sym](), _factors(b)
    for node in _factors(a):
        k = next((k for k, other in enumerate(below) if other is node), None)
        if k is None:
            above.append(node)
        else:
            del below[k]  # one for one
    quotient = graph.constant(1.0)
    for node in above:
        quotient = quotient * node
    for node in below:
        quotient = quotient * (node if is_sign(node) else node.args[0] if node.op == "reciprocal" else graph.constant(1.0) / node)
    return quotient


def _factors(node: Sym) -> list[Sym]:
    """The factors of a product."""
    return [f for arg in node.args for f in _factors(arg)] if node.op == "multiply" else [node]
