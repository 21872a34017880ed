"""Contributions of each contact to the equations of a machine: inner states with rates, or modes with guards."""

from __future__ import annotations

from typing import Any

from stickslip.basics.status import Status
from stickslip.engine.assembly import Assembly
from stickslip.engine.coupled import add_box, add_feet, breakaway
from stickslip.engine.flight import add_flight, add_take_off_and_landing, side_in_flight
from stickslip.engine.landings import add_landing
from stickslip.engine.pressed import Pressed, add_pressed, pressed_stops, settled_apart, settles, shut_at
from stickslip.engine.refused import groups_of
from stickslip.engine.several_feet import add_several
from stickslip.engine.solved_load import add_solved, events_of_border, events_of_side
from stickslip.engine.symbolic import Symbolic
from stickslip.engine.symbols import Sym, TraceError
from stickslip.engine.system import Branches, TracedContact
from stickslip.engine.values import needed_by
from stickslip.models.friction.law_adapter import LawAdapter
from stickslip.models.mechanics import brakes_one

_UNPRESSED = 1e-12  # of the force that gives a mass the velocity scale in a period: a load that is none
_BESIDE = 1e-12  # how far beside the border where loads are infinite a run ends: nothing that is infinite has a series
_NEAR = 1e-15  # of the velocity scale: what rounding makes of a slip that is a difference, and that begins without acceleration


def _add_dynamic(parts: Assembly, i: int, speed: Sym | None) -> None:
    """A law with inner states: rate and force; its memory of whole numbers, if it has one, changes by switches."""
    m = parts.m
    law, graph, slip, load = m.laws[i], m.graph, m.slips[i], m.loads[i]
    graph.sign(slip)
    guard = next(k for k, known in enumerate(graph.guards) if known is slip)
    names = [f"z{k}" if m.single else f"z{i}_{k}" for k in range(law.states)]
    z = tuple(map(graph.variable, names))
    own = parts.memories[i]
    modes = tuple(mode for _, mode in own)
    zdot = tuple(map(m.lift, law.rate(slip, z, load, modes)))
    applied = _applied(parts, i) if law.needs_applied else None
    least = law.least_creep(parts.velocity_scale, m.equations.difference(i))
    parts.forces[i] = law.resolved(least, slip, z, zdot, load, modes, applied)
    first = len(m.y) + len(parts.inner)
    _add_switches(parts, i, z, own, first)
    typical = law.scale(m.first_loads[i])
    parts.scales += [None] * law.states if typical is None else list(map(m.lift, typical))
    parts.inner += z
    parts.rates += zdot
    state = m.owner.index(i) if i in m.owner else None
    inner = tuple(range(first, first + law.states))
    creep = law.creep_velocity(z, load)
    parts.contacts.append(
        TracedContact(
            m.equations.contacts[i], slip, m.directions[i], state, guard, inner, tuple(k for k, _ in own), None, speed, law.needs_applied,
            None if creep is None else creep + least, least, row=m.weighted(i),
        )
    )  # fmt: skip


def _applied(parts: Assembly, i: int) -> Sym:
    """The force that would keep the slip of a contact constant, if it brakes one body alone [N]; where a stop is closed, both its ends.

    What rubs on the other end does what it would do alone, if it is decided later, so that together they bear what they can.
    """
    m = parts.m
    force = _applied_alone(m, i)
    for p in [p for p in m.pressed if sum(map(abs, p.row)) == 2.0 and _on(p, m.directions[i])]:
        others = {k: parts.forces[k] if k in parts.forces else _alone(m, k) for k, row in enumerate(m.directions) if k != i and _on(p, row)}
        mass = sum((m.lift(each) for each, h in zip(m.equations.masses, p.row, strict=True) if h), m.graph.constant(0.0))
        force = m.graph.select(p.closed, _kept(m, i, mass, m.accelerations(others, closed=p)), force)
    return force


def _on(p: Pressed, row: tuple[float, ...]) -> bool:
    """Whether a contact brakes an end of a stop."""
    return any(g and h for g, h in zip(row, p.row, strict=True))


def _alone(m: Symbolic, i: int) -> Sym:
    """Force of a law without states that asks for the applied force, which is that of its body alone."""
    return m.lift(m.laws[i].force(m.slips[i], (), (), m.loads[i], (), _applied_alone(m, i)))


