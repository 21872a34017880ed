"""The states of a flow that switches as the maps of this package know them: its states by their names, and its mode."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.analysis.state_order import order_of, order_of_names
from stickslip.basics.batch import cases_of, labels_of
from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.status import Status
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, Ends
from stickslip.solvers.flow_starts import changed_at_once, places_of_starts
from stickslip.solvers.plain.composed_flows import mode_of_strobe_state

_HALVINGS = 30  # of a drive period, in search of the instant at which a run ends


@sealed
class FlowCoordinates(Coordinates):
    """Those of a flow that switches: its states by their names, and the place of its mode among its modes, which is a memory."""

    def start(self, state: ArrayLike) -> dict[str, Any]:
        """A state, or a table of them, by the names of its numbers."""
        state = np.asarray(state, float)
        return {name: state[..., i][()] for i, name in enumerate((*self.names[: self.smooth], "memory"))}

    def begun(self, model: Any, state: Array) -> dict[str, Any]:
        """What `solve` takes to begin a run in a state."""
        state = np.asarray(state, float)
        return {"start": state[:-1], "mode": mode_of_strobe_state(model, state)}

    def at_rest(self, model: Any) -> Array:
        """All states zero, in the mode in which a run begins there."""
        rest = np.zeros((labels_of(model).cases, len(self.names)))
        rest[:, -1] = [places_of_starts(case, rest[:1, :-1])[0] for case in cases_of(model)]
        return rest

    def map_of(self, model: Any, rtol: float) -> Callable[[Array, int], Ends]:
        """The strobe map, which is exact to rounding."""
        return lambda states, periods: _of_flow(model, states, periods * np.asarray(model.period, float))

    def after(self, model: Any, states: Array, duration: Array, rtol: float) -> Ends:
        """The states after some time."""
        return _of_flow(model, states, duration)

    has_phase = in_lanes = False

    def time_of(self, model: Any) -> None:
        """Its functions do not say it."""

    def last(self, run: Any) -> Array:
        """The state and the mode at the end of a run."""
        return np.asarray(run.strobe_state)

    def states_in(self, run: Any, t: Array) -> Array:
        """The states at some instants of a run, with the places of the modes; at a switch those after it."""
        index = run._index(t)
        return np.column_stack([run.pieces.states(t, index), run.modes[index]])

    def placed(self, model: Any, states: Array) -> Array:
        """States with the place of the mode in which a run begins there."""
        return np.column_stack([states[:, :-1], places_of_starts(model, states[:, :-1])])

    def changed_at_once(self, model: Any, states: Array) -> Array:
        """Those of which a reset makes others."""
        return changed_at_once(model, states[:, :-1])

    @property
    def start_names(self) -> tuple[str, ...]:
        """Names of its states; the mode follows."""
        return self.names[: self.smooth]

    def before_end(self, model: Any, states: Array) -> Array:
        """The last states within the next period before a flow cannot be solved any more, by halving the time."""
        from stickslip.solvers.flow_engine import ends

        low, high = np.zeros(len(states)), np.ones(len(states))
        T, last = np.asarray(model.period if self.section is None else self.section.longest, float), states.copy()
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            y, _, status = ends(model, states[:, :-1], np.round(states[:, -1]), middle * T)
            fine = (status <= Status.REPEATS) & np.isfinite(y).all(axis=1)
            last[fine, :-1] = y[fine]
            low, high = np.where(fine, middle, low), np.where(fine, high, middle)
        return last


def coordinates_of_flow(flow: Any, count: int | None = None) -> Coordinates:
    """The states of a flow by their names, and the place of its mode among its modes, which is a memory."""
    if flow.states is None and count is not None:
        order, sizes = order_of_names(flow.names(count - 1)), (1.0,) * (count - 1)
    else:
        order, sizes = order_of(flow), flow.sizes
    return FlowCoordinates((*order.names, "mode"), np.append(sizes, 1.0), order, 1, drifts=flow.drifts)


def _of_flow(flow: Any, states: Array, duration: Any) -> Ends:
    """The states of a flow that switches after some time, and the way that its first cyclic coordinate makes."""
    from stickslip.solvers.flow_engine import ends, unknown
    from stickslip.solvers.flow_requests import untraced

    if why := unknown(flow, states.shape[1] - 1):
        raise InputError("SwitchingFlow", [untraced(why)])
    y, modes, status = ends(flow, states[:, :-1], np.round(states[:, -1]), duration)
    return ends_of_flow(flow, states, y, modes, status)


def ends_of_flow(flow: Any, begun: Array, y: Array, modes: Array, status: Array, duration: Any = None) -> Ends:
    """The ends of runs of a flow from some starts: cyclic coordinates count as a way, and are brought back."""
    none, drifts = np.full(len(y), np.nan), flow.drifts
    way = y[:, drifts.places[0]] - begun[:, drifts.places[0]] if drifts else np.zeros(len(y))
    states = np.column_stack([drifts.wrapped(y) if drifts else y, np.where(modes < 0, np.nan, modes)])
    return Ends(states, way, status, none, none, duration=duration)
