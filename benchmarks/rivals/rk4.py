"""Hand-written RK4 in Numba, fixed step, scalars only: what most people write first."""

from __future__ import annotations

from time import process_time

import numpy as np
from numba import njit

from kernels import FAST, flow
from problem import PERIOD, Problem
from rivals.base import Outcome, Rival


@njit(error_model="numpy", fastmath=FAST, cache=True)
def _paths(rows, steps, settle, periods, period):
    """Displacement at the end of settling and at the end, for each case. x is summed as a fifth-order free rider."""
    found = np.empty((len(rows), 2))
    h = period / steps
    for i in range(len(rows)):
        p = rows[i]
        v = z = x = 0.0
        for k in range(periods):
            if k == settle:
                found[i, 0] = x
            for j in range(steps):
                t = j * h  # the drive is periodic: no need for the full time
                a1, b1 = flow(t, v, z, p)
                v2 = v + 0.5 * h * a1
                a2, b2 = flow(t + 0.5 * h, v2, z + 0.5 * h * b1, p)
                v3 = v + 0.5 * h * a2
                a3, b3 = flow(t + 0.5 * h, v3, z + 0.5 * h * b2, p)
                v4 = v + h * a3
                a4, b4 = flow(t + h, v4, z + h * b3, p)
                x += h / 6 * (v + 2 * v2 + 2 * v3 + v4)
                v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
                z += h / 6 * (b1 + 2 * b2 + 2 * b3 + b4)
        found[i, 1] = x
    return found


def _run(problem: Problem, steps: int) -> Outcome:
    """Fixed `steps` per period."""
    rows = problem.rows
    _paths(rows[:1], 2, 0, 1, PERIOD)
    start = process_time()
    paths = _paths(rows, steps, problem.settle, problem.periods, PERIOD)
    seconds = process_time() - start
    return problem.mean_velocity(paths[:, 0], paths[:, 1]), seconds


RIVALS = (
    Rival(
        name="RK4, Numba, scalars",
        pip="numba",
        module="numba",
        run=_run,
        cases=32,
        cases_stiff=4,
        alone=True,
        # steps per period
        settings=(300, 500, 700, 1000, 2000, 4000, 8000, 16_000, 64_000, 256_000),
        settings_stiff=(64_000, 128_000, 256_000, 512_000),
    ),
)
