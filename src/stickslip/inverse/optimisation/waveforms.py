"""Waveforms of unknown shape: from a few numbers between 0 and 1 to a drive that keeps its limits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import Problems
from stickslip.basics.frozen_arrays import sealed
from stickslip.models.drives import MultiHarmonic, Pieces, Recorded
from stickslip.models.drives.fourier import series_range

_KINDS = {"pieces": 2, "fourier": 1, "spline": 4}  # with the least count of each
_MOST = 64
_SHORTEST = 0.02  # of the longest duration: that of a piece, before the motion is closed
_LEAST_PIECE = 1e-9  # of the period: what is shorter is a pulse and no piece
_LEAST_SHARE = 0.05  # of the longest period within the limits
_HARMONICS = 2  # of a spline for each of its points: what is left out is a thousandth of it, or less


@sealed
@dataclass(frozen=True)
class Waveform:
    """A drive whose waveform is to be found.

    Parameters
    ----------
    kind : str
        "pieces", "fourier" or "spline".
    count : int
        Pieces of constant acceleration, harmonics, or points of the spline.

    Examples
    --------
    >>> waveform(pieces=4)
    Waveform(kind='pieces', count=4)
    """

    kind: str
    count: int


@dataclass(frozen=True)
class Scales:
    """The limits that give a waveform its size.

    Parameters
    ----------
    acceleration : float
        Largest relative acceleration [m/s^2].
    stroke, velocity : float
        Largest stroke [m] and relative velocity [m/s]; infinite where there is none.
    """

    acceleration: float
    stroke: float = np.inf
    velocity: float = np.inf


@explains_arguments
def waveform(pieces: int | None = None, fourier: int | None = None, spline: int | None = None) -> Waveform:
    """A drive of unknown shape, for `optimise`.

    Parameters
    ----------
    pieces : int, optional
        Number of pieces of constant relative acceleration; their durations and accelerations are searched. The result is a `Pieces`.
    fourier : int, optional
        Number of harmonics; amplitudes, phases and the frequency are searched. The result is a `MultiHarmonic`.
    spline : int, optional
        Number of points, evenly spaced in the period, of a periodic cubic spline through relative positions. The result is a `Recorded`
        with the first harmonics of the spline, two for each point.

    Returns
    -------
    Waveform

    Raises
    ------
    InputError
        Unless exactly one of them is given.

    Examples
    --------
    >>> import stickslip as ss
    >>> ss.optimisation.waveform(fourier=3)
    Waveform(kind='fourier', count=3)
    """
    given = {name: value for name, value in (("pieces", pieces), ("fourier", fourier), ("spline", spline)) if value is not None}
    problems = Problems("waveform")
    if len(given) != 1:
        problems.add(
            f"{' and '.join(given) or 'nothing'} given; allowed is exactly one of {', '.join(_KINDS)}; "
            f"type ss.optimisation.waveform(pieces=4)"
        )
    for name, value in given.items():
        problems.whole(name, value, _KINDS[name], example=4, most=_MOST)
    problems.check()
    ((kind, count),) = given.items()
    return Waveform(kind, int(count))


def unknowns_of(form: Waveform) -> int:
    """How many numbers between 0 and 1 a waveform has."""
    return {"pieces": 2 * form.count, "fourier": 2 * form.count - 1, "spline": form.count}[form.kind] + (form.kind != "pieces") + 1


def drive_of_waveform(form: Waveform, u: Array, scales: Scales) -> Any:
    """The drive of some unknowns: array (unknowns,), or (unknowns, cases) for a batch. Where a shape has no sense its numbers are NaN.

    The last unknown is the period, as a part of the longest one within stroke and velocity; of what is not in pieces the one before it is
    the largest acceleration, as a part of the allowed one.

    Examples
    --------
    >>> drive = drive_of_waveform(Waveform("fourier", 1), np.array([0.5, 1.0, 1.0]), Scales(60.0, stroke=0.01))
    >>> round(drive.stroke, 9), round(float(drive.omega**2 * drive.amplitudes[0]), 9)
    (0.01, 60.0)
    """
    return _MAKERS[form.kind](form.count, np.asarray(u, float), scales)


def _in_pieces(n: int, u: Array, scales: Scales) -> Pieces:
    a = scales.acceleration * (2.0 * u[:n] - 1.0)
    d = _closed(u[:n], _SHORTEST ** (1.0 - u[n : 2 * n]))
    d = d / d.sum(axis=0)
    d = np.where(d.min(axis=0) < _LEAST_PIECE, np.nan, d)  # as where all accelerations but one tiny one have one sign
    with np.errstate(invalid="ignore"):
        stroke, velocity = _spans(d, a)
        T = _share(u[-1]) * _longest(stroke, velocity, scales)
    a = a - (a * d).sum(axis=0)  # rounding
    return _unchecked(Pieces, durations=tuple(_plain(T * d)), accelerations=tuple(_plain(a + 0.0 * T)))


def _closed(level: Array, d: Array) -> Array:
    """Durations changed by exp(-s a) so that the changes of velocity a d add up to zero: one root, as the sum falls with s."""
    a = 2.0 * level - 1.0
    s = np.zeros(a.shape[1:])
    both = (a.max(axis=0) > 0.0) & (a.min(axis=0) < 0.0)
    low, high = np.full(s.shape, -np.inf), np.full(s.shape, np.inf)
    for _ in range(_NEWTON):
        e = d * np.exp(np.clip(-s * a, -_FAR, _FAR))
        F, slope = (a * e).sum(axis=0), -(a * a * e).sum(axis=0)
        if np.all(~both | (abs(F) <= _ROUNDING * (abs(a) * e).sum(axis=0))):
            break
        low, high = np.where(F > 0, s, low), np.where(F <= 0, s, high)
        with np.errstate(invalid="ignore", divide="ignore"):
            step = np.clip(-F / slope, -3.0, 3.0)
        s = np.where(both & np.isfinite(step), s + step, s)
        outside = (s <= low) | (s >= high)
        with np.errstate(invalid="ignore"):
            s = np.where(both & outside & np.isfinite(low + high), 0.5 * (low + high), s)
    return np.where(both, d * np.exp(np.clip(-s * a, -_FAR, _FAR)), np.nan)


_NEWTON, _FAR, _ROUNDING = 60, 300.0, 1e-15


def _spans(d: Array, a: Array) -> tuple[Array, Array]:
    """Stroke and largest velocity of pieces."""
    drive = _unchecked(Pieces, durations=tuple(d), accelerations=tuple(a))
    return drive.stroke, drive.velocity_scale


def _longest(stroke: Array, velocity: Array, scales: Scales) -> Array:
    """The longest period within the limits, given stroke and velocity for a period of 1 s: accelerations stay what they are."""
    with np.errstate(divide="ignore"):
        return np.minimum(np.sqrt(scales.stroke / stroke), scales.velocity / velocity)


def _share(u: Array) -> Array:
    return _LEAST_SHARE + (1.0 - _LEAST_SHARE) * u


def _in_harmonics(n: int, u: Array, scales: Scales) -> MultiHarmonic:
    zero = np.zeros(u.shape[1:])
    sizes = u[:n] + 1e-12
    phases = np.stack([zero, *(2.0 * np.pi * (u[n : 2 * n - 1] - 0.5))])
    k = np.arange(1, n + 1).reshape(-1, *(1,) * (u.ndim - 1))
    amplitudes = sizes / k**2  # each can have the whole acceleration
    A, omega = _scaled(amplitudes * np.sin(phases), amplitudes * np.cos(phases), u, scales)
    return _unchecked(MultiHarmonic, omega=_plain([omega])[0], amplitudes=tuple(_plain(A * amplitudes)), phases=tuple(_plain(phases)))


def _in_spline(n: int, u: Array, scales: Scales) -> Recorded:
    values = u[:n] - u[:n].mean(axis=0)
    cosines, sines = _spline_harmonics(values, _HARMONICS * n)
    A, omega = _scaled(cosines, sines, u, scales)
    return _unchecked(
        Recorded, period=_plain([2 * np.pi / omega])[0], cosines=tuple(_plain(A * cosines)), sines=tuple(_plain(A * sines)), notes=None
    )


def _spline_harmonics(values: Array, count: int) -> tuple[Array, Array]:
    """Fourier coefficients of the periodic cubic spline through evenly spaced values: of its points, times that of the spline of one."""
    n = len(values)
    k = np.arange(1, count + 1)
    points = np.fft.fft(values, axis=0) / n
    theta = np.pi * k / n
    single = (np.sin(theta) / theta) ** 4 * 3.0 / (2.0 + np.cos(2.0 * theta))
    c = points[k % n] * single.reshape(-1, *(1,) * (values.ndim - 1))
    return 2.0 * c.real, -2.0 * c.imag


def _scaled(cosines: Array, sines: Array, u: Array, scales: Scales) -> tuple[Array, Array]:
    """The factor for the coefficients, and the angular frequency, that keep acceleration, stroke and velocity within their limits."""
    k = np.arange(1, len(sines) + 1).reshape(-1, *(1,) * (sines.ndim - 1))

    def span(a: Array, b: Array) -> tuple[Array, Array]:
        low, high = series_range(tuple(a), tuple(b))
        return np.asarray(low), np.asarray(high)

    low, high = span(cosines, sines)
    stroke = high - low
    v_low, v_high = span(k * sines, -k * cosines)
    a_low, a_high = span(k**2 * cosines, k**2 * sines)
    bend = np.maximum(a_high, -a_low)
    with np.errstate(divide="ignore", invalid="ignore"):
        size = _share(u[-2]) * scales.acceleration / bend  # A omega^2
        longest = _longest(stroke * size, np.maximum(v_high, -v_low) * size, scales)  # of 1 / omega
        omega = 1.0 / (_share(u[-1]) * longest)
        return size / omega**2, omega


def _plain(values: Any) -> list[Any]:
    """Floats of numbers that are not arrays."""
    return [float(value) if np.ndim(value) == 0 else np.ascontiguousarray(value) for value in values]


def _unchecked(cls: Any, **fields: Any) -> Any:
    """A record made without its checks: numbers of cases that have no sense are NaN, and those cases are left out later."""
    record = object.__new__(cls)
    for name, value in fields.items():
        object.__setattr__(record, name, value)
    return record


_MAKERS: dict[str, Callable[[int, Array, Scales], Any]] = {"pieces": _in_pieces, "fourier": _in_harmonics, "spline": _in_spline}


def unknowns_of_pieces(drive: Pieces, count: int, scales: Scales) -> Array:
    """The unknowns of a waveform of `count` pieces that is this drive, its longest pieces cut in halves until there are enough.

    Examples
    --------
    >>> drive = Pieces.verge(acceleration=60.0, stroke=0.01, mass_ratio=0.1315, mu_plus=0.15, mu_minus=0.25)
    >>> scales = Scales(60.0, stroke=0.01)
    >>> again = drive_of_waveform(Waveform("pieces", 4), unknowns_of_pieces(drive, 4, scales), scales)
    >>> bool(abs(again.period - drive.period) < 1e-12), round(float(again.stroke), 12)
    (True, 0.01)
    """
    pieces = [(float(d), float(a)) for d, a in zip(drive.durations, drive.accelerations, strict=True)]
    while len(pieces) < count:
        i = max(range(len(pieces)), key=lambda j: pieces[j][0])
        d, a = pieces[i]
        pieces[i : i + 1] = [(0.5 * d, a)] * 2
    d, a = np.array(pieces).T
    level = 0.5 * (1.0 + a / scales.acceleration)
    length = 1.0 - np.log(d / d.max()) / np.log(_SHORTEST)
    stroke, velocity = _spans(d / d.sum(), a)
    share = d.sum() / _longest(stroke, velocity, scales)
    return np.clip(np.concatenate([level, length, [(share - _LEAST_SHARE) / (1.0 - _LEAST_SHARE)]]), 0.0, 1.0)
