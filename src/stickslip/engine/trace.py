"""From a model to its equations: call its plain Python with symbols and write down what comes out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.engine.checks import explained
from stickslip.engine.sums import terms_of
from stickslip.engine.symbols import STATE, Graph, Sym, TraceError
from stickslip.fields import leaves, replace_leaf
from stickslip.friction.adapter import law_of
from stickslip.machine import machine_of
from stickslip.maths import maximum
from stickslip.mechanics import normal_load
from stickslip.position import knows_position

__all__ = ["SPAN", "Equations", "Switch", "kind_of", "label", "numbers_of", "trace"]

#: Name of the column that holds the length of the run, for a model without a period.
SPAN = "span"
_NUMBER = object()  # in a kind, where there is a number; None is a field that has none
#: Status of a case whose load fell to zero.
LOST = 6


@dataclass(frozen=True)
class Switch:
    """What happens when a guard falls to zero, beside the flip of its flag."""

    modes: tuple[Sym, ...]  # the new modes
    states: tuple[Sym | None, ...]  # the new states; None: unchanged
    status: int = 0  # the run ends with this status


@dataclass(frozen=True)
class Contact:
    """Accelerations at a set-valued contact: while it slides, and how much is left at the limits of rest."""

    forwards: Sym
    backwards: Sym
    push: Sym  # > 0: the body breaks away forwards
    pull: Sym  # > 0: backwards


@dataclass(frozen=True)
class Equations:
    """What a step needs to know of a model.

    States are y[0] = velocity at the contact, the law's inner states after it, and x as the last where the equations need it.
    """

    graph: Graph
    names: tuple[str, ...]  # the case's numbers, in the order of a row
    t: Sym
    y: tuple[Sym, ...]
    f: tuple[Sym, ...]  # dy/dt
    offset: Sym  # velocity of the body less that at the contact
    free: Sym  # acceleration without friction
    inertia: Sym | None  # what the drive's mass does to the body [N], where there is one
    jacobian: tuple[tuple[Sym, ...], ...]
    by_time: tuple[Sym, ...]
    guards: tuple[Sym, ...]
    guard_rates: tuple[Sym, ...]  # total derivative of each guard along the flow
    signs: int  # the first guards have flags that flip; the others are positive until their switch
    switches: dict[int, Switch]  # by number of the guard
    modes: tuple[Sym, ...]
    first_modes: tuple[Sym, ...]  # from the state, at the start and after an impulse
    clocks: tuple[Sym, ...]
    instants: tuple[Sym, ...]  # when each clock's flag changes
    impulses: tuple[tuple[Sym, Sym], ...]  # instant, jump of v
    period: Sym
    velocity_scale: Sym
    free_velocity: Sym  # what the body would do without friction: the unit of strobe distances
    scales: tuple[Sym | None, ...]  # typical size of y[1:]; None: not known
    stribeck_velocity: Sym | None
    cyclic: bool
    contact: Contact | None  # of a set-valued law
    mass: Sym  # all that moves with the contact [kg]
    offered: Sym | None  # what all forces but friction add up to [N], where time alone decides it
    balances: bool  # a dynamic law that holds the body by the force that is applied: at rest its guards know time alone

    @property
    def dynamic(self) -> bool:
        """Whether the law has a rate and a force, and so never rests exactly."""
        return self.contact is None

    @property
    def states(self) -> int:
        """Number of states."""
        return len(self.y)


def label(model: Any) -> str:
    """What a model's kind is called: ``LuGre × Harmonic``."""
    drive, track = machine_of(model).drive, machine_of(model).track
    parts = [type(model.friction).__name__, type(model if drive is None else drive).__name__]
    if track is not None and type(track).__name__ != "Level":
        parts.append(type(track).__name__)
    return " × ".join(parts)


def numbers_of(model: Any) -> tuple[str, ...]:
    """Names of the numbers that make a case's row.

    An exponent that is 1 or 2 for all cases belongs to the kind: its power is written out.
    """
    return tuple(
        name for name, value in leaves(model) if not (name.endswith(".exponent") and isinstance(value, float) and value in (1.0, 2.0))
    )


def kind_of(model: Any) -> tuple[Any, ...]:
    """What the equations depend on: classes, names of the numbers, and the fields that are no numbers."""
    numbers = set(numbers_of(model))
    return tuple((name, _NUMBER if name in numbers else value) for name, value in leaves(model, kinds=True))


def trace(model: Any) -> Equations:
    """The equations of a model; `InputError` says what to change in a law that cannot be traced."""
    return explained(_trace, model)


