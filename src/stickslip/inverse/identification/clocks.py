"""A common time base for channels that were sampled separately: motion and input, evenly spaced."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.phrases import counted
from stickslip.inverse.identification.weighting import weights_at

if TYPE_CHECKING:
    from stickslip.records.record import Record


_GAP = 3  # usual steps, beyond which nothing is known between two samples
_EVEN = 1e-3  # of an interval, by which the clock of a logger may be off


@sealed
@dataclass(frozen=True, eq=False)
class Clock:
    """Position and what was applied at the same, evenly spaced instants.

    Parameters
    ----------
    t, x, y, weight : array (n,)
        Weight is zero where something is missing.
    notes : tuple of str
    """

    t: Any
    x: Any
    y: Any
    weight: Any
    notes: tuple[str, ...] = ()

    @property
    def step(self) -> float:
        """Time between samples [s]."""
        return float(self.t[1] - self.t[0])

    def joined(self, at: Any, half: int) -> Any:
        """Windows in which nothing is missing."""
        gone = np.concatenate([[0], np.cumsum(self.weight <= 0)])
        return gone[at + half + 1] == gone[at - half]


def clock_of(rec: Record, applied: str, label: str) -> Clock:
    """Motion and what was applied of a record; the channel with fewer samples has the clock."""
    own, motion = rec[applied], rec["position"] if "position" in rec else rec["velocity"]
    notes: list[str] = []
    t, x, y, weight = together(rec, motion, own, notes)
    if len(t) < 40:
        raise InputError("identify", [f"{label} has {len(t)} samples with motion and {applied}; allowed are 40 or more"])
    t, x, y, weight = _even(t, x, y, weight, notes)
    if "position" not in rec:
        h = t[1] - t[0]
        x = np.concatenate([[0.0], np.cumsum(0.5 * (x[1:] + x[:-1])) * h])
        notes.append("the position is the integral of the velocity, from zero")
    return Clock(t, x, y, weight, tuple(notes))


def together(rec: Record, motion: Any, own: Any, notes: list[str]) -> tuple[Any, Any, Any, Any]:
    """All at the instants of the channel with the longer step; of the faster one means or values between samples."""
    slow, fast = (motion, own) if own.rate > 1.01 * motion.rate else (own, motion)
    t = slow.time
    other = fast.si if len(fast) == len(slow) and np.array_equal(fast.time, t) else _at(t, fast, slow is motion, notes)
    x, y = (slow.si, other) if slow is motion else (other, slow.si)
    weight = weights_at(rec, t)
    known = np.isfinite(x) & np.isfinite(y)
    if not known.all():
        notes.append(f"of {len(t)} samples {int((~known).sum())} miss a value; they are left out")
    good = np.isfinite(t) & np.concatenate([[True], np.diff(t) > 0])
    return t[good], x[good], y[good], np.where(known & np.isfinite(weight), weight, 0.0)[good]


def _at(t: Array, c: Any, averaged: bool, notes: list[str]) -> Any:
    """A channel at other instants: the mean of what lies about each where it is denser, else between its samples."""
    many = float(np.median(np.diff(t))) * c.rate if averaged else 1.0
    if many < 1.5:
        notes.append(f"{c.name} is taken between its samples at the instants of the other channel")
        return np.interp(t, c.time, c.si, left=np.nan, right=np.nan)
    notes.append(f"{c.name} is averaged over {many:.3g} samples about each instant of the motion")
    sums = np.concatenate([[0.0], np.cumsum(np.nan_to_num(c.si))])
    half = 0.5 * float(np.median(np.diff(t)))
    first, last = np.searchsorted(c.time, t - half), np.searchsorted(c.time, t + half)
    count = last - first
    return np.where(count >= 0.7 * many, (sums[last] - sums[first]) / np.maximum(count, 1), np.nan)


def _even(t: Array, x: Array, y: Array, weight: Any, notes: list[str]) -> tuple[Any, Any, Any, Any]:
    """Evenly spaced instants; where the logger's are not, values between them by a spline, and none in gaps."""
    h = float(np.median(np.diff(t)))
    if abs(np.diff(t) / h - 1).max() <= _EVEN:
        return t, _filled(t, x), y, weight
    from scipy.interpolate import CubicSpline

    known = weight > 0
    even = t[0] + h * np.arange(int((t[-1] - t[0]) / h * (1 + 1e-12)) + 1)
    near = np.searchsorted(t[known], even)
    a, b = t[known][np.clip(near - 1, 0, None)], t[known][np.clip(near, None, known.sum() - 1)]
    inside = (b - a) <= _GAP * h
    within = np.diff(t)[np.diff(t) < _GAP * h] / h
    if abs(within - 1).max() > _EVEN:
        jitter = 100 * float(np.std(within))
        notes.append(f"the times are uneven (by {jitter:.2g} % of a step), so motion and input are resampled at even ones, by splines")
    if gaps := len(t) - 1 - len(within):
        notes.append(f"the times have {counted(gaps, 'gap')} longer than {_GAP} steps; nothing is compared there")
    values = [CubicSpline(t[known], of[known])(even) for of in (x, y)]
    return even, *values, np.where(inside, np.interp(even, t[known], weight[known]), 0.0)


def _filled(t: Any, x: Any) -> Any:
    """Positions, between their neighbours where they are missing; windows there are not compared."""
    good = np.isfinite(x)
    return x if good.all() else np.interp(t, t[good], x[good])
