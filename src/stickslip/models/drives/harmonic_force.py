"""A harmonic force on an inner mass."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import pi, sin
from stickslip.basics.quantities import OMEGA, PHASE, quantity
from stickslip.models.drives.drive import OfFrequency, angular_frequency, taken
from stickslip.models.drives.force import Force


@dataclass(frozen=True, eq=False, init=False, repr=False)
class HarmonicForce(OfFrequency, Force):
    r"""A force on the inner mass of a `Forced` drive: :math:`F(t) = A \sin(\omega t + \varphi)`.

    Parameters
    ----------
    amplitude : float
        A [N].
    omega : float
        Angular frequency [rad/s]. Give exactly one of `omega` and `frequency`.
    phase : float, optional
        Phase at t = 0 [rad]; pi/2 makes a cosine.
    frequency : float
        Frequency [Hz].

    Examples
    --------
    >>> force = HarmonicForce(amplitude=1.5, frequency=1 / 0.06, phase=pi / 2)
    >>> round(force.period, 12), round(force.at(0.0), 12)
    (0.06, 1.5)
    """

    amplitude: float = field(metadata=quantity("force on the inner mass", "N", "A", example=1.5))
    omega: float = field(metadata=OMEGA | {"example": 104.72})
    phase: float = field(default=0.0, metadata=PHASE | {"label": "phase of the force"})

    def __init__(self, amplitude: Any, omega: Any = None, phase: Any = 0.0, frequency: Any = None):
        omega = angular_frequency("HarmonicForce", omega, frequency, "type for example omega=104.72")
        taken(self, amplitude=amplitude, omega=omega, phase=phase)

    def at(self, t: Numeric) -> Any:
        """The force [N]."""
        return self.amplitude * sin(self.omega * t + self.phase)

    @classmethod
    def example(cls) -> HarmonicForce:
        """A force that shakes a capsubot of some hundred grams."""
        return cls(amplitude=1.5, omega=2 * pi / 0.06)
