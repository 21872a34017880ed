"""SUNDIALS CVODE through scikit-sundae: BDF, dense solver, Numba right side and analytic Jacobian.

scikit-sundae gives Python callables only, so as with SciPy each call crosses Python.
"""

from __future__ import annotations

from time import process_time

import numpy as np

from kernels import scaled_jacobian, scaled_rhs
from problem import PATH, Problem
from rivals.base import Outcome, Rival

ATOL = np.array([1e-2, 1e-2, 1.0])  # as for SciPy


def _f(t, u, out, data):
    scaled_rhs(t, u, out, data[0])


def _jacobian(t, u, _slope, out, data):
    scaled_jacobian(u, out, data[0])


def _path(problem: Problem, row: np.ndarray, rtol: float) -> np.ndarray:
    from sksundae.cvode import CVODE

    solver = CVODE(_f, userdata=(row,), jacfn=_jacobian, rtol=rtol, atol=rtol * ATOL, max_num_steps=10_000_000)
    return solver.solve(problem.times, np.zeros(3)).y[:, 2]


def _run(problem: Problem, rtol: float) -> Outcome:
    rows = problem.rows
    _path(Problem(problem.mu0, problem.amplitude[:1], periods=2, settle=1), rows[0], 1e-3)
    start = process_time()
    paths = np.array([_path(problem, row, rtol) for row in rows]) * PATH
    seconds = process_time() - start
    return problem.mean_velocity(paths[:, 1], paths[:, 2]), seconds


RIVALS = (
    Rival(
        name="SUNDIALS CVODE (scikit-sundae), Numba f, J",
        pip="scikit-sundae",
        module="sksundae",
        run=_run,
        cases=16,
        cases_stiff=8,
        settings=(1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11),
    ),
)
