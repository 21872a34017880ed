"""Stops that stay closed: where rebounds have come to an end and forces press, both ends move as one until nothing presses them together.

A stop with restitution whose gap h closes at the rate -r throws its ends back, h' = e r. Under a pressure lambda the rebounds shrink by e
and are all over after the time 2 e r m/(lambda (1 - e)), where m is the mass that the hit feels. Where that is a
moment the stop stays closed: a mode of it is 1 from there on, h' = 0, and the sign of lambda = -(h'' without it) m says when it opens.

Under laws with inner states forces follow from the states, and what a closed stop does from them. Under laws that rest exactly an end
without a contact, as the inner mass of a capsule, follows the other end. Where what the stop joins rubs at both ends, or rubs and is
pressed against a wall, both contacts hold one acceleration (`Feet`). How the rest is shared between them and the stop is not told by the
equations: it lasts while there is a lambda >= 0 with which both forces are inside their limits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import reduce
from typing import Any

from stickslip.engine.assembly import Assembly
from stickslip.engine.coupled import Feet, limits_of, sliding_both_ways
from stickslip.engine.graphs import Substituted
from stickslip.engine.symbolic import Symbolic
from stickslip.engine.symbols import Sym
from stickslip.models.mechanics import brakes_one

Event = tuple[Sym, dict[int, Sym], dict[int, Sym], int]  # guard, new modes, new states, status

_MOMENT = 1e-8  # of a period: rebounds that are over within it are over at once
_OPEN = 1e-14  # of the distance of a period: the gap that a closed stop keeps, so that rounding cannot close it once more
_NOTHING = 1e-11  # of the force that gives the mass of a hit the velocity scale in a period: a pull that opens no stop
_STILL = 1e-12  # of the velocity scale: a gap that opens no faster may be closed where a run begins


@dataclass(frozen=True, eq=False)
class Pressed:
    """A stop that may stay closed."""

    stop: Any
    number: int  # of its mode
    closed: Sym  # the mode: 1 while it is closed, else 0
    row: tuple[float, ...]  # what its gap takes of each coordinate
    follower: int | None  # the coordinate that has no contact; None under laws with inner states, and where there is none
    rubs: dict[int, int] = field(default_factory=dict)  # where all ends rub: by coordinate its contact, under a law that rests exactly

    def followed(self, m: Symbolic, a: list[Sym]) -> Sym:
        """Acceleration of the follower with which the gap keeps its rate, from those of the others."""
        return self._following(m, a, self.follower or 0)

    def _following(self, m: Symbolic, a: Sequence[Sym], k: int) -> Sym:
        """Acceleration of a coordinate with which the gap keeps its rate, from those of the others."""
        return -self.rate(m, [*a[:k], m.graph.constant(0.0), *a[k + 1 :]]) / self.row[k]

    def rate(self, m: Symbolic, a: Any) -> Sym:
        """Second derivative of the gap."""
        return sum((h * of for h, of in zip(self.row, a, strict=True) if h), m.lift(self.stop.offset_rate(m.t)))

    def mass(self, m: Symbolic) -> Sym:
        """The mass that a hit feels."""
        inverse = sum(
            (abs(h) * abs(h) / m.lift(mass) for h, mass in zip(self.row, m.equations.masses, strict=True) if h), m.graph.constant(0.0)
        )
        return 1.0 / inverse

    def closing(self, m: Symbolic, a: tuple[Sym, ...]) -> tuple[Sym, ...]:
        """Accelerations with the stop closed, from those that the other forces make; an end that rubs has those of `together`."""
        force = -(self.mass(m) * self.rate(m, a))
        return tuple(of if not h else of + force * (h / m.lift(mass)) for of, h, mass in zip(a, self.row, m.equations.masses, strict=True))

    def common(self, m: Symbolic, a: tuple[Sym, ...]) -> Sym:
        """Acceleration of the first coordinate of a stop whose ends rub, from those with it open."""
        first, *others = self.rubs
        if not others:  # a wall leaves it no choice
            return self._following(m, [m.graph.constant(0.0)] * len(a), first)
        return a[first] - self.mass(m) * self.rate(m, a) * (self.row[first] / m.lift(m.equations.masses[first]))

    def together(self, m: Symbolic, a: Sequence[Any], first: Sym) -> tuple[Any, ...]:
        """Accelerations of all coordinates, of which the stop's have that of the first one."""
        together = list(a)
        for n, c in enumerate(self.rubs):
            together[c] = (
                first if n == 0 else self._following(m, [first if k in self.rubs else m.graph.constant(0.0) for k in range(len(a))], c)
            )
        return tuple(together)

    def feet(self, parts: Assembly) -> Feet:
        """The contacts of all its ends, which hold one acceleration while it is closed."""
        m, graph = parts.m, parts.m.graph
        first, held = next(iter(self.rubs)), {}
        for c, i in self.rubs.items():
            own = -graph.derivative(m.slips[i], m.t)
            held[i] = own if c == first else self._following(m, [own if k == c else graph.constant(0.0) for k in range(len(m.y))], first)
        supports = {i: self._support(m, c, i) for c, i in self.rubs.items()}
        still = m.lift(self.stop.rate(m.t, tuple(graph.constant(0.0) for _ in m.v))) is graph.constant(0.0)
        alike = {i: [k for k in supports if k == i or (still and supports[k] is supports[i])] for i in supports}

        def acceleration(forces: dict[int, Sym]) -> Sym:
            return self.common(m, m.accelerations(forces, closed=None))

        return Feet(parts, acceleration, held, alike)

    def _support(self, m: Symbolic, c: int, i: int) -> Sym:
        """Velocity of what a contact rubs on."""
        still = Substituted(m.graph, {m.y[c].name: m.graph.constant(0.0)})
        return still.of(m.v[c]) - still.of(m.slips[i])


