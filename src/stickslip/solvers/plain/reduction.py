"""From the dense output of one case to its row of a summary."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Model
from stickslip.models.machine_adapter import machine_of
from stickslip.results.pieces import DensePieces
from stickslip.results.steadiness import outcome_of
from stickslip.results.trajectory import Trajectory
from stickslip.solvers import strobes
from stickslip.solvers.plain.reduction_of_parts import reduced_parts
from stickslip.solvers.settings import Request


def reduced(todo: Request, model: Model, pieces: DensePieces, case: int) -> dict[str, Any]:
    """Raw results of one case."""
    T = float(todo.span[case])
    run = Trajectory(model, pieces, todo.periods, todo.settle, todo.rtol, todo.method)
    if machine_of(model).one_body is None:
        return reduced_parts(todo, run.with_axes)
    strobe = _strobe(run)
    period, limit = outcome_of(model, strobe, todo.method, todo.rtol)
    settle = todo.periods - period if todo.auto and period else todo.settle
    results = strobes.over_window(strobe[:, 0], settle, period, limit)
    t = strobes.strobe_samples(pieces.t[-1], period or 1, T)
    index = run._index(t)
    x, v, z = (of[:, 0] for of in run._states_at(t, index))
    mode, memory = run.pieces.mode[index, 0].astype(int), tuple(pieces.memory[index].T)
    codes = strobes.codes_of(model, v, z, mode, todo.slip_ratio, t, x, memory)
    number, seg_time, seg_code = strobes.segments_of(np.full(len(t), (period or 1) * T / len(t)), codes)
    return {
        **results, "periods_run": todo.periods, "status": 0,
        "v_min": v.min(), "v_max": v.max(), **_wide(run, T * results["window"], v),
        "seg_count": number, "seg_time": seg_time, "seg_code": seg_code, "margin_force": strobes.margin_force(model),
    }  # fmt: skip


def _wide(run: Trajectory, window: float, last: Any) -> dict[str, float]:
    """Extremes over the window, at the ends of the pieces in it, and of the last motion period."""
    t = run.pieces.t
    index = np.flatnonzero(t[:-1] >= t[-1] - window * (1 + 1e-12))
    v = np.concatenate([last, run._states_at(t[index], index)[1][:, 0]])
    return {"wide_min": v.min(), "wide_max": v.max()}


def _strobe(run: Trajectory) -> Any:
    """States at the borders of the periods, or at both ends of a run that has none."""
    if run.model.period is None:
        states = run._states_at(run.pieces.t[[0, -1]], np.array([0, len(run.pieces.mode) - 1]))
        return np.column_stack([of[:, 0] for of in states])
    return np.column_stack([run.strobe_x, run.strobe_v, *([] if run.strobe_z is None else [run.strobe_z])])
