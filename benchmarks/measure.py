"""Work and precision: a rival's ladder becomes a curve, a curve becomes a cost at a given error."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from statistics import median
from typing import Any

import numpy as np

import reference
from problem import Problem
from rivals.base import Rival

TARGETS = (1e-4, 1e-7)
STIFF_BELOW = 0.1  # mu0
FAST = 0.3  # CPU seconds; a rung that takes less is measured in every round, a longer one averages by itself


@dataclass(frozen=True)
class Point:
    """One rung: what it cost and what came of it."""

    setting: Any
    error: float  # worst relative error of the mean velocity over the cases
    times: tuple[float, ...]  # CPU microseconds per period and case, one for each round

    @property
    def microseconds(self) -> float:
        """The median over the rounds."""
        return median(self.times)


@dataclass(frozen=True)
class Curve:
    """One rival on one problem."""

    name: str
    mu0: float
    cases: int
    points: tuple[Point, ...] = ()
    missing: str = ""  # why there are no points
    stopped: str = ""  # why the ladder was not climbed to its end

    def front(self) -> list[Point]:
        """The points that no other point beats in both, from loose to tight."""
        best: list[Point] = []
        for point in sorted(self.points, key=lambda p: (p.microseconds, p.error)):
            if math.isfinite(point.error) and (not best or point.error < best[-1].error):
                best.append(point)
        return best

    def cost(self, target: float) -> float | None:
        """Microseconds at this error, by log-log interpolation between two rungs; None if it was not reached."""
        front = self.front()
        for before, point in zip([None, *front], front, strict=False):
            if point.error > target:
                continue
            if before is None:  # already the loosest setting is better than asked
                return point.microseconds
            errors = np.log([point.error or 1e-17, before.error])
            return float(np.exp(np.interp(math.log(target), errors, np.log([point.microseconds, before.microseconds]))))
        return None


def rung(rival: Rival, problem: Problem, setting: Any, expected: np.ndarray) -> tuple[Point, float]:
    """One setting, once; with the CPU seconds it took."""
    velocities, seconds = rival.run(problem, setting)
    error = float(np.max(np.abs(velocities / expected - 1)))
    return Point(setting, error if math.isfinite(error) else math.inf, (seconds * _share(problem),)), seconds


def _share(problem: Problem) -> float:
    """Microseconds per period and case in a second for all."""
    return 1e6 / (len(problem.amplitude) * problem.periods)


def again(found: Curve, rival: Rival, problem: Problem) -> Curve:
    """The same curve with one more time for each fast point.

    Rounds over all rivals, not repeats of one: on a shared machine a slow minute then hits everybody.
    """
    problem = problem.some(found.cases)
    points = []
    for point in found.points:
        if point.times[0] < FAST * _share(problem):
            more = rival.run(problem, point.setting)[1] * _share(problem)
            point = replace(point, times=(*point.times, more))
        points.append(point)
    return replace(found, points=tuple(points))


def curve(rival: Rival, problem: Problem, budget: float, answers: Callable[[Problem], np.ndarray] = reference.velocities) -> Curve:
    """The whole ladder, or as much of it as `budget` CPU seconds buy. A rival that fails says so and stops nobody else."""
    stiff = problem.mu0 < STIFF_BELOW
    problem = problem.some(rival.most_cases(stiff))
    cases = len(problem.amplitude)
    if reason := rival.available() or (rival.skip_stiff if stiff else ""):
        return Curve(rival.name, problem.mu0, cases, missing=reason)
    expected = answers(problem)
    points: list[Point] = []
    spent, stopped = 0.0, ""
    for setting in rival.ladder(stiff):
        try:
            point, seconds = rung(rival, problem, setting, expected)
        except Exception as error:  # other people's software, in versions we have not seen
            stopped = f"failed at {setting}: {type(error).__name__}: {(str(error).splitlines() or [''])[0]}"
            break
        points.append(point)
        spent += seconds
        if spent > budget and setting != rival.ladder(stiff)[-1]:
            stopped = f"stopped after {setting}: {spent:.0f} s spent"
            break
    if not points:
        return Curve(rival.name, problem.mu0, cases, missing=stopped)
    return Curve(rival.name, problem.mu0, cases, tuple(points), stopped=stopped)
