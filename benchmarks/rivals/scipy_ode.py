"""SciPy: LSODA through odeint (its loop is compiled; solve_ivp's is not), Radau and DOP853 through solve_ivp.

The right side and its Jacobian are Numba functions. None of SciPy's ODE solvers takes a LowLevelCallable, so each call
crosses Python; that crossing, not the method, is what these rows mostly measure.
"""

from __future__ import annotations

from functools import partial
from time import process_time

import numpy as np

from kernels import jacobian_tyu, rhs_tyu
from problem import PATH, Problem
from rivals.base import Outcome, Rival

# v and z of order 1 in scaled units; the path is a quadrature and grows, so it is watched less closely
ATOL = np.array([1e-2, 1e-2, 1.0])


def _odeint(problem: Problem, row: np.ndarray, rtol: float) -> np.ndarray:
    """Scaled path at the three times by LSODA."""
    from scipy.integrate import odeint

    return odeint(
        rhs_tyu, np.zeros(3), problem.times, args=(row,), Dfun=jacobian_tyu, tfirst=True, rtol=rtol, atol=rtol * ATOL, mxstep=10_000_000
    )[:, 2]


def _solve_ivp(method: str, problem: Problem, row: np.ndarray, rtol: float) -> np.ndarray:
    """Scaled path at the three times by a solve_ivp method."""
    from scipy.integrate import solve_ivp

    more = {"jac": jacobian_tyu} if method in ("Radau", "LSODA", "BDF") else {}
    done = solve_ivp(
        rhs_tyu, problem.times[[0, -1]], np.zeros(3), method, t_eval=problem.times, args=(row,), rtol=rtol, atol=rtol * ATOL, **more
    )
    return done.y[2]


def _run(path, problem: Problem, rtol: float) -> Outcome:
    """All cases, one after the other."""
    rows = problem.rows
    path(Problem(problem.mu0, problem.amplitude[:1], periods=2, settle=1), rows[0], 1e-3)
    start = process_time()
    paths = np.array([path(problem, row, rtol) for row in rows]) * PATH
    seconds = process_time() - start
    return problem.mean_velocity(paths[:, 1], paths[:, 2]), seconds


def _rival(name: str, path, **more) -> Rival:
    return Rival(name=name, pip="scipy numba", module="scipy.integrate", run=partial(_run, path), **more)


MULTISTEP = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
RIVALS = (
    _rival("scipy LSODA (odeint), Numba f, J", _odeint, cases=32, settings=MULTISTEP),
    _rival("scipy LSODA (solve_ivp), Numba f, J", partial(_solve_ivp, "LSODA"), cases=16, settings=MULTISTEP),
    _rival(
        "scipy DOP853, Numba f",
        partial(_solve_ivp, "DOP853"),
        cases=8,
        settings=(1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8),
        skip_stiff="not run: explicit, 5 000 000 when tried",
    ),
    _rival(
        "scipy Radau, Numba f, J",
        partial(_solve_ivp, "Radau"),
        cases=8,
        cases_stiff=4,
        settings=(1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7),
    ),
)
