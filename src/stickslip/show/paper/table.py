"""Section 4's table: mean velocity and type for the four angles, beside the printed values and the experiment."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

from stickslip.show.paper.cases import EXPERIMENTS, PrintedExperiment
from stickslip.show.paper.solved_runs import Runs

__all__ = ["TableRow", "rows"]


@dataclass(frozen=True)
class TableRow:
    """One angle of section 4.

    Parameters
    ----------
    experiment : PrintedExperiment
        The case with its printed values.
    coulomb, lugre, gravity : float
        Our mean velocities [m/s]: exact Coulomb, folded LuGre, LuGre on a true incline.
    type : str
        Motion type of the exact Coulomb run; it depends on no threshold.
    margin : float
        Its distance to the nearest border between types.
    pattern : str
        Its signs over one period.
    fractions : dict
        Parts of the period forwards, backwards and at rest.
    intervals : tuple
        Start, length [drive periods] and sign of each interval of sliding or rest in the exact Coulomb run.
    lugre_word : str
        The word for the LuGre run at the default thresholds.
    lugre_words : dict
        Number of threshold pairs that give each word.
    """

    experiment: PrintedExperiment
    coulomb: float
    lugre: float
    gravity: float
    type: str
    margin: float
    pattern: str
    fractions: dict[str, float]
    intervals: tuple[tuple[float, float, int], ...]
    lugre_word: str
    lugre_words: dict[str, int]

    @property
    def rests(self) -> tuple[float, ...]:
        """Lengths of the rests of the exact Coulomb body [drive periods]."""
        return tuple(length for _, length, sign in self.intervals if sign == 0)

    @property
    def signs(self) -> str:
        """The pattern with a true minus."""
        return self.pattern.replace("-", "−")

    @property
    def closer(self) -> str:
        """The law whose mean velocity, as computed, is closer to the measured one."""
        measured = self.experiment.measured
        return "LuGre" if abs(self.lugre - measured) < abs(self.coulomb - measured) else "Coulomb"

    @property
    def closer_printed(self) -> str:
        """The law whose printed mean velocity is closer to the measured one."""
        e = self.experiment
        return "LuGre" if abs(e.lugre - e.measured) < abs(e.coulomb - e.measured) else "Coulomb"


def rows(runs: Runs) -> tuple[TableRow, ...]:
    """The table, in the order of the angles."""
    return tuple(_row(e, runs) for e in EXPERIMENTS)


def _row(e: PrintedExperiment, runs: Runs) -> TableRow:
    from stickslip.analysis.motion import motion, threshold_table
    from stickslip.analysis.steady import mean_velocity

    exact, bristles = motion(runs.coulomb[e.name]), motion(runs.lugre[e.name])
    words: Any = Counter(r["type"] for r in threshold_table(runs.lugre[e.name]))
    return TableRow(
        experiment=e,
        coulomb=mean_velocity(runs.coulomb[e.name]),
        lugre=mean_velocity(runs.lugre[e.name]),
        gravity=runs.gravity[e.name],
        type=exact.type,
        margin=exact.margin,
        pattern=exact.pattern,
        fractions={"forward": exact.forward_fraction, "backward": exact.backward_fraction, "stick": exact.stick_fraction},
        intervals=tuple((float(a), float(b), int(sign)) for a, b, sign in exact.intervals),
        lugre_word=bristles.type,
        lugre_words=dict(words.most_common()),
    )
