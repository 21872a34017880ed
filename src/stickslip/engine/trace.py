"""From a model to its equations: call its plain Python with symbols and write down what comes out."""

from __future__ import annotations

from dataclasses import replace
from itertools import accumulate, pairwise
from typing import Any

import numpy as np

from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError
from stickslip.basics.fields import replace_leaf
from stickslip.basics.maths import maximum, pi
from stickslip.basics.status import Status
from stickslip.engine.as_written import check_as_written
from stickslip.engine.contact_equations import Assembly, add_contacts, add_stop, borders_of_loads, loads_that_end
from stickslip.engine.graphs import Substituted
from stickslip.engine.law_checks import explained
from stickslip.engine.observed import Observed, with_signals
from stickslip.engine.refused import refused
from stickslip.engine.sums import terms_of
from stickslip.engine.symbolic import SPAN, Symbolic, numbers_of
from stickslip.engine.symbols import STATE, Graph, Sym, TraceError
from stickslip.engine.system import System, TracedSwitch
from stickslip.engine.values import held_by, needed_by, values_of
from stickslip.models.machine_adapter import machine_of

_ENDLESS = 1e300  # m: the scale of a position on which nothing depends
_AS_FAR, _AS_NEAR = (3.0, 3.0, 12.0, 12.0, 100.0, 1e3), 1e-9  # where positions are held against those a turn further, and how near
_NO_DRIVE = 1e-12  # m/s: a velocity for steps where the drive is off and the law has no velocity of its own


def label(model: Model) -> str:
    """The name of a model's kind: ``LuGre × Harmonic``."""
    return machine_of(model).kind_name


def trace(model: Model, observe: Observed = (), noted: bool = False) -> System:
    """The equations of a model; `InputError` says what to change in a law, or an observable, that cannot be traced.

    With `noted` one body on one contact has signals too, as others have.
    """
    return explained(lambda model: _trace(model, observe, noted), model)


def _trace(model: Model, observe: Observed, noted: bool) -> System:
    mechanics = machine_of(model).mechanics
    if (reason := refused(model)) and not mechanics.single:  # of one body equations are asked that no kernel is made of
        raise InputError(type(model).__name__, [reason])
    if not mechanics.knows_place:
        eq = _traced(model, True, observe, noted)
        check_as_written(model)
        return eq
    eq = _traced(model, False, (), noted)
    check_as_written(model)
    if _only_differences(eq):
        return _traced(model, True, observe, noted)
    return _traced(model, False, observe, noted) if observe else eq


def _only_differences(eq: System) -> bool:
    """Whether the positions appear as differences only: what a common shift changes is zero, at any numbers."""
    graph, positions = eq.graph, [eq.y[i] for i in eq.positions]
    changes = []
    for node in (*eq.f[: eq.positions.start], *eq.guards, *eq.sampled.values(), *eq.heights):
        total = graph.constant(0.0)
        for position in positions:
            total = total + graph.derivative(node, position)
        changes.append((total, [graph.derivative(node, position) for position in positions]))
    numbers = np.random.default_rng(20261122)
    for _ in range(4):
        known = {name: numbers.uniform(0.5, 1.5) for name in (*eq.names, SPAN, *(s.name for s in (*eq.y, eq.t)))}
        known |= {mode.name: float(numbers.integers(-1, 2)) for mode in eq.modes}
        computed = values_of(graph, known, [node for total, parts in changes for node in (total, *parts)])
        for total, parts in changes:
            if abs(computed[total.number]) > 1e-9 * sum(abs(computed[part.number]) for part in parts):
                return False
    return True


