"""Contacts under laws that rest exactly and that act on one another in the same instant: feet of one body, and bodies on bodies.

Between events the modes are held; at an event, and at the start, they are decided anew for the contacts whose slip is zero.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from functools import reduce
from typing import Any

from stickslip.engine.assembly import Assembly
from stickslip.engine.graphs import Substituted
from stickslip.engine.linear_systems import extended
from stickslip.engine.symbolic import Symbolic
from stickslip.engine.symbols import Graph, Sym
from stickslip.engine.system import Branches, TracedContact
from stickslip.models.friction.law_adapter import TINY

_DECIDED = "slip that is decided"
_TIE = 1e-13  # of the terms of a condition: what rounding may make of one that holds with equality
SLIP = 1.5e-14  # of a velocity, 64 roundings: what a slip may be that is zero


class Feet:
    """Several contacts that hold one unknown acceleration, and a weighted median decides who rests.

    They are contacts of one coordinate, or of two that a closed stop makes move as one. Contacts that always move as one, `alike`, are
    one foot, that of the first of them.
    """

    def __init__(self, parts: Assembly, acceleration: Callable[[dict[int, Sym]], Sym], held: dict[int, Sym], alike: dict[int, list[int]]):
        self.parts, self.m, self.graph = parts, parts.m, parts.m.graph
        self._acceleration, self.alike = acceleration, alike
        self.feet = feet = [i for i in alike if alike[i][0] == i]
        self.modes = {i: parts.modes[i] for i in feet}
        self.held = held  # acceleration at which the foot's slip stays as it is
        self.slide = {i: _sums([sliding_both_ways(parts, k) for k in alike[i]]) for i in feet}
        self.limits = {i: _sums([limits_of(parts, k) for k in alike[i]]) for i in feet}  # backward, forward
        self.kinetic = {i: (self.slide[i][1], self.slide[i][0]) for i in feet}  # the same of feet that slide

    def acceleration(self, now: dict[int, Sym], at_rest: dict[int, Sym]) -> Sym:
        """With friction forces at rest as given."""
        return self._acceleration({i: self.graph.by_side(now[i], *self.slide[i], at_rest[i]) for i in self.feet})

    def apart(self, i: int, k: int) -> Sym:
        """To which side foot k slips where foot i rests: that to which its rest moves away."""
        held, zero = self.held, self.graph.constant(0.0)
        away, sizes = held[i] - held[k], held[i] * held[i] + held[k] * held[k]
        return self.graph.select(away * away - _TIE**2 * sizes, away, zero)  # feet that move alike may differ by rounding

    def at_rest(self, i: int, v: Sym) -> Sym:
        """Mode of a foot at an event of another: its slip may be zero there too. `v` is the velocity of the body."""
        sizes = v * v + self.parts.velocity_scale * self.parts.velocity_scale
        slip = self.m.slips[i]
        return self.graph.select(slip * slip - SLIP**2 * sizes, self.modes[i], self.graph.constant(0.0))

    def pushed(self, i: int, now: dict[int, Sym], own: tuple[Sym, Sym], slips: dict[int, tuple[Sym, Sym]]) -> tuple[Sym, Sym]:
        """How strongly a foot is driven beyond its rest, forwards and backwards, with forces of its own and of those that would slip."""

        def forces_if(same: int) -> dict[int, Sym]:
            return {
                k: own[same] if i == k else self.graph.by_side(self.apart(i, k), slips[k][1], slips[k][0], slips[k][same])
                for k in self.feet
            }

        held = self.held[i]
        return self.acceleration(now, forces_if(1)) - held, held - self.acceleration(now, forces_if(0))

    def moved(self, i: int, now: dict[int, Sym], forces: dict[int, tuple[Sym, Sym]]) -> Sym:
        """The mode of a foot whose slip is zero, if these are the forces at which feet slip."""
        graph, one, zero = self.graph, self.graph.constant(1.0), self.graph.constant(0.0)
        push, pull = self.pushed(i, now, forces[i], forces)
        return graph.by_side(now[i], one, -one, graph.select(push, one, graph.select(pull, -one, zero)))

    def decided(self, now: dict[int, Sym], rested: dict[int, Sym]) -> dict[int, Sym]:
        """Modes of all feet. One that rested stays if it can while the others slide; else one rests that static friction holds.

        Where that holds none they slide, and if one comes to rest then, kinetic friction says which.
        """
        graph, feet, one, zero = self.graph, self.feet, self.graph.constant(1.0), self.graph.constant(0.0)
        modes = {i: self.moved(i, now, self.limits) for i in feet}
        if any(a is not b for i in feet for a, b in zip(self.limits[i], self.kinetic[i], strict=True)):
            holds = _total([graph.by_side(modes[i], zero, zero, one) for i in feet])
            sliding = {i: self.moved(i, now, self.kinetic) for i in feet}
            modes = {i: graph.select(holds, modes[i], sliding[i]) for i in feet}
            for i in rested:
                push, pull = self.pushed(i, now, self.limits[i], self.kinetic)
                stays = graph.select(push, zero, graph.select(pull, zero, graph.by_side(rested[i], zero, zero, one)))
                for k in feet:
                    side = zero if i == k else graph.by_side(now[k], one, -one, graph.by_side(self.apart(i, k), one, -one, zero))
                    modes[k] = graph.select(stays, side, modes[k])
        return self.all_alike(modes)

    def all_alike(self, new: dict[int, Sym]) -> dict[int, Sym]:
        """The same for those that are one foot."""
        return {k: mode for i, mode in new.items() for k in self.alike[i]}

    def motion(self, modes: dict[int, Sym]) -> tuple[Sym, Sym]:
        """The acceleration if none rests, and as modes say."""
        sliding = self.acceleration(modes, dict.fromkeys(self.feet, self.graph.constant(0.0)))
        motion = sliding
        for i in reversed(self.feet):
            motion = self.graph.by_side(modes[i], motion, motion, self.held[i])
        return sliding, motion

    def breaks(self) -> tuple[Sym, Sym]:
        """The accelerations at which what rests breaks away, forwards and backwards."""
        return tuple(self.acceleration(self.modes, {k: self.limits[k][side] for k in self.feet}) for side in (1, 0))  # type: ignore[return-value]

    def events(self, i: int, v: Sym, forwards: Sym, backwards: Sym) -> list[tuple[Sym, dict[int, Sym]]]:
        """Guards of a foot, and the modes after them: its slip passes zero, it breaks away forwards, and backwards."""
        graph, one, zero = self.graph, self.graph.constant(1.0), self.graph.constant(0.0)
        mode, slip, held = self.modes[i], self.m.slips[i], self.held[i]
        arrives = {**{k: self.at_rest(k, v) for k in self.feet}, i: zero}
        others = {k: self.modes[k] for k in self.feet if k != i}
        return [
            (graph.by_side(mode, slip, -slip, one), self.decided(arrives, others)),
            (graph.by_side(mode, one, one, held - forwards), self.all_alike({i: one})),
            (graph.by_side(mode, one, one, backwards - held), self.all_alike({i: -one})),
        ]

    def first(self) -> dict[int, Sym]:
        """Modes at the start, from the slips."""
        graph, one, zero = self.graph, self.graph.constant(1.0), self.graph.constant(0.0)
        return self.decided({i: graph.by_side(self.m.slips[i], one, -one, zero) for i in self.feet}, {})


def add_feet(parts: Assembly, every: list[int], speeds: list[Sym | None]) -> None:
    """Several contacts of one coordinate under laws that may hold it."""
    m = parts.m
    j = next(k for k, g in enumerate(m.directions[every[0]]) if g)
    held = {i: -m.graph.derivative(m.slips[i], m.t) for i in every}
    alike = {i: [k for k in every if m.slips[k] is m.slips[i]] for i in every}
    feet = Feet(parts, lambda forces: m.accelerations({**parts.known_forces, **forces})[j], held, alike)
    sliding, motion = feet.motion(feet.modes)
    forwards, backwards = feet.breaks()
    for i in feet.feet:
        exactly = {j: m.y[j] - m.slips[i]}  # zero slip, to the last digit: after a break-away it grows more slowly than rounding at first
        parts.events += [(guard, modes, exactly, 0) for guard, modes in feet.events(i, m.y[j], forwards, backwards)]
    for number, new in feet.first().items():
        parts.first_modes[number] = new
    parts.f[j] = motion
    for i in every:
        first = alike[i][0]
        branches = Branches(sliding, sliding, forwards - held[first], held[first] - backwards)
        state = j if m.owner[j] == i else None
        name = m.equations.contacts[i]
        parts.contacts.append(TracedContact(name, m.slips[i], m.directions[i], state, None, (), (i,), branches, speeds[i], False))


def add_box(parts: Assembly, group: list[int], speeds: list[Sym | None]) -> Box:
    """Bodies on bodies: what rests together has forces that follow from one another, and every combination is looked at.

    Their contact problem is what it gives back.
    """
    box = _box_of(parts, group)
    m, graph = parts.m, parts.m.graph
    one, zero = graph.constant(1.0), graph.constant(0.0)
    forces = box.forces(box.modes)
    parts.forces |= forces
    for i in group:
        mode, (low, high) = box.modes[i], box.limits[i]
        arrives = {**box.modes, i: zero}

        def resting(left: Sym, mode: Sym = mode) -> Sym:
            return graph.by_side(mode, one, one, left)

        slip = graph.by_side(mode, m.slips[i], -m.slips[i], one)
        exactly = without_slip(m, i)
        parts.events += [
            (slip, box.decided(arrives, i), exactly, 0),
            (resting(high - forces[i]), {i: one}, exactly, 0),
            (resting(forces[i] - low), {i: -one}, exactly, 0),
        ]
        state = m.owner.index(i) if i in m.owner else None
        branches = Branches(zero, zero, forces[i] - high, low - forces[i])
        name = m.equations.contacts[i]
        parts.contacts.append(
            TracedContact(name, m.slips[i], m.directions[i], state, None, (), (i,), branches, speeds[i], False, row=m.weighted(i))
        )
    if m.equations.joined:
        _solve_together(parts, box)
        _hold_exactly(parts, group)
    sides = {i: graph.by_side(m.slips[i], one, -one, zero) for i in group}
    for number, new in box.decided(sides).items():
        parts.first_modes[number] = new
    return box


def _box_of(parts: Assembly, group: list[int]) -> Box:
    """The contact problem of some contacts of a machine."""
    m, graph = parts.m, parts.m.graph
    slide, limits = {i: sliding_both_ways(parts, i) for i in group}, {i: limits_of(parts, i) for i in group}
    accelerations = m.accelerations(parts.known_forces)
    free = {i: _total([*_changes(m, i, accelerations), *_drifts(m, i)]) for i in group}
    if m.equations.joined or any(m.weighted(i) for i in group):
        G = _felt(parts, group)
    else:
        masses, rows = list(map(m.lift, m.equations.masses)), m.directions
        G = {
            (i, k): _total([graph.constant(0.0), *(a * b / mass for a, b, mass in zip(rows[i], rows[k], masses, strict=True) if a * b)])
            for i in group
            for k in group
        }
    modes = {i: parts.modes[i] for i in group}
    if m.equations.joined:
        friction = {i: FrictionAtOnce(parts, i, lambda side, i=i: m.load(i, side)) for i in group}  # type: ignore[misc]
        return _BoxInPlane(parts, friction, modes, slide, limits, G, free)
    return Box(graph, modes, slide, limits, G, free)


def _changes(m: Symbolic, i: int, accelerations: tuple[Sym, ...]) -> list[Any]:
    """What accelerations of the coordinates, as far as a contact's slip takes them, do to it."""
    return [g * a for known, g, a in zip(m.directions[i], m.rows[i], accelerations, strict=True) if known]


