"""heyoka: Taylor series of tolerance-dependent order, compiled for the equations; one case, or 8 or 16 in lanes.

The equations have a kink at v = 0. A terminal event there ends the step on it, and the event's callback writes the other side's
coefficients into the parameters: every Taylor series sees one smooth branch. What measuring settled:
- `select(v > 0, ...)` without an event is 3 us cheaper and 5 % wrong, or, with steps short enough for 2e-3, twice as dear;
- fast_math is worth 11 % at the same error, callbacks that write through views taken beforehand 5 %, v' in expanded form 5 %,
  16 lanes instead of 8 10 %, 32 none; force_avx512, slp_vectorize and high_accuracy change nothing, compact_mode costs 40 %;
- a cooldown must be given, since the automatic one fails where v' = 0; the start is such a place, so v is nudged there by 1e-18.
"""

from __future__ import annotations

from functools import cache
from time import process_time

import numpy as np

from problem import MASS, OMEGA, PERIOD, SIGMA0, SIGMA1, SIGMA2, V_S, WEIGHT, Problem
from rivals.base import Outcome, Rival

COOLDOWN = 1e-9  # seconds, 3e-8 of a period
NUDGE = 1e-18


def _equations():
    """[(state, its rate)] with par[0] the push and par[1], par[2] = s W/sigma0 (mu_s, f_s - mu_s)."""
    import heyoka as hy

    v, z, x = hy.make_vars("v", "z", "x")
    flow_back = v * z / (hy.par[1] + hy.par[2] * hy.exp(-(v * v) * (1 / V_S**2)))
    vdot = hy.par[0] * hy.sin(OMEGA * hy.time) - ((SIGMA1 + SIGMA2) / MASS) * v - (SIGMA0 / MASS) * z + (SIGMA1 / MASS) * flow_back
    return v, [(v, vdot), (z, v - flow_back), (x, v)]


def _side_numbers(mu0: float) -> tuple[list[float], list[float]]:
    """par[1], par[2] forward and backward."""
    (mu_p, f_p), (mu_m, f_m) = Problem(mu0, np.zeros(1)).sides
    k = WEIGHT / SIGMA0
    return [k * mu_p, k * (f_p - mu_p)], [-k * mu_m, -k * (f_m - mu_m)]


@cache
def _batch(mu0: float, tol: float, lanes: int):
    """(integrator, forward numbers), compiled once."""
    import heyoka as hy

    hy.set_logger_level_error()
    v, system = _equations()
    (a_plus, b_plus), (a_minus, b_minus) = _side_numbers(mu0)
    views = []

    def cross(_ta, direction, lane):
        a, b = views
        if direction > 0:
            a[lane], b[lane] = a_plus, b_plus
        else:
            a[lane], b[lane] = a_minus, b_minus
        return True

    event = hy.t_event_batch(v, callback=cross, cooldown=COOLDOWN)
    ta = hy.taylor_adaptive_batch(system, np.zeros((3, lanes)), pars=np.zeros((3, lanes)), tol=tol, t_events=[event], fast_math=True)
    views.extend((ta.pars[1], ta.pars[2]))
    return ta, (a_plus, b_plus)


@cache
def _single(mu0: float, tol: float):
    """As _batch, one case."""
    import heyoka as hy

    hy.set_logger_level_error()
    v, system = _equations()
    plus, minus = map(np.array, _side_numbers(mu0))
    views = []

    def cross(_ta, direction):
        views[0][:] = plus if direction > 0 else minus
        return True

    event = hy.t_event(v, callback=cross, cooldown=COOLDOWN)
    ta = hy.taylor_adaptive(system, [0.0, 0.0, 0.0], pars=[0.0, 0.0, 0.0], tol=tol, t_events=[event], fast_math=True)
    views.append(ta.pars[1:])
    return ta, plus


def _propagate(ta, push, plus, problem: Problem) -> tuple:
    """Path at the end of settling and at the end, from rest."""
    if hasattr(ta, "set_time"):  # batch
        ta.set_time(0.0)
    else:
        ta.time = 0.0
    ta.state[:] = 0.0
    ta.state[0] = NUDGE
    ta.pars[0] = push
    ta.pars[1], ta.pars[2] = plus
    ta.reset_cooldowns()
    ta.propagate_until(problem.settle * PERIOD)
    settled = ta.state[2].copy()
    ta.propagate_until(problem.periods * PERIOD)
    return settled, ta.state[2].copy()


def run_batch(problem: Problem, setting: tuple[float, int]) -> Outcome:
    tol, lanes = setting
    ta, plus = _batch(problem.mu0, tol, lanes)
    push = problem.push
    full = np.resize(push, -(-len(push) // lanes) * lanes).reshape(-1, lanes)
    start = process_time()
    paths = [_propagate(ta, row, plus, problem) for row in full]
    seconds = process_time() - start
    settled, end = (np.concatenate(part)[: len(push)] for part in zip(*paths, strict=True))
    return problem.mean_velocity(settled, end), seconds


def run_single(problem: Problem, tol: float) -> Outcome:
    ta, plus = _single(problem.mu0, tol)
    start = process_time()
    paths = np.array([_propagate(ta, push, plus, problem) for push in problem.push])
    seconds = process_time() - start
    return problem.mean_velocity(paths[:, 0], paths[:, 1]), seconds


TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-12, 1e-14)
RIVALS = (
    Rival(
        name="heyoka batch, event at v = 0",
        pip="heyoka",
        module="heyoka",
        run=run_batch,
        cases=512,
        cases_stiff=16,
        # (tolerance, lanes)
        settings=tuple((tol, lanes) for tol in TOLERANCES for lanes in (8, 16)),
        settings_stiff=tuple((tol, 16) for tol in (1e-6, 1e-8, 1e-10, 1e-12)),
    ),
    Rival(
        name="heyoka single, event at v = 0",
        pip="heyoka",
        module="heyoka",
        run=run_single,
        cases=64,
        cases_stiff=2,
        alone=True,
        settings=TOLERANCES,
        settings_stiff=(1e-6, 1e-8, 1e-10, 1e-12),
    ),
)
