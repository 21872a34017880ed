r"""Points of bodies in the plane that leave the ground where their load falls to zero, fly, and land: a mode, two states, two guards.

While a point touches, the contact keeps its height. Where the load falls to zero, h'' of the motion without this contact is zero too, and
from there on the gap h goes that way, and nothing rubs. Where the gap closes at the rate r < 0 there are impulses, P across by Newton's
restitution and Q along by Coulomb's friction, with A = n W n^T, B = n W g^T, G = g W g^T of the rows n and g of gap and slip, and W the
inverse of M:

.. math:: r^+ = r + A P - B Q = -e r, \qquad w^+ = w + B P - G Q, \qquad Q \in \mu P \operatorname{Sgn} w^+ .

The slip after it falls with Q, so that there is one answer always. Where the series of rebounds would end within a moment the point stays.
The gap is a state of its own: it is zero to the last digit at every hit, so that rebounds die out as precisely as they began.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any

from stickslip.engine.assembly import Assembly
from stickslip.engine.coupled import without_slip
from stickslip.engine.graphs import Substituted
from stickslip.engine.solved_load import SolvedLoad, add_solved, events_of_border
from stickslip.engine.symbols import Graph, Sym
from stickslip.engine.system import Flight
from stickslip.models.friction.law_adapter import TINY

MOMENT = 1e-8  # of the time scale, or of a second: rebounds that are over within it are over at once
_SLIP = "slip at a hit"


@dataclass(frozen=True)
class _Hit:
    """What a hit makes: changes of the coordinates' velocities, and to which side the point slips after it, 0 where it does not."""

    changes: tuple[Sym, ...]
    side: Sym


def add_landing(parts: Assembly, i: int, speeds: list[Sym | None]) -> None:
    """A contact alone under a law that rests exactly, which may leave what it rubs on and land again."""
    m, begin = parts.m, len(parts.events)
    graph, one = m.graph, m.graph.constant(1.0)
    flight = flight_of(parts, i)
    solved = add_solved(parts, i, speeds)
    mode, slip = parts.modes[i], m.slips[i]
    parts.events += events_of_border(solved, None)
    parts.events[begin:] = [(graph.select(flight.aloft, one, guard), *then) for guard, *then in parts.events[begin:]]  # type: ignore[misc]
    first = _first_flight(parts, flight, solved)
    parts.first_modes[i] = graph.select(first, graph.by_side(slip, one, -one, one), parts.first_modes[i])
    parts.first_modes[flight.mode], flight = first, replace(flight, first=first)
    parts.contacts[-1] = replace(parts.contacts[-1], flight=flight, inner=flight.inner)
    for j, (own, free) in enumerate(zip(parts.f, m.free_of(i), strict=True)):
        parts.f[j] = graph.select(flight.aloft, free, own)
    up = graph.by_side(mode, one, -one, one)  # in flight nothing rests
    parts.events.append((graph.select(flight.aloft, one, solved.pressing), {flight.mode: one, i: up}, {}, 0))
    _add_hit(parts, i, flight, solved, up)


def flight_of(parts: Assembly, i: int) -> Flight:
    """The states and the mode of its flight."""
    m = parts.m
    graph, one, zero = m.graph, m.graph.constant(1.0), m.graph.constant(0.0)
    gap, rate = (graph.variable(f"z{i}_{k}") for k in range(2))
    first = graph.select(gap, one, graph.select(rate, one, graph.select(-m.rising(i), zero, one)))
    number, aloft = parts.mode(first)
    begin, speed = len(m.y) + len(parts.inner), m.lift(m.machine.velocity_scale)
    parts.inner += [gap, rate]
    parts.rates += [graph.select(aloft, rate, zero), graph.select(aloft, m.rising(i), zero)]
    parts.scales += [speed * m.period(m.model), speed]
    height, struck = m.equations.heights(m.t, m.places, m.v)[m.equations.contacts[i]], m.struck(i)
    moved = (tuple(map(m.lift, of)) for of in (struck.moved_across, struck.moved_along))
    return Flight(number, aloft, first, (begin, begin + 1), tuple(map(m.lift, height)), *moved)


