r"""Several contacts of bodies in the plane of which some follow from the motion, each feeling the others at once.

Points on ground that pushes slip, rest, fly and land; rails hold on both sides; other contacts have loads that are given.

With the rows n and g of the gaps and slips, W the inverse of M, and normal and friction forces :math:`\lambda` and R,

.. math:: h_i'' = \gamma_i + \sum_j (A_{ij} \lambda_j - B_{ij} R_j), \qquad w_i' = \omega_i + \sum_j (B_{ji} \lambda_j - G_{ij} R_j),
    \qquad A = n W n^T, \quad B = n W g^T, \quad G = g W g^T.

Between events modes say which point touches, and which of those rest. At events every combination is looked at: one agrees whose loads are
not negative, whose rests are inside their limits, whose slips begin to their sides, and whose other points rise. A hit is the same problem
of impulses, in which given loads have no part. Where no combination agrees a run ends. Points of one body on flat ground have one slip
while they touch: they rest together, within what they can bear, and the equations do not say what each of them bears.

A rail presses on either side, :math:`N = \sigma \lambda`, and sigma is a mode that turns over where N falls to zero. Where coordinates
could take its point off, it keeps its height as a point does; else its force is what the bodies that it bears need along its normal,
:math:`\lambda = c\,\ddot q + \lambda_r`, which does nothing to the coordinates: that is the row n = c with A less one, and no push.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from typing import Any, NamedTuple

from stickslip.basics.status import Status
from stickslip.engine.assembly import Assembly
from stickslip.engine.coupled import FrictionAtOnce, limits_of, sliding_both_ways, without_slip
from stickslip.engine.landings import MOMENT, flight_of, jumped, per_impulse, time_of
from stickslip.engine.symbols import Sym
from stickslip.engine.system import Branches, Flight, TracedContact
from stickslip.models.linear_equations import determinant, eliminated, product, total
from stickslip.models.rails import weighed

LIFTS = 2  # of a combination: the point does not touch; else 1 and -1 are its side, 0 is rest
_TIE = 1e-12  # of a load, or of the rates that there are: what rounding may make of a condition that holds with equality
_BESIDE = 1e-10  # of itself without friction: how far beside the border a run ends, whose 24 coefficients are numbers
_STILL = 1e-11  # of the velocity scale: a slip, or a rate of a gap, that is none
_AT_ONCE = 1e-10  # of the time scale: points that are down within it after a hit have part in it
_SAME = 1e-16  # of the distance of a time scale: what rounding makes of the gaps of points that land together

Numbers = dict[int, Sym]
Sides = dict[int, int]


class Bearing(NamedTuple):
    """Normal and friction forces of the points, or impulses."""

    across: Numbers
    along: Numbers


class Feet:
    """The contact problem of a machine.

    `points` push, `rails` hold, and the loads of others are given; `pressed` are those whose loads are solved for.
    """

    def __init__(self, parts: Assembly, group: list[int]):
        self.parts, self.m, self.group = parts, parts.m, group
        m, self.graph = parts.m, parts.m.graph
        self.zero, self.one = self.graph.constant(0.0), self.graph.constant(1.0)
        touching = m.equations.touching
        self.points, self.rails = [i for i in group if m.laws[i].flies], [i for i in group if touching[i].is_held and not m.laws[i].flies]
        self.pressed = [i for i in group if touching[i].is_held]
        self.free = m.free_of(group[0])
        self.moved_along = {i: m.moved_by(i) for i in group}
        self.heights, self.moved_across, self.rising = {}, {}, {}
        for i in self.pressed:
            self._add_normal(i)
        self.A, self.B, self.C, self.G = {}, {}, {}, {}
        for i, j in itertools.product(group, repeat=2):
            if i in self.pressed:
                self.B[i, j] = total(map(product, self.heights[i], self.moved_along[j]))
            if i in self.pressed and j in self.pressed:
                bears = -1.0 if i == j and not touching[i].keeps_height else 0.0
                self.A[i, j] = total([*map(product, self.heights[i], self.moved_across[j]), bears])
            self.G[i, j] = total(map(product, m.rows[i], self.moved_along[j]))
        for i, j in itertools.product(group, self.pressed):  # what forces that press do to slips
            self.C[i, j] = self.B[j, i] if touching[j].keeps_height else 0.0
        drift = m.equations.slip_biases(m.t, m.places, m.v)
        self.sliding = {
            i: m.lift(total([*map(product, m.rows[i], self.free), drift[i], self.graph.derivative(m.slips[i], m.t)])) for i in group
        }
        self.steepness = {i: m.lift(touching[i].steepness(m.places) if touching[i].keeps_height else 1.0) for i in self.pressed}
        per_load = {i: [parts.per_load(i, parts.slip(i), side) for side in (1.0, -1.0)] for i in self.pressed}
        self.kinetic = {i: tuple(self.steepness[i] * of for of in per_load[i]) for i in self.pressed}
        self.limits = {i: tuple(self.steepness[i] * m.lift(of) for of in m.laws[i].breakaway(1.0)) for i in self.pressed}
        self.given = {i: (sliding_both_ways(parts, i), limits_of(parts, i)) for i in group if i not in self.pressed}
        self.at_once = {i: FrictionAtOnce(parts, i, lambda side, i=i: 1.0 if i in self.pressed else m.load(i, side)) for i in group}  # type: ignore[misc]
        contacts = {i: m.equations.joints[m.equations.contacts[i]] for i in self.points}
        on_flat = {i: contact.body for i, contact in contacts.items() if contact.on is None}
        self.alike = {i: [k for k in group if k == i or (i in on_flat and on_flat.get(k) == on_flat[i])] for i in group}
        self.signs = {i: parts.mode(self.one) for i in self.rails}
        self.lost = parts.mode(self.zero)  # 1 where no combination agrees, which ends the run

    def friction_at(self, i: int, now: Sym) -> tuple[Sym, Sym]:
        """Friction for a newton across, or under a given load, forwards and backwards, of a slip to a side `now`, or about to be."""
        forwards, backwards = self.at_once[i].at(now)
        return (self.steepness[i] * forwards, self.steepness[i] * backwards) if i in self.pressed else (forwards, backwards)

    def _add_normal(self, i: int) -> None:
        """The row of a height or of a rail's bodies, what its force moves, and its rate without forces of contacts."""
        m, e = self.m, self.m.equations
        if e.touching[i].keeps_height:
            self.heights[i] = e.touching[i].heights_at(m.places)
            self.moved_across[i], self.rising[i] = m.struck(i).moved_across, m.rising(i)
        else:
            self.heights[i], rest = weighed(e, i, m.t, m.places, m.v, m.held)
            self.moved_across[i] = (0.0,) * len(m.y)
            self.rising[i] = m.lift(total([*map(product, self.heights[i], self.free), rest]))

    def solved(
        self, touching: Sequence[int], resting: Sequence[int], slide: dict[int, Any], gaps: Numbers, slips: Numbers, known: dict[int, Any]
    ) -> Bearing:
        """The forces with which gaps and slips keep what is asked, from their rates `gaps` and `slips` without them.

        `touching` are those whose loads are wanted, and `known` the friction of the others that slip.
        """
        first, rows = self._first(resting), self._equations(touching, resting, slide)
        gaps, slips = (
            {i: total([of[i], *(product(-1.0, product(felt[i, k], R)) for k, R in known.items())]) for i in at}
            for of, felt, at in ((gaps, self.B, touching), (slips, self.G, first))
        )
        right = [-rate[i] for at, rate in ((touching, gaps), (first, slips)) for i in at]
        unknowns = [self.m.lift(of) for of in eliminated(rows, right)] if rows else []
        loads = dict(zip(touching, unknowns, strict=False))
        held = {k: of for i, of in zip(first, unknowns[len(touching) :], strict=True) for k in resting if k == i or self.alike[k][0] == i}
        friction = held | {i: self.m.lift(product(slide[i], loads[i])) for i in touching if i not in resting} | known
        return Bearing({i: loads.get(i, self.zero) for i in self.pressed}, {i: friction.get(i, self.zero) for i in self.group})

    def _first(self, resting: Sequence[int]) -> list[int]:
        """Resting points, of those that rest as one the first."""
        return [i for i in resting if self.alike[i][0] not in resting or self.alike[i][0] == i]

    def _equations(self, touching: Sequence[int], resting: Sequence[int], slide: dict[int, Any]) -> list[tuple[Any, ...]]:
        """What loads of points that touch, and friction of those that rest, do to gaps and slips."""
        first = self._first(resting)
        columns: list[tuple[dict[int, Any], dict[int, Any]]] = [({i: 1.0}, {} if i in resting else {i: slide[i]}) for i in touching]
        columns += [({}, {k: 1.0 for k in resting if k == i or self.alike[k][0] == i}) for i in first]
        rows = []
        for at, across, along in ((touching, self.A, self.B), (first, self.C, self.G)):
            for i in at:
                row = []
                for pressed, rubbed in columns:
                    normal = [product(across[i, j], of) for j, of in pressed.items()]
                    row.append(total([*normal, *(product(-1.0, product(along[i, j], of)) for j, of in rubbed.items())]))
                rows.append(tuple(row))
        return rows

    def rates(self, bearing: Bearing, gaps: Numbers, slips: Numbers) -> tuple[Numbers, Numbers]:
        """Rates of gaps and slips under some forces."""
        up = {i: self.m.lift(total([gaps[i], *self._sum(self.A, self.B, i, bearing)])) for i in self.pressed}
        along = {i: self.m.lift(total([slips[i], *self._sum(self.C, self.G, i, bearing)])) for i in self.group}
        return up, along

    def _sum(self, across: Any, along: Any, i: int, bearing: Bearing) -> list[Any]:
        pushed = {j: product(across[i, j], of) for j, of in bearing.across.items()}
        return [part for j in self.group for part in (pushed.get(j, 0.0), product(-1.0, product(along[i, j], bearing.along[j])))]

    def changes(self, bearing: Bearing) -> list[Sym]:
        """What forces add to the accelerations of the coordinates."""
        return [
            self.m.lift(
                total(
                    part
                    for i in self.group
                    for part in (
                        product(self.moved_across[i][c], bearing.across[i]) if i in self.pressed else 0.0,
                        product(-1.0, product(self.moved_along[i][c], bearing.along[i])),
                    )
                )
            )
            for c in range(len(self.m.y))
        ]

    def slide_of(self, modes: Numbers, signs: dict[int, Any]) -> tuple[dict[int, Any], dict[int, Sym]]:
        """Friction of what slips: for each newton of the force across, and of contacts whose loads are given."""
        slide: dict[int, Any] = {i: self.graph.by_side(modes[i], *self.kinetic[i], self.zero) for i in self.pressed}
        slide |= {i: product(signs[i], slide[i]) for i in self.rails}
        return slide, {i: self.graph.by_side(modes[i], *forces, self.zero) for i, (forces, _) in self.given.items()}

    def by_modes(self, aloft: Numbers, modes: Numbers) -> Bearing:
        """The forces as modes say."""
        graph = self.graph
        slide, known = self.slide_of(modes, {i: sign for i, (_, sign) in self.signs.items()})

        def leaf(touching: tuple[int, ...], resting: tuple[int, ...]) -> Bearing:
            slips = {i: R for i, R in known.items() if i not in resting}
            return self.solved(touching, resting, slide, self.rising, self.sliding, slips)

        def chosen(left: list[int], touching: tuple[int, ...], resting: tuple[int, ...]) -> Bearing:
            if not left:
                return leaf(touching, resting)
            i, *others = left
            touches = (*touching, i) if i in self.pressed else touching
            flies = chosen(others, touching, resting) if i in self.points else None
            slides, rests = (chosen(others, touches, of) for of in (resting, (*resting, i)))

            def one(a: Numbers | None, b: Numbers, c: Numbers) -> Numbers:
                on = {k: graph.by_side(modes[i], b[k], b[k], c[k]) for k in b}
                return on if a is None else {k: graph.select(aloft[i], a[k], on[k]) for k in b}

            return Bearing(*(one(*each) for each in zip(flies or (None, None), slides, rests, strict=True)))

        return chosen(self.group, (), ())

    def borders(self, aloft: Numbers, modes: Numbers) -> list[Sym]:
        """What is positive as long as one set of loads follows from the motion, under friction of what slips, to either side of rails.

        It is the determinant of the equations, as a part of what that is without friction.
        """
        graph, every = self.graph, []

        def least(slide: dict[int, Any], left: list[int], touching: tuple[int, ...], resting: tuple[int, ...]) -> Sym:
            if not left:
                slips = [i for i in touching if i not in resting]
                if not slips:
                    return self.one
                without, under = (determinant(self._equations(touching, resting, of)) for of in (dict.fromkeys(slips, 0.0), slide))
                return self.m.lift(under) / self.m.lift(without) - _BESIDE
            i, *others = left
            touches = (*touching, i) if i in self.pressed else touching
            slides, rests = (least(slide, others, touches, of) for of in (resting, (*resting, i)))
            on = graph.by_side(modes[i], slides, slides, rests)
            return graph.select(aloft[i], least(slide, others, touching, resting), on) if i in self.points else on

        for signs in self.each_sign():
            every.append(least(self.slide_of(modes, signs)[0], self.group, (), ()))
        return every

    def each_sign(self) -> list[dict[int, int]]:
        """The sides on which rails may press."""
        return [dict(zip(self.rails, signs, strict=True)) for signs in itertools.product((1, -1), repeat=len(self.rails))]

    def combinations(self, of: Sequence[int]) -> list[Sides]:
        """All that some contacts may do together, those first in which most rest and touch."""
        every = itertools.product(*((0, 1, -1, LIFTS) if i in self.points else (0, 1, -1) for i in of))
        sides = (dict(zip(of, each, strict=True)) for each in sorted(every, key=lambda each: sum(map(abs, each))))
        return [given for given in sides if self._together(given)]

    def _together(self, given: Sides) -> bool:
        return all(len({given[k] for k in self.alike[i] if k in given and given[k] != LIFTS}) <= 1 for i in given)

    def bearing_of(
        self, given: Sides, signs: dict[int, int], gaps: Numbers, slips: Numbers, slide: Any, known: dict[int, Any]
    ) -> tuple[Bearing, Numbers, Numbers]:
        """The forces of a combination, and the rates under them."""
        touching = [i for i in self.pressed if given[i] != LIFTS]
        resting = [i for i in given if given[i] == 0]
        kinetic = {i: product(float(signs.get(i, 1)), slide[i][0 if given[i] == 1 else 1]) for i in touching}
        bearing = self.solved(touching, resting, kinetic, gaps, slips, known)
        return bearing, *self.rates(bearing, gaps, slips)

    def bounds(self, i: int, bearing: Bearing, sign: Any) -> tuple[Any, Any]:
        """What a contact could bear, backwards and forwards; of a rail that presses on a side."""
        if i in self.given:
            return self.given[i][1]
        load = product(sign, bearing.across[i])
        return self.limits[i][0] * load, self.limits[i][1] * load

    def borne(
        self, i: int, resting: Sequence[int], bearing: Bearing, slack: float = 0.0, signs: dict[int, Any] | None = None
    ) -> tuple[Sym, Sym]:
        """How much more what rests together with a contact could bear, forwards and backwards."""
        both = [k for k in self.alike[i] if k in resting]
        ends = {k: self.bounds(k, bearing, (signs or {}).get(k, 1.0)) for k in both}
        low, high, force, size = (
            reduce(lambda a, b: a + b, of)
            for of in zip(*((*ends[k], bearing.along[k], slack * (ends[k][1] - ends[k][0])) for k in both), strict=True)
        )
        return high - force + size, force - low + size


