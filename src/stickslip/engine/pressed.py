"""Stops that stay closed: where rebounds have come to an end and forces press, both ends move as one until nothing presses them together.

A stop with restitution whose gap h closes at the rate -r throws its ends back, h' = e r. Under a pressure lambda the rebounds shrink by e
and are all over after the time 2 e r m/(lambda (1 - e)), where m is the mass that the hit feels. Where that is a
moment the stop stays closed: a mode of it is 1 from there on, h' = 0, and the sign of lambda = -(h'' without it) m says when it opens.

Under laws with inner states forces follow from the states, and what a closed stop does from them. Under laws that rest exactly, one of the
ends must have no contact, as the inner mass of a capsule: what it does while the stop is closed follows from the other end. Where
both have one, a case ends with a status that says so.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.engine.assembly import Assembly
from stickslip.engine.coupled import sliding_both_ways
from stickslip.engine.graphs import Substituted
from stickslip.engine.symbolic import Symbolic
from stickslip.engine.symbols import Sym

__all__ = ["Pressed", "add_pressed", "closes", "pressed_stops"]

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
    follower: int | None  # the coordinate that has no contact; None under laws with inner states

    def followed(self, m: Symbolic, a: list[Sym]) -> Sym:
        """Acceleration of the follower with which the gap keeps its rate, from those of the others."""
        k = self.follower or 0
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
        """Accelerations with the stop closed, from those that the other forces make."""
        force = -(self.mass(m) * self.rate(m, a))
        return tuple(of if not h else of + force * (h / m.lift(mass)) for of, h, mass in zip(a, self.row, m.equations.masses, strict=True))


def pressed_stops(parts: Assembly) -> None:
    """Give a mode to each stop that may stay closed; before the contacts are made, because they feel it."""
    m = parts.m
    braked = {c for row in m.directions for c, g in enumerate(row) if g}
    alone = all(sum(map(abs, row)) == 1.0 and m.directions.count(row) == 1 for row in m.directions)
    told = all(law.dynamic for law in m.laws)
    for stop in m.equations.stops if alone or told else ():
        follower = None if told else next((c for c, h in enumerate(stop.direction) if h and c not in braked), None)
        if told or follower is not None:
            number, closed = parts.mode(m.graph.constant(0.0))
            m.pressed.append(Pressed(stop, number, closed, tuple(stop.direction), follower))


def closes(parts: Assembly, p: Pressed, sides: dict[int, Sym]) -> Sym:
    """How strongly a closed stop is pressed [N], with contacts that slide or rest as `sides` say; negative where it would open."""
    m, k = parts.m, p.follower
    if k is None:
        return -(p.mass(m) * p.rate(m, m.accelerations(parts.forces, closed=None)))
    apart = m.accelerations(parts.forces, closed=None)[k]
    held = p.followed(m, [_closed(parts, p, c, sides) for c in range(len(m.y))])
    return (held - apart) * (m.lift(m.equations.masses[k]) / p.row[k])


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
    """What a closed stop adds: the motion of the follower, the guard at which it opens, and whether it is closed at the start."""
    m, graph, k = parts.m, parts.m.graph, p.follower
    one, zero = graph.constant(1.0), graph.constant(0.0)
    now = {i: parts.modes[i] for i, law in enumerate(m.laws) if not law.dynamic}
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
    presses = graph.select(closes(parts, p, first), one, zero)
    rate, gap = m.lift(p.stop.rate(m.t, m.v)), m.lift(p.stop.gap(m.t, m.places))
    least = _STILL * m.lift(m.machine.velocity_scale)
    still = graph.select(least - rate, graph.select(least + rate, presses, zero), zero)
    begins = graph.select(4.0 * _kept(m) - gap, still, zero)
    parts.first_modes[p.number] = begins
    begun = Substituted(graph, {p.closed.name: begins})
    for i in now:
        parts.first_modes[i] = begun.of(parts.first_modes[i])


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
    places = [c for c, place in enumerate(m.places) if place is not zero]
    c = p.follower if p.follower in places else next(c for c in places if p.row[c])
    more = (_kept(m) - m.lift(p.stop.gap(m.t, m.places))) / p.row[c]
    return len(m.y) + len(parts.inner) + places.index(c), m.places[c] + more
