"""Any kind of law called in one way: states and memories as tuples, none of them where there are none."""

from __future__ import annotations

import dataclasses
import inspect
from typing import Any

from stickslip.fields import replace_leaf

__all__ = ["Probe", "mirrored"]


class Probe:
    """A law, the load on it, and how large its states and velocities typically are."""

    def __init__(self, law: Any, load: Any):
        self.law, self.load = law, load
        self.dynamic = hasattr(law, "rate") and hasattr(law, "force")
        self.states = int(getattr(law, "states", 1)) if self.dynamic else 0
        self.modes = int(getattr(law, "modes", 0)) if self.dynamic else 0
        self.needs_applied = self.dynamic and "applied" in inspect.signature(law.force).parameters

    def _shaped(self, z: tuple[Any, ...]) -> Any:
        return z[0] if self.states == 1 else z

    def rate(self, v: Any, z: tuple[Any, ...], mode: tuple[Any, ...]) -> tuple[Any, ...]:
        """Rates of the inner states."""
        if not self.dynamic:
            return ()
        found = self.law.rate(v, self._shaped(z), self.load, *([mode] if self.modes else []))
        return tuple(found) if isinstance(found, (tuple, list)) else (found,)

    def force(self, v: Any, z: tuple[Any, ...], mode: tuple[Any, ...], applied: Any = 0.0) -> Any:
        """Friction force [N]."""
        if not self.dynamic:
            return self.law.sliding(v, self.load)
        zdot = self._shaped(self.rate(v, z, mode))
        more = ([mode] if self.modes else []) + ([applied] if self.needs_applied else [])
        return self.law.force(v, self._shaped(z), zdot, self.load, *more)

    def switches(self, v: Any, z: tuple[Any, ...], mode: tuple[int, ...]) -> list[tuple[Any, Any, Any]]:
        """Guards with the mode and the states after them; () means states unchanged."""
        if not self.modes:
            return []
        found = self.law.switches(v, self._shaped(z), self.load, mode)
        return [(guard, after, z if bent is None else bent if isinstance(bent, tuple) else (bent,)) for guard, after, bent in found]

    @property
    def velocity_scale(self) -> float:
        """A velocity over which friction changes, or 1 cm/s."""
        speed = getattr(self.law, "velocity_scale", None)
        return 0.01 if speed is None else float(speed())

    @property
    def scale(self) -> tuple[float, ...]:
        """Typical size of each inner state: the law's own, or where the force is a fifth of the load."""
        if hasattr(self.law, "scale") and self.states:
            given = self.law.scale(self.load)
            return tuple(map(float, given)) if isinstance(given, (tuple, list)) else (float(given),)
        at = [self.force(0.0, (h,) * self.states, (0,) * self.modes) for h in (0.0, 1e-9)]
        stiffness = abs(at[1] - at[0]) / 1e-9
        return (0.2 * self.load / stiffness if stiffness > 0 else 1e-6,) * self.states

    @property
    def start(self) -> tuple[tuple[float, ...], tuple[int, ...]]:
        """The states and memories of a fresh contact."""
        return (0.0,) * self.states, (0,) * self.modes


def mirrored(law: Any) -> Any:
    """The law with plus and minus exchanged: what it is for who looks from the other side."""
    values: dict[str, Any] = {}
    for field in dataclasses.fields(law):
        value = getattr(law, field.name)
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            values[field.name] = mirrored(value)
        elif field.name.endswith("_minus"):
            stem = field.name.removesuffix("_minus")
            plus = next((name for name in (f"{stem}_plus", stem) if hasattr(law, name)), None)
            if plus is not None and not (plus == stem and value is None):  # z_ba_minus=None means z_ba
                values[field.name], values[plus] = getattr(law, plus), value
    return replace_leaf(law, values)
