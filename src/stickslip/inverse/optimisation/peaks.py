"""How far, how fast and how hard the inner masses of a machine move relative to their bodies: of any drive, from its motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.fields import leaves
from stickslip.models.drives.drive_adapter import drive_of

_GRID = 256  # points of a period, beside its breaks
_ROUNDS, _FINER = 16, 2.0  # in which the neighbourhood of the best point is searched, each time so much finer: any point of it is reached
_BEFORE = 1e-12  # of the period: how far before a break its left side is looked at
#: What may be limited of a drive: its name, and the unit.
LIMITS = {"stroke": "m", "relative_velocity": "m/s", "relative_acceleration": "m/s^2"}


def peaks_of(drive: Any, name: str) -> Array:
    """A peak of one drive or of each of a batch: "stroke" [m], "relative_velocity" [m/s] or "relative_acceleration" [m/s^2].

    Where the drive does not say it, it is the largest of values that the motion takes, at points ever nearer to that. Where the velocity
    jumps, the acceleration is infinite.

    Examples
    --------
    >>> from stickslip.drives import Harmonic, TwoPhase
    >>> drive = Harmonic(amplitude=5e-4, omega=200.0)
    >>> [round(float(peaks_of(drive, name)), 12) for name in LIMITS]
    [0.001, 0.1, 20.0]
    >>> float(peaks_of(TwoPhase(stroke=0.01, u1=0.05, u2=0.4), "relative_acceleration"))
    inf
    """
    if name == "stroke":
        said = drive_of(drive).stroke
        if said is not None:
            return said
        return _highest(drive, drive.position) + _highest(drive, lambda t: -drive.position(t))
    if name == "relative_velocity":
        return np.maximum(_highest(drive, drive.velocity), _highest(drive, lambda t: -drive.velocity(t)))
    jumps = [abs(np.asarray(jump, float)) for _, jump in drive_of(drive).jumps]
    peak = np.maximum(_highest(drive, drive.acceleration), _highest(drive, lambda t: -drive.acceleration(t)))
    return np.where(np.asarray(sum(jumps, 0.0)) > 0.0, np.inf, peak)[()]


def _highest(drive: Any, of: Callable[[Any], Any]) -> Array:
    """The largest value of a function of time in a period, of every case."""
    shape = np.broadcast_shapes(*(np.shape(value) for _, value in leaves(drive)))
    T = np.broadcast_to(np.asarray(drive.period, float), shape)
    breaks = [np.broadcast_to(np.asarray(s, float), T.shape) for s in drive_of(drive).breaks or ()]
    breaks += [np.broadcast_to(np.asarray(s, float), T.shape) for s, _ in drive_of(drive).jumps or ()]
    times = np.stack([T * ((k + 0.5) / _GRID) for k in range(_GRID)] + [b for s in breaks for b in (s, s - _BEFORE * T)])
    values = _values(of, times)
    at = np.nanargmax(np.where(np.isnan(values), -np.inf, values), axis=0)
    t, best = (np.take_along_axis(each, at[None], axis=0)[0] for each in (times, values))
    h = T / _GRID
    for _ in range(_ROUNDS):
        around = _values(of, np.stack([t - h, t + h]))
        bend = around[0] - 2.0 * best + around[1]
        with np.errstate(invalid="ignore", divide="ignore"):
            move = np.where(bend < 0.0, 0.5 * h * (around[0] - around[1]) / bend, 0.0)
        tried = np.stack([t - h, t + h, t + np.clip(move, -h, h)])
        candidates = np.concatenate([best[None], around, _values(of, tried[2:])])
        at = np.argmax(np.where(np.isnan(candidates), -np.inf, candidates), axis=0)
        t = np.take_along_axis(np.concatenate([t[None], tried]), at[None], axis=0)[0]
        best, h = np.take_along_axis(candidates, at[None], axis=0)[0], h / _FINER
    return best[()]


def _values(of: Callable[[Any], Any], times: Array) -> Array:
    return np.broadcast_to(np.asarray(of(times), float), times.shape)
