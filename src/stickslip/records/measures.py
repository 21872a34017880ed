"""Measures on a record without any model: mean cycle, mean velocity, period number, friction of strokes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.records.given import given_frequency
from stickslip.records.overview import noise
from stickslip.records.tones import measured_samples

if TYPE_CHECKING:
    from stickslip.records.record import Record


#: The longest period that is looked for, in drive periods.
LONGEST = 4


@dataclass(frozen=True)
class Value:
    """A number with its standard error."""

    value: float
    error: float


@sealed
@dataclass(frozen=True, eq=False)
class Cycle:
    """The mean cycle of a record.

    Parameters
    ----------
    phase : array (bins,)
        Middles of the bins, in drive periods.
    v, error : array (bins,)
        Mean velocity in each bin and its standard error [m/s].
    frequency : float
        [Hz]
    periods : float
        Drive periods in the record.
    noise : float
        Standard deviation of one sample [m/s].
    """

    phase: Any
    v: Any
    error: Any
    frequency: float
    periods: float
    noise: float


def velocity_of(rec: Record) -> tuple[Any, Any]:
    """Times [s] and velocity [m/s]; from the position where there is no velocity."""
    if "velocity" in rec or "position" not in rec:
        return measured_samples(rec["velocity"])
    t, x = measured_samples(rec["position"])
    return t, np.gradient(x, t)


def frequency_of(rec: Record, frequency: float | None) -> float:
    """The drive frequency [Hz] that is given, or that of the drive's record."""
    return rec.drive_frequency().value if frequency is None else given_frequency(frequency)


