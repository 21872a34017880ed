"""A sawtooth: slowly one way, fast back."""

from __future__ import annotations

from dataclasses import dataclass, field
from operator import attrgetter

from stickslip.basics.quantities import STROKE, positive, quantity
from stickslip.models.drives.two_phase import Wedge


@dataclass(frozen=True, eq=False)
class Sawtooth(Wedge):
    r"""Forwards by the stroke at one speed, back at another, as the voltage of a stick-slip stage.

    .. math:: \dot\xi = L/t_r \text{ for the time } t_r, \quad -L/t_f \text{ for the time } t_f

    It begins with the rise. The velocity jumps at the turning points, and the jumps are treated as impulses. It is a `TwoPhase` drive given
    by its durations.

    Parameters
    ----------
    stroke : float
        From end to end [m].
    rise, fall : float
        Durations of the motion forwards and back [s].

    Examples
    --------
    >>> saw = Sawtooth(stroke=5e-6, rise=0.95e-3, fall=0.05e-3)
    >>> round(1 / saw.period), round(saw.velocity(0.5e-3), 9), [round(jump, 9) for _, jump in saw.jumps]
    (1000, 0.005263158, [0.105263158, -0.105263158])
    """

    stroke: float = field(metadata=STROKE)
    rise: float = field(metadata=quantity("duration of the rise", "s", "t_{r}", example=0.2, rule=positive, range=(0.005, 0.5), shown="ms"))
    fall: float = field(
        metadata=quantity("duration of the fall", "s", "t_{f}", example=0.025, rule=positive, range=(0.005, 0.5), shown="ms")
    )

    t1 = property(attrgetter("rise"), doc="Duration of the rise [s].")
    t2 = property(attrgetter("fall"), doc="Duration of the fall [s].")

    @property
    def u1(self) -> float:
        """Speed forwards [m/s]."""
        return self.stroke / self.rise

    @property
    def u2(self) -> float:
        """Speed back [m/s]."""
        return self.stroke / self.fall

    @classmethod
    def example(cls) -> Sawtooth:
        """One of a piezo stage: 5 micrometres, a thousand times a second."""
        return cls(stroke=5e-6, rise=0.95e-3, fall=0.05e-3)
