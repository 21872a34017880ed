"""Periodic motions of Coulomb robots without their transients: strobe points by formula, one motion period from each.

For batches that ask for the steady motion only (``settle="auto"``, from rest). What the formula does not cover, such as static friction
above the sliding friction, is left to the mode machine of `exact`, whose strobe point is then looked at in the same way.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.basics.batch import some_of
from stickslip.basics.contracts import Array
from stickslip.results.summary import Summary
from stickslip.solvers import set_valued as exact
from stickslip.solvers.closed_arcs import Arcs, dimensionless_arcs
from stickslip.solvers.gather import OF_CASES
from stickslip.solvers.part_results import OF_ONE_CONTACT
from stickslip.solvers.settings import Request

TOLERANCE = 1e-13  # of 1 + |w|: how well a strobe point must come back (rounding of half a dozen arcs)
_CHUNK = 16384
_REPEATS = 1
_WAYS = ("forward_way", "backward_way")


def applies(todo: Request) -> bool:
    """Whether a request of a model with closed arcs is for the motions in which it ends from rest."""
    return todo.auto and not todo.start.any()


def _kernel() -> Any:
    from stickslip.engine.cache import load
    from stickslip.engine.texts import coulomb_orbits_text

    return load(coulomb_orbits_text(), "coulomb_orbits", "Coulomb × Harmonic, periodic motions")


def orbit_rows(
    rows: Array, known: Array | None = None, workers: int = 1, progress: Callable[[int, int], None] | None = None
) -> dict[str, Array]:
    """Periodic motions of dimensionless cases: columns r_plus, r_minus, s_plus, s_minus, gamma, w at a strobe point.

    Parameters
    ----------
    rows : array (cases, 6)
        As for `exact.solve_rows`.
    known : array (cases,) of int, optional
        Period of the motion whose strobe point stands in a row; 0 where it is to be found.
    workers : int
        Threads.
    progress : callable, optional
        Called with (cases done, cases).

    Returns
    -------
    dict of arrays
        displacement, window, v_max, v_min, margin_force, strobe_error, forward_way, backward_way, limit (displacement in a
        drive period), status (1; 2 where there is no formula), period, periods_run, seg_count, seg_time, seg_code; velocities in w,
        ways in w times radians.

    Examples
    --------
    >>> found = orbit_rows(np.array([[0.5, 1.2, 0.5, 1.2, 0.0, 0.0], [0.4, 0.5, 0.4, 0.5, 0.0, 0.0]]))
    >>> (found["displacement"] / (2 * np.pi)).round(14).tolist()
    [0.20145220333367, 0.12247535997450]
    """
    n, orbits = len(rows), _kernel()["orbits"]
    known = np.zeros(n, np.int64) if known is None else np.ascontiguousarray(known, np.int64)

    def run(first: int, last: int, *into: Array) -> None:
        orbits(rows, known, first, last, TOLERANCE, *into)

    raw = exact.shared_rows(run, n, _CHUNK, (*exact.FOUND, *_WAYS), workers, progress)
    return raw | {"limit": raw["displacement"] / np.maximum(raw["window"], 1), "wide_max": raw["v_max"], "wide_min": raw["v_min"]}


def solve(todo: Request) -> tuple[Summary, dict[str, Array]]:
    """Solve as asked; beside the summary the ways of the motion period [m] and gravity along the track [m/s^2]."""
    arcs = dimensionless_arcs(todo.model, todo.numbers_of())
    rows, driven = exact.dimensionless_rows(arcs, np.zeros(todo.cases))
    easy = driven & np.isfinite(rows).all(axis=1) & (rows[:, 2] <= rows[:, 0]) & (rows[:, 3] <= rows[:, 1]) & (rows[:, :2] > 0).all(axis=1)
    rows[~easy] = exact.AT_REST
    raw = orbit_rows(rows, None, todo.workers, todo.progress)
    hard = np.flatnonzero(~easy | (raw["status"] != _REPEATS))
    if not len(hard):  # half a dozen segments of the 32 that there is room for
        most = max(int(raw["seg_count"].max(initial=0)), 1)
        raw |= {name: np.ascontiguousarray(raw[name][:, :most]) for name in ("seg_time", "seg_code")}
    exact.scale(raw, arcs, driven)
    raw["seg_time"] = raw["seg_time"] * arcs.period[:, None]
    if len(hard):
        _wait_for(raw, hard, todo)
    return exact.summary_of(todo, raw), {**{name: raw[name] for name in _WAYS}, "along": arcs.along}


def solve_waiting(todo: Request) -> tuple[Summary, dict[str, Array]]:
    """The same period after period from the start that was asked for; beside the summary the ways [m] and v_end [m/s]."""
    raw = exact.raw_batch(todo)
    return exact.summary_of(todo, raw), {
        **ways_from(raw, dimensionless_arcs(todo.model, todo.numbers_of()), todo.workers),
        "v_end": raw["v_end"],
    }


def _wait_for(raw: dict[str, Array], hard: Array, todo: Request) -> None:
    """Solve some cases by the mode machine, period after period, and look at the motion that it ends in."""
    model = some_of(todo.model, hard)
    solved, arcs = exact.solve_batch(model, todo.periods, "auto", None, todo.workers), dimensionless_arcs(model)
    solved["seg_time"] = solved["seg_time"] * arcs.period[:, None]
    solved |= ways_from(solved, arcs, todo.workers)
    for name in (*OF_CASES, *OF_ONE_CONTACT, *_WAYS):
        raw[name][hard] = solved[name]


def ways_from(raw: dict[str, Array], arcs: Arcs, workers: int = 1) -> dict[str, Array]:
    """Distances travelled forwards and backwards in the motions that runs of `exact.solve_batch` reached [m]; NaN if they reached none."""
    rows, _ = exact.dimensionless_rows(arcs, raw["v_end"])
    settled = (raw["status"] <= _REPEATS) & (raw["period"] > 0) & np.isfinite(rows).all(axis=1) & (arcs.drive > 0)
    rows[~settled] = exact.AT_REST
    ways = orbit_rows(rows, np.where(settled, raw["period"], 0), workers)
    metres = np.where(arcs.drive > 0, arcs.drive, np.nan) / arcs.omega**2
    return {name: np.where(settled & (ways["status"] == _REPEATS), ways[name] * metres, np.nan) for name in _WAYS}
