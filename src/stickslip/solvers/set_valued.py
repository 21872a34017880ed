"""Exact stick-slip of set-valued laws. Coulomb friction under a harmonic drive has closed arcs; all else goes by Taylor steps.

Nothing is regularised: the body sticks, slides forwards or slides backwards, each arc is a closed formula, and only the
instants at which the velocity comes to zero are searched. The kernel works with w = v omega / a and the phase omega t.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.basics.batch import labels_of, spread_over_cases
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import SolveError
from stickslip.basics.interruption import is_stopped, look, takes_some_cases
from stickslip.basics.pool import handed_out
from stickslip.basics.status import Status
from stickslip.engine.kernels.columns import SEGS as SEGMENTS
from stickslip.models.mechanics import rest_velocity
from stickslip.results.dense_output import HarmonicArcs
from stickslip.results.summary import Summary
from stickslip.results.trajectory import Trajectory
from stickslip.solvers import undriven
from stickslip.solvers.closed_arcs import Arcs, dimensionless_arcs
from stickslip.solvers.gather import OF_CASES, RawResults, gather, trajectory
from stickslip.solvers.part_results import parts_of_one
from stickslip.solvers.settings import Request

Progress = Callable[[int, int], None]  # cases done, cases

REPEAT = 1e-8  # of 1 + |w|: strobe points this close count as the same point
TINY = 1e-100  # a drive this small beside the resistance is no drive
_SLICE = 0.05  # seconds between looks at the keyboard
_COST = 3e-7  # seconds per drive period and case, generous
_ROOM = 1 << 16  # arcs recorded in one slice
_COLUMNS = ("r_plus", "r_minus", "s_plus", "s_minus", "gamma", "w")
#: What a kernel finds of each case, by name; those that are lengths, and those that are velocities.
FOUND = ("displacement", "window", "v_max", "v_min", "margin_force", "strobe_error")
_LENGTHS = ("displacement", "x_end", "limit", "forward_way", "backward_way")
_VELOCITIES = ("v_max", "v_min", "v_end", "strobe_error", "wide_max", "wide_min")
#: A row of a body at rest, in place of one that a kernel cannot take.
AT_REST = (2.0, 2.0, 2.0, 2.0, 0.0, 0.0)


def solve(todo: Request) -> Trajectory | Summary:
    """Solve as asked."""
    if todo.keep == "trajectory":
        arcs, counts = solve_one(todo.model, todo.periods, _start_of(todo), todo.progress, todo.partial, todo.numbers_of())
        whole = arcs.t[-1] == todo.periods * float(todo.span[0])
        return trajectory(todo, "exact", arcs, counts, Status.FINISHED if whole else Status.NOT_COMPUTED)
    return summary_of(todo, raw_batch(todo))


def _start_of(todo: Request) -> dict[str, Any]:
    return dict(x=todo.start[:, 0].reshape(todo.labels.shape), v=todo.start[:, 1].reshape(todo.labels.shape))


def raw_batch(todo: Request) -> dict[str, Array]:
    """The raw results of `solve_batch` as asked, times in seconds."""
    arcs, settle = dimensionless_arcs(todo.model, todo.numbers_of()), "auto" if todo.auto else todo.settle
    raw = solve_batch(todo.model, todo.periods, settle, _start_of(todo), todo.workers, todo.progress, arcs)
    raw["seg_time"] = raw["seg_time"] * arcs.period[:, None]
    return raw


def summary_of(todo: Request, raw: dict[str, Any]) -> Summary:
    """A summary from raw results."""
    parts = parts_of_one(raw, spread_over_cases(rest_velocity(todo.model), todo.labels), todo.span)
    return gather(todo, "exact", [((0, todo.cases), RawResults(**{name: raw[name] for name in OF_CASES}, parts=parts))], 1)


def _kernel() -> Any:
    from stickslip.engine.cache import load
    from stickslip.engine.texts import coulomb_runs_text

    return load(coulomb_runs_text(), "coulomb_harmonic", "Coulomb × Harmonic")


def dimensionless_rows(arcs: Arcs, v0: Array) -> tuple[Array, Array]:
    """Dimensionless rows of the kernel, and which cases have a drive to measure against."""
    rows = np.empty((len(arcs.drive), len(_COLUMNS)))
    columns = arcs.resist_plus, arcs.resist_minus, arcs.hold_plus, arcs.hold_minus, arcs.along, v0 * arcs.omega
    for k, column in enumerate(columns):
        rows[:, k] = column
    driven = arcs.drive > TINY * np.max(abs(rows[:, [0, 1, 2, 3, 5]]), axis=1)
    return rows / np.where(driven, arcs.drive, 1.0)[:, None], driven


def solve_rows(
    rows: Array,
    periods: int,
    settle: int | str,
    workers: int = 1,
    progress: Progress | None = None,
    skip: bool = True,
    tolerance: float = REPEAT,
) -> dict[str, Array]:
    """Run dimensionless cases: columns r_plus, r_minus, s_plus, s_minus, gamma (gravity along the track), w at the start.

    Returns the raw results of `solve_batch` in units of the kernel: w for velocities, w times radians for displacements.
    With ``skip=False`` every period is run, also after the strobe point has come back to the last bit.
    """
    n, auto, run_rows = len(rows), settle == "auto", _kernel()["run"]
    size = max(1, min(int(_SLICE / (_COST * periods)) + 1, -(-n // (8 * workers if workers > 1 else 1))))

    def run(first: int, last: int, *into: Array) -> None:
        run_rows(rows, first, last, periods, 0 if auto else int(settle), auto, skip, tolerance, *into)

    return shared_rows(run, n, size, (*FOUND, "x_end", "v_end", "limit", "wide_max", "wide_min"), workers, progress)


def shared_rows(
    run: Callable[..., None], cases: int, size: int, names: tuple[str, ...], workers: int, progress: Progress | None
) -> dict[str, Array]:
    """Results of a kernel for cases that threads share, `size` at a time: numbers by name, statuses, segments.

    `run` takes the first case, the one after the last, and the arrays to be filled in. After an interruption the statuses of cases that
    were not begun are "not computed", where that is allowed (`takes_some_cases`).
    """
    out, count = np.full((cases, len(names)), np.nan), np.zeros((cases, 4), np.int64)
    count[:, 0] = Status.NOT_COMPUTED
    seg_time, seg_code = np.zeros((cases, SEGMENTS)), np.zeros((cases, SEGMENTS), np.int8)

    partial = takes_some_cases()

    def part(first: int) -> int:
        if partial and is_stopped():
            return 0
        last = min(first + size, cases)
        run(first, last, out, count, seg_time, seg_code)
        return last - first

    done = 0
    for _, finished in handed_out(part, range(0, cases, size), workers, all_parts=partial):
        done += finished
        if progress is not None and finished:
            progress(done, cases)
    raw: dict[str, Array] = {name: out[:, k] for k, name in enumerate(names)}
    raw |= {name: count[:, k] for k, name in enumerate(("status", "period", "periods_run", "seg_count"))}
    return {**raw, "seg_time": seg_time, "seg_code": seg_code}


def scale(raw: dict[str, Array], arcs: Arcs, driven: Array) -> None:
    """Take lengths and velocities from the units of a kernel to metres and seconds."""
    a = np.where(driven, arcs.drive, 1.0)
    for names, units in ((_LENGTHS, a / arcs.omega**2), (_VELOCITIES, a / arcs.omega)):
        for name in raw.keys() & names:
            raw[name] = raw[name] * units


def solve_batch(
    model: Model,
    periods: int,
    settle: int | str,
    start: dict[str, Any] | None = None,
    workers: int = 1,
    progress: Progress | None = None,
    arcs: Arcs | None = None,
) -> dict[str, Array]:
    """Run every case of a batch without keeping trajectories.

    Parameters
    ----------
    model : Robot
        A model that `stickslip.solvers.closed_arcs.handles` takes.
    periods : int
        Drive periods to run; with ``settle="auto"`` the largest number of them.
    settle : int or "auto"
        Periods left out of the window; "auto" stops at the repeated strobe point, and the window is the last motion period.
    start : dict
        Position x [m] and velocity v [m/s] at t = 0, numbers or arrays that broadcast to the batch.
    workers : int
        Threads.
    progress : callable
        Called with (cases done, cases).
    arcs : Arcs, optional
        The numbers of its arcs, where they are at hand.

    Returns
    -------
    dict of arrays, one entry (or row) for each case in C order
        displacement over the window [m], window (its drive periods: whole motion periods where a period was found), v_max and v_min
        of the last motion period [m/s], margin_force, strobe_error (estimated distance of the last strobe point from the periodic
        motion [m/s]), x_end and v_end, limit (displacement in a drive period that the motion
        approaches [m], see `stickslip.results.recurrence`), wide_max and wide_min (extremes over the window), status, period (0: none),
        periods_run, seg_count, seg_time (cases, 32),
        seg_code (cases, 32).

    Examples
    --------
    >>> import stickslip as ss
    >>> raw = solve_batch(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[5.56e-4, 8e-4], law="coulomb-static"), periods=200, settle=100)
    >>> (raw["displacement"] / (raw["window"] * 2 / 65.4)).round(9).tolist()  # mean velocity
    [0.002032039, 0.004308808]
    """
    arcs = dimensionless_arcs(model) if arcs is None else arcs
    x0, v0 = _start(labels_of(model).shape, start)
    rows, driven = dimensionless_rows(arcs, v0)
    good = np.isfinite(rows).all(axis=1)
    rows[~(good & driven)] = AT_REST
    raw = solve_rows(rows, periods, settle, workers, progress)
    scale(raw, arcs, driven)
    for i in np.flatnonzero(good & ~driven):
        undriven.fill_case(raw, int(i), arcs, v0[i], periods, settle)
    raw["x_end"] = raw["x_end"] + x0
    for name in raw.keys() & (*_LENGTHS, *_VELOCITIES, "margin_force"):
        raw[name][~good] = np.nan
    raw["status"][~good], raw["seg_count"][~good], raw["period"][~good] = 5, 0, 0
    return raw


def _start(shape: tuple[int, ...], start: dict[str, Any] | None) -> tuple[Array, Array]:
    """x and v at t = 0 of every case."""
    x, v = (np.full(shape, (start or {}).get(name, 0.0), float).ravel() + 0.0 for name in "xv")  # minus zero is zero
    return x, v


def solve_one(
    model: Model, periods: int, start: dict[str, Any] | None = None, progress: Progress | None = None, partial: bool = False,
    known: dict[str, Any] | None = None,
) -> tuple[HarmonicArcs, dict[str, int]]:  # fmt: skip
    """Run one case and keep every arc.

    Parameters
    ----------
    model : Robot
        A single case that `stickslip.solvers.closed_arcs.handles` takes.
    periods : int
        Drive periods to run.
    start : dict
        Position x [m] and velocity v [m/s] at t = 0.
    progress : callable, optional
        Called with (periods done, periods).
    partial : bool
        Whether an interruption ends it with the periods that are done.
    known : dict, optional
        The model's numbers by name, where they are at hand.

    Returns
    -------
    arcs : HarmonicArcs
        The dense output. Arcs also end at every whole drive period.
    counts : dict
        arcs, and switches of the mode.

    Examples
    --------
    >>> import stickslip as ss
    >>> arcs, counts = solve_one(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static"), periods=2)
    >>> arcs.mode[:, 0].tolist(), counts
    ([0, 1, 0, -1, -1, 0, 1, 0, -1], {'arcs': 9, 'switches': 7})
    """
    numbers = dimensionless_arcs(model, known)
    x0, v0 = (float((start or {}).get(name, 0.0)) + 0.0 for name in "xv")  # minus zero is zero
    rows, driven = dimensionless_rows(numbers, np.array([v0]))
    if not np.isfinite(rows).all():
        raise SolveError(
            f"the numbers of this case are not all finite: {dict(zip(_COLUMNS, rows[0].tolist(), strict=True))}; check the law's numbers"
        )
    a, omega, T = (float(n[0]) for n in (numbers.drive, numbers.omega, numbers.period))
    if driven[0]:
        (number, (phase, x, v), mode), periods = _recorded(rows[0], periods, progress, partial)
        t = np.minimum(number * T + phase / omega, (number + 1) * T)
        x, v = x * (a / omega**2), v * (a / omega)
    else:
        t, x, v, mode = undriven.arcs_of(numbers, 0, v0, periods * T)
    ends = np.concatenate([t, [periods * T]])
    keep = ends[1:] > t
    if not keep.all():
        ends, mode, x, v = ends[np.concatenate([keep, [True]])], mode[keep], x[keep], v[keep]
    mode = mode.astype(np.int8)
    arcs = HarmonicArcs(
        t=ends, mode=mode, x0=x + x0, v0=v, drive_acceleration=a, omega=omega,
        resist_plus=float(numbers.resist_plus[0]), resist_minus=float(numbers.resist_minus[0]),
    )  # fmt: skip
    return arcs, {"arcs": len(mode), "switches": int(np.count_nonzero(mode[1:] != mode[:-1]))}


def _recorded(row: Array, periods: int, progress: Progress | None = None, partial: bool = False) -> tuple[tuple[Array, Array, Array], int]:
    """Drive period, (phase, displacement, w) and mode of all arcs; and the drive periods that are done."""
    record, state, n, recorded = _kernel()["record"], np.array([row[5], 0.0, 0.0, -1.0, -1.0]), 0, []
    while n < periods:
        number, arcs, mode = np.empty(_ROOM, np.int64), np.empty((_ROOM, 3)), np.empty(_ROOM, np.int64)
        count, n = record(row, state, n, periods, number, arcs, mode)
        if count < 0:
            raise SolveError(
                f"period {n} has too many arcs; this is a bug of the exact solver: please report it with the robot's to_toml()"
            )
        recorded.append((number[:count].copy(), arcs[:count].copy(), mode[:count].astype(np.int8)))
        if progress is not None:
            progress(n, periods)
        if not partial:
            look()
        elif is_stopped():
            break
    numbers, arcs, modes = recorded[0] if len(recorded) == 1 else (np.concatenate(part) for part in zip(*recorded, strict=True))
    return (numbers, arcs.T, modes), n
