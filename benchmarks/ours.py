"""stickslip, as a user calls it: many cases in one `solve`, and one case alone."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from time import process_time

import numpy as np

from problem import OMEGA, Problem
from rivals.base import Outcome, Rival
from whole import whole


def _solve(problem: Problem, rtol: float) -> np.ndarray:
    """Mean velocity of each case [m/s]."""
    import stickslip as ss

    amplitude = problem.amplitude if len(problem.amplitude) > 1 else float(problem.amplitude[0])
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=amplitude, omega=OMEGA, mu0=problem.mu0)
    run = ss.solve(robot, periods=problem.periods, settle=problem.settle, keep="summary", rtol=rtol)
    return np.atleast_1d(np.asarray(run.mean_velocity, dtype=float))


@cache
def _warm(lanes: bool, rtol: float) -> None:
    """Compile, or fetch from the cache, the kernel that this tolerance takes."""
    _solve(Problem(0.18, np.linspace(4e-4, 8e-4, 16 if lanes else 1), periods=2, settle=1), rtol)


def _run(problem: Problem, rtol: float) -> Outcome:
    _warm(len(problem.amplitude) > 1, rtol)
    start = process_time()
    velocities = _solve(problem, rtol)
    return velocities, process_time() - start


def _run_whole(problem: Problem, rtol: float) -> Outcome:
    """As _run, with every period made."""
    with whole():
        return _run(problem, rtol)


def _run_long(problem: Problem, rtol: float) -> Outcome:
    """As _run_whole, but the time is that of 300 further periods, scaled down: what is left when a call's fixed cost is spread."""
    longer = replace(problem, periods=problem.periods + 300)
    velocities, short = _run_whole(problem, rtol)
    return velocities, (_run_whole(longer, rtol)[1] - short) * problem.periods / 300


RTOLS = (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)
OURS = Rival(name="stickslip", pip="stickslip", module="stickslip", run=_run, settings=RTOLS, alone=True)
OURS_WHOLE = replace(OURS, name="stickslip, every period made", run=_run_whole)
OURS_LONG = replace(OURS, name="stickslip, fixed cost of the call taken off", run=_run_long)
