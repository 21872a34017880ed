"""Small changes along a run: how far a change of the start, or of a number of the model, has moved the end and the way.

They are passive states of the system itself (`stickslip.engine.tangent`), a lane of the kernel for each direction.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.batch import some_of
from stickslip.basics.contracts import Array, Model
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.status import Status
from stickslip.dynamics.derivatives.slopes import Slopes, period_of
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, map_method
from stickslip.engine import lanes
from stickslip.engine.kinds import check_functions, kind_of
from stickslip.engine.remembered import Remembered
from stickslip.engine.tangent import has_corners, means_of, part_in, tangent
from stickslip.engine.trace import trace
from stickslip.models.model_adapter import adapter_of

_corners: Remembered[bool] = Remembered()
_means: Remembered[tuple[str, ...]] = Remembered()
_ORDERS = (1, -1)  # in which guards that fire at one instant are gone through


@sealed
class Changes:
    """Small changes after a time: one row for each direction.

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
    integrals, integral_changes : array (cases, integrals)
        Integrals over time that were asked for, and their changes.
    """

    state: Array
    change: Array
    way: Array
    way_change: Array
    status: Array
    volume: Any = ()
    integrals: Any = ()
    integral_changes: Any = ()


@sealed
class Directions:
    """Along what small changes are followed besides the start, and how.

    Parameters
    ----------
    numbers : dict of arrays (cases,), optional
        Changes of the model's numbers, by name. The strobe moves with the period: ends are compared at the same part of it.
    rtol : float
        Tolerance of the runs.
    span : float or array, optional
        How long a period is, for models that have none [s].
    order : int
        What happens at one instant happens in the order of the guards (1), against it (-1), or as rounding has it (0).
    made : callable
        What is made of the system: `tangent`, or `tangent_and_volume`, whose volume comes with it.
    observe : tuple of (name, Observable)
        A user's own signals.
    integrals : int
        How many integrals over time `made` adds.
    more : dict of arrays (cases,), optional
        Numbers of the kernel that are none of the model.
    """

    numbers: dict[str, Array] | None = None
    rtol: float = 1e-12
    span: Any = None
    order: int = 0
    made: Any = tangent
    observe: Any = ()
    integrals: int = 0
    more: dict[str, Array] | None = None


OF_START = Directions()  # changes of the start alone


def changes_along(model: Model, states: Array, starts: Array, periods: int = 1, how: Directions = OF_START) -> Changes:
    """Follow small changes of the start and of the model's numbers for some drive periods.

    Parameters
    ----------
    model : Robot or machine
        Under laws that rest exactly; one, or a batch with a case for each direction.
    states : array (cases, states)
        Strobe states in the order of `coordinates`.
    starts : array (cases, states)
        Changes of the states.
    periods : int
        Drive periods.
    how : Directions
        Changes of the model's numbers, and how they are followed.
    """
    from stickslip.solvers.time_dependence import check_period

    check_functions(model)
    check_period(model)
    return Follower(model, len(states), how).after(states, starts, periods)


class Follower:
    """Small changes along the runs of one model: what does not depend on where they start is made once.

    Parameters
    ----------
    model : Robot or machine
        As for `changes_along`.
    cases : int
        How many directions there are.
    how : Directions
        As for `changes_along`.
    at : Coordinates, optional
        Of the model, where they are known.
    """

    def __init__(self, model: Model, cases: int, how: Directions = OF_START, at: Coordinates | None = None):
        self.model, self.at, self.given = model, coordinates(model) if at is None else at, how.numbers or {}
        tableau, self.tolerance = map_method(model, how.rtol)
        self.is_exact = tableau is None
        self.kernel = lanes.ordered(lanes.kernel_of(model, tableau, False, how.observe, how.made, noted=how.integrals > 0), how.order)
        self.integrals, self.more = how.integrals, how.more
        self.span, self.slopes = 0.0 if how.span is None else how.span, Slopes(model, self.given, cases)

    @cached_property
    def period(self) -> tuple[Array, Array]:
        """The drive period, or the span, and its change along each direction [s]."""
        if self.model.period is None:
            return np.broadcast_to(self.span, (self.slopes.cases,)), np.zeros(self.slopes.cases)
        return self.slopes.values(period_of)[0], self.slopes.of(period_of)[0]

    @cached_property
    def table(self) -> Any:
        """The rows of the lanes; starts are placed later."""
        from stickslip.solvers.lane_tables import CaseTable

        width = 2 * len(self.kernel.owners) + self.at.order.all_inner + self.at.memories
        more = {**(self.more or {}), **{part_in(name): part for name, part in self.given.items()}}
        return CaseTable(self.model, self.kernel, np.zeros((self.slopes.cases, width)), self.span, more=more)

    @cached_property
    def carried(self) -> _Carried:
        """The lanes' columns."""
        return _Carried(self.table, self.kernel, self.at, self.slopes)

    def after(self, states: Array, starts: Array, periods: int = 1, which: Any = slice(None), loose: float = 1.0) -> Changes:
        """Changes `starts` of some states (cases, states) after a number of drive periods; for all directions, or some.

        Under dynamic laws the tolerance may be so many times as loose.
        """
        start, results = self.lanes(states, starts, periods, which, loose)
        state, change, way, way_change = self.carried.ends(start, results.end, periods * self.period[0][which], which)
        known = np.where(results.status <= Status.REPEATS, 1.0, np.nan)[:, None]
        sums, d_sums = self.carried.integrals(results.end, self.integrals)
        return Changes(
            state * known, change * known, way, way_change * known[:, 0], results.status, results.end[:, -1], sums, d_sums * known
        )

    def lanes(self, states: Array, starts: Array, periods: int, which: Any = slice(None), loose: float = 1.0) -> tuple[Array, Any]:
        """The start of the lanes, and what they found."""
        from stickslip.solvers.stepping import BUDGET

        q, u, z, memory = _parted(self.at, np.asarray(states, float))
        first = self.table.placed(np.column_stack([*q, *u, *z, *memory.round()]), which)
        start = self.carried.start(first, np.asarray(starts, float), which)
        job = lanes.Job(periods, 0, False, self.tolerance * loose, 0.75, BUDGET * periods)
        return start, lanes.run(self.kernel, self.table.rows[which], start, job)