def _by_place(m: Symbolic, i: int) -> list[Sym]:
    """Rate of a slip whose row varies with the place, while velocities stay as they are."""
    zero = m.graph.constant(0.0)
    slopes = [(m.graph.derivative(m.slips[i], position), v) for position, v in zip(m.places, m.v, strict=True) if position is not zero]
    return [slope * v for slope, v in slopes if slope is not zero]


def _drifts(m: Symbolic, i: int) -> list[Sym]:
    """What changes a contact's slip besides accelerations."""
    return [m.graph.derivative(m.slips[i], m.t), *_by_place(m, i)]


def _solve_together(parts: Assembly, box: Box) -> None:
    """Accelerations and friction forces as one system of linear equations, as the modes say: a contact rests, or its force is known."""
    m, graph, equations = parts.m, parts.m.graph, {}
    zero, one = graph.constant(0.0), graph.constant(1.0)
    for i in box.group:
        rests, slides = (graph.by_side(box.modes[i], of, of, other) for of, other in ((zero, one), (one, zero)))
        row = [rests * g if known else zero for known, g in zip(m.directions[i], m.rows[i], strict=True)]
        equations[i] = row, slides, graph.by_side(box.modes[i], *box.slide[i], -_total(_drifts(m, i)))
    extended(graph, m.accelerations(parts.forces), {i: parts.forces[i] for i in box.group}, equations)


