"""From a model to its equations: call its plain Python with symbols and write down what comes out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.engine.checks import explained
from stickslip.engine.refused import refused
from stickslip.engine.sums import terms_of
from stickslip.engine.symbols import STATE, Graph, Sym, TraceError
from stickslip.engine.values import values_of
from stickslip.errors import InputError
from stickslip.fields import leaves, replace_leaf
from stickslip.machine import machine_of
from stickslip.maths import maximum, pi
from stickslip.position import knows_position

__all__ = ["SPAN", "Branches", "Contact", "Equations", "Switch", "kind_of", "label", "numbers_of", "trace"]

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
class Branches:
    """Accelerations at a set-valued contact: while it slides, and how much is left at the limits of rest."""

    forwards: Sym
    backwards: Sym
    push: Sym  # > 0: the body breaks away forwards
    pull: Sym  # > 0: backwards


@dataclass(frozen=True)
class Contact:
    """One contact: where it stands in the states, guards and modes."""

    name: str
    slip: Sym
    direction: tuple[float, ...]  # what its slip takes of each coordinate's velocity: 1, -1 or 0
    state: int | None  # the state that is its slip velocity; None where the slip is made of several, or of time
    guard: int | None  # the guard whose flag holds the side of its slip; None of a set-valued law of several contacts: its mode does
    inner: tuple[int, ...]  # its inner states among the states
    modes: tuple[int, ...]  # its modes among the modes: +1, -1 or 0 (at rest) of a set-valued law, else the law's memories
    branches: Branches | None  # of a set-valued law
    stribeck_velocity: Sym | None
    balances: bool  # a dynamic law that holds the body by the force that is applied: at rest its guards know time alone


@dataclass(frozen=True)
class Equations:
    """What a step needs to know of a model.

    States are the velocity of each coordinate (less that of what its contact rubs on, where that does not vary), the laws' inner states
    contact by contact, and then the positions that the equations need: of all coordinates, or of all but the first as differences to
    it, whose own position is the integral of its velocity (none, for a single body). For one body y[0] = velocity at the contact.
    """

    graph: Graph
    names: tuple[str, ...]  # the case's numbers, in the order of a row
    t: Sym
    y: tuple[Sym, ...]
    f: tuple[Sym, ...]  # dy/dt
    bodies: tuple[str, ...]  # names, one for each coordinate
    single: bool  # one body with one contact by its kind, as a robot
    offsets: tuple[Sym, ...]  # velocity of each coordinate less the state that stands for it
    contacts: tuple[Contact, ...]
    free: Sym  # acceleration of the first coordinate without friction
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
    impulses: tuple[tuple[Sym, tuple[Sym, ...]], ...]  # instant, jump of each coordinate's velocity
    period: Sym
    velocity_scale: Sym
    free_velocity: Sym  # what the body would do without friction: the unit of strobe distances
    scales: tuple[Sym | None, ...]  # typical size of each state; None: not known
    cyclic: bool
    mass: Sym  # all that moves with the first contact [kg]
    shares: tuple[Sym, ...]  # of each position among the states, in that of the centre of mass; none for one body
    offered: Sym | None  # what all forces but friction add up to [N], where time alone decides it; of one body

    @property
    def dynamic(self) -> bool:
        """Whether the laws have a rate and a force, and so never rest exactly."""
        return all(contact.branches is None for contact in self.contacts)

    @property
    def states(self) -> int:
        """Number of states."""
        return len(self.y)

    @property
    def coordinates(self) -> int:
        """Number of velocities, the first states."""
        return len(self.offsets)

    @property
    def positions(self) -> range:
        """The states that are positions, or differences of positions: the last ones."""
        count = self.coordinates - 1 if self.cyclic else self.coordinates
        return range(self.states - count, self.states)

    @property
    def offset(self) -> Sym:
        """Velocity of the first coordinate less the state that stands for it."""
        return self.offsets[0]

    @property
    def contact(self) -> Branches | None:
        """Of a set-valued law of one contact."""
        return self.contacts[0].branches


def label(model: Any) -> str:
    """What a model's kind is called: ``LuGre × Harmonic``."""
    drive, track = machine_of(model).drive, machine_of(model).track
    if not machine_of(model).is_single:
        laws = [law.name for law in machine_of(model).mechanics.laws]
        return " × ".join([*dict.fromkeys(laws), type(model).__name__, str(len(laws))])
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
    """A model with symbols for its numbers, time, velocities and positions."""

    def __init__(self, model: Any, cyclic: bool):
        self.graph = graph = Graph()
        self.cyclic = cyclic
        names = numbers_of(model)
        self.model: Any = replace_leaf(model, {name: graph.case(name) for name in names})
        self.machine = machine_of(self.model)
        self.single, self.equations = self.machine.is_single, self.machine.mechanics
        self.names = names if model.period is not None else (*names, SPAN)
        self.laws, self.directions = self.equations.laws, self.equations.directions
        self.t, n = graph.variable("t"), self.equations.coordinates
        self.y = tuple(graph.variable(f"v{j}" if n > 1 else "v") for j in range(n))
        self.places = self._places()
        if self.single:
            graph.sign(self.y[0])  # of one body, flag 0 is always the side of v
        rates = tuple(map(self.lift, self.equations.offsets(self.t)))
        zero = graph.constant(0.0)
        self.owner = _owners(graph, self.directions, rates, n)  # of each coordinate, the contact whose slip its state is
        self.offsets = tuple(zero if i is None else -rates[i] for i in self.owner)
        self.v = tuple(y + offset for y, offset in zip(self.y, self.offsets, strict=True))
        self.slips = tuple(self.y[self.owner.index(i)] if i in self.owner else self._slip(i) for i in range(len(self.laws)))
        for slip, law in zip(self.slips, self.laws, strict=True):
            if law.dynamic:
                graph.sign(slip)  # of each contact, before any other condition
        self.loads = tuple(map(self.lift, self.equations.loads(self.t, self.places)))
        self.first_loads = tuple(map(self.lift, self.equations.loads(zero, (zero,) * n)))  # typical loads, where they vary

    def _slip(self, i: int) -> Sym:
        return self.lift(self.equations.slips(self.t, self.v)[i])

    def _places(self) -> tuple[Sym, ...]:
        """Positions of the coordinates; where only their differences matter, from the first one."""
        graph, n = self.graph, len(self.y)
        zero = graph.constant(0.0)
        names = ["x"] if n == 1 else [f"{'l' if self.cyclic else 'x'}{j}" for j in range(n)]
        return tuple(zero if j == 0 and self.cyclic else graph.variable(name) for j, name in enumerate(names))

    def lift(self, value: Any) -> Sym:
        return value if isinstance(value, Sym) else self.graph.constant(value)

    def accelerations(self, R: dict[int, Any], at: dict[int, Sym] | None = None) -> tuple[Sym, ...]:
        """Accelerations of the coordinates under the friction forces R by contact, with other states `at` those of the coordinates."""
        v = tuple((at or {}).get(j, y) + offset for j, (y, offset) in enumerate(zip(self.y, self.offsets, strict=True)))
        forces = [R.get(i, 0.0) for i in range(len(self.laws))]
        return tuple(_spread(self.lift(a)) for a in self.equations.accelerations(self.t, self.places, v, forces))

    def feet(self, i: int) -> list[int]:
        """The contacts of the coordinate that a contact brakes, where it brakes one alone."""
        return [k for k, row in enumerate(self.directions) if row == self.directions[i]]

    def period(self, given: Any) -> Sym:
        return self.graph.case(SPAN) if given.period is None else self.lift(self.model.period)


