"""A drive that is somewhere else in its period when the robot starts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.fields import Record

__all__ = ["ShiftedDrive"]


@dataclass(frozen=True, eq=False)
class ShiftedDrive(Record):
    """A drive that is a part of its period ahead: what starts at another phase is a start at t = 0 of this one.

    Parameters
    ----------
    drive : Harmonic or any smooth drive
        The drive itself.
    phase : float
        How far it is ahead, in drive periods.

    Examples
    --------
    >>> import stickslip as ss
    >>> ahead = ShiftedDrive(ss.Harmonic(amplitude=1e-3, omega=200.0), 0.25)
    >>> round(ahead.position(0.0), 9), round(ahead.period, 9)
    (0.001, 0.031415927)
    """

    drive: Any
    phase: float

    @property
    def period(self) -> Any:
        """Period [s]."""
        return self.drive.period

    @property
    def omega(self) -> Any:
        """Angular frequency [rad/s]."""
        return self.drive.omega

    @property
    def amplitude(self) -> Any:
        """Amplitude of the relative motion [m]."""
        return self.drive.amplitude

    @property
    def velocity_scale(self) -> Any:
        """A typical relative velocity [m/s]."""
        return self.drive.velocity_scale

    def _ahead(self, t: Any) -> Any:
        return t + self.phase * self.drive.period

    def position(self, t: Any) -> Any:
        """Relative position [m]."""
        return self.drive.position(self._ahead(t))

    def velocity(self, t: Any) -> Any:
        """Relative velocity [m/s]."""
        return self.drive.velocity(self._ahead(t))

    def acceleration(self, t: Any) -> Any:
        """Relative acceleration [m/s^2]."""
        return self.drive.acceleration(self._ahead(t))
