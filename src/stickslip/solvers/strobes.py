"""From strobe states and one sampled motion period to the raw results of a case: for the methods that have no lanes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model, Numeric
from stickslip.basics.interruption import Interrupted, look
from stickslip.basics.status import Status
from stickslip.engine.kernels.columns import SEGS as SEGMENTS
from stickslip.models.forces import slip_ratio as slip_ratio_of
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.machine_adapter import MachineAdapter
from stickslip.models.normal_loads import normal_load
from stickslip.results.steadiness import window_count
from stickslip.solvers.gather import OF_CASES, RawResults

_LOOKS = 5000  # in a drive period
#: Results of a case that could not be solved, but for its parts.
NOTHING: dict[str, Any] = {"displacement": np.nan, "window": 1.0, "period": 0, "limit": np.nan, "periods_run": 0, "status": 4}


def case_or_nothing(work: Callable[[], dict[str, Any]], nothing: dict[str, Any], partial: bool) -> dict[str, Any]:
    """The results of one case; after an interruption, where a part of a batch is taken, those of a case that is not computed."""
    try:
        look()
        return work()
    except Interrupted:
        if not partial:
            raise
        return {**nothing, "status": Status.NOT_COMPUTED}


def codes_of(model: Model, v: Numeric, z: Numeric, mode: Any, slip_ratio: float, t: Numeric, x: Numeric, memory: Any = ()) -> Any:
    """The mode of the body at sampled instants: +2, -2 slipping, 0 stuck, +1, -1 elastic (see `stickslip.results.segments`)."""
    if not law_of(model).states:
        return 2 * mode
    slip, load = model.contact_velocity(v), normal_load(model, t, x)  # type: ignore[attr-defined]
    ratio = slip_ratio_of(law_of(model), model.velocity_scale, mode, slip, load, z.T, memory)  # type: ignore[attr-defined]
    return mode * np.where(ratio >= slip_ratio, 2, 1)


def over_window(x: Array, settle: int, period: int, limit: float) -> dict[str, Any]:
    """The displacement over the window, from positions at the strobe points; with period number and the displacement approached."""
    count = window_count(len(x) - 1, settle, period)
    return {"period": period, "limit": limit, "displacement": float(x[-1] - x[-1 - count]), "window": float(count)}


def strobe_samples(end: float, periods: int, T: float) -> Any:
    """Instants at which the last drive periods before `end` are sampled."""
    count = _LOOKS * periods
    return end - periods * T * (1 - (np.arange(count) + 0.5) / count)


def margin_forces(machine: MachineAdapter) -> Array:
    """Of each contact nothing that these methods measure: without meaning for a dynamic law, not known for a set-valued one."""
    return np.array([np.inf if law.dynamic else np.nan for law in machine.laws])


def segments_of(durations: Any, codes: Array) -> tuple[int, Any, Any]:
    """Stretches of one code: their number (-1 if too many to keep), durations and codes."""
    seg_time, seg_code = np.zeros(SEGMENTS), np.zeros(SEGMENTS, np.int8)
    starts = np.flatnonzero(np.diff(codes, prepend=99))
    if len(starts) > SEGMENTS:
        return -1, seg_time, seg_code
    seg_time[: len(starts)] = np.add.reduceat(durations, starts)
    seg_code[: len(starts)] = codes[starts]
    return len(starts), seg_time, seg_code


def raw(case: dict[str, Any]) -> RawResults:
    """The results of one case, by the names of `RawResults`; "failure" says where and why it ended too early."""
    columns: dict[str, Any] = {name: np.array([case[name]]) for name in OF_CASES}
    return RawResults(**columns, parts=case["parts"], failures={0: case["failure"]} if "failure" in case else {})