def _traced(model: Model, cyclic: bool, observe: Observed, noted: bool = False) -> System:
    m = Symbolic(model, cyclic)
    if m.single:
        _check_contact(model)
    graph, zero = m.graph, m.graph.constant(0.0)
    speeds = [law.velocity_scale() for law in m.laws]
    speed = next((each for each in speeds if each is not None), None)
    scale = _velocity_scale(m, m.machine.velocity_scale, speed)
    for y in m.y:
        graph.units[y.name] = graph.select(scale, scale, graph.constant(1.0))
    parts = Assembly(m, scale)
    add_contacts(parts, [None if each is None else m.lift(each) for each in speeds])
    for stop in m.equations.stops:
        add_stop(parts, stop)
    moved = m.accelerations(parts.forces)
    f = tuple(a if own is None else own for a, own in zip(moved, parts.f, strict=True))
    positions = tuple(position for position in m.places if position is not zero)
    rates = m.v if not cyclic else tuple(v - m.v[0] for v in m.v[1:])
    n = len(m.y)
    held = range(n + len(parts.inner), n + len(parts.inner) + len(m.held))
    y, f = (*m.y, *parts.inner, *m.held, *positions), (*f, *parts.rates, *m.held_rates(), *rates)
    distance = None if m.single or model.period is None else scale * m.period(model) / (2 * pi)
    for i in range(len(m.laws)):
        if m.loads[i].level >= STATE and not m.laws[i].flies:  # one that jumps at known instants counts too
            parts.events += [(load, {}, {}, Status.LOST) for load in loads_that_end(parts, i)]
        parts.events += [(border, {}, {}, Status.PAINLEVE) for border in borders_of_loads(parts, i)]
    guards = (*graph.guards, *(guard for guard, *_ in parts.events))

    def switch(modes: dict[int, Sym], states: dict[int, Sym], status: int = 0) -> TracedSwitch:
        return TracedSwitch(
            tuple(modes.get(k, old) for k, old in enumerate(parts.modes)), tuple(states.get(k) for k in range(len(y))), status
        )

    switches = {len(graph.guards) + k: switch(*event) for k, (_, *event) in enumerate(parts.events)}
    switches |= {parts.contacts[i].guard or 0: switch(*changes) for i, changes in parts.at_rest.items()}
    eq = System(
        graph=graph, names=m.names, t=m.t, y=y, f=f,
        bodies=tuple((name, m.equations.coordinate_of(name)) for name in m.equations.bodies),
        slips_of=m.equations.slips_of, single=m.single, principal=m.machine.principal, offsets=m.offsets, contacts=tuple(parts.contacts),
        guards=guards, signs=len(graph.guards), switches=switches,
        modes=tuple(parts.modes), first_modes=tuple(parts.first_modes),
        clocks=tuple(graph.clocks), instants=tuple(instant for clock in graph.clocks for instant in instants_of(graph, clock, m.t)),
        impulses=tuple((m.lift(instant), tuple(map(m.lift, jumps))) for instant, jumps in m.equations.jumps),
        period=m.period(model), velocity_scale=scale,
        free_velocity=_velocity_scale(m, m.machine.free_velocity, speed),
        scales=((None,) * n if m.single else (scale,) * n) + (*parts.scales, *m.held_scales, *(distance for _ in positions)),
        cyclic=cyclic, mass=m.lift(m.equations.masses[0]), shares=_shares(m), offered=_offered(m) if m.single else None,
        free=m.accelerations({})[0], inertia=_inertia(m), apart=_apart(m, parts), **_of_controllers(m, held),
    )  # fmt: skip
    if m.equations.joined and distance is not None:
        eq = replace(eq, scales=_of_what_matters(eq))
    if model.period is not None and not cyclic:
        eq = replace(eq, lengths=_lengths(eq, m))
    return eq if m.single and not observe and not noted else with_signals(eq, parts, observe)


def _of_what_matters(eq: System) -> tuple[Sym | None, ...]:
    """The scales of the states; positions on which nothing depends are as if all were the same, so that what goes on repeats."""
    nodes = (*eq.f[: eq.positions.start], *eq.guards, *eq.sampled.values(), *eq.heights)
    varied, endless = frozenset[str]().union(*map(eq.graph.varies, nodes)), eq.graph.constant(_ENDLESS)
    loose = [i for i in eq.positions if eq.y[i].name not in varied]
    return tuple(endless if i in loose else scale for i, scale in enumerate(eq.scales))


