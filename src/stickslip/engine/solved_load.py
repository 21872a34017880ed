r"""One contact whose load follows from the motion: accelerations, load and friction force as one system of linear equations.

.. math:: M a + g R - n \lambda = h, \qquad n a = -\dot n u \;\text{ (a point that keeps its height), or }\;
    \lambda - c\,a = \lambda_r \;\text{ (a rail that bears bodies)}, \qquad R = \mu \sigma \lambda \;\text{ or }\; g a = -\dot g u,

as the mode says: the contact slips, or rests. The load is N = lambda on ground that pushes; a rail presses on either side,
N = sigma lambda, and sigma is a mode that turns over where N falls to zero. At rest the contact breaks away where R is what N can bear:
both are those of rest.
"""

from __future__ import annotations

from typing import Any

from stickslip.basics.status import Status
from stickslip.engine.assembly import Assembly
from stickslip.engine.coupled import without_slip
from stickslip.engine.graphs import Substituted
from stickslip.engine.linear_systems import shorter, solution
from stickslip.engine.symbols import Sym
from stickslip.engine.system import Branches, TracedContact
from stickslip.models.friction.law_adapter import TINY
from stickslip.models.linear_equations import determinant, product, total
from stickslip.models.rails import weighed

_TIE = 1e-13  # of the load: what rounding may make of a rest that holds with equality
_BESIDE = 1e-10  # of itself without friction: how far beside the border a run ends, whose 24 coefficients are numbers
_FEW = 2  # coordinates up to which that border is a determinant, a polynomial of what varies; else a quotient


class SolvedLoad:
    """The contact, with its friction force and its load as expressions of its mode."""

    def __init__(self, parts: Assembly, i: int):
        self.parts, self.m, self.i = parts, parts.m, i
        m, graph = parts.m, parts.m.graph
        self.graph, self.one, self.zero = graph, graph.constant(1.0), graph.constant(0.0)
        self.contact, self.mode = m.equations.touching[i], parts.modes[i]
        if self.contact.pushes:
            self.side = self.one
        else:
            free = m.lift(m.equations.free_reaction(i, m.t, m.places, m.v, m.held))
            self.number, self.side = parts.mode(graph.select(free, self.one, -self.one))
        self.kinetic = tuple(self._per_load(side) for side in (1.0, -1.0))
        self.limits = tuple(map(m.lift, m.laws[i].breakaway(1.0)))  # backward, forward
        self.slope = m.lift(self.contact.steepness(m.places)) if self.contact.keeps_height else self.one
        self._solve()

    def _per_load(self, side: float) -> Sym:
        """Friction for a load of one, to a side."""
        slip = self.parts.slip(self.i)
        self.graph.assumed[slip.number] = side
        force = self.m.lift(self.m.laws[self.i].sliding(slip, 1.0))
        self.graph.assumed.clear()
        return force

    def _equations(self, rests: Any, slides: Any, friction: Any) -> tuple[list[list[Any]], list[Any]]:
        """Rows and right-hand sides, with friction for a unit of lambda while the contact slips."""
        m, e, i = self.m, self.m.equations, self.i
        n, row = len(m.y), self.row
        M, h = e.matrix(m.t, m.places), e.applied(m.t, m.places, m.v, m.held)
        if self.contact.keeps_height:
            up = self.contact.heights_at(m.places)
            lifted, keeps = [product(-1.0, of) for of in up], [*up, 0.0, 0.0]
            given = product(-1.0, self.contact.point(e.moved(m.t, m.places, m.v))[1].second)
        else:
            by, given = weighed(e, i, m.t, m.places, m.v, m.held)
            lifted, keeps = [0.0] * n, [*(product(-1.0, of) for of in by), 1.0, 0.0]
        rows = [[*M[j], lifted[j], row[j]] for j in range(n)]
        rows += [keeps, [*(product(rests, g) for g in row), product(-1.0, product(slides, friction)), slides]]
        drift = total([e.slip_biases(m.t, m.places, m.v)[i], self.graph.derivative(m.slips[i], m.t)])
        return rows, [*h, given, product(-1.0, product(rests, drift))]

    @property
    def row(self) -> list[Any]:
        """What the slip takes of the coordinates' rates."""
        m = self.m
        return [of if known else 0.0 for known, of in zip(m.directions[self.i], m.rows[self.i], strict=True)]

    def _solve(self) -> None:
        m, graph, n = self.m, self.graph, len(self.m.y)
        rests, slides = (graph.by_side(self.mode, of, of, other) for of, other in ((self.zero, self.one), (self.one, self.zero)))
        friction = self.side * (self.slope * graph.by_side(self.mode, *self.kinetic, self.zero))
        rows, right = self._equations(rests, slides, friction)
        unknowns = [m.lift(of) for of in solution(rows, right)]
        self.accelerations, self.force = tuple(unknowns[:n]), unknowns[n + 1]
        self.pressing = unknowns[n]  # lambda
        self.load = self.side * (self.slope * unknowns[n])

    def in_mode(self, node: Sym, mode: float) -> Sym:
        """An expression in another mode."""
        return Substituted(self.graph, {self.mode.name: self.graph.constant(mode)}).of(node)

    def left(self) -> tuple[Sym, Sym]:
        """How much more the contact could bear at rest, forwards and backwards."""
        low, high = self.limits
        return high * self.load - self.force, self.force - low * self.load

    def decided(self, now: Sym) -> Sym:
        """Its mode, where it slips to the side `now`, or does not."""
        graph, one, zero = self.graph, self.one, self.zero
        low, high = self.limits
        pressing, force = (self.in_mode(node, 0.0) for node in (self.pressing, self.force))
        load = self.slope * (pressing if self.contact.pushes else graph.select(pressing, pressing, -pressing))  # sigma may be unknown yet
        slack = _TIE * ((high - low) * load)
        begins = graph.select(high * load - force + slack, graph.select(force - low * load + slack, zero, -one), one)
        return graph.by_side(now, one, -one, begins)

    def borders(self) -> list[Sym]:
        """What is positive as long as one load follows from the motion, at rest to either side."""
        graph = self.graph
        forwards, backwards = self.kinetic[0], -self.kinetic[1]
        if self.contact.pushes:  # friction goes to the side of the slip
            pairs = ((self.one, forwards), (-self.one, -backwards))
            return [graph.select(-side * self.mode, self.one, self._border(self.slope * of)) for side, of in pairs]
        law = self.m.laws[self.i]
        first, second = self.m.lift(law.sliding(TINY, 1.0)), -self.m.lift(law.sliding(-TINY, 1.0))  # about to slip
        largest = self.slope * graph.by_side(self.mode, forwards, backwards, graph.select(first - second, first, second))
        return [self._border(largest), self._border(-largest)]

    def _short(self, rows: list[list[Any]]) -> list[list[Sym]]:
        return [[shorter(self.m.lift(entry)) for entry in row] for row in rows]

    def _border(self, friction: Sym) -> Sym:
        """Positive as long as one load follows under a friction force of so much for a unit of lambda."""
        if len(self.m.y) > _FEW:
            back = self.m.lift(self.m.equations.yields(self.i, self.m.t, self.m.places))
            return self.one + (friction / self.slope) * back - _BESIDE
        with_it, without = (determinant(self._short(self._equations(0.0, 1.0, of)[0])) for of in (friction, 0.0))
        return self.m.lift(with_it) - _BESIDE * self.m.lift(without)