def _applied_alone(m: Symbolic, i: int) -> Sym:
    """The force that would keep the slip of a contact constant, if no stop is closed."""
    if m.single:
        return m.lift(m.model.total_mass * m.accelerations({})[0])
    j = next(k for k, g in enumerate(m.directions[i]) if g)
    return _kept(m, i, m.lift(m.equations.masses[j]), m.accelerations({}, closed=None))


def _kept(m: Symbolic, i: int, mass: Sym, a: tuple[Sym, ...]) -> Sym:
    """The force that keeps the slip of a contact constant where a mass has an acceleration without it."""
    j = next(k for k, g in enumerate(m.directions[i]) if g)
    return mass * (a[j] + m.graph.derivative(m.slips[i], m.t))


def _add_switches(parts: Assembly, i: int, z: tuple[Sym, ...], own: list[tuple[int, Sym]], first: int) -> None:
    """The law's switches; those at the instant when v passes zero belong to the guard that is there already."""
    m = parts.m
    for guard, new_modes, new_z in switches_of_law(m.laws[i], m.slips[i], z, m.loads[i], tuple(mode for _, mode in own), m.lift):
        modes = {number: new for (number, _), new in zip(own, new_modes, strict=True)}
        states = {} if new_z is None else {first + k: new for k, new in enumerate(new_z)}
        if guard is None:
            parts.at_rest[i] = (modes, states)
        else:
            parts.events.append((guard, modes, states, 0))


def switches_of_law(law: LawAdapter, slip: Sym, z: tuple[Sym, ...], load: Any, modes: tuple[Sym, ...], lift: Any) -> list[Any]:
    """What ends the modes of a law: guards (None: the slip passes zero), each with the modes and the inner states (or None) after it."""
    passing = abs(slip)
    return [
        (None if guard is passing else lift(guard), tuple(map(lift, after)), None if new is None else tuple(map(lift, new)))
        for guard, after, new in law.switches(slip, z, load, modes)
    ]


def _add_set_valued(parts: Assembly, i: int, speed: Sym | None) -> None:
    """A law that may hold the body: mode +1 slides forwards, -1 backwards, 0 is stuck until the forces reach break-away."""
    m = parts.m
    graph, law, slip = m.graph, m.laws[i], m.slips[i]
    j = next(k for k, g in enumerate(m.directions[i]) if g)  # the coordinate that it brakes
    one, zero = graph.constant(1.0), graph.constant(0.0)
    sliding: list[Sym] = []
    mode_number, mode = i, parts.modes[i]
    slides = parts.slip(i)
    for side in (1.0, -1.0):
        graph.assumed[slides.number] = side
        sliding.append(m.accelerations({**parts.known_forces, i: law.sliding(slides, m.load(i, side))})[j])
    backward, forward = breakaway(m, i)
    owned = m.owner[j] == i
    still = zero if owned else -(slip - m.y[j])
    held = zero if owned else graph.derivative(still, m.t)  # acceleration of the body while it rests on what it rubs on
    push = m.accelerations({**parts.known_forces, i: forward}, {j: still})[j] - held  # > 0: breaks away forwards
    pull = -(m.accelerations({**parts.known_forces, i: backward}, {j: still})[j] - held)
    graph.assumed.clear()

    holds = any(m.lift(limit) is not zero for limit in (backward, forward))  # else a slip that falls to zero goes on to the other side
    rest = graph.select(push, one, graph.select(pull, -one, zero if holds else one))
    stopped = rest if holds else -mode
    first, flight = rest, add_flight(parts, i) if law.flies else None
    if flight is not None:
        add_take_off_and_landing(parts, i, flight, rest, still, held)
        stopped = graph.select(flight.aloft, -mode, stopped)
        first = graph.select(flight.first, side_in_flight(parts, i, held), rest)
    near = zero if owned else _NEAR * m.lift(m.machine.velocity_scale)
    parts.own_events[i] = len(parts.events)
    parts.events += [
        (graph.by_side(mode, slip + near, near - slip, one), {mode_number: stopped}, {j: still}, 0),
        (graph.by_side(mode, one, one, -push if holds else one), {mode_number: one}, {}, 0),
        (graph.by_side(mode, one, one, -pull if holds else one), {mode_number: -one}, {}, 0),
    ]
    parts.first_modes[mode_number] = graph.by_side(slip, one, -one, first)
    moved = graph.by_side(mode, sliding[0], sliding[1], held)
    parts.f[j] = moved if flight is None else graph.select(flight.aloft, m.accelerations({})[j], moved)
    branches = Branches(*sliding, push, pull)
    guard, inner = 0 if m.single else None, () if flight is None else flight.inner
    name, state = m.equations.contacts[i], j if owned else None
    parts.contacts.append(
        TracedContact(name, slip, m.directions[i], state, guard, inner, (mode_number,), branches, speed, False, flight=flight)
    )