def _owners(graph: Graph, directions: Any, offsets: tuple[Sym, ...], coordinates: int) -> tuple[int | None, ...]:
    """For each coordinate the first contact whose slip is its velocity plus what does not vary in time."""
    found = []
    for j in range(coordinates):
        alone = [i for i, row in enumerate(directions) if row[j] == 1.0 and sum(map(abs, row)) == 1.0 and not graph.varies(offsets[i])]
        found.append(alone[0] if alone else None)
    return tuple(found)


class _Writer:
    """Collects what contact by contact makes of the equations."""

    def __init__(self, m: _Mechanics):
        self.m, n = m, len(m.y)
        self.forces: dict[int, Any] = {}  # of dynamic laws
        self.f: list[Any] = [None] * n  # of the coordinates, where a set-valued contact decides them
        self.inner: list[Sym] = []
        self.rates: list[Sym] = []
        self.scales: list[Sym | None] = []
        self.modes: list[Sym] = []
        self.first_modes: list[Sym] = []
        self.events: list[tuple[Sym, dict[int, Sym], dict[int, Sym], int]] = []  # guard, new modes, new states, status
        self.at_rest: dict[int, tuple[dict[int, Sym], dict[int, Sym]]] = {}  # by number of the contact
        self.contacts: list[Contact] = []

    def mode(self, first: Sym) -> tuple[int, Sym]:
        """A new mode, and its number."""
        self.modes.append(self.m.graph.mode(f"mode{len(self.modes)}"))
        self.first_modes.append(first)
        return len(self.modes) - 1, self.modes[-1]


