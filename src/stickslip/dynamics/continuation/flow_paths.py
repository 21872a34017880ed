"""Following a periodic orbit of a forced flow in one of its numbers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.dynamics.continuation.pseudo_arclength import Path
from stickslip.dynamics.flows.flow_orbits import FlowOrbit, orbit_at
from stickslip.dynamics.periodic.newton import Found

__all__ = ["FlowPath"]


@dataclass(frozen=True, eq=False)
class FlowPath(Path):
    """What stays the same along a branch of a flow's orbits. What is remembered of a point is the mode on the strobe."""

    def numbers(self, guess: Any) -> None:
        """None: differences are taken, as what its numbers do is followed for machines only."""

    @property
    def has_tolerance(self) -> bool:
        """No: its runs are exact."""
        return False

    @cached_property
    def _followed(self) -> bool:
        """Differences are taken."""
        return False

    def orbit(self, found: Found) -> FlowOrbit:
        """The motion at a point."""
        state = np.append(found.at[: self.at.smooth] * self.scales, found.memory)
        return orbit_at(self.robot(found.at), state, self.period, found.residual)