def add_contacts(parts: Assembly, speeds: list[Sym | None]) -> None:
    """All contacts of a machine; those under laws that rest exactly in groups of which each decides for itself, a mode for each contact."""
    m = parts.m
    both = len({law.dynamic for law in m.laws}) > 1
    for i, law in enumerate(m.laws):
        if not law.dynamic or both:  # so that contacts and modes have the same numbers; under laws with inner states it is not used
            parts.mode(m.graph.constant(0.0))
        if law.dynamic:
            parts.memories[i] = [parts.mode(m.graph.constant(0.0)) for _ in range(law.modes)]
    pressed_stops(parts)
    for i in sorted(range(len(m.laws)), key=lambda i: m.laws[i].needs_applied):  # those that ask what is left to bear, last
        if m.laws[i].dynamic:
            _add_dynamic(parts, i, speeds[i])
    for group in groups_of(m.reach, [i for i, law in enumerate(m.laws) if not law.dynamic]):
        if m.equations.together:
            add_several(parts, group, speeds)
        elif m.equations.joined and m.laws[group[0]].flies:
            add_landing(parts, group[0], speeds)
        elif len(group) == 1 and m.of_motion[group[0]] and m.equations.joined:
            solved = add_solved(parts, group[0], speeds)
            parts.events += [*events_of_border(solved, None), *events_of_side(solved)]
        elif m.equations.joined or len({m.directions[i] for i in group}) > 1 or not brakes_one(m.directions[group[0]]):
            add_box(parts, group, speeds)
        elif len(group) > 1:
            add_feet(parts, group, speeds)
        else:
            _add_set_valued(parts, group[0], speeds[group[0]])
    parts.contacts.sort(key=lambda contact: m.equations.contacts.index(contact.name))
    for p in m.pressed:
        add_pressed(parts, p)


def loads_that_end(parts: Assembly, i: int) -> list[Sym]:
    """What is positive as long as a contact is not lost: its load, at rest that of either side.

    A load that follows from forces or velocities may touch zero, as that of a gear does where its torque is zero: it is lost once it
    lies below zero by more than rounding makes of forces.
    """
    m = parts.m
    if m.equations.joined and m.of_motion[i] and not m.laws[i].dynamic:
        return [m.loads[i]] if m.equations.touching[i].pushes else []  # a rail presses on its other side
    if not m.of_motion[i]:
        return [m.loads[i]]
    mass = m.lift(m.equations.masses[next(k for k, g in enumerate(m.directions[i]) if g)])
    least = _UNPRESSED * (mass * (parts.velocity_scale / m.period(m.model)))
    if m.load(i, 1.0) is m.load(i, -1.0):
        return [m.load(i, 1.0) + least]
    one, mode = m.graph.constant(1.0), parts.modes[i]
    return [m.graph.select(-side * mode, one, m.load(i, side) + least) for side in (1.0, -1.0)]


def borders_of_loads(parts: Assembly, i: int) -> list[Sym]:
    """What is positive as long as one load of a contact follows from its motion, at rest to either side; nothing where it is given."""
    m, borders = parts.m, []
    if not m.of_motion[i] or m.laws[i].dynamic or m.equations.joined:  # those that solve for it say so themselves
        return []
    slip, one, mode = parts.slip(i), m.graph.constant(1.0), parts.modes[i] if i < len(parts.modes) else None
    flight = parts.contacts[i].flight
    for side in (1.0, -1.0):
        m.graph.assumed[slip.number] = side
        decides = m.equations.decides(i, m.t, m.places, m.laws[i].sliding(slip, 1.0))
        borders += [] if decides is None else [m.graph.select(-side * mode, one, m.lift(decides) - _BESIDE)]
    m.graph.assumed.clear()
    return borders if flight is None else [m.graph.select(flight.aloft, one, border) for border in borders]


