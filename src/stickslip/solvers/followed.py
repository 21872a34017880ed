"""Machines whose numbers change at given instants, as a recorded command changes them: many cases, each followed by compiled code."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError
from stickslip.basics.pool import handed_out
from stickslip.engine import driver, lanes
from stickslip.engine.held_lane import ROOM, Side
from stickslip.engine.shared_arrays import address_of
from stickslip.solvers.lane_tables import CaseTable
from stickslip.solvers.methods import method_for
from stickslip.solvers.request import request
from stickslip.solvers.settings import Settings
from stickslip.solvers.stepping import budget_of


def followed(
    machines: Model, instants: Array, changes: Mapping[str, Array], *, start: Any = None, rtol: float = 1e-8, body: str | None = None
) -> tuple[Any, Any]:
    """Position and velocity of a body at given instants, while numbers of the machine change there.

    Events lie where they are, as in `stickslip.solve`. The cases go side by side on all processors.

    Parameters
    ----------
    machines : machine
        One, or a batch of one dimension. It has no period of its own.
    instants : array (n,)
        Ascending, from where the motion begins [s].
    changes : dict of array (n - 1,) or (cases, n - 1)
        Numbers of the machine by their names, from each of these instants to the next.
    start : dict, optional
        As for `stickslip.solve`.
    rtol : float
        Relative tolerance of dynamic laws.
    body : str, optional
        Name of the body; by default the principal one.

    Returns
    -------
    tuple of array (cases, n)
        [m] and [m/s], or [rad] and [rad/s]; NaN from where a case could not be followed any further.

    Raises
    ------
    InputError
        For a machine that has a period, or numbers that it has not.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.Coulomb(0.02, 0.02)
    >>> joint = ss.Joint(inertia=0.01, friction=law, control=ss.machines.PID(kp=2.0, ki=0.0, kd=0.1, target=0.0))
    >>> angle, rate = followed(joint, np.array([0.0, 1.0, 5.0]), {"control.target": np.array([0.0, 0.5])})
    >>> bool(angle[0, 1] == 0.0), bool(0.49 <= angle[0, 2] < 0.5), float(rate[0, 2])
    (True, True, 0.0)
    """
    if machines.period is not None:
        raise InputError("followed", [f"the {type(machines).__name__} has a period; allowed are numbers instead of its periodic inputs"])
    instants = np.asarray(instants, float) - instants[0]
    whole = 2.0 * max(float(instants[-1]), 1e-300)
    todo = request(machines, Settings(duration=whole, rtol=rtol, start=start, samples=4, keep="summary"))
    chosen: Any = method_for(todo.method, machines, pauses=True)
    tableau, own_rtol = chosen.steps(todo)
    kernel = lanes.kernel_of(machines, tableau, record=True)
    table = CaseTable(machines, kernel, todo.start, todo.span, machine=todo.machine, own=todo.numbers_of())
    columns = _columns(kernel, changes)
    of = np.stack([np.broadcast_to(values, (len(table.rows), len(instants) - 1)) for values in changes.values()], axis=-1)
    budget = float(budget_of(machines, 1, todo.machine))

    def work(case: int) -> Any:
        side = Side(kernel, table.rows[case], table.start[case], own_rtol, np.empty((ROOM, lanes.bytes_of_piece(kernel) // 8)))
        side.aim(0, 0.0, budget)
        legs, ends = np.column_stack([instants[1:], of[case]]), np.full((len(instants) - 1, 1 + kernel.states), np.nan)
        driver.load("follow")(side.S, address_of(side.shared.at), kernel.table, legs, columns, ends)
        return ends

    driver.load("follow")  # before there are threads
    ends = np.empty((len(table.rows), len(instants) - 1, 1 + kernel.states))
    for case, each in handed_out(work, range(len(ends)), min(len(ends), os.cpu_count() or 1)):
        ends[case] = each
    return _of_body(machines, kernel, table, ends, body)


def _columns(kernel: lanes.Kernel, changes: Mapping[str, Any]) -> Any:
    """Where the numbers that change stand in a row."""
    for name in changes:
        if name not in kernel.names:
            raise InputError("followed", [f"there is no number {name!r}; allowed are {', '.join(kernel.names)}"])
    return np.array([kernel.names.index(name) for name in changes], dtype=np.int64)


def _of_body(machines: Model, kernel: lanes.Kernel, table: CaseTable, ends: Any, body: str | None) -> tuple[Any, Any]:
    """Position and velocity of a body from the states at the ends of all legs, and where they begin."""
    named = body or kernel.layout.principal
    own = next((each for each in kernel.layout.bodies if each.name == named), None)
    if own is None:
        allowed = ", ".join(repr(each.name) for each in kernel.layout.bodies)
        raise InputError("followed", [f"body = {body!r}; allowed for this {type(machines).__name__} is one of {allowed}"])
    states = np.concatenate([table.start[:, None, : 1 + kernel.states], ends], axis=1)
    column = 0 if own.position is None else 1 + own.position
    return states[..., column], states[..., 1 + own.velocity] + table.offsets[:, own.velocity][:, None]