def _trace(model: Any) -> Equations:
    single = machine_of(model).is_single
    if single:
        _check_contact(model)
        return _traced(model, not knows_position(model))
    if reason := refused(model):
        raise InputError(type(model).__name__, [reason])
    found = _traced(model, False)
    return _traced(model, True) if _only_differences(found) else found


def _only_differences(eq: Equations) -> bool:
    """Whether the positions appear as differences only: what a common shift changes is zero, at any numbers."""
    graph, places = eq.graph, [eq.y[i] for i in eq.positions]
    changes = []
    for node in (*eq.f[: eq.positions.start], *eq.guards):
        total = graph.constant(0.0)
        for place in places:
            total = total + graph.derivative(node, place)
        changes.append((total, [graph.derivative(node, place) for place in places]))
    numbers = np.random.default_rng(20261122)
    for _ in range(4):
        known = {name: numbers.uniform(0.5, 1.5) for name in (*eq.names, SPAN, *(s.name for s in (*eq.y, eq.t)))}
        known |= {mode.name: float(numbers.integers(-1, 2)) for mode in eq.modes}
        found = values_of(graph, known, [node for total, parts in changes for node in (total, *parts)])
        for total, parts in changes:
            if abs(found[total.number]) > 1e-9 * sum(abs(found[part.number]) for part in parts):
                return False
    return True


