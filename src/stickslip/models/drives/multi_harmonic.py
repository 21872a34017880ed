"""A drive of several harmonics."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.errors import InputError, Problems
from stickslip.basics.maths import cos, pi, sin
from stickslip.basics.quantities import OMEGA, quantity
from stickslip.models.drives.drive import OfFrequency, angular_frequency, taken
from stickslip.models.drives.fourier import FourierDrive

_EXAMPLE = "type for example MultiHarmonic(omega=205.0, amplitudes=(5e-4, 1e-4), phases=(0.0, 1.57))"


@dataclass(frozen=True, eq=False, init=False, repr=False)
class MultiHarmonic(OfFrequency, FourierDrive):
    r"""Relative motion :math:`\xi(t) = A_1 \sin(\omega t + \varphi_1) + A_2 \sin(2 \omega t + \varphi_2) + \dots`.

    A second harmonic makes the motion asymmetric, so that even a robot with the same friction in both directions moves.

    Parameters
    ----------
    omega : float
        Angular frequency of the first harmonic [rad/s]. Give exactly one of `omega` and `frequency`.
    amplitudes : tuple of float
        Amplitudes A_1, A_2, … of the harmonics [m]; 0 leaves one out.
    phases : tuple of float
        Phases, one for each amplitude [rad]; all zero if left out.
    frequency : float
        Frequency of the first harmonic [Hz].

    Examples
    --------
    >>> drive = MultiHarmonic(omega=200.0, amplitudes=(4e-4, 1e-4), phases=(0.0, pi / 2))
    >>> round(drive.stroke, 6), round(drive.specific_energy, 6)
    (0.0008, 0.0054)
    """

    omega: float = field(metadata=OMEGA)
    amplitudes: tuple[float, ...] = field(metadata=quantity("amplitude of a harmonic", "m", "A", example=(5e-4, 1e-4)))
    phases: tuple[float, ...] = field(metadata=quantity("phase of a harmonic", "rad", r"\varphi", example=(0.0, 1.57)))

    def __init__(self, omega: Any = None, amplitudes: Any = None, phases: Any = None, frequency: Any = None):
        omega = angular_frequency("MultiHarmonic", omega, frequency, _EXAMPLE)
        if amplitudes is None:
            raise InputError("MultiHarmonic", [f"amplitudes is missing; {_EXAMPLE}"])
        zeros = (0.0,) * len(amplitudes) if hasattr(amplitudes, "__len__") else ()  # what is not a tuple is reported
        taken(self, omega=omega, amplitudes=amplitudes, phases=zeros if phases is None else phases)

    def _check(self, problems: Problems) -> None:
        amplitudes, phases = self.amplitudes, self.phases
        if isinstance(amplitudes, tuple) and not amplitudes:
            problems.add(f"amplitudes is empty; allowed is at least one; {_EXAMPLE}")
        elif isinstance(amplitudes, tuple) and isinstance(phases, tuple) and len(phases) != len(amplitudes):
            problems.add(f"{len(phases)} phases for {len(amplitudes)} amplitudes; allowed is one for each; {_EXAMPLE}")

    @property
    def coefficients(self) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """Coefficients of cos(k omega t) and of sin(k omega t) [m]."""
        pairs = tuple(zip(self.amplitudes, self.phases, strict=True))
        return tuple(A * sin(p) for A, p in pairs), tuple(A * cos(p) for A, p in pairs)

    @classmethod
    def example(cls) -> MultiHarmonic:
        """An example that moves the paper's robot forwards."""
        return cls(omega=205.0, amplitudes=(5e-4, 1e-4), phases=(0.0, -0.5 * pi))