def pressed_stops(parts: Assembly) -> None:
    """Give a mode to each stop that may stay closed; before the contacts are made, because they feel it."""
    m = parts.m
    braked = {c for row in m.directions for c, g in enumerate(row) if g}
    alone = all(brakes_one(row) and m.directions.count(row) == 1 for row in m.directions)
    dynamic = all(law.dynamic for law in m.laws)
    for stop in m.equations.stops if alone or dynamic else ():
        ends = [c for c, h in enumerate(stop.direction) if h]
        follower = None if dynamic else next((c for c in ends if c not in braked), None)
        rubs = {} if dynamic or follower is not None else {c: next(i for i, row in enumerate(m.directions) if row[c]) for c in ends}
        if any(m.laws[i].flies for i in rubs.values()) or sum(stop.direction[c] for c in rubs) * (len(rubs) - 1):
            continue  # what lifts off, and ends that do not go the same way
        number, closed = parts.mode(m.graph.constant(0.0))
        m.pressed.append(Pressed(stop, number, closed, tuple(stop.direction), follower, rubs))


def closes(parts: Assembly, p: Pressed, sides: dict[int, Sym]) -> Sym:
    """How strongly a closed stop is pressed [N], with contacts that slide or rest as `sides` say; negative where it would open."""
    m, k = parts.m, p.follower
    if p.rubs:
        return reduce(lambda a, b: m.graph.select(a - b, b, a), _pressures(parts, p, sides).values())
    if k is None:
        return -(p.mass(m) * p.rate(m, m.accelerations(parts.forces, closed=None)))
    apart = m.accelerations(parts.forces, closed=None)[k]
    held = p.followed(m, [_closed(parts, p, c, sides) for c in range(len(m.y))])
    return (held - apart) * (m.lift(m.equations.masses[k]) / p.row[k])