def _traced(model: Any, cyclic: bool) -> Equations:
    m = _Mechanics(model, cyclic)
    graph, zero = m.graph, m.graph.constant(0.0)
    speeds = [law.velocity_scale() for law in m.laws]
    speed = next((each for each in speeds if each is not None), None)
    scale = _velocity_scale(m, m.machine.velocity_scale, speed)
    for y in m.y:
        graph.units[y.name] = graph.select(scale, scale, graph.constant(1.0))
    parts = _Writer(m)
    lifted = [None if each is None else m.lift(each) for each in speeds]
    for i, law in enumerate(m.laws):
        if law.dynamic:
            _add_dynamic(parts, i, lifted[i])
        elif len(m.feet(i)) == 1:
            _add_set_valued(parts, i, lifted[i])
        elif m.feet(i)[0] == i:
            _add_feet(parts, m.feet(i), lifted)
    parts.contacts.sort(key=lambda contact: m.equations.contacts.index(contact.name))
    for stop in m.equations.stops:
        _add_stop(parts, stop)
    moved = m.accelerations(parts.forces)
    f = tuple(a if own is None else own for a, own in zip(moved, parts.f, strict=True))
    places = tuple(place for place in m.places if place is not zero)
    rates = m.v if not cyclic else tuple(v - m.v[0] for v in m.v[1:])
    n = len(m.y)
    y, f = (*m.y, *parts.inner, *places), (*f, *parts.rates, *rates)
    distance = None if m.single or model.period is None else scale * m.period(model) / (2 * pi)
    for i in range(len(m.laws)):
        if graph.varies(m.loads[i]):
            parts.events.append((m.loads[i], {}, {}, LOST))
    guards = (*graph.guards, *(guard for guard, *_ in parts.events))

    def switch(modes: dict[int, Sym], states: dict[int, Sym], status: int = 0) -> Switch:
        return Switch(tuple(modes.get(k, old) for k, old in enumerate(parts.modes)), tuple(states.get(k) for k in range(len(y))), status)

    switches = {len(graph.guards) + k: switch(*event) for k, (_, *event) in enumerate(parts.events)}
    switches |= {parts.contacts[i].guard or 0: switch(*changes) for i, changes in parts.at_rest.items()}
    return Equations(
        graph=graph, names=m.names, t=m.t, y=y, f=f,
        bodies=m.equations.bodies, single=m.single, offsets=m.offsets, contacts=tuple(parts.contacts),
        jacobian=tuple(tuple(graph.derivative(fi, yj) for yj in y) for fi in f),
        by_time=tuple(graph.derivative(fi, m.t) for fi in f),
        guards=guards, guard_rates=tuple(_along_flow(graph, g, m.t, y, f) for g in guards), signs=len(graph.guards), switches=switches,
        modes=tuple(parts.modes), first_modes=tuple(parts.first_modes),
        clocks=tuple(graph.clocks), instants=tuple(_instant(graph, clock, m.t) for clock in graph.clocks),
        impulses=tuple((m.lift(instant), tuple(map(m.lift, jumps))) for instant, jumps in m.equations.jumps),
        period=m.period(model), velocity_scale=scale,
        free_velocity=_velocity_scale(m, m.machine.free_velocity, speed),
        scales=((None,) * n if m.single else (scale,) * n) + (*parts.scales, *(distance for _ in places)),
        cyclic=cyclic, mass=m.lift(m.equations.masses[0]), shares=_shares(m), offered=_offered(m) if m.single else None,
        free=m.accelerations({})[0], inertia=_inertia(m),
    )  # fmt: skip


def _shares(m: _Mechanics) -> tuple[Sym, ...]:
    """Part of all masses that each coordinate has, of those whose positions are states."""
    if len(m.y) == 1:
        return ()
    masses = list(map(m.lift, m.equations.masses))
    total = masses[0]
    for mass in masses[1:]:
        total = total + mass
    return tuple(mass / total for mass in masses[m.cyclic :])


def _add_dynamic(parts: _Writer, i: int, speed: Sym | None) -> None:
    """A law with inner states: rate and force; its memory of whole numbers, if it has one, changes by switches."""
    m = parts.m
    law, graph, slip, load = m.laws[i], m.graph, m.slips[i], m.loads[i]
    graph.sign(slip)
    guard = next(k for k, known in enumerate(graph.guards) if known is slip)
    names = [f"z{k}" if m.single else f"z{i}_{k}" for k in range(law.states)]
    z = tuple(map(graph.variable, names))
    own = [parts.mode(graph.constant(0.0)) for _ in range(law.modes)]
    modes = tuple(mode for _, mode in own)
    zdot = tuple(map(m.lift, law.rate(slip, z, load, modes)))
    applied = m.model.total_mass * m.accelerations({})[0] if law.needs_applied else None
    parts.forces[i] = law.force(slip, z, zdot, load, modes, applied)
    first = len(m.y) + len(parts.inner)
    _add_switches(parts, i, z, own, first)
    typical = law.scale(m.first_loads[i])
    parts.scales += [None] * law.states if typical is None else list(map(m.lift, typical))
    parts.inner += z
    parts.rates += zdot
    state = m.owner.index(i) if i in m.owner else None
    inner = tuple(range(first, first + law.states))
    parts.contacts.append(
        Contact(
            m.equations.contacts[i], slip, m.directions[i], state, guard, inner, tuple(k for k, _ in own), None, speed, law.needs_applied
        )
    )


