"""Frequencies in a record: its spectrum, and the drive frequency refined far below one line of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.interruption import looking
from stickslip.basics.notebook_display import rounded, sure
from stickslip.basics.one_thread import in_one_thread
from stickslip.records.given import given_frequency

if TYPE_CHECKING:
    pass


_MOST = 40_000  # samples that a refinement looks at
_HARMONICS = 8
_FEWEST = 1.9  # periods in a record that can show one
_NEAR, _FAR = 3, 15  # lines beside one that it is compared with
_STANDS_OUT = 5.0  # times their median; the highest of ten thousand lines of noise has 4.8
_EXPLAINED = 0.9  # part of the variance that a period may explain instead, where its harmonics fill the spectrum
_MOST_FALLING = 0.01  # part of the samples that may lie at times that do not rise


class NotPeriodic(InputError):
    """A record in which no frequency repeats."""


@dataclass(frozen=True)
class Frequency:
    """A frequency that was found in the data, with its standard error [Hz], and the channel it was found in."""

    value: float
    error: float
    channel: str

    def __str__(self) -> str:
        return f"{rounded(self.value, self.error)} {sure(self.error)} Hz (in {self.channel!r})"

    @property
    def omega(self) -> float:
        """Angular frequency [rad/s]."""
        return 2 * np.pi * self.value


def spectrum(c: Any) -> tuple[Any, Any]:
    """Single-sided amplitude spectrum of a channel with a Hann window.

    Uneven samples and gaps are interpolated first.

    Returns
    -------
    tuple of arrays
        Frequencies [Hz], and amplitudes [SI unit of the channel]: a sine of amplitude a on a line of the spectrum shows as a.
    """
    return amplitudes(*measured_samples(c))


def amplitudes(t: Array, y: Array) -> tuple[Any, Any]:
    """The same of samples at rising times."""
    step = (t[-1] - t[0]) / (len(t) - 1)
    even = np.interp(t[0] + step * np.arange(len(t)), t, y)
    window = np.hanning(len(t) + 1)[:-1]
    lines = np.fft.rfft((even - even.mean()) * window) * (2 / window.sum())
    amplitude = abs(lines)
    amplitude[0] = abs(even.mean())
    return np.fft.rfftfreq(len(t), step), amplitude


def measured_samples(c: Any) -> tuple[Any, Any]:
    """Times [s] and values [SI] of the samples that were measured, at rising times."""
    t, y = c.time, c.si
    good = np.isfinite(t) & np.isfinite(y)
    t, y = t[good], y[good]
    rises = np.concatenate([np.ones(min(len(t), 1), bool), t[1:] > np.maximum.accumulate(t)[:-1]])
    if (~rises).sum() > _MOST_FALLING * len(t):
        raise InputError("record", [f"the times of {c.name!r} do not rise at {int((~rises).sum())} of {len(t)} samples; mend the file"])
    if rises.sum() < 8:
        raise InputError(
            "record", [f"{c.name!r} has {int(rises.sum())} samples that can be used; allowed are 8 or more, over rising times"]
        )
    return t[rises], y[rises]


def refuse_constant(name: str, y: Array, why: str = "no frequency can be read of it") -> None:
    """`InputError` where all values are equal: a record of rest has neither a frequency nor numbers of a motion."""
    if not np.ptp(y) > 0:
        what = f"{name} is {y[0]:g} at all {len(y)} samples: nothing moves, and {why}"
        raise InputError("record", [f"{what}; measure a stronger drive, or another body, or name the channel that moves"])


def _without_drift(t: Array, y: Array) -> Any:
    """Values less the straight line through them."""
    T, Y = (t - t.mean()) / np.ptp(t), y - y.mean()
    return Y - T * ((T @ Y) / (T @ T))


def harmonics(t: Array, y: Array, frequency: float, count: int = _HARMONICS) -> tuple[Any, Any]:
    """Least-squares mean, drift and harmonics of a frequency, and what they leave over."""
    turn = np.exp(2j * np.pi * frequency * (t - t[0]))
    rows, power = [np.ones_like(t), (t - t.mean()) / max(np.ptp(t), 1e-300)], np.ones_like(turn)
    for _ in range(count):
        power = power * turn
        rows += [power.real, power.imag]
    matrix = np.stack(rows)
    coefficients = np.linalg.lstsq(matrix @ matrix.T, matrix @ y, rcond=1e-12)[0]
    return coefficients, y - coefficients @ matrix


@in_one_thread
def drive_frequency(rec: Any, about: float | None = None) -> Frequency:
    """Frequency of the drive: the strongest line of the spectrum (or the one near `about`), refined by least squares over its harmonics.

    Parameters
    ----------
    rec : Record
    about : float, optional
        Where to look [Hz], to within a tenth.

    Returns
    -------
    Frequency

    Raises
    ------
    InputError
        No line stands out of its neighbours, or the record holds fewer than two of its periods. With `about`, any line will do.
    """
    role = next((r for r in ("drive", "velocity", "position", "acceleration", "force") if r in rec), "velocity")
    c = rec[role]
    t, y = measured_samples(c)
    if len(t) <= _MOST:
        return _strongest(c.name, t, y, about)
    try:
        return _strongest(c.name, t[:_MOST], y[:_MOST], about)
    except NotPeriodic:  # it may be slower than the beginning of the record tells
        each = -(-len(t) // _MOST)
        t, y = (a[: len(a) // each * each].reshape(-1, each).mean(axis=1) for a in (t, y))
        return _strongest(c.name, t, y, about)


def _strongest(name: str, t: Array, y: Array, about: float | None) -> Frequency:
    """The strongest line of these samples, refined."""
    about = None if about is None else given_frequency(about, "about")
    refuse_constant(repr(name), y)
    drifting = _without_drift(t, y)
    lines, amplitude = amplitudes(t, drifting)
    near = (lines > 1.5 / np.ptp(t)) if about is None else abs(lines / about - 1) < 0.1
    if not near.any() or not amplitude[near].max() > 0:
        raise InputError("record", [f"no drive frequency is found in {name!r}; type frequency=... [Hz], or a longer record"])
    first = int(np.flatnonzero(near)[np.argmax(amplitude[near])])
    value, error, left = _refined(t, y, float(lines[first]))
    if about is None:
        _check_line(name, value, value * np.ptp(t) * len(t) / (len(t) - 1), amplitude, first, 1 - left / float(drifting @ drifting))
    return Frequency(value, error, name)


def _check_line(name: str, value: float, periods: float, amplitude: Any, line: int, explained: float) -> None:
    """Whether the record repeats at this frequency, or is only strongest there."""
    apart = abs(np.arange(len(amplitude)) - line)
    neighbours = amplitude[(apart >= _NEAR) & (apart <= _FAR) & (np.arange(len(amplitude)) > 1)]
    why = None
    if periods < _FEWEST:
        why = f"its strongest line, at {value:.4g} Hz, has only {periods:.2g} periods in it; allowed are 2 or more"
    elif len(neighbours) and amplitude[line] < _STANDS_OUT * np.median(neighbours) and explained < _EXPLAINED:
        why = f"its strongest line, at {value:.4g} Hz, does not stand out of those beside it"
    if why:
        raise NotPeriodic("record", [f"{name!r} is not periodic: {why}; if it is, type frequency=... [Hz]"])


def _refined(t: Array, y: Array, start: float) -> tuple[float, float, float]:
    """The frequency at which the harmonics leave least over, its standard error from the curvature there, and what they leave."""
    from scipy.optimize import minimize_scalar

    usual = float(np.median(np.diff(t)))
    count = int(np.clip(0.45 / (usual * start), 1, _HARMONICS))
    line = 1 / np.ptp(t)

    @looking
    def left(f: float) -> float:
        rest = harmonics(t, y, f, count)[1]
        return float(rest @ rest)

    grid = start + line * np.linspace(-1, 1, 41)
    best = grid[np.argmin([left(f) for f in grid])]
    low, high = max(best - 0.06 * line, 0.1 * line), best + 0.06 * line
    f = float(minimize_scalar(left, bounds=(low, high), method="bounded", options={"xatol": 1e-7 * line}).x)
    h = 0.02 * line
    curvature = (left(f + h) - 2 * left(f) + left(f - h)) / h**2
    variance = left(f) / max(len(t) - 2 * count - 3, 1)
    return f, float(np.sqrt(2 * variance / curvature)) if curvature > 0 else float("nan"), left(f)
