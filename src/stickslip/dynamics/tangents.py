"""Small changes along a run: how far a change of the start, or of a number of the model, has moved the end and the way.

They are passive states of the system itself (`stickslip.engine.tangent`), a lane of the kernel for each direction.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np

from stickslip.batch import numbers_by_name
from stickslip.dynamics.many import picked
from stickslip.dynamics.mapping import coordinates, map_method
from stickslip.engine import lanes
from stickslip.engine.graphs import Along
from stickslip.engine.symbols import Graph, Sym
from stickslip.engine.tangent import part_in, tangent
from stickslip.engine.trace import numbers_of
from stickslip.engine.values import values_of
from stickslip.fields import replace_leaf
from stickslip.machine import machine_of
from stickslip.sealing import sealed

__all__ = ["Changes", "changes_along", "jacobian_of", "jacobians_of", "not_followed", "number_slopes", "orders_differ", "start_changes"]

Array = Any
_ORDERS = (1, -1)  # in which guards that fire at one instant are gone through


@sealed
@dataclass(frozen=True, eq=False)
class Changes:
    """What became of small changes: a row for each direction.

    Parameters
    ----------
    state : array (cases, states)
        Where the runs ended, in the order of `coordinates`, without memories.
    change : array (cases, states)
        Change of that along each direction.
    way, way_change : array (cases,)
        Way made, of several bodies by their centre of mass [m], and its change.
    status : array (cases,)
        Of the runs, as everywhere.
    volume : array (cases,)
        Logarithm of how a volume of starts has grown, where that was asked for.
    """

    state: Array
    change: Array
    way: Array
    way_change: Array
    status: Array
    volume: Array = ()


def changes_along(
    model: Any, states: Array, starts: Array, numbers: dict[str, Array] | None = None, periods: int = 1, rtol: float = 1e-12,
    span: Any = None, order: int = 0, made: Any = tangent,
) -> Changes:  # fmt: skip
    """Follow small changes of the start and of the model's numbers for some drive periods.

    Parameters
    ----------
    model : Robot or machine
        Under laws that rest exactly; one, or a batch with a case for each direction.
    states : array (cases, states)
        Strobe states in the order of `coordinates`.
    starts : array (cases, states)
        Changes of the states.
    numbers : dict of arrays (cases,), optional
        Changes of the model's numbers, by name. The strobe moves with the period: ends are compared at the same part of it.
    periods : int
        Drive periods.
    span : float, optional
        How long a period is, for models that have none [s].
    order : int
        What happens at one instant happens in the order of the guards (1), against it (-1), or as rounding has it (0).
    made : callable
        What is made of the system: `tangent`, or `with_volume`, whose volume comes with it.
    """
    from stickslip.solvers.repeating import check_period
    from stickslip.solvers.stepping import BUDGET
    from stickslip.solvers.tables import CaseTable

    at, cases, given = coordinates(model), len(states), numbers or {}
    check_period(model)
    tableau, tolerance = map_method(model, rtol)
    kernel = lanes.ordered(lanes.kernel_of(model, tableau, record=False, made=made), order)
    states, starts = np.asarray(states, float), np.asarray(starts, float)
    q, u, z = at.order.parted(list(states.T[: at.smooth]), np.zeros(cases))
    dq, du, dz = at.order.parted(list(starts.T[: at.smooth]), np.zeros(cases))
    table = CaseTable(model, kernel, np.column_stack([*q, *u, *z, np.round(states[:, at.smooth :])]), 0.0 if span is None else span, given)
    slopes = _Slopes(model, given, cases)
    d_offsets = slopes.of(lambda m: _offsets(m, kernel.owners))
    places = [d - dq[0] for d in dq[1:]] if table.cyclic else list(dq)
    passive = [*(d - offset for d, offset in zip(du, d_offsets, strict=True)), *dz, *places]
    k, n = table.count, len(passive)
    start = np.column_stack([table.start[:, : 1 + n], *passive, np.zeros((cases, kernel.states - 2 * n)), table.start[:, 1 + n :]])
    found = lanes.run(kernel, table.rows, start, lanes.Job(periods, 0, False, tolerance, 0.75, BUDGET * periods))
    ends, moved, j = found.end[:, 1 : 1 + n], found.end[:, 1 + n :], k + len(dz)
    good = found.status[:, None] <= 1

    def ordered(y: Array, offsets: Any) -> Array:
        zero = (np.zeros(cases),) if table.cyclic else ()
        columns = at.order.joined([*zero, *y[:, j:n].T], [a + b for a, b in zip(y[:, :k].T, offsets, strict=True)], list(y[:, k:j].T))
        return np.where(good, np.column_stack(columns), np.nan)

    shares, d_shares = np.array(slopes.values(_shares)), np.array(slopes.of(_shares))
    first, last, d_first, d_last = (y[:, j:n].T for y in (start[:, 1:], ends, start[:, 1 + n :], moved))
    if table.cyclic:
        shares, d_shares = shares[1:], d_shares[1:]
        way = found.end[:, 0] - table.start[:, 0] - _total(shares * first) + table.carried * periods * _period(model, table.span)
        d_way = moved[:, n]
    else:
        way, d_way = found.end[:, 0] - _total(shares * first), 0.0
    d_way = d_way + _total(shares * (d_last - d_first) + d_shares * (last - first))
    d_way = np.where(good[:, 0], d_way, np.nan)
    return Changes(ordered(ends, table.offsets.T), ordered(moved, d_offsets), way, d_way, found.status, moved[:, -1])


def _period(model: Any, span: Array) -> Any:
    return span if model.period is None else model.period


def _total(terms: Array) -> Any:
    return np.sum(terms, axis=0) if len(terms) else 0.0


def jacobian_of(model: Any, state: Array, periods: int = 1, rtol: float = 1e-12, span: Any = None, order: int = 0) -> Array:
    """The derivative of the strobe state after some periods by that before them.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    >>> orbit = ss.periodic_orbit(robot)
    >>> round(float(jacobian_of(robot, orbit.state)[0, 0]), 6)  # type IV forgets all but this part in one period
    0.089023
    """
    return jacobians_of(model, np.asarray(state, float)[None], periods, rtol, span, order)[0]


def jacobians_of(model: Any, states: Array, periods: int = 1, rtol: float = 1e-12, span: Any = None, order: int = 0) -> Array:
    """The same for each case of a batch, or for several states of one: array (cases, states, states)."""
    cases, d = len(states), coordinates(model).smooth
    each = picked(model, np.repeat(np.arange(cases), d))
    found = changes_along(each, np.repeat(states, d, axis=0), np.tile(np.eye(d), (cases, 1)), None, periods, rtol, span, order)
    return found.change.reshape(cases, d, d).transpose(0, 2, 1)


def not_followed(model: Any) -> str:
    """Why changes are not followed along the runs of a model; "" where they are."""
    machine = machine_of(model)
    if not all(law.compiles for law in machine.laws):
        return "a law is written for plain numbers only"
    if machine.mechanics.jumps and any(law.switching for law in machine.laws):
        return "an impulse makes a law forget"
    return ""


def orders_differ(model: Any, state: Array, periods: int = 1, rtol: float = 1e-12, tolerance: float = 1e-6) -> bool:
    """Whether what switches at one instant leaves other changes behind in the other order: they then depend on the direction's side."""
    one, other = (jacobian_of(model, state, periods, rtol, order=order) for order in _ORDERS)
    sizes = coordinates(model).scales[: len(one)]
    scaled = sizes / sizes[:, None]
    return bool(np.max(abs(one - other) * scaled) > tolerance * np.max(abs(one) * scaled))


