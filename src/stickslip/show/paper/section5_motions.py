"""Section 5 judged by multipliers and exponents: the kind of motion in each figure, with the evidence."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from stickslip.show.paper.cases import CASES, rig
from stickslip.show.paper.solved_runs import Runs, Tell
from stickslip.show.paper.words import plain

__all__ = ["FigureMotion", "motions"]

#: Drive periods over which exponents are averaged, for periodic and for other motions.
PERIODS, LONG = 40, 2000
ROUNDING = 1e-12  # smaller multipliers are rounding errors of the matrix; their exponents are not


@dataclass(frozen=True)
class FigureMotion:
    """The motion of a figure.

    Parameters
    ----------
    figure : int
        The paper's figure.
    kind : str
        "periodic", "quasi-periodic", "chaotic" or "not settled".
    period : int or None
        Drive periods until it repeats.
    multipliers : tuple of complex
        Multipliers of the periodic orbit, the largest first; empty if there is none.
    exponent, error : float
        Largest Lyapunov exponent per drive period and its standard error.
    residual : float or None
        Distance of the orbit's strobe state from its image, in the scales of its coordinates.
    twin : float or None
        Largest multiplier of the same robot with exact Coulomb friction that breaks away at f0; 0 if it comes to rest.
    why : str
        The evidence in a sentence.
    """

    figure: int
    kind: str
    period: int | None
    multipliers: tuple[complex, ...]
    exponent: float
    error: float
    residual: float | None
    twin: float | None
    why: str

    @property
    def word(self) -> str:
        """The verdict in words.

        Examples
        --------
        >>> FigureMotion(23, "periodic", 2, (-0.39,), -0.47, 1e-12, 1e-13, 0.0, "").word
        'periodic, period 2'
        """
        return f"periodic, period {self.period}" if self.kind == "periodic" else self.kind

    @property
    def multiplier(self) -> str:
        """The largest multiplier as text."""
        if not self.multipliers:
            return "none"
        largest = self.multipliers[0]
        if abs(largest) < ROUNDING:
            return "below 10⁻¹²"
        return plain(largest.real, 3) if largest.imag == 0 else f"|λ| = {plain(abs(largest), 3)}"

    @property
    def exponents(self) -> str:
        """The largest exponent as text, with its error where that is not below the last digit printed."""
        if not math.isfinite(self.exponent):
            return "−∞"
        if self.multipliers and abs(self.multipliers[0]) < ROUNDING:  # the orbit's matrix cannot resolve what is measured along the motion
            return f"below {plain(math.log(ROUNDING), 2)}"
        if self.error < 0.5e-5 * abs(self.exponent):
            return plain(self.exponent, 6)
        digits = max(1, min(6, 2 + math.floor(math.log10(max(abs(self.exponent), self.error) / self.error))))
        return f"{plain(self.exponent, digits)} ± {plain(self.error, 1)}"

    @property
    def from_multiplier(self) -> float | None:
        """The exponent from the orbit: the logarithm of the largest multiplier over the period."""
        if not self.multipliers or not self.period or abs(self.multipliers[0]) < ROUNDING:
            return None
        return math.log(abs(self.multipliers[0])) / self.period

    def as_data(self) -> dict[str, Any]:
        """The motion as plain data."""
        return {
            "kind": self.kind, "period": self.period, "multipliers": [[m.real, m.imag] for m in self.multipliers],
            "exponent": self.exponent, "error": self.error, "exponent_from_multiplier": self.from_multiplier, "residual": self.residual,
            "coulomb_multiplier": self.twin, "why": self.why,
        }  # fmt: skip


def motions(runs: Runs, tell: Tell) -> dict[int, FigureMotion]:
    """The verdict on every figure of section 5, by its number; each computation continues the run of the figure."""
    verdicts = {}
    for i, case in enumerate(CASES):
        tell("judging motions by multipliers and exponents", i, len(CASES))
        verdicts[case.figure] = _judged(case, runs)
    tell("judging motions by multipliers and exponents", len(CASES), len(CASES))
    return verdicts


def _judged(case: Any, runs: Runs) -> FigureMotion:
    from stickslip.dynamics.exponents.motion_verdict import verdict

    robot, run = rig(case), runs.figures[case.figure]
    judgement = verdict(robot, periods=PERIODS, settle=0, start=run)
    if judgement.kind != "periodic":
        judgement = verdict(robot, periods=LONG, settle=400, start=run)
    multipliers = () if judgement.orbit is None else tuple(map(complex, judgement.orbit.multipliers))
    return FigureMotion(
        case.figure, judgement.kind, judgement.period, multipliers, judgement.exponents.largest, judgement.exponents.error,
        None if judgement.orbit is None else judgement.orbit.residual, _of_twin(runs.twins[case.figure]), judgement.why,
    )  # fmt: skip


def _of_twin(run: Any) -> float | None:
    """The largest multiplier of the exact Coulomb motion to which a run has converged."""
    from stickslip.analysis.motion import motion
    from stickslip.basics.errors import SolveError
    from stickslip.dynamics.periodic.periodic_orbits import periodic_orbit

    period = motion(run).period
    if not period:
        return None
    try:
        return float(abs(periodic_orbit(run.model, period, guess=run).multipliers).max())
    except SolveError:
        return None
