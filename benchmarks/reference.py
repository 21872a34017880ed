"""The right answers, from software that is not ours: heyoka (Taylor, tolerance 1e-15, stepping on v = 0 exactly).

    python benchmarks/reference.py           # compute all, cross-check, write reference.json (10 minutes, needs heyoka)
    python benchmarks/reference.py --check   # only cross-check what is stored

The cross-check is a different method in a different library on a differently written equation: scipy's DOP853 (mu0 = 0.18) and
Radau (mu0 = 0.03), one smooth branch at a time, restarted at each zero of v.
"""

from __future__ import annotations

import argparse
import json
import math
from functools import cache
from pathlib import Path

import numpy as np

from problem import AMPLITUDES, MASS, MU, OMEGA, PERIOD, SIGMA0, SIGMA1, SIGMA2, V_S, WEIGHT, Problem, alone, sweep

FILE = Path(__file__).with_name("reference.json")
FRICTIONS = (0.18, 0.03)
TOLERANCE = 1e-15


@cache
def _stored() -> dict:
    return json.loads(FILE.read_text(encoding="utf-8"))


def velocities(problem: Problem) -> np.ndarray:
    """Mean velocity of each case [m/s]; the cases must be some of `sweep` or `alone`."""
    known = _stored()["mean_velocity"][f"{problem.mu0:g}"]
    table = dict(zip(AMPLITUDES.tolist(), known["sweep"], strict=True)) | {6e-4: known["alone"]}
    return np.array([table[a] for a in problem.amplitude.tolist()])


def arcs(mu0: float, amplitude: float, method: str, rtol: float) -> float:
    """Mean velocity by scipy, arc by arc between the zeros of v [m/s]."""
    from scipy.integrate import solve_ivp

    problem = Problem(mu0, np.array([amplitude]))
    t, u, side, paths = 0.0, np.zeros(3), 1.0, []
    for end in problem.times[1:]:
        while t < end:
            rate, event = _branch(problem, amplitude, side)
            event.terminal, event.direction = True, -side  # type: ignore[attr-defined]
            with np.errstate(over="ignore"):  # Radau's difference Jacobian by x, which nothing depends on
                done = solve_ivp(rate, (t, end), u, method, events=event, rtol=rtol, atol=rtol * np.array([1e-4, 1e-9, 1e-6]))
            t, u = done.t[-1], done.y[:, -1]
            side = -side if done.status == 1 else side
        paths.append(u[2])
    return float(problem.mean_velocity(*paths))


def _branch(problem: Problem, amplitude: float, side: float):
    """(right side, event) of the smooth branch that holds for v of this sign."""
    mu, f = problem.sides[0 if side > 0 else 1]

    def rate(t, u):
        v, z, _ = u
        g = mu + (f - mu) * math.exp(-((v / V_S) ** 2))
        zdot = v * (1 - side * SIGMA0 * z / (WEIGHT * g))
        resistance = SIGMA0 * z + SIGMA1 * zdot + SIGMA2 * v
        return [amplitude * MU * OMEGA**2 * math.sin(OMEGA * t) - resistance / MASS, zdot, v]

    return rate, lambda t, u: u[0]


def check(count: int = 3) -> dict:
    """Largest relative difference between the stored numbers and `arcs` on a few cases of each problem."""
    found = {}
    for mu0, method, rtol in ((0.18, "DOP853", 1e-12), (0.03, "Radau", 1e-9)):
        some = sweep(mu0).some(count)
        other = np.array([arcs(mu0, a, method, rtol) for a in some.amplitude])
        found[f"{mu0:g}"] = {
            "method": f"scipy {method}, rtol {rtol:g}, restarted at v = 0",
            "amplitudes": some.amplitude.tolist(),
            "worst_relative_difference": float(np.max(np.abs(other / velocities(some) - 1))),
        }
        print(mu0, found[f"{mu0:g}"])
    return found


def compute() -> None:
    """Writes reference.json."""
    import heyoka

    from rivals.taylor_heyoka import run_batch, run_single

    answers = {}
    for mu0 in FRICTIONS:
        many, seconds = run_batch(sweep(mu0), (TOLERANCE, 8))
        print(f"mu0 = {mu0}: {seconds:.0f} s")
        answers[f"{mu0:g}"] = {"alone": float(run_single(alone(mu0), TOLERANCE)[0][0]), "sweep": many.tolist()}
    told = {
        "what": "mean velocity [m/s] over periods 20..30 from v = z = 0, problem.py; sweep: 512 amplitudes 0.4..0.8 mm; alone: 0.6 mm",
        "method": f"heyoka {heyoka.__version__}, tolerance {TOLERANCE}, terminal event at v = 0",
        "period": PERIOD,
        "mean_velocity": answers,
    }
    FILE.write_text(json.dumps(told, indent=1), encoding="utf-8")
    told["cross_check"] = check()
    FILE.write_text(json.dumps(told, indent=1), encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="only cross-check what is stored")
    check() if parser.parse_args().check else compute()