def _add_switches(parts: _Writer, i: int, z: tuple[Sym, ...], own: list[tuple[int, Sym]], first: int) -> None:
    """The law's switches; those at the instant when v passes zero belong to the guard that is there already."""
    m, passing = parts.m, abs(parts.m.slips[i])
    for guard, new_modes, new_z in m.laws[i].switches(m.slips[i], z, m.loads[i], tuple(mode for _, mode in own)):
        modes = {number: m.lift(new) for (number, _), new in zip(own, new_modes, strict=True)}
        states = {} if new_z is None else {first + k: m.lift(new) for k, new in enumerate(new_z)}
        if guard is passing:
            parts.at_rest[i] = (modes, states)
        else:
            parts.events.append((m.lift(guard), modes, states, 0))


def _add_set_valued(parts: _Writer, i: int, speed: Sym | None) -> None:
    """A law that may hold the body: mode +1 slides forwards, -1 backwards, 0 is stuck until the forces reach break-away."""
    m = parts.m
    graph, law, slip, load = m.graph, m.laws[i], m.slips[i], m.loads[i]
    j = next(k for k, g in enumerate(m.directions[i]) if g)  # the coordinate that it brakes
    one, zero = graph.constant(1.0), graph.constant(0.0)
    place, first = len(parts.modes), graph.constant(0.0)
    sliding = []
    number, mode = parts.mode(first)
    for side in (1.0, -1.0):
        graph.assumed[slip.number] = side
        sliding.append(m.accelerations({i: law.sliding(slip, load)})[j])
    backward, forward = law.breakaway(load)
    owned = m.owner[j] == i
    still = zero if owned else -(slip - m.y[j])
    held = zero if owned else graph.derivative(still, m.t)  # acceleration of the body while it rests on what it rubs on
    push = m.accelerations({i: forward}, {j: still})[j] - held  # > 0: breaks away forwards
    pull = -(m.accelerations({i: backward}, {j: still})[j] - held)
    graph.assumed.clear()

    def by_mode(forwards: Sym, backwards: Sym, stuck: Sym) -> Sym:
        return graph.select(mode, forwards, graph.select(-mode, backwards, stuck))

    rest = graph.select(push, one, graph.select(pull, -one, zero))
    parts.events += [
        (by_mode(slip, -slip, one), {place: rest}, {j: still}, 0),
        (by_mode(one, one, -push), {place: one}, {}, 0),
        (by_mode(one, one, -pull), {place: -one}, {}, 0),
    ]
    parts.first_modes[number] = graph.select(slip, one, graph.select(-slip, -one, rest))
    parts.f[j] = by_mode(sliding[0], sliding[1], held)
    branches = Branches(*sliding, push, pull)
    guard = 0 if m.single else None
    parts.contacts.append(
        Contact(m.equations.contacts[i], slip, m.directions[i], j if owned else None, guard, (), (number,), branches, speed, False)
    )


