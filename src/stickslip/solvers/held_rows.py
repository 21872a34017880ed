"""A row of many bodies as a case that a held row follows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.engine.held_rows import BODY, CHANGE, END, PIECE, REST, STANCE, TIME, WHAT, RowLane, RowSide, rows_of
from stickslip.engine.local_events import row_of
from stickslip.models.machine_adapter import machine_of
from stickslip.models.pushed import Pushed
from stickslip.models.state_layout import StateLayout
from stickslip.results.events import Event, kind_of
from stickslip.results.trajectory import Trajectory
from stickslip.solvers import local_steps
from stickslip.solvers.held_bodies import FORCE, BodiesCase, forces_of, request_of_one
from stickslip.solvers.held_cases import Standing

_NOBODY = np.zeros(0, bool)


class RowCase(BodiesCase):
    """A row of many bodies that `solve` takes in local steps, with a constant force on each body.

    Parameters
    ----------
    machine : machine
        A single case.
    start, rtol, method
        As for `solve`.
    """

    method, rtol = "exact", 0.0
    period = None  # its time goes on, also where its forces repeat
    is_pushed = True

    def __init__(self, machine: Model, start: Any, rtol: float, method: str):
        self._forces = forces_of(machine)
        self.asked = {"start": start, "rtol": rtol, "method": method, "mode": None}
        self._start = np.array(request_of_one(machine, start, rtol, method).start[0], float)
        self._take(machine, np.zeros(len(machine_of(machine).mechanics.bodies)))

    def _take(self, model: Any, pushes: Array) -> None:
        """Read what the numbers say."""
        self.model, self._machine, self._pushes = model, machine_of(model), pushes
        mechanics: Any = self._machine.mechanics
        self._row = row_of(mechanics)
        self._of, self._layout = np.array(local_steps.bodies_of_contacts(mechanics)), local_steps.layout_of(mechanics)
        self._columns = {FORCE + f"applied.{i}": i for i in range(len(mechanics.bodies))}

    @property
    def layout(self) -> StateLayout:
        """What its states are."""
        return self._layout

    @property
    def kernel_name(self) -> str:
        """The name of its kernel's file."""
        return self._row.kernel.name

    # ---- its numbers ----
    def ready_for(self, numbers: Mapping[str, float]) -> RowCase:
        """Itself for forces; for other numbers the row that has them, whose arrays are made anew."""
        others = {name: value for name, value in numbers.items() if not self.is_quick(name)}
        return self.changed(others) if others else self

    def is_as(self, other: Any) -> bool:
        """Whether another case of this simulation has the same numbers and forces."""
        return bool(self.model == other.model and np.array_equal(self._pushes, other._pushes))

    def column(self, number: str) -> int:
        """Where a force stands in a row."""
        return self._columns[number]

    def row(self, span: float) -> Array:
        """The forces, and how long it may run."""
        return np.append(self._pushes, span)

    def changed(self, numbers: Mapping[str, float]) -> RowCase:
        """The same case with other numbers or forces."""
        others = {name: value for name, value in numbers.items() if not self.is_quick(name)}
        pushes = self._pushes.copy()
        for name in numbers.keys() - others.keys():
            pushes[self._columns[name]] = numbers[name]
        other = object.__new__(RowCase)
        other.__dict__.update(self.__dict__)
        if others:
            other._take(self.model.replace(others), pushes)
        other._pushes = pushes
        return other

    def lane(self, span: float, side: RowSide | None = None) -> RowLane:
        """A row at the start, or where another one of the same bodies stands."""
        n, speed = len(self._machine.mechanics.bodies), float(self._machine.velocity_scale)
        if side is None:
            return RowLane(self._row, self._start[:n], self._start[n : 2 * n], 0.0, span, speed, self._of)
        return RowLane(self._row, *side.places, side.time, span, speed, self._of, side.modes_of_bodies)

    def rebase(self, side: RowSide, before: RowCase, t: float) -> None:
        """Velocities are counted from zero."""

    def judge_anew(self, side: RowSide) -> None:
        """It is done wherever a number changes."""

    # ---- where it stands ----
    def standing(self, side: RowSide, t: float) -> Standing:
        """Where a row stands."""
        return Standing(t, side.states, side.sides, side.memory, _NOBODY)

    def _parts(self, side: RowSide, t: float) -> tuple[Array, Array, Array]:
        x, v = side.places
        return x, v, side.memory

    # ---- what happened ----
    def whole(self, before: Standing, rows: Array, side: RowSide) -> Array:
        """Some steps with the modes where they begin, the pieces that have not ended, and where they end."""
        modes = np.full(len(self._machine.mechanics.bodies), 2.0)
        modes[self._of] = before.sides
        stances = rows_of(STANCE, np.arange(len(modes)), before.t, modes)
        return np.concatenate([stances, rows, side.open_pieces(), rows_of(END, np.zeros(1), side.time, 0.0)])

    def events(self, before: Standing, rows: Array, after: Standing) -> list[Event]:
        """As `Trajectory.events` has them: one at an instant for each contact that has changed."""
        contact = {int(body): i for i, body in enumerate(self._of)}
        mode, events = before.sides.astype(int), list[Event]()
        changes = rows[rows[:, WHAT] == CHANGE]
        last = {(change[TIME], contact[int(change[BODY])]): int(change[REST]) for change in changes}
        for (t, i), new in sorted(last.items()):
            if new != mode[i]:
                events.append(Event(float(t), kind_of(int(mode[i]), new), int(mode[i]), new, self.layout.contacts[i].name))
                mode[i] = new
        return events

    def lost(self, side: RowSide, t: float) -> list[Event]:
        """What presses contacts is constant."""
        return []

    def run(self, rows: Array, more: dict[str, Any]) -> Trajectory:
        """Some steps as a trajectory."""
        stances, ends = (rows[rows[:, WHAT] == what] for what in (STANCE, END))
        begin, end = stances[0, TIME], ends[-1, TIME]
        first = stances[: len(self._machine.mechanics.bodies)]
        pieces, changes = (rows[rows[:, WHAT] == what] for what in (PIECE, CHANGE))
        latest = pieces[np.lexsort((np.arange(len(pieces)), pieces[:, TIME], pieces[:, BODY]))]
        again = np.append(np.all(latest[1:, BODY:REST] == latest[:-1, BODY:REST], axis=1), False)  # the same, written once more
        events = changes[:, [TIME, BODY, REST]]
        of = local_steps.pieces_of(self._machine.mechanics, first[:, REST].astype(np.int8), [latest[~again, BODY:]], events, begin, end)
        model = Pushed(self.model, tuple(self._pushes.tolist())) if self._pushes.any() else self.model
        periods = 1 if model.period is None else max(int(np.ceil((end - begin) / model.period)), 1)
        return Trajectory(model, of, periods, 0, 0.0, self.method, **more)

    def budget(self, duration: float) -> float:
        """As many steps as it needs."""
        return np.inf