class _Mechanics:
    """A model with symbols for its numbers, time, velocity at the contact, and position."""

    def __init__(self, model: Any):
        self.graph = graph = Graph()
        self.cyclic = not knows_position(model)
        names = numbers_of(model)
        self.model: Any = replace_leaf(model, {name: graph.case(name) for name in names})
        self.names = names if model.period is not None else (*names, SPAN)
        self.t, self.slip = graph.variable("t"), graph.variable("v")
        self.x = graph.constant(0.0) if self.cyclic else graph.variable("x")
        graph.sign(self.slip)  # flag 0 is always the side of v
        self.offset = -self.lift(self.model.contact_velocity(graph.constant(0.0)))
        self.v = self.slip + self.offset
        self.load = self.lift(normal_load(self.model, self.t, self.x))
        zero = graph.constant(0.0)
        self.first_load = self.lift(normal_load(self.model, zero, zero))  # a typical load, where it varies
        self.law = law_of(self.model)

    def lift(self, value: Any) -> Sym:
        return value if isinstance(value, Sym) else self.graph.constant(value)

    def acceleration(self, R: Any, slip: Sym | None = None) -> Sym:
        v = (self.slip if slip is None else slip) + self.offset
        return _spread(self.lift(self.model.acceleration(self.t, self.x, v, R)))

    def period(self, given: Any) -> Sym:
        return self.graph.case(SPAN) if given.period is None else self.lift(self.model.period)


@dataclass(frozen=True)
class _Motion:
    """How a law moves the states: the part of the equations that depends on its sort."""

    inner: tuple[Sym, ...]
    f: tuple[Sym, ...]
    events: list[tuple[Sym, Switch]]  # one-sided guards
    at_rest: Switch | None  # what happens when the velocity passes zero
    modes: tuple[Sym, ...]
    first_modes: tuple[Sym, ...]
    scales: tuple[Sym | None, ...]
    contact: Contact | None = None


def _trace(model: Any) -> Equations:
    _check_contact(model)
    m = _Mechanics(model)
    graph = m.graph
    speed = m.law.velocity_scale()
    scale = _velocity_scale(m, m.model.velocity_scale, speed)
    graph.units["v"] = graph.select(scale, scale, graph.constant(1.0))
    motion = _dynamic(m) if m.law.dynamic else _set_valued(m)
    y = (m.slip, *motion.inner, *(() if m.cyclic else (m.x,)))
    f = (*motion.f, *(() if m.cyclic else (m.v,)))
    events = [*motion.events, *_lost(m, len(y), motion.modes)]
    guards = (*graph.guards, *(guard for guard, _ in events))
    switches = {len(graph.guards) + k: switch for k, (_, switch) in enumerate(events)}
    if motion.at_rest is not None:
        switches[0] = motion.at_rest
    impulses = tuple((m.lift(instant), m.lift(jump)) for instant, jump in machine_of(m.model).impulses)
    return Equations(
        graph=graph, names=m.names, t=m.t, y=y, f=f, offset=m.offset,
        jacobian=tuple(tuple(graph.derivative(fi, yj) for yj in y) for fi in f),
        by_time=tuple(graph.derivative(fi, m.t) for fi in f),
        guards=guards, guard_rates=tuple(_along_flow(graph, g, m.t, y, f) for g in guards), signs=len(graph.guards), switches=switches,
        modes=motion.modes, first_modes=motion.first_modes,
        clocks=tuple(graph.clocks), instants=tuple(_instant(graph, clock, m.t) for clock in graph.clocks), impulses=impulses,
        period=m.period(model),
        velocity_scale=scale,
        free_velocity=_velocity_scale(m, machine_of(m.model).free_velocity, speed),
        scales=(*motion.scales, *(() if m.cyclic else (None,))),
        stribeck_velocity=None if speed is None else m.lift(speed),
        cyclic=m.cyclic, contact=motion.contact, mass=m.lift(m.model.total_mass), offered=_offered(m),
        balances=m.law.needs_applied,
        free=m.acceleration(0.0), inertia=_inertia(m),
    )  # fmt: skip


def _dynamic(m: _Mechanics) -> _Motion:
    """A law with inner states: rate and force; its memory of whole numbers, if it has one, changes by switches."""
    law, graph = m.law, m.graph
    z = tuple(graph.variable(f"z{i}") for i in range(law.states))
    modes = tuple(graph.mode(f"mode{i}") for i in range(law.modes))
    zdot = tuple(map(m.lift, law.rate(m.slip, z, m.load, modes)))
    applied = m.model.total_mass * m.acceleration(0.0) if law.needs_applied else None
    force = law.force(m.slip, z, zdot, m.load, modes, applied)
    events, at_rest = _switches(m, z, modes)
    typical = law.scale(m.first_load)
    scales = (None,) * law.states if typical is None else tuple(map(m.lift, typical))
    zero = graph.constant(0.0)
    return _Motion(z, (m.acceleration(force), *zdot), events, at_rest, modes, (zero,) * len(modes), scales)


def _switches(m: _Mechanics, z: tuple[Sym, ...], modes: tuple[Sym, ...]) -> tuple[list[tuple[Sym, Switch]], Switch | None]:
    """The law's switches; those at the instant when v passes zero belong to the guard that is there already."""
    events, at_rest, passing = [], None, abs(m.slip)
    for guard, new_modes, new_z in m.law.switches(m.slip, z, m.load, modes):
        inner: tuple[Sym | None, ...] = (None,) * len(z) if new_z is None else tuple(map(m.lift, new_z))
        states = (None, *inner, *(() if m.cyclic else (None,)))
        switch = Switch(tuple(m.lift(new) for new in new_modes), states)
        if guard is passing:
            at_rest = switch
        else:
            events.append((m.lift(guard), switch))
    return events, at_rest


