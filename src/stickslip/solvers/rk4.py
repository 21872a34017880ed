"""Classical Runge-Kutta steps of fixed length: the naive judge, and the method of the paper and of hand-written scripts.

It is here to be compared with, not to be used. For laws with an inner state it solves the plain equations; for set-valued
laws it follows the usual practice: friction by the sign of v, and a body that rests only where v is 0 to the last bit. So it
chatters where it should stick, and its error falls no faster than its step.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from stickslip.basics.batch import rows_of, with_row
from stickslip.basics.contracts import Array, Model, OneContact
from stickslip.basics.errors import InputError, SolveError, is_whole
from stickslip.basics.interruption import is_stopped, look
from stickslip.basics.pool import handed_out
from stickslip.basics.status import Status
from stickslip.engine import fixed_steps as engine
from stickslip.engine.kernels.columns import SEGS as SEGMENTS
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.machine_adapter import machine_of
from stickslip.models.mechanics import rest_velocity
from stickslip.results.dense_output import PolynomialPieces
from stickslip.results.steadiness import is_steady, outcome_of
from stickslip.results.summary import Summary
from stickslip.results.trajectory import Trajectory
from stickslip.solvers import strobes
from stickslip.solvers.gather import RawResults, gather, trajectory
from stickslip.solvers.part_results import OF_ONE_CONTACT, parts_of_one
from stickslip.solvers.settings import Request
from stickslip.solvers.time_dependence import check_period

#: Steps per drive period, if none are asked for.
STEPS = 2000
#: What may be asked for.
ALLOWED = "a whole number of steps per period, 4 to 10000000"
#: Steps that one call of the kernel does: it returns to Python so that Ctrl-C works.
SLICE = 1_000_000
#: Pieces of dense output per drive period; finer steps are thinned.
PIECES = 1000
_LOOKS = 360  # at the load, in a drive period


def allows(steps: Any) -> bool:
    """Whether this is a number of steps per period.

    Examples
    --------
    >>> allows(2000), allows(3), allows(2000.0)
    (True, False, False)
    """
    return is_whole(steps) and 4 <= steps <= 10_000_000


def solve(todo: Request) -> Trajectory | Summary:
    """Solve as asked; the option ``steps`` is the number of steps in each drive period."""
    steps = todo.options.get("steps", STEPS)
    if not allows(steps):
        raise InputError("solve", [f"steps = {steps!r}; allowed is {ALLOWED}; type for example steps={STEPS}"])
    check_period(todo.model)
    _check_load(todo.model)
    kernel = engine.fixed_step_kernel(todo.model)
    rows = rows_of(todo.model, kernel.names)
    if todo.keep == "summary":
        return gather(todo, "rk4", _parts(todo, kernel, rows, int(steps)))
    march = _March(todo.model, kernel, rows[0], todo.start[0], int(steps), thinned=True)
    march.go(todo.periods, report=lambda done: todo.progress(done, todo.periods), partial=todo.partial)
    if march.interrupted and march.done:
        return trajectory(todo, "rk4", march.pieces(), {"steps": march.done * int(steps)}, Status.NOT_COMPUTED)
    if march.done < todo.periods:
        raise SolveError(_message(todo, march, steps))
    return trajectory(todo, "rk4", march.pieces(), {"steps": todo.periods * int(steps), "steps_per_period": int(steps)})


def _message(todo: Request, march: _March, steps: int) -> str:
    """Where a run stopped."""
    return f"the run stopped in period {march.done + 1} of {todo.periods}: {Status.NOT_A_NUMBER.sentence}; type more than steps={steps}"


def _check_load(model: OneContact) -> None:
    """Refuse a load that falls to zero within a drive period: fixed steps do not end where contact is lost."""
    if not callable(model.load):
        return
    lowest = min(float(np.min(model.load(model.period * k / _LOOKS, 0.0))) for k in range(_LOOKS))
    if not lowest > 0:
        mistake = f'method = "rk4" does not see where contact is lost, and the load falls to {lowest:.6g} N'
        raise InputError("solve", [f'{mistake}; type method="auto", whose run ends there'])


class _March:
    """One case on its way: its state, its strobe states, and what of its steps is kept."""

    def __init__(self, model: Model, kernel: engine.FixedStepKernel, row: Any, start: Any, steps: int, thinned: bool):
        self.model, self.kernel, self.row, self.steps = model, kernel, row, steps
        self.state = np.array(start, float)
        self.every = -(-steps // PIECES) if thinned else 0
        self.strobe: list[Any] = [self.state[None, :].copy()]
        self.nodes: list[Any] = []
        self.extremes, self.done, self.interrupted = np.array([np.inf, -np.inf]), 0, False

    def go(self, periods: int, every: int | None = None, report: Callable[[int], None] | None = None, partial: bool = False) -> None:
        """Do some periods; `done` counts those that went well. After an interruption, fewer, if a part of them is asked for."""
        every = self.every if every is None else every
        block = max(1, SLICE // self.steps)
        per_period = -(-self.steps // every) if every else 0
        while periods > 0:
            count = min(block, periods)
            strobe, nodes = np.empty((count, len(self.state))), np.empty((per_period * count, 2 * len(self.state) - 1))
            extremes = np.empty(2)
            finished = self.kernel.advance(self.row, self.state, count, self.steps, every, strobe, nodes, extremes)
            self.done += finished
            if finished < count:
                return
            self.strobe += [strobe[1:], self.state[None, :].copy()]
            self.nodes.append(nodes)
            self.extremes = np.array([min(self.extremes[0], extremes[0]), max(self.extremes[1], extremes[1])])
            periods -= count
            if report is not None:
                report(self.done)
            self.interrupted = periods > 0 and is_stopped()
            if self.interrupted:
                if not partial:
                    look()
                return

    @property
    def strobes(self) -> Any:
        """x, v and z at the starts of the periods, and at the end."""
        return np.concatenate(self.strobe)

    def instants(self, every: int, first: int = 0) -> Any:
        """Times of the nodes that are kept from period `first` on, one step in `every`, and of the end [s]."""
        starts = np.arange(0, self.steps, every) / self.steps
        return np.append((np.arange(first, self.done)[:, None] + starts).ravel(), self.done) * float(self.model.period)

    def pieces(self) -> PolynomialPieces:
        """Dense output from the kept nodes, for all periods done."""
        t, n = self.instants(self.every), self.kernel.states
        nodes = np.concatenate(self.nodes)
        y = np.concatenate([nodes[:, : n + 1], self.state[None, :]])
        slope = np.concatenate([nodes[:, n + 1 :], nodes[:1, n + 1 :]])
        slope[-1] = self._last_slope()
        return _dense(t, y, slope)

    def _last_slope(self) -> Any:
        """Slopes at the end of the run: those at the start of the next period."""
        node = np.empty((1, 2 * len(self.state) - 1))
        self.kernel.advance(self.row, self.state.copy(), 1, self.steps, self.steps, np.empty((1, len(self.state))), node, np.zeros(2))
        return node[0, self.kernel.states + 1 :]


def _dense(t: Array, y: Array, slope: Any) -> PolynomialPieces:
    """Cubic Hermite pieces, with a quartic term in v so that its integral is the step's own change of x."""
    h = np.diff(t)[:, None]
    a, b, da, db = y[:-1, 1:], y[1:, 1:], slope[:-1] * h, slope[1:] * h
    c = np.stack([a, da, 3 * (b - a) - 2 * da - db, 2 * (a - b) + da + db, np.zeros_like(a)], axis=2)
    missing = 30 * ((y[1:, 0] - y[:-1, 0]) / h[:, 0] - (c[:, 0] / np.arange(1, 6)).sum(axis=1))
    c[:, 0, 2:] += missing[:, None] * [1, -2, 1]
    return PolynomialPieces(*_cut_at_rest(t, y[:-1, 0], c))