def _felt(parts: Assembly, group: list[int]) -> dict[tuple[int, int], Sym]:
    """How much the force of contact k takes of the rate of slip i, from the traced equations: they are linear in forces."""
    m, graph, G = parts.m, parts.m.graph, {}
    for k in group:
        force = graph.variable(f"force{k}")
        moved = m.accelerations({**parts.known_forces, k: force})
        felt = tuple(-graph.derivative(a, force) for a in moved)
        G |= {(i, k): _total([graph.constant(0.0), *_changes(m, i, felt)]) for i in group}
    return G


def _hold_exactly(parts: Assembly, group: list[int]) -> None:
    """Acceleration of a coordinate whose velocity is a slip, without what rounding leaves of it while it rests."""
    m = parts.m
    moved = m.accelerations(parts.forces)
    for j, i in enumerate(m.owner):
        if i in group:
            held = -m.graph.derivative(m.slips[i] - m.y[j], m.t)
            parts.f[j] = m.graph.by_side(parts.modes[i], moved[j], moved[j], held)


def without_slip(m: Symbolic, i: int) -> dict[int, Sym]:
    """Velocities with which a contact does not slip, to the last digit, from those with which it does by rounding."""
    if not (row := m.weighted(i)):
        return {j: m.y[j] - m.slips[i] for j, g in enumerate(m.directions[i]) if g == 1.0}
    size = _total([g * g for known, g in zip(m.directions[i], row, strict=True) if known])
    return {j: m.y[j] - m.slips[i] * (g / size) for j, (known, g) in enumerate(zip(m.directions[i], row, strict=True)) if known}


