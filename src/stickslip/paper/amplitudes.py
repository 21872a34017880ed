"""The amplitudes that the paper omits, determined in each run: those that reproduce its printed values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.paper.borders import exact_types, longest, stretches
from stickslip.paper.cases import AMPLITUDE_5, CASES, EXPERIMENTS, Experiment, rig
from stickslip.paper.followed_motions import Followed, followed
from stickslip.paper.solved_runs import Tell, batch

__all__ = ["ROUNDING", "Amplitudes", "Bracket", "Candidates", "Interval", "infer", "overlap"]

#: Half of the last printed digit of a mean velocity [m/s].
ROUNDING = 5e-5
#: What the five frequencies of Figures 17 to 21 should give, in order.
WANTED = ("rest", "II", "I", "III", "IV")
OMEGAS = np.array([c.changes["omega"] for c in CASES if c.section == "5.2"])
#: Kinetic coefficients at which only types III and IV should appear, and amplitudes among which that is looked for [m].
KINETIC, RANGE = np.array([0.05, 0.10, 0.21]), (5e-4, 9e-4)

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
        return self.joint or overlap(self.coulomb, self.type)

    @property
    def inside(self) -> bool:
        """Whether the amplitude taken lies within."""
        return self.good is not None and self.good[0] - 1e-9 <= self.experiment.amplitude <= self.good[1] + 1e-9


@dataclass(frozen=True, eq=False)
class Candidates:
    """Requirements on one amplitude for all of sections 5.2 to 5.4, and the amplitudes that meet them.

    Parameters
    ----------
    round_values : tuple of dict
        For each multiple of 0.1 mm: amplitude [m], exact types at the five frequencies; LuGre motion at mu0 = 0.04: its kind, its period
        number (0 if it has none) and its largest multiplier (None if it has none).
    frequencies : tuple or None
        Amplitudes [m] at which the five frequencies give rest, II, I, III, IV: by the exact borders.
    period_two : Followed
        The stable motion of period two at mu0 = 0.04, from amplitude to amplitude, by continuation of its orbit.
    only_three_and_four : tuple or None
        Amplitudes [m] from 0.5 to 0.9 mm at which mu0 = 0.05, 0.10 and 0.21 all give type III or IV: by the exact borders.
    """

    round_values: tuple[dict[str, Any], ...]
    frequencies: Interval
    period_two: Followed
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
            found = overlap(found, bracket.good)
        return found


def infer(fast: bool, tell: Tell) -> Amplitudes:
    """Scan the amplitude and keep what reproduces the printed numbers."""
    tell("inferring amplitudes", 0, 2)
    step = 4e-6 if fast else 5e-7
    section4 = tuple(_bracket(e, step) for e in EXPERIMENTS)
    tell("inferring amplitudes", 1, 2)
    section5 = _candidates()
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


def _candidates() -> Candidates:
    round_values = 1e-4 * np.arange(3, 11)
    types = _types(round_values, omega=OMEGAS)
    rows = tuple(
        {"amplitude": float(A), "types": t.tolist(), **m} for A, t, m in zip(round_values, types, _motions(round_values), strict=True)
    )
    by_frequency = stretches(lambda A: (_types(A, omega=OMEGAS) == np.array(WANTED)).all(axis=1), *RANGE)
    by_kinetic = stretches(lambda A: np.isin(_types(A, mu0=KINETIC), ("III", "IV")).all(axis=1), *RANGE)
    two = followed("amplitude", AMPLITUDE_5, *RANGE, period=2, mu0=0.04)
    return Candidates(rows, longest(by_frequency), two, longest(by_kinetic))


def _types(A: Any, **changes: Any) -> Any:
    """Exact types over amplitude and another number of the rig, by the closed borders."""
    return exact_types(rig(CASES[-1], amplitude=A[:, None], f0=0.21, law="coulomb", **changes))


def _motions(A: Any) -> list[dict[str, Any]]:
    """The LuGre motions at mu0 = 0.04: periodic where Newton's method finds a stable orbit, else by the largest exponent."""
    from stickslip.dynamics.attractors.period_maps import chaos_map
    from stickslip.presets import piezo_rig

    seen = chaos_map(piezo_rig, amplitude=A, mu0=0.04, f0=0.21, tilt_deg=1.7, settle=300, periods=300, rtol=1e-7)
    return [_judged(float(a), *map(float, row)) for a, *row in zip(A, seen.period, seen.exponent, seen.error, strict=True)]


def _judged(A: float, period: float, exponent: float, error: float) -> dict[str, Any]:
    from stickslip.dynamics.periodic.periodic_orbits import periodic_orbit
    from stickslip.errors import SolveError

    kind, multiplier = "chaotic" if period == 0 and exponent > 3 * error else "undecided", None
    try:
        orbit = periodic_orbit(rig(CASES[-1], amplitude=A, mu0=0.04, f0=0.21), int(period)) if period else None
        if orbit is not None and orbit.stable:
            kind, multiplier = "periodic", float(abs(orbit.multipliers[0]))
    except SolveError:
        pass
    period = int(period) if kind == "periodic" else 0
    return {"kind": kind, "period": period, "multiplier": multiplier, "exponent": exponent, "error": error}


def _interval(A: Any, good: Any) -> Interval:
    """First and last amplitude of the longest run of good ones."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]]).astype(int)))
    runs = [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
    if not runs:
        return None
    first, last = max(runs, key=lambda r: r[1] - r[0])
    return float(A[first]), float(A[last])


def overlap(one: Interval, other: Interval) -> Interval:
    """Where both hold."""
    if one is None or other is None:
        return None
    low, high = max(one[0], other[0]), min(one[1], other[1])
    return (low, high) if low <= high else None
