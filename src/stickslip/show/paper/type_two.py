"""Type II with LuGre friction: by how much each motion misses the definition, a velocity that is never negative; and why all do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.show.paper.cases import CASES, EXPERIMENTS, rig
from stickslip.show.paper.solved_runs import Runs, batch

__all__ = ["TypeTwo", "type_two"]

#: Amplitudes [m] and tilts [degrees] of the search.
AMPLITUDES, TILTS = np.linspace(2e-4, 1.5e-3, 53), np.array([0.5, 1.0, 1.7, 2.7, 4.7, 5.7, 7.0, 8.5, 10.0])


@dataclass(frozen=True, eq=False)
class TypeTwo:
    """How far LuGre motions are from type II.

    Parameters
    ----------
    figures : dict
        Figure number -> smallest over largest velocity of the settled motion: negative unless the motion is of type II as defined.
    friction : dict
        Figure number -> mean friction force over a period, relative to (M+m)g: zero by the balance of momentum.
    searched : int
        Number of robots in the search over amplitude and tilt.
    nearest, place : float, (float, float)
        The largest such ratio of those that slide (mean velocity above 0.01 Aμω), and its amplitude [m] and tilt [degrees].
    """

    figures: dict[int, float]
    friction: dict[int, float]
    searched: int
    nearest: float
    place: tuple[float, float]

    @property
    def misses_all(self) -> bool:
        """Whether no motion here is of type II as the paper defines it."""
        return max(*self.figures.values(), self.nearest) < 0

    def as_data(self) -> dict[str, Any]:
        """The numbers as plain data, SI units."""
        return vars(self)


def type_two(runs: Runs, fast: bool) -> TypeTwo:
    """The figures' motions, and a search over amplitude and tilt."""
    solved = {e.figure: runs.lugre[e.name] for e in EXPERIMENTS} | runs.figures
    ratios, friction = {}, {}
    for figure, run in sorted(solved.items()):
        t = np.linspace(run.strobe_times[-3], run.strobe_times[-1], 4001)[:-1]
        samples = run.at(t)
        ratios[figure] = float(samples["v"].min() / samples["v"].max())
        friction[figure] = float(samples["friction_force"].mean() / (run.model.total_mass * run.model.gravity))
    A, tilt = AMPLITUDES[:: 4 if fast else 1, None], TILTS[None, :]
    many = batch(rig(CASES[-1], amplitude=A, tilt_deg=tilt, f0=0.21), periods=100, settle=80)
    slides = many.mean_velocity > 0.01 * np.asarray(many.model.mass_ratio * many.model.velocity_scale)
    ratio = np.where(slides, many.velocity_min / many.velocity_max, -np.inf)
    i, j = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
    return TypeTwo(ratios, friction, ratio.size, float(ratio[i, j]), (float(A[i, 0]), float(tilt[0, j])))
