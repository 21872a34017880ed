"""A contact that flies where its load falls to zero, and lands: two more states, a mode, and two guards with resets.

While the load N(t, x) is positive the body stays on what it rubs on, and its gap h and the gap's rate are zero. From where N falls to zero
it flies, h'' = -N/m, and nothing rubs. Where the gap closes, at a rate -v_n, there is an impulse P = m (1 + e) v_n across; the one along is
what stops the slip, but no more than the sliding friction that P makes. Where the series of rebounds would end within a moment the body
stays: then P = m v_n, and in the time of the rebounds that are left out N does what their impulses would have done.
"""

from __future__ import annotations

from stickslip.engine.assembly import Assembly
from stickslip.engine.symbols import Sym
from stickslip.engine.system import Flight

_MOMENT = 1e-8  # of a period: rebounds that are over within it are over at once


def add_flight(parts: Assembly, i: int) -> Flight:
    """The states and the mode of a contact's flight."""
    m = parts.m
    graph, one, zero = m.graph, m.graph.constant(1.0), m.graph.constant(0.0)
    gap, rate = (graph.variable(f"z{i}_{k}") for k in range(2))
    first = graph.select(gap, one, graph.select(rate, one, graph.select(m.loads[i], zero, one)))
    number, aloft = parts.mode(first)
    begin = len(m.y) + len(parts.inner)
    speed, mass = m.lift(m.machine.velocity_scale), m.lift(m.equations.masses[_brakes(parts, i)])
    parts.inner += [gap, rate]
    parts.rates += [graph.select(aloft, rate, zero), graph.select(aloft, -(m.loads[i] / mass), zero)]
    parts.scales += [speed * m.period(m.model), speed]
    return Flight(number, aloft, first, (begin, begin + 1))


def touching(parts: Assembly, i: int, value: Sym) -> Sym:
    """The value of an expression while a contact touches, and zero in flight; once all contacts are made."""
    flight = parts.contacts[i].flight
    return value if flight is None else parts.m.graph.select(flight.aloft, parts.m.graph.constant(0.0), value)


def add_take_off_and_landing(parts: Assembly, i: int, flight: Flight, rest: Sym, still: Sym, held: Sym) -> None:
    """The guards of a contact that may fly; `rest` is the mode of one that has come to rest, `still` its body's velocity there."""
    m, mode_number, mode = parts.m, i, parts.modes[i]
    graph, one, zero, j = m.graph, m.graph.constant(1.0), m.graph.constant(0.0), _brakes(parts, i)
    aloft, (first, second) = flight.aloft, flight.inner
    gap, rate = parts.inner[first - len(m.y)], parts.inner[second - len(m.y)]
    apart = side_in_flight(parts, i, held)
    mass, e = m.lift(m.equations.masses[j]), m.lift(m.laws[i].restitution)
    parts.events.append(
        (graph.select(aloft, one, m.loads[i]), {flight.mode: one, mode_number: graph.by_side(mode, one, -one, apart)}, {}, 0)
    )
    over = _MOMENT * (m.period(m.model) * ((1.0 - e) * m.loads[i])) + 2.0 * (e * (mass * rate))  # > 0: so are the rebounds
    forwards, backwards = _impulses(parts, i, -(mass * rate * graph.select(over, one, 1.0 + e)))
    left = graph.by_side(mode, mass * m.slips[i] - forwards, backwards - mass * m.slips[i], zero)  # > 0: it slips on
    slip = graph.by_side(mode, m.y[j] - forwards / mass, m.y[j] - backwards / mass, still)
    parts.events.append(
        (
            graph.select(aloft, gap, one),
            {flight.mode: graph.select(over, zero, one), mode_number: graph.select(left, mode, graph.select(over, rest, apart))},
            {j: graph.select(left, slip, still), first: zero, second: graph.select(over, zero, -(e * rate))},
            0,
        )
    )


def side_in_flight(parts: Assembly, i: int, held: Sym) -> Sym:
    """To which side a slip goes that is zero in flight."""
    m = parts.m
    one = m.graph.constant(1.0)
    return m.graph.by_side(m.accelerations({})[_brakes(parts, i)] - held, one, -one, one)


def _impulses(parts: Assembly, i: int, across: Sym) -> tuple[Sym, Sym]:
    """Impulses along [N s], forwards and backwards, with one across: what the sliding force has for it, without what no load makes."""
    m, impulses = parts.m, []
    for side in (1.0, -1.0):
        m.graph.assumed[m.slips[i].number] = side
        impulses.append(m.lift(m.laws[i].sliding(m.slips[i], across)) - m.lift(m.laws[i].sliding(m.slips[i], m.graph.constant(0.0))))
    m.graph.assumed.clear()
    return impulses[0], impulses[1]


def _brakes(parts: Assembly, i: int) -> int:
    """The coordinate of the contact."""
    return next(k for k, g in enumerate(parts.m.directions[i]) if g)