def _cut_at_rest(t: Array, x0: Any, c: Any) -> tuple[Any, Any, Any, Any]:
    """The pieces, those in which v changes its sign cut in two there: (t, mode, x0, coefficients)."""
    powers = np.arange(c.shape[2])
    ends = c[:, 0].sum(axis=1)
    crossed = np.flatnonzero(c[:, 0, 0] * ends < 0)
    low, high = np.zeros(len(crossed)), np.ones(len(crossed))
    for _ in range(53):
        middle = 0.5 * (low + high)
        same = (c[crossed, 0] * middle[:, None] ** powers).sum(axis=1) * c[crossed, 0, 0] > 0
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    part = 0.5 * (low + high)
    h = np.diff(t)
    where = crossed + 1
    late = _shifted(c[crossed], part)
    late[:, 0, 0] = 0.0
    middle_x = x0[crossed] + h[crossed] * part * (c[crossed, 0] * part[:, None] ** powers / (powers + 1)).sum(axis=1)
    c = c.copy()
    c[crossed] *= part[:, None, None] ** powers
    mode = np.sign(c[:, 0].sum(axis=1) + c[:, 0, 0]).astype(np.int8)
    mode[crossed] = np.sign(c[crossed, 0, 0])
    return (
        np.insert(t, where, t[crossed] + part * h[crossed]), np.insert(mode, where, np.sign(ends[crossed]).astype(np.int8)),
        np.insert(x0, where, middle_x), np.insert(c, where, late, axis=0),
    )  # fmt: skip


