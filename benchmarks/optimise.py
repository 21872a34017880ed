"""Optima that are known in closed form, found from nothing: stickslip beside plain use of SciPy and of cma on the same objective.

Run: python benchmarks/optimise.py [--seeds 3]     (`pip install cma`, which may be missing)

The objective of all is the mean velocity of the steady motion, solved exactly until it repeats, as a function of numbers between 0 and 1,
with what is beyond a limit worth nothing. The others call it for one machine at a time, as one does who writes ten lines; ours runs a
generation in lanes and has derivatives through every switch. Of each: by how much the best value stays below the closed optimum, the worst
of the seeds; the mean of the candidates that were run, and of the processor seconds. Only ratios of seconds within one run mean anything.
"""

from __future__ import annotations

import argparse
import contextlib
import functools
import importlib
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import stickslip as ss
from stickslip.inverse.optimisation.candidates import Candidates
from stickslip.inverse.optimisation.constraints import checked_limits, scales_within
from stickslip.inverse.optimisation.unknowns import Unknowns, checked_over

G, MU, UP, DOWN, L, W = 9.81, 0.1315, 0.15, 0.25, 0.01, 60.0
_MOST = 20_000  # candidates of a rival
_WORTHLESS = 0.0  # what is beyond a limit, or no machine


@dataclass(frozen=True)
class Task:
    """A robot, what varies, its limits, and the best speed by its formula [m/s]."""

    name: str
    robot: Any
    over: dict[str, Any]
    limits: dict[str, Any]
    best: float


def robot(drive: Any) -> Any:
    """The robot of all tasks."""
    return ss.Robot(1.0 - MU, MU, drive, ss.Coulomb(UP, DOWN))


def tasks() -> list[Task]:
    """Two speeds, the accelerations of three phases, three free pieces."""
    U = 0.8
    two = MU * U - UP * (UP + DOWN) * G * L / (4 * DOWN * U)
    three = 0.041032906654407  # w1 on the verge of slipping back, w2 = w3 = 60 m/s^2
    p, T = DOWN / (UP + DOWN), ss.drives.Pieces.verge(W, L, MU, UP, DOWN).period
    verge = p**2 * T * (MU**2 * W**2 - UP**2 * G**2) / (4 * MU * W)
    speeds = {"drive.u1": (0.0, U), "drive.u2": (0.0, U)}
    phases = {"drive.u1": (0.01, 1.0), **{f"drive.w{k}": (1.0, W) for k in (1, 2, 3)}}
    free = {"stroke": (None, L), "relative_acceleration": (None, W)}
    return [
        Task("two phases, 2 numbers", robot(ss.drives.TwoPhase(stroke=L, u1=0.1, u2=0.1)), speeds, {}, two),
        Task("three phases, 4 numbers", robot(ss.drives.ThreePhase.example()), phases, {"stroke": (None, L)}, three),
        Task("three pieces, 7 numbers", robot(ss.drives.Pieces.example()), {"drive": ss.optimisation.waveform(pieces=3)}, free, verge),
    ]


class Objective:
    """Minus the mean velocity of one machine, for who minimises; counts its calls and remembers the best."""

    def __init__(self, task: Task):
        problems: Any = None
        varied, limits = checked_over(task.robot, task.over, problems), checked_limits(task.robot, task.limits, problems)
        scales = scales_within(limits, problems) if any(each.form is not None for each in varied) else None
        self.space = Unknowns(task.robot, varied, scales)
        self.worth = Candidates(self.space, "mean_velocity", -1.0, limits)
        self.count, self.calls, self.best = self.space.count, 0, 0.0

    def __call__(self, u: Any) -> float:
        """The value at one point of the unit cube."""
        if self.calls >= _MOST:
            raise StopIteration
        self.calls += 1
        found, over = self.worth.values(np.clip(u, 0.0, 1.0))
        value = _WORTHLESS if over[0] > 0.0 or math.isnan(found[0]) else float(found[0])
        self.best = min(self.best, value)
        return value


def by_evolution(f: Objective, seed: int) -> None:
    """SciPy's differential evolution with its defaults."""
    from scipy.optimize import differential_evolution

    differential_evolution(f, [(0.0, 1.0)] * f.count, seed=seed)


def by_gradients(f: Objective, seed: int) -> None:
    """SciPy's L-BFGS-B from 20 random places, with its own differences."""
    from scipy.optimize import minimize

    for start in np.random.default_rng(seed).random((20, f.count)):
        minimize(f, start, bounds=[(0.0, 1.0)] * f.count, method="L-BFGS-B")


def by_annealing(f: Objective, seed: int) -> None:
    """SciPy's dual annealing with its defaults."""
    from scipy.optimize import dual_annealing

    dual_annealing(f, [(0.0, 1.0)] * f.count, seed=seed)


def by_cma(f: Objective, seed: int, restarts: int = 0) -> None:
    """CMA-ES from the middle, with its defaults; every restart has twice the population."""
    cma = importlib.import_module("cma")
    cma.fmin2(f, np.full(f.count, 0.5), 0.3, {"bounds": [0, 1], "seed": seed + 1, "verbose": -9}, restarts=restarts)


RIVALS: dict[str, Callable[[Objective, int], None]] = {
    "SciPy differential_evolution": by_evolution,
    "SciPy dual_annealing": by_annealing,
    "SciPy L-BFGS-B, 20 starts": by_gradients,
    "cma.fmin2": by_cma,
    "cma.fmin2, 9 restarts": functools.partial(by_cma, restarts=9),
}


def rival(task: Task, search: Callable[[Objective, int], None], seed: int) -> tuple[float, int, float]:
    """How far below the best a rival ends, its candidates, and its processor seconds."""
    f, began = Objective(task), time.process_time()
    with contextlib.suppress(StopIteration):
        search(f, seed)
    return 1.0 + f.best / task.best, f.calls, time.process_time() - began


def ours(task: Task, seed: int) -> tuple[float, int, float]:
    """The same of `ss.optimise`, which is told no closed optimum."""
    began = time.process_time()
    best = ss.optimise(task.robot, over=task.over, maximise="mean_velocity", subject_to=task.limits, starts=None, seed=seed)
    return 1.0 - best["mean_velocity"] / task.best, best.tried, time.process_time() - began


def row(name: str, found: list[tuple[float, int, float]]) -> str:
    """A row of the table."""
    below, tried, seconds = (np.array(column) for column in zip(*found, strict=True))
    return f"{name:30s} {max(below.max(), 0.0):8.1e} {tried.mean():10.0f} {seconds.mean():8.1f} s"


def main() -> None:
    """Print a table for each task."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("--seeds", type=int, default=3)
    words.add_argument("--task", type=int, choices=range(len(tasks())), action="append", help="only this one (again for more)")
    asked = words.parse_args()
    seeds = range(asked.seeds)
    for task in [task for i, task in enumerate(tasks()) if asked.task is None or i in asked.task]:
        print(f"\n{task.name}: best {1e3 * task.best:.6f} mm/s\n{'':30s} {'below':>8s} {'candidates':>10s}")
        ours(task, 99)  # kernels are compiled or loaded before any clock
        print(row("ss.optimise", [ours(task, seed) for seed in seeds]), flush=True)
        for name, search in RIVALS.items():
            try:
                print(row(name, [rival(task, search, seed) for seed in seeds]), flush=True)
            except ModuleNotFoundError as error:
                print(f"{name:30s} type: pip install {error.name}")


if __name__ == "__main__":
    main()