class Decision(NamedTuple):
    """Which points lift, the modes of the others, the sides on which rails press, and 1 where no combination agrees."""

    lifts: Numbers
    modes: Numbers
    signs: Numbers
    lost: Sym

    def after(self, feet: Feet, flights: dict[int, Flight], lost: Sym) -> dict[int, Sym]:
        """The new modes by their numbers; where nothing has agreed before, `lost`, nothing does."""
        new = {feet.lost[0]: feet.graph.select(lost, lost, self.lost)} | {flights[k].mode: self.lifts[k] for k in feet.points}
        new |= {k: self.modes[k] for k in feet.group}
        return new | {feet.signs[k][0]: self.signs[k] for k in feet.rails}


def decided(feet: Feet, flies: Numbers, slips: Numbers, of: Any) -> Decision:
    """What the accelerations decide.

    `flies` is 1 of a point that is in flight, `slips` the side of a slip, 0 of one that is none; `of` takes expressions to the state after
    an event, these sides too.
    """
    graph, one, zero = feet.graph, feet.one, feet.zero
    aloft, modes, lost = dict.fromkeys(feet.points, one), dict.fromkeys(feet.group, one), one
    sides_of_rails, friction = dict.fromkeys(feet.rails, one), {i: feet.friction_at(i, side) for i, side in slips.items()}
    now = {i: of(side) for i, side in slips.items()}
    for given, signs in reversed(list(itertools.product(feet.combinations(feet.group), feet.each_sign()))):
        known = {i: friction[i][0 if given[i] == 1 else 1] for i in feet.given if given[i]}
        bearing, up, along = feet.bearing_of(given, signs, feet.rising, feet.sliding, friction, known)
        conditions, resting = list[Sym](), [i for i in feet.group if given[i] == 0]
        for i, side in given.items():
            if side == LIFTS:
                conditions.append(graph.select(flies[i], one, of(up[i])))
                continue
            if i in feet.pressed:
                on = [graph.select(flies[i], -one, one)] if i in feet.points else []
                conditions += [*on, of(feet.m.lift(product(float(signs.get(i, 1)), bearing.across[i])))]
            if side == 0:
                both = feet.borne(i, resting, bearing, _TIE, signs)
                conditions += [graph.by_side(now[i], -one, -one, one), *map(of, both)]
            else:
                low, high = feet.bounds(i, bearing, float(signs.get(i, 1)))
                size = high - low if i in feet.given else high - low + product(float(signs.get(i, 1)), bearing.across[i])
                begins = of(side * along[i] + _TIE * (feet.G[i, i] * size))  # nothing holds what does not rub: it slips with no speed
                conditions.append(graph.by_side(now[i], side * one, -side * one, begins))
        agrees = reduce(lambda rest, condition: graph.select(condition, rest, -one), conditions, one)
        for i, side in given.items():
            if i in feet.points:
                aloft[i] = graph.select(agrees, one if side == LIFTS else zero, aloft[i])
            modes[i] = graph.select(agrees, one if side == LIFTS else graph.constant(float(side)), modes[i])
        for i, sign in signs.items():
            sides_of_rails[i] = graph.select(agrees, graph.constant(float(sign)), sides_of_rails[i])
        lost = graph.select(agrees, zero, lost)
    return Decision(aloft, modes, sides_of_rails, lost)


