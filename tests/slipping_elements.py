"""Jenkins elements (a spring in series with a slider), with discrete memory, and an oscillator on them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import stickslip as ss
from stickslip.maths import where


@dataclass(frozen=True)
class Jenkins:
    """n elements of stiffness 1 N/m whose slider yields at so much of the load; a memory of each says whether and which way it yields."""

    limits: tuple[float, ...]

    @property
    def states(self):
        return len(self.limits)

    modes = states

    def rate(self, v, z, load, mode):
        rates = tuple(v * (1 - m * m) for m in mode)
        return rates if self.states > 1 else rates[0]

    def force(self, v, z, zdot, load, mode):
        return sum(z[1:], z[0]) if self.states > 1 else z

    def scale(self, load):
        found = tuple(limit * load for limit in self.limits)
        return found if self.states > 1 else found[0]

    def switches(self, v, z, load, mode):
        z = z if self.states > 1 else (z,)
        found: list[Any] = []
        for i, limit in enumerate(self.limits):
            for side in (1.0, -1.0):
                yields = tuple(side if j == i else m for j, m in enumerate(mode))
                found.append((where(mode[i] * mode[i] > 0.5, 1.0, limit * load - side * z[i]), yields, None))
        return [*found, (abs(v), tuple(0.0 * m for m in mode), None)]


def oscillator(limits, force, omega):
    return ss.ForcedOscillator(mass=1.0, stiffness=1.0, damping=0.02, force=force, omega=omega, friction=Jenkins(limits), load=1.0)
