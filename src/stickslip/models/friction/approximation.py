"""Common parts of the smoothed laws: no inner state, a width in velocity, and a statement of their error."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.models.friction.coefficients import MU_MINUS, MU_PLUS, WIDTH
from stickslip.models.friction.law import Law


class Approximation(Law):
    """Base of the laws that serve to show their own error; each has its force and a sentence on the error."""

    states: ClassVar[int] = 0
    approximation: ClassVar[str] = ""

    def rate(self, v: Numeric, z: Numeric | tuple[Numeric, ...], load: Numeric) -> tuple[Any, ...]:
        """There is no inner state."""
        return ()

    def scale(self, load: Numeric) -> tuple[Any, ...]:
        """There is no inner state."""
        return ()

    def velocity_scale(self: Any) -> Any:
        """The velocity over which friction changes [m/s]."""
        return self.width

    def notes(self, load: Numeric) -> list[str]:
        """The error of this law."""
        return [self.approximation]


@dataclass(frozen=True, eq=False)
class SmoothedCoulomb(Approximation):
    """Base of the laws that draw a curve through the step of Coulomb friction at v = 0."""

    mu_plus: float = field(metadata=MU_PLUS)
    mu_minus: float = field(metadata=MU_MINUS)
    width: float = field(metadata=WIDTH)
