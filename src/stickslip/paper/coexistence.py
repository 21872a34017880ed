"""Section 5.4 from several starts: where, over static coefficient and amplitude, two motions of one LuGre body coexist."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.paper.borders import kinds
from stickslip.paper.cases import CASES, OMEGA, rig
from stickslip.paper.followed_motions import Followed, followed
from stickslip.paper.solved_runs import batch

__all__ = ["STARTS", "Coexistence", "Range", "coexistence"]

#: Velocities at the start in units of A mu omega, at drive phase 0 with unstretched bristles; the first is rest.
STARTS = (0.0, -1.5, -1.0, 1.0)
#: Mean velocities further apart than this, in units of A mu omega, are those of two motions (settled ones agree to 1e-6).
APART = 1e-3


@dataclass(frozen=True)
class Range:
    """Amplitudes at which two stable motions exist under one of the printed static coefficients.

    Parameters
    ----------
    f0 : float
    slide, rest : Followed
        The motion that slides, followed down to where it ends; and the one that a start from rest finds, followed up.
    found : (float, float)
        First and last amplitude at which the starts found both [m].
    """

    f0: float
    slide: Followed
    rest: Followed
    found: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Coexistence:
    """The attractors reached from several starts.

    Parameters
    ----------
    f0, amplitude : array
        Axes of the grid.
    spread : array (amplitude, f0)
        Largest minus smallest mean velocity over the starts, in units of A mu omega: LuGre friction.
    exact : array (amplitude, f0)
        The same for the exact motion with break-away at f0.
    printed : array
        The four printed f0.
    fine : array
        Amplitudes at which these are looked at more closely.
    words : array (fine, printed, starts)
        LuGre words there, at the default thresholds.
    ranges : tuple of Range
        Where two motions exist under a printed f0, by continuation.
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
        """Where the starts lead to different motions."""
        return self.spread > APART

    def types(self, row: int) -> int:
        """How many of the four types the four printed f0 can show at one amplitude, each from a start of its own choice."""
        return max(kinds(choice) for choice in itertools.product(*(sorted(set(words.tolist())) for words in self.words[row])))

    def as_data(self) -> dict[str, Any]:
        """The same for machines, SI units."""
        return {
            "starts_over_A_mu_omega": STARTS, "f0": self.f0, "amplitude": self.amplitude, "spread_over_A_mu_omega": self.spread,
            "coexisting": int(self.two.sum()), "exact_coexisting": int((self.exact > APART).sum()), "cases": int(self.spread.size),
            "ranges": [
                {"f0": r.f0, "from": r.slide.low.value, "from_kind": r.slide.low.kind, "to": r.rest.high.value, "to_kind": r.rest.high.kind,
                 "found": r.found}
                for r in self.ranges
            ],
        }  # fmt: skip


def coexistence(fast: bool) -> Coexistence:
    """Run the grid from every start, and follow both motions where two were found under a printed f0."""
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
    """A batch over amplitude, static coefficient and start."""
    shape = (len(A), len(f0), len(STARTS))
    amplitude = np.broadcast_to(A[:, None, None], shape)
    robot = rig(CASES[-1], law=law, amplitude=amplitude, f0=np.broadcast_to(f0[None, :, None], shape))
    return batch(robot, start={"v": np.array(STARTS) * robot.free_velocity}, periods=150, settle=100, rtol=1e-6)


def _spread(many: Any, A: Any) -> Any:
    """How far apart the mean velocities of the starts are, in units of A mu omega."""
    return np.ptp(many.mean_velocity, axis=-1) / (A[:, None] * OMEGA * rig(CASES[-1]).mass_ratio)


def _range(f0: float, A: Any, start: float, beyond: float) -> Range:
    """Both motions at a printed f0, from the amplitudes at which both were found to where each ends; `start` slides at the first."""
    from stickslip.solvers import solve

    low, high = float(A[0]), float(A[-1])
    how: dict[str, Any] = {"step": 0.05, "points": 30, "rtol": 1e-7, "f0": f0}
    robot = rig(CASES[-1], amplitude=low, f0=f0)
    run = solve(robot, periods=100, start={"v": start * robot.free_velocity})
    slide = followed("amplitude", low, low - beyond, low, guess=run, **how)
    return Range(f0, slide, followed("amplitude", high, high, high + beyond, **how), (low, high))