def add_several(parts: Assembly, group: list[int], speeds: list[Sym | None]) -> None:
    """The contacts of a machine of which some push, or hold, and none is alone."""
    m = parts.m
    graph, zero, one = m.graph, m.graph.constant(0.0), m.graph.constant(1.0)
    flights = {i: flight_of(parts, i) for i in group if m.laws[i].flies}
    feet = Feet(parts, group)
    aloft, modes = {i: flight.aloft for i, flight in flights.items()}, {i: parts.modes[i] for i in group}
    signs = {i: sign for i, (_, sign) in feet.signs.items()}
    bearing = feet.by_modes(aloft, modes)
    up, _ = feet.rates(bearing, feet.rising, feet.sliding)
    for j, change in enumerate(feet.changes(bearing)):
        parts.f[j] = feet.free[j] + change
    pressed = {i: m.lift(product(signs.get(i, 1.0), feet.steepness[i] * bearing.across[i])) for i in feet.pressed}
    m.loads = tuple(pressed.get(i, load) for i, load in enumerate(m.loads))
    parts.forces |= bearing.along
    ends = (graph.select(feet.lost[1], -one, one), *feet.borders(aloft, modes))  # before all else that an instant may bring
    parts.events += [(guard, {}, {}, Status.PAINLEVE) for guard in ends]
    for i in group:
        _add_events(feet, i, flights, bearing)
        branches, name = Branches(zero, zero, *(-of for of in feet.borne(i, [i], bearing, signs=signs))), m.equations.contacts[i]
        inner, row = flights[i].inner if i in flights else (), m.weighted(i)
        state = m.owner.index(i) if i in m.owner else None
        contact = TracedContact(name, m.slips[i], m.directions[i], state, None, inner, (i,), branches, speeds[i], False, row=row)
        if i in flights:
            parts.rates[flights[i].inner[1] - len(m.y)] = graph.select(aloft[i], up[i], zero)
            contact = replace(contact, flight=replace(flights[i], together=tuple(feet.alike[i])))
        parts.contacts.append(contact)
    speed = _STILL * m.lift(m.machine.velocity_scale)
    flies = {i: graph.select(parts.inner[f.inner[0] - len(m.y)], one, graph.select(_rate(parts, f), one, zero)) for i, f in flights.items()}
    now = {i: _side(m.slips[i], speed, graph) for i in group}
    for k, first in decided(feet, flies, now, lambda node: node).after(feet, flights, zero).items():
        parts.first_modes[k] = first