def _pressures(parts: Assembly, p: Pressed, sides: dict[int, Sym]) -> dict[int, Sym]:
    """By coordinate the force of a closed stop on an end that rubs [N]; the largest that its contact allows where it rests."""
    m, graph, feet, pressures = parts.m, parts.m.graph, p.feet(parts), {}
    sides = {i: sides[feet.alike[i][0]] for i in feet.alike}
    shut = p.together(m, [graph.constant(0.0)] * len(m.y), feet.motion(sides)[1])
    for c, i in p.rubs.items():
        backward, forward = limits_of(parts, i)
        force = graph.by_side(sides[i], *sliding_both_ways(parts, i), forward if p.row[c] > 0 else backward)
        pressures[c] = (shut[c] - m.accelerations({i: force}, closed=None)[c]) * (m.lift(m.equations.masses[c]) / p.row[c])
    return pressures


def _closed(parts: Assembly, p: Pressed, c: int, sides: dict[int, Sym]) -> Sym:
    """Acceleration of a coordinate with the stop closed."""
    m, graph = parts.m, parts.m.graph
    if not p.row[c] or c == p.follower:
        return graph.constant(0.0)
    contact = next((i for i, row in enumerate(m.directions) if row[c] and not m.laws[i].dynamic), None)
    if contact is None:
        return m.accelerations(parts.forces, closed=p)[c]
    forwards, backwards = (m.accelerations({contact: force}, closed=p)[c] for force in sliding_both_ways(parts, contact))
    return graph.by_side(sides[contact], forwards, backwards, -graph.derivative(m.slips[contact] - m.y[c], m.t))


def add_pressed(parts: Assembly, p: Pressed) -> None:
    """Contributions of a closed stop: the follower's motion, the guard at which it opens, and whether it is closed at the start."""
    m, graph, k = parts.m, parts.m.graph, p.follower
    one, zero = graph.constant(1.0), graph.constant(0.0)
    now = {i: parts.modes[i] for i, law in enumerate(m.laws) if not law.dynamic}
    if p.rubs:
        _add_rubbing(parts, p, now)
        return
    if k is not None:
        others = [parts.f[c] if parts.f[c] is not None else m.accelerations(parts.forces)[c] for c in range(len(m.y))]
        open_ = others[k] if parts.f[k] is not None else m.accelerations(parts.forces, closed=None)[k]
        parts.f[k] = graph.select(p.closed, p.followed(m, others), open_)
    apart = closes(parts, p, now)
    if any(law.needs_applied for law in m.laws):  # each end bears itself, and what is left for the stop is no more than rounding
        apart = apart + _NOTHING * p.mass(m) * m.lift(m.machine.velocity_scale) / m.period(m.model)
    parts.events.append((graph.select(p.closed, apart, one), {p.number: zero}, {}, 0))
    shut = Substituted(graph, {p.closed.name: one})
    first = {i: shut.of(parts.first_modes[i]) for i in now}
    begun = Substituted(graph, {p.closed.name: _begins(parts, p, first)})
    for i in now:
        parts.first_modes[i] = begun.of(parts.first_modes[i])


def _begins(parts: Assembly, p: Pressed, first: dict[int, Sym]) -> Sym:
    """Whether it is closed where a run begins, if `first` are the modes of contacts then."""
    m, graph, one, zero = parts.m, parts.m.graph, parts.m.graph.constant(1.0), parts.m.graph.constant(0.0)
    presses = graph.select(closes(parts, p, first), one, zero)
    rate, gap = m.lift(p.stop.rate(m.t, m.v)), m.lift(p.stop.gap(m.t, m.places))
    least = _STILL * m.lift(m.machine.velocity_scale)
    still = graph.select(least - rate, graph.select(least + rate, presses, zero), zero)
    begins = graph.select(4.0 * _kept(m) - gap, still, zero)
    parts.first_modes[p.number] = begins
    return begins


