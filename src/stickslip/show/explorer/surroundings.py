"""The surroundings of a robot: a map over two parameters, or a strip along one; cancelled when a newer request supersedes them."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.dynamics.stroboscopic.strobe_maps import at_rest, coordinates, strobe_map
from stickslip.show.explorer.effort import RTOL, effort, too_much
from stickslip.show.explorer.kernels import Kernels, compiling
from stickslip.show.explorer.requests import Message, State
from stickslip.show.explorer.sliders import PARAMETERS
from stickslip.solvers import solve

Stop = Callable[[], bool]

#: Motion types in the order of their codes on a map.
TYPES = ("rest", "presliding", "I", "II", "III", "IV", "other")
#: Time limit of a map or a strip [s].
PATIENCE = 8.0
#: Largest number of drive periods of a map; periods of a strip before its points, and number of its points.
FINE, SETTLE, KEPT = 200, 48, 16
#: Loose enough for the fast method, tight enough for four digits.


class Stopped(Exception):
    """The result is no longer needed."""


# ---- maps ----
def map_of(asked: Message, kernels: Kernels, stop: Stop) -> tuple[dict[str, Any], dict[str, Any]]:
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
        solved = solve(many, periods=FINE, settle="auto", rtol=1e-3, keep="summary", progress=watch(stop))
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
    found = np.full(np.shape(types), len(TYPES) - 1, float)
    for code, name in enumerate(TYPES):
        found[np.asarray(types) == name] = code
    return found


def watch(stop: Stop) -> Callable[[int, int], None]:
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
def strip_of(asked: Message, kernels: Kernels, stop: Stop) -> tuple[dict[str, Any], dict[str, Any]]:
    """Velocities at the start of some drive periods, and the mean velocity, along one parameter."""
    state, plane = asked.state, asked.plane
    assert plane is not None
    header = {**vars(plane), "kind": "strip", "law": state.law}
    (name,), (span,), (count,) = plane.names, plane.spans, plane.cells
    tell = watch(stop)
    if not kernels.ready(state, state.law, state.robot(), True):
        return header | {"kind": "waits", "waits": compiling(state, state.law)}, {}
    values = np.linspace(*span, count)
    strobes, means = np.full((count, KEPT), np.nan), np.full(count, np.nan)
    robots, good = _batch(state, plane.names, [values])
    strobes[good], means[good] = _strobed(robots, int(good.sum()), tell)
    return header | {"kept": KEPT, "label": PARAMETERS[name].label}, {"values": values, "strobes": strobes, "means": means}


def _strobed(robots: Any, count: int, tell: Callable[[int, int], None]) -> tuple[Any, Any]:
    """The strobed velocities and the mean velocities of robots that start from rest, solved together."""
    swings, decays = (np.broadcast_to(a, count) for a in effort(robots))
    wanted = ~too_much(swings, decays)
    stride = int(np.clip(2000 / max(swings[wanted].max(initial=0.0), 1.0), 1, 8))  # short enough for prompt cancellation
    state = np.resize(at_rest(robots), (count, len(coordinates(robots).names)))
    ways, strobes = np.zeros(count), np.full((count, KEPT), np.nan)
    periods = [stride] * (SETTLE // stride) + [1] * KEPT
    for i, step in enumerate(periods):
        tell(i, len(periods))
        ends = strobe_map(robots, state, step, RTOL)
        wanted &= np.all(np.isfinite(ends.state), axis=1)
        state = np.where(wanted[:, None], ends.state, 0.0)
        if (point := i - (len(periods) - KEPT)) >= 0:
            strobes[:, point], ways = np.where(wanted, state[:, coordinates(robots).names.index("v")], np.nan), ways + ends.displacement
    return strobes, np.where(wanted, ways / (KEPT * np.broadcast_to(robots.period, count)), np.nan)
