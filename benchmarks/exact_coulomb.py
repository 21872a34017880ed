"""The Coulomb robot: our exact batch solver against hand-written mode machines.

    python benchmarks/exact_coulomb.py [--rounds 5] [--budget 20] [--json FILE]

In phase tau = omega t and w = v / (A mu omega), the robot is w' = sin tau - r with r = alpha_plus forward, -alpha_minus backward, and it
sticks while -alpha_minus <= sin tau <= alpha_plus (docs, and Eq. 2.4). Break-away is known in closed form to both rivals; they
differ in how they slide: scipy's DOP853 with a terminal event at w = 0, as a good user writes it, and the closed formula of the arc
with brentq for its end, as a very good user does. The latter, at the tightest tolerance, is the reference.
"""

from __future__ import annotations

import pin  # isort: skip  # before NumPy

import argparse
import math
from collections.abc import Callable
from functools import cache, partial
from time import process_time
from typing import Any

import numpy as np

import table
from measure import again, curve
from problem import GRAVITY, OMEGA, Problem, sweep
from rivals.base import Outcome, Rival

TURN = 2 * math.pi
TARGETS = (1e-4, 1e-8, 1e-12)
STEP_OFF = 1e-4
MOST_ARCS = 1000
#: (tau, w, x, side, alpha of that side, stop) -> (tau, w, x) at w = 0 or at stop
Slide = Callable[[float, float, float, int, float, float], tuple[float, float, float]]


def machine(slide: Slide, forward: float, backward: float, stops: tuple[float, ...]) -> list[float]:
    """Path, in units of A mu, at each stop; from rest. `forward`, `backward` are alpha_plus, alpha_minus."""
    tau, w, x, side = 0.0, 0.0, 0.0, 0
    paths, arcs = [], 0
    for stop in stops:
        while tau < stop:
            arcs += 1
            if arcs > MOST_ARCS:
                raise RuntimeError(f"more than {MOST_ARCS} arcs: the mode machine spins at tau = {tau}")
            if side == 0:
                tau, side = _release(tau, forward, backward, stop)
                continue
            tau, w, x = slide(tau, w, x, side, forward if side > 0 else backward, stop)
            if tau < stop:
                push, w = math.sin(tau), 0.0
                side = 1 if push > forward else -1 if push < -backward else 0
        paths.append(x)
    return paths


def _release(tau: float, forward: float, backward: float, stop: float) -> tuple[float, int]:
    """When and to which side a stuck body breaks away, or (stop, 0)."""
    first, side = stop, 0
    for alpha, phase, way in ((forward, 0.0, 1), (backward, math.pi, -1)):
        if alpha < 1:
            start = phase + math.asin(alpha)
            start += TURN * math.ceil((tau - start) / TURN)
            if start < first:
                first, side = start, way
    return first, side


def closed_form(tau: float, w: float, x: float, side: int, alpha: float, stop: float, xtol: float) -> tuple[float, float, float]:
    """One sliding arc by its formula; between two extremes of w there is at most one zero, which brentq finds."""
    from scipy.optimize import brentq

    def speed(t: float) -> float:
        return side * (w + math.cos(tau) - math.cos(t)) - alpha * (t - tau)

    low, end = tau, stop
    for high in _extremes(tau, side, alpha, stop):
        if speed(high) < 0:
            end = brentq(speed, low, high, xtol=xtol, rtol=1e-15) if low > tau or speed(low) > 0 else low
            break
        low = high
    span = end - tau
    way = (w + math.cos(tau)) * span - (math.sin(end) - math.sin(tau)) - side * alpha * span**2 / 2
    return end, side * speed(end), x + way