def cycle(rec: Record, frequency: float | None = None, bins: int | None = None, period: int = 1) -> Cycle:
    """The mean cycle over `period` drive periods.

    Examples
    --------
    >>> from stickslip.records import Record
    >>> t = np.arange(4000) / 4000
    >>> c = cycle(Record.of(t, {"v [m/s]": np.sin(2 * np.pi * 10 * t)}), frequency=10.0)
    >>> round(float(c.v.max()), 2), round(c.periods, 2)
    (1.0, 10.0)
    """
    t, v = velocity_of(rec)
    f = frequency_of(rec, frequency)
    periods = (t[-1] - t[0]) * f * len(t) / max(len(t) - 1, 1)
    if periods < period:
        raise InputError("record", [f"holds {periods:.2f} drive periods; allowed is at least {period}; give a longer record"])
    if bins is None:
        needed = (200 * noise(v) / max(float(np.ptp(v)), 1e-300)) ** 2  # samples in a bin for a standard error of 0.5 % of the range
        bins = int(np.clip(len(t) / max(needed, 4), min(24 * period, len(t) // 2), 400 * period))
    phase = ((t - t[0]) * f / period) % 1.0
    index = np.minimum((phase * bins).astype(int), bins - 1)
    count = np.bincount(index, minlength=bins)
    safe = np.maximum(count, 1)
    mean = np.interp(np.arange(bins), np.flatnonzero(count), (np.bincount(index, v, bins) / safe)[count > 0])
    level = np.fmin(noise(v), _scatter(v - np.interp(phase * bins - 0.5, np.arange(bins), mean, period=bins), count))
    return Cycle((np.arange(bins) + 0.5) / bins * period, mean, level / np.sqrt(safe), f, float(periods), float(level))


def _scatter(rest: Any, count: Any) -> float:
    """Standard deviation of samples about the mean cycle; it holds no bends of the curve, which differences between samples do."""
    free = len(rest) - int((count > 0).sum())
    return float(np.sqrt(rest @ rest / free)) if free > 0.25 * len(rest) else np.nan


def mean_velocity(rec: Record, frequency: float | None = None) -> Value:
    """Mean velocity over whole drive periods [m/s], with its standard error.

    From a position channel it is the displacement over the time, else the mean of the velocity. The error holds the noise and what differs
    from one period to the next, not an offset of the sensor.
    """
    f = frequency_of(rec, frequency)
    position = "position" in rec and "velocity" not in rec
    t, y = measured_samples(rec["position"]) if position else velocity_of(rec)
    periods = int((t[-1] - t[0]) * f * (1.0 if position else 1 + 1 / max(len(t) - 1, 1)) + 1e-9)
    if periods < 1:
        raise InputError("record", [f"holds {(t[-1] - t[0]) * f:.2f} drive periods; allowed is at least 1; give a longer record"])
    edges = t[0] + np.arange(periods + 1) / f
    if position:
        x = np.interp(edges, t, y)
        each = np.diff(x) * f
    else:
        edges[-1] = min(edges[-1], t[-1] + np.median(np.diff(t)))
        total = np.concatenate([[0.0], np.cumsum(0.5 * (y[1:] + y[:-1]) * np.diff(t))])
        step = np.median(np.diff(t))
        ends, sums = np.append(t, t[-1] + step), np.append(total, total[-1] + step * 0.5 * (y[-1] + y[0]))
        each = np.diff(np.interp(edges, ends, sums)) / np.diff(edges)
    level = noise(y) / np.sqrt(len(y)) if not position else noise(y) * np.sqrt(2) * f / periods
    spread = each.std(ddof=1) / np.sqrt(periods) if periods > 1 else 0.0
    return Value(float(each.mean()), float(np.hypot(level, spread)))


def period(rec: Record, frequency: float | None = None) -> int | None:
    """After how many drive periods the motion repeats, 1 to 4; None if it does not, or not in a record this short."""
    t, v = velocity_of(rec)
    return period_number_of((t - t[0]) * frequency_of(rec, frequency), v)


def scaled(v: Array) -> Any:
    """The same curve with values of up to 1: by a power of two, which changes no digit, so that the squares of all numbers are numbers.

    Examples
    --------
    >>> scaled(np.array([-3e200, 1.5e200])) * 2.0**666 == [-3e200, 1.5e200]
    array([ True,  True])
    """
    return np.ldexp(v, -int(np.frexp(np.fmax.reduce(abs(v), initial=0.0))[1]))


def period_number_of(phase: Any, v: Array) -> int | None:
    """The period number of a velocity at these places, counted in drive periods."""
    v = scaled(v)
    longest = min(LONGEST, int((phase[-1] - phase[0]) // 2))
    left = {p: _left(phase, v, p) for p in range(1, longest + 1)}
    if not left:
        return None
    floor = float(np.fmax(noise(v) ** 2, 1e-6 * float(np.var(v))))
    least = min(left.values())
    best = next(p for p, rest in left.items() if rest <= 1.25 * least + floor)
    return best if left[best] <= 3 * floor + 0.02 * float(np.var(v)) else None


def loop_friction(rec: Record, between: tuple[float, float], least_speed: float = 0.0, start: float = -np.inf) -> Value:
    """Friction of a machine that strokes to and fro: half the difference of the mean force on the way out and on the way back [N].

    Whatever does not depend on the direction, such as a pressure on a piston, drops out.

    Parameters
    ----------
    rec : Record
        With a position and a force, as their only channels of these roles.
    between : tuple of float
        The part of the stroke that counts [m].
    least_speed : float
        Slower samples do not count [m/s].
    start : float
        Earlier samples do not count [s].

    Returns
    -------
    Value
        The error is that of the mean over the strokes, from what differs between them.
    """
    c, F = rec["position"], rec["force"].si
    t, x = c.time, c.si
    v = _speed(t, x)
    inside = (t > start) & (x >= between[0]) & (x <= between[1]) & (abs(v) > least_speed) & np.isfinite(F)
    up, down = inside & (v > 0), inside & (v < 0)
    if not up.any() or not down.any():
        raise InputError("loop_friction", [f"has no stroke in both directions between {between[0]:g} and {between[1]:g} m; widen the part"])
    strokes = np.cumsum(np.diff(np.sign(np.where(inside, v, 0)), prepend=0) != 0)
    errors = []
    for part in (up, down):
        means = [F[part & (strokes == k)].mean() for k in np.unique(strokes[part]) if (part & (strokes == k)).sum() > 20]
        errors.append(np.std(means, ddof=1) / np.sqrt(len(means)) if len(means) > 1 else 0.0)
    return Value(float(0.5 * (F[up].mean() - F[down].mean())), float(0.5 * np.hypot(errors[0], errors[1])))


def _speed(t: Array, x: Array, half: int = 5) -> Any:
    """Slopes of straight lines through 2 half + 1 neighbouring samples."""
    kernel = np.ones(2 * half + 1)

    def total(a: Any) -> Any:
        return np.convolve(a, kernel, "same")

    n, T, X = total(np.ones_like(t)), t - t.mean(), x - x.mean()
    return (n * total(T * X) - total(T) * total(X)) / (n * total(T * T) - total(T) ** 2)


def _left(phase: Any, v: Array, p: int) -> float:
    """Mean square of what differs between motion periods of p drive periods."""
    shifted = phase + p
    inside = shifted <= phase[-1]
    return float(np.mean((np.interp(shifted[inside], phase, v) - v[inside]) ** 2) / 2)