class Box:
    """The contact problem of a group: rates of slips w' = beta - G R, with R told by mode or found where contacts rest.

    Parameters
    ----------
    graph : Graph
    modes : dict
        By number of the contact, its mode.
    slide, limits : dict
        Friction forces of sliding (forwards, backwards), and those that it can bear at rest (backward, forward).
    G, free : dict
        How much the force of contact k takes of the rate of slip i, by (i, k); and the rates without friction.
    apart : set of (int, int)
        Pairs that do not rest together: contacts of one coordinate on grounds that move otherwise than one another.
    """

    def __init__(
        self,
        graph: Graph,
        modes: dict[int, Sym],
        slide: dict[int, tuple[Sym, Sym]],
        limits: dict[int, tuple[Sym, Sym]],
        G: dict[tuple[int, int], Sym],
        free: dict[int, Sym],
        apart: frozenset[tuple[int, int]] = frozenset(),
    ):
        self.graph, self.group, self.apart = graph, list(modes), apart
        self.modes, self.slide, self.limits, self.G, self.free = modes, slide, limits, G, free

    def beta(self, forces: dict[int, Sym]) -> dict[int, Sym]:
        """Rates of the slips under some of the forces."""
        return {i: _total([self.free[i], *(-(self.G[i, k] * R) for k, R in forces.items())]) for i in self.group}

    def held(self, pattern: tuple[int, ...], beta: dict[int, Sym]) -> dict[int, Sym]:
        """Forces under which the contacts of a pattern rest: G R = beta, by elimination without pivots (G is positive definite)."""
        rows = {i: ({k: self.G[i, k] for k in pattern}, beta[i]) for i in pattern}
        for n, p in enumerate(pattern):
            for i in pattern[n + 1 :]:
                factor = rows[i][0][p] / rows[p][0][p]
                rows[i] = ({k: rows[i][0][k] - factor * rows[p][0][k] for k in pattern[n + 1 :]}, rows[i][1] - factor * rows[p][1])
        forces: dict[int, Sym] = {}
        for p in reversed(pattern):
            known = _total([rows[p][1], *(-(rows[p][0][k] * forces[k]) for k in forces)])
            forces[p] = known / rows[p][0][p]
        return forces

    def forces(self, modes: dict[int, Sym]) -> dict[int, Sym]:
        """The friction forces in any mode: those of what slides, and what holds the rest."""
        graph, zero = self.graph, self.graph.constant(0.0)
        sliding = {i: graph.by_side(modes[i], self.slide[i][0], self.slide[i][1], zero) for i in self.group}
        beta = self.beta(sliding)

        def by_rest(left: list[int], pattern: tuple[int, ...], i: int) -> Sym:
            """The force of contact i at rest, by which of the others rest."""
            if not left:
                return self.held(pattern, beta)[i]
            k, *others = left
            moving = by_rest(others, pattern, i)
            if not self._rest(together := tuple(sorted((*pattern, k)))):
                return moving
            resting = by_rest(others, together, i)
            return graph.by_side(modes[k], moving, moving, resting)

        forces = {}
        for i in self.group:
            at_rest = by_rest([k for k in self.group if k != i], (i,), i)
            forces[i] = graph.by_side(modes[i], self.slide[i][0], self.slide[i][1], at_rest)
        return forces

    def combinations(self) -> list[dict[int, int]]:
        """All that contacts may do together, those with more at rest first."""
        every = itertools.product((0, 1, -1), repeat=len(self.group))
        together = (sides for sides in every if self._rest([i for i, side in zip(self.group, sides, strict=True) if not side]))
        return [dict(zip(self.group, sides, strict=True)) for sides in sorted(together, key=_sliding)]

    def decided(self, now: dict[int, Sym], touched: int | None = None) -> dict[int, Sym]:
        """Modes of the contacts: the first combination that agrees with its own forces, those with more contacts at rest first.

        `touched` is the one that has just come to rest.
        """
        graph, group = self.graph, self.group
        one = graph.constant(1.0)
        new = {i: graph.constant(0.0) for i in group}
        for given in reversed(self.combinations()):
            agrees = reduce(lambda rest, condition: graph.select(condition, rest, -one), self._conditions(given, now), one)
            new = {i: graph.select(agrees, graph.constant(float(given[i])), new[i]) for i in group}
        return new

    def _rest(self, pattern: Sequence[int]) -> bool:
        """Whether these contacts may rest together."""
        return not any(pair in self.apart for pair in itertools.combinations(pattern, 2))

    def _conditions(self, given: dict[int, int], now: dict[int, Sym]) -> list[Sym]:
        """Conditions of a combination, positive if met: resting forces within their limits, slips that begin to the right side."""
        graph, one = self.graph, self.graph.constant(1.0)
        at_limit = {i: self.limits[i][1 if side > 0 else 0] for i, side in given.items() if side}
        sliding = {i: graph.by_side(now[i], self.slide[i][0], self.slide[i][1], at_limit[i]) for i in at_limit}
        beta = self.beta(sliding)
        held = self.held(tuple(i for i, side in given.items() if not side), beta)
        rates = self.beta(sliding | held)
        conditions = []
        for i, side in given.items():
            low, high = self.limits[i]
            slack = _TIE * (high - low)
            moves = graph.by_side(now[i], one, one, -one)  # whether it slides already
            if side == 0:
                conditions += [-moves, high - held[i] + slack, held[i] - low + slack]
            else:
                begins = side * rates[i] + self.G[i, i] * slack
                conditions.append(graph.select(moves, side * now[i], begins))
        return conditions


