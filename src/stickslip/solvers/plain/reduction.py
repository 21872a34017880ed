"""From the dense output of one case to its row of a summary, with results of each body, contact and stop where parts have names."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.models.forces import slip_ratio
from stickslip.models.machine_adapter import machine_of
from stickslip.results.pieces import DensePieces
from stickslip.results.steadiness import outcome_of, repetition_of, window_count
from stickslip.results.trajectory import Trajectory
from stickslip.solvers import strobes
from stickslip.solvers.part_results import RawParts
from stickslip.solvers.settings import Request


def reduced(todo: Request, model: Model, pieces: DensePieces, case: int) -> dict[str, Any]:
    """Raw results of one case."""
    T = float(todo.span[case])
    run = Trajectory(model, pieces, todo.periods, todo.settle, todo.rtol, todo.method)
    if machine_of(model).one_body is None:
        return _of_parts(todo, run.with_axes)
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


def _of_parts(todo: Request, run: Trajectory) -> dict[str, Any]:
    """Raw results of one case; what is of bodies, contacts and stops is sampled over the last motion period."""
    way, period, limit = (np.zeros(2), 0, np.nan) if run.model.period is None else repetition_of(run)
    settle = todo.periods - period if todo.auto and period else todo.settle
    if run.model.period is None:
        x = run.at(run.pieces.t[[0, -1]])["x"]
        results = {**strobes.NOTHING, "displacement": run.steadiness.mean_velocity * float(np.ptp(run.pieces.t[[0, -1]])), "window": 1.0}
    else:
        x = run.strobe_x
        results = {**strobes.NOTHING, **strobes.over_window(way, settle, period, limit)}
    count = window_count(len(x) - 1, settle, period)
    parts = _results_of_parts(todo, run, period or 1, x[-1] - x[-1 - count])
    return {**results, "status": 0, "periods_run": todo.periods, "parts": parts}


def _results_of_parts(todo: Request, run: Trajectory, periods: int, displacement: Array) -> RawParts:
    """Results of the parts over the last drive periods."""
    end, T = float(run.pieces.t[-1]), float(todo.span[0] if run.model.period is None else run.model.period)
    t, span = strobes.strobe_samples(end, periods, T), periods * T
    at, machine = run.at(t), machine_of(run.model)
    v, slip, step = at["v"], at["slip"], span / len(t)
    segments = [strobes.segments_of(np.full(len(t), step), codes) for codes in _codes(todo, run, at).T]
    number, time, code = (np.array([each[k] for each in segments])[None] for k in range(3))
    hits, pressed = _hits(run, end - span), _pressed(run, at)
    stops = [name for name, _ in machine.mechanics.named_stops]
    return RawParts(
        displacement=displacement[None], v_max=v.max(axis=0)[None], v_min=v.min(axis=0)[None], wide_max=v.max(axis=0)[None],
        wide_min=v.min(axis=0)[None], slip_max=slip.max(axis=0)[None], slip_min=slip.min(axis=0)[None],
        slipped=slip.sum(axis=0)[None] * step, friction_work=(at["friction_force"] * slip).sum(axis=0)[None] * step,
        seg_count=number, seg_time=time, seg_code=code, margin_force=np.nan,
        hits=np.array([[(hits | pressed)[name][0] for name in stops]], float),
        impulse_max=np.array([[hits[name][1] if name in hits else np.nan for name in stops]]),
        stop_force_max=np.array([[pressed[name][1] if name in pressed else np.nan for name in stops]]),
    )  # fmt: skip


def _codes(todo: Request, run: Trajectory, at: dict[str, Array]) -> Array:
    """The mode of each contact at sampled instants (see `stickslip.results.segments`)."""
    mode, slip, load = at["mode"].astype(int), at["slip"], at["load"]
    codes = 2 * mode
    for i, law in enumerate(machine_of(run.model).laws):
        if law.has_slip_ratio:
            layout = run.pieces.layout.contacts[i]
            memory = tuple(run.pieces.memory[run._index(at["t"])][:, list(layout.memory)].T)
            z = np.asarray(at["z"]).reshape(len(mode), len(mode[0]), -1)[:, i, : law.states]
            ratio = slip_ratio(law, machine_of(run.model).velocity_scale, mode[:, i], slip[:, i], load[:, i], z.T, memory)
            codes[:, i] = mode[:, i] * np.where(ratio >= todo.slip_ratio, 2, 1)
    return codes


def _hits(run: Trajectory, since: float) -> dict[str, tuple[int, float]]:
    """By name of a stop with restitution how often it was hit, and the greatest impulse [N s]."""
    mechanics = machine_of(run.model).mechanics
    speeds: dict[str, list[float]] = {name: [] for name, stop in mechanics.named_stops if stop.part.restitution is not None}
    for event in run.events:
        if event.kind == "hit" and event.t > since and event.velocity is not None:
            speeds[event.part].append(-event.velocity)
    hits = {}
    for name, stop in mechanics.named_stops:
        if name in speeds:
            inverse = sum(h * h / float(m) for h, m in zip(stop.direction, mechanics.masses, strict=True))
            hits[name] = len(speeds[name]), (1 + float(stop.part.restitution)) * max(speeds[name], default=0.0) / inverse
    return hits


def _pressed(run: Trajectory, at: dict[str, Array]) -> dict[str, tuple[int, float]]:
    """By name of an elastic stop how often it begins to be pressed, and the greatest force [N], at sampled instants."""
    mechanics: Any = machine_of(run.model).mechanics
    pressed = {}
    x, v = (tuple(np.asarray(at[name]).T) for name in ("x", "v"))
    for name, stop in mechanics.named_stops:
        if stop.part.restitution is None:
            distance, rate = mechanics.distance(stop.ends, x), mechanics.distance(stop.ends, v)
            touching = stop.part.gap_left(distance, at["t"]) < 0.0
            begun = int(np.sum(touching & ~np.roll(touching, 1)))
            pressed[name] = begun, float(np.max(abs(stop.part.force(distance, rate, at["t"]))))
    return pressed
