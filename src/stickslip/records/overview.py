"""The summary of a record: the quantities measured, sampling rates, and quality."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import ArrayLike
from stickslip.basics.errors import InputError
from stickslip.basics.units import unit_named
from stickslip.records.tones import NotPeriodic

if TYPE_CHECKING:
    from stickslip.records.record import Record


@dataclass(frozen=True)
class ChannelSummary:
    """One channel in numbers, in the channel's own unit."""

    name: str
    unit: str | None
    role: str | None
    count: int
    rate: float
    rate_unit: str
    duration: float
    gaps: int
    missing: int
    least: float
    largest: float
    noise: float
    clipped: int


@dataclass(frozen=True)
class Overview:
    """The summary of a record.

    Parameters
    ----------
    lines : tuple of ChannelSummary
        One for each channel.
    frequency, frequency_error : float or None
        Drive frequency and its standard error [Hz]; None where none could be found.
    notes : tuple of str
    format : str
    synthetic : bool
    aperiodic : str or None
        Why there is no drive frequency, where the record was searched for one.
    """

    lines: tuple[ChannelSummary, ...]
    frequency: float | None
    frequency_error: float | None
    notes: tuple[str, ...]
    format: str
    synthetic: bool
    aperiodic: str | None = None

    @property
    def line_word(self) -> str:
        """The name of the frequency: a record of a force, torque or current without a drive is of no shaken robot."""
        roles = {c.role for c in self.lines}
        return "frequency of the motion" if roles & {"force", "current"} and "drive" not in roles else "drive frequency"

    @property
    def facts(self) -> dict[str, str]:
        """What there is to say of the whole record."""
        facts = {"format": self.format} if self.format else {}
        if self.frequency is not None:
            facts[self.line_word] = f"{self.frequency:.9g} ± {self.frequency_error:.2g} Hz"
        elif self.aperiodic is not None:
            facts[self.line_word] = f"none: {self.aperiodic}"
        return facts

    @property
    def table(self) -> list[tuple[str, ...]]:
        """The channels as rows of text below a heading."""
        head = ("channel", "unit", "role", "values", "rate", "least", "largest", "noise", "gaps", "missing", "clipped")
        rows = [
            (
                c.name, c.unit or "?", c.role or "", str(c.count), f"{c.rate:.6g} {c.rate_unit}", f"{c.least:.6g}", f"{c.largest:.6g}",
                f"{c.noise:.3g}" if np.isfinite(c.noise) else "", *(str(n) if n else "" for n in (c.gaps, c.missing, c.clipped)),
            )
            for c in self.lines
        ]  # fmt: skip
        return [head, *rows]

    def __str__(self) -> str:
        rows = ["SYNTHETIC: computed, not measured"] if self.synthetic else []
        rows.append(f"{self.format}, {len(self.lines)} channel{'' if len(self.lines) == 1 else 's'}")
        for c in self.lines:
            more = [f"noise {c.noise:.3g}" if np.isfinite(c.noise) else "", f"{c.gaps} gaps" if c.gaps else ""]
            more += [f"{c.missing} missing" if c.missing else "", f"{c.clipped} clipped" if c.clipped else ""]
            size = f"{c.least:.6g} to {c.largest:.6g}"
            rows.append(
                f"  {c.name} [{c.unit or '?'}]{f', {c.role}' if c.role else ''}: {c.count} values at {c.rate:.6g} {c.rate_unit}, "
                + ", ".join([size, *(m for m in more if m)])
            )
        if self.frequency is not None:
            rows.append(f"{self.line_word} {self.frequency:.9g} ± {self.frequency_error:.2g} Hz")
        elif self.aperiodic is not None:
            rows.append(f"no {self.line_word}: {self.aperiodic}")
        return "\n".join([*rows, *(f"note: {note}" for note in self.notes)])


def overview(rec: Record) -> Overview:
    """The summary of a record."""
    frequency, why = None, None
    with np.errstate(all="ignore"):  # a damaged record holds any number
        lines = tuple(_line(c) for c in rec.channels.values())
        try:
            frequency = rec.drive_frequency()
        except NotPeriodic as said:
            why = said.problems[0]
        except (InputError, np.linalg.LinAlgError):
            pass
    value, error = (None, None) if frequency is None else (frequency.value, frequency.error)
    return Overview(lines, value, error, rec.notes, str(rec.source.get("format", "")), rec.synthetic, why)


def _line(c: Any) -> ChannelSummary:
    values = abs(c.values) if np.iscomplexobj(c.values) else c.values
    good = values[np.isfinite(values)]
    least, largest = (float(good.min()), float(good.max())) if len(good) else (float("nan"),) * 2
    span = float(np.nanmax(c.t) - np.nanmin(c.t)) if len(c.t) and np.isfinite(c.t).any() else 0.0
    unit = unit_named(c.axis_unit)
    missing = len(values) - len(good)
    return ChannelSummary(
        c.name, c.unit, c.role, len(c), float(c.rate), c.rate_unit, span * (unit.factor if unit else 1.0), len(c.gaps), missing,
        least, largest, noise(values) if c.over_time else float("nan"), clipped(values),
    )  # fmt: skip