def add_stop(parts: Assembly, stop: Any) -> None:
    """A stop with restitution: where its gap closes, velocities jump, and contacts whose slip jumps are free. It may stay closed."""
    m = parts.m
    graph, one, zero = m.graph, m.graph.constant(1.0), m.graph.constant(0.0)
    p = next((each for each in m.pressed if each.stop is stop), None)
    rate, e, gap = m.lift(stop.rate(m.t, m.v)), m.lift(stop.restitution), m.lift(stop.gap(m.t, m.places))
    _check_instants(m, stop)
    if p is None:
        over = settled_apart(parts, stop, rate)
    else:
        over = settles(parts, p, rate, {i: parts.modes[k] for i, k in _deciding(parts).items()} | _thrown(parts, stop, rate, e))
    impulse = (1.0 + graph.select(over, zero, e)) * rate * _mass_at(parts, stop)
    states = _after(parts, stop, impulse)
    deciding = _deciding(parts)
    modes = {deciding[i]: side for i, side in _thrown(parts, stop, rate, graph.select(over, zero, e)).items()}
    if p is not None:
        gap = graph.select(p.closed, one, gap)
        modes[p.number] = graph.select(over, one, zero)
        position, shut = shut_at(parts, p)
        states[position] = graph.select(over, shut, parts.position(position))
    else:
        number, closed = parts.mode(zero)
        modes[number] = graph.select(over, one, zero)
        parts.events.append((graph.select(closed, -one, one), {}, {}, Status.CHATTERS))
    parts.hits[stop] = len(parts.events), -impulse
    parts.events.append((gap, modes, states, 0))


def _check_instants(m: Symbolic, stop: Any) -> None:
    """`TraceError` for a stop that moves and whose velocity jumps at an instant that nobody names: there it is hit, or left."""
    of_time = () if stop.part.at is None else needed_by([m.lift(stop.part.motion.velocity(m.t))])
    if any(node.op == "flag" and node.name.startswith("clk") for node in of_time) and not stop.part.instants:
        raise TraceError(
            f"the motion of the stop {stop.name} has conditions on time, and it does not name their instants; "
            "type breaks=(...) [s] of the Stop"
        )


def _mass_at(parts: Assembly, stop: Any) -> Sym:
    """The mass that a hit on a stop feels."""
    m = parts.m
    masses = map(m.lift, m.equations.masses)
    return 1.0 / sum((abs(h) * abs(h) / mass for h, mass in zip(stop.direction, masses, strict=True) if h), m.graph.constant(0.0))


def _after(parts: Assembly, stop: Any, impulse: Sym) -> dict[int, Sym]:
    """Velocities of the coordinates after an impulse of a stop."""
    m = parts.m
    masses = map(m.lift, m.equations.masses)
    return {c: m.y[c] - h / mass * impulse for c, (h, mass) in enumerate(zip(stop.direction, masses, strict=True)) if h}


def _deciding(parts: Assembly) -> dict[int, int]:
    """Of each contact under a law that rests exactly the number of its mode."""
    return {parts.m.equations.contacts.index(c.name): c.modes[0] for c in parts.contacts if c.branches is not None}


def _thrown(parts: Assembly, stop: Any, rate: Sym, e: Any) -> dict[int, Sym]:
    """Of each contact whose slip a hit changes, to which side it slips then."""
    m, sides = parts.m, {}
    graph, one = m.graph, m.graph.constant(1.0)
    states = _after(parts, stop, (1.0 + e) * rate * _mass_at(parts, stop))
    for i, number in _deciding(parts).items():
        contact = next(c for c in parts.contacts if m.equations.contacts.index(c.name) == i)
        thrown = sum(
            (contact.taken(c) * (states[c] - m.y[c]) for c, g in enumerate(contact.direction) if g and c in states), graph.constant(0.0)
        )
        if thrown is not graph.constant(0.0):
            sides[i] = graph.by_side(contact.slip + thrown, one, -one, parts.modes[number])
    return sides
