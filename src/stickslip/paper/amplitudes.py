"""The amplitudes that the paper leaves out, found again in this very run: which of them reproduce what it prints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.paper.cases import AMPLITUDE_5, CASES, EXPERIMENTS, Experiment, rig
from stickslip.paper.runs import Tell, batch

__all__ = ["ROUNDING", "Amplitudes", "Bracket", "Candidates", "Interval", "infer"]

#: Half of the last printed digit of a mean velocity [m/s].
ROUNDING = 5e-5
#: What the five frequencies of Figures 17 to 21 should give, in order.
WANTED = ("rest", "II", "I", "III", "IV")

Interval = tuple[float, float] | None


@dataclass(frozen=True, eq=False)
class Bracket:
    """Amplitudes of one angle of section 4 that reproduce what is printed.

    Parameters
    ----------
    experiment : Experiment
    coulomb, lugre : tuple or None
        First and last amplitude [m] at which our mean velocity rounds to the printed one, with either law.
    type : tuple or None
        Amplitudes [m] at which the exact Coulomb motion is of the printed type.
    joint : tuple or None
        All three at once.
    misses : float
        By how much the LuGre velocity misses its rounding at the best amplitude where the other two hold [m/s]; 0 if it does not.
    step : float
        Step of the scan [m].
    scan : dict
        The scan itself: amplitude, coulomb, lugre [m, m/s, m/s].
    """

    experiment: Experiment
    coulomb: Interval
    lugre: Interval
    type: Interval
    joint: Interval
    misses: float
    step: float
    scan: dict[str, Any]

    @property
    def good(self) -> Interval:
        """All three at once, or the first two where the LuGre velocity cannot be had."""
        return self.joint or _overlap(self.coulomb, self.type)


@dataclass(frozen=True, eq=False)
class Candidates:
    """What one amplitude for all of sections 5.2 to 5.4 has to do, and which ones do it.

    Parameters
    ----------
    round_values : tuple of dict
        For each multiple of 0.1 mm: amplitude [m], exact types at the five frequencies, LuGre period number at mu0 = 0.04.
    frequencies : tuple or None
        Amplitudes [m] at which the five frequencies give rest, II, I, III, IV.
    period_two : tuple or None
        Amplitudes [m] around the chosen one at which mu0 = 0.04 gives period two.
    only_three_and_four : tuple or None
        Amplitudes [m] at which mu0 = 0.05, 0.10 and 0.21 all give type III or IV.
    """

    round_values: tuple[dict[str, Any], ...]
    frequencies: Interval
    period_two: Interval
    only_three_and_four: Interval

    @property
    def chosen(self) -> tuple[float, ...]:
        """The round values that do everything [m]."""
        return tuple(r["amplitude"] for r in self.round_values if tuple(r["types"]) == WANTED and r["period"] == 2)


@dataclass(frozen=True, eq=False)
class Amplitudes:
    """Both inferences."""

    section4: tuple[Bracket, ...]
    section5: Candidates

    @property
    def common(self) -> Interval:
        """An amplitude that would serve all four angles of section 4."""
        found: Interval = (0.0, np.inf)
        for bracket in self.section4:
            found = _overlap(found, bracket.good)
        return found


def infer(fast: bool, tell: Tell) -> Amplitudes:
    """Scan the amplitude and keep what reproduces the printed numbers."""
    tell("inferring amplitudes", 0, 2)
    step = 4e-6 if fast else 5e-7
    section4 = tuple(_bracket(e, step) for e in EXPERIMENTS)
    tell("inferring amplitudes", 1, 2)
    section5 = _candidates(5e-6 if fast else 1e-6)
    tell("inferring amplitudes", 2, 2)
    return Amplitudes(section4, section5)


def _bracket(e: Experiment, step: float) -> Bracket:
    coarse = np.arange(3e-4, 1.8e-3, 2e-5)
    near = coarse[abs(_velocity(e, coarse, "coulomb") - e.coulomb) < 0.25 * e.coulomb]
    A = step * np.arange(round(near[0] / step), round(near[-1] / step) + 1)
    exact = batch(rig(e, amplitude=A, law="coulomb"), settle="auto")
    lugre = batch(rig(e, amplitude=A), periods=100, settle=80).mean_velocity
    by_coulomb, by_lugre = abs(exact.mean_velocity - e.coulomb) <= ROUNDING, abs(lugre - e.lugre) <= ROUNDING
    by_type = exact.motion_type == e.type
    rest = by_coulomb & by_type
    misses = max(float(np.min(abs(lugre - e.lugre)[rest], initial=np.inf)) - ROUNDING, 0.0)
    scan = {"amplitude": A, "coulomb": exact.mean_velocity, "lugre": lugre}
    return Bracket(
        e, _interval(A, by_coulomb), _interval(A, by_lugre), _interval(A, by_type), _interval(A, rest & by_lugre), misses, step, scan
    )


def _velocity(e: Experiment, A: Any, law: str) -> Any:
    return batch(rig(e, amplitude=A, law=law), settle="auto").mean_velocity


def _candidates(step: float) -> Candidates:
    round_values = 1e-4 * np.arange(3, 11)
    types, periods = _types_by_frequency(round_values), _periods(round_values)
    rows = tuple(
        {"amplitude": float(A), "types": t.tolist(), "period": int(p)} for A, t, p in zip(round_values, types, periods, strict=True)
    )
    A = step * np.arange(round(5e-4 / step), round(9e-4 / step) + 1)
    by_frequency = (_types_by_frequency(A) == np.array(WANTED)).all(axis=1)
    larger = np.array([0.05, 0.10, 0.21])
    by_kinetic = batch(rig(CASES[-1], amplitude=A[:, None], mu0=larger, f0=0.21, law="coulomb"), settle="auto").motion_type
    return Candidates(
        rows,
        _interval(A, by_frequency),
        _interval(A, _periods(A) == 2, around=AMPLITUDE_5),
        _interval(A, np.isin(by_kinetic, ("III", "IV")).all(axis=1)),
    )


def _types_by_frequency(A: Any) -> Any:
    omegas = np.array([c.changes["omega"] for c in CASES if c.section == "5.2"])
    return batch(rig(CASES[-1], amplitude=A[:, None], omega=omegas, f0=0.21, law="coulomb"), settle="auto").motion_type


def _periods(A: Any) -> Any:
    return batch(rig(CASES[-1], amplitude=A, mu0=0.04, f0=0.21), periods=200).period


def _interval(A: Any, good: Any, around: float | None = None) -> Interval:
    """First and last amplitude of the longest run of good ones, or of the run that holds `around`."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]]).astype(int)))
    runs = [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    if around is not None:
        runs = [r for r in runs if A[r[0]] - 1e-12 <= around <= A[r[1]] + 1e-12]
    if not runs:
        return None
    first, last = max(runs, key=lambda r: r[1] - r[0])
    return float(A[first]), float(A[last])


def _overlap(one: Interval, other: Interval) -> Interval:
    if one is None or other is None:
        return None
    low, high = max(one[0], other[0]), min(one[1], other[1])
    return (low, high) if low <= high else None
