"""The return map of a model without a period: where a state on a section is when it comes back to it, and how long that takes.

It is for such a model what the strobe map is for a driven one, with returns in place of drive periods. A start that is not on the section
runs to it first. Where a motion does not come back within the longest time of a return, that run is one return as well: it may stand still.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.status import Status
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, Ends, coordinates, map_method, spread_over
from stickslip.models.machine_adapter import machine_of

_ON = 1e-9  # of a coordinate's scale: a start that is so near to the section is on it
LONGEST_RETURN = 60.0  # times the model's own time: how long a return may take before it is one that does not come back


@sealed
class ReturnSection:
    """A section of the states of a model: a coordinate that falls, or rises, through a value.

    Parameters
    ----------
    name : str
        The coordinate, one of the names of `coordinates`.
    index : int
        Its place among them.
    value : array (cases,) or float
        What it passes.
    direction : float
        +1 where it rises through it, -1 where it falls.
    longest : array (cases,) or float
        The time after which a motion has not come back [s].

    Examples
    --------
    >>> ReturnSection("v", 1, 0.0, -1.0, 60.0)
    ReturnSection(name='v', index=1, value=0.0, direction=-1.0, longest=60.0)
    """

    name: str
    index: int
    value: Any
    direction: float
    longest: Any

    def map_of(self, model: Model, rtol: float, at: Coordinates) -> Callable[[Array, int], Ends]:
        """The return map of a model, for `strobe_map`."""
        return return_map(model, rtol, at)

    def of(self, cases: Any) -> ReturnSection:
        """The section of some cases of a batch."""
        value, longest = (each[cases] if np.ndim(each) else each for each in (self.value, self.longest))
        return replace(self, value=value, longest=longest)


def on_section(model: Model, at: Coordinates | None = None) -> Coordinates:
    """The coordinates of a model, and, where it has no period, the section on which its motions are looked at.

    Of one body on a spring the section is a turning point: the body moves as fast as the spring's far end, and slows down. Of any other
    machine it is the velocity that swings most along a run from rest, in the middle of its range.

    Examples
    --------
    >>> import stickslip as ss
    >>> at = on_section(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)))
    >>> at.section.name, float(at.section.value), at.section.direction
    ('v', 0.0, -1.0)
    """
    at = coordinates(model) if at is None else at
    if model.period is not None:
        return at
    machine = machine_of(model)
    longest = LONGEST_RETURN * np.asarray(machine.time_scale, float)
    if machine.is_single:
        return replace(at, section=ReturnSection("v", at.names.index("v"), np.asarray(machine.far_end_velocity, float), -1.0, longest))
    return replace(at, section=_of_the_widest_swing(model, at, longest))


def _of_the_widest_swing(model: Model, at: Coordinates, longest: Any) -> ReturnSection:
    """The velocity that swings most in the second half of a run from rest, and the middle of its range; of a batch of its first case."""
    from stickslip.basics.batch import cases_of
    from stickslip.solvers import solve

    one = cases_of(model)[0]
    run = solve(one, duration=float(np.max(longest)), keep="trajectory")
    late = run.t >= 0.5 * run.t[-1]
    m = machine_of(one).mechanics
    u = np.array(m.coordinates_of(tuple(np.moveaxis(np.asarray(run.with_axes.v)[late], -1, 0))))
    widest = int(np.argmax(np.ptp(u, axis=1)))
    index = at.order.velocities.start + widest
    return ReturnSection(at.names[index], index, float(0.5 * (u[widest].min() + u[widest].max())), -1.0, longest)


def return_map(model: Model, rtol: float, at: Coordinates) -> Callable[[Array, int], Ends]:
    """The return map of a model as a function of states, one for each case of the model, and of returns."""
    table: Any = None

    def mapped(states: Array, returns: int) -> Ends:
        nonlocal table
        ends, table = _returned(spread_over(model, len(states)), states, returns, rtol, at, table)
        return ends

    return mapped


def _returned(model: Model, states: Array, returns: int, rtol: float, at: Coordinates, table: Any) -> tuple[Ends, Any]:
    """Some returns of each start, and the table of the cases."""
    from stickslip.engine import lanes
    from stickslip.engine.section import RETURNS, VALUE, until_section, weight_of
    from stickslip.solvers.lane_tables import CaseTable
    from stickslip.solvers.stepping import BUDGET

    order, count = at.order, len(states)
    tableau, tolerance = map_method(model, rtol)
    kernel = lanes.kernel_of(model, tableau, False, made=until_section)
    q, u, z = order.parted(list(states.T[: at.smooth]), np.zeros(count))
    start = np.column_stack([*q, *u, *z, np.round(states[:, at.smooth :])])
    section, column = at.section, _column(at, kernel)
    if table is None or table.rows[0, kernel.names.index(RETURNS)] != returns:
        span = returns * np.broadcast_to(section.longest, (count,))
        weights = {weight_of(i): np.full(count, section.direction if i == column else 0.0) for i in range(kernel.states)}
        table = CaseTable(model, kernel, start, span, more=weights | {RETURNS: np.full(count, float(returns))})
        offset = table.offsets[:, column] if column < table.count else 0.0
        table.rows[:, kernel.names.index(VALUE)] = section.direction * (np.broadcast_to(section.value, (count,)) - offset)
    else:
        table = table.restarted(start)
    value = section.direction * table.rows[:, kernel.names.index(VALUE)]
    near = abs(table.start[:, 1 + column] - value) <= _ON * at.scales[at.section.index]
    table.start[near, 1 + column] = value[near]
    results = lanes.run(kernel, table.rows, table.start, lanes.Job(1, 0, False, tolerance, 0.75, BUDGET * returns))
    positions, v, inner = table.ends(results)
    zero = (np.zeros(count),) if order.cyclic else ()
    y = np.column_stack([*order.joined([*zero, *positions.T], list(v.T), list(inner.T))])
    returned = results.status == Status.RETURNED
    good = returned | (results.status <= Status.REPEATS)
    ended = results.ended if results.ended is not None else np.full(count, np.nan)
    duration = np.where(returned, ended, table.span)
    state = np.hstack([np.where(good[:, None], y, np.nan), results.memory[:, : states.shape[1] - at.smooth]])
    way = _way(model, results, table, at, positions.shape[1]) + table.carried * duration
    offset = table.offsets[:, 0]
    if machine_of(model).is_single:
        state[:, 0] -= np.where(good, machine_of(model).far_end_velocity * duration, 0.0)
    status = np.where(returned, int(Status.FINISHED), results.status)
    return Ends(state, way, status, results.wide_max + offset, results.wide_min + offset, duration=duration), table


def _column(at: Coordinates, kernel: Any) -> int:
    """The place of the section's coordinate among the states of a kernel."""
    order, index = at.order, at.section.index
    n = order.velocities.stop - order.velocities.start
    if order.velocities.start <= index < order.velocities.stop:
        return index - order.velocities.start
    if order.inner.start <= index < order.inner.stop:
        return n + index - order.inner.start
    return kernel.states - (order.places.stop - order.places.start) + index - order.places.start


def _way(model: Model, results: Any, table: Any, at: Coordinates, places: int) -> Array:
    """How far the machine went in a return [m]: its one coordinate, or the centre of mass."""
    if table.count == 1:
        return np.asarray(results.end[:, 0] - table.start[:, 0])
    last = table.start.shape[1] - at.memories
    shares = np.array([np.broadcast_to(share, (len(table.start),)) for share in machine_of(model).mechanics.shares][table.cyclic :], float)
    begun = (shares.T * table.start[:, last - places : last]).sum(axis=1) + (table.start[:, 0] if table.cyclic else 0.0)
    return np.asarray(results.end[:, 0] - begun)