def _rate(parts: Assembly, flight: Flight) -> Sym:
    """The rate of a gap."""
    return parts.inner[flight.inner[1] - len(parts.m.y)]


def _side(slip: Sym, still: Sym, graph: Any) -> Sym:
    """The side of a slip, 0 of one that is none."""
    one = graph.constant(1.0)
    return graph.select(slip - still, one, graph.select(-slip - still, -one, graph.constant(0.0)))


def _add_events(feet: Feet, i: int, flights: dict[int, Flight], bearing: Bearing) -> None:
    """What ends the modes of a contact: its slip, its limits, its load, or its flight."""
    parts, m, graph, group = feet.parts, feet.m, feet.graph, feet.group
    one, zero, mode, points = feet.one, feet.zero, feet.parts.modes[i], feet.points
    aloft = {k: flights[k].aloft if k in points else zero for k in group}
    signs = {k: sign for k, (_, sign) in feet.signs.items()}
    still = _STILL * m.lift(m.machine.velocity_scale)
    exactly = without_slip(m, i)
    now = {k: zero if k == i else graph.by_side(parts.modes[k], *[_side(m.slips[k], still, graph)] * 2, zero) for k in group}
    new = decided(feet, {k: aloft[k] for k in points}, now, lambda node: node).after(feet, flights, feet.lost[1])
    parts.events.append((graph.select(aloft[i], one, graph.by_side(mode, m.slips[i], -m.slips[i], one)), new, exactly, 0))
    rests = [graph.select(aloft[k], zero, graph.by_side(parts.modes[k], zero, zero, one)) for k in group]
    forwards, backwards = _together(feet, i, bearing, dict(zip(group, rests, strict=True)), signs)
    kept = {k: parts.modes[k] for k in feet.alike[i]}
    for left, side in ((forwards, one), (backwards, -one)):
        after = {k: graph.select(aloft[k], own, graph.by_side(own, own, own, side)) for k, own in kept.items()}
        guard = graph.select(aloft[i], one, graph.by_side(mode, one, one, left))
        parts.events.append((guard, after | {i: side}, exactly, 0))
    if i in feet.rails:
        parts.events.append((m.loads[i], {feet.signs[i][0]: -signs[i]}, {}, 0))
    if i in points:
        up = graph.by_side(mode, one, -one, one)  # in flight nothing rests
        parts.events.append((graph.select(aloft[i], one, bearing.across[i]), {flights[i].mode: one, i: up}, {}, 0))
        _add_hit(feet, i, flights)


