"""Where limit cycles are cut: a coordinate passes a value. A cycle is a state there, and a duration after which it comes back.

Of one body on a spring the section is a turning point of the spring: the body moves as fast as its far end (a belt's spring: not at all),
and slows down. That is in the middle of a slide, where the motion is smooth. Of any other machine it is a position, or a velocity, in the
middle of its range.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.dynamics.stroboscopic.sections import halved, read
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, flow_map, state_at
from stickslip.models.machine_adapter import machine_of

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


_SLIGHT = 1e-9  # of a range: what passes a value by less is rounding


@dataclass(frozen=True)
class Section:
    """A coordinate and its value.

    Parameters
    ----------
    index : int
        The coordinate's number in the state.
    value : float, optional
        What it passes; the velocity of the spring's far end if not given.

    Examples
    --------
    >>> Section(2, 0.5).value
    0.5
    """

    index: int = 1
    value: float | None = None

    @property
    def turns(self) -> bool:
        """Whether it is where a spring turns."""
        return self.value is None

    def unknowns(self, at: Coordinates, state: Array, duration: float, unit: float) -> Array:
        """A cycle as Newton's method looks for it: all that is not fixed, in its scales, and the duration."""
        return np.append(np.delete((state / at.scales)[: at.smooth], self.index), duration / unit)

    def states(self, model: Model, at: Coordinates, U: Array, memory: Array) -> Array:
        """States on the section, one row for each row of unknowns."""
        fixed = np.broadcast_to(far_end(model) if self.value is None else self.value, len(U))
        free = U[:, :-1] * np.delete(at.scales[: at.smooth], self.index)
        held = np.broadcast_to(memory, (len(U), len(memory)))
        return np.hstack([np.insert(free, self.index, fixed, axis=1), held])

    def ends(self, model: Model, at: Coordinates, U: Array, memory: Array, rtol: float, unit: float) -> Array:
        """States after the durations, relative to the spring's far end; NaN where a duration is not positive."""
        T = U[:, -1] * unit
        good = np.isfinite(T) & (T > 0)
        ends = flow_map(model, self.states(model, at, U, memory), np.where(good, T, 1.0), rtol).state.copy()
        if self.turns:
            ends[:, 0] -= far_end(model) * T
        return np.where(good[:, None], ends, np.nan)

    def misses(self, model: Model, at: Coordinates, U: Array, memory: Array, rtol: float, unit: float) -> Array:
        """How far states are from themselves after their durations, in scales."""
        return ((self.ends(model, at, U, memory, rtol, unit) - self.states(model, at, U, memory)) / at.scales)[:, : at.smooth]


TURN = Section()


def far_end(model: Model) -> Array:
    """Velocity of the spring's far end [m/s]."""
    return np.asarray(machine_of(model).far_end_velocity, float)


def section_of(run: Trajectory) -> tuple[Section, str, float, float]:
    """Where the motion at the end of a run is cut: the section, its column of the run, its value there, and the direction of passing."""
    if machine_of(run.model).is_single:
        return TURN, "v", float(far_end(run.model)), -1.0
    at, t = coordinates(run.model), np.unique(run.t)
    late = t[t >= 0.5 * (t[0] + t[-1])]
    columns = {name: read(run, name, late) for name in at.names if name.startswith(("x.", "v.")) and name.count(".") == 1}
    swings = {name: float(np.ptp(values)) / at.scales[at.names.index(name)] for name, values in columns.items()}
    places = {name: swing for name, swing in swings.items() if name.startswith("x.")} or swings
    name = max(places, key=lambda each: places[each])
    middle = float(0.5 * (columns[name].min() + columns[name].max()))
    steps = np.diff(columns[name])[np.diff(columns[name] > middle)] / np.diff(late)[np.diff(columns[name] > middle)]
    faster = -1.0 if len(steps) and -steps.min() > steps.max() else 1.0  # in a slide, not where it rides along
    return Section(at.names.index(name), middle), name, middle, faster


def returns(run: Trajectory, column: str, value: float, direction: float) -> Array:
    """The instants at which a column of a run passes a value."""
    t = np.unique(run.t)
    beyond = (read(run, column, t) - value) * direction
    size = _SLIGHT * max(float(abs(beyond).max()), 1e-300)
    where = np.flatnonzero((beyond[:-1] < 0) & (beyond[1:] >= 0) & (np.maximum(abs(beyond[:-1]), abs(beyond[1:])) > size))
    return halved(run, column, value, t[where], t[where + 1], direction * np.ones(len(where)))


def states_of_returns(run: Trajectory, t: Array) -> Array:
    """The states at some instants of a run, with what laws remember; a spring is measured from its far end."""
    states = []
    single = machine_of(run.model).is_single
    for instant in t:
        state = state_at(run, float(instant))
        if single:
            state = np.concatenate([[state[0] - far_end(run.model) * instant, far_end(run.model)], state[2:]])
        piece = min(int(np.searchsorted(run.pieces.t, instant, side="right")) - 1, len(run.pieces.mode) - 1)
        states.append(np.concatenate([state, np.ravel(np.asarray(run.pieces.memory[piece], float))]))
    return np.array(states)