def _add_rubbing(parts: Assembly, p: Pressed, now: dict[int, Sym]) -> None:
    """The same where all ends rub: while it is closed, contacts come to rest and break away together."""
    m, graph, feet = parts.m, parts.m.graph, p.feet(parts)
    one, zero = graph.constant(1.0), graph.constant(0.0)
    for c, a in enumerate(p.together(m, parts.f, feet.motion(feet.modes)[1])):
        parts.f[c] = graph.select(p.closed, a, parts.f[c]) if c in p.rubs else parts.f[c]
    forwards, backwards = feet.breaks()
    for c, i in p.rubs.items():
        shut = [(one, {})] * 3 if i not in feet.feet else feet.events(i, m.y[c], forwards, backwards)
        states = _all_still(m, p, c, i, feet)
        for n, (guard, modes) in enumerate(shut, parts.own_events[i]):
            parts.events[n] = _either(parts, p, (guard, modes, states), parts.events[n])
    for c, apart in _pressures(parts, p, now).items():
        i = p.rubs[c]
        away = graph.by_side(now[i], now[i], now[i], graph.constant(p.row[c]))
        parts.events.append((graph.select(p.closed, apart, one), {p.number: zero, i: away}, {}, 0))
    first = feet.first()
    begins = _begins(parts, p, now | first)
    for i, mode in first.items():
        parts.first_modes[i] = graph.select(begins, mode, parts.first_modes[i])


def _all_still(m: Symbolic, p: Pressed, c: int, i: int, feet: Feet) -> dict[int, Sym]:
    """Velocities of the ends with which a contact of coordinate c rests, to the last digit, and others with it."""
    velocities = {c: m.y[c] - m.slips[i]}
    for other, k in p.rubs.items():
        if other != c:
            velocities[other] = m.y[other] - m.slips[k] if k in feet.alike[i] else m.y[other] + (p.row[c] / p.row[other]) * m.slips[i]
    return velocities


def _either(parts: Assembly, p: Pressed, shut: tuple[Sym, dict[int, Sym], dict[int, Sym]], open_: Event) -> Event:
    """An event that is one thing while a stop is closed, and another while it is open."""
    graph = parts.m.graph
    modes = {k: graph.select(p.closed, shut[1].get(k, parts.modes[k]), open_[1].get(k, parts.modes[k])) for k in {**shut[1], **open_[1]}}
    y = parts.m.y
    states = {j: graph.select(p.closed, shut[2].get(j, y[j]), open_[2].get(j, y[j])) for j in {**shut[2], **open_[2]}}
    return graph.select(p.closed, shut[0], open_[0]), modes, states, open_[3]


def _kept(m: Symbolic) -> Sym:
    """The gap of a closed stop [m]."""
    return _OPEN * m.lift(m.machine.velocity_scale) * m.period(m.model)


def settles(parts: Assembly, p: Pressed, rate: Sym, sides: dict[int, Sym]) -> Sym:
    """Positive where the rebounds after a hit are over at once."""
    m = parts.m
    e = m.lift(p.stop.restitution)
    return (_MOMENT * m.period(m.model)) * ((1.0 - e) * closes(parts, p, sides)) + 2.0 * (e * (p.mass(m) * rate))


def settled_apart(parts: Assembly, stop: Any, rate: Sym) -> Sym:
    """The same of a stop that has no mode to stay closed in: a run ends there."""
    m = parts.m
    now = m.accelerations(parts.forces)
    p = Pressed(stop, -1, m.graph.constant(0.0), tuple(stop.direction), None)
    push = -p.rate(m, [a if own is None else own for a, own in zip(now, parts.f, strict=True)])
    e = m.lift(stop.restitution)
    return (_MOMENT * m.period(m.model)) * ((1.0 - e) * push) + 2.0 * (e * rate)


def shut_at(parts: Assembly, p: Pressed) -> tuple[int, Sym]:
    """A position among the states, by its number, and its value with which the gap is as a closed stop keeps it."""
    m = parts.m
    zero = m.graph.constant(0.0)
    positions = [c for c, position in enumerate(m.places) if position is not zero]
    c = p.follower if p.follower in positions else next(c for c in positions if p.row[c])
    more = (_kept(m) - m.lift(p.stop.gap(m.t, m.places))) / p.row[c]
    return parts.first_position + positions.index(c), m.places[c] + more
