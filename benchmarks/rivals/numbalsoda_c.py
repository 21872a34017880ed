"""numbalsoda: LSODA in C++ and dop853 in Fortran, with the right side as a C function: no Python in the loop.

One absolute tolerance serves all states, so the states are scaled (problem.py). No analytic Jacobian can be given.
PyPI has the source only: it builds where CMake finds a C++ and a Fortran compiler.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache, partial
from time import process_time

import numpy as np

from problem import PATH, Problem
from rivals.base import Outcome, Rival

# dop853 prints a warning for every stiff stretch; unbuffered, so that `_quiet` catches it before it waits for the exit
os.environ.setdefault("GFORTRAN_UNBUFFERED_ALL", "1")


@contextmanager
def _quiet() -> Iterator[None]:
    """Sends what compiled code prints to nowhere."""
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


@cache
def _compiled(method: str):
    """(address of the right side, the loop over cases), compiled once."""
    import numbalsoda
    from numba import carray, cfunc, njit

    from kernels import FAST, scaled_rhs

    @cfunc(numbalsoda.lsoda_sig, error_model="numpy", fastmath=FAST)
    def f(t, u, out, row):
        scaled_rhs(t, carray(u, (3,)), carray(out, (3,)), carray(row, (12,)))

    solver = getattr(numbalsoda, method)

    @njit
    def loop(address, rows, times, rtol, atol):
        found = np.empty((len(rows), 3))
        for i in range(len(rows)):
            states, fine = solver(address, np.zeros(3), times, rows[i], rtol, atol, 100_000_000)
            found[i] = states[:, 2]
            if not fine:
                found[i] = np.nan
        return found

    return f, loop


def _run(method: str, problem: Problem, rtol: float) -> Outcome:
    f, loop = _compiled(method)
    rows, times = problem.rows, problem.times
    loop(f.address, rows[:1], times / 1000, 1e-3, 1e-3)
    with _quiet():
        start = process_time()
        paths = loop(f.address, rows, times, rtol, 1e-2 * rtol) * PATH
        seconds = process_time() - start
    return problem.mean_velocity(paths[:, 1], paths[:, 2]), seconds


def _rival(method: str, **more) -> Rival:
    return Rival(name=f"numbalsoda {method}", pip="numbalsoda", module="numbalsoda", run=partial(_run, method), **more)


RIVALS = (
    _rival("lsoda", cases=64, alone=True, settings=(1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)),
    _rival("dop853", cases=32, cases_stiff=2, settings=(1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9), settings_stiff=(1e-4, 1e-6, 1e-8)),
)
