"""The data of a fit: the values of one record over the drive phase, with their noise."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.distributions import distribution_of
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.units import SI, quantity_of
from stickslip.basics.variables import VARIABLES
from stickslip.inverse.identification.averages import MOST, averaged
from stickslip.inverse.identification.censored import sides_of
from stickslip.inverse.identification.weighting import weights_at
from stickslip.records import Record
from stickslip.records.given import given_frequency
from stickslip.records.measures import LONGEST, mean_velocity, period_number_of
from stickslip.records.overview import noise
from stickslip.records.settling import settled
from stickslip.records.tones import measured_samples, refuse_constant

_ROTARY = {what: SI[what] for what in ("angle", "angular velocity")}


_OTHER = 4.0  # standard errors beyond which a line of a record is not that of the frequency that was typed
_DELAY = 5.0  # samples by which a delay is looked for where nothing is typed
_MOTION, _MOTION_UNITS = ("position", "velocity"), ("m (rad)", "m/s (rad/s)")


class Compared:
    """Base of what a fit compares with: values y with their weights; what is special of a kind of records says its own class."""

    if TYPE_CHECKING:
        y: Any
        weight: Any
        label: str
        time: Any
    transient: bool = False
    remark: str | None = None
    unit: str = ""
    within: float = 0.0
    in_play: bool = False
    lag: float = 0.0
    known: Any = 1.0
    spared: Any = 0.0  # standard deviations by which each value may be off before it counts
    timeless: bool = False  # whether its values are rows of a table, of which nobody knows when they were taken
    clipped: Any = 0  # which values sit on the upper end (1), or the lower one (-1), of the range of their sensor

    @property
    def exact(self) -> Any:
        """Which values are known themselves, and not only to lie beyond an end: array (n,) of bool."""
        return self.clipped * np.ones(self.count, int) == 0

    @property
    def has_noise(self) -> bool:
        """Whether other noise of the sensors of the input would have shown another one."""
        return False

    @property
    def count(self) -> int:
        """Number of values."""
        return len(self.y)

    def better(self, part: float) -> str:
        """The sensor of the motion that would have so small a part of the noise, in words."""
        measured = getattr(self, "measured", None)
        if measured is None:
            return f"{self.label}: a load cell with {part:.2g} times the noise would do"
        order = min(measured.noise)
        unit = f"{_MOTION[order]} with a noise of {part * measured.noise[order]:.2g} {_MOTION_UNITS[order]}"
        return f"{self.label}: a sensor of the {unit} or less would do, or one of the velocity beside it"

    def delayed(self, h: Array, delay: float) -> Any:
        """Values a little later, of many columns too; between samples they change evenly."""
        columns = [np.interp(self.time - delay, self.time, column) for column in h.reshape(len(h), -1).T]
        return np.stack(columns, axis=1).reshape(h.shape)

    def delay_slope(self, h: Array, delay: float) -> Any:
        """The change of delayed values with time [1/s]."""
        return np.gradient(self.delayed(h, delay) if delay else h, self.time)

    @property
    def step(self) -> float:
        """Usual time between samples [s]."""
        return float(np.median(np.diff(self.time)))

    def finer(self) -> Any:
        """The same with shorter steps where these are long."""
        return self

    @property
    def most_noise(self) -> float:
        """The most that the noise of a value can be, as the record shows it by itself; infinite where it does not."""
        return float("inf")

    @property
    def left_open(self) -> int:
        """How many values beside jumps of a force are left open."""
        return 0

    def late(self, lag: float) -> Any:
        """The same where what jumps is late by so much."""
        return self

    @property
    def longest_delay(self) -> float:
        """The longest delay that is looked for where nothing is typed [s]."""
        return _DELAY * self.step

    def mean_square(self, rest: Array, which: Any = slice(None)) -> float:
        """Mean square of what is left of all samples, from the residuals of the values, or of some of them."""
        return float(np.average(rest[which] ** 2, weights=(self.weight * np.ones(self.count))[which])) + self.within


@sealed
@dataclass(frozen=True, eq=False)
class Target(Compared):
    """The numbers of one record that a model is to give.

    Parameters
    ----------
    kind : {"velocity", "position", "mean"}
    phase : array (n,)
        Drive phases of the samples, in drive periods since the first one.
    y : array (n,)
        Measured values [m/s or m].
    sigma : float
        Standard deviation of the noise of one value.
    frequency : float
        Drive frequency [Hz]; NaN for a bare mean velocity.
    given_sigma : bool
        Whether the user gave the noise; otherwise its size is taken from the residuals.
    label : str
    """

    kind: str
    phase: Any
    y: Any
    sigma: float
    frequency: float
    given_sigma: bool
    label: str
    weight: Any = 1.0  # samples that were averaged into each value
    slips: bool = False  # whether the frequency is fitted further
    transient: bool = False  # whether the first sample is where the motion starts, in a state that is fitted
    placed: bool = False  # whether it matters where that is, so that the position is fitted too
    remark: str | None = None  # what was done about a start that is not steady
    cut: str | None = None  # what was left out of a very long record
    period: int = 1  # drive periods after which the motion repeats, as far as the record tells
    unit: str = ""  # of the values, where it is not that of the kind
    body: int | None = None  # whose motion it is, of a machine whose columns have an axis for bodies
    within: float = 0.0  # mean square, over all samples, of what was lost where they were averaged
    clipped: Any = 0

    @property
    def course(self) -> Any:
        """Where in the record each sample is, from -1/2 to 1/2."""
        return (self.phase - 0.5 * (self.phase[0] + self.phase[-1])) / max(float(self.phase[-1] - self.phase[0]), 1e-300)

    @property
    def time(self) -> Any:
        """Times of the values, counted from the middle of the record [s]."""
        return (self.phase - 0.5 * (self.phase[0] + self.phase[-1])) / self.frequency


def of_body(summary: Any, name: str, body: int | None) -> Any:
    """A column of a summary, of a machine of several bodies that of one."""
    column = np.asarray(getattr(summary, name), float)
    return column if body is None or "body" not in VARIABLES[name].dims else column[..., body]


def target(
    rec: Record, kind: str, sigma: float | None, frequency: float | None, label: str, settle: int | str = "auto", transient: bool = False
) -> Target:
    """The target of a record; ``kind="auto"`` takes the velocity, else the position.

    A start that is not steady is left out (`settle`), or is fitted too (`transient`).
    """
    if not isinstance(rec, Record):
        return mean_target(rec, sigma, label)
    if kind == "auto":
        kind = "velocity" if "velocity" in rec or "position" not in rec else "position"
    remark = None
    if not transient:
        rec, _, remark = settled(rec, settle, frequency)
    if kind == "mean":
        mean = mean_velocity(rec, frequency)
        return dataclasses.replace(mean_target(mean.value, sigma if sigma is not None else mean.error, label), remark=remark)
    t, y = measured_samples(rec[kind])
    own = weights_at(rec, t)
    t, y, own = t[own > 0], y[own > 0], own[own > 0]
    refuse_constant(f"{rec[kind].name!r} of {label}", y, "no number can be fitted to it")
    many = len(t) > MOST and "weight" not in rec and kind == "velocity" and not transient
    clipped, cut = sides_of(y), None
    if many and np.any(clipped):  # an average of clipped samples is nothing
        cut = f"of {len(t)} samples {int(np.sum(clipped != 0))} sit at the end of the sensor's range and are left out"
        t, y, own, clipped = t[clipped == 0], y[clipped == 0], own[clipped == 0], 0
    elif np.any(clipped):
        cut = f"{int(np.sum(clipped != 0))} of {len(t)} samples sit at the end of the sensor's range and count as that or beyond"
    f = rec.drive_frequency().value if frequency is None else given_frequency(frequency)
    cut = cut if frequency is None else "; ".join(filter(None, (cut, _other_line(rec, f)))) or None
    level = noise(np.where(clipped == 0, y, np.nan)) if sigma is None else float(sigma)
    if not level > 0:
        level = 1e-6 * float(np.ptp(y)) or 1.0
    phase = (t - t[0]) * f
    slips = frequency is None and phase[-1] > 2
    repeats = None if transient else period_number_of(phase, y if kind == "velocity" else np.gradient(y, t))
    unit = _ROTARY.get(quantity_of(rec[kind].unit) or "", "")
    known = Target(kind, phase, y, level, f, sigma is not None, label, own, slips, transient)
    whole = dataclasses.replace(known, remark=remark, period=repeats or 1, unit=unit, clipped=clipped, cut=cut)
    return _fewer(whole, repeats) if many and len(t) > MOST else whole


def _other_line(rec: Record, typed: float) -> str:
    """Where the record's own line is, if that is not where the frequency says that was typed."""
    try:
        own = rec.drive_frequency(typed)
    except InputError:
        return ""
    apart = abs(own.value - typed) / max(own.error, 1e-300)
    if apart < _OTHER:
        return ""
    where = f"the line of the record is at {own.value:.6g} Hz and {typed:.6g} Hz was typed, {apart:.2g} standard errors away"
    return f"{where}: correct that, or leave the frequency out, so that it is fitted"


