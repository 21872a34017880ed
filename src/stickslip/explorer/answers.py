"""What a page is answered: curves with the figures of merit, a map, a strip. Plain computing, stopped when nobody waits any more."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.analysis.motion import motion
from stickslip.analysis.steady import mean_velocity
from stickslip.errors import InputError, StickslipError
from stickslip.explorer.asked import Message, Plane, State
from stickslip.explorer.code import python
from stickslip.explorer.effort import affordable
from stickslip.explorer.frames import written
from stickslip.explorer.kernels import Kernels
from stickslip.explorer.models import DRIVES, FRICTION
from stickslip.explorer.parameters import PARAMETERS
from stickslip.solvers import solve

__all__ = ["TYPES", "Stopped", "answer", "run_of", "sentence"]

Stop = Callable[[], bool]

#: Motion types in the order of their codes on a map.
TYPES = ("rest", "presliding", "I", "II", "III", "IV", "other")
#: Drive periods of a run while a slider moves, and when it rests.
COARSE, FINE = 40, 200
#: Loose enough for the quick method, tight enough for four digits.
RTOL = 1e-4
#: Most seconds that a map or a strip may take.
PATIENCE = 8.0
SAMPLES, LONGEST = 256, 8


class Stopped(Exception):
    """Nobody waits for this answer any more."""


def answer(asked: Message, kernels: Kernels, stop: Stop) -> bytes:
    """The bytes that answer a request; what is wrong with its numbers is an answer too."""
    head = {"channel": asked.channel, "id": asked.id}
    try:
        found = {"curves": _curves, "map": _map, "strip": _strip}[asked.channel](asked, kernels, stop)
    except InputError as error:
        found = {"kind": "problems", "problems": [sentence(p) for p in error.problems]}, {}
    except StickslipError as error:
        found = {"kind": "problems", "problems": [str(error)]}, {}
    header, arrays = found
    return written({**head, **header}, arrays)


def sentence(problem: str) -> str:
    """A problem as a page says it: what to type in Python is of no use there."""
    return "; ".join(part for part in problem.split("; ") if not part.startswith("type "))


def _compiling(law: str, state: State) -> str:
    return f"preparing {FRICTION[law].label} × {DRIVES[state.drive].label}: compiled once, which takes some seconds, and kept for later"


# ---- curves ----
def run_of(state: State, law: str, fine: bool, robot: Any = None) -> Any:
    """The run of one law."""
    made = state.robot(law) if robot is None else robot
    return solve(made, periods=affordable(made, FINE if fine else COARSE), rtol=RTOL, keep="trajectory", samples=400 if fine else 48)


def _curves(asked: Message, kernels: Kernels, stop: Stop) -> tuple[dict[str, Any], dict[str, Any]]:
    state, laws, runs = asked.state, [], {}
    for law in state.laws:
        entry: dict[str, Any] = {"name": law, "label": FRICTION[law].label}
        laws.append(entry)
        robot = state.robot(law)
        if not kernels.ready(state, law, robot, False):
            entry["waits"] = _compiling(law, state)
            continue
        if stop():
            raise Stopped
        runs[law] = run_of(state, law, asked.fine, robot)
        entry["mean_velocity"] = _mean(runs[law])
    header: dict[str, Any] = {"kind": "curves", "fine": asked.fine, "laws": laws, "period": float(robot.period), "samples": SAMPLES}
    header |= {"figures": None, "shown": 3, "once": 3}
    if state.law in runs:
        header["figures"] = _figures(runs[state.law])
        count = header["figures"]["period_number"] or LONGEST
        header |= {"once": min(count, LONGEST), "shown": 3 if count == 1 else min(2 * count, LONGEST)}
    arrays: dict[str, Any] = {}
    for law, run in runs.items():
        arrays |= {f"{law}.{name}": column for name, column in _columns(run, header["shown"], law == state.law).items()}
    if state.law in runs:
        header["figures"]["power"] = _power(runs[state.law], count, arrays)
    if asked.fine:
        header["python"] = python(state)
    return header, arrays


def _mean(run: Any) -> float | None:
    return None if len(run.strobe_times) < 3 else float(mean_velocity(run))


def _figures(run: Any) -> dict[str, Any]:
    """Figures of merit of a run."""
    if len(run.strobe_times) < 3:
        raise InputError("run", [f"{run.status} after {float(run.pieces.t[-1]):.4g} s, within the first periods"])
    m = motion(run)
    return {
        "mean_velocity": float(mean_velocity(run)), "motion_type": m.type, "pattern": m.pattern, "margin": m.margin,
        "period_number": m.period, "direction": m.direction, "stick_fraction": m.stick_fraction,
        "forward_fraction": m.forward_fraction, "backward_fraction": m.backward_fraction,
        "status": run.status, "periods": run.periods, "method": run.method, "notes": list(run.notes),
    }  # fmt: skip


def _power(run: Any, count: int, arrays: dict[str, Any]) -> float:
    """Mean power of the actuator in the steady motion [W]: what friction takes, less what gravity gives."""
    law = next(name for name in arrays if name.endswith(".mode")).partition(".")[0]
    last = slice(-(SAMPLES * count + 1), None)
    t, v, R = (arrays[f"{law}.{name}"][last] for name in ("t", "v", "R"))
    taken = np.trapezoid(R * v, t) / np.ptp(t)
    return float(taken - run.model.total_mass * run.model.track.along(run.model.gravity) * np.trapezoid(v, t) / np.ptp(t))


def _columns(run: Any, shown: int, main: bool) -> dict[str, Any]:
    """The last periods of a run: times from their start, and what the page draws."""
    count = min(shown, len(run.strobe_times) - 1)
    end = float(run.strobe_times[-1])
    start = end - count * run.period_time
    at = run.at(np.clip(np.linspace(start, end, SAMPLES * count + 1), start, end))
    found = {"t": at["t"] - start, "v": at["v"], "x": at["x"] - at["x"][0], "R": at["friction_force"]}
    if main:
        found |= {"xi": at["xi"], "mode": at["mode"]}
    kept = min(max(len(run.strobe_times) - 1 - int(run.settle), 1), 64)
    drift, instants = float(at["x"][-1] - at["x"][0]) / (end - start), run.strobe_times[-kept:]
    return found | {"strobe_s": run.strobe_x[-kept:] - at["x"][0] - drift * (instants - start), "strobe_v": run.strobe_v[-kept:]}


# ---- maps ----
def _map(asked: Message, kernels: Kernels, stop: Stop) -> tuple[dict[str, Any], dict[str, Any]]:
    state, plane = asked.state, asked.plane
    assert plane is not None
    header = _axes(plane) | {"kind": "map", "law": state.law}
    if not kernels.ready(state, state.law, state.robot(), True):
        return header | {"kind": "waits", "waits": _compiling(state.law, state)}, {}
    x, y = (np.linspace(*span, n) for span, n in zip(plane.spans, plane.cells, strict=True))
    grid = [np.broadcast_to(a, (len(y), len(x))) for a in (x[None, :], y[:, None])]
    many, good = _batch(state, plane.names, grid)
    shape = grid[0].shape
    columns = {name: np.full(shape, np.nan) for name in ("mean_velocity", "motion_type", "period", "stick_fraction")}
    began = time.perf_counter()
    if many is not None:
        solved = solve(many, periods=FINE, settle="auto", rtol=1e-3, keep="summary", progress=_watch(stop))
        ended = np.isin(solved.status, (0, 1))
        for name in columns:
            values = _codes(solved.motion_type) if name == "motion_type" else np.asarray(solved.columns[name], float)
            columns[name][good] = np.where(ended, values, np.nan).ravel()
    return header | {"types": TYPES, "seconds": time.perf_counter() - began}, columns


def _batch(state: State, names: tuple[str, ...], grid: list[Any]) -> tuple[Any, Any]:
    """The robots of a map as one batch, and which cells they are; cells that no robot can have are left out."""
    good = np.ones(grid[0].shape, bool)
    try:
        return state.robot(**{name: a.ravel() for name, a in zip(names, grid, strict=True)}), good
    except InputError:
        pass
    for cell in np.ndindex(good.shape):
        try:
            state.robot(None, **{name: float(a[cell]) for name, a in zip(names, grid, strict=True)})
        except InputError as error:
            good[cell], last = False, error
    if not good.any():
        raise last
    return state.robot(**{name: a[good] for name, a in zip(names, grid, strict=True)}), good


def _codes(types: Any) -> Any:
    """Motion types as the numbers of `TYPES`."""
    found = np.full(np.shape(types), len(TYPES) - 1, float)
    for code, name in enumerate(TYPES):
        found[np.asarray(types) == name] = code
    return found


def _axes(plane: Plane) -> dict[str, Any]:
    return {"names": plane.names, "spans": plane.spans, "cells": plane.cells}


def _watch(stop: Stop) -> Callable[[int, int], None]:
    """A progress callback that ends the work when it is not wanted any more, or takes too long."""
    began = time.perf_counter()

    def tell(done: int, whole: int) -> None:
        if stop():
            raise Stopped
        if time.perf_counter() - began > PATIENCE:
            took = f"{done} of {whole} cases took {PATIENCE:g} s"
            raise InputError("map", [f"{took}, which is the most that is given; zoom in, or ease the numbers"])

    return tell


# ---- the strip ----
def _strip(asked: Message, kernels: Kernels, stop: Stop) -> tuple[dict[str, Any], dict[str, Any]]:
    state, plane = asked.state, asked.plane
    assert plane is not None
    header = _axes(plane) | {"kind": "strip", "law": state.law}
    (name,), ((low, high),), (count,) = plane.names, plane.spans, plane.cells
    if not kernels.ready(state, state.law, state.robot(), False):
        return header | {"kind": "waits", "waits": _compiling(state.law, state)}, {}
    watch, kept = _watch(stop), 16
    values = np.linspace(low, high, count)
    strobes, means = np.full((count, kept), np.nan), np.full(count, np.nan)
    for i, value in enumerate(values):
        watch(i, count)
        try:
            robot = state.robot(None, **{name: float(value)})
            run = solve(robot, periods=affordable(robot, 64), rtol=RTOL, keep="trajectory")
        except StickslipError:
            continue
        last = run.strobe_v[-kept:]
        strobes[i, : len(last)], means[i] = last, _mean(run) or np.nan
    label = PARAMETERS[name].label
    return header | {"kept": kept, "label": label}, {"values": values, "strobes": strobes, "means": means}