def _lengths(eq: System, m: Symbolic) -> tuple[Sym | None, ...]:
    """After which length each state comes again in all equations: a turn of an angle, a wave of the track; or None."""
    graph, wave = eq.graph, m.machine.wavelength
    circles = [node for node in graph.nodes if node.op in ("sin", "cos")]
    lengths: list[Sym | None] = [None] * eq.states
    for i in eq.positions:
        if wave is not None:
            lengths[i] = m.lift(wave)
        elif any(eq.y[i].name in graph.varies(node) for node in circles):
            lengths[i] = graph.constant(2 * pi)
    return tuple(None if length is None else _coming_again(eq, i, length) for i, length in enumerate(lengths))


def _coming_again(eq: System, i: int, length: Sym) -> Sym | None:
    """The length, if the equations are the same where a position is so much larger; None if they are not.

    Where it takes some of the numbers to be zero, as the stiffness of a spring, the case decides: it is then zero in a case that differs.
    """
    graph, position, places = eq.graph, eq.y[i].name, _places(eq)
    nodes = [*eq.f[: eq.positions.start], *eq.guards, *eq.sampled.values(), *eq.heights]
    numbers = dict(zip((*eq.names, SPAN), np.random.default_rng(20261130).uniform(0.5, 1.5, 1 + len(eq.names)), strict=True))

    @np.errstate(all="ignore")  # a number that is zero may be one to divide by
    def other(nodes: list[Sym], numbers: dict[str, Any]) -> list[Sym]:
        step, varied = values_of(graph, numbers, [length])[length.number], set[int]()
        for at in places:
            here, there = (values_of(graph, numbers | at | {position: at[position] + far}, nodes) for far in (0.0, step))
            varied |= {n.number for n in nodes if not abs(here[n.number] - there[n.number]) <= _AS_NEAR * (1.0 + abs(here[n.number]))}
        return [node for node in nodes if node.number in varied]

    differ = other(nodes, numbers)
    alike = [name for name in eq.names if differ and len(other(differ, numbers | {name: np.float64(0.0)})) < len(differ)]
    if not differ:
        return length
    if not alike or other(differ, numbers | dict.fromkeys(alike, np.float64(0.0))):
        return None
    excess = graph.constant(0.0)
    for at in places[1::4]:  # near, and far away
        here, there = (_at(eq, differ, {**at, position: at[position] + far}) for far in (0.0, length))
        for a, b in zip(here, there, strict=True):
            excess = maximum(excess, abs(a - b) - _AS_NEAR * (1.0 + abs(a)))
    return graph.select(excess, graph.constant(0.0), length)


def _places(eq: System) -> list[dict[str, float]]:
    """Instants, states and modes at which equations are held against those a length further, positions ever farther away."""
    draw, places = np.random.default_rng(20261130), []
    for far in _AS_FAR:
        at = {s.name: draw.uniform(0.5, 1.5) for s in (*eq.y, eq.t)}
        at |= {eq.y[j].name: far * draw.uniform(-1.0, 1.0) for j in eq.positions}
        places.append(at | {mode.name: float(draw.integers(-1, 2)) for mode in eq.modes})
    return places


def _at(eq: System, nodes: list[Sym], where: dict[str, Any]) -> list[Sym]:
    """Expressions of the numbers of a case: what nodes are at an instant in a state."""
    graph = eq.graph
    leaves = {name: value if isinstance(value, Sym) else graph.constant(value) for name, value in where.items()}
    for flag in (node for node in needed_by(nodes) if node.op == "flag" and node.name not in leaves):
        (held,) = held_by(flag)
        leaves[flag.name] = graph.select(Substituted(graph, leaves).of(held), graph.constant(1.0), graph.constant(-1.0))
    substituted = Substituted(graph, leaves)
    return [substituted.of(node) for node in nodes]


