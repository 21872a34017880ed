"""Where limit cycles are cut: a coordinate passes a value. A cycle is a state there, and a duration after which it comes back.

Which coordinate that is says `stickslip.analysis.section_choice`. A turning point of a spring, where the body moves as fast as the far end
(a belt's spring: not at all), stays one while the speed varies.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.analysis.section_choice import Cut
from stickslip.basics.contracts import Array, Model
from stickslip.dynamics.derivatives.slopes import number_slopes
from stickslip.dynamics.derivatives.tangents import Directions, changes_along
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, flow_map
from stickslip.models.machine_adapter import machine_of


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
        ends[:, 0] -= far_end(model) * T
        return np.where(good[:, None], ends, np.nan)

    def misses(self, model: Model, at: Coordinates, U: Array, memory: Array, rtol: float, unit: float) -> Array:
        """How far states are from themselves after their durations, in scales."""
        return ((self.ends(model, at, U, memory, rtol, unit) - self.states(model, at, U, memory)) / at.scales)[:, : at.smooth]

    def slopes(
        self, model: Model, at: Coordinates, u: Array, memory: Array, rtol: float, unit: float, numbers: dict[str, float] | None = None
    ) -> tuple[Array, Array]:
        """What one state misses, and its derivatives by the unknowns: by small changes along the cycle, by its rates at the end.

        With derivatives of the model's numbers by a parameter, those by the parameter come last.
        """
        T, given = float(u[-1] * unit), numbers or {}
        tried = u + _RATE * np.array([0.0, 1.0, -1.0])[:, None] * np.eye(len(u))[-1]
        missed = self.misses(model, at, tried, memory, rtol, unit)
        if not T > 0.0 or not np.isfinite(missed).all():
            return missed[0], np.full((at.smooth, len(u) + bool(given)), np.nan)
        shift = _far_end_slope(model, given) if given else 0.0
        free = np.delete(np.diag(at.scales[: at.smooth]), self.index, axis=0)
        moved = shift * np.eye(at.smooth)[self.index] if self.turns else np.zeros(at.smooth)
        starts = np.vstack([free, moved]) if given else free
        parts = {name: np.append(np.zeros(len(free)), slope) for name, slope in given.items()}
        states = np.repeat(self.states(model, at, u[None, :], memory), len(starts), axis=0)
        change = changes_along(model, states, starts, how=Directions(parts, rtol, T)).change - starts
        change[len(free) :, 0] -= shift * T
        J = np.insert((change / at.scales[: at.smooth]).T, len(free), (missed[1] - missed[2]) / (2.0 * _RATE), axis=1)
        return missed[0], J


TURN = Section()
_RATE = 1e-6  # of the unit of time: differences of durations, beside an end where the motion is smooth


def far_end(model: Model) -> Array:
    """Velocity of the spring's far end [m/s]."""
    return np.asarray(machine_of(model).far_end_velocity, float)


def _far_end_slope(model: Model, numbers: dict[str, float]) -> float:
    """Derivative of the velocity of the spring's far end by a parameter, from those of the model's numbers."""
    return float(number_slopes(model, {name: np.array([slope]) for name, slope in numbers.items()}, _far_end_of)[0][0])


def _far_end_of(machine: Any) -> list[Any]:
    """Velocity of the spring's far end, as a function of the model's numbers."""
    return [machine.far_end_velocity]


def section_of(model: Model, cut: Cut) -> Section:
    """The section of a cycle that is cut there: a turning point of the spring is kept as such, and goes with the speed of its far end."""
    turning = machine_of(model).turning_velocity
    if turning is not None and cut.name == "v" and cut.value == float(np.max(turning)):
        return TURN
    return Section(coordinates(model).names.index(cut.name), float(cut.value))
