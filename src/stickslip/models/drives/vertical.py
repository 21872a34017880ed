"""Vertical vibration beside the horizontal one: the normal force rises and falls."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.maths import pi, sin
from stickslip.basics.quantities import PHASE, at_least, quantity
from stickslip.models.drives.drive_adapter import drive_of
from stickslip.models.drives.harmonic import Harmonic
from stickslip.models.drives.wrapper import Around


@dataclass(frozen=True, eq=False)
class VerticalVibration(Around):
    r"""A drive whose inner mass also moves up and down: :math:`\eta(t) = B \sin(n \omega t + \varphi)`, upwards positive.

    .. math:: N(t) = (M+m)\,g\cos\theta + m\,\ddot\eta(t)

    The load is largest where the inner mass is lowest. Where it falls to zero the contact is lost, and a run ends there with that status: a
    hopping robot has another equation of motion.

    Parameters
    ----------
    drive : any drive
        The motion along the track.
    amplitude : float
        Amplitude B of the vertical motion [m].
    phase : float
        Phase relative to the start of the drive's period [rad]. To have :math:`N = W (1 + b \sin(\omega t + \varphi))` take phase
        :math:`\varphi + \pi`.
    harmonic : int
        Number of vertical vibrations in one period of the drive.

    Examples
    --------
    >>> drive = VerticalVibration(Harmonic(amplitude=5e-4, omega=200.0), amplitude=1e-4, phase=pi)
    >>> round(drive.vertical_acceleration(drive.period / 4), 9)
    4.0
    """

    drive: Any
    amplitude: float = field(
        metadata=quantity("amplitude of the vertical motion", "m", "B", example=1e-4, rule=at_least(0.0), range=(0.0, 5e-4), shown="mm")
    )
    phase: float = field(default=0.0, metadata=PHASE | {"label": "phase of the vertical motion"})
    harmonic: int = 1

    def _check(self, problems: Problems) -> None:
        super()._check(problems)
        problems.whole("harmonic", self.harmonic, 1, example=1)

    def vertical_position(self, t: Numeric) -> Any:
        """Relative position of the inner mass across the track [m]."""
        return self.amplitude * sin(self.harmonic * self.omega * t + self.phase)

    def vertical_acceleration(self, t: Numeric) -> Any:
        """Relative acceleration of the inner mass across the track [m/s^2]."""
        omega, inner = self.harmonic * self.omega, drive_of(self.drive).vertical_acceleration
        own = -self.amplitude * omega**2 * sin(omega * t + self.phase)
        return own if inner is None else own + inner(t)

    @classmethod
    def example(cls) -> VerticalVibration:
        """The paper's drive, and a load that rises and falls by a twentieth."""
        return cls(Harmonic.example(), amplitude=1e-4, phase=0.5 * pi)
