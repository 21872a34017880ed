"""What a drive of a user's own may leave out, with its one default."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from stickslip.contracts import Drive
from stickslip.maths import maximum

__all__ = ["NEEDS", "DriveAdapter", "drive_of", "lacking", "needs_of"]

#: What a drive has to say; the rest has its default in `DriveAdapter`.
NEEDS = ("position", "velocity", "acceleration", "period")
_SAMPLES = 64  # instants of a period at which a drive that does not name its velocity scale is asked for its velocity


@dataclass(frozen=True, eq=False)
class DriveAdapter:
    """A drive, asked for what not every drive says.

    Examples
    --------
    >>> from stickslip.drives import Harmonic
    >>> drive = drive_of(Harmonic(amplitude=5e-4, omega=200.0))
    >>> drive.velocity_scale, drive.breaks, drive.vertical_acceleration is None
    (0.1, (), True)
    """

    drive: Any

    @property
    def breaks(self) -> Any:
        """Instants in (0, period) at which its acceleration is not smooth [s]."""
        return getattr(self.drive, "breaks", ())

    @property
    def jumps(self) -> Any:
        """Jumps of the relative velocity: (instant in [0, period) [s], jump [m/s])."""
        return getattr(self.drive, "jumps", ())

    @property
    def smooth(self) -> bool:
        """Whether its equations are one formula for all times, and not for one period only; of a drive that does not say, False."""
        return bool(getattr(self.drive, "smooth", False))

    @property
    def vertical_acceleration(self) -> Callable[[Any], Any] | None:
        """Relative acceleration of the inner mass across the track [m/s^2], as a function of time; None where it moves along only."""
        return getattr(self.drive, "vertical_acceleration", None)

    @property
    def velocity_scale(self) -> float:
        """A relative velocity of the size of the largest one [m/s]: what the drive says itself, or the largest of a few instants.

        Errors are measured against it. Of a sum of harmonics it is the root of 2 times the r.m.s., which is not the largest velocity.
        """
        named = getattr(self.drive, "velocity_scale", None)
        if named is not None:
            return named
        largest = abs(self.drive.velocity(0.0))
        for k in range(1, _SAMPLES):
            largest = maximum(largest, abs(self.drive.velocity(self.drive.period * (k / _SAMPLES))))
        return largest

    @property
    def stroke(self) -> Any:
        """From end to end [m], where it says so itself; None where it does not."""
        return getattr(self.drive, "stroke", None)

    @property
    def specific_energy(self) -> Any:
        """Largest kinetic energy of the relative motion along the track for each kilogram of the inner mass [J/kg]."""
        named = getattr(self.drive, "specific_energy", None)
        return 0.5 * self.velocity_scale**2 if named is None else named

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks on where its numbers come from."""
        return tuple(getattr(self.drive, "notes", None) or ())


def drive_of(drive: Drive) -> DriveAdapter:
    """A drive, to be asked for what not every drive says."""
    return DriveAdapter(drive)


def needs_of(drive: Any) -> tuple[str, ...]:
    """What a drive has to say: its motion, or, if the inner mass moves by itself, the machine that the robot is then."""
    return ("period", "machine") if callable(getattr(drive, "machine", None)) else NEEDS


def lacking(part: Any, needs: tuple[str, ...] = NEEDS) -> list[str]:
    """What an object lacks of a drive, or of another part of a robot; all of it for a class."""
    return [name for name in needs if isinstance(part, type) or not hasattr(part, name)]
