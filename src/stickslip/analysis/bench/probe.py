"""A law under one load, with the typical size of its states and velocities."""

from __future__ import annotations

from typing import Any

from stickslip.basics.contracts import ArrayLike, Law, Numeric
from stickslip.models.friction.law_adapter import adapted


class Probe:
    """A law, the load on it [N], and their typical scales."""

    def __init__(self, law: Law, load: Numeric):
        self.law, self.load = adapted(law), load

    def force(self, v: ArrayLike, z: tuple[Any, ...], mode: tuple[Any, ...], applied: ArrayLike = 0.0) -> Any:
        """Friction force [N]."""
        return self.response(v, z, mode, applied)[0]

    def response(self, v: Any, z: tuple[Any, ...], mode: tuple[Any, ...], applied: Any = 0.0) -> tuple[Any, tuple[Any, ...]]:
        """Friction force [N], and the rates of the inner states."""
        return self.law.response(v, z, self.load, mode, applied)

    def switches(self, v: Numeric, z: tuple[Any, ...], mode: tuple[int, ...]) -> list[tuple[Any, Any, Any]]:
        """Guards with the memories and the inner states after each switch."""
        return [(guard, after, z if new is None else new) for guard, after, new in self.law.switches(v, z, self.load, mode)]

    @property
    def velocity_scale(self) -> float:
        """A velocity over which friction changes, or 1 cm/s."""
        own = self.law.velocity_scale()
        return 0.01 if own is None else float(own)

    @property
    def scale(self) -> tuple[float, ...]:
        """Typical size of each inner state: the law's own, or the size at which the force is a fifth of the load."""
        own = self.law.scale(self.load)
        if own is not None:
            return tuple(map(float, own))
        states = self.law.states
        at = [self.force(0.0, (h,) * states, (0,) * self.law.modes) for h in (0.0, 1e-9)]
        stiffness = abs(at[1] - at[0]) / 1e-9
        return (0.2 * self.load / stiffness if stiffness > 0 else 1e-6,) * states

    @property
    def start(self) -> tuple[tuple[float, ...], tuple[int, ...]]:
        """The states and memories of a fresh contact."""
        return tuple(map(float, self.law.start(self.load))), (0,) * self.law.modes