def _add_feet(parts: _Writer, feet: list[int], speeds: list[Sym | None]) -> None:
    """Several contacts of one coordinate under laws that may hold it: one unknown acceleration, and a weighted median decides who rests."""
    m = parts.m
    graph, zero = m.graph, m.graph.constant(0.0)
    one = graph.constant(1.0)
    j = next(k for k, g in enumerate(m.directions[feet[0]]) if g)
    own = {i: parts.mode(zero) for i in feet}
    modes = {i: mode for i, (_, mode) in own.items()}
    held = {i: -graph.derivative(m.slips[i], m.t) for i in feet}  # acceleration at which the foot's slip stays as it is
    slide: dict[int, tuple[Sym, Sym]] = {}
    for i in feet:
        forces = []
        for side in (1.0, -1.0):
            graph.assumed[m.slips[i].number] = side
            forces.append(m.lift(m.laws[i].sliding(m.slips[i], m.loads[i])))
        graph.assumed.clear()
        slide[i] = (forces[0], forces[1])
    limits = {i: tuple(map(m.lift, m.laws[i].breakaway(m.loads[i]))) for i in feet}  # backward, forward

    def by_mode(mode: Sym, forwards: Sym, backwards: Sym, stuck: Sym) -> Sym:
        return graph.select(mode, forwards, graph.select(-mode, backwards, stuck))

    def acceleration(now: dict[int, Sym], at_rest: dict[int, Sym]) -> Sym:
        """With friction forces at rest as given."""
        return m.accelerations({i: by_mode(now[i], *slide[i], at_rest[i]) for i in feet})[j]

    def beside(i: int, k: int, same: int) -> Sym:
        """Force of a foot k that rests now, if foot i were to rest: it would slip to the side to which its rest moves away."""
        apart = held[i] - held[k]
        return graph.select(apart, limits[k][1], graph.select(-apart, limits[k][0], limits[k][same]))

    def decided(now: dict[int, Sym]) -> dict[int, Sym]:
        """Modes of all feet: those at rest may stay or slip."""
        found = {}
        for i in feet:
            push = acceleration(now, {k: beside(i, k, 1) for k in feet}) - held[i]
            pull = held[i] - acceleration(now, {k: beside(i, k, 0) for k in feet})
            found[i] = by_mode(now[i], one, -one, graph.select(push, one, graph.select(pull, -one, zero)))
        return {own[i][0]: new for i, new in found.items()}

    sliding = acceleration(modes, dict.fromkeys(feet, zero))
    motion = sliding
    for i in reversed(feet):
        motion = by_mode(modes[i], motion, motion, held[i])
    forwards = acceleration(modes, {k: limits[k][1] for k in feet})
    backwards = acceleration(modes, {k: limits[k][0] for k in feet})
    for i in feet:
        number, mode = own[i]
        arrives = {**modes, i: zero}
        parts.events += [
            (by_mode(mode, m.slips[i], -m.slips[i], one), decided(arrives), {j: m.y[j] - m.slips[i]}, 0),
            (by_mode(mode, one, one, held[i] - forwards), {number: one}, {}, 0),
            (by_mode(mode, one, one, backwards - held[i]), {number: -one}, {}, 0),
        ]
    first = decided({i: graph.select(m.slips[i], one, graph.select(-m.slips[i], -one, zero)) for i in feet})
    for number, new in first.items():
        parts.first_modes[number] = new
    parts.f[j] = motion
    for i in feet:
        branches = Branches(sliding, sliding, forwards - held[i], held[i] - backwards)
        state = j if m.owner[j] == i else None
        name = m.equations.contacts[i]
        parts.contacts.append(Contact(name, m.slips[i], m.directions[i], state, None, (), (own[i][0],), branches, speeds[i], False))


def _add_stop(parts: _Writer, stop: Any) -> None:
    """A stop with restitution: where its gap closes, velocities jump, and contacts whose slip jumps are free."""
    m = parts.m
    graph = m.graph
    masses = list(map(m.lift, m.equations.masses))
    weights = [h / mass if h else None for h, mass in zip(stop.direction, masses, strict=True)]
    G = sum((abs(h) * abs(h) / mass for h, mass in zip(stop.direction, masses, strict=True) if h), graph.constant(0.0))
    impulse = (1.0 + m.lift(stop.restitution)) * m.lift(stop.rate(m.t, m.v)) / G
    states = {c: m.y[c] - weight * impulse for c, weight in enumerate(weights) if weight is not None}
    modes = {}
    for contact in parts.contacts:
        thrown = sum((g * (states[c] - m.y[c]) for c, g in enumerate(contact.direction) if g and c in states), graph.constant(0.0))
        if contact.branches is not None and thrown is not graph.constant(0.0):
            after, (number,) = contact.slip + thrown, contact.modes
            one = graph.constant(1.0)
            modes[number] = graph.select(after, one, graph.select(-after, -one, parts.modes[number]))
    parts.events.append((m.lift(stop.gap(m.t, m.places)), modes, states, 0))


def _offered(m: _Mechanics) -> Sym | None:
    """What all forces but friction add up to [N]: the drive's and gravity's share, for a robot."""
    total = m.lift(m.model.total_mass) * m.accelerations({})[0]
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
