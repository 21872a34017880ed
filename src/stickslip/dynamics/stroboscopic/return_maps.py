"""The return map of a model without a period: where a state on a section is when it comes back to it, and how long that takes.

It is for such a model what the strobe map is for a driven one, with returns in place of drive periods. A start that is not on the section
runs to it first. Where a motion does not come back within the longest time of a return, that run is one return as well: it may stand still.
Which section it is says `stickslip.dynamics.stroboscopic.chosen_sections`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.status import Status
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, Ends, ends_of_flow, map_method, spread_over
from stickslip.models.flow_contacts import modes_passed
from stickslip.models.friction.law_adapter import SWITCHES
from stickslip.models.machine_adapter import machine_of

_ON = 1e-9  # of a coordinate's scale: a start that is so near to the section is on it


@sealed
class ReturnSection:
    """A section of the states of a model: a coordinate that falls, or rises, through a value; or a switch of a contact or a flow.

    Parameters
    ----------
    name : str
        The coordinate, one of the names of `coordinates`; or the switch, such as "stick of block", or "free to hunted" of a flow.
    index : int
        Its place among them; -1 for a switch, which has no value and no direction.
    value : array (cases,) or float
        What it passes.
    direction : float
        +1 where it rises through it, -1 where it falls.
    longest : array (cases,) or float
        The time after which a motion has not come back [s].
    turns : int
        How many returns the map makes at once.
    begun : array or None
        The start whose run showed the section, if one did.

    Examples
    --------
    >>> ReturnSection("v", 1, 0.0, -1.0, 60.0)
    ReturnSection(name='v', index=1, value=0.0, direction=-1.0, longest=60.0, turns=1, begun=None)
    """

    name: str
    index: int
    value: Any
    direction: float
    longest: Any
    turns: int = 1
    begun: Any = None

    @property
    def is_switch(self) -> bool:
        """Whether it is a switch."""
        return self.index < 0

    def starts(self, rest: Array) -> Array:
        """Where motions begin if no start is given: at rest, or where the run began that showed the section."""
        return rest if self.begun is None else np.tile(self.begun, (len(rest), 1))

    def map_of(self, model: Model, rtol: float, at: Coordinates) -> Callable[[Array, int], Ends]:
        """The return map of a model, for `strobe_map`: a function of states, one for each case of the model, and of returns."""
        if not at.in_lanes:
            return lambda states, returns: _returned_by_flow(model, states, returns * self.turns, at)
        table: Any = None

        def mapped(states: Array, returns: int) -> Ends:
            nonlocal table
            ends, table = _returned(spread_over(model, len(states)), states, returns * self.turns, rtol, at, table)
            return ends

        return mapped

    def of(self, cases: Any) -> ReturnSection:
        """The section of some cases of a batch."""
        value, longest = (each[cases] if np.ndim(each) else each for each in (self.value, self.longest))
        return replace(self, value=value, longest=longest)

    @property
    def asked(self) -> str | tuple[str, float, float]:
        """The section as `section=` takes it; of a batch its first case."""
        if self.is_switch:
            return self.name
        return self.name, float(np.ravel(self.value)[0]), self.direction

    def __str__(self) -> str:
        if self.is_switch:
            return self.name
        values = np.unique(self.value)
        where = f"{values[0]:.6g}" if len(values) == 1 else f"values from {values[0]:.6g} to {values[-1]:.6g}"
        return f"{self.name} {'rises' if self.direction > 0 else 'falls'} through {where}"


def _returned(model: Model, states: Array, returns: int, rtol: float, at: Coordinates, table: Any) -> tuple[Ends, Any]:
    """Some returns of each start, and the table of the cases."""
    from stickslip.engine import lanes
    from stickslip.engine.section import RETURNS, VALUE, until_section, until_switch
    from stickslip.solvers.lane_tables import CaseTable
    from stickslip.solvers.stepping import BUDGET

    order, count = at.order, len(states)
    tableau, tolerance = map_method(model, rtol)
    section = at.section
    kernel = lanes.kernel_of(model, tableau, False, made=until_switch if section.is_switch else until_section)
    q, u, z = order.split(list(states.T[: at.smooth]), np.zeros(count))
    start = np.column_stack([*q, *u, *z, np.round(states[:, at.smooth :])])
    column = None if section.is_switch else _column(at, kernel)
    if table is None or table.rows[0, kernel.names.index(RETURNS)] != returns:
        span = returns * np.broadcast_to(section.longest, (count,))
        numbers = {name: np.full(count, value) for name, value in _numbers_of(section, column, model, kernel).items()}
        table = CaseTable(model, kernel, start, span, more=numbers | {RETURNS: np.full(count, float(returns))})
        if column is not None:
            offset = table.offsets[:, column] if column < table.count else 0.0
            table.rows[:, kernel.names.index(VALUE)] = section.direction * (np.broadcast_to(section.value, (count,)) - offset)
    else:
        table = table.restarted(start)
    if column is not None:
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
    state[:, 0] -= np.where(good, machine_of(model).far_end_velocity * duration, 0.0)
    status = np.where(returned, int(Status.FINISHED), results.status)
    return Ends(state, way, status, results.wide_max + offset, results.wide_min + offset, duration=duration), table


def _numbers_of(section: ReturnSection, column: int | None, model: Model, kernel: Any) -> dict[str, float]:
    """The numbers of a case that say which section it is: weights of the states, or which contact's switches count."""
    from stickslip.engine.section import switch_of, weight_of

    if column is not None:
        return {weight_of(i): section.direction if i == column else 0.0 for i in range(kernel.states)}
    kind, _, name = section.name.partition(" of ")
    names = {switch_of(i, each): (each, contact) for i, contact in enumerate(machine_of(model).mechanics.contacts) for each in SWITCHES}
    return {number: float(which == (kind, name)) for number, which in names.items() if number in kernel.names}


