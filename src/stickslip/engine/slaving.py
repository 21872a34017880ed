"""Whether the inner state of a law can be slaved to the velocity, decided from the traced equations; and the slaved equations."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Any

from stickslip.engine.graphs import Substituted
from stickslip.engine.symbols import STATE, Graph, Sym, is_sign
from stickslip.engine.system import System
from stickslip.engine.values import needed_by, values_of


@dataclass(frozen=True)
class Pieces:
    """A rate of several smooth pieces, chosen by flags: on one z relaxes as it does under LuGre, on one it does not relax at all."""

    rest: Sym  # the variable that stands for what z slaved is more than on the piece where it relaxes
    excess: Sym  # what that is: (rate on this piece - rate) / J, of z itself
    relaxing: dict[str, float]  # the flags on which it depends whether this is the piece, with their signs there
    free: str  # the flag that has another sign where z does not relax
    side: float  # this sign


@dataclass(frozen=True)
class Slaving:
    """An inner state z whose rate is p + J z: what z and the acceleration are by the velocity and z's rate."""

    rate: Sym  # the variable that stands for z'
    z: Sym  # (z' - p) / J
    braked: Sym  # acceleration with this z
    slope: Sym  # J
    weight: Sym  # what the acceleration changes by with z', z slaved
    deflection: Sym  # a typical z, that of steady slip at the velocity that the body would have without friction
    pieces: Pieces | None = None

    @property
    def swept(self) -> list[str]:
        """The variables that sweeps find."""
        return [self.rate.name, *([] if self.pieces is None else [self.pieces.rest.name])]

    def not_swept(self, graph: Graph) -> list[Sym]:
        """The parts of these expressions that do not depend on them."""
        nodes = [node for node in needed_by([self.z, self.braked, self.weight]) if node.level == STATE and node.args]
        return [node for node in nodes if graph.varies(node).isdisjoint(self.swept)]


def slaving(eq: System) -> Slaving | str:
    """The slaved equations of a law's inner state; or the reason why the method does not accept a machine."""
    why = _lacks(eq)
    if why:
        return why
    graph, (v, z), (_, whole) = eq.graph, eq.y, eq.f
    sides = {} if eq.signs == 1 else _relaxing(eq)
    if sides is None:
        return "the rate of the inner state is affine in it on no side of its conditions"
    rate = _on_sides(eq, sides).of(whole)
    slope = graph.derivative(rate, z)
    if z.name in graph.varies(slope):
        return "the rate of the inner state is not affine in it"
    if v.name not in graph.varies(slope):
        return "the inner state does not relax faster the faster it slips"
    braked, dz = eq.apart  # type: ignore[misc]
    rest = Substituted(graph, {z.name: graph.constant(0.0)}).of(rate)
    steady = _quotient(rest, slope)  # less
    slaved = dz * _quotient(graph.constant(1.0), slope) - steady
    pieces = None if eq.signs == 1 else _pieces(eq, sides, slope)
    if isinstance(pieces, str):
        return pieces
    if pieces is not None:
        slaved = slaved + pieces.rest
    forwards = {v.name: eq.free_velocity, eq.t.name: graph.constant(0.0), "b0": graph.constant(1.0)}
    deflection = abs(Substituted(graph, forwards).of(steady))
    if deflection.level == STATE:
        return "the inner state of steady slip depends on more than the velocity"
    weight = graph.derivative(braked, z) * _quotient(graph.constant(1.0), slope) + graph.derivative(braked, dz)
    to = Substituted(graph, {z.name: slaved})
    return Slaving(dz, slaved, to.of(braked), slope, to.of(weight), deflection, pieces)


def _lacks(eq: System) -> str:
    """Features that the steps do not support."""
    if eq.apart is None or len(eq.contacts) != 1 or eq.states != 2 or not eq.cyclic:
        return "it is for one body on one contact under a law with one inner state, whose place does not matter"
    if len(eq.guards) != eq.signs or eq.switches or eq.modes:
        return "it knows no conditions but the side of the velocity, and those on which rates depend continuously"
    if eq.passive or eq.signals or eq.sampling or eq.contacts[0].balances or eq.contacts[0].creep_velocity is not None:
        return "it does not note what is asked for"
    if eq.t.name not in eq.graph.varies(eq.f[0]) and not eq.clocks and not eq.impulses:
        return "nothing drives the body"
    return ""


# ---- rates of several pieces ----
def _relaxing(eq: System) -> dict[str, float] | None:
    """The sides of its conditions, as few as it takes, where the rate is affine in z and relaxes the faster the faster it slips."""
    graph, (v, z), (_, rate) = eq.graph, eq.y, eq.f
    for chosen in product((1.0, -1.0), repeat=eq.signs - 1):
        sides = dict(zip(_flags(eq), chosen, strict=True))
        piece = _on_sides(eq, sides).of(rate)
        slope = graph.derivative(piece, z)
        varied = [graph.varies(_on_sides(eq, {"b0": side}).of(slope)) for side in (1.0, -1.0)]  # forwards and backwards
        if all(v.name in names and z.name not in names for names in varied):
            for flag in _flags(eq):
                if _on_sides(eq, {name: side for name, side in sides.items() if name != flag}).of(rate) is piece:
                    del sides[flag]
            return sides
    return None