def _together(feet: Feet, i: int, bearing: Bearing, rests: Numbers, signs: Numbers) -> tuple[Sym, Sym]:
    """How much more a point could bear, with those that rest with it as one."""
    alone, both = feet.borne(i, [i], bearing, signs=signs), feet.borne(i, feet.alike[i], bearing, signs=signs)
    others = [rests[k] for k in feet.alike[i] if k != i]
    joined = reduce(lambda a, b: a + b, others) if others else feet.zero
    a, b = (feet.graph.select(joined, of, own) for of, own in zip(both, alone, strict=True))
    return a, b


def _add_hit(feet: Feet, h: int, flights: dict[int, Flight]) -> None:
    """A gap closes: impulses at all points that touch and at rails, and what they do after it."""
    parts, m, graph, group, points = feet.parts, feet.m, feet.graph, feet.group, feet.points
    one, zero = feet.one, feet.zero
    speed = m.lift(m.machine.velocity_scale)
    still = _STILL * speed
    time = time_of(parts)
    gaps, rates = ({i: parts.inner[flights[i].inner[k] - len(m.y)] for i in points} for k in (0, 1))
    late = {i: gaps[i] - _SAME * (speed * time) + _AT_ONCE * (time * rates[i]) for i in points}  # > 0: it lands later, by itself
    lands = {i: one if i == h else graph.select(late[i], -one, graph.select(-rates[i], one, -one)) for i in points}
    touches = {i: one if i == h else graph.select(flights[i].aloft, lands[i], one) for i in points}
    before = {i: graph.select(flights[i].aloft, rates[i], zero) for i in points}
    thrown, after, fails = _impulses(feet, touches, before, {i: m.lift(m.laws[i].restitution) for i in points}, True)
    stays, settled, lost = _impulses(feet, touches, before, dict.fromkeys(points, zero), False)
    over = _over(feet, touches, after, thrown)
    changes = [graph.select(over, a, b) for a, b in zip(feet.changes(stays), feet.changes(thrown), strict=True)]
    there = jumped(graph, list(zip(m.y, changes, strict=True)))
    aloft = {i: graph.select(over, settled[i], after[i]) for i in points}
    rate = {i: graph.select(touches[i], graph.select(over, zero, graph.select(after[i] - still, after[i], zero)), aloft[i]) for i in points}
    flies = {i: graph.select(touches[i], graph.select(rate[i], one, zero), one) for i in points}
    new = decided(feet, flies, {i: _side(m.slips[i], still, graph) for i in group}, there.of).after(feet, flights, feet.lost[1])
    new[feet.lost[0]] = reduce(lambda rest, none: graph.select(none, one, rest), (graph.select(over, lost, zero), fails), new[feet.lost[0]])
    states: dict[int, Any] = {c: y + change for c, (y, change) in enumerate(zip(m.y, changes, strict=True))}
    for i in points:
        states |= {flights[i].inner[1]: rate[i]}
        states |= {flights[i].inner[0]: graph.select(touches[i], zero, gaps[i])}
    parts.events.append((graph.select(flights[h].aloft, parts.inner[flights[h].inner[0] - len(m.y)], one), new, states, 0))


