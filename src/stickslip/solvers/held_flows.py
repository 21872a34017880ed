"""A switching flow as a case that a held lane follows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from stickslip.basics.batch import labels_of
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.status import STATUS
from stickslip.engine.held_lane import HeldLane, Side
from stickslip.models.switching_flow import SwitchingFlow
from stickslip.results.flow_pieces import FlowPieces, ModeChange
from stickslip.results.trajectory import Trajectory
from stickslip.solvers import flow_engine
from stickslip.solvers.flow_requests import flow_request
from stickslip.solvers.held_cases import Standing, times_of
from stickslip.solvers.settings import Settings, periods_begun

_NOBODY = np.zeros(0, bool)
_ENDLESS = 1e9  # switches


class FlowCase:
    """A switching flow, whose numbers are its inputs.

    Parameters
    ----------
    flow : SwitchingFlow
        Of single numbers.
    start, method
        As for `solve`.
    mode
        The first one; if it is not given the state says which.
    """

    period = None  # the time of a flow goes on
    is_pushed = False
    unit: float | None

    def __init__(self, flow: SwitchingFlow, start: Any, method: str, mode: Any = None):
        if shape := labels_of(flow).shape:
            raise InputError("simulation", [f"the flow is a batch of shape {shape}; allowed is one case; type ss.solve(flow) for a batch"])
        self.asked = {"start": start, "rtol": flow_engine.TOLERANCE, "method": method, "mode": mode}
        options = {} if mode is None else {"mode": mode}
        asked = flow_request(flow, Settings(start=start, keep="trajectory", samples=4, method=method, duration=1.0, options=options))
        self.method, _ = flow_engine.steps_of_flow(flow)
        self.model, self._labels, self.unit = flow, list(flow.modes), None if flow.period is None else float(flow.period)
        self._y, self._mode, self._n = asked.start, asked.modes[0], asked.start.shape[1]
        self._equations, self.kernel, self._names = flow_engine.flow_kernel(asked.equations, record=True)
        self._known = flow.names(self._n)

    @property
    def names(self) -> dict[str, str]:
        """Its numbers."""
        return {name: name for name in self.model.numbers}

    def numbers(self) -> dict[str, float]:
        """The inputs as they are now."""
        return {name: float(value) for name, value in self.model.numbers.items()}

    @property
    def machine(self) -> SwitchingFlow:
        """The flow."""
        return self.model

    @property
    def kernel_name(self) -> str:
        """The name of its kernel's file."""
        return self.kernel.code.name

    def ready_for(self, numbers: Mapping[str, float]) -> FlowCase:
        """Itself: any of its numbers can change."""
        return self

    def is_as(self, other: Any) -> bool:
        """Whether another case of this simulation has the same numbers."""
        return self.numbers() == other.numbers()

    def is_quick(self, number: str) -> bool:
        """A flow's numbers may be any, so that each changes alone."""
        return number in self._names

    def knows(self, memory: Any) -> bool:
        """The first is the number of its mode."""
        return 1 <= round(float(memory[0])) <= len(self.machine.modes)

    def column(self, number: str) -> int | None:
        """Where a number stands in a row."""
        return self._names.index(number)

    def lane(self, span: float, side: Side | None = None) -> HeldLane:
        """A lane at the start."""
        start = np.concatenate(
            [[0.0], self._y[0], np.zeros(self.kernel.states - self._n), [flow_engine.number_of_mode(self.model, self._mode)]]
        )
        return HeldLane(self.kernel, self.row(span), start, flow_engine.TOLERANCE)

    def row(self, span: float) -> Array:
        """The numbers in the kernel's order."""
        row: Array = flow_engine.flow_row(self.model, self._equations, self._names, self._y, span, 0.0, _ENDLESS)[0]
        return row

    def changed(self, numbers: Mapping[str, float]) -> FlowCase:
        """The same case with other numbers."""
        other = object.__new__(FlowCase)
        other.__dict__.update(self.__dict__)
        other.model = self.model.replace(dict(numbers))
        return other

    def rebase(self, side: Side, before: FlowCase, t: float) -> None:
        """States are counted from zero."""

    def judge_anew(self, side: Side) -> None:
        """What contacts do from here on is what the state says, as at the start of a run."""
        if self.model.contacts:
            field, _ = self.model.labels[self._mode_of(side)]
            side.memory[0] = -1.0 - list(self.model.fields).index(field)

    def standing(self, side: Side, t: float) -> Standing:
        """Where a lane stands."""
        return Standing(t, side.states[: self._n].copy(), side.sides, side.memory.copy(), _NOBODY)

    def _mode_of(self, side: Side) -> Any:
        return self._labels[round(float(side.memory[0])) - 1]

    def state(self, side: Side, t: float) -> dict[str, Any]:
        """t, the states by their names, and the mode."""
        return {"t": t, **dict(zip(self._known, side.states[: self._n].tolist(), strict=True)), "mode": self._mode_of(side)}

    def start(self, side: Side, t: float) -> dict[str, Any]:
        """The states as `solve` takes a start."""
        return dict(zip(self._known, side.states[: self._n].tolist(), strict=True))

    def parts(self, side: Side, t: float) -> dict[str, dict[str, Any]]:
        """A flow has none."""
        return {}

    def events(self, before: Standing, rows: Array, after: Standing) -> list[ModeChange]:
        """The switches, each once however many of them fall on one instant."""
        sides, t = np.concatenate([before.sides[None], rows[:, 4:6], after.sides[None]]), times_of(rows, None)
        modes = [self._labels[round(float(number)) - 1] for number in sides[:, 0]]
        return [ModeChange(float(t[k]), modes[k], modes[k + 1]) for k in np.flatnonzero(np.diff(sides[:, 1]) > 0)]

    def lost(self, side: Side, t: float) -> list[Any]:
        """Nothing is pressed."""
        return []

    def whole(self, before: Standing, rows: Array, side: Side) -> Array:
        """These steps: none of them is open."""
        return rows

    def run(self, rows: Array, more: dict[str, Any]) -> Trajectory:
        """Some steps as a run."""
        method, tolerance = flow_engine.steps_of_flow(self.model)
        n, lasts, switches = self._n, rows[:, 2] > rows[:, 1], np.flatnonzero(np.diff(rows[:, 5]) > 0)
        c = rows[:, flow_engine.FIRST :].reshape(len(rows), self.kernel.states, -1)[:, :n]
        modes, long, own = np.round(rows[:, 4]).astype(int) - 1, rows[lasts], c[lasts]
        pieces = FlowPieces(
            t=np.concatenate([long[:1, 1], long[:, 2]]),
            mode=modes[lasts],
            coefficients=own,
            end=own[-1].sum(axis=-1),
            end_mode=modes[-1],
            passed=c[~lasts, :, 0],
            switch_times=rows[switches, 2],
            switch_modes=np.column_stack([modes[switches], modes[switches + 1]]),
        )
        periods = 1 if self.unit is None else periods_begun(float(pieces.t[-1] - pieces.t[0]), self.unit)
        return Trajectory(self.model, pieces, periods, 0, tolerance, method, **more)

    def budget(self, duration: float) -> float:
        """As many as in one run."""
        return flow_engine.budget_of_flow(self.model)

    def sentence(self, status: int, side: Side, t: float) -> str:
        """Why a step could not be made."""
        end = ", ".join(f"{name} = {value:.9g}" for name, value in self.start(side, t).items())
        return f"{STATUS[status]} at t = {t:.9g} in mode {self._mode_of(side)!r}, where {end}"
