"""Where in a record the steady motion begins."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.errors import InputError, is_one_of, is_whole
from stickslip.records import tones
from stickslip.records.given import given_frequency
from stickslip.records.measures import period_number_of, scaled, velocity_of
from stickslip.records.tones import Frequency

if TYPE_CHECKING:
    from stickslip.records.record import Record


_FEWEST = 6  # drive periods in a record that can be judged
_TWICE = 2.5  # mean square in a period over the usual one
_SURE = 4.0  # standard errors of the mean over a period
_FAINT = 1e-3  # part of the range below which a difference is none


def settling_periods(rec: Record, frequency: float) -> int:
    """How many drive periods at the start of a record differ from the mean cycle of its second half by more than its noise.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip.records import Record
    >>> t = np.arange(4000) / 200
    >>> settling_periods(Record.of(t, {"v [m/s]": np.sin(2 * np.pi * t) + 2 * np.exp(-2 * t)}), 1.0)
    6
    """
    t, v = velocity_of(rec)
    v, phase = scaled(v), (t - t[0]) * frequency
    periods = int(phase[-1] + 1e-6 + frequency * (t[-1] - t[0]) / max(len(t) - 1, 1))
    if periods < _FEWEST:
        return 0
    half = phase >= periods // 2
    each = np.minimum(phase.astype(int), periods - 1)
    held = np.bincount(each, minlength=periods)  # samples in each; where they are missing nothing can differ
    sampled = held >= 0.5 * np.median(held[held > 0])
    if sampled.sum() < _FEWEST or sampled[periods // 2 :].sum() < _FEWEST // 2:
        return 0
    repeats = period_number_of(phase[half], v[half]) or 1
    bins, turn = int(np.clip(half.sum() / 8, 16, 400 * repeats)), np.mod(phase / repeats, 1.0)
    index = np.minimum((turn * bins).astype(int), bins - 1)
    count = np.bincount(index[half], minlength=bins)
    sums = np.bincount(index[half], v[half], bins)
    mean = np.interp(np.arange(bins), np.flatnonzero(count), sums[count > 0] / count[count > 0])
    rest = v - np.interp(turn * bins - 0.5, np.arange(bins), mean, period=bins)
    number = np.maximum(held, 1)
    size, drift = np.bincount(each, rest**2, periods) / number, np.bincount(each, rest, periods) / number
    usual = float(np.median(size[periods // 2 :][sampled[periods // 2 :]])) + (_FAINT * float(np.ptp(v))) ** 2
    calm = np.flatnonzero(sampled & (size <= _TWICE * usual) & (drift**2 <= _SURE**2 * usual / number))
    first = int(calm[0]) if len(calm) else periods
    return min(first + (first + 1) // 2, periods // 2)  # what has sunk below the noise is still there: half as many periods more


def drive_frequency(rec: Record, about: float | None = None) -> Frequency:
    """Drive frequency with its standard error [Hz], refined from the data; give an estimate `about` if it is not the strongest line.

    Drive periods at the start of a velocity or a position that differ from the later ones are left out: a transient shifts phases, as
    another frequency would.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip.records import Record
    >>> t = np.arange(4000) / 200
    >>> rec = Record.of(t, {"v [m/s]": np.sin(2 * np.pi * t + 2 * np.exp(-t))})
    >>> bool(abs(tones.drive_frequency(rec).value - 1) > 1e-3), bool(abs(drive_frequency(rec).value - 1) < 1e-4)
    (True, True)
    """
    frequency = tones.drive_frequency(rec, about)
    if rec[frequency.channel].role not in ("velocity", "position"):
        return frequency
    kept, count, _ = settled(rec, "auto", frequency.value)
    return tones.drive_frequency(kept, frequency.value) if count else frequency


def settled(rec: Record, settle: int | str = "auto", frequency: float | None = None) -> tuple[Any, int, str | None]:
    """The record from where its motion is steady, how many drive periods were left out, and a sentence on that.

    Parameters
    ----------
    rec : Record
    settle : int or "auto"
        Drive periods to leave out; "auto" finds those that differ from the later ones.
    frequency : float, optional
        Of the drive [Hz].
    """
    auto = is_one_of(settle, ("auto",))
    if not auto and not (is_whole(settle) and int(settle) >= 0):
        raise InputError("settle", [f'settle = {settle!r}; allowed is "auto" or a number of drive periods; type for example settle=10'])
    if settle == 0:
        return rec, 0, None
    f = rec.drive_frequency().value if frequency is None else given_frequency(frequency)
    count = settling_periods(rec, f) if auto else int(settle)
    if count == 0:
        return rec, 0, None
    start = float(velocity_of(rec)[0][0])
    kept = rec.between(start + (count - 1e-6) / f, np.inf)
    what = "differ from the later ones" if auto else "were to be left out"
    late = auto and count >= int((velocity_of(rec)[0][-1] - start) * f) // 2 - 1
    more = "; the record may not have settled at all" if late else ""
    return (
        kept,
        count,
        f"the first {count} drive periods {what} and are not compared with steady motion{more}; settle=0 takes them as steady",
    )
