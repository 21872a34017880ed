"""The same motion, so much of a period earlier."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.drives.adapter import drive_of
from stickslip.drives.around import Around
from stickslip.drives.harmonic import Harmonic
from stickslip.maths import pi, wrapped

__all__ = ["Shifted"]


@dataclass(frozen=True, eq=False)
class Shifted(Around):
    r"""A drive ahead of itself: :math:`\xi(t + \varphi T/2\pi)`.

    Parameters
    ----------
    drive : any drive
        What is shifted.
    phase : float
        How far it is ahead [rad], from -2 pi to 2 pi.

    Examples
    --------
    >>> import math
    >>> drive = Shifted(Harmonic(amplitude=1.0, omega=2.0), phase=math.pi / 2)
    >>> round(drive.position(0.0), 12)
    1.0
    """

    drive: Any
    phase: Any = 0.0

    def _time(self, t: Any) -> Any:
        return t + self.phase * self.drive.period / (2 * pi)

    def _begun(self, instant: Any) -> Any:
        """When an instant of the drive comes, in [0, period)."""
        period = self.drive.period
        return wrapped(instant - self.phase * period / (2 * pi), period)

    @property
    def breaks(self) -> Any:
        """Instants in (0, period) at which its acceleration is not smooth [s]; also where the drive's own period begins."""
        own = drive_of(self.drive).breaks
        return tuple(self._begun(s) for s in (0.0, *own)) if own else ()

    @property
    def jumps(self) -> Any:
        """Jumps of the relative velocity: (instant [s], jump [m/s])."""
        return tuple((self._begun(instant), jump) for instant, jump in drive_of(self.drive).jumps)

    @property
    def vertical_acceleration(self) -> Any:
        """That of the drive, as much ahead; None if it has none."""
        lift = drive_of(self.drive).vertical_acceleration
        return None if lift is None else lambda t: lift(self._time(t))

    def position(self, t: Any) -> Any:
        """Relative position [m]."""
        return self.drive.position(self._time(t))

    def velocity(self, t: Any) -> Any:
        """Relative velocity [m/s]."""
        return self.drive.velocity(self._time(t))

    def acceleration(self, t: Any) -> Any:
        """Relative acceleration [m/s^2]."""
        return self.drive.acceleration(self._time(t))

    @classmethod
    def example(cls) -> Shifted:
        """A sine that is a quarter of a period ahead."""
        return cls(Harmonic.example(), phase=0.5 * pi)
