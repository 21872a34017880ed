"""From the dense output of one case to its row of a summary, with results of each body, contact and stop where parts have names."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.models.forces import slip_ratio
from stickslip.models.machine_adapter import machine_of
from stickslip.results.pieces import DensePieces
from stickslip.results.steadiness import repetition_of, way_of_machine
from stickslip.results.trajectory import Trajectory
from stickslip.solvers import strobes
from stickslip.solvers.part_results import RawParts
from stickslip.solvers.plain.step_extremes import over_steps, points
from stickslip.solvers.settings import Request

_AT_ONCE = 1 << 17  # velocities, each at several points
_SAME = 1e-12  # of a window: how well its beginning is known


def reduced(todo: Request, model: Model, pieces: DensePieces, case: int) -> dict[str, Any]:
    """Raw results of one case; what is of bodies, contacts and stops is sampled over the last motion period."""
    T = float(todo.span[case])
    run = Trajectory(model, pieces, todo.periods, todo.settle, todo.rtol, todo.method).with_axes
    if model.period is None:
        x, period, limit = run._states_at(run.pieces.t[[0, -1]], np.array([0, len(run.pieces.mode) - 1]))[0], 0, np.nan
        way = way_of_machine(model, x)
    else:
        x, (way, period, limit) = run.strobe_x, repetition_of(run)
    settle = todo.periods - period if todo.auto and period else todo.settle
    results = strobes.over_window(way, settle, period, limit)
    moved = x[-1] - x[-1 - int(results["window"])]
    parts = _results_of_parts(todo, run, (period or 1, T), moved, T * results["window"])
    return {**results, "status": 0, "periods_run": todo.periods, "parts": parts}


def _results_of_parts(todo: Request, run: Trajectory, last: tuple[int, float], displacement: Array, window: float) -> RawParts:
    """Results of the parts over the last drive periods, of which `last` is their number and length; extremes also over the window."""
    periods, T = last
    end, machine = float(run.pieces.t[-1]), machine_of(run.model)
    t, span = strobes.strobe_samples(end, periods, T), periods * T
    at, step = run.at(t), span / len(t)
    v, slip = at["v"], at["slip"]
    segments = [strobes.segments_of(np.full(len(t), step), codes) for codes in _codes(todo, run, at).T]
    number, time, code = (np.array([each[k] for each in segments])[None] for k in range(3))
    low, high = _over_window(run, window, v.min(axis=0), v.max(axis=0))
    hits, pressed = _hits(run, end - span), _pressed(run, at)
    stops = [name for name, _ in machine.mechanics.named_stops]
    return RawParts(
        displacement=displacement[None], v_max=v.max(axis=0)[None], v_min=v.min(axis=0)[None], wide_max=high[None],
        wide_min=low[None], slip_max=slip.max(axis=0)[None], slip_min=slip.min(axis=0)[None],
        slipped=slip.sum(axis=0)[None] * step, slipped_over=np.array([periods]),
        friction_power=(at["friction_force"] * slip).sum(axis=0)[None] * step / span,
        seg_count=number, seg_time=time, seg_code=code, margin_force=strobes.margin_forces(machine)[None],
        hits=np.array([[(hits | pressed)[name][0] for name in stops]], float),
        impulse_max=np.array([[hits[name][1] if name in hits else np.nan for name in stops]]),
        stop_force_max=np.array([[pressed[name][1] if name in pressed else np.nan for name in stops]]),
    )  # fmt: skip


def _over_window(run: Trajectory, window: float, low: Array, high: Array) -> tuple[Array, Array]:
    """The least and the largest velocity of each body in the window, to its last instant, or what is known if that is more."""
    t = run.pieces.t
    begin = t[-1] - window
    index = np.flatnonzero(t[1:] > t[-1] - window * (1.0 - _SAME))
    for some in np.array_split(index, 1 + len(index) * len(run.pieces.layout.bodies) // _AT_ONCE):
        at = points(np.maximum(t[some], begin)[:, None], t[some + 1][:, None])
        v = run._states_at(at.ravel(), np.repeat(some, at.shape[1]))[1]
        low, high = over_steps(v.reshape(*at.shape, -1).transpose(0, 2, 1), low, high)
    return low, high


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