def _impulses(feet: Feet, touches: Numbers, before: Numbers, e: Numbers, may_lift: bool) -> tuple[Bearing, Numbers, Sym]:
    """Impulses of a hit by Newton and Coulomb at all points that touch and at rails, and rates of gaps after it; 1 where none agree.

    Or of a hit after which none lifts.
    """
    m, graph, pressed, one = feet.m, feet.graph, feet.pressed, feet.one
    gaps = {i: (1.0 + e[i]) * before[i] if i in e else feet.zero for i in pressed}
    slips, still = {i: m.slips[i] for i in feet.group}, {i: before.get(i, feet.zero) for i in pressed}
    slide = {i: tuple(feet.steepness[i] * per_impulse(feet.parts, i, side) for side in (1.0, -1.0)) for i in pressed}
    answer = Bearing(dict.fromkeys(pressed, feet.zero), dict.fromkeys(feet.group, feet.zero))
    size, none = _TIE * m.lift(m.machine.velocity_scale), one
    for given, signs in reversed(list(itertools.product(feet.combinations(pressed), feet.each_sign()))):
        bearing, up, along = feet.bearing_of(given, signs, gaps, slips, slide, {})
        conditions, resting = list[Sym](), [i for i in pressed if given[i] == 0]
        for i, side in given.items():
            if side == LIFTS:
                conditions.append(graph.select(touches[i], up[i] + size if may_lift else -one, one))
                continue
            slack = size / feet.G[i, i]
            if i in feet.points:
                conditions += [touches[i], bearing.across[i] + (size / feet.A[i, i] if may_lift else 1e300 * one)]
            else:
                conditions.append(float(signs[i]) * bearing.across[i] + slack)
            rests = feet.borne(i, resting, bearing, signs=signs) if side == 0 else ()
            conditions += [of + slack for of in rests] if side == 0 else [side * along[i] + size]
        agrees = reduce(lambda rest, condition: graph.select(condition, rest, -one), conditions, one)
        answer = Bearing(*({i: graph.select(agrees, new[i], old[i]) for i in old} for new, old in zip(bearing, answer, strict=True)))
        none = graph.select(agrees, feet.zero, none)
    up, _ = feet.rates(answer, still, slips)
    return answer, up, none


