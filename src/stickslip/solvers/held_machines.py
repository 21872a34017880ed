"""A machine as a case that a held lane follows: its row of numbers, its start, and what its states mean."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.engine import lanes
from stickslip.engine.held_lane import HeldLane, Side
from stickslip.models.machine_adapter import machine_of
from stickslip.models.pushed import pushed
from stickslip.models.state_layout import StateLayout
from stickslip.results.dense_output import PolynomialPieces
from stickslip.results.events import Event, aloft_of, events_of, flights_of, hits_of
from stickslip.results.trajectory import Trajectory
from stickslip.solvers.held_bodies import FORCE, BodiesCase, forces_of, request_of_one
from stickslip.solvers.held_cases import Standing, times_of
from stickslip.solvers.lane_tables import CaseTable
from stickslip.solvers.methods import method_for
from stickslip.solvers.stepping import budget_of

_NOBODY = np.zeros(0, bool)
_LOST = 1e-6  # of the load at the start: what is left of one where a contact is lost


class MachineCase(BodiesCase):
    """A machine of bodies and contacts; with a force on each body once one is given.

    Parameters
    ----------
    machine : Robot or machine
        A single case.
    start, rtol, method
        As for `solve`.
    """

    def __init__(self, machine: Model, start: Any, rtol: float, method: str):
        self._forces, self.is_pushed = forces_of(machine), False
        self._todo = request_of_one(machine, start, rtol, method)
        self._start = self._todo.start
        self.asked = {"start": start, "rtol": rtol, "method": method, "mode": None}
        self._take(machine)
        self._compile()

    def _take(self, model: Any) -> None:
        """Read what the numbers say."""
        self.model, self._machine = model, machine_of(model)
        self._table: CaseTable | None = None
        self.period = None if model.period is None else float(model.period)

    def _compile(self) -> None:
        """The kernel, and the tolerance to which its steps are held."""
        todo = replace(self._todo, model=self.model)
        chosen: Any = method_for(todo.method, self.model, pauses=True)
        tableau, self.rtol = chosen.steps(todo)
        self.tolerance = None if tableau is None else todo.rtol
        self.kernel = lanes.kernel_of(self.model, tableau, record=True)
        self._flies = max(self.kernel.flights, default=-1) >= 0
        self.method = "exact" if tableau is None else tableau.name

    def ready_for(self, numbers: Mapping[str, float]) -> MachineCase:
        """The case in which these numbers can change: itself, or the machine with a force on each body, which is compiled once."""
        if self.is_pushed or not any(name.startswith(FORCE) for name in numbers):
            return self
        other = self._copied(pushed(self.model))
        other.is_pushed = True
        other._compile()
        return other

    @property
    def layout(self) -> StateLayout:
        """What its states are."""
        return self.kernel.layout

    @property
    def kernel_name(self) -> str:
        """The name of its kernel's file."""
        return self.kernel.code.name

    def _copied(self, model: Any) -> MachineCase:
        other = object.__new__(MachineCase)
        other.__dict__.update(self.__dict__)
        other._take(model)
        return other

    @property
    def machine(self) -> Any:
        """The machine without the forces."""
        return self.model.machine if self.is_pushed else self.model

    def is_as(self, other: Any) -> bool:
        """Whether another case of this simulation has the same numbers and forces."""
        return bool(self.model == other.model)

    def column(self, number: str) -> int | None:
        """Where a force stands in a row; None before one is given."""
        return self.kernel.names.index(number.removeprefix(FORCE)) if self.is_pushed else None

    def _of(self, span: float) -> CaseTable:
        return CaseTable(self.model, self.kernel, self._start, span, machine=self._machine)

    @property
    def table(self) -> CaseTable:
        """Its numbers and its start as a lane takes them."""
        if self._table is None:
            self._table = self._of(1.0 if self.period is None else self.period)
        return self._table

    def lane(self, span: float, side: Side | None = None) -> HeldLane:
        """A lane at the start, or where another lane of the same machine stands."""
        table = self._of(span)
        start = table.start[0] if side is None else np.concatenate([[side.way], side.states, side.memory])
        return HeldLane(self.kernel, table.rows[0], start, self.rtol)

    def row(self, span: float) -> Array:
        """The numbers in the kernel's order."""
        return self._of(span).rows[0]

    def changed(self, numbers: Mapping[str, float]) -> MachineCase:
        """The same case with other numbers."""
        own = "machine." if self.is_pushed else ""
        forces = {name.removeprefix(FORCE): value for name, value in numbers.items() if self.is_pushed and self.is_quick(name)}
        changes = {own + name: value for name, value in numbers.items() if not self.is_quick(name)} | forces
        return self._copied(self.model.replace(changes)) if changes else self

    def rebase(self, side: Side, before: MachineCase, t: float) -> None:
        """Velocities are counted from what contacts rub on, where that does not vary."""
        old, new, count = before.table, self.table, self.table.count
        if np.any(old.offsets != new.offsets):
            side.states[:count] += old.offsets[0] - new.offsets[0]
        if np.any(old.carried != new.carried):
            side.count_way_from(side.way + float(old.carried[0] - new.carried[0]) * t)

    def judge_anew(self, side: Side) -> None:
        """The kernel does, by the conditions of an impulse."""

    def standing(self, side: Side, t: float) -> Standing:
        """Where a lane stands."""
        states = side.states.copy()
        states[: self.table.count] += self.table.offsets[0]
        return Standing(t, states, side.sides, side.memory.copy(), side.aloft if self._flies else _NOBODY)

    def _parts(self, side: Side, t: float) -> tuple[Array, Array, Any]:
        """Positions, velocities and other states, with the velocities in full."""
        table, y = self.table, side.states
        n, placed = table.count, len(y) - table.count + int(table.cyclic)
        u = y[:n] + table.offsets[0]
        q = y[placed:]
        if table.cyclic:
            q = (side.way + float(table.carried[0]) * t) + np.concatenate([[0.0], q])
        return q, u, y[n:placed]

    # ---- what happened ----
    def pieces(self, rows: Array, before: Standing | None = None, after: Standing | None = None) -> PolynomialPieces:
        """Steps of dense output, and constant ones where it stood before and stands after them, as long as all of them."""
        k, table = self.kernel, self.table
        t, first = times_of(rows, self.period), 4 + k.contacts + k.modes
        good = t[1:] > t[:-1]
        t, rows = np.concatenate([t[:1], t[1:][good]]), rows[good]
        coefficients = rows[:, first:].reshape(len(rows), k.states, k.degree + 1).copy()
        coefficients[:, : len(k.owners), 0] += table.offsets[0]
        x = rows[:, 3] + table.carried[0] * t[:-1]
        sides, memory = rows[:, 4 : 4 + k.contacts], rows[:, 4 + k.contacts : first]
        length = max(t[-1] - t[0], 1e-9 * abs(t[-1]), 1e-300)
        for standing, where in ((before, 0), (after, len(rows) + 1)):
            if standing is None:
                continue
            still = np.zeros((1, k.states, k.degree + 1))
            still[0, :, 0] = standing.states
            front = where == 0
            t = np.concatenate([[t[0] - length], t] if front else [t, [t[-1] + length]])
            coefficients, sides, memory, x = (
                np.concatenate([new, of] if front else [of, new])
                for new, of in (
                    (still, coefficients), (standing.sides[None], sides), (standing.memory[None], memory), (np.zeros(1), x),
                )
            )  # fmt: skip
        ways = x[:, None] if k.layout.ways else np.empty((len(x), 0))
        return PolynomialPieces(t, sides.astype(np.int8), ways, coefficients, memory.astype(np.int32), k.layout)

    def events(self, before: Standing, rows: Array, after: Standing) -> list[Event]:
        """As `Trajectory.events` has them."""
        pieces, machine = self.pieces(rows, before, after), self._machine
        hits: list[Any] = []
        aloft = aloft_of(pieces, machine.laws)
        if self._flies:
            aloft[0], aloft[-1] = before.aloft, after.aloft
        if machine.mechanics.stops:
            hits = hits_of(pieces, machine.mechanics, float(machine.velocity_scale), float(machine.time_scale or 1.0))
        hits += flights_of(pieces, aloft)
        impulses = self._impulses(before.t, after.t)
        return sorted([*(hit for _, hit in hits), *events_of(pieces, impulses, (), aloft)], key=lambda event: event.t)

    def _impulses(self, begin: float, end: float) -> list[tuple[float, Any]]:
        """Impulses after one instant and until another."""
        jumps = self._machine.jumps
        if not jumps or self.period is None:
            return []
        T, slack = self.period, 1e-9 * self.period
        whole = range(math.floor(begin / T) - 1, math.floor(end / T) + 2)
        every = ((k * T + float(instant), jump) for k in whole for instant, jump in jumps)
        return [(t, jump) for t, jump in every if begin + slack < t <= end + slack]

    def whole(self, before: Standing, rows: Array, side: Side) -> Array:
        """These steps: none of them is open."""
        return rows

    def run(self, rows: Array, more: dict[str, Any]) -> Trajectory:
        """Some steps as a trajectory."""
        periods = 1 if self.period is None else max(int(rows[-1, 0] - rows[0, 0]) + 1, 1)
        return Trajectory(self.model, self.pieces(rows), periods, 0, self.tolerance or 0.0, self.method, **more)

    def lost(self, side: Side, t: float) -> list[Event]:
        """The contacts that nothing presses any more."""
        q, u, _ = self._parts(side, t)
        m = self._machine.mechanics
        held = [side.states[k] for part in self.layout.controllers for k in part.inner]
        loads, first = m.loads(t, tuple(q), tuple(u), held), m.loads(0.0, m.start)
        sides = zip(m.contacts, loads, first, side.sides, strict=True)
        return [Event(t, "contact lost", int(mode), int(mode), name) for name, load, of, mode in sides if load <= _LOST * abs(of)]

    def budget(self, duration: float) -> float:
        """As many as `solve` allows."""
        periods = 1 if self.period is None else math.ceil(duration / self.period) + 1
        return float(budget_of(self.model, periods, self._machine))
