"""Features that the coefficients of a Taylor polynomial cannot predict, and how a step is kept from passing over them.

A function such as exp(-(v/v_s)^2) and all its coefficients are below rounding many v_s away from rest, and yet its peak may lie within
the step. Three things keep a step honest. It ends where the argument of an exponential rises to `FLOOR`, which is found as an
event is: as the zero of a polynomial. It keeps to a part of the distance to the nearest pole of a quotient. And when it
has been taken its polynomial is held against the equation, at its end and between (`slopes`), and it is cut until the two agree
(``kernels/arcs.py``). Systems that are polynomials of low weight, with sines of time in them, hide nothing, and pay for nothing.
"""

from __future__ import annotations

from stickslip.engine.kernel_text import function
from stickslip.engine.linear_systems import parts_of
from stickslip.engine.rosenbrock_step import Step
from stickslip.engine.steptext import bound, held
from stickslip.engine.symbols import Graph, Sym
from stickslip.engine.system import System
from stickslip.engine.write import Writer

FLOOR = -45.0  # e to this is 3e-20: an exponential below it is nothing beside the friction of which it is a part
NEAR_POLE = 1e-5  # of a quotient: its last terms in a step are at most this, which is half the way to a pole
#: A motion from rest has positions that go as t^2 and velocities as t. A product of states of a *weight* w, 2 for each position in it
#: and 1 for each velocity, leaves every w-th coefficient of a velocity, and the one after it of a position, that are not zero.
#: Up to these weights the last two of 16 coefficients show one of them, and the last `LAST` of the order that a varying inertia has.
WEIGHT, WEIGHT_OF_INERTIA = 3.0, 6.0
LAST = 6
MISFIT = 2e-14  # of the free velocity: what a misfit may add to the velocity in a step
ROUNDING_OF_SLOPES = 3e-14  # of the terms of the polynomial's slope: a misfit below it is rounding
POINTS = 8  # of a step at which the polynomial is held against the equation: one vector

#: The choices on the way to a part of an equation: what is asked, and whether it must be above zero.
Way = tuple[tuple[Sym, bool], ...]


def hides(eq: System) -> bool:
    """Whether a slope is no polynomial of low weight, so that something in it may come up within a step unseen."""
    most = WEIGHT_OF_INERTIA if eq.graph.linear else WEIGHT
    known = {eq.y[i].number: 2.0 for i in eq.positions} | {eq.t.number: 0.5}
    return any(_weight(eq.graph, f, known) > most for f in eq.active)


def _weight(graph: Graph, node: Sym, known: dict[int, float]) -> float:
    """Weight of a polynomial in time and the states, time counts half, a sine of it nothing; infinite for any other function."""
    if node.number not in known:
        known[node.number] = 0.0 if not graph.varies(node) else 1.0 if node.op == "variable" else _composed(graph, node, known)
    return known[node.number]


def _composed(graph: Graph, node: Sym, known: dict[int, float]) -> float:
    weights = [_weight(graph, a, known) for a in parts_of(node)]
    if node.op in ("add", "subtract", "select") or node.number in graph.linear:
        return max(weights)
    if node.op == "multiply":
        return sum(weights)
    if node.op in ("sin", "cos") and graph.linear:  # of an angle: all its powers of one parity follow one another
        return weights[0] if graph.varies(node) != {"t"} else 0.0 if weights[0] <= 0.5 else float("inf")
    of_time = graph.varies(node) == {"t"} and weights[0] <= 0.5
    return 0.0 if node.op in ("sin", "cos") and of_time else float("inf")


def active(eq: System, op: str) -> dict[Sym, list[Way]]:
    """The varying functions of one kind in the slopes and the guards, each with the ways that lead to it."""
    ways: dict[Sym, list[Way]] = {}
    visited: set[tuple[int, Way]] = set()
    stack: list[tuple[Sym, Way]] = [(root, ()) for root in (*eq.active, *eq.guards)]
    while stack:
        node, way = stack.pop()
        if (node.number, way) in visited or not eq.graph.varies(node):
            continue
        visited.add((node.number, way))
        if node.number in eq.graph.linear:
            stack += [(a, way) for a in parts_of(node)]
            continue
        if node.op == op:
            ways.setdefault(node, []).append(way)
        if node.op == "select":
            held, yes, no = node.args
            stack += [(yes, (*way, (held, True))), (no, (*way, (held, False)))]
        else:
            stack += [(a, way) for a in node.args]
    return ways


def slopes(eq: System, step: Step, lanes: int) -> str:
    """Text of the function that says what the slopes are at `POINTS` instants and states.

    It takes them in rows of W (t, then each state) and puts the slope of the first state where t was, and so on.
    """
    w = Writer()
    w.case_nodes = list(step.case_nodes)
    values = [f"W[{i * POINTS} + j] = {value}" for i, value in enumerate([w.value(f, bound(eq)) for f in eq.f])]
    if len(w.case_nodes) > len(step.case_nodes):
        raise AssertionError("the check of a step needs a number that the step does not hold")
    rows = [f"{name} = W[{i * POINTS} + j]" for i, name in enumerate(["_t", *(f"_y{i}" for i in range(eq.states))])]
    body = [*rows, *w.lines, *values]
    lines = [*held(step, lanes, body), f"for j in range(0, {POINTS}):", *(f"    {line}" for line in body)]
    return function("slopes", "lane, S, W", lines)