def _over(feet: Feet, touches: Numbers, after: Numbers, thrown: Bearing) -> Sym:
    """1 where all that a hit has thrown up would be down again within a moment."""
    m, graph, points = feet.m, feet.graph, feet.points
    time = time_of(feet.parts)
    there = jumped(graph, list(zip(m.y, feet.changes(thrown), strict=True)))
    over = feet.one
    for i in points:
        others = [k for k in points if k != i]
        alone, borne = (there.of(_falling(feet, i, of)) for of in ((), others))
        joined = reduce(lambda rest, k: graph.select(touches[k], rest, -feet.one), others, feet.one)
        loss = 1.0 - m.lift(m.laws[i].restitution)
        soon = MOMENT * time * loss * -graph.select(joined, borne, alone) - 2.0 * after[i]
        over = graph.select(touches[i], graph.select(after[i], graph.select(soon, over, feet.zero), over), over)
    return over


def _falling(feet: Feet, i: int, resting: Sequence[int]) -> Sym:
    """How fast the rate of a gap grows while some other points rest, and rails do not rub."""
    rails = dict.fromkeys(feet.rails, 0.0)
    held = feet.solved([*resting, *rails], resting, rails, feet.rising, feet.sliding, {})
    return feet.rates(held, feet.rising, feet.sliding)[0][i]