def _pieces(eq: System, relaxing: dict[str, float], slope: Sym) -> Pieces | str:
    """What series need to know of the other pieces of a rate; or why they cannot."""
    graph, z, rate = eq.graph, eq.y[1], eq.f[1]
    if any(node.op == "flag" and node.name in _flags(eq)[k:] for k, guard in enumerate(eq.guards[1:]) for node in needed_by([guard])):
        return "its conditions depend on one another"
    free = [(flag, side) for flag in _flags(eq) for side in (1.0, -1.0) if z.name not in graph.varies(_on_sides(eq, {flag: side}).of(rate))]
    if not free:
        return "the inner state relaxes on all sides of its conditions"
    if _jumps(eq):
        return "a rate jumps at one of its conditions"
    excess = _quotient(_difference(_on_sides(eq, relaxing).of(rate), rate), slope)
    return Pieces(graph.variable("rest"), excess, relaxing, *free[0])


def _flags(eq: System) -> list[str]:
    """The names of all flags but that of the velocity's side."""
    return [f"b{k}" for k in range(1, eq.signs)]


def _on_sides(eq: System, sides: dict[str, float]) -> Substituted:
    """What turns expressions into those on some sides of conditions."""
    return Substituted(eq.graph, {flag: eq.graph.constant(side) for flag, side in sides.items()})


def _jumps(eq: System) -> bool:
    """Whether a rate jumps wherever some flag changes: asked on straight ways through numbers of no meaning, on which v keeps its sign."""
    import numpy as np

    of, count = np.random.default_rng(20261130), 200
    numbers = {name: of.uniform(0.5, 1.5, count) for name in eq.names}
    states = [node.name for node in (*eq.y, eq.t)]
    start, way = ({name: of.normal(0.0, 2.0, count) for name in states} for _ in range(2))
    start["v"], way["v"] = abs(start["v"]), abs(way["v"])

    def at(part: Any) -> dict[str, Any]:
        known = numbers | {name: start[name] + part * way[name] for name in states} | {"b0": np.ones(count)}
        known |= {clock.name: 1.0 for clock in eq.clocks} | {f"clk{k}": 1.0 for k in range(len(eq.clocks))}
        for flag, guard in zip(_flags(eq), eq.guards[1:], strict=True):
            known[flag] = np.where(values_of(eq.graph, known, [guard])[guard.number] > 0.0, 1.0, -1.0)
        return known

    low, high, first = np.zeros(count), np.ones(count), at(0.0)
    for _ in range(40):
        middle = 0.5 * (low + high)
        now = at(middle)
        same = np.all([now[flag] == first[flag] for flag in _flags(eq)], axis=0)
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    (one, other), rate = (at(low), at(high)), eq.f[1]
    before, after = (values_of(eq.graph, known, [rate])[rate.number] for known in (one, other))
    jumps = abs(after - before) > 1e-6 * (1.0 + abs(before))
    changes = [one[flag] != other[flag] for flag in _flags(eq)]
    return any(bool(np.any(change)) and bool(np.all(jumps[change])) for change in changes)


def _difference(a: Sym, b: Sym) -> Sym:
    """a - b, what both have in common as a factor or as a term taken out."""
    graph = a.graph
    if a.op == b.op == "subtract" and a.args[0] is b.args[0]:
        return _difference(b.args[1], a.args[1])
    left, right, common = list[Sym](), _factors(b), graph.constant(1.0)
    for node in _factors(a):
        k = next((k for k, other in enumerate(right) if other is node), None)
        if k is None:
            left.append(node)
        else:
            common = common * right.pop(k)
    if len(right) == len(_factors(b)):
        return a - b
    return common * _difference(_product(graph, left), _product(graph, right))


def _product(graph: Graph, factors: list[Sym]) -> Sym:
    total = graph.constant(1.0)
    for factor in factors:
        total = total * factor
    return total


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
        quotient = quotient * (
            node if _is_own_reciprocal(node) else node.args[0] if node.op == "reciprocal" else graph.constant(1.0) / node
        )
    return quotient


def _factors(node: Sym) -> list[Sym]:
    """The factors of a product."""
    return [f for arg in node.args for f in _factors(arg)] if node.op == "multiply" else [node]


def _is_own_reciprocal(node: Sym) -> bool:
    """Whether it is 1 or -1, as a flag or by the choice of one."""
    return is_sign(node) or (node.op == "select" and all(arg.op == "constant" and abs(arg.value) == 1.0 for arg in node.args[1:]))
