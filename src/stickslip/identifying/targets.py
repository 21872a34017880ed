"""What a fit compares with: the numbers of one record over the drive's phase, with their noise."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.errors import InputError
from stickslip.records import Record
from stickslip.records.overview import noise
from stickslip.records.settling import settled
from stickslip.records.tones import _finite

__all__ = ["KINDS", "Target", "mean_target", "target"]

#: What can be fitted.
KINDS = ("velocity", "position", "mean", "force")
_MOST = 20_000  # samples of one record; more are averaged over neighbouring phases
_BINS = 4000


@dataclass(frozen=True, eq=False)
class Target:
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
    said: str | None = None  # what was done about a start that is not steady

    @property
    def course(self) -> Any:
        """Where in the record each sample is, from -1/2 to 1/2."""
        return (self.phase - 0.5 * (self.phase[0] + self.phase[-1])) / max(float(self.phase[-1] - self.phase[0]), 1e-300)

    @property
    def count(self) -> int:
        """Number of values."""
        return len(self.y)


def target(
    rec: Any, kind: str, sigma: float | None, frequency: float | None, label: str, settle: int | str = "auto", transient: bool = False
) -> Target:
    """The target of a record; ``kind="auto"`` takes the velocity, else the position.

    A start that is not steady is left out (`settle`), or is fitted too (`transient`).
    """
    if not isinstance(rec, Record):
        return mean_target(rec, sigma, label)
    if kind == "auto":
        kind = "velocity" if "velocity" in rec or "position" not in rec else "position"
    said = None
    if not transient:
        rec, _, said = settled(rec, settle, frequency)
    if kind == "mean":
        from stickslip.records.measures import mean_velocity

        found = mean_velocity(rec, frequency)
        return dataclasses.replace(mean_target(found.value, sigma if sigma is not None else found.error, label), said=said)
    t, y = _finite(rec[kind])
    f = rec.drive_frequency().value if frequency is None else float(frequency)
    level = noise(y) if sigma is None else float(sigma)
    if not level > 0:
        level = 1e-6 * float(np.ptp(y)) or 1.0
    phase, weight = (t - t[0]) * f, np.ones(len(t))
    slips = frequency is None and len(t) <= _MOST and phase[-1] > 2
    if len(t) > _MOST and kind == "velocity" and not transient:
        phase, y, weight = _averaged(phase, y)
    return Target(kind, phase, y, level, f, sigma is not None, label, weight, slips, transient, said)


def _averaged(phase: Any, y: Any) -> tuple[Any, Any, Any]:
    """Means over neighbouring phases of one drive period."""
    place = np.mod(phase, 1.0)
    index = np.minimum((place * _BINS).astype(int), _BINS - 1)
    count = np.bincount(index, minlength=_BINS)
    kept = count > 0
    means = [np.bincount(index, a, _BINS)[kept] / count[kept] for a in (place, y)]
    return means[0], means[1], count[kept].astype(float)


def mean_target(value: Any, sigma: float | None, label: str) -> Target:
    """A bare mean velocity [m/s] as a target."""
    try:
        y = np.array([float(value)])
    except (TypeError, ValueError):
        raise InputError("identify", [f"{label} = {value!r}; allowed is a Record, or a mean velocity [m/s]"]) from None
    return Target("mean", np.zeros(1), y, 1.0 if sigma is None else float(sigma), float("nan"), sigma is not None, label, np.ones(1))
