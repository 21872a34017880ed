"""The harmonic drive of the paper."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import ArrayLike, Numeric
from stickslip.basics.maths import cos, pi, sin
from stickslip.basics.quantities import AMPLITUDE, OMEGA, PHASE
from stickslip.models.drives.drive import Drive, OfFrequency, Remarked, angular_frequency, taken

_KNOWN = "the amplitude was found for"


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Harmonic(OfFrequency, Remarked, Drive):
    r"""Relative motion of the inner mass, Eq. 2.2: :math:`\xi(t) = A \sin(\omega t + \varphi)`.

    Parameters
    ----------
    amplitude : float
        Amplitude A of the relative motion [m].
    omega : float
        Angular frequency [rad/s]. Give exactly one of `omega` and `frequency`.
    frequency : float
        Frequency [Hz].
    phase : float, optional
        Phase :math:`\varphi` at the start of a run [rad]; zero if left out. It sets the phase difference between several inner masses.
    notes : tuple of str, optional
        Remarks on where these numbers come from; `Robot.notes` repeats them. A copy with another amplitude has none; a copy with another
        frequency has a remark that the amplitude, such as that of a `PiezoBeam`, was found for the former one.

    Examples
    --------
    >>> drive = Harmonic(amplitude=5e-4, frequency=32.7)
    >>> round(drive.omega, 6), round(drive.period, 9)
    (205.46016, 0.030581040)
    """

    amplitude: float = field(metadata=AMPLITUDE)
    omega: float = field(metadata=OMEGA)
    notes: tuple[str, ...] | None = None
    phase: float | None = field(default=None, metadata=PHASE)

    smooth: ClassVar[bool] = True

    def __init__(self, amplitude: Any, omega: Any = None, frequency: Any = None, notes: Any = None, phase: Any = None):
        omega = angular_frequency("Harmonic", omega, frequency, "type for example omega=205.46")
        taken(self, amplitude=amplitude, omega=omega, notes=notes, phase=phase)

    def replace(self, changes: dict[str, Any] | None = None, /, **fields: Any) -> Any:
        """A copy with some fields changed; its remarks are about what it keeps of the old ones."""
        changed = {**(changes or {}), **fields}
        same = self._of_another_frequency() if "omega" in changed else self.notes
        return super().replace({"notes": None if "amplitude" in changed else same, **changed})

    def _of_another_frequency(self) -> tuple[str, ...] | None:
        """The remark on an amplitude that was found for another frequency: this one, or the one that it is said of already."""
        if not self.notes or self.notes[0].startswith(_KNOWN):
            return self.notes
        return (
            f"{_KNOWN} {_range(self.frequency)} Hz and is kept at another frequency, where the same actuator has another amplitude (near a "
            "resonance by a multiple); make the drive anew, such as drive=PiezoBeam().drive(voltage=20, frequency=32.7)",
        )

    @property
    def velocity_scale(self) -> float:
        """A omega, the largest relative velocity [m/s]."""
        return self.amplitude * self.omega

    @property
    def stroke(self) -> float:
        """2 A, from end to end [m]."""
        return 2 * self.amplitude

    def position(self, t: Numeric) -> Any:
        """Relative position xi(t) [m] (Eq. 2.2)."""
        return self.amplitude * self._sine(t)

    def velocity(self, t: Numeric) -> Any:
        """Relative velocity of the inner mass [m/s]."""
        return self.amplitude * self.omega * self._cosine(t)

    def acceleration(self, t: Numeric) -> Any:
        """Relative acceleration of the inner mass [m/s^2]."""
        return -self.amplitude * self.omega**2 * self._sine(t)

    def _sine(self, t: Numeric) -> Any:
        """sin(omega t + phase), as a sum of which the second term vanishes with the phase."""
        wave = sin(self.omega * t)
        return wave if self.phase is None else wave * cos(self.phase) + cos(self.omega * t) * sin(self.phase)

    def _cosine(self, t: Numeric) -> Any:
        wave = cos(self.omega * t)
        return wave if self.phase is None else wave * cos(self.phase) - sin(self.omega * t) * sin(self.phase)

    @classmethod
    def example(cls) -> Harmonic:
        """The drive of the paper, with the amplitude inferred for its first track."""
        return cls(amplitude=5.56e-4, omega=65.4 * pi)


def _range(value: ArrayLike) -> str:
    """A number, or the smallest and the largest of an array."""
    import numpy as np

    return " to ".join(dict.fromkeys(f"{end:.5g}" for end in (np.min(value), np.max(value))))
