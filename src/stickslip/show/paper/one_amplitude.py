"""One amplitude for sections 5.2, 5.3 and 6, which print none: how many of their statements hold at each, under either break-away."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.dynamics.attractors.kinds_of_motion import PERIODIC, UNSETTLED
from stickslip.show.paper.borders import FOUR, exact_types
from stickslip.show.paper.cases import AMPLITUDE_5, CASES, rig
from stickslip.show.paper.followed_motions import Followed, stable_range
from stickslip.show.paper.readings import PRINTED_READING, STATED, Reading
from stickslip.show.paper.solved_runs import Tell

__all__ = ["KINETIC", "STATEMENTS", "WANTED", "AmplitudeSearch", "ReadingSearch", "amplitude_search"]

#: Motion types expected at the five frequencies of Figures 17 to 21, in order of the frequency: the paper prints none of them.
WANTED = ("rest", "II", "I", "III", "IV")
OMEGAS = np.array([c.changes["omega"] for c in CASES if c.section == "5.2"])
#: Kinetic coefficients of Figures 24 to 26, and those of the range in which only types III and IV should appear.
KINETIC = np.array([0.05, 0.10, 0.21])
STATIC = np.array([c.changes["f0"] for c in CASES if c.section == "5.4"])
#: Amplitudes searched [m].
RANGE = (3e-4, 1.2e-3)
STATEMENTS = {
    "frequencies": "5.2: the five frequencies pass through rest, II, I, III and IV",
    "period_two": "5.3: period two at μ₀ = 0.04",
    "three_and_four": "5.3: types III or IV at μ₀ = 0.05, 0.10 and 0.21",
    "not_by_kinetic": "6: the dynamic coefficient does not give all four types",
    "static": "5.4: f₀ = 0.18, 0.35, 0.5 and 1 give the four types",
}


@dataclass(frozen=True, eq=False)
class ReadingSearch:
    """The statements under one reading.

    Parameters
    ----------
    reading : Reading
    amplitude : array
        The amplitudes [m].
    holds : dict
        Key of a statement -> whether it holds at each amplitude.
    """

    reading: Reading
    amplitude: Any
    holds: dict[str, Any]

    @property
    def count(self) -> Any:
        """The number of statements that hold at each amplitude."""
        return sum(np.asarray(held, int) for held in self.holds.values())

    @property
    def most(self) -> int:
        """The largest number of statements that hold at once."""
        return int(self.count.max())

    @property
    def best(self) -> tuple[float, float]:
        """The longest run of amplitudes at which most statements hold [m]."""
        return longest_run(self.amplitude, self.count == self.most)

    @property
    def held(self) -> tuple[str, ...]:
        """The statements that hold in the middle of that run, in words."""
        at = int(np.argmin(abs(self.amplitude - 0.5 * sum(self.best))))
        return tuple(STATEMENTS[key] for key, held in self.holds.items() if held[at])

    def window(self, key: str) -> tuple[float, float] | None:
        """The longest run of amplitudes at which a statement holds [m]; None if it never does."""
        return longest_run(self.amplitude, self.holds[key]) if self.holds[key].any() else None

    def as_data(self) -> dict[str, Any]:
        """The search as plain data, SI units."""
        return {
            "breakaway": self.reading.breakaway, "most": self.most, "of": len(self.holds), "amplitudes": self.best, "statements": self.held,
            "windows": {key: self.window(key) for key in self.holds},
        }  # fmt: skip


def longest_run(A: Any, good: Any) -> tuple[float, float]:
    """First and last of the longest run of good values.

    Examples
    --------
    >>> longest_run(np.arange(6.0), np.array([1, 0, 1, 1, 1, 0], bool))
    (2.0, 4.0)
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]]).astype(int)))
    first, last = max(zip(edges[::2], edges[1::2], strict=True), key=lambda pair: int(pair[1] - pair[0]))
    return float(A[first]), float(A[last - 1])


