"""What the coefficients of a Taylor polynomial cannot foresee, and how a step is kept from going past it.

A function such as exp(-(v/v_s)^2) and all its coefficients are below rounding many v_s away from rest, and yet its peak may lie within
the step. Three things keep a step honest. It ends where the argument of an exponential rises to `FLOOR`, which is found as an
event is: as the zero of a polynomial. It keeps to a part of the distance to the nearest pole of a quotient. And when it
has been taken its polynomial is held against the equation, at its end and between, and it is cut until the two agree (`misses`).
Equations that are polynomials of low degree, with sines of time in them, hide nothing, and pay for nothing.
"""

from __future__ import annotations

from stickslip.engine.rosenbrock import Step
from stickslip.engine.steptext import used, without_branches
from stickslip.engine.symbols import Graph, Sym
from stickslip.engine.trace import Equations
from stickslip.engine.write import Writer, horner, literal

__all__ = ["FLOOR", "NEAR_POLE", "POINTS", "active", "hides", "misses"]

FLOOR = -45.0  # e to this is 3e-20: an exponential below it is nothing beside the friction of which it is a part
NEAR_POLE = 1e-5  # of a quotient: its last terms in a step are at most this, which is half the way to a pole
DEGREE = 4  # polynomials up to this degree show in the last of 16 coefficients, also where a state begins at zero
POINTS = 8  # of a step at which the polynomial is held against the equation: one vector
MISFIT = 2e-14  # of the free velocity: what a misfit may add to the velocity in a step
ROUNDING = 3e-14  # of the terms of the polynomial's slope: a misfit below it is rounding

#: The choices on the way to a part of an equation: what is asked, and whether it must be above zero.
Way = tuple[tuple[Sym, bool], ...]


def hides(eq: Equations) -> bool:
    """Whether the acceleration is no polynomial of low degree, so that something in it may come up within a step unseen."""
    return _degree(eq.graph, eq.f[0], {}) > DEGREE


def _degree(graph: Graph, node: Sym, known: dict[int, float]) -> float:
    """Degree of a polynomial in time and the states, in which a sine of time counts half; infinite for what is no such polynomial."""
    if node.number not in known:
        known[node.number] = 0.0 if not graph.varies(node) else 1.0 if node.op == "variable" else _composed(graph, node, known)
    return known[node.number]


def _composed(graph: Graph, node: Sym, known: dict[int, float]) -> float:
    degrees = [_degree(graph, a, known) for a in node.args]
    if node.op in ("add", "subtract", "select"):
        return max(degrees)
    if node.op == "multiply":
        return sum(degrees)
    of_time = graph.varies(node) == {"t"} and degrees[0] <= 1.0
    return 0.5 if node.op in ("sin", "cos") and of_time else float("inf")


def active(eq: Equations, op: str) -> dict[Sym, list[Way]]:
    """The varying functions of one kind in the acceleration and the guards, each with the ways that lead to it."""
    found: dict[Sym, list[Way]] = {}
    seen: set[tuple[int, Way]] = set()
    stack: list[tuple[Sym, Way]] = [(root, ()) for root in (eq.f[0], *eq.guards[1:])]
    while stack:
        node, way = stack.pop()
        if (node.number, way) in seen or not eq.graph.varies(node):
            continue
        seen.add((node.number, way))
        if node.op == op:
            found.setdefault(node, []).append(way)
        if node.op == "select":
            held, yes, no = node.args
            stack += [(yes, (*way, (held, True))), (no, (*way, (held, False)))]
        else:
            stack += [(a, way) for a in node.args]
    return found


def misses(eq: Equations, step: Step) -> str:
    """Text of the function that holds a step's polynomial against the equation; empty where nothing hides.

    It returns the number of the first of `POINTS` points, evenly spaced up to `part` of the step, at which they differ.
    """
    if not hides(eq):
        return ""
    w = Writer()
    w.case_nodes = list(step.case_nodes)
    free = w.value(eq.free_velocity, {})
    lines = _misfit(eq, step, w)
    if len(w.case_nodes) > len(step.case_nodes):
        raise AssertionError("the check of a step needs a number that the step does not hold")
    sizes = " + ".join(f"{m}.0 * abs(_k0_{m})" for m in range(1, step.degree + 1))
    text = [
        '@njit("int64(int64, float64, float64[::1])", **OPTIONS)',
        "def missed(lane, part, S):",
        *(f"    {line}" for line in _held(step, w, lines)),
        f"    allowed = {literal(MISFIT)} * {free} + {literal(ROUNDING)} * part * ({sizes})",
        f"    first = {POINTS}",
        f"    for j in range({POINTS}):",
        f"        _x = part * {literal(1 / POINTS)} * (j + 1)",
        *(f"        {line}" for line in lines),
        f"        first = min(first, {POINTS} if abs(_misfit) * part <= allowed else j)",
        "    return first",
    ]
    return without_branches("\n".join(text))


def _misfit(eq: Equations, step: Step, w: Writer) -> list[str]:
    """Lines from the place _x in the step to the _misfit there: the polynomial's slope less what the equation says, in one step."""
    powers = range(step.degree + 1)
    states = [w.line(f"_s{i}", horner([f"_k{i}_{m}" for m in powers], "_x")) for i in range(eq.states)]
    bind = {s.name: name for s, name in zip(eq.y, states, strict=True)} | {"t": w.line("_time", "fma(_x, _hh, _t)"), "mode0": "_mode0"}
    bind |= {f"b{k}": f"_b{k}" for k in range(eq.signs)} | {f"clk{k}": f"_clk{k}" for k in range(len(eq.clocks))}
    slope = horner(["_k0_1", *(f"{m}.0 * _k0_{m}" for m in powers[2:])], "_x")
    w.line("_misfit", f"({slope}) - _hh * {w.value(eq.f[0], bind)}")
    return w.lines


def _held(step: Step, w: Writer, lines: list[str]) -> list[str]:
    """Lines that read what the lane holds and the others ask for."""
    asked = used(lines) | {f"k0_{m}" for m in range(1, step.degree + 1)}
    fields = [f"_{name} = S[{i} * L + lane]" for i, name in enumerate(step.fields) if name in asked]
    return fields + [f"_c{j} = S[F_C + {j} * L + lane]" for j in range(len(w.case_nodes))]
