"""Measures on a record without any model: mean cycle, mean velocity, period number, motion type."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.errors import InputError
from stickslip.records.overview import noise
from stickslip.records.tones import _finite
from stickslip.segments import intervals_of, type_of

__all__ = ["Cycle", "MeasuredMotion", "Value", "cycle", "loop_friction", "mean_velocity", "motion", "period_number"]

#: The longest period that is looked for, in drive periods.
LONGEST = 4


@dataclass(frozen=True)
class Value:
    """A number with its standard error."""

    value: float
    error: float


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
    """

    phase: Any
    v: Any
    error: Any
    frequency: float
    periods: float


@dataclass(frozen=True)
class MeasuredMotion:
    """The motion that a record shows, in the words of `stickslip.motion`, with the threshold that was needed.

    Parameters
    ----------
    type, pattern : str
    period : int or None
    direction : int
    stick_fraction, forward_fraction, backward_fraction : float
    intervals : tuple of (start, length, sign)
        In drive periods.
    threshold : float
        Slower than this counts as rest [m/s].
    """

    type: str
    pattern: str
    period: int | None
    direction: int
    stick_fraction: float
    forward_fraction: float
    backward_fraction: float
    intervals: tuple[tuple[float, float, int], ...]
    threshold: float


def _velocity(rec: Any) -> tuple[Any, Any]:
    """Times [s] and velocity [m/s]; from the position where there is no velocity."""
    if "velocity" in rec or "position" not in rec:
        return _finite(rec["velocity"])
    t, x = _finite(rec["position"])
    return t, np.gradient(x, t)


def _frequency(rec: Any, frequency: float | None) -> float:
    return rec.drive_frequency().value if frequency is None else float(frequency)