def _parted(at: Coordinates, states: Array) -> tuple[list[Array], list[Array], list[Array], Array]:
    """Columns of positions, velocities, inner states and memories."""
    q, u, z = at.order.split(list(states.T[: at.smooth]), np.zeros(len(states)))
    return list(q), list(u), list(z), states[:, at.smooth :].T


class _Carried:
    """The lanes' columns of a state (way, velocities less offsets, inner states, positions), and the same of its change."""

    def __init__(self, table: Any, kernel: lanes.Kernel, at: Coordinates, slopes: Slopes):
        self.table, self.at = table, at
        self.offsets = np.array(slopes.of(_offsets, kernel.owners))
        self.inner = at.order.all_inner
        self.n = 2 * table.count + self.inner - int(table.cyclic)  # states of the motion itself
        self.more = kernel.states - 2 * self.n
        self.shares, self.d_shares = (np.array(each)[int(table.cyclic) :] for each in (slopes.values(_shares), slopes.of(_shares)))

    def start(self, first: Array, changes: Array, which: Any) -> Array:
        """The start of the lanes, of changes beside states that have been placed."""
        q, u, z, _ = _parted(self.at, changes)
        positions = [position - q[0] for position in q[1:]] if self.table.cyclic else q
        own = [v - offset for v, offset in zip(u, self.offsets[:, which], strict=True)]
        return np.column_stack([first[:, : 1 + self.n], *own, *z, *positions, np.zeros((len(first), self.more)), first[:, 1 + self.n :]])

    def ends(self, start: Array, end: Array, time: Any, which: Any) -> tuple[Array, Array, Array, Array]:
        """State, change of it, way of the centre of mass, change of that."""
        n, table, shares, d_shares = self.n, self.table, self.shares[:, which], self.d_shares[:, which]
        (first, d_first), (last, d_last) = ((y[:, 1 : 1 + n].T, y[:, 1 + n :].T) for y in (start, end))
        places = slice(table.count + self.inner, n)
        d_way = np.sum(shares * (d_last[places] - d_first[places]) + d_shares * (last[places] - first[places]), axis=0)
        way = end[:, 0] - np.sum(shares * first[places], axis=0)
        if table.cyclic:
            way, d_way = way - start[:, 0] + table.carried[which] * time, d_way + d_last[n]
        return self._state(last, table.offsets[which].T), self._state(d_last, self.offsets[:, which]), way, d_way

    def integrals(self, end: Array, count: int) -> tuple[Array, Array]:
        """The integrals, which come last, and their changes, which come last among the changes."""
        first = 1 + 2 * self.n + int(self.table.cyclic)
        return end[:, first + count + 1 :][:, :count], end[:, first : first + count]

    def _state(self, y: Array, offsets: Any) -> Array:
        """In the order of the coordinates."""
        k, j = self.table.count, self.table.count + self.inner
        zero = [np.zeros(len(y[0]))] if self.table.cyclic else []
        velocities = [a + b for a, b in zip(y[:k], offsets, strict=True)]
        return np.column_stack(self.at.order.joined([*zero, *y[j : self.n]], velocities, list(y[k:j])))


