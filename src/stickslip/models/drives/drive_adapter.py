"""Optional methods of a user-defined drive, with one default for each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.basics.contracts import Drive, Numeric
from stickslip.basics.errors import StickslipError
from stickslip.basics.maths import is_symbol, maximum

#: What a drive has to say; the rest has its default in `DriveAdapter`.
NEEDS = ("position", "velocity", "acceleration", "period")
_SAMPLES = 64  # instants of a period at which a drive that does not name its velocity scale is asked for its velocity


def _said(name: str, otherwise: Any, about: str) -> Any:
    """A property of a drive that it may leave out."""
    return property(lambda self: getattr(self.drive, name, otherwise), doc=about)


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

    breaks = _said("breaks", (), "Instants in (0, period) at which its acceleration is not smooth [s].")
    jumps = _said("jumps", (), "Jumps of the relative velocity: (instant in [0, period) [s], jump [m/s]).")
    smooth = _said("smooth", False, "Whether its equations are one formula for all times, and not for one period only.")
    vertical_acceleration = _said("vertical_acceleration", None, "Relative acceleration of the inner mass across the track [m/s^2].")
    stroke = _said("stroke", None, "From end to end [m].")

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
    def specific_energy(self) -> Any:
        """Largest kinetic energy of the relative motion along the track for each kilogram of the inner mass [J/kg]."""
        named = getattr(self.drive, "specific_energy", None)
        return 0.5 * self.velocity_scale**2 if named is None else named

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks on where its numbers come from, and on a motion that no actuator makes."""
        return (*(getattr(self.drive, "notes", None) or ()), *unlikely(self))


#: Beyond this relative velocity [m/s] we ask whether a unit was mistaken: piezo actuators, voice coils, cranks and shakers stay below.
_FASTEST = 10.0
_EARTH = 9.81  # [m/s^2]
#: How remarks on numbers begin that are likely to be in another unit.
MISTAKEN = "is a unit mistaken?"
#: First words of the remark of a robot whose incline went with the law that had it.
LEVEL = "the track is level:"


def unlikely(adapter: DriveAdapter) -> tuple[str, ...]:
    """A remark on a motion that is faster than actuators are, as one is whose millimetres were typed as metres.

    Examples
    --------
    >>> from stickslip.drives import Harmonic
    >>> unlikely(drive_of(Harmonic(amplitude="0.55 mm", omega=205.0)))
    ()
    >>> print(*unlikely(drive_of(Harmonic(amplitude=0.55, omega=205.0))))
    is a unit mistaken? This drive has a stroke of 1.1 m, reaches 113 m/s and 2.36e+03 g; lengths are in m, and amplitude="0.55 mm" ...
    """
    import numpy as np

    try:
        speeds = adapter.velocity_scale
    except StickslipError:  # of a drive that does not say how the mass moves
        return ()
    if is_symbol(speeds) or not np.any(np.asarray(speeds) > _FASTEST):
        return ()

    drive = adapter.drive
    t = [drive.period * ((k + 0.5) / _SAMPLES) for k in range(_SAMPLES)]
    ways, accelerations = (np.array([one(s) + 0.0 * drive.period for s in t]) for one in (drive.position, drive.acceleration))
    stroke, speed = np.max(np.ptp(ways, axis=0)), np.max(np.asarray(speeds))
    extent = f"has a stroke of {_digits(stroke)} m, reaches {_digits(speed)} m/s and {_digits(np.max(abs(accelerations)) / _EARTH)} g"
    return (f'{MISTAKEN} This drive {extent}; lengths are in m, and amplitude="0.55 mm" is allowed',)


def _digits(value: Numeric) -> str:
    return f"{float(value):.3g}"


def drive_of(drive: Drive) -> DriveAdapter:
    """A drive, to be asked for what not every drive says."""
    return DriveAdapter(drive)


def needs_of(drive: Drive) -> tuple[str, ...]:
    """Methods that a drive must have: its motion or, if the inner mass moves by itself, the machine that the robot becomes."""
    return ("period", "machine") if callable(getattr(drive, "machine", None)) else NEEDS


def lacking(part: Any, needs: tuple[str, ...] = NEEDS) -> list[str]:
    """Names of the methods that an object lacks as a drive, or as another part of a robot; all of them for a class."""
    return [name for name in needs if isinstance(part, type) or not hasattr(part, name)]
