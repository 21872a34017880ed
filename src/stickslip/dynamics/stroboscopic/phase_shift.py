"""A robot started at another drive phase."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.contracts import Model, Numeric
from stickslip.basics.errors import InputError
from stickslip.models.drives.shifted import begun_at
from stickslip.models.machine_adapter import machine_of
from stickslip.models.normal_loads import normal_load
from stickslip.models.tracks.tracks import VaryingInTime, grip_of

_SAME = 1e-9  # of the largest value: how well a shifted model must be the model at the later time


@dataclass(frozen=True, eq=False)
class ShiftedTrack(VaryingInTime):
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
    >>> round(ShiftedTrack(ss.tracks.VaryingFriction(ss.Level(), depth=0.5), 0.25).grip(0.0, period=1.0), 9)
    1.5
    """

    track: Any
    phase: float

    def grip(self, t: Numeric, period: Numeric) -> Any:
        """Factor on the friction at a time, for a drive of this period [-]."""
        return self.track.grip(t + self.phase * period, period)


def shifted_robots(what: str, model: Any, phase: Any) -> Any:
    """The robots whose drive is at a phase when they start; `InputError` where there is none, or something else keeps the time too.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)
    >>> later = shifted_robots("basins", robot, 0.25)
    >>> bool(later.drive.position(0.0) == robot.drive.position(robot.period / 4))
    True
    """
    track = machine_of(model).track
    if machine_of(model).drive is None:
        raise InputError(what, [f"phase is that of a drive, and {type(model).__name__} has none; leave phase out"])
    later = model.replace(drive=begun_at(model.drive, phase, getattr(model, "cycles", None)))
    later = later.replace(track=ShiftedTrack(track, phase)) if grip_of(track) is not None else later
    if not _is_later(later, model, phase):
        kind = type(model).__name__
        raise InputError(what, [f"phase is that of the drive, and {kind} keeps the time in its own equations as well; leave phase out"])
    return later


def _is_later(later: Any, model: Model, phase: Any) -> bool:
    """Whether the equations of a shifted model are those of the model at the later time, and not only its drive and its track."""
    T = model.period
    for f in (normal_load, lambda m, t, x: m.acceleration(t, x, 0.0, 0.0)):
        pairs = [(np.asarray(f(later, s * T, 0.0)), np.asarray(f(model, (s + phase) * T, 0.0))) for s in (0.13, 0.57, 0.81)]
        if np.any(np.max([abs(a - b) for a, b in pairs], axis=0) > _SAME * np.max([abs(a) + abs(b) for a, b in pairs], axis=0)):
            return False
    return True
