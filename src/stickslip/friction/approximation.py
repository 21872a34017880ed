"""What the smoothed laws share: no inner state, a width in velocity, and a sentence on what is wrong with them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from stickslip.fields import at_least, positive
from stickslip.friction.law import Law

__all__ = ["Approximation", "SmoothedCoulomb"]


class Approximation(Law):
    """Base of the laws that exist to show how wrong they are; each brings its force and its sentence."""

    states: ClassVar[int] = 0
    approximation: ClassVar[str] = ""
    width: Any

    def rate(self, v: Any, z: Any, load: Any) -> tuple[Any, ...]:
        """There is no inner state."""
        return ()

    def scale(self, load: Any) -> tuple[Any, ...]:
        """There is no inner state."""
        return ()

    def velocity_scale(self) -> Any:
        """The velocity over which friction changes [m/s]."""
        return self.width

    def notes(self, load: Any) -> list[str]:
        """What is wrong with this law."""
        return [self.approximation]


@dataclass(frozen=True, eq=False)
class SmoothedCoulomb(Approximation):
    """Base of the laws that draw a curve through the step of Coulomb friction at v = 0."""

    mu_plus: float
    mu_minus: float
    width: float

    _example: ClassVar[dict[str, Any]] = dict(mu_plus=0.15, mu_minus=0.21, width=1e-3)
    _rules: ClassVar[dict[str, Any]] = {
        "mu_plus": (at_least(0.0), "zero or more"),
        "mu_minus": (at_least(0.0), "zero or more"),
        "width": (positive, "a positive velocity [m/s]"),
    }
