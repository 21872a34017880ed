"""A force that is switched on and off."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import where, within
from stickslip.basics.quantities import PERIOD, Rule, quantity
from stickslip.models.drives.force import Force


@dataclass(frozen=True, eq=False)
class Pulses(Force):
    r"""A force on the inner mass of a `Forced` drive that is on for a part of each period, as in pulse-width modulation.

    .. math:: F(t) = A \text{ for } 0 \le t < d\,T, \quad 0 \text{ for } d\,T \le t < T

    Parameters
    ----------
    amplitude : float
        A, while it is on [N].
    period : float
        T [s].
    duty : float
        d, the fraction of the period for which it is on, between 0 and 1.

    Examples
    --------
    >>> force = Pulses(amplitude=1.25, period=0.06, duty=0.35)
    >>> force.at(0.0), force.at(0.0209), force.at(0.0211), force.at(0.06), [round(s, 12) for s in force.breaks]
    (1.25, 1.25, 0.0, 1.25, [0.021])
    """

    amplitude: float = field(metadata=quantity("force on the inner mass", "N", "A", example=1.25))
    period: float = field(metadata=PERIOD | {"label": "period of the force", "example": 0.06})
    duty: float = field(
        metadata=quantity(
            "part of the period for which the force is on",
            "1",
            "d",
            example=0.35,
            rule=Rule(lambda x: (x > 0) & (x < 1), ""),
            allowed="between 0 and 1, the part of the period for which the force is on",
        )
    )

    @property
    def breaks(self) -> tuple[Any, ...]:
        """Instant at which it is switched off [s]."""
        return (self.duty * self.period,)

    def at(self, t: Numeric) -> Any:
        """The force [N]; at a switching instant the value after it."""
        return where(within(t, self.period) < self.duty * self.period, self.amplitude, 0.0)

    @classmethod
    def example(cls) -> Pulses:
        """The pulses of a capsubot."""
        return cls(amplitude=1.25, period=0.06, duty=0.35)
