"""Work and precision: a rival's ladder becomes a curve, a curve becomes a cost at a given error."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np

import reference
from problem import Problem
from rivals.base import Rival

TARGETS = (1e-4, 1e-7)
STIFF_BELOW = 0.1  # mu0
ENOUGH = 1.0  # CPU seconds in one rung, after which it is not repeated


@dataclass(frozen=True)
class Point:
    """One rung: what it cost and what came of it."""

    setting: Any
    microseconds: float  # CPU, per period and case
    error: float  # worst relative error of the mean velocity over the cases


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


def rung(rival: Rival, problem: Problem, setting: Any, expected: np.ndarray, repeats: int) -> tuple[Point, float]:
    """One setting, repeated and the median taken if it is fast; with the CPU seconds of all repeats."""
    velocities, seconds = rival.run(problem, setting)
    times = [seconds]
    while len(times) < repeats and sum(times) < ENOUGH:
        times.append(rival.run(problem, setting)[1])
    error = float(np.max(np.abs(velocities / expected - 1)))
    error = error if math.isfinite(error) else math.inf
    return Point(setting, median(times) / (len(expected) * problem.periods) * 1e6, error), sum(times)


def curve(
    rival: Rival, problem: Problem, repeats: int, budget: float, answers: Callable[[Problem], np.ndarray] = reference.velocities
) -> Curve:
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
            point, seconds = rung(rival, problem, setting, expected, repeats)
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
