"""Plain masses in a row."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from stickslip.basics.errors import Problems
from stickslip.basics.fields import Frozen
from stickslip.basics.quantities import MASS
from stickslip.models.forces import check_law
from stickslip.models.friction.law_adapter import mirrored_law as mirrored_law


@dataclass(frozen=True, eq=False)
class Bodies(Frozen):
    """Plain masses in a row, each with a contact, such as the segments of a worm.

    Parameters
    ----------
    mass : float or tuple of float
        Mass of each body [kg]; a tuple has one for each, from head to tail.
    count : int
        Number of bodies, two or more.
    friction : Coulomb or LuGre or any law
        Friction law of each body on the track.

    Examples
    --------
    >>> import stickslip as ss
    >>> three = Bodies(mass=0.05, count=3, friction=ss.Coulomb(mu_plus=0.1, mu_minus=0.3))
    >>> three.masses, Bodies(mass=(0.1, 0.05), count=2, friction=three.friction).masses
    ((0.05, 0.05, 0.05), (0.1, 0.05))
    """

    mass: float | tuple[float, ...] = field(metadata=MASS)
    count: int
    friction: Any

    def _check(self, problems: Problems) -> None:
        problems.whole("count", self.count, 2, example=3, what=" of bodies", most=64)
        if isinstance(self.mass, tuple) and not problems.mistakes and len(self.mass) != self.count:
            mistake = f"mass has {len(self.mass)} numbers for {self.count} bodies; allowed is one number, or one for each"
            problems.add(f"{mistake}; type mass={(0.05,) * self.count}")
        check_law(self.friction, problems)

    @property
    def masses(self) -> tuple[Any, ...]:
        """Mass of each body [kg]."""
        return self.mass if isinstance(self.mass, tuple) else (self.mass,) * self.count

    def mirrored(self) -> Bodies:
        """The row with forwards and backwards exchanged: the last body is the head."""
        return replace(self, mass=self.mass[::-1] if isinstance(self.mass, tuple) else self.mass, friction=mirrored_law(self.friction))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the bodies, from head to tail."""
        return tuple(f"body {i + 1}" for i in range(self.count))

    @classmethod
    def example(cls) -> Bodies:
        """Three masses that slide forwards more easily than back."""
        from stickslip.models.friction import Coulomb

        return cls(mass=0.05, count=3, friction=Coulomb(mu_plus=0.1, mu_minus=0.3))
