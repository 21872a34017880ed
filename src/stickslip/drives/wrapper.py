"""A drive around a drive: what is not changed is handed through."""

from __future__ import annotations

from typing import Any

from stickslip.drives.drive import Drive
from stickslip.drives.drive_adapter import NEEDS, drive_of, lacking
from stickslip.errors import Problems
from stickslip.maths import pi

__all__ = ["Around"]


class Around(Drive):
    """Base of the drives that modify one property of another `drive`."""

    drive: Any

    def _check(self, problems: Problems) -> None:
        if lacking(self.drive):
            problems.add(
                f"drive = {self.drive!r}; allowed is a drive, an object with {', '.join(NEEDS)}; "
                "type for example drive=ss.Harmonic(amplitude=5e-4, omega=205.46)"
            )

    @property
    def period(self) -> float:
        """Period of the drive [s]."""
        return self.drive.period

    @property
    def omega(self) -> float:
        """Angular frequency 2 pi / T [rad/s]."""
        return 2 * pi / self.drive.period

    @property
    def breaks(self) -> Any:
        """Where the acceleration is not smooth [s]."""
        return drive_of(self.drive).breaks

    @property
    def smooth(self) -> bool:
        """Whether its equations are one formula for all times."""
        return drive_of(self.drive).smooth

    @property
    def jumps(self) -> Any:
        """Jumps of the relative velocity: (instant [s], jump [m/s])."""
        return drive_of(self.drive).jumps

    @property
    def velocity_scale(self) -> float:
        """A typical relative velocity along the track [m/s]."""
        return drive_of(self.drive).velocity_scale

    @property
    def specific_energy(self) -> Any:
        """Largest kinetic energy of the relative motion along the track for each kilogram of the inner mass [J/kg]."""
        return drive_of(self.drive).specific_energy

    @property
    def stroke(self) -> float:
        """Stroke along the track [m]."""
        return self.drive.stroke

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks of the drive."""
        return drive_of(self.drive).notes

    def position(self, t: Any) -> Any:
        """Relative position along the track [m]."""
        return self.drive.position(t)

    def velocity(self, t: Any) -> Any:
        """Relative velocity along the track [m/s]."""
        return self.drive.velocity(t)

    def acceleration(self, t: Any) -> Any:
        """Relative acceleration along the track [m/s^2]."""
        return self.drive.acceleration(t)