class _BoxInPlane(Box):
    """That of bodies whose places follow from coordinates, as the judge decides it: what rested before stays if it can.

    What begins to slip feels kinetic friction, and what slips that of its slip at the instant.
    """

    def __init__(self, parts: Assembly, friction: dict[int, FrictionAtOnce], *given: Any):
        super().__init__(parts.m.graph, *given)
        self.friction = friction

    def decided(self, now: dict[int, Sym], touched: int | None = None) -> dict[int, Sym]:
        """Modes of the contacts: of the combinations that agree one in which all rest that rested, if there is one; else as elsewhere."""
        graph, one, zero = self.graph, self.graph.constant(1.0), self.graph.constant(0.0)
        free = {i: one if i == touched else graph.by_side(now[i], one, one, -one) for i in self.group}
        friction = {i: self.friction[i].at(now[i]) for i in self.group}
        whole, kept, keeps = dict.fromkeys(self.group, zero), dict.fromkeys(self.group, zero), zero
        for given in reversed(self.combinations()):
            agrees = reduce(lambda rest, condition: graph.select(condition, rest, -one), self._conditions_of(given, now, friction), one)
            stays = reduce(lambda rest, i: graph.select(free[i], rest, -one), [i for i, side in given.items() if side], agrees)
            whole = {i: graph.select(agrees, graph.constant(float(given[i])), whole[i]) for i in self.group}
            kept = {i: graph.select(stays, graph.constant(float(given[i])), kept[i]) for i in self.group}
            keeps = graph.select(stays, one, keeps)
        return {i: graph.select(keeps, kept[i], whole[i]) for i in self.group}

    def _conditions_of(self, given: dict[int, int], now: dict[int, Sym], friction: dict[int, tuple[Sym, Sym]]) -> list[Sym]:
        """Conditions of a combination, positive if met."""
        graph, one = self.graph, self.graph.constant(1.0)
        sliding = {i: friction[i][0 if side > 0 else 1] for i, side in given.items() if side}
        held = self.held(tuple(i for i, side in given.items() if not side), self.beta(sliding))
        rates, conditions = self.beta(sliding | held), list[Sym]()
        for i, side in given.items():
            low, high = self.limits[i]
            slack = _TIE * (high - low)
            if side == 0:
                conditions += [graph.by_side(now[i], -one, -one, one), high - held[i] + slack, held[i] - low + slack]
            else:
                conditions.append(graph.by_side(now[i], side * one, -side * one, side * rates[i] + self.G[i, i] * slack))
        return conditions


