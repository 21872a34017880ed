"""From raw results to what a user gets: one place, whatever the solver."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import MISSING, dataclass, fields
from typing import Any

import numpy as np

from stickslip.batch import spread
from stickslip.coded_words import CodedWords
from stickslip.errors import SolveError
from stickslip.machine_adapter import machine_of
from stickslip.solvers.part_results import RawParts, columns_of_parts, of_own_parts, typed
from stickslip.solvers.request import Request, provenance
from stickslip.status import STATUS, Status
from stickslip.steadiness import STEADY, UNKNOWN, judged, mean_tolerance
from stickslip.summary import Summary
from stickslip.trajectory import Trajectory

__all__ = ["NEEDED", "Raw", "gather", "trajectory"]


@dataclass(frozen=True, eq=False)
class Raw:
    """What a batch solver finds for each case, before any word is put on it."""

    displacement: Any  # [m] over the window
    window: Any  # [drive periods]
    period: Any  # period number, 0 if none
    periods_run: Any
    status: Any
    v_max: Any
    v_min: Any
    seg_count: Any
    seg_time: Any  # [s]
    seg_code: Any
    margin_force: Any
    limit: Any  # displacement in a drive period that the motion approaches [m], see stickslip.recurrence
    wide_max: Any  # extremes of v over the whole window of the displacement [m/s]
    wide_min: Any
    friction_power: Any = None  # [W] over the last motion period, where the solver measures it
    parts: RawParts | None = None  # of a machine that lists its bodies: it has no velocity and no segments of its own
    observed: dict[str, Any] | None = None  # a user's own columns


#: What every batch solver must find.
NEEDED = tuple(f.name for f in fields(Raw) if f.default is MISSING)


def gather(todo: Request, method: str, parts: Iterable[tuple[tuple[int, int], Raw]]) -> Summary:
    """A summary from raw results that arrive chunk by chunk, in any order."""
    cases = todo.cases
    T, free = np.broadcast_to(todo.span, (cases,)), spread(machine_of(todo.model).free_velocity, todo.labels)
    columns: dict[str, Any] = {}
    coded: dict[str, dict[int, CodedWords]] = {}
    for (first, last), raw in parts:
        for name, values in _columns(todo, raw, T[first:last], free[first:last], mean_tolerance(method, todo.rtol)).items():
            if (first, last) == (0, cases):
                columns[name] = values
                continue
            if isinstance(values, CodedWords):
                coded.setdefault(name, {})[first] = values
                continue
            if name not in columns:
                columns[name] = np.empty((cases, *values.shape[1:]), values.dtype)
            elif values.itemsize > columns[name].itemsize:  # longer words
                columns[name] = columns[name].astype(values.dtype)
            columns[name][first:last] = values
    for name, by_case in coded.items():
        begins, *others = (by_case[case] for case in sorted(by_case))
        columns[name] = begins.joined(others)
    shaped = {name: values.reshape((*todo.labels.shape, *values.shape[1:])) for name, values in columns.items()}
    tolerance = None if method == "exact" else todo.rtol
    return Summary(todo.model, todo.labels, shaped, provenance(todo, method, tolerance))


def _columns(todo: Request, raw: Raw, T: Any, free: Any, tolerance: float) -> dict[str, Any]:
    good = raw.status <= Status.REPEATS
    with np.errstate(invalid="ignore", divide="ignore"):
        velocity = np.where(good, raw.displacement / (raw.window * T), np.nan)
        approached = np.where(good & (todo.model.period is not None), raw.limit / T, np.nan)
    steadiness = judged(velocity, approached, raw.period, free, tolerance) if todo.model.period is not None else np.full(len(T), UNKNOWN)
    lasting = steadiness == STEADY  # then the last motion period says all; else the extremes are those of the window of the mean
    rtol = todo.rtol if machine_of(todo.model).has_inner_states else 0.0
    if raw.parts is None:
        of_parts = _columns_of_one(raw, T, good, lasting, todo.dwell, rtol)
    else:
        of_parts = columns_of_parts(raw.parts, T, raw.window, raw.period, good, lasting, todo.dwell, rtol)
        of_parts = of_own_parts(of_parts, machine_of(todo.model))
    power = of_parts.pop("friction_power", None)
    return {
        "mean_velocity": velocity,
        **of_parts,
        "period": np.where(good, raw.period, 0),
        "displacement": raw.displacement,
        **({} if power is None else {"friction_power": power}),
        "steadiness": steadiness.astype(np.int8),
        "settling_error": np.where(np.isfinite(approached), abs(velocity - approached), np.nan),
        "periods_run": raw.periods_run,
        "status": raw.status,
        **{name: np.where(good, values, np.nan) for name, values in (raw.observed or {}).items()},
    }


def _columns_of_one(raw: Raw, T: Any, good: Any, lasting: Any, dwell: float, rtol: float) -> dict[str, Any]:
    """What is about the velocity and the contact of the only body."""
    seg = raw.seg_count, raw.seg_time, raw.seg_code
    found = typed(seg, T, raw.period, raw.margin_force, raw.displacement, (raw.v_max, raw.v_min), raw.window, dwell, rtol, good)
    found["velocity_max"] = np.where(good, np.where(lasting, raw.v_max, np.maximum(raw.v_max, raw.wide_max)), np.nan)
    found["velocity_min"] = np.where(good, np.where(lasting, raw.v_min, np.minimum(raw.v_min, raw.wide_min)), np.nan)
    if raw.friction_power is not None:
        found["friction_power"] = np.where(good, raw.friction_power, np.nan)
    return found


def _remedy(status: int) -> str:
    """What to change where a run ended at its start."""
    if status == Status.LOST:
        return "nothing presses the body on its track there; give a smaller vertical vibration, more gravity or another phase of the drive"
    return "give a longer run or other numbers"


def trajectory(todo: Request, method: str, pieces: Any, counts: dict[str, Any], status: int = 0) -> Trajectory:
    """A trajectory from dense output, cut at the duration that was asked for; `SolveError` where there is no motion at all."""
    if len(pieces.mode) == 0 or not pieces.t[-1] > pieces.t[0]:
        raise SolveError(f"the run ended at its start, t = {float(pieces.t[0]):.6g} s: {STATUS[status]}; {_remedy(status)}")
    tolerance = None if method == "exact" else todo.rtol
    if todo.duration is not None and pieces.t[-1] > todo.duration:
        pieces, status = pieces.until(todo.duration), 0
    return Trajectory(
        model=todo.model, pieces=pieces, periods=todo.periods, settle=todo.settle, rtol=todo.rtol, method=method,
        status=STATUS[status], samples=todo.samples, start=dict(todo.given_start),
        provenance=provenance(todo, method, tolerance), counts=counts,
    )  # fmt: skip
