"""What periodic orbits and limit cycles have in common: a motion that comes back to its state, and what becomes of disturbances."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.dynamics.mapping import coordinates
from stickslip.dynamics.variational import monodromy

__all__ = ["ClosedMotion", "largest_first"]

Array = Any


class ClosedMotion(ABC):
    """A motion of a model that comes back to a state."""

    model: Any
    state: Array

    @property
    @abstractmethod
    def run(self) -> Any:
        """Once around, with its dense output."""

    @property
    @abstractmethod
    def multipliers(self) -> Array:
        """Floquet multipliers, the largest first."""

    @property
    def names(self) -> tuple[str, ...]:
        """What the numbers of the state are."""
        return coordinates(self.model).names

    @property
    def start(self) -> dict[str, Any]:
        """The state as `solve` takes a start."""
        return coordinates(self.model).start(self.state)

    @property
    def events(self) -> list[Any]:
        """Every change of mode within the motion (dynamic laws: reversals of the contact's velocity)."""
        return self.run.events

    @cached_property
    def monodromy(self) -> Array:
        """The derivative of the state after the motion by the state before it."""
        return monodromy(self.run)

    @property
    def stable(self) -> bool:
        """Whether small disturbances die out: all multipliers within the unit circle."""
        return bool(np.all(abs(self.multipliers) < 1.0))


def largest_first(multipliers: Array) -> Array:
    """Multipliers by their absolute values.

    Examples
    --------
    >>> largest_first(np.array([0.5, -2.0, 1.0])).tolist()
    [-2.0, 1.0, 0.5]
    """
    return multipliers[np.argsort(-abs(multipliers), kind="stable")]