def _shifted(c: Any, part: Any) -> Any:
    """The same polynomials on what lies behind `part`, with theta again from 0 to 1."""
    from math import comb

    degree, rest = c.shape[2], 1 - part[:, None]
    late = [sum(comb(k, j) * c[:, :, k] * part[:, None] ** (k - j) for k in range(j, degree)) * rest**j for j in range(degree)]
    return np.stack(late, axis=2)


# ---- batches ----
#: Results of a case that could not be solved.
_NOTHING: dict[str, Any] = strobes.NOTHING | {
    **dict.fromkeys(("v_min", "v_max", "wide_min", "wide_max"), np.nan),
    "seg_count": 0, "seg_time": np.zeros(SEGMENTS), "seg_code": np.zeros(SEGMENTS, np.int8), "margin_force": np.inf,
}  # fmt: skip


def _parts(todo: Request, kernel: engine.FixedStepKernel, rows: Any, steps: int) -> Iterator[tuple[tuple[int, int], RawResults]]:
    """Raw results case by case; the compiled loop lets go of the lock, so threads help."""

    def work(i: int) -> dict[str, Any]:
        model = with_row(todo.model, kernel.names, rows[i])
        march = _March(model, kernel, rows[i], todo.start[i], steps, thinned=False)
        result = strobes.case_or_nothing(lambda: _summary(todo, march), _NOTHING, todo.partial)
        of_one = {name: np.array([result[name]]) for name in (*OF_ONE_CONTACT, "displacement", "window")}
        result["parts"] = parts_of_one(of_one, rest_velocity(model), np.array([float(model.period)]))
        todo.progress(i + 1, len(rows))
        return result

    for i, result in handed_out(work, range(len(rows)), todo.workers, all_parts=todo.partial):
        yield (i, i + 1), strobes.raw(result)


def _summary(todo: Request, march: _March) -> dict[str, Any]:
    asked, period, results = 0, 0, {}
    for count in _blocks(todo):
        if asked <= todo.settle:  # the extremes are those of the window
            march.extremes = np.array([np.inf, -np.inf])
        march.go(count)
        asked += count
        if march.done < asked:
            failure = _message(todo, march, march.steps)
            return {**_NOTHING, "status": Status.NOT_A_NUMBER, "periods_run": march.done, "failure": failure}
        way, period, limit = _repetition(todo, march)
        repeats = todo.auto and period > 0  # the mean is then over one motion period, if it is that of the steady motion
        results = strobes.over_window(way, march.done - period if repeats else todo.settle, period, limit)
        if repeats and is_steady(march.model, results, todo.method, todo.rtol):
            break
    done, wide = march.done, march.extremes
    count, seg_time, seg_code = _last(todo, march, period or 1)
    return {
        **results, "periods_run": done, "status": int(todo.auto and done < todo.periods),
        "v_min": march.extremes[0], "v_max": march.extremes[1],
        "wide_min": min(wide[0], march.extremes[0]), "wide_max": max(wide[1], march.extremes[1]),
        "seg_count": count, "seg_time": seg_time, "seg_code": seg_code,
        "margin_force": strobes.margin_forces(machine_of(march.model))[0],
    }  # fmt: skip


def _repetition(todo: Request, march: _March) -> tuple[Any, int, float]:
    """The way at the strobe points, after how many of them the motion repeats, and the displacement in a period that it approaches."""
    x, v, z = march.strobes[:, :1], march.strobes[:, 1:2], march.strobes[:, None, 2:]
    return outcome_of(march.model, x, v, z, todo.method, todo.rtol)


def _blocks(todo: Request) -> list[int]:
    """Periods to do before each look at the strobe points."""
    if not todo.auto:
        return [n for n in (todo.settle, todo.periods - todo.settle) if n]
    return [min(8, todo.periods - first) for first in range(0, todo.periods, 8)]


def _last(todo: Request, march: _March, period: int) -> tuple[int, Any, Any]:
    """Segments and extremes of one more motion period, at the instants of the steps."""
    march.nodes.clear()
    march.extremes = np.array([np.inf, -np.inf])
    first, every = march.done, max(1, march.steps // 5000)
    march.go(period, every)
    t, nodes = march.instants(every, first), np.concatenate(march.nodes)
    x, v, z = nodes[:, 0], nodes[:, 1], nodes[:, 2 : 1 + march.kernel.states]
    mode = np.where(v > 0, 1, -1) if law_of(march.model).dynamic else np.sign(v).astype(int)
    codes = strobes.codes_of(march.model, v, z, mode, todo.slip_ratio, t[:-1], x)
    return strobes.segments_of(np.full(len(v), period * float(march.model.period) / len(v)), codes)
