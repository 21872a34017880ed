"""The amplitudes that the paper omits, determined in each run, over every reading of the text: those that reproduce what it prints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.show.paper.cases import EXPERIMENTS, PrintedExperiment
from stickslip.show.paper.one_amplitude import AmplitudeSearch, amplitude_search
from stickslip.show.paper.readings import READINGS, STATED, Reading
from stickslip.show.paper.solved_runs import Tell, batch, steady_velocity

__all__ = ["ROUNDING", "AmplitudeBracket", "Amplitudes", "Interval", "ReadingFit", "infer", "overlap"]

#: Half of the last printed digit of a mean velocity [m/s].
ROUNDING = 5e-5

Interval = tuple[float, float] | None


@dataclass(frozen=True, eq=False)
class AmplitudeBracket:
    """Amplitudes for one angle of section 4 that reproduce the printed values under one reading.

    Parameters
    ----------
    experiment : PrintedExperiment
    coulomb, lugre : tuple or None
        First and last amplitude [m] at which our mean velocity, of a motion that has settled, rounds to the printed one, with either law.
    type : tuple or None
        Amplitudes [m] at which the exact Coulomb motion is of the printed type.
    joint : tuple or None
        Amplitudes [m] at which all three conditions hold.
    velocities, types : int
        Printed velocities (of two) and types (of one) that come out at the amplitude at which most do.
    step : float
        Step of the scan [m].
    scan : dict
        The scan itself: amplitude, coulomb, lugre [m, m/s, m/s].
    """

    experiment: PrintedExperiment
    coulomb: Interval
    lugre: Interval
    type: Interval
    joint: Interval
    velocities: int
    types: int
    step: float
    scan: dict[str, Any]

    @property
    def inside(self) -> bool:
        """Whether the amplitude taken lies in the interval of all three conditions."""
        return self.joint is not None and self.joint[0] - 1e-9 <= self.experiment.amplitude <= self.joint[1] + 1e-9


@dataclass(frozen=True, eq=False)
class ReadingFit:
    """Section 4 under one reading: its four angles, and how many of the printed velocities and types come out."""

    reading: Reading
    brackets: tuple[AmplitudeBracket, ...]

    @property
    def velocities(self) -> int:
        """Printed mean velocities that come out, of eight."""
        return sum(b.velocities for b in self.brackets)

    @property
    def types(self) -> int:
        """Printed types that come out, of four."""
        return sum(b.types for b in self.brackets)

    def as_data(self) -> dict[str, Any]:
        """The reading and its windows as plain data, SI units."""
        windows = [
            {"tilt_deg": b.experiment.tilt_deg, "window": b.joint, "velocities": b.velocities, "type": b.types} for b in self.brackets
        ]
        return {**vars(self.reading), "velocities": self.velocities, "types": self.types, "angles": windows}


@dataclass(frozen=True, eq=False)
class Amplitudes:
    """The inferred amplitudes of sections 4 and 5, the reading under which most comes out first."""

    fits: tuple[ReadingFit, ...]
    section5: AmplitudeSearch

    @property
    def section4(self) -> tuple[AmplitudeBracket, ...]:
        """The four angles under the stated reading."""
        return next(f.brackets for f in self.fits if f.reading == STATED)

    @property
    def common(self) -> Interval:
        """The interval of amplitudes common to all four angles of section 4; None if there is none."""
        shared: Interval = (0.0, np.inf)
        for bracket in self.section4:
            shared = overlap(shared, bracket.joint)
        return shared


def infer(fast: bool, tell: Tell) -> Amplitudes:
    """Scan the amplitude for the values that reproduce the printed numbers."""
    step, fits = 1e-6 if fast else 5e-7, []
    for i, reading in enumerate(READINGS):
        tell("inferring amplitudes of section 4", i, len(READINGS))
        fits.append(ReadingFit(reading, tuple(_bracket(e, reading, 5e-7 if reading == STATED else step) for e in EXPERIMENTS)))
    tell("inferring amplitudes of section 4", len(READINGS), len(READINGS))
    order = sorted(fits, key=lambda f: -(f.velocities + f.types))
    return Amplitudes(tuple(order), amplitude_search(fast, tell))


def _bracket(e: PrintedExperiment, reading: Reading, step: float) -> AmplitudeBracket:
    coarse = np.arange(3e-4, 1.8e-3, 2e-5)
    rough = steady_velocity(batch(reading.coulomb(e, amplitude=coarse), settle="auto"))
    near = coarse[abs(rough - e.coulomb) < 0.25 * e.coulomb]
    A = np.arange(round(near[0] / step), round(near[-1] / step) + 1) / round(
        1 / step
    )  # the decimal numbers themselves: 0.000559, not 0.0005589999…
    exact = batch(reading.coulomb(e, amplitude=A), settle="auto")
    coulomb = steady_velocity(exact)
    there = abs(coulomb / e.coulomb - 1) < 0.12  # LuGre's velocities are sought where the exact ones are near the printed one
    lugre = np.full(len(A), np.nan)
    lugre[there] = steady_velocity(batch(reading.lugre(e, amplitude=A[there]), periods=100, settle=80))
    by_coulomb, by_lugre = abs(coulomb - e.coulomb) <= ROUNDING, abs(lugre - e.lugre) <= ROUNDING
    by_type = (exact.motion_type == e.type) & np.isfinite(coulomb)
    best = int(np.argmax(by_coulomb.astype(int) + by_lugre + by_type))
    scan = {"amplitude": A, "coulomb": coulomb, "lugre": lugre}
    one, two, three, joint = (_interval(A, good) for good in (by_coulomb, by_lugre, by_type, by_coulomb & by_lugre & by_type))
    return AmplitudeBracket(e, one, two, three, joint, int(by_coulomb[best]) + int(by_lugre[best]), int(by_type[best]), step, scan)


def _interval(A: Any, good: Any) -> Interval:
    """First and last amplitude of the longest run of good ones."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]]).astype(int)))
    runs = [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    if not runs:
        return None
    first, last = max(runs, key=lambda r: r[1] - r[0])
    return float(A[first]), float(A[last])


def overlap(one: Interval, other: Interval) -> Interval:
    """The intersection of two intervals."""
    if one is None or other is None:
        return None
    low, high = max(one[0], other[0]), min(one[1], other[1])
    return (low, high) if low <= high else None