def _apart(m: Symbolic, parts: Assembly) -> tuple[Sym, Sym] | None:
    """The friction force of one body by the law's inner state and its rate as if they were two variables; for one inner state."""
    law = m.laws[0] if m.single else None
    if law is None or not law.dynamic or law.states != 1 or law.modes or law.needs_applied:
        return None
    conditions, rate = len(m.graph.guards), m.graph.variable("zdot")
    braked = m.accelerations({0: law.force(m.slips[0], tuple(parts.inner), (rate,), m.loads[0], (), None)})[0]
    return (braked, rate) if len(m.graph.guards) == conditions else None


def _of_controllers(m: Symbolic, held: range) -> dict[str, Any]:
    """The states that controllers hold, and what a sample makes of them."""
    parts = m.equations.controllers
    if not held:
        return {}
    ends = list(accumulate(parts.counts, initial=held.start))
    named = tuple((name, states, tuple(range(*of))) for name, states, of in zip(parts.names, parts.states, pairwise(ends), strict=True))
    new = {i: value for i, old, value in zip(held, m.held, m.held_after_sample(), strict=True) if value is not old}
    return {"controllers": named, "sampling": () if parts.sample is None else (m.lift(parts.sample),), "sampled": new}


def _shares(m: Symbolic) -> tuple[Sym, ...]:
    """Part of each coordinate in the way that the machine makes, of those whose positions are states."""
    return () if len(m.y) == 1 else tuple(map(m.lift, m.equations.shares))[m.cyclic :]


def _offered(m: Symbolic) -> Sym | None:
    """The sum of all forces but friction [N]: for a robot the drive's and gravity's share."""
    total = m.lift(m.model.total_mass) * m.accelerations({})[0]
    return total if m.graph.varies(total) <= {"t"} else None


def _check_contact(model: Model) -> None:
    """Refuse a contact whose velocity is not that of the body less a number of the case: steps know the two by their difference."""
    graph = Graph()
    v = graph.variable("v")
    velocity = replace_leaf(model, {name: graph.case(name) for name in numbers_of(model)}).contact_velocity(v)
    terms = terms_of(velocity) if isinstance(velocity, Sym) else {}
    if terms.get((v.number,)) is not graph.constant(1.0) or set(terms) - {(), (v.number,)}:
        raise TraceError("contact_velocity(v) is not v less a number; allowed is for example return v - self.speed")


def _inertia(m: Symbolic) -> Sym | None:
    """The drive force, -m d²xi/dt²."""
    drive = m.machine.drive
    return None if drive is None else -(m.machine.whole_inner_mass * m.lift(drive.acceleration(m.t)))


def instants_of(graph: Graph, clock: Sym, t: Sym) -> list[Sym]:
    """The zeros of an expression that is linear in time: t - c(t)/c'(t), which does not vary; one for each choice that is in it."""
    slope = graph.derivative(clock, t)
    return list(dict.fromkeys(-value / slope for value in _at_zero(graph, clock, t)))


def _at_zero(graph: Graph, node: Sym, t: Sym) -> list[Sym]:
    """Possible values of an expression at t = 0: a choice on time has two."""
    if node is t:
        return [graph.constant(0.0)]
    if node.level < STATE:
        return [node]
    if node.op == "select":
        return [value for arg in node.args[1:] for value in _at_zero(graph, arg, t)]
    a = [_at_zero(graph, arg, t) for arg in node.args]
    match node.op:
        case "add":
            return [x + y for x in a[0] for y in a[1]]
        case "subtract":
            return [x - y for x in a[0] for y in a[1]]
        case "multiply":
            return [x * y for x in a[0] for y in a[1]]
    raise TraceError(f"a condition on time has {node.op} in it; write it as where(within(t, period) < instant, ...)")


def _velocity_scale(m: Symbolic, driven: Any, speed: Any) -> Sym:
    """A velocity of the drive, and something positive where the drive is off: steps are as exact as this, so they need some length."""
    least = m.graph.constant(_NO_DRIVE) if speed is None else 1e-9 * m.lift(speed)
    return maximum(m.lift(driven), least)
