"""Following a limit cycle in a parameter: how long it takes is one more unknown, in the place of the velocity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.dynamics.cycles import LimitCycle, ends_of, misses_of, states_on, unknowns
from stickslip.dynamics.newton import Found
from stickslip.dynamics.paths import Path
from stickslip.forces import is_dynamic

__all__ = ["CyclePath", "vanishing"]

Array = Any
_WELL = 1e-11  # residual of the cycles that are used
_SHORT = 0.01  # part of the cycle below which a rest is about to vanish


@dataclass(frozen=True, eq=False)
class CyclePath(Path):
    """What stays the same along a branch of limit cycles. A point is (x, inner states, duration, parameter).

    Parameters
    ----------
    unit : float
        The time in which durations are measured [s].
    """

    unit: float = 1.0

    def scaled(self, orbit: Any, value: float) -> Array:
        """The point u of a cycle."""
        return np.append(unknowns(self.at, orbit.state, orbit.duration, self.unit), (value - self.origin) / self.span)

    def ends(self, U: Array, memory: Array) -> Array:
        """The states after the durations."""
        return ends_of(self.family.robots(self.value(U)), self.at, U[:, :-1], memory, self.rtol, self.unit)

    def misses(self, U: Array, memory: Array) -> Array:
        """How far each state is from itself after its duration, in its scales."""
        return misses_of(self.family.robots(self.value(U)), self.at, U[:, :-1], memory, self.rtol, self.unit)

    def orbit(self, found: Found) -> LimitCycle:
        """The cycle at a point."""
        model, u = self.family.robot(self.value(found.at)), found.at[:-1]
        state = states_on(model, self.at, u[None, :], found.memory)[0]
        return LimitCycle(model, self.period, state, float(u[-1] * self.unit), found.residual, self.rtol)


def vanishing(values: Array, cycles: Sequence[Any]) -> float | None:
    """Where the rest of stick-slip cycles vanishes, if their branch ends because of that; None if not.

    The slide then touches the speed at which the contact rests: the square of the time at rest is smooth in the parameter, and is
    continued to zero from the last points.
    """
    if not isinstance(cycles[-1], LimitCycle) or is_dynamic(cycles[-1].model.friction):
        return None
    kept = [(float(value), _rest(o) ** 2) for value, o in zip(values, cycles, strict=True) if o.residual < _WELL][-3:]
    if len(kept) < 3 or not kept[0][1] > kept[1][1] > kept[2][1] > 0.0 or kept[-1][1] > (_SHORT * cycles[-1].duration) ** 2:
        return None
    (a, p), (b, q), (c, r) = kept
    return a * q * r / ((p - q) * (p - r)) + b * p * r / ((q - p) * (q - r)) + c * p * q / ((r - p) * (r - q))


def _rest(cycle: LimitCycle) -> float:
    """How long the contact rests in a cycle [s]."""
    pieces = cycle.run.pieces
    return float(np.diff(pieces.t)[np.asarray(pieces.mode) == 0].sum())