def _set_valued(m: _Mechanics) -> _Motion:
    """A law that may hold the body: mode +1 slides forwards, -1 backwards, 0 is stuck until the forces reach break-away."""
    graph, law = m.graph, m.law
    mode = graph.mode("mode0")
    one, zero = graph.constant(1.0), graph.constant(0.0)
    sliding = []
    for side in (1.0, -1.0):
        graph.assumed[m.slip.number] = side
        sliding.append(m.acceleration(law.sliding(m.slip, m.load)))
    backward, forward = law.breakaway(m.load)
    push, pull = m.acceleration(forward, zero), -m.acceleration(backward, zero)  # > 0: breaks away forwards, backwards
    graph.assumed.clear()
    states = (None,) if m.cyclic else (None, None)

    def by_mode(forwards: Sym, backwards: Sym, stuck: Sym) -> Sym:
        return graph.select(mode, forwards, graph.select(-mode, backwards, stuck))

    rest = graph.select(push, one, graph.select(pull, -one, zero))
    events = [
        (by_mode(m.slip, -m.slip, one), Switch((rest,), (zero, *states[1:]))),
        (by_mode(one, one, -push), Switch((one,), states)),
        (by_mode(one, one, -pull), Switch((-one,), states)),
    ]
    first = graph.select(m.slip, one, graph.select(-m.slip, -one, rest))
    return _Motion((), (by_mode(sliding[0], sliding[1], zero),), events, None, (mode,), (first,), (), Contact(*sliding, push, pull))


def _lost(m: _Mechanics, states: int, modes: tuple[Sym, ...]) -> list[tuple[Sym, Switch]]:
    """The end of the run, where a load that varies falls to zero."""
    return [(m.load, Switch(modes, (None,) * states, LOST))] if m.graph.varies(m.load) else []


def _offered(m: _Mechanics) -> Sym | None:
    """What all forces but friction add up to [N]: the drive's and gravity's share, for a robot."""
    total = m.lift(m.model.total_mass) * m.acceleration(0.0)
    return total if m.graph.varies(total) <= {"t"} else None


def _check_contact(model: Any) -> None:
    """Refuse a contact whose velocity is not that of the body less a number of the case: steps know the two by their difference."""
    graph = Graph()
    v = graph.variable("v")
    found = replace_leaf(model, {name: graph.case(name) for name in numbers_of(model)}).contact_velocity(v)
    terms = terms_of(found) if isinstance(found, Sym) else {}
    if terms.get((v.number,)) is not graph.constant(1.0) or set(terms) - {(), (v.number,)}:
        raise TraceError("contact_velocity(v) is not v less a number; allowed is for example return v - self.speed")


def _inertia(m: _Mechanics) -> Sym | None:
    """The drive force, -m d²xi/dt²."""
    drive = machine_of(m.model).drive
    return None if drive is None else -(m.model.inner_mass * m.lift(drive.acceleration(m.t)))


def _instant(graph: Graph, clock: Sym, t: Sym) -> Sym:
    """The zero of an expression that is linear in time: t - c(t)/c'(t), which does not vary."""
    slope = graph.derivative(clock, t)
    return -_at_zero(graph, clock, t) / slope


def _at_zero(graph: Graph, node: Sym, t: Sym) -> Sym:
    """An expression at t = 0."""
    if node is t:
        return graph.constant(0.0)
    if not graph.varies(node):
        return node
    a = [_at_zero(graph, arg, t) for arg in node.args]
    match node.op:
        case "add":
            return a[0] + a[1]
        case "subtract":
            return a[0] - a[1]
        case "multiply":
            return a[0] * a[1]
        case "select":
            return graph.select(a[0], a[1], a[2])
    raise TraceError(f"a condition on time has {node.op} in it; write it as where(within(t, period) < instant, ...)")


def _velocity_scale(m: _Mechanics, driven: Any, speed: Any) -> Sym:
    """A velocity of the drive, and something positive where the drive is off."""
    driven = m.lift(driven)
    return driven if speed is None else maximum(driven, 1e-9 * m.lift(speed))


def _spread(node: Sym, factor: Sym | None = None) -> Sym:
    """A sum with the case's factors multiplied into its terms, where they are computed once per case."""
    graph = node.graph
    if node.op in ("add", "subtract"):
        a, b = (_spread(x, factor) for x in node.args)
        return a + b if node.op == "add" else a - b
    if node.op == "multiply" and node.args[0].level < STATE and node.args[1].op in ("add", "subtract"):
        return _spread(node.args[1], node.args[0] if factor is None else graph.multiply(factor, node.args[0]))
    return node if factor is None else graph.multiply(factor, node)


def _along_flow(graph: Graph, guard: Sym, t: Sym, y: tuple[Sym, ...], f: tuple[Sym, ...]) -> Sym:
    total = graph.derivative(guard, t)
    for yi, fi in zip(y, f, strict=True):
        total = total + graph.derivative(guard, yi) * fi
    return total