def _returned_by_flow(flow: Any, states: Array, returns: int, at: Coordinates) -> Ends:
    """The same of a flow that switches."""
    from stickslip.solvers.flow_engine import passing_a_value, returned, switching

    section, n = at.section, len(states)
    y, span = np.array(states[:, :-1], float), returns * np.broadcast_to(np.asarray(section.longest, float), (n,))
    if section.is_switch:
        where = switching(modes_passed(flow, section.name))
    else:
        value = np.broadcast_to(np.asarray(section.value, float), (n,))
        near = abs(y[:, section.index] - value) <= _ON * at.scales[section.index]
        y[near, section.index] = value[near]
        where = passing_a_value(section.index, section.direction, value, y.shape[1])
    ends = returned(flow, y, np.round(states[:, -1]), where, returns, span)
    return ends_of_flow(flow, states, ends.states, ends.modes, ends.status, ends.duration)


def _column(at: Coordinates, kernel: Any) -> int:
    """The place of the section's coordinate among the states of a kernel."""
    order, index = at.order, at.section.index
    n = order.velocities.stop - order.velocities.start
    if order.velocities.start <= index < order.velocities.stop:
        return index - order.velocities.start
    if order.inner.start <= index < order.inner.stop:
        return n + order.own[index - order.inner.start]
    return kernel.states - (order.places.stop - order.places.start) + index - order.places.start


def _way(model: Model, results: Any, table: Any, at: Coordinates, places: int) -> Array:
    """How far the machine went in a return [m]: its one coordinate, or the centre of mass."""
    if table.count == 1:
        return np.asarray(results.end[:, 0] - table.start[:, 0])
    last = table.start.shape[1] - at.memories
    shares = np.array([np.broadcast_to(share, (len(table.start),)) for share in machine_of(model).mechanics.shares][table.cyclic :], float)
    begun = (shares.T * table.start[:, last - places : last]).sum(axis=1) + (table.start[:, 0] if table.cyclic else 0.0)
    return np.asarray(results.end[:, 0] - begun)
