"""Samples of a periodic motion: whether they can be used, and the harmonics in them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import Problems, is_number
from stickslip.basics.fields import describe
from stickslip.basics.frozen_arrays import sealed

MOST = 64  # harmonics at most, unless more are asked for
_GAP = 2.5  # a step this many times as long as the usual one is a gap
_REPEAT = 0.1  # part of the r.m.s. by which a record may differ from itself a period later
_MEAN = 0.02  # part of the r.m.s. that the mean of a velocity or acceleration may be
_JUMP = 3.0  # a step from the last sample to the first this many times as large as any other is not a repetition
_SAME = 1e-9  # part of a period: instants that lie no further apart are one
_ROUNDING = 1e-6  # of a number of samples in a period, whose instants are rounded
_CHUNK = 1 << 14  # samples at a time


@sealed
@dataclass(frozen=True)
class Samples:
    """A record that can be used: instants [s], values, its name, its period [s], and how often the position was differentiated."""

    t: Array
    values: Array
    name: str
    period: float

    @property
    def derivatives(self) -> int:
        """1 for a velocity, 2 for an acceleration, 0 for a position or a force."""
        return {"velocity": 1, "acceleration": 2}.get(self.name, 0)

    @property
    def per_period(self) -> float:
        """Samples in a period."""
        import numpy as np

        return self.period / float(np.median(np.diff(self.t)))

    @property
    def harmonics(self) -> int:
        """How many harmonics so many samples bear, two numbers for each and one for the mean."""
        return max(math.floor((self.per_period - 1) / 2 + _ROUNDING), 0)

    @property
    def spread(self) -> float:
        """Root mean square of the values about their mean."""
        return float(self.values.std())


def checked_samples(t: Any, given: dict[str, Any], period: Any, tolerance: Any, order: Any, what: str, example: str) -> Samples:
    """The record, or everything that is wrong with it, with what to type for example."""
    problems = Problems(what)
    names = [name for name, values in given.items() if values is not None]
    if len(names) != 1:
        problems.add(f"give exactly one of position, velocity and acceleration; got {', '.join(names) or 'none'}; {example}")
    if not is_number(period) or not period > 0:
        problems.add(f"period = {period!r}; allowed is the period of the record [s], which is not guessed; {example}")
    if not is_number(tolerance) or not 0 < tolerance < 1:
        problems.add(f"tolerance = {tolerance!r}; allowed is a part of the r.m.s. between 0 and 1; type for example tolerance=1e-3")
    if order is not None:
        problems.whole("order", order, 1, example=10)
    t = _numbers("t", t, problems, example)
    values = [_numbers(name, given[name], problems, example) for name in names]
    problems.check()
    if t.shape != values[0].shape or len(t) < 5:
        problems.add(f"t has {len(t)} values and {names[0]} {len(values[0])}; allowed are as many of one as of the other, at least 5")
        problems.check()
    record = Samples(t, values[0], names[0], float(period))
    _check_instants(record, order, problems)
    problems.check()
    _check_repetition(record, problems)
    problems.check()
    return record


def _numbers(name: str, values: ArrayLike, problems: Problems, example: str) -> Array:
    import numpy as np

    try:
        array = np.asarray(values, float)
    except (TypeError, ValueError):
        array = np.array(np.nan)
    if array.ndim != 1:
        problems.add(f"{name} = {describe(array)}; allowed is a list of numbers; {example}")
        return np.empty(0)
    bad = np.flatnonzero(~np.isfinite(array))
    if len(bad):
        problems.add(
            f"{name}[{bad[0]}] = {array[bad[0]]} ({len(bad)} of {len(array)} values are not numbers); allowed are records without gaps: "
            "cut the record to whole periods without them, or fill them in"
        )
    return array


def _check_instants(record: Samples, order: int | None, problems: Problems) -> None:
    import numpy as np

    t, steps = record.t, np.diff(record.t)
    if np.any(steps <= 0):
        i = int(np.argmax(steps <= 0))
        problems.add(f"t[{i + 1}] = {t[i + 1]:.6g} is not after t[{i}] = {t[i]:.6g}; allowed are ascending instants; sort the record")
        return
    usual, widest = float(np.median(steps)), int(np.argmax(steps))
    if steps[widest] > _GAP * usual:
        problems.add(
            f"a gap of {steps[widest]:.4g} s after t[{widest}] = {t[widest]:.6g}, where samples are usually {usual:.4g} s apart; allowed "
            "are records without gaps: cut the record to whole periods without it"
        )
    length = t[-1] - t[0] + usual
    if length < record.period - 0.5 * usual:
        problems.add(f"the record lasts {length:.6g} s and its period is {record.period:.6g} s; allowed is at least one period")
    most = record.harmonics
    if (order or 1) > most:
        asked = f"order = {order}" if order is not None else "a period"
        problems.add(f"{asked} with {record.per_period:.4g} samples in a period; allowed is an order up to {most}: sample faster")


def _check_repetition(record: Samples, problems: Problems) -> None:
    import numpy as np

    values, spread = record.values, record.spread
    if not spread > 1e-12 * float(np.max(abs(values))):
        problems.add(f"{record.name} is constant, {values[0]:.6g}; allowed is a motion")
        return
    differs = _difference(record)
    if differs > _REPEAT:
        problems.add(
            f"the record does not repeat with period = {record.period:.6g} s: it differs from itself by {100 * differs:.3g} per cent of "
            f"its r.m.s.; allowed is {100 * _REPEAT:.3g}: check the period, cut off the beginning, or take out the trend"
        )
    elif record.derivatives and abs(_mean(record)) > _MEAN * spread:
        problems.add(
            f"the mean of {record.name} over a period is {_mean(record):.4g}, {100 * abs(_mean(record)) / spread:.3g} per cent of its "
            f"r.m.s.: the inner mass would leave the body; allowed is {100 * _MEAN:.3g}: take out the offset of the sensor, "
            f"type {record.name}={record.name} - {record.name}.mean()"
        )


def _difference(record: Samples) -> float:
    """By how much the record differs from itself whole periods later, over its r.m.s.; of one period, the step that does not close."""
    import numpy as np

    t, values, period = record.t, record.values, record.period
    later = t + np.floor((t[-3] - t[0]) / period + _SAME) * period  # from the third sample from the end: one alone says little
    inside = (later <= t[-1] + _SAME * period) & (later > t)
    if np.count_nonzero(inside) >= 3:
        return float(np.sqrt(np.mean((np.interp(later[inside], t, values) - values[inside]) ** 2))) / record.spread
    last = values[np.searchsorted(t, t[0] + period * (1 - _SAME)) - 1]
    steps = np.diff(values)
    wrap = abs(values[0] - last)
    return float(wrap / record.spread) if wrap > _JUMP * np.max(abs(steps)) and wrap > _REPEAT * record.spread else 0.0


def _mean(record: Samples) -> float:
    """Mean over the whole periods of the record."""
    return float(_solved(record, min(8, record.harmonics))[0])


def _basis(angle: Array, order: int) -> Array:
    """Columns 1, cos, sin, cos 2, sin 2, … of angles."""
    import numpy as np

    from stickslip.models.drives.fourier import harmonics

    columns = [np.ones_like(angle)]
    for pair in harmonics(angle, order):
        columns += pair
    return np.stack(columns, axis=1)


def _chunks(record: Samples, order: int) -> Iterator[tuple[Array, Array]]:
    """The basis and the values, some samples at a time: a long record needs little memory."""
    for start in range(0, len(record.t), _CHUNK):
        part = slice(start, start + _CHUNK)
        yield _basis(2 * math.pi / record.period * record.t[part], order), record.values[part]


def _solved(record: Samples, order: int) -> Array:
    """Coefficients of the basis by least squares."""
    import numpy as np

    square, right = np.zeros((2 * order + 1, 2 * order + 1)), np.zeros(2 * order + 1)
    for basis, values in _chunks(record, order):
        square += basis.T @ basis
        right += basis.T @ values
    return np.linalg.lstsq(square, right, rcond=1e-12)[0]


def _misses(record: Samples, c: Array) -> Array:
    """Residuals of a fit at every sample."""
    import numpy as np

    return np.concatenate([values - basis @ c for basis, values in _chunks(record, len(c) // 2)])


def fourier_fit(record: Samples, tolerance: float, order: int | None) -> tuple[list[float], list[float], float, str]:
    """Coefficients of the cosines and of the sines of the record, its mean, and a sentence on what they leave."""
    import numpy as np

    most = min(MOST, record.harmonics) if order is None else order
    c = _solved(record, most)
    if order is None:
        powers = 0.5 * (c[1::2] ** 2 + c[2::2] ** 2)
        unfitted = np.mean(_misses(record, c) ** 2)
        left = np.sqrt(unfitted + np.append(np.cumsum(powers[::-1])[::-1][1:], 0.0))  # left[k - 1]: r.m.s. above harmonic k
        good = left <= tolerance * record.spread
        order = int(np.argmax(good)) + 1 if good.any() else most
        c = _solved(record, order)
    misses = _misses(record, c)
    residual = float(np.sqrt(np.mean(misses**2))) / record.spread
    remark = (
        f"the drive is a {record.name} record of {len(record.t)} samples as {order} harmonics; they leave {100 * residual:.3g} per cent "
        f"of its r.m.s., at most {float(np.max(abs(misses))):.3g}"
    )
    if residual > tolerance and order == most:
        remark += f", more than tolerance = {tolerance:g}: the record has noise or corners that {order} harmonics do not follow"
    return list(c[1::2]), list(c[2::2]), float(c[0]), remark