def jacobian_of(model: Model, state: Array, periods: int = 1, rtol: float = 1e-12, span: Any = None, order: int = 0) -> Array:
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


def jacobians_of(model: Model, states: Array, periods: int = 1, rtol: float = 1e-12, span: Any = None, order: int = 0) -> Array:
    """The same for each case of a batch, or for several states of one: array (cases, states, states)."""
    cases, d = len(states), coordinates(model).smooth
    each = some_of(model, np.repeat(np.arange(cases), d))
    changes = changes_along(
        each, np.repeat(states, d, axis=0), np.tile(np.eye(d), (cases, 1)), periods, Directions(rtol=rtol, span=span, order=order)
    )
    return changes.change.reshape(cases, d, d).transpose(0, 2, 1)


def means_named(model: Model, observe: Any = ()) -> tuple[str, ...]:
    """Names of what `tangent_of_means` averages over a machine's motion, in order."""
    return _means((kind_of(model), observe), lambda: tuple(means_of(trace(model, observe, noted=True))))


def has_corners_of(model: Model) -> bool:
    """Whether something jumps where a machine switches, by its traced equations: then derivatives may be other ones on its two sides."""
    return _corners(kind_of(model), lambda: has_corners(trace(model)))


def not_followed(model: Model) -> str:
    """Why changes are not followed along the runs of a model; "" where they are."""
    return adapter_of(model).not_followed


def orders_differ(model: Model, state: Array, periods: int = 1, rtol: float = 1e-12, tolerance: float = 1e-6, span: Any = None) -> bool:
    """Whether what switches at one instant leaves other changes behind in the other order: they then depend on the direction's side."""
    one, other = (jacobian_of(model, state, periods, rtol, span, order) for order in _ORDERS)
    sizes = coordinates(model).scales[: len(one)]
    scaled = sizes / sizes[:, None]
    return bool(np.max(abs(one - other) * scaled) > tolerance * np.max(abs(one) * scaled))


def _offsets(machine: Any, owners: tuple[int | None, ...]) -> list[Any]:
    """Velocity of each coordinate less the state that stands for it."""
    offsets = machine.mechanics.offsets(0.0)
    return [0.0 if i is None else -offsets[i] for i in owners]


def _shares(machine: Any) -> list[Any]:
    """Part of each coordinate in the way that the machine makes."""
    return list(machine.mechanics.shares)