def _fewer(target: Target, repeats: int | None) -> Target:
    """A target of very many samples with fewer values: averages where the motion repeats, else the end of the record."""
    if repeats is None:
        end = slice(target.count - MOST, None)
        said = f"the motion does not repeat within {LONGEST} drive periods: of {target.count} samples only the last {MOST} are compared"
        cut = "; ".join(filter(None, (target.cut, said)))
        return dataclasses.replace(target, phase=target.phase[end], y=target.y[end], weight=target.weight[end], cut=cut)
    phase, y, weight, within, scatter = averaged(target.phase, target.y, repeats)
    level = target.sigma if target.given_sigma else max(target.sigma, scatter)
    return dataclasses.replace(target, phase=phase, y=y, weight=weight, within=within, sigma=level)


def mean_target(value: Any, sigma: float | None, label: str) -> Target:
    """A mean velocity [m/s] as a target, with its error or bare."""
    known = distribution_of(value)
    if known:
        return dataclasses.replace(mean_target(known.mean, known.sd, label), given_sigma=True)
    try:
        y = np.array([float(value)])
    except (TypeError, ValueError):
        raise InputError("identify", [f"{label} = {value!r}; allowed is a Record, or a mean velocity [m/s]"]) from None
    return Target("mean", np.zeros(1), y, 1.0 if sigma is None else float(sigma), float("nan"), sigma is not None, label, np.ones(1))
