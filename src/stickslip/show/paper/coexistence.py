"""Section 5.4 from several initial states: coexisting motions of a LuGre body over static coefficient and amplitude."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.show.paper.borders import kinds
from stickslip.show.paper.cases import CASES, OMEGA, rig
from stickslip.show.paper.followed_motions import Followed, stable_range
from stickslip.show.paper.solved_runs import batch

__all__ = ["STARTS", "Coexistence", "Range", "coexistence"]

#: Initial velocities in units of A mu omega, at drive phase 0 with unstretched bristles; the first is rest.
STARTS = (0.0, -1.5, -1.0, 1.0)
#: Difference of mean velocities that distinguishes two motions, in units of A mu omega (settled ones agree to 1e-6).
APART = 1e-3


@dataclass(frozen=True)
class Range:
    """Amplitudes at which two stable motions coexist for one of the printed static coefficients.

    Parameters
    ----------
    f0 : float
    slide, rest : Followed
        The sliding motion, followed down to its end; and the motion reached from rest, followed up.
    both : (float, float)
        First and last amplitude at which both were reached from the initial states [m].
    """

    f0: float
    slide: Followed
    rest: Followed
    both: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Coexistence:
    """Results from several initial states.

    Parameters
    ----------
    f0, amplitude : array
        Axes of the grid.
    spread : array (amplitude, f0)
        Largest minus smallest mean velocity over the initial states, in units of A mu omega, with LuGre friction.
    exact : array (amplitude, f0)
        The same for the exact motion with break-away at f0.
    printed : array
        The four printed f0.
    fine : array
        Amplitudes of the finer scan at the printed f0.
    words : array (fine, printed, starts)
        LuGre labels there, at the default thresholds.
    ranges : tuple of Range
        Ranges in which two motions coexist at a printed f0, by continuation.
    """

    f0: Any
    amplitude: Any
    spread: Any
    exact: Any
    printed: Any
    fine: Any
    words: Any
    ranges: tuple[Range, ...]

    @property
    def two(self) -> Any:
        """The mask of the cases in which different initial states lead to different motions."""
        return self.spread > APART

    def types(self, row: int) -> int:
        """The number of the four types that the printed f0 can show at one amplitude, each from its own choice of initial state."""
        return max(kinds(choice) for choice in itertools.product(*(sorted(set(words.tolist())) for words in self.words[row])))

    def as_data(self) -> dict[str, Any]:
        """The results as plain data, SI units."""
        return {
            "starts_over_A_mu_omega": STARTS, "f0": self.f0, "amplitude": self.amplitude, "spread_over_A_mu_omega": self.spread,
            "coexisting": int(self.two.sum()), "exact_coexisting": int((self.exact > APART).sum()), "cases": int(self.spread.size),
            "ranges": [
                {"f0": r.f0, "from": r.slide.low.value, "from_kind": r.slide.low.kind, "to": r.rest.high.value, "to_kind": r.rest.high.kind,
                 "found": r.both}
                for r in self.ranges
            ],
        }  # fmt: skip


def coexistence(fast: bool) -> Coexistence:
    """Solve the grid from every initial state, and follow both motions where two were found at a printed f0."""
    f0 = np.linspace(0.18, 1.0, 12 if fast else 42)
    A = 1e-5 * np.arange(50, 151, 10 if fast else 5)
    printed = np.array([c.changes["f0"] for c in CASES if c.section == "5.4"])
    fine = 1e-5 * np.arange(50, 151, 5 if fast else 1)
    near = _from_starts(printed, fine, "lugre")
    both = (_spread(near, fine) > APART).T
    fastest = np.argmax(abs(near.mean_velocity), axis=-1)
    ranges = [
        _range(float(f), fine[two], STARTS[fastest[two, k][0]], 1.5 * (fine[1] - fine[0]))
        for k, (f, two) in enumerate(zip(printed, both, strict=True))
        if two.any()
    ]
    lugre, exact = (_spread(_from_starts(f0, A, law), A) for law in ("lugre", "coulomb-static"))
    return Coexistence(f0, A, lugre, exact, printed, fine, near.motion_type, tuple(ranges))


def _from_starts(f0: Any, A: Any, law: str) -> Any:
    """A batch over amplitude, static coefficient and initial state."""
    shape = (len(A), len(f0), len(STARTS))
    amplitude = np.broadcast_to(A[:, None, None], shape)
    robot = rig(CASES[-1], law=law, amplitude=amplitude, f0=np.broadcast_to(f0[None, :, None], shape))
    return batch(robot, start={"v": np.array(STARTS) * robot.free_velocity}, periods=150, settle=100, rtol=1e-6)


def _spread(many: Any, A: Any) -> Any:
    """Range of the mean velocities over the initial states, in units of A mu omega."""
    return np.ptp(many.mean_velocity, axis=-1) / (A[:, None] * OMEGA * rig(CASES[-1]).mass_ratio)


def _range(f0: float, A: Any, start: float, beyond: float) -> Range:
    """Both motions at a printed f0, from amplitudes at which both were found to their ends; `start` leads to sliding at the first."""
    from stickslip.solvers import solve

    low, high = float(A[0]), float(A[-1])
    how: dict[str, Any] = {"step": 0.05, "points": 30, "rtol": 1e-7, "fixed": {"f0": f0}}
    robot = rig(CASES[-1], amplitude=low, f0=f0)
    run = solve(robot, periods=100, start={"v": start * robot.free_velocity})
    slide = stable_range("amplitude", low, low - beyond, low, guess=run, **how)
    return Range(f0, slide, stable_range("amplitude", high, high, high + beyond, **how), (low, high))