def add_solved(parts: Assembly, i: int, speeds: list[Sym | None]) -> SolvedLoad:
    """A contact under a law that rests exactly, whose load follows from the motion."""
    solved, m, graph = SolvedLoad(parts, i), parts.m, parts.m.graph
    one, zero, mode = solved.one, solved.zero, solved.mode
    parts.forces[i] = solved.force
    m.loads = tuple(solved.load if k == i else load for k, load in enumerate(m.loads))
    forwards, backwards = solved.left()
    exactly = without_slip(m, i)
    parts.events += [
        (graph.by_side(mode, m.slips[i], -m.slips[i], one), {i: solved.decided(zero)}, exactly, 0),
        (graph.by_side(mode, one, one, forwards), {i: one}, exactly, 0),
        (graph.by_side(mode, one, one, backwards), {i: -one}, exactly, 0),
    ]
    state = m.owner.index(i) if i in m.owner else None
    branches, name = Branches(zero, zero, -forwards, -backwards), m.equations.contacts[i]
    parts.contacts.append(
        TracedContact(name, m.slips[i], m.directions[i], state, None, (), (i,), branches, speeds[i], False, row=m.weighted(i))
    )
    for j, a in enumerate(solved.accelerations):
        held = -graph.derivative(m.slips[i] - m.y[j], m.t) if m.owner[j] == i else a
        parts.f[j] = graph.by_side(mode, a, a, held)
    parts.first_modes[i] = solved.decided(graph.by_side(m.slips[i], one, -one, zero))
    return solved


def events_of_side(solved: SolvedLoad) -> list[tuple[Sym, dict[int, Sym], dict[int, Sym], int]]:
    """Where a rail begins to press on its other side: behind the borders, where neither side may be right."""
    return [] if solved.contact.pushes else [(solved.load, {solved.number: -solved.side}, {}, 0)]


def events_of_border(solved: SolvedLoad, aloft: Sym | None) -> list[tuple[Sym, dict[int, Sym], dict[int, Sym], int]]:
    """Where a run ends because no load follows from the motion, or two."""
    one = solved.one
    borders = [border if aloft is None else solved.graph.select(aloft, one, border) for border in solved.borders()]
    return [(border, {}, {}, Status.PAINLEVE) for border in borders]
