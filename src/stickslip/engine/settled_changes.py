"""Small changes of a start of which a motion keeps what contacts leave: what rests does not slip, what touches stays on the ground.

Points of bodies in the plane are settled together, first their heights by the positions, then rates of heights and slips by the velocities.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import add
from typing import Any

from stickslip.engine.graphs import Along, Substituted
from stickslip.engine.symbols import Sym
from stickslip.engine.system import System, TracedContact
from stickslip.models.linear_equations import eliminated, product, total
from stickslip.models.mechanics import brakes_one


def settled_changes(system: System, changes: list[Sym], along: Along) -> dict[int, Sym]:
    """The changes, by number of the state, with which a run begins: of velocities, gaps and positions.

    `along` takes expressions of the system to how they change.
    """
    exact = [contact for contact in system.contacts if contact.branches is not None]
    if any(contact.flight is not None and contact.flight.point for contact in exact):
        return _Points(system, exact, changes, along).settled()
    graph, now, first = system.graph, dict[int, Sym](), system.states
    for _ in exact if any(not brakes_one(contact.direction) for contact in exact) else exact[:1]:  # bodies on bodies pass it on
        for contact in exact:
            (number,) = contact.modes
            slips = Substituted(graph, {changes[i - first].name: new for i, new in now.items()}).of(along.of(contact.slip))
            for j, part in _parts_of_slip(contact).items():
                old = now.get(first + j, changes[j])
                now[first + j] = graph.by_side(system.modes[number], old, old, old - slips * part)
    for flight in (contact.flight for contact in exact if contact.flight is not None):  # a gap that is closed stays closed
        now |= {first + k: graph.select(flight.aloft, changes[k], graph.constant(0.0)) for k in flight.inner}
    return now


def changes_of_landing(system: System, k: int, states: dict[str, Sym], modes: Sequence[Sym], along: Along) -> dict[str, Sym]:
    """Changes after an event, by name, where points have landed at one instant: what now touches together is settled.

    `states` are the new states and changes by name, `modes` the new modes. A motion beside lands on one point after the other, and then
    touches with both too: what made the difference is forgotten.
    """
    graph, contacts = system.graph, [c for c in system.contacts if c.flight is not None and c.flight.point]
    gaps = [system.y[c.flight.inner[0]] for c in contacts if c.flight is not None]
    own = [i for i, gap in enumerate(gaps) if system.guards[k].op == "select" and any(gap is of for of in system.guards[k].args)]
    if len(contacts) < 2 or not own:
        return {}
    one, at_once = graph.constant(1.0), graph.constant(-1.0)
    for i, (contact, gap) in enumerate(zip(contacts, gaps, strict=True)):
        if i in own or contact.flight is None:
            continue
        lands = graph.select(contact.flight.aloft, graph.select(modes[contact.flight.mode], -one, one), -one)
        at_once = graph.select(graph.select(states[gap.name], -one, lands), one, at_once)
    after = {c.name: modes[c.flight.mode] for c in contacts if c.flight is not None}
    points, before = _Points(system, contacts, [], along, after), dict(states)
    for wanted, numbers in ((points.heights, points.positions), (points.rates_of_heights, points.velocities)):
        now = Substituted(graph, before)
        taken = points.chosen(wanted(now), numbers)
        names = [f"d {system.y[j].name}" for j in numbers]
        before |= {name: before[name] - of for name, of in zip(names, taken, strict=True)}
    return {name: graph.select(at_once, new, states[name]) for name, new in before.items() if new is not states[name]}


class _Points:
    """The contacts of a machine of which some are points that may fly; `after` says which do after an event, by name of the contact."""

    def __init__(
        self, system: System, contacts: list[TracedContact], changes: list[Sym], along: Along, after: dict[str, Sym] | None = None
    ):
        self.system, self.graph, self.contacts, self.changes, self.along = system, system.graph, contacts, changes, along
        self.numbers = [system.contacts.index(contact) for contact in contacts]
        self.velocities, self.positions = range(system.coordinates), system.positions
        self.after = after or {}

    def settled(self) -> dict[int, Sym]:
        """The changes by number of the state."""
        system, zero = self.system, self.graph.constant(0.0)
        before = {y.name: change for y, change in zip(self.changes, self.changes, strict=True)}
        at = dict(zip((change.name for change in self.changes), range(len(self.changes)), strict=True))
        for states, wanted in ((self.positions, self.heights), (self.velocities, self._rates)):
            taken = self.chosen(wanted(Substituted(self.graph, before)), states)
            before |= {self.changes[k].name: self.changes[k] - of for k, of in zip(states, taken, strict=True)}
        now = {system.states + at[name]: new for name, new in before.items() if new is not self.changes[at[name]]}
        after = Substituted(self.graph, before)
        for flight in (contact.flight for contact in self.contacts if contact.flight is not None):
            for k, own in zip(flight.inner, flight.point, strict=True):
                now[system.states + k] = self.graph.select(flight.aloft, after.of(self.along.of(own)), zero)
        return now

    def heights(self, now: Substituted) -> list[_Condition]:
        """What positions have to keep: the heights of points that touch."""
        return self._of_points(now, 0, [self.system.y[k] for k in self.positions])

    def rates_of_heights(self, now: Substituted) -> list[_Condition]:
        """The same of velocities."""
        return self._of_points(now, 1, [self.system.y[j] for j in self.velocities])

    def _of_points(self, now: Substituted, which: int, states: Sequence[Sym]) -> list[_Condition]:
        graph, held, at = self.graph, [], Substituted(self.graph, {y.name: now.leaves.get(y.name, y) for y in self.system.y})
        one = graph.constant(1.0)
        for contact in self.contacts:
            if (flight := contact.flight) is not None:
                own, aloft = flight.point[which], self.after.get(contact.name, flight.aloft)
                row, moved = [at.of(graph.derivative(own, y)) for y in states], [at.of(graph.constant(0.0) + of) for of in flight.across]
                held.append(_Condition(graph.select(aloft, -one, one), row, moved, now.of(self.along.of(own))))
        return held

    def _rates(self, now: Substituted) -> list[_Condition]:
        """The same of velocities: rates of heights that are kept, and slips of what rests."""
        graph, one, rests = self.graph, self.graph.constant(1.0), dict[int, Sym]()
        held = self.rates_of_heights(now)
        for i, contact in zip(self.numbers, self.contacts, strict=True):
            (number,), flight = contact.modes, contact.flight
            row = [graph.constant(0.0) + contact.taken(j) if g else graph.constant(0.0) for j, g in enumerate(contact.direction)]
            rests[i] = graph.by_side(self.system.modes[number], -one, -one, one)
            if flight is not None:
                rests[i] = graph.select(flight.aloft, -one, rests[i])
            others = () if flight is None else (rests[k] for k in flight.together if k in rests and k != i)
            alone = reduce(lambda rest, other: graph.select(other, -one, rest), others, rests[i])  # the first of those that rest as one
            held.append(_Condition(alone, row, row if flight is None else flight.along, now.of(self.along.of(contact.slip))))
        return held

    def chosen(self, conditions: list[_Condition], states: Sequence[int]) -> list[Sym]:
        """What is taken of each state so that all conditions hold which do."""
        graph, zero = self.graph, self.graph.constant(0.0)

        def leaf(those: list[_Condition]) -> list[Sym]:
            if not those:
                return [zero] * len(states)
            matrix = [[zero + total(map(product, a.row, b.moved)) for b in those] for a in those]
            sizes = eliminated(matrix, [each.change for each in those])
            return [zero + total(product(size, each.moved[n]) for size, each in zip(sizes, those, strict=True)) for n in range(len(states))]

        def chosen(left: list[_Condition], those: list[_Condition]) -> list[Sym]:
            if not left:
                return leaf(those)
            first, *others = left
            pairs = zip(chosen(others, [*those, first]), chosen(others, those), strict=True)
            return [graph.select(first.holds, kept, free) for kept, free in pairs]

        return chosen(conditions, [])


class _Condition:
    """What a start has to keep: positive where it does, its slopes, how states change for it, and by how much it is off."""

    def __init__(self, holds: Sym, row: Sequence[Any], moved: Sequence[Any], change: Sym):
        self.holds, self.row, self.moved, self.change = holds, row, moved, change


def _parts_of_slip(contact: TracedContact) -> dict[int, Any]:
    """By coordinate what its velocity has to give so that a contact does not slip, as a part of the slip."""
    if not contact.row:
        return {contact.direction.index(1.0): 1.0}
    taken = {j: contact.taken(j) for j, g in enumerate(contact.direction) if g}
    size = reduce(add, [g * g for g in taken.values()])
    return {j: g / size for j, g in taken.items()}