def _extremes(tau: float, side: int, alpha: float, stop: float):
    """Where w' = 0 after tau, in order, and at last the stop; if w' is never 0, a grid."""
    if alpha >= 1:
        points = [tau + math.pi * k for k in range(1, int((stop - tau) / math.pi) + 1)]
    else:
        lift = math.asin(alpha) + (0.0 if side > 0 else math.pi)
        fall = math.pi - math.asin(alpha) + (0.0 if side > 0 else math.pi)
        turns = range(int((tau - TURN) // TURN), int(stop // TURN) + 1)
        points = sorted(t for k in turns for t in (lift + TURN * k, fall + TURN * k) if tau < t < stop)
    yield from points
    yield stop


def by_scipy(
    tau: float, w: float, x: float, side: int, alpha: float, stop: float, setting: tuple[float, float]
) -> tuple[float, float, float]:
    """One sliding arc by DOP853 and a terminal event.

    At the start w = 0, where the event would fire at once or, rounded to the wrong side, end the arc with length zero and so for
    ever. Its direction prevents the first, a first small step by Taylor's series the second.
    A step limit has to keep w from dipping below zero and back inside one step.
    """
    from scipy.integrate import solve_ivp

    def hit(t, u):
        return u[0]

    hit.terminal, hit.direction = True, -side  # type: ignore[attr-defined]
    resistance, (rtol, max_step) = side * alpha, setting
    if w == 0.0 and tau + STEP_OFF < stop:
        slope, bend = math.sin(tau) - resistance, math.cos(tau)
        w = slope * STEP_OFF + bend * STEP_OFF**2 / 2 - math.sin(tau) * STEP_OFF**3 / 6
        x += slope * STEP_OFF**2 / 2 + bend * STEP_OFF**3 / 6
        tau += STEP_OFF
    done = solve_ivp(
        lambda t, u: (math.sin(t) - resistance, u[0]),
        (tau, stop),
        (w, x),
        "DOP853",
        events=hit,
        rtol=rtol,
        atol=rtol / 100,
        max_step=max_step,
    )
    return float(done.t[-1]), float(done.y[0, -1]), float(done.y[1, -1])


def _run(slide: Callable, problem: Problem, setting: Any) -> Outcome:
    """All cases, one after the other."""
    (forward, _), (backward, _) = problem.sides
    stops = (TURN * problem.settle, TURN * problem.periods)
    alphas = [(forward * GRAVITY / p, backward * GRAVITY / p) for p in problem.push.tolist()]
    one = partial(_with, slide, setting)
    machine(one, *alphas[0], stops=(TURN,))
    start = process_time()
    paths = np.array([machine(one, a, b, stops) for a, b in alphas])
    seconds = process_time() - start
    return problem.mean_velocity(paths[:, 0], paths[:, 1]) * problem.push / OMEGA**2, seconds


def _with(slide: Callable, setting: Any, *arc) -> tuple[float, float, float]:
    return slide(*arc, setting)


def _ours(problem: Problem, _setting: None) -> Outcome:
    """stickslip, one batch; it has no tolerance."""
    _solve_ours(Problem(problem.mu0, problem.amplitude[:16], periods=2, settle=1))
    start = process_time()
    velocities = _solve_ours(problem)
    return velocities, process_time() - start


def _solve_ours(problem: Problem) -> np.ndarray:
    import stickslip as ss

    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=problem.amplitude, omega=OMEGA, mu0=problem.mu0, law="coulomb")
    run = ss.solve(robot, periods=problem.periods, settle=problem.settle, keep="summary")
    return np.asarray(run.mean_velocity, dtype=float)


@cache
def _answers(mu0: float) -> dict[float, float]:
    problem = sweep(mu0)
    return dict(zip(problem.amplitude.tolist(), _run(closed_form, problem, 1e-15)[0].tolist(), strict=True))


def answers(problem: Problem) -> np.ndarray:
    """Mean velocities by the closed form at the tightest tolerance."""
    return np.array([_answers(problem.mu0)[a] for a in problem.amplitude.tolist()])


TOLERANCES = (1e-3, 1e-7, 1e-9, 1e-11, 1e-13)
SOLVERS = (
    Rival("stickslip, exact", "stickslip", (None,), _ours, module="stickslip"),
    Rival("closed arcs, brentq, plain Python", "scipy", (1e-3, 1e-6, 1e-9, 1e-12, 1e-15), partial(_run, closed_form), cases=128),
    Rival(
        "scipy DOP853, events, restarts",
        "scipy",
        tuple((tol, 0.5) for tol in TOLERANCES),
        partial(_run, by_scipy),
        cases=32,
        settings_stiff=tuple((tol, 0.2) for tol in TOLERANCES),
    ),
)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5, help="in which what is fast is measured again; the median counts")
    parser.add_argument("--budget", type=float, default=20, help="CPU seconds for a row on one problem")
    parser.add_argument("--json", metavar="FILE")
    asked = parser.parse_args()
    problems = [sweep(mu0) for mu0 in (0.18, 0.03)]
    rows = [[curve(s, p, asked.budget, answers) for p in problems] for s in SOLVERS]
    for _ in range(1, asked.rounds):
        rows = [[again(c, s, p) for c, p in zip(row, problems, strict=True)] for row, s in zip(rows, SOLVERS, strict=True)]
    print(f"# {pin.WHERE}; " + ", ".join(f"{k} {v}" for k, v in table.versions().items()))
    print(table.text("Coulomb robot, 512 amplitudes, CPU us per drive period and case at a worst relative error", rows, TARGETS))
    if asked.json:
        table.write_json(asked.json, {"coulomb": rows}, pinned=pin.WHERE)


if __name__ == "__main__":
    main()