def noise(y: ArrayLike) -> float:
    """Standard deviation of the noise of a channel, in its unit: from third differences, which a smooth signal hardly has.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> 0.95 < noise(np.sin(np.arange(20000) / 200) + rng.normal(size=20000)) < 1.05
    True
    """
    y = np.asarray(y, float)
    bends = np.diff(y, 3)
    bends = bends[np.isfinite(bends)]
    if len(bends) < 8:
        return float("nan")
    return float(np.median(abs(bends - np.median(bends))) / 0.6744897501960817 / np.sqrt(20))


_NEXT, _MANY = 5, 6  # values next to an extreme one, and how many times as often that must come to be an end of the range


def runs_of(which: Any) -> Any:
    """Where runs of samples begin and end: array (runs, 2)."""
    which = np.concatenate([[False], which, [False]])
    return np.flatnonzero(which[1:] != which[:-1]).reshape(-1, 2)


def clipped(y: Any, least: int = 3) -> int:
    """How many samples sit on the end of the range (see `clipped_sides`).

    Examples
    --------
    >>> clipped(np.clip(np.sin(np.arange(1000) / 10), -0.8, 0.8)) > 300, clipped(np.sin(np.arange(1000) / 10))
    (True, 0)
    """
    return int(np.sum(clipped_sides(y, least) != 0))


def clipped_sides(y: Any, least: int = 3) -> Any:
    """Which samples sit on the end of the range: 1 on the upper end, -1 on the lower one, 0 elsewhere; array (n,).

    An end is one of the range, and not of the motion, where runs of extreme values begin or end with a jump, or where many more samples
    have the extreme value than have any of those next to it (the counts of a slow sine fall to a third from the last to the next ones).

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> wave = np.sin(np.arange(1000) / 10) + 1e-3 * rng.normal(size=1000)
    >>> clipped_sides(np.clip(wave, -2, 0.99)).tolist().count(1) > 40, bool(np.any(clipped_sides(np.round(wave, 2))))
    (True, False)
    """
    y = np.asarray(y, float)
    sides = np.zeros(len(y), int)
    if len(y) < 8 or not np.nanmax(y, initial=-np.inf) > np.nanmin(y, initial=np.inf):
        return sides
    for side, value in ((1, np.nanmax(y)), (-1, np.nanmin(y))):
        there = y == value
        if value == 0.0 or int(there.sum()) < least:  # zero is rest
            continue
        runs = runs_of(there)
        runs = runs[runs[:, 1] - runs[:, 0] >= least]
        if len(runs) > 1:  # the counts of a coarse record are no jumps
            runs = runs[_jumps(y, runs) > 2 * max(_usual_bend(y), float(np.median(np.diff(np.unique(y[np.isfinite(y)])))))]
        if len(runs) > 1 or _crowded(y, side):
            sides[there] = side
    return sides


def _crowded(y: Any, side: int) -> bool:
    """Whether many more samples have an extreme value than have any of the values next to it."""
    known = side * y[np.isfinite(y)]
    grain = 1e-9 * float(np.ptp(known))
    values, counts = np.unique(np.round(known / grain), return_counts=True)
    neighbours = counts[-1 - _NEXT : -1]
    return len(values) > _NEXT and bool(counts[-1] >= _MANY * max(int(neighbours.max()), 1))


def _usual_bend(y: Any) -> float:
    """The median size of second differences; 0 where none is finite."""
    bends = np.diff(y, 2)
    np.abs(bends, out=bends)
    if not (good := np.isfinite(bends)).all():
        bends = bends[good]
    return float(np.median(bends, overwrite_input=True)) if len(bends) else 0.0


def dead_zone(y: Any, least: int = 3) -> float:
    """Half width of a dead zone about zero, in the unit of the channel: zeros in many runs that begin and end with a jump; 0 where none is.

    Examples
    --------
    >>> y = np.sin(np.arange(4000) / 30)
    >>> round(dead_zone(np.where(abs(y) < 0.2, 0.0, y)), 1), dead_zone(np.maximum(y, 0.0)), dead_zone(y)
    (0.2, 0.0, 0.0)
    """
    y = np.asarray(y, float)
    if not (good := np.isfinite(y)).all():
        y = y[good]
    still = y == 0.0
    if int(np.sum(np.diff(runs_of(still)) >= least)) < 4 or not ((y > 0).any() and (y < 0).any()):
        return 0.0
    moving = abs(np.diff(y))[~(still[1:] | still[:-1])]
    moving = moving[moving > 0]
    if len(moving) < 8:
        return 0.0
    width = min(float(y[y > 0].min()), float(-y[y < 0].max()))
    return width if width > 2.5 * float(np.median(moving)) else 0.0


def _jumps(y: Any, runs: Any) -> Any:
    """The larger of the steps by which each run is entered and left."""
    first, last = runs[:, 0], runs[:, 1] - 1
    into, out = abs(y[first] - y[np.maximum(first - 1, 0)]), abs(y[np.minimum(last + 1, len(y) - 1)] - y[last])
    return np.maximum(into, out)
