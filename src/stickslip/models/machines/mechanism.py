"""Base class of the mechanisms: checks, batch shape, TOML, and the protocol of the solvers."""

from __future__ import annotations

from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any, ClassVar

from stickslip.basics.batch import check_shape
from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.maths import pi, sqrt
from stickslip.basics.quantities import DAMPING, LOAD, MASS, STIFFNESS, Rule, positive, quantity
from stickslip.models.forces import check_law
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.machines.filed import Filed
from stickslip.models.mirroring import image_of_fields


class Mechanism(Filed):
    """Base of the mechanisms: a mass with one contact. A subclass adds its fields, `acceleration` and where its energy goes."""

    _turns: ClassVar[tuple[str, ...]] = ()  # numbers that change their sign in the mirror
    period: Any = None  # nothing repeats by itself: a run is so many seconds long
    total_mass: Any = property(attrgetter("mass"), doc="The mass that moves [kg].")

    def _check(self: Any, problems: Problems) -> None:
        check_law(self.friction, problems)
        check_shape(self, problems)

    def contact_velocity(self: Any, v: Numeric) -> Any:
        """Velocity at the contact [m/s]."""
        return v

    def mirrored(self: Any) -> Any:
        """The mechanism with forwards and backwards exchanged."""
        return image_of_fields(self, self._turns)

    @property
    def notes(self: Any) -> list[str]:
        """Remarks on these numbers that are not errors, such as a law outside of its range."""
        return law_of(self).notes(self.load)


class Sprung(Mechanism):
    """A mass on a spring and a damper that are fixed at their other end."""

    def potential(self: Any, t: Numeric, x: Numeric) -> Any:
        """Energy in the spring [J]."""
        return 0.5 * self.stiffness * x**2

    def damping_power(self: Any, t: Numeric, x: Numeric, v: Numeric) -> Any:
        """Power dissipated by the damping [W]."""
        return self.damping * v**2


@dataclass(frozen=True, eq=False)
class SpringMass(Sprung):
    """Base of the mechanisms in which something that moves steadily stretches a spring."""

    mass: float = field(metadata=MASS | {"example": 1.0})
    stiffness: float = field(metadata=STIFFNESS | {"example": 2.0, "rule": positive})
    speed: float = field(
        metadata=quantity(
            "speed of the belt or of the pull", "m/s", "u", example=0.1, rule=Rule(lambda x: x != 0, "a speed that is not zero")
        )
    )
    friction: Any
    load: float = field(default=1.0, metadata=LOAD)
    damping: float = field(default=0.0, metadata=DAMPING)

    _turns: ClassVar[tuple[str, ...]] = ("speed",)

    @property
    def velocity_scale(self) -> float:
        """Speed of the steady motion, the scale of errors [m/s]."""
        return abs(self.speed)

    @property
    def time_scale(self) -> Any:
        """Period of the free oscillation [s]."""
        return 2 * pi * sqrt(self.mass / self.stiffness)
