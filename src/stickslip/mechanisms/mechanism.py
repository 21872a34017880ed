"""What the mechanisms share: checks, the shape of a batch, TOML, and the protocol that solvers ask."""

from __future__ import annotations

from typing import Any, ClassVar

from stickslip.batch import shape_of
from stickslip.errors import InputError, Problems
from stickslip.fields import Record, at_least, positive
from stickslip.forces import check_law
from stickslip.tables import from_toml, record_html, to_toml

__all__ = ["RULES", "Mechanism"]

#: What several mechanisms allow for their numbers.
RULES: dict[str, Any] = {
    "mass": (positive, "a positive mass [kg]"),
    "stiffness": (positive, "a positive stiffness [N/m]"),
    "speed": (lambda value: value != 0, "a speed that is not zero [m/s]"),
    "load": (positive, "a positive force [N]"),
    "damping": (at_least(0.0), "zero or more [N s/m]"),
}


class Mechanism(Record):
    """Base of the mechanisms: a mass with one contact. A subclass adds its fields, `acceleration` and where its energy goes."""

    kind: ClassVar[str] = ""  # its name in a study file
    cyclic: ClassVar[bool] = False  # x appears in the equations
    period: Any = None  # nothing repeats by itself: a run is so many seconds long
    mass: Any
    friction: Any
    load: Any

    def _check(self, problems: Problems) -> None:
        check_law(self.friction, problems)
        if not problems.found:
            try:
                shape_of(self)
            except InputError as error:
                problems.include(error)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch that this mechanism is; () for one."""
        return shape_of(self)

    @property
    def total_mass(self) -> Any:
        """The mass that moves [kg]."""
        return self.mass

    def contact_velocity(self, v: Any) -> Any:
        """Velocity at the contact [m/s]."""
        return v

    @property
    def notes(self) -> list[str]:
        """Remarks on these numbers that are no errors, such as a LuGre law that is not passive."""
        law_notes = getattr(self.friction, "notes", None)
        return [] if law_notes is None else law_notes(self.load)

    def to_toml(self) -> str:
        """The mechanism as TOML text, every digit kept; `from_toml` reads it back."""
        return to_toml(self, "mechanism")

    @classmethod
    def from_toml(cls, text: str) -> Any:
        """A mechanism of this kind from the TOML text of `to_toml`."""
        return from_toml(cls, text, "mechanism")

    def _repr_html_(self) -> str:
        return record_html(self)
