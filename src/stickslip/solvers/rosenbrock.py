"""Dynamic laws: Rosenbrock steps in lanes, one engine for one case and for a million."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from stickslip.batch import rows_of
from stickslip.engine import lanes, tableaux, trace
from stickslip.errors import SolveError
from stickslip.pieces import PolynomialPieces
from stickslip.solvers.gather import Raw, gather, trajectory
from stickslip.solvers.request import Request
from stickslip.summary import STATUS, Summary
from stickslip.trajectory import Trajectory

__all__ = ["solve"]

#: At looser tolerances than this the fourth-order method is cheaper (benchmarks/work_precision.py).
LOOSE = 1e-4
#: Steps that a case may take, for each period it should run.
BUDGET = 200_000
CHUNK = 4096
#: The steps are held to a part of the tolerance asked for, so that energy closes to it and no case is an outlier.
SAFETY = 0.5


def _tableau(todo: Request) -> tableaux.Tableau:
    if todo.method == "auto":
        return tableaux.RODAS4 if todo.rtol >= LOOSE else tableaux.RODAS5P
    return tableaux.TABLEAUX[todo.method]


def solve(todo: Request) -> Trajectory | Summary:
    """Solve as asked."""
    tableau = _tableau(todo)
    kernel = lanes.kernel_of(todo.model, tableau, record=todo.cases == 1)
    rows = rows_of(todo.model, kernel.names)
    job = lanes.Job(
        todo.periods, todo.settle, todo.auto and todo.keep == "summary", SAFETY * todo.rtol, todo.slip_ratio, BUDGET * todo.periods
    )
    if todo.keep == "summary":
        return gather(todo, tableau.name, _parts(todo, kernel, rows, job))
    results = lanes.run(kernel, rows, todo.start, job, keep_pieces=True)
    if results.status[0] > 1:
        trace.check_numbers(todo.model)
        raise SolveError(
            f"the run stopped after {results.periods_run[0]} of {todo.periods} periods: {STATUS[int(results.status[0])]}; "
            f"the state was x, v, z = {results.end[0].tolist()}. Try another rtol (now {todo.rtol:g}) or start, and check the law's numbers"
        )
    counts = {"steps": int(results.accepted[0]), "rejected": int(results.rejected[0])}
    return trajectory(todo, tableau.name, _pieces(results.pieces, kernel, float(todo.model.period), todo.periods), counts)


def _parts(todo: Request, kernel: lanes.Kernel, rows: Any, job: lanes.Job) -> Any:
    """Raw results chunk by chunk, in order; threads share the chunks."""
    bounds = _bounds(len(rows), todo.workers)
    begun = [0] * len(bounds)

    def work(i: int) -> lanes.Results:
        first, last = bounds[i]

        def tell(count: int) -> None:
            begun[i] = count
            if todo.progress is not None:
                todo.progress(sum(begun), len(rows))

        return lanes.run(kernel, rows[first:last], todo.start[first:last], job, progress=tell)

    if todo.workers == 1 or len(bounds) == 1:
        yield from zip(bounds, map(_raw, map(work, range(len(bounds)))), strict=True)
        return
    with ThreadPoolExecutor(todo.workers) as pool:
        yield from zip(bounds, map(_raw, pool.map(work, range(len(bounds)))), strict=True)


def _bounds(cases: int, workers: int) -> list[tuple[int, int]]:
    """Chunks of cases: large enough for full lanes, small enough that threads finish together."""
    size = min(CHUNK, max(128, -(-cases // (workers * 2)))) if workers > 1 else CHUNK
    return [(i, min(i + size, cases)) for i in range(0, cases, size)]


def _raw(r: lanes.Results) -> Raw:
    return Raw(
        displacement=r.displacement, window=r.window, period=r.period, periods_run=r.periods_run, status=r.status,
        v_max=r.v_max, v_min=r.v_min, seg_count=r.seg_count, seg_time=r.seg_time, seg_code=r.seg_code,
        margin_force=np.full(len(r.status), np.inf),
    )  # fmt: skip


def _pieces(pieces: Any, kernel: lanes.Kernel, period: float, periods: int) -> PolynomialPieces:
    """The recorded steps of one case as dense output."""
    pieces = pieces[pieces[:, 0] < periods]
    ends = np.where(pieces[:, 2] >= period, (pieces[:, 0] + 1) * period, pieces[:, 0] * period + pieces[:, 2])
    t = np.concatenate([[0.0], ends])
    good = np.diff(t) > 0
    t, pieces = np.concatenate([[0.0], ends[good]]), pieces[good]
    coefficients = pieces[:, 5:].reshape(len(pieces), kernel.states, kernel.degree + 1)
    return PolynomialPieces(t=t, mode=pieces[:, 4].astype(np.int8), x0=pieces[:, 3], coefficients=coefficients)