class _Slopes:
    """Values of a machine's plain functions, and their changes along directions in its numbers."""

    def __init__(self, model: Any, along: dict[str, Array], cases: int):
        graph, self.cases = Graph(), cases
        names = numbers_of(model)
        self.graph, self.machine = graph, machine_of(replace_leaf(model, {name: graph.case(name) for name in names}))
        own = numbers_by_name(model)
        self.known = {name: own[name] for name in names} | {part_in(name): part for name, part in along.items()}
        self.along = Along(graph, {name: graph.case(part_in(name)) for name in along})

    def values(self, what: Callable[[Any], Any]) -> list[Array]:
        """What a function of the machine gives, for each case."""
        return self._each([self._lift(value) for value in what(self.machine)])

    def of(self, what: Callable[[Any], Any]) -> list[Array]:
        """The changes of that."""
        return self._each([self.along.of(self._lift(value)) for value in what(self.machine)])

    def _lift(self, value: Any) -> Sym:
        return value if isinstance(value, Sym) else self.graph.constant(value)

    def _each(self, nodes: list[Sym]) -> list[Array]:
        found = values_of(self.graph, self.known, nodes)
        return [np.broadcast_to(np.asarray(found[node.number], float), (self.cases,)) for node in nodes]


def number_slopes(model: Any, along: dict[str, Array], what: Callable[[Any], Any], cases: int = 1) -> list[Array]:
    """Changes of what a function of the machine gives, along directions in its numbers."""
    return _Slopes(model, along, cases).of(what)


def start_changes(model: Any, start: dict[str, Any], along: dict[str, Array], cases: int) -> Array:
    """Changes of the state in which a run begins, where the model says it and not who asked for the run: array (cases, states)."""
    at, slopes = coordinates(model), _Slopes(model, along, cases)
    m = machine_of(model).mechanics
    q = slopes.of(lambda machine: machine.mechanics.start)
    z = [slopes.of(lambda machine, i=i: _inner_starts(machine)[i]) for i in range(len(m.contacts))]
    fixed = [np.zeros(cases)]
    placed = _given(start.get("x"), m.bodies)
    q = [0.0 * d if any(m.coordinate_of(body) == j for body in placed) else d for j, d in enumerate(q)]
    inner = [fixed[0] if name in _given(start.get("z"), m.contacts) else d for name, own in zip(m.contacts, z, strict=True) for d in own]
    return np.column_stack(at.order.joined(q, fixed * len(q), inner))


def _given(values: Any, names: tuple[str, ...]) -> tuple[str, ...]:
    """The parts whose numbers a start says."""
    return () if values is None else tuple(values) if isinstance(values, dict) else names


def _inner_starts(machine: Any) -> list[tuple[Any, ...]]:
    mechanics = machine.mechanics
    loads = mechanics.loads(0.0, mechanics.start)
    return [law.start(load) for law, load in zip(mechanics.laws, loads, strict=True)]


def _offsets(machine: Any, owners: tuple[int | None, ...]) -> list[Any]:
    """Velocity of each coordinate less the state that stands for it."""
    offsets = machine.mechanics.offsets(0.0)
    return [0.0 if i is None else -offsets[i] for i in owners]


def _shares(machine: Any) -> list[Any]:
    """Part of all masses that each coordinate has."""
    masses = machine.mechanics.masses
    total = reduce(lambda a, b: a + b, masses)
    return [mass / total for mass in masses]