def cycle(rec: Any, frequency: float | None = None, bins: int | None = None, period: int = 1) -> Cycle:
    """The mean cycle over `period` drive periods.

    Examples
    --------
    >>> from stickslip.records import Record
    >>> t = np.arange(4000) / 4000
    >>> c = cycle(Record.of(t, {"v [m/s]": np.sin(2 * np.pi * 10 * t)}), frequency=10.0)
    >>> round(float(c.v.max()), 2), round(c.periods, 2)
    (1.0, 10.0)
    """
    t, v = _velocity(rec)
    f = _frequency(rec, frequency)
    periods = (t[-1] - t[0]) * f * len(t) / max(len(t) - 1, 1)
    if periods < period:
        raise InputError("record", [f"holds {periods:.2f} drive periods; allowed is at least {period}; give a longer record"])
    if bins is None:
        needed = (200 * noise(v) / max(float(np.ptp(v)), 1e-300)) ** 2  # samples in a bin for a standard error of 0.5 % of the range
        bins = int(np.clip(len(t) / max(needed, 4), min(24 * period, len(t) // 2), 400 * period))
    place = ((t - t[0]) * f / period) % 1.0
    index = np.minimum((place * bins).astype(int), bins - 1)
    count = np.bincount(index, minlength=bins)
    safe = np.maximum(count, 1)
    mean = np.bincount(index, v, bins) / safe
    level = noise(v)
    mean = np.where(count > 0, mean, np.interp(np.arange(bins), np.flatnonzero(count), mean[count > 0]))
    return Cycle((np.arange(bins) + 0.5) / bins * period, mean, level / np.sqrt(safe), f, float(periods))


def mean_velocity(rec: Any, frequency: float | None = None) -> Value:
    """Mean velocity over whole drive periods [m/s], with its standard error.

    From a position channel it is the displacement over the time, else the mean of the velocity. The error holds the noise and what differs
    from one period to the next, not an offset of the sensor.
    """
    f = _frequency(rec, frequency)
    position = "position" in rec and "velocity" not in rec
    t, y = _finite(rec["position"]) if position else _velocity(rec)
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


def period_number(rec: Any, frequency: float | None = None) -> int | None:
    """After how many drive periods the motion repeats, 1 to 4; None if it does not, or not in a record this short."""
    t, v = _velocity(rec)
    f = _frequency(rec, frequency)
    place = (t - t[0]) * f
    longest = min(LONGEST, int(place[-1] // 2))
    left = {p: _left(place, v, p) for p in range(1, longest + 1)}
    if not left:
        return None
    floor = max(noise(v) ** 2, 1e-6 * float(np.var(v)))
    least = min(left.values())
    best = next(p for p, rest in left.items() if rest <= 1.25 * least + floor)
    return best if left[best] <= 3 * floor + 0.02 * float(np.var(v)) else None


def loop_friction(rec: Any, between: tuple[float, float], least_speed: float = 0.0, start: float = -np.inf) -> Value:
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


def _speed(t: Any, x: Any, half: int = 5) -> Any:
    """Slopes of straight lines through 2 half + 1 neighbouring samples."""
    kernel = np.ones(2 * half + 1)

    def total(a: Any) -> Any:
        return np.convolve(a, kernel, "same")

    n, T, X = total(np.ones_like(t)), t - t.mean(), x - x.mean()
    return (n * total(T * X) - total(T) * total(X)) / (n * total(T * T) - total(T) ** 2)


def _left(place: Any, v: Any, p: int) -> float:
    """Mean square of what differs between motion periods of p drive periods."""
    shifted = place + p
    inside = shifted <= place[-1]
    return float(np.mean((np.interp(shifted[inside], place, v) - v[inside]) ** 2) / 2)


def motion(rec: Any, frequency: float | None = None, threshold: float | None = None, dwell: float = 0.03) -> MeasuredMotion:
    """Motion type and intervals of the mean cycle.

    Parameters
    ----------
    rec : Record
    frequency : float, optional
        Of the drive [Hz]; found in the record otherwise.
    threshold : float, optional
        Slower than this counts as rest [m/s]; otherwise four standard errors of the mean cycle, at least 1 % of its range.
    dwell : float
        Shorter rests do not count [drive periods].

    Returns
    -------
    MeasuredMotion
    """
    f = _frequency(rec, frequency)
    number = period_number(rec, f)
    c = cycle(rec, f, period=number or 1)
    limit = float(max(4 * np.median(c.error), 0.01 * np.ptp(c.v))) if threshold is None else float(threshold)
    signs = np.where(abs(c.v) <= limit, 0, np.sign(c.v)).astype(int)
    signs = _without_crossings(signs, c.v, limit, dwell * len(signs) / (number or 1))
    time, code = _runs(signs, number or 1)
    rows = (np.array([len(time)]), time[None, :], 2 * code[None, :])
    told = type_of(*rows, [number or 0], [np.inf], [float(c.v.mean())], dwell, moving=[False])
    merged = intervals_of(*rows, dwell)
    spans = tuple((float(a), float(b), int(s)) for a, b, s in zip(merged.start[0], merged.length[0], merged.sign[0], strict=True) if b > 0)
    words = {name: float(told[name][0]) for name in ("stick_fraction", "forward_fraction", "backward_fraction")}
    return MeasuredMotion(
        str(told["motion_type"][0]), str(told["pattern"][0]), number, int(told["direction"][0]), intervals=spans, threshold=limit, **words
    )


def _without_crossings(signs: Any, v: Any, limit: float, least: float) -> Any:
    """A slow stretch between motion of opposite signs is a rest only if it lasts longer than passing straight through would."""
    signs, n = signs.copy(), len(signs)
    starts = [i for i in range(n) if signs[i] == 0 and signs[i - 1] != 0]
    for start in starts:
        length = next((k for k in range(n) if signs[(start + k) % n] != 0), n)
        inside = (start + np.arange(length)) % n
        end = start + length
        into, out = abs(v[start - 5] - v[start - 1]) / 4, abs(v[(end + 4) % n] - v[end % n]) / 4  # slopes just outside
        passing = limit / max(into, 1e-300) + 1.5 * limit / max(out, 1e-300)  # break-away begins gently
        opposite = signs[start - 1] == -signs[(start + length) % n]
        if length < least or (opposite and length < passing):
            signs[inside] = np.where(v[inside] >= 0, 1, -1) if opposite else signs[start - 1]
    return _without_flicker(signs, max(int(least), 1))


def _without_flicker(signs: Any, least: int) -> Any:
    """Runs shorter than `least` bins, which noise makes where v passes zero, are given to the run before them."""
    turn = next((i for i in range(len(signs)) if signs[i] != signs[i - 1]), 0)
    signs = np.roll(signs, -turn)
    begins = np.flatnonzero(np.diff(signs, prepend=signs[0] - 5))
    lengths = np.diff(np.append(begins, len(signs)))
    for begin, length in zip(begins, lengths, strict=True):
        if length < least:
            signs[begin : begin + length] = signs[begin - 1]
    return np.roll(signs, turn)


def _runs(signs: Any, periods: int) -> tuple[Any, Any]:
    """Durations in drive periods, and signs, of the runs of equal signs."""
    begins = np.flatnonzero(np.diff(signs, prepend=signs[0] - 5))
    lengths = np.diff(np.append(begins, len(signs)))
    return lengths * (periods / len(signs)), signs[begins]
