r"""Several points of bodies in the plane on ground that pushes: they slip, rest, fly and land, and each feels the others at once.

With the rows n and g of the gaps and slips, W the inverse of M, and normal and friction forces :math:`\lambda` and R,

.. math:: h_i'' = \gamma_i + \sum_j (A_{ij} \lambda_j - B_{ij} R_j), \qquad w_i' = \omega_i + \sum_j (B_{ji} \lambda_j - G_{ij} R_j),
    \qquad A = n W n^T, \quad B = n W g^T, \quad G = g W g^T.

Between events modes say which point touches, and which of those rest. At events every combination is looked at: one agrees whose loads are
not negative, whose rests are inside their limits, whose slips begin to their sides, and whose other points rise. A hit is the same problem
of impulses. Where no combination agrees a run ends. Two points of one body on flat ground have one slip while both touch: they rest
together, within what both can bear, and the equations do not say what each of them bears.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from typing import Any, NamedTuple

from stickslip.basics.status import Status
from stickslip.engine.assembly import Assembly
from stickslip.engine.coupled import without_slip
from stickslip.engine.landings import MOMENT, flight_of, jumped, per_impulse, time_of
from stickslip.engine.symbols import Sym
from stickslip.engine.system import Branches, Flight, TracedContact
from stickslip.models.linear_equations import determinant, eliminated, product, total

LIFTS = 2  # of a combination: the point does not touch; else 1 and -1 are its side, 0 is rest
_TIE = 1e-12  # of a load, or of the rates that there are: what rounding may make of a condition that holds with equality
_BESIDE = 1e-10  # of itself without friction: how far beside the border a run ends, whose 24 coefficients are numbers
_STILL = 1e-11  # of the velocity scale: a slip, or a rate of a gap, that is none

Numbers = dict[int, Sym]


class Bearing(NamedTuple):
    """Normal and friction forces of the points, or impulses."""

    across: Numbers
    along: Numbers


class Feet:
    """The problem of the points of one machine."""

    def __init__(self, parts: Assembly, group: list[int]):
        self.parts, self.m, self.group = parts, parts.m, group
        m, self.graph = parts.m, parts.m.graph
        self.zero, self.one = self.graph.constant(0.0), self.graph.constant(1.0)
        struck = {i: m.struck(i) for i in group}
        self.heights = {i: m.equations.touching[i].heights_at(m.places) for i in group}
        self.moved_across, self.moved_along = ({i: of[k] for i, of in struck.items()} for k in (0, 1))
        self.A, self.B, self.G = {}, {}, {}
        for i, j in itertools.product(group, repeat=2):
            self.A[i, j], self.B[i, j] = (total(map(product, self.heights[i], of[j])) for of in (self.moved_across, self.moved_along))
            self.G[i, j] = total(map(product, m.rows[i], self.moved_along[j]))
        self.free = m.free_of(group[0])
        self.rising = {i: m.rising(i) for i in group}
        drift = m.equations.slip_biases(m.t, m.places, m.v)
        self.sliding = {
            i: m.lift(total([*map(product, m.rows[i], self.free), drift[i], self.graph.derivative(m.slips[i], m.t)])) for i in group
        }
        self.steepness = {i: m.lift(struck[i].steepness) for i in group}
        per_load = {i: [parts.per_load(i, parts.slip(i), side) for side in (1.0, -1.0)] for i in group}
        self.kinetic = {i: tuple(self.steepness[i] * of for of in per_load[i]) for i in group}
        self.limits = {i: tuple(self.steepness[i] * m.lift(of) for of in m.laws[i].breakaway(1.0)) for i in group}
        given = {i: m.equations.joints[m.equations.contacts[i]] for i in group}
        on_flat = {i: contact.body for i, contact in given.items() if contact.on is None}
        self.alike = {i: [k for k in group if k == i or (i in on_flat and on_flat.get(k) == on_flat[i])] for i in group}

    def solved(self, touching: Sequence[int], resting: Sequence[int], slide: dict[int, Any], gaps: Numbers, slips: Numbers) -> Bearing:
        """The forces with which gaps and slips keep what is asked, from their rates `gaps` and `slips` without them."""
        first, rows = self._first(resting), self._equations(touching, resting, slide)
        right = [-rate[i] for at, rate in ((touching, gaps), (first, slips)) for i in at]
        unknowns = [self.m.lift(of) for of in eliminated(rows, right)] if rows else []
        loads = dict(zip(touching, unknowns, strict=False))
        held = {k: of for i, of in zip(first, unknowns[len(touching) :], strict=True) for k in resting if k == i or self.alike[k][0] == i}
        friction = {i: held[i] if i in resting else self.m.lift(product(slide[i], loads[i])) for i in touching}
        return Bearing({i: loads.get(i, self.zero) for i in self.group}, {i: friction.get(i, self.zero) for i in self.group})

    def _first(self, resting: Sequence[int]) -> list[int]:
        """Resting points, of those that rest as one the first."""
        return [i for i in resting if self.alike[i][0] not in resting or self.alike[i][0] == i]

    def _equations(self, touching: Sequence[int], resting: Sequence[int], slide: dict[int, Any]) -> list[tuple[Any, ...]]:
        """What loads of points that touch, and friction of those that rest, do to gaps and slips."""
        first = self._first(resting)
        columns: list[tuple[dict[int, Any], dict[int, Any]]] = [({i: 1.0}, {} if i in resting else {i: slide[i]}) for i in touching]
        columns += [({}, {k: 1.0 for k in resting if k == i or self.alike[k][0] == i}) for i in first]
        rows = []
        for at, across, along in ((touching, self.A, self.B), (first, None, self.G)):
            for i in at:
                row = []
                for pressed, rubbed in columns:
                    normal = [product(across[i, j] if across is not None else self.B[j, i], of) for j, of in pressed.items()]
                    row.append(total([*normal, *(product(-1.0, product(along[i, j], of)) for j, of in rubbed.items())]))
                rows.append(tuple(row))
        return rows

    def rates(self, bearing: Bearing, gaps: Numbers, slips: Numbers) -> tuple[Numbers, Numbers]:
        """Rates of gaps and slips under some forces."""
        up, along = {}, {}
        for i in self.group:
            up[i] = self.m.lift(total([gaps[i], *self._sum(self.A, self.B, i, bearing)]))
            terms = [(product(self.B[j, i], bearing.across[j]), product(self.G[i, j], bearing.along[j])) for j in self.group]
            along[i] = self.m.lift(total([slips[i], *(part for a, b in terms for part in (a, product(-1.0, b)))]))
        return up, along

    def _sum(self, across: Any, along: Any, i: int, bearing: Bearing) -> list[Any]:
        terms = [(product(across[i, j], bearing.across[j]), product(along[i, j], bearing.along[j])) for j in self.group]
        return [part for a, b in terms for part in (a, product(-1.0, b))]

    def changes(self, bearing: Bearing) -> list[Sym]:
        """What forces add to the accelerations of the coordinates."""
        return [
            self.m.lift(
                total(
                    part
                    for i in self.group
                    for part in (
                        product(self.moved_across[i][c], bearing.across[i]),
                        product(-1.0, product(self.moved_along[i][c], bearing.along[i])),
                    )
                )
            )
            for c in range(len(self.m.y))
        ]

    def by_modes(self, aloft: Numbers, modes: Numbers) -> Bearing:
        """The forces as modes say."""
        graph = self.graph
        slide = {i: graph.by_side(modes[i], *self.kinetic[i], self.zero) for i in self.group}

        def leaf(touching: tuple[int, ...], resting: tuple[int, ...]) -> Bearing:
            return self.solved(touching, resting, slide, self.rising, self.sliding)

        def chosen(left: list[int], touching: tuple[int, ...], resting: tuple[int, ...]) -> Bearing:
            if not left:
                return leaf(touching, resting)
            i, *others = left
            flies = chosen(others, touching, resting)
            slides, rests = (chosen(others, (*touching, i), of) for of in (resting, (*resting, i)))

            def one(a: Numbers, b: Numbers, c: Numbers) -> Numbers:
                return {k: graph.select(aloft[i], a[k], graph.by_side(modes[i], b[k], b[k], c[k])) for k in self.group}

            return Bearing(*(one(*each) for each in zip(flies, slides, rests, strict=True)))

        return chosen(self.group, (), ())

    def border(self, aloft: Numbers, modes: Numbers) -> Sym:
        """What is positive as long as one set of loads follows from the motion, under friction of the points that slip.

        It is the determinant of the equations, as a part of what that is without friction.
        """
        graph = self.graph
        slide = {i: graph.by_side(modes[i], *self.kinetic[i], self.zero) for i in self.group}

        def least(left: list[int], touching: tuple[int, ...], resting: tuple[int, ...]) -> Sym:
            if not left:
                slips = [i for i in touching if i not in resting]
                if not slips:
                    return self.one
                without, under = (determinant(self._equations(touching, resting, of)) for of in (dict.fromkeys(slips, 0.0), slide))
                return self.m.lift(under) / self.m.lift(without) - _BESIDE
            i, *others = left
            slides, rests = (least(others, (*touching, i), of) for of in (resting, (*resting, i)))
            return graph.select(aloft[i], least(others, touching, resting), graph.by_side(modes[i], slides, slides, rests))

        return least(self.group, (), ())

    def combinations(self) -> list[tuple[int, ...]]:
        """All that the points may do together, those first in which most rest and touch."""
        every = itertools.product((0, 1, -1, LIFTS), repeat=len(self.group))
        return sorted(filter(self._together, every), key=lambda sides: sum(map(abs, sides)))

    def _together(self, sides: tuple[int, ...]) -> bool:
        given = dict(zip(self.group, sides, strict=True))
        return all(len({given[k] for k in self.alike[i] if given[k] != LIFTS}) <= 1 for i in self.group)

    def bearing_of(self, sides: tuple[int, ...], gaps: Numbers, slips: Numbers, slide: Any) -> tuple[Bearing, Numbers, Numbers]:
        """The forces of a combination, and the rates under them."""
        given = dict(zip(self.group, sides, strict=True))
        touching = [i for i in self.group if given[i] != LIFTS]
        resting = [i for i in touching if given[i] == 0]
        bearing = self.solved(touching, resting, {i: slide[i][0 if given[i] == 1 else 1] for i in touching}, gaps, slips)
        return bearing, *self.rates(bearing, gaps, slips)

    def borne(self, i: int, resting: Sequence[int], bearing: Bearing, slack: float = 0.0) -> tuple[Sym, Sym]:
        """How much more what rests together with a point could bear, forwards and backwards."""
        both = [k for k in self.alike[i] if k in resting]
        low, high, force, size = (
            reduce(lambda a, b: a + b, of)
            for of in zip(
                *((self.limits[k][0] * bearing.across[k], self.limits[k][1] * bearing.across[k], bearing.along[k],
                   slack * (self.limits[k][1] - self.limits[k][0]) * bearing.across[k]) for k in both), strict=True,
            )
        )  # fmt: skip
        return high - force + size, force - low + size


def decided(feet: Feet, flies: Numbers, now: Numbers, of: Any) -> tuple[Numbers, Numbers, Sym]:
    """Which points lift, and the modes of the others, by accelerations; and 1 where no combination agrees.

    `flies` is 1 of a point that is in flight, `now` the side of a slip, 0 of one that is none; `of` takes expressions to the state after
    an event.
    """
    graph, one, zero = feet.graph, feet.one, feet.zero
    aloft, modes, lost = dict.fromkeys(feet.group, one), dict.fromkeys(feet.group, one), one
    for sides in reversed(feet.combinations()):
        bearing, up, along = feet.bearing_of(sides, feet.rising, feet.sliding, feet.kinetic)
        given, conditions = dict(zip(feet.group, sides, strict=True)), []
        resting = [i for i in feet.group if given[i] == 0]
        for i, side in given.items():
            if side == LIFTS:
                conditions.append(graph.select(flies[i], one, of(up[i])))
                continue
            conditions += [graph.select(flies[i], -one, one), of(bearing.across[i])]
            if side == 0:
                conditions += [graph.by_side(now[i], -one, -one, one), *map(of, feet.borne(i, resting, bearing, _TIE))]
            else:
                begins = of(side * along[i] + _TIE * (feet.G[i, i] * (feet.limits[i][1] - feet.limits[i][0]) * bearing.across[i]))
                conditions.append(graph.by_side(now[i], side * one, -side * one, begins))
        agrees = reduce(lambda rest, condition: graph.select(condition, rest, -one), conditions, one)
        for i, side in given.items():
            aloft[i] = graph.select(agrees, one if side == LIFTS else zero, aloft[i])
            modes[i] = graph.select(agrees, one if side == LIFTS else graph.constant(float(side)), modes[i])
        lost = graph.select(agrees, zero, lost)
    return aloft, modes, lost


def add_several(parts: Assembly, group: list[int], speeds: list[Sym | None]) -> None:
    """The contacts of several points that may fly and land."""
    m = parts.m
    graph, zero, one = m.graph, m.graph.constant(0.0), m.graph.constant(1.0)
    flights = {i: flight_of(parts, i) for i in group}
    feet, number, lost = Feet(parts, group), *parts.mode(zero)
    aloft, modes = {i: flights[i].aloft for i in group}, {i: parts.modes[i] for i in group}
    bearing = feet.by_modes(aloft, modes)
    up, _ = feet.rates(bearing, feet.rising, feet.sliding)
    for j, change in enumerate(feet.changes(bearing)):
        parts.f[j] = feet.free[j] + change
    m.loads = tuple(feet.steepness[i] * bearing.across[i] if i in group else load for i, load in enumerate(m.loads))
    parts.forces |= bearing.along
    for i in group:
        parts.rates[flights[i].inner[1] - len(m.y)] = graph.select(aloft[i], up[i], zero)
        _add_events(feet, i, flights, bearing, number)
        branches, name = Branches(zero, zero, *(-of for of in feet.borne(i, [i], bearing))), m.equations.contacts[i]
        inner, row = flights[i].inner, m.weighted(i)
        state = m.owner.index(i) if i in m.owner else None
        contact = TracedContact(name, m.slips[i], m.directions[i], state, None, inner, (i,), branches, speeds[i], False, row=row)
        parts.contacts.append(replace(contact, flight=replace(flights[i], together=tuple(feet.alike[i]))))
    parts.events += [(guard, {}, {}, Status.PAINLEVE) for guard in (graph.select(lost, -one, one), feet.border(aloft, modes))]
    speed = _STILL * m.lift(m.machine.velocity_scale)
    flies = {i: graph.select(parts.inner[f.inner[0] - len(m.y)], one, graph.select(_rate(parts, f), one, zero)) for i, f in flights.items()}
    now = {i: _side(m.slips[i], speed, graph) for i in group}
    lifts, sides, none = decided(feet, flies, now, lambda node: node)
    parts.first_modes[number] = none
    for i in group:
        parts.first_modes[flights[i].mode], parts.first_modes[i] = lifts[i], sides[i]


def _rate(parts: Assembly, flight: Flight) -> Sym:
    """The rate of a gap."""
    return parts.inner[flight.inner[1] - len(parts.m.y)]


def _side(slip: Sym, still: Sym, graph: Any) -> Sym:
    """The side of a slip, 0 of one that is none."""
    one = graph.constant(1.0)
    return graph.select(slip - still, one, graph.select(-slip - still, -one, graph.constant(0.0)))


def _add_events(feet: Feet, i: int, flights: dict[int, Flight], bearing: Bearing, number: int) -> None:
    """What ends the modes of a point: its slip, its limits, its load, or its flight."""
    parts, m, graph, group = feet.parts, feet.m, feet.graph, feet.group
    one, zero, mode, aloft = feet.one, feet.zero, feet.parts.modes[i], flights[i].aloft
    still = _STILL * m.lift(m.machine.velocity_scale)
    exactly = without_slip(m, i)
    now = {k: zero if k == i else graph.by_side(parts.modes[k], *[_side(m.slips[k], still, graph)] * 2, zero) for k in group}
    lifts, sides, lost = decided(feet, {k: flights[k].aloft for k in group}, now, lambda node: node)
    new = {number: lost} | {flights[k].mode: lifts[k] for k in group} | {k: sides[k] for k in group}
    parts.events.append((graph.select(aloft, one, graph.by_side(mode, m.slips[i], -m.slips[i], one)), new, exactly, 0))
    rests = [graph.select(flights[k].aloft, zero, graph.by_side(parts.modes[k], zero, zero, one)) for k in group]
    forwards, backwards = _together(feet, i, bearing, dict(zip(group, rests, strict=True)))
    kept = {k: parts.modes[k] for k in feet.alike[i]}
    for left, side in ((forwards, one), (backwards, -one)):
        after = {k: graph.select(flights[k].aloft, own, graph.by_side(own, own, own, side)) for k, own in kept.items()}
        guard = graph.select(aloft, one, graph.by_side(mode, one, one, left))
        parts.events.append((guard, after | {i: side}, exactly, 0))
    up = graph.by_side(mode, one, -one, one)  # in flight nothing rests
    parts.events.append((graph.select(aloft, one, bearing.across[i]), {flights[i].mode: one, i: up}, {}, 0))
    _add_hit(feet, i, flights, number)


def _together(feet: Feet, i: int, bearing: Bearing, rests: Numbers) -> tuple[Sym, Sym]:
    """How much more a point could bear, with those that rest with it as one."""
    alone, both = feet.borne(i, [i], bearing), feet.borne(i, feet.alike[i], bearing)
    others = [rests[k] for k in feet.alike[i] if k != i]
    joined = reduce(lambda a, b: a + b, others) if others else feet.zero
    a, b = (feet.graph.select(joined, of, own) for of, own in zip(both, alone, strict=True))
    return a, b


def _add_hit(feet: Feet, h: int, flights: dict[int, Flight], number: int) -> None:
    """A gap closes: impulses at all points that touch, and what they do after it."""
    parts, m, graph, group = feet.parts, feet.m, feet.graph, feet.group
    one, zero = feet.one, feet.zero
    speed = m.lift(m.machine.velocity_scale)
    still = _STILL * speed
    time = time_of(parts)
    gaps, rates = ({i: parts.inner[flights[i].inner[k] - len(m.y)] for i in group} for k in (0, 1))
    lands = {i: one if i == h else graph.select(gaps[i] - still * time, -one, graph.select(-rates[i], one, -one)) for i in group}  # at once
    touches = {i: one if i == h else graph.select(flights[i].aloft, lands[i], one) for i in group}
    before = {i: graph.select(flights[i].aloft, rates[i], zero) for i in group}
    thrown, after = _impulses(feet, touches, before, {i: m.lift(m.laws[i].restitution) for i in group}, True)
    stays, settled = _impulses(feet, touches, before, dict.fromkeys(group, zero), False)
    over = _over(feet, touches, after, thrown)
    changes = [graph.select(over, a, b) for a, b in zip(feet.changes(stays), feet.changes(thrown), strict=True)]
    there = jumped(graph, list(zip(m.y, changes, strict=True)))
    aloft = {i: graph.select(over, settled[i], after[i]) for i in group}
    rate = {i: graph.select(touches[i], graph.select(over, zero, graph.select(after[i] - still, after[i], zero)), aloft[i]) for i in group}
    flies = {i: graph.select(touches[i], graph.select(rate[i], one, zero), one) for i in group}
    now = {i: _side(there.of(m.slips[i]), still, graph) for i in group}
    lifts, sides, lost = decided(feet, flies, now, there.of)
    new = {number: lost} | {flights[k].mode: lifts[k] for k in group} | {k: sides[k] for k in group}
    states: dict[int, Any] = {c: y + change for c, (y, change) in enumerate(zip(m.y, changes, strict=True))}
    for i in group:
        states |= {flights[i].inner[1]: rate[i]}
        states |= {flights[i].inner[0]: graph.select(touches[i], zero, gaps[i])}
    parts.events.append((graph.select(flights[h].aloft, parts.inner[flights[h].inner[0] - len(m.y)], one), new, states, 0))


def _impulses(feet: Feet, touches: Numbers, before: Numbers, e: Numbers, may_lift: bool) -> tuple[Bearing, Numbers]:
    """Impulses of a hit by Newton and Coulomb at all points that touch, and rates of gaps after it; or of one after which none lifts."""
    m, graph, group, one = feet.m, feet.graph, feet.group, feet.one
    gaps, slips = {i: (1.0 + e[i]) * before[i] for i in group}, {i: m.slips[i] for i in group}
    slide = {i: tuple(feet.steepness[i] * per_impulse(feet.parts, i, side) for side in (1.0, -1.0)) for i in group}
    answer = Bearing(dict.fromkeys(group, feet.zero), dict.fromkeys(group, feet.zero))
    for sides in reversed(feet.combinations()):
        bearing, up, along = feet.bearing_of(sides, gaps, slips, slide)
        given, conditions = dict(zip(group, sides, strict=True)), []
        resting = [i for i in group if given[i] == 0]
        size = _TIE * m.lift(m.machine.velocity_scale)
        for i, side in given.items():
            if side == LIFTS:
                conditions.append(graph.select(touches[i], up[i] + size if may_lift else -one, one))
                continue
            conditions += [touches[i], bearing.across[i] + (size / feet.A[i, i] if may_lift else 1e300 * one)]
            slack = size / feet.G[i, i]
            conditions += [of + slack for of in feet.borne(i, resting, bearing)] if side == 0 else [side * along[i] + size]
        agrees = reduce(lambda rest, condition: graph.select(condition, rest, -one), conditions, one)
        answer = Bearing(*({i: graph.select(agrees, new[i], old[i]) for i in group} for new, old in zip(bearing, answer, strict=True)))
    up, _ = feet.rates(answer, before, slips)
    return answer, up


def _over(feet: Feet, touches: Numbers, after: Numbers, thrown: Bearing) -> Sym:
    """1 where all that a hit has thrown up would be down again within a moment."""
    m, graph, group = feet.m, feet.graph, feet.group
    time = time_of(feet.parts)
    there = jumped(graph, list(zip(m.y, feet.changes(thrown), strict=True)))
    over = feet.one
    for i in group:
        others = [k for k in group if k != i]
        alone = there.of(feet.rising[i])
        held = feet.solved(others, others, {}, feet.rising, feet.sliding)
        borne = there.of(feet.rates(held, feet.rising, feet.sliding)[0][i])
        joined = reduce(lambda rest, k: graph.select(touches[k], rest, -feet.one), others, feet.one)
        loss = 1.0 - m.lift(m.laws[i].restitution)
        soon = MOMENT * time * loss * -graph.select(joined, borne, alone) - 2.0 * after[i]
        over = graph.select(touches[i], graph.select(after[i], graph.select(soon, over, feet.zero), over), over)
    return over