@dataclass(frozen=True, eq=False)
class AmplitudeSearch:
    """The search under both readings, and what was computed for it.

    Parameters
    ----------
    searches : tuple of ReadingSearch
        Break-away at f0, and as Eq. 2.4 has it.
    round_values : tuple of dict
        For each multiple of 0.1 mm: amplitude [m]; LuGre motion at mu0 = 0.04: its kind, its period number (0 if it has none) and its
        largest multiplier (None if it has none).
    period_two : Followed
        The stable motion of period two at mu0 = 0.04 and its range of amplitudes, by continuation of its orbit.
    """

    searches: tuple[ReadingSearch, ...]
    round_values: tuple[dict[str, Any], ...]
    period_two: Followed

    @property
    def stated(self) -> ReadingSearch:
        """The search under the stated reading."""
        return next(s for s in self.searches if s.reading == STATED)

    @property
    def printed(self) -> ReadingSearch:
        """The search under Eq. 2.4 to the letter."""
        return next(s for s in self.searches if s.reading == PRINTED_READING)


def amplitude_search(fast: bool, tell: Tell) -> AmplitudeSearch:
    """Search the amplitude under both readings of break-away."""
    tell("searching one amplitude for section 5", 0, 3)
    two = stable_range("amplitude", AMPLITUDE_5, 5e-4, 9e-4, period=2, fixed={"mu0": 0.04})
    A = (1e-5 if fast else 2e-6) * np.arange(round(RANGE[0] / (1e-5 if fast else 2e-6)), round(RANGE[1] / (1e-5 if fast else 2e-6)) + 1)
    searches = []
    for i, reading in enumerate((STATED, PRINTED_READING)):
        tell("searching one amplitude for section 5", i + 1, 3)
        searches.append(_search(reading, np.round(A, 9), two, 31 if fast else 91))
    rows = tuple({"amplitude": float(a), **m} for a, m in zip(1e-4 * np.arange(3, 11), _motions(1e-4 * np.arange(3, 11)), strict=True))
    tell("searching one amplitude for section 5", 3, 3)
    return AmplitudeSearch(tuple(searches), rows, two)


def _search(reading: Reading, A: Any, two: Followed, points: int) -> ReadingSearch:
    at: Callable[..., Any] = lambda **changes: exact_types(reading.coulomb(CASES[-1], amplitude=A[:, None], **changes))  # noqa: E731
    along = at(f0=0.21, mu0=np.linspace(np.tan(np.radians(1.7)) * (1 + 1e-6), 0.21, points))
    holds = {
        "frequencies": (at(f0=0.21, omega=OMEGAS) == np.array(WANTED)).all(axis=1),
        "period_two": (two.low.value <= A) & (two.high.value >= A),
        "three_and_four": np.isin(at(f0=0.21, mu0=KINETIC), ("III", "IV")).all(axis=1),
        "not_by_kinetic": np.array([not set(FOUR) <= set(row) for row in along.tolist()]),
        "static": np.array([set(FOUR) <= set(row) for row in at(f0=STATIC).tolist()]),
    }
    return ReadingSearch(reading, A, holds)


def _motions(A: Any) -> list[dict[str, Any]]:
    """The LuGre motions at mu0 = 0.04, by the rule of `chaos_map`; periodic ones with the largest multiplier of their orbit."""
    from stickslip.dynamics.attractors.period_maps import chaos_map
    from stickslip.models.presets import piezo_rig

    computed = chaos_map(piezo_rig, amplitude=A, mu0=0.04, f0=0.21, tilt_deg=1.7, settle=300, periods=300, rtol=1e-7)
    columns = (computed.motion.values.tolist(), *(computed[name].values.tolist() for name in ("period", "exponent", "error")))
    return [_with_its_orbit(float(a), *row) for a, *row in zip(A, *columns, strict=True)]


def _with_its_orbit(A: float, kind: str, period: int, exponent: float, error: float) -> dict[str, Any]:
    """A motion, and the largest multiplier of its orbit; without a stable orbit it has not settled."""
    from stickslip.basics.errors import SolveError
    from stickslip.dynamics.periodic.periodic_orbits import periodic_orbit

    multiplier = None
    if kind == PERIODIC:
        with suppress(SolveError):
            orbit = periodic_orbit(rig(CASES[-1], amplitude=A, mu0=0.04, f0=0.21), period)
            multiplier = float(abs(orbit.multipliers[0])) if orbit.stable else None
        kind = UNSETTLED if multiplier is None else kind
    return {"kind": kind, "period": period if kind == PERIODIC else 0, "multiplier": multiplier, "exponent": exponent, "error": error}
