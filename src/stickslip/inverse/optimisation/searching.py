"""The search: a population in lanes, then SciPy's gradient method, and the population again, ever nearer, where the optimum is a ridge."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.inverse.optimisation.candidates import Candidates

_AROUND = (0.02, 0.002, 2e-4)  # of the unknowns: half the boxes around the best in which the population goes on
_GAIN = 1e-8  # of the best: what the population has to find for another climb to be worth its time
_NO_VALUE = 1e3  # of the best: what stands for the value of what is not a machine
_NEAR = 1e-4  # the same of the search over everything, from where derivatives go on
_ROAMS = 0.5  # of the generations over everything: until then the best draws the others less than fully
_SETTLED = 1e-9  # of the best: a population whose values are nearer to each other has arrived


def search(worth: Candidates, starts: Array, seed: int, generations: int, population: int, climbing: bool = True) -> None:
    """Find the best of all; `worth` remembers it.

    Parameters
    ----------
    worth : Candidates
    starts : array (starts, unknowns)
        Candidates that are tried with the first generation.
    seed : int
    generations, population : int
        Of the search over everything.
    climbing : bool
        Whether the gradient method takes part, which needs kernels of its own.
    """
    rng = np.random.default_rng(seed)
    n = worth.space.count
    _evolve(worth, Bounds(np.zeros(n), np.ones(n)), starts, rng, Pace(generations, population, _NEAR, _ROAMS))
    if worth.best is None:
        return
    if climbing:
        _climb(worth)
    for half in _AROUND:
        before = worth.least
        around = Bounds(np.clip(worth.best - half, 0.0, 1.0), np.clip(worth.best + half, 0.0, 1.0))
        _evolve(worth, around, worth.best[None], rng, Pace(generations // 5, population, _SETTLED, 0.0))
        if climbing and before - worth.least > _GAIN * abs(worth.least):
            _climb(worth)


class Bounds(NamedTuple):
    """Where candidates are looked for, of each unknown."""

    low: Array
    high: Array

    def within(self, y: Array, rng: Any) -> Array:
        """Puts values beyond a bound on it or, as often, somewhere between the bounds."""
        low, high = self
        anywhere, on = low + (high - low) * rng.random(y.shape), rng.random(y.shape) < 0.5
        return np.where((y < low) | (y > high), np.where(on, np.clip(y, low, high), anywhere), y)


class Pace(NamedTuple):
    """How long it is looked for, in generations of so many candidates.

    `settled`: how near to each other their values are when they have arrived, of the best. `roams`: the part of the generations over which
    candidates are drawn to the best one ever more; drawn from the first, all may gather at an optimum that is wide and low before a narrow
    high one is met.
    """

    generations: int
    population: int
    settled: float
    roams: float


def _evolve(worth: Candidates, bounds: Bounds, starts: Array, rng: Any, pace: Pace) -> None:
    """Differential evolution (Storn and Price 1997), a batch for each generation."""
    (low, high), (generations, population, settled, roams) = bounds, pace
    n = len(low)
    x = low + (high - low) * (np.argsort(rng.random((population, n)), axis=0) + rng.random((population, n))) / population
    x[: len(starts)] = starts[:population]
    f = worth(x)
    for k in range(generations):
        first = x[np.argmin(f)]
        a, b, c = (x[rng.permutation(population)] for _ in range(3))
        F, CR = rng.uniform(0.4, 0.9, (population, 1)), rng.choice([0.5, 0.95], (population, 1))
        pull = rng.uniform(0.0, 1.0 if k >= roams * generations else k / (roams * generations), (population, 1))
        y = a + pull * (first - a) + F * (b - c)
        keep = (rng.random((population, n)) > CR) & (np.arange(n) != rng.integers(n, size=(population, 1)))
        y = bounds.within(np.where(keep, x, y), rng)
        g = worth(y)
        better = g <= f
        x[better], f[better] = y[better], g[better]
        if (f.max() - f.min() <= settled * abs(f.min()) and f.min() < 0.0) or np.ptp(x, axis=0).max() < 1e-12:
            break


def _climb(worth: Candidates) -> None:
    """Sequential quadratic programming (SLSQP) from the best, with exact derivatives."""
    from scipy.optimize import minimize

    scale = abs(worth.least) or 1.0
    sides = len(worth.margins(worth.best)) if worth.bounding else 0
    n = worth.space.count

    def slopes(u: Array) -> Array:
        h = 1e-6
        ends = np.clip(np.vstack([u + h * np.eye(n), u - h * np.eye(n)]), 0.0, 1.0)
        values, width = worth.margins(ends), np.diag(ends[:n] - ends[n:])
        return (values[:, :n] - values[:, n:]) / width

    kept = [{"type": "ineq", "fun": lambda u: worth.margins(np.clip(u, 0.0, 1.0))[:, 0], "jac": slopes}] if sides else []

    def value(u: Array) -> float:
        values = worth.values(np.clip(u, 0.0, 1.0))[0][0]
        return float(values) / scale if np.isfinite(values) else _NO_VALUE

    minimize(
        value, worth.best, jac=lambda u: worth.slope(np.clip(u, 0.0, 1.0)) / scale,
        bounds=[(0.0, 1.0)] * n, constraints=kept, method="SLSQP", options={"maxiter": 40, "ftol": 1e-12},
    )  # fmt: skip
