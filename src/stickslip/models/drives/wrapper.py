"""Base class of drives that change another drive and pass on the rest."""

from __future__ import annotations

from operator import attrgetter
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.models.drives.drive import PeriodicDrive
from stickslip.models.drives.drive_adapter import NEEDS, drive_of, lacking


def _adapted(name: str, about: str) -> Any:
    """A property that the drive inside has, or the default of one that does not say."""
    return property(lambda self: getattr(drive_of(self.drive), name), doc=about)


class Around(PeriodicDrive):
    """Base of the drives that modify one property of another `drive`."""

    drive: Any

    period = property(attrgetter("drive.period"), doc="Period of the drive [s].")
    stroke = property(attrgetter("drive.stroke"), doc="Stroke along the track [m].")
    breaks = _adapted("breaks", "Where the acceleration is not smooth [s].")
    jumps = _adapted("jumps", "Jumps of the relative velocity: (instant [s], jump [m/s]).")
    smooth = _adapted("smooth", "Whether its equations are one formula for all times.")
    velocity_scale = _adapted("velocity_scale", "A typical relative velocity along the track [m/s].")
    specific_energy = _adapted("specific_energy", "Largest kinetic energy of the relative motion along the track per inner mass [J/kg].")
    vertical_acceleration = _adapted("vertical_acceleration", "That of the drive; None if it has none.")
    notes = _adapted("notes", "Remarks of the drive.")

    def _check(self, problems: Problems) -> None:
        if lacking(self.drive):
            problems.add(
                f"drive = {self.drive!r}; allowed is a drive, an object with {', '.join(NEEDS)}; "
                "type for example drive=ss.Harmonic(amplitude=5e-4, omega=205.46)"
            )

    def _of(self, what: str, t: Numeric) -> Any:
        """Position, velocity or acceleration: of the drive, unless a subclass changes it."""
        return getattr(self.drive, what)(t)

    def position(self, t: Numeric) -> Any:
        """Relative position along the track [m]."""
        return self._of("position", t)

    def velocity(self, t: Numeric) -> Any:
        """Relative velocity along the track [m/s]."""
        return self._of("velocity", t)

    def acceleration(self, t: Numeric) -> Any:
        """Relative acceleration along the track [m/s^2]."""
        return self._of("acceleration", t)
