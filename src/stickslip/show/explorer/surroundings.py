"""The surroundings of a robot: a map over two parameters, or a strip along one; cancelled when a newer request supersedes them."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.basics.batch import some_of
from stickslip.basics.errors import InputError
from stickslip.dynamics.attractors.period_numbers import periods_of, return_tolerance
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, state_at_rest, strobe_map
from stickslip.show.explorer.effort import RTOL, effort, too_much
from stickslip.show.explorer.kernels import Kernels, compiling
from stickslip.show.explorer.requests import IsCancelled, Message, State, Stopped
from stickslip.show.explorer.sliders import PARAMETERS
from stickslip.solvers import solve

#: Motion types in the order of their codes on a map.
TYPES = ("rest", "presliding", "I", "II", "III", "IV", "other")
#: Time limit of a map or a strip [s].
PATIENCE = 8.0
#: Largest number of drive periods of a map.
FINE = 200
#: Periods of a strip before its points, number of its points, and periods after which a value that does not repeat is not run on.
SETTLE, KEPT, LIMIT = 48, 16, 256


# ---- maps ----
def map_of(asked: Message, kernels: Kernels, stop: IsCancelled) -> tuple[dict[str, Any], dict[str, Any]]:
    """Mean velocity, type, period number and fraction at rest for a grid of robots."""
    state, plane = asked.state, asked.plane
    assert plane is not None
    header = {**vars(plane), "kind": "map", "law": state.law}
    if not kernels.ready(state, state.law, state.robot(), True):
        return header | {"kind": "waits", "waits": compiling(state, state.law)}, {}
    x, y = (np.linspace(*span, n) for span, n in zip(plane.spans, plane.cells, strict=True))
    grid = [np.broadcast_to(a, (len(y), len(x))) for a in (x[None, :], y[:, None])]
    many, good = _batch(state, plane.names, grid)
    shape = grid[0].shape
    columns = {name: np.full(shape, np.nan) for name in ("mean_velocity", "motion_type", "period", "stick_fraction")}
    began = time.perf_counter()
    if many is not None:
        solved = solve(many, periods=FINE, settle="auto", rtol=1e-3, keep="summary", progress=progress_watch(stop))
        ended = np.isin(solved.status, (0, 1))
        for name in columns:
            values = _codes(solved.motion_type) if name == "motion_type" else np.asarray(solved.columns[name], float)
            columns[name][good] = np.where(ended, values, np.nan).ravel()
    return header | {"types": TYPES, "seconds": time.perf_counter() - began}, columns


def _batch(state: State, names: tuple[str, ...], grid: list[Any]) -> tuple[Any, Any]:
    """The robots of a map or a strip as one batch, and the mask of their cells; cells with invalid numbers are left out."""
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
    """Motion types as indices into `TYPES`."""
    codes = np.full(np.shape(types), len(TYPES) - 1, float)
    for code, name in enumerate(TYPES):
        codes[np.asarray(types) == name] = code
    return codes


def progress_watch(stop: IsCancelled) -> Callable[[int, int], None]:
    """A progress callback that ends the work if it is superseded or takes too long."""
    began = time.perf_counter()

    def tell(done: int, whole: int) -> None:
        if stop():
            raise Stopped
        if time.perf_counter() - began > PATIENCE:
            took = f"{100 * done // whole} % took {PATIENCE:g} s"
            raise InputError("map", [f"{took}, which is the limit; zoom in, or choose less demanding numbers"])

    return tell


# ---- the strip ----
def strip_of(asked: Message, kernels: Kernels, stop: IsCancelled) -> tuple[dict[str, Any], dict[str, Any]]:
    """Velocities at the start of some drive periods, the mean velocity, and whether they repeat, along one parameter."""
    state, plane = asked.state, asked.plane
    assert plane is not None
    header = {**vars(plane), "kind": "strip", "law": state.law}
    (name,), (span,), (count,) = plane.names, plane.spans, plane.cells
    tell = progress_watch(stop)
    if not kernels.ready(state, state.law, state.robot(), True):
        return header | {"kind": "waits", "waits": compiling(state, state.law)}, {}
    values = np.linspace(*span, count)
    robots, good = _batch(state, plane.names, [values])
    run = _Strip(robots, int(good.sum()), tell)
    run.settle()
    arrays = {"values": values}
    for key, column in (("strobes", run.strobes), ("means", run.means), ("run", run.total), ("settled", run.settled)):
        arrays[key] = np.full((count, *column.shape[1:]), np.nan)
        arrays[key][good] = column
    moving = int(np.count_nonzero(run.wanted & ~run.settled))
    limit = int(run.total.max())
    said = f"{moving} of {count} values, drawn pale, do not repeat after {limit} drive periods: not settled, or without a period"
    return header | {"kept": KEPT, "label": PARAMETERS[name].label, "said": said if moving else ""}, arrays


class _Strip:
    """Robots that start from rest and are run together until their states at the start of drive periods repeat, up to a limit.

    Attributes
    ----------
    strobes : array (robots, `KEPT`)
        Velocities at the start of the last drive periods [m/s]; NaN of what is not solved.
    means : array (robots,)
        Mean velocities over these [m/s].
    total : array (robots,)
        Drive periods that were run.
    settled : array of bool (robots,)
        Whether the states at the start of these periods repeat.
    wanted : array of bool (robots,)
        Whether a robot is solved.
    """

    def __init__(self, robots: Any, count: int, tell: Callable[[int, int], None]):
        self._robots, self._tell, self._began = robots, tell, time.perf_counter()
        self._swings, decays = (np.broadcast_to(a, count) for a in effort(robots))
        self.wanted, self._at = ~too_much(self._swings, decays), coordinates(robots)
        self._state = np.resize(state_at_rest(robots), (count, len(self._at.names)))
        self.strobes, self.means = np.full((count, KEPT), np.nan), np.full(count, np.nan)
        self.total, self.settled = np.zeros(count), np.zeros(count, bool)

    def settle(self) -> None:
        """Run all to the first look, and what does not repeat then twice as long each time, while there is time."""
        rows, periods = np.arange(len(self.total)), SETTLE
        while True:
            self._look(rows, periods)
            rows = np.flatnonzero(self.wanted & ~self.settled)
            total, spent = int(self.total.max()), time.perf_counter() - self._began
            if not len(rows) or 2 * total > LIMIT or spent > PATIENCE / 3:  # the next look takes as long again
                return
            periods = total - KEPT

    def _look(self, rows: Any, periods: int) -> None:
        """Run robots on by some drive periods, and look at the next `KEPT` ones."""
        robots, wanted, state = some_of(self._robots, rows), self.wanted[rows], self._state[rows]
        most = max(self._swings[rows][wanted].max(initial=0.0), 1.0)
        stride = int(np.clip(2000 / most, 1, 8))  # short enough for prompt cancellation
        steps, ways, points = [stride] * (periods // stride) + [1] * KEPT, np.zeros(len(rows)), []
        for i, step in enumerate(steps):
            self._tell(i, len(steps))
            ends = strobe_map(robots, state, step, RTOL)
            wanted = wanted & np.all(np.isfinite(ends.state), axis=1)
            state = np.where(wanted[:, None], ends.state, 0.0)
            if i >= len(steps) - KEPT:
                points.append(state)
                ways = ways + ends.displacement
        self.wanted[rows], self._state[rows] = wanted, state
        self.total[rows] += sum(steps)
        kept, T = np.stack(points, axis=1), np.broadcast_to(robots.period, len(rows))
        self.settled[rows] = wanted & (periods_of(kept, self._at.scales, return_tolerance(RTOL)) > 0)
        self.strobes[rows] = np.where(wanted[:, None], kept[:, :, self._at.names.index("v")], np.nan)
        self.means[rows] = np.where(wanted, ways / (KEPT * T), np.nan)
