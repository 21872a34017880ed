"""Readings of the text: where the paper leaves open what was computed, each way to read it, as data and as robots."""

from __future__ import annotations

import dataclasses
import itertools
from dataclasses import dataclass
from typing import Any

from stickslip.show.paper.cases import rig

__all__ = ["PRINTED_READING", "READINGS", "STATED", "Reading"]

#: Laws of the preset by the coefficient at which rest ends.
_LAWS = {"μ": "coulomb", "f₀": "coulomb-static"}
_COEFFICIENTS = ("mu_plus", "mu_minus", "f_plus", "f_minus")


@dataclass(frozen=True)
class Reading:
    """One way to read the paper.

    Parameters
    ----------
    breakaway : str
        "μ", as Eq. 2.4 is printed: rest ends at the kinetic coefficient; or "f₀": at the measured static one.
    weight : str
        "M+m", as in Eqs 2.4 and 2.6, or "M", as Eq. 3.8 is printed: the weight by which coefficients are multiplied.
    """

    breakaway: str
    weight: str

    @property
    def name(self) -> str:
        """The reading in words.

        Examples
        --------
        >>> STATED.name, PRINTED_READING.name
        ('break-away at f₀, weight (M+m)g', 'break-away at μ, weight (M+m)g')
        """
        return f"break-away at {self.breakaway}, weight {'(M+m)g' if self.weight == 'M+m' else 'Mg'}"

    def coulomb(self, case: Any, **arguments: Any) -> Any:
        """The robot of a case with Coulomb friction under this reading."""
        return self._weighed(rig(case, law=_LAWS[self.breakaway], **arguments))

    def lugre(self, case: Any, **arguments: Any) -> Any:
        """The robot of a case with LuGre friction under this reading; break-away belongs to the law itself."""
        return self._weighed(rig(case, **arguments))

    def _weighed(self, robot: Any) -> Any:
        if self.weight == "M+m":
            return robot
        share, law = robot.body_mass / robot.total_mass, robot.friction
        scaled = {n: share * getattr(law, n) for n in _COEFFICIENTS if getattr(law, n) is not None}
        return dataclasses.replace(robot, friction=dataclasses.replace(law, **scaled))


READINGS = tuple(Reading(breakaway, weight) for weight, breakaway in itertools.product(("M+m", "M"), ("f₀", "μ")))
#: The reading under which most printed results come out, and the one of Eq. 2.4 to the letter.
STATED, PRINTED_READING = READINGS[:2]
