"""A robot whose drive is somewhere else in its period when it starts, and with it all that keeps the drive's time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.drives.adapter import drive_of
from stickslip.drives.around import Around
from stickslip.dynamics.duals import variables
from stickslip.errors import InputError, Problems
from stickslip.fields import Frozen
from stickslip.machine import machine_of
from stickslip.mechanics import normal_load
from stickslip.tracks import grip_of

__all__ = ["ShiftedDrive", "ShiftedTrack", "shifted"]

_LOOKS = 64  # instants of a period at which a function of time is compared with itself a period later
_SAME = 1e-9  # of its largest value


@dataclass(frozen=True, eq=False)
class ShiftedDrive(Around):
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
    def vertical_acceleration(self) -> Any:
        """That of the drive, as much ahead, or None if it has none."""
        lift = drive_of(self.drive).vertical_acceleration
        return None if lift is None else lambda t: lift(self._ahead(t))

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


@dataclass(frozen=True, eq=False)
class ShiftedTrack(Frozen):
    """A track whose friction varies in time, as much ahead as the drive.

    Parameters
    ----------
    track : VaryingFriction or any track with a grip
        The track itself.
    phase : float
        How far it is ahead, in drive periods.

    Examples
    --------
    >>> import stickslip as ss
    >>> round(ShiftedTrack(ss.VaryingFriction(ss.Level(), depth=0.5), 0.25).grip(0.0, period=1.0), 9)
    1.5
    """

    track: Any
    phase: float

    def across(self, gravity: Any) -> Any:
        """Gravity that presses the body on the track [m/s^2]."""
        return self.track.across(gravity)

    def along(self, gravity: Any) -> Any:
        """Gravity that pulls the body forwards [m/s^2]."""
        return self.track.along(gravity)

    def grip(self, t: Any, period: Any) -> Any:
        """Factor on the friction at a time, for a drive of this period [-]."""
        return self.track.grip(t + self.phase * period, period)


def shifted(what: str, model: Any, phase: Any) -> Any:
    """The robots whose drive is at a phase when they start; `InputError` where the engine could not follow one over its period's end.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)
    >>> later = shifted("basins", robot, 0.25)
    >>> bool(later.drive.position(0.0) == robot.drive.position(robot.period / 4))
    True
    """
    problems, track = Problems(what), machine_of(model).track
    if machine_of(model).drive is None:
        raise InputError(what, [f"phase is that of a drive, and {type(model).__name__} has none; leave phase out"])
    for part in (model.drive, track):
        if getattr(part, "breaks", ()) or getattr(part, "jumps", ()):
            problems.add(f"phase is for smooth drives; {type(part).__name__} has breaks or jumps; leave phase out")
        elif not all(_goes_on(f, float(model.period)) for f in _of_time(part, model.period)):
            problems.add(f"phase is for smooth drives; {type(part).__name__} begins anew with every period; leave phase out")
    problems.check()
    found = model.replace(drive=ShiftedDrive(model.drive, phase))
    found = found.replace(track=ShiftedTrack(track, phase)) if grip_of(track) is not None else found
    if not _is_later(found, model, phase):
        kind = type(model).__name__
        raise InputError(what, [f"phase is that of the drive, and {kind} keeps the time in its own equations as well; leave phase out"])
    return found


def _is_later(found: Any, model: Any, phase: Any) -> bool:
    """Whether the equations of a shifted model are those of the model at the later time, and not only its drive and its track."""
    T = model.period
    for f in (normal_load, lambda m, t, x: m.acceleration(t, x, 0.0, 0.0)):
        pairs = [(np.asarray(f(found, s * T, 0.0)), np.asarray(f(model, (s + phase) * T, 0.0))) for s in (0.13, 0.57, 0.81)]
        if np.any(np.max([abs(a - b) for a, b in pairs], axis=0) > _SAME * np.max([abs(a) + abs(b) for a, b in pairs], axis=0)):
            return False
    return True


def _of_time(part: Any, period: Any) -> list[Callable[[Any], Any]]:
    """What the equations of motion ask a drive or a track at a time."""
    found = [getattr(part, name, None) for name in ("acceleration", "vertical_acceleration")]
    grip = grip_of(part)
    return [f for f in found if f is not None] + ([] if grip is None else [lambda t: grip(t, period)])


def _goes_on(f: Callable[[Any], Any], period: float) -> bool:
    """Whether a function is the same a period later also for the engine, whose time is no float and is not taken `within` a period."""
    t = period * (np.arange(_LOOKS) + 0.5) / _LOOKS
    try:
        now, later = (getattr(found, "value", found) for found in (f(variables(start)[0]) for start in (t, t + period)))
    except Exception:  # it takes floats only; the engine, which takes symbols, says what to write
        return True
    return bool(np.max(abs(now - later)) <= _SAME * np.max(abs(now)))
