"""What the mechanisms share: checks, the shape of a batch, TOML, and the protocol that solvers ask."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

from stickslip.batch import check_shape, shape_of
from stickslip.errors import Problems
from stickslip.fields import Frozen
from stickslip.forces import check_law
from stickslip.friction.law_adapter import law_of, mirrored as mirrored_law
from stickslip.maths import pi, sqrt
from stickslip.quantities import DAMPING, LOAD, MASS, STIFFNESS, Rule, positive, quantity
from stickslip.tables import from_toml, record_html, to_toml

__all__ = ["Mechanism", "SpringMass"]


class Mechanism(Frozen):
    """Base of the mechanisms: a mass with one contact. A subclass adds its fields, `acceleration` and where its energy goes."""

    kind: ClassVar[str] = ""  # its name in a study file
    _turns: ClassVar[tuple[str, ...]] = ()  # numbers that change their sign in the mirror
    period: Any = None  # nothing repeats by itself: a run is so many seconds long
    mass: Any
    friction: Any
    load: Any

    def _check(self, problems: Problems) -> None:
        check_law(self.friction, problems)
        check_shape(self, problems)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch that this mechanism is; () for one."""
        return shape_of(self)

    @property
    def total_mass(self) -> float:
        """The mass that moves [kg]."""
        return self.mass

    def contact_velocity(self, v: Any) -> Any:
        """Velocity at the contact [m/s]."""
        return v

    def mirrored(self) -> Any:
        """The mechanism with forwards and backwards exchanged."""
        numbers = {name: 0.0 - getattr(self, name) for name in self._turns}
        return replace(self, friction=mirrored_law(self.friction), **numbers)  # type: ignore[type-var]

    @property
    def notes(self) -> list[str]:
        """Remarks on these numbers that are not errors, such as a LuGre law that is not passive."""
        return law_of(self).notes(self.load)

    def to_toml(self) -> str:
        """The mechanism as TOML text, every digit kept; `from_toml` reads it back."""
        return to_toml(self, "mechanism")

    @classmethod
    def from_toml(cls, text: str) -> Any:
        """A mechanism of this kind from the TOML text of `to_toml`."""
        return from_toml(cls, text, "mechanism")

    def _repr_html_(self) -> str:
        return record_html(self)


@dataclass(frozen=True, eq=False)
class SpringMass(Mechanism):
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