class FrictionAtOnce:
    """Friction of a contact at an instant that is decided, whatever the mode says that ends: its law is asked at the slip there.

    `load` gives its load, of a contact that slips, or is about to, to a side.
    """

    def __init__(self, parts: Assembly, i: int, load: Callable[[float], Any]):
        m, before = parts.m, parts.m.graph.at_once
        self.graph, self.slip, loads = m.graph, m.slips[i], {side: load(side) for side in (1.0, -1.0)}
        self.graph.at_once = True  # conditions of the law are those of this slip
        self.asked = {side: m.lift(m.laws[i].sliding(self.graph.variable(_DECIDED), of)) for side, of in loads.items()}
        self.graph.at_once = before

    def at(self, now: Sym) -> tuple[Sym, Sym]:
        """The forces forwards and backwards of a slip that goes to a side `now`, or is about to go to one."""
        graph = self.graph
        slips = {side: graph.select(side * now, self.slip, graph.constant(side * TINY)) for side in (1.0, -1.0)}
        forwards, backwards = (Substituted(graph, {_DECIDED: slips[side]}).of(force) for side, force in self.asked.items())
        return forwards, backwards


def _sliding(sides: tuple[int, ...]) -> int:
    """How many contacts slide."""
    return sum(map(abs, sides))


def sliding_both_ways(parts: Assembly, i: int) -> tuple[Sym, Sym]:
    """Friction force of a contact that slides forwards, and backwards."""
    m, forces, slip = parts.m, [], parts.slip(i)
    for side in (1.0, -1.0):
        m.graph.assumed[slip.number] = side
        forces.append(m.lift(m.laws[i].sliding(slip, m.load(i, side))))
    m.graph.assumed.clear()
    return forces[0], forces[1]


def limits_of(parts: Assembly, i: int) -> tuple[Sym, Sym]:
    """Friction forces (backward, forward) that a contact can bear at rest."""
    backward, forward = breakaway(parts.m, i)
    return parts.m.lift(backward), parts.m.lift(forward)


def breakaway(m: Symbolic, i: int) -> tuple[Any, Any]:
    """The same as a law says them: each under the load of a body about to move that way."""
    low, high = m.laws[i].breakaway(m.load(i, -1.0))
    return (low, high) if i not in m.by_side else (low, m.laws[i].breakaway(m.load(i, 1.0))[1])


def _sums(pairs: list[tuple[Sym, Sym]]) -> tuple[Sym, Sym]:
    return _total([a for a, _ in pairs]), _total([b for _, b in pairs])


def _total(terms: list[Any]) -> Any:
    return reduce(lambda a, b: a + b, terms)