def _first_flight(parts: Assembly, flight: Flight, solved: SolvedLoad) -> Sym:
    """1 of a point that begins in flight: not of one that slips on the ground and could as well stay, pressed by its own friction."""
    graph, zero, one = parts.m.graph, parts.m.graph.constant(0.0), parts.m.graph.constant(1.0)
    slip = parts.m.slips[solved.i]
    borders = map(Substituted(graph, {solved.mode.name: graph.by_side(slip, one, -one, zero)}).of, solved.borders())
    stays = reduce(lambda rest, border: graph.select(border, rest, zero), borders, one)
    alone = graph.by_side(slip, *[graph.select(stays, flight.first, zero)] * 2, flight.first)
    gap, rate = (parts.inner[k - len(parts.m.y)] for k in flight.inner)
    return graph.select(gap, one, graph.select(rate, one, alone))


def _add_hit(parts: Assembly, i: int, flight: Flight, solved: SolvedLoad, up: Sym) -> None:
    """Where the gap closes: thrown back, or it stays and slips on, rests, or breaks away."""
    m = parts.m
    graph, one, zero = m.graph, m.graph.constant(1.0), m.graph.constant(0.0)
    gap, rate = (parts.inner[k - len(m.y)] for k in flight.inner)
    e = m.lift(m.laws[i].restitution)
    thrown, stays = (_hit(parts, i, rate, of) for of in (e, zero))
    after = jumped(graph, list(zip(m.y, stays.changes, strict=True)))
    over = MOMENT * time_of(parts) * (1.0 - e) * -after.of(m.rising(i)) + 2.0 * (e * rate)  # > 0: so are the rebounds
    rests = after.of(solved.decided(zero))
    exactly = {j: after.of(of) for j, of in without_slip(m, i).items()}
    states: dict[int, Any] = {flight.inner[0]: zero, flight.inner[1]: graph.select(over, zero, -(e * rate))}
    for j, y in enumerate(m.y):
        kept = y + stays.changes[j]
        states[j] = graph.select(over, graph.by_side(stays.side, kept, kept, exactly.get(j, kept)), y + thrown.changes[j])
    side = graph.select(over, graph.by_side(stays.side, one, -one, rests), graph.by_side(thrown.side, one, -one, up))
    guard = graph.select(flight.aloft, gap, one)
    parts.events.append((guard, {flight.mode: graph.select(over, zero, one), i: side}, states, 0))


def jumped(graph: Graph, changes: Sequence[tuple[Sym, Sym]]) -> Substituted:
    """Expressions at states that have jumped by so much, with the conditions that hold there."""
    there = {y.name: y + change for y, change in changes}
    for k, guard in enumerate(graph.guards):
        there[f"b{k}"] = graph.select(Substituted(graph, there).of(guard), graph.constant(1.0), graph.constant(-1.0))
    return Substituted(graph, there)


def time_of(parts: Assembly) -> Any:
    """The time scale of a machine, or a second where it has none."""
    scale = parts.m.machine.time_scale
    return 1.0 if scale is None else parts.m.lift(scale)


def _hit(parts: Assembly, i: int, rate: Sym, e: Sym) -> _Hit:
    """A hit with a restitution, at the rate of the gap that is its state."""
    m, graph = parts.m, parts.m.graph
    struck, zero, one = m.struck(i), parts.m.graph.constant(0.0), parts.m.graph.constant(1.0)
    A, B, G = (m.lift(each) for each in (struck.across, struck.between, struck.along))
    w, gained = m.slips[i], -((1.0 + e) * rate)
    forwards, backwards = (m.lift(struck.steepness) * per_impulse(parts, i, side) for side in (1.0, -1.0))
    holding = (w + B * gained / A) / (G - B * B / A)  # the impulse along that leaves no slip
    across = (gained + B * holding) / A
    side = graph.select(
        holding, graph.select(holding - forwards * across, one, zero), graph.select(backwards * across - holding, -one, zero)
    )
    along = graph.by_side(side, forwards * gained / (A - forwards * B), backwards * gained / (A - backwards * B), holding)
    across = (gained + B * along) / A
    changes = (across * m.lift(up) - along * m.lift(ahead) for up, ahead in zip(struck.moved_across, struck.moved_along, strict=True))
    return _Hit(tuple(changes), side)


def per_impulse(parts: Assembly, i: int, side: float) -> Sym:
    """Impulse along for one across while the point slips to a side: by the slip before it, or where that is to the other side by none."""
    m, graph = parts.m, parts.m.graph
    slip, before = graph.variable(_SLIP), graph.at_once
    graph.at_once = True  # conditions of the law are those of this slip
    friction = parts.per_load(i, slip, side)
    graph.at_once = before
    return Substituted(graph, {_SLIP: graph.select(side * m.slips[i], m.slips[i], graph.constant(side * TINY))}).of(friction)
