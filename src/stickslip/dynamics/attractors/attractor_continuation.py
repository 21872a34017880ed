"""Coexisting attractors tracked along a parameter: which there are at each value, what each becomes, and its share of the starts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.arguments import Maker, Numbers, explains_arguments
from stickslip.dynamics.attractors.basins import Attractor, grid_of, on_grid, settled_points, start_axes, told_apart, wilson
from stickslip.dynamics.attractors.bifurcation_diagrams import UNDONE, checked_values, strobe_attrs
from stickslip.dynamics.continuation.one_parameter import Family, family
from stickslip.dynamics.stroboscopic.chunked_runs import Report
from stickslip.dynamics.stroboscopic.refusals import needs_model
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, spread_over
from stickslip.errors import InputError
from stickslip.sweeps.progress import Watch

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["attractors"]

Array = Any


@dataclass
class _Track:
    """One attractor through the values: a strobe state on it, and what it was at each value where it is."""

    state: Array
    found: dict[int, Attractor]


@explains_arguments
def attractors(
    make: Maker,
    *,
    parameter: str,
    values: Numbers,
    starts: dict[str, Any] | None = None,
    settle: int = 300,
    rtol: float = 1e-7,
    workers: int = 1,
    progress: Report | None = None,
    **fixed: Any,
) -> xr.Dataset:
    """Attractors along a parameter: those reached from a grid of initial states, and continuations of those at the previous value.

    An attractor is continued by the motion that attracts its last strobe state. If this motion also continues another attractor, or if
    there is none, the attractor ends; an attractor that continues no other one is new. Shares count the grid only.

    Parameters
    ----------
    make : callable or Robot
        A function that makes a robot from keyword arguments, or a robot whose numbers have dotted names.
    parameter : str
        The keyword that varies.
    values : array
        Its values, ascending.
    starts : dict, optional
        The grid of initial states, as for `basins`: v [m/s], z [m], x [m], memory; single values or lists.
    settle : int
        Drive periods to discard.
    rtol : float
        Tolerance for dynamic laws.
    workers : int
        Threads for the starts of one value. The results do not depend on it.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with a `Progress` after each value; return False to stop. Attractors are
        then missing at the values that were not computed.
    **fixed
        The other arguments of `make`.

    Returns
    -------
    xarray.Dataset
        Over attractor (in the order in which they appear) and the parameter: mean_velocity [m/s], period (drive periods until it repeats;
        0: none up to 32, -1: absent), share of the starts with its 95 % interval share_low to share_high (Wilson), the strobe state (v, z,
        ...); over the parameter: unsolved, the number of starts that reach no attractor (-1: not computed).

    Examples
    --------
    >>> import stickslip as ss
    >>> d = ss.attractors(ss.presets.piezo_rig, parameter="mu0", values=[0.17, 0.18], starts=dict(v=[-0.01, 0.01]), settle=60,
    ...                   amplitude=6e-4, tilt_deg=1.7)
    >>> d.period.values.tolist(), d.share.values.tolist()
    ([[1, 1]], [[1.0, 1.0]])
    """
    robots = family("attractors", make, (parameter,), fixed)
    values = checked_values("attractors", values)
    needs_model("attractors", robots.robot(values[0]))
    at = coordinates(robots.robots(values))
    if "phase" in (starts or {}):
        raise InputError("attractors", ["phase is not part of the strobe state that is tracked; take ss.basins(robot, phase=...)"])
    axes = start_axes("attractors", at, starts or {}, settle, workers)
    table = grid_of(axes)
    tracks: list[_Track] = []
    lost, watch = np.full(len(values), UNDONE), Watch(len(values), progress)
    for k in range(len(values)):
        lost[k] = _at_value(robots, float(values[k]), k, table, tracks, at, settle, rtol, workers)
        watch.finished(k, np.zeros(1, int))
        if watch.stopped:
            break
    return _dataset(robots, parameter, values, tracks, lost, at, math.prod(map(len, axes.values())))


def _at_value(
    robots: Family,
    value: float,
    k: int,
    table: dict[str, Array],
    tracks: list[_Track],
    at: Coordinates,
    settle: int,
    rtol: float,
    workers: int,
) -> int:
    """Go on with the tracks at one value, and begin new ones. Returns how many starts lead nowhere."""
    model = robots.robot(value)
    first, alive = on_grid(table, model), [track for track in tracks if k - 1 in track.found]
    states = np.vstack([*(track.state[None, :] for track in alive), first])
    points, ways, good = settled_points(spread_over(model, len(states)), states, settle, rtol, workers, None)
    period, V, number = told_apart(float(model.period), points, ways, good, at, rtol)
    carried, ours = number[: len(alive)], number[len(alive) :]
    taken: set[int] = set()
    for i in _nearest_first(carried, V, alive, k):
        if carried[i] >= 0 and carried[i] not in taken:
            taken.add(int(carried[i]))
            _note(alive[i], k, int(carried[i]), number, ours, points, period, V)
    for n in sorted(set(ours[ours >= 0].tolist()) - taken, key=lambda n: -np.count_nonzero(ours == n)):
        tracks.append(_Track(first[0], {}))
        _note(tracks[-1], k, n, number, ours, points, period, V)
    return int(np.count_nonzero(ours < 0))


def _nearest_first(carried: Array, V: Array, alive: list[_Track], k: int) -> list[int]:
    """Tracks in the order in which they may claim a motion: those whose mean velocity changed least come first."""
    return sorted(range(len(carried)), key=lambda i: abs(V[i] - alive[i].found[k - 1].mean_velocity))


def _note(track: _Track, k: int, n: int, number: Array, ours: Array, points: Array, period: Array, V: Array) -> None:
    members = np.flatnonzero(number == n)
    hits = int(np.count_nonzero(ours == n))
    first, count = members[0], len(ours)
    track.state = points[first, -1]
    track.found[k] = Attractor(int(period[first]), float(np.mean(V[members])), track.state, hits / count, wilson(hits, count), None)


def _dataset(robots: Family, parameter: str, values: Array, tracks: list[_Track], lost: Array, at: Coordinates, starts: int) -> Any:
    import xarray as xr

    shape = (len(tracks), len(values))
    V, share, low, high = (np.full(shape, np.nan) for _ in range(4))
    period, state = np.full(shape, UNDONE), np.full((*shape, len(at.names)), np.nan)
    for i, track in enumerate(tracks):
        for k, a in track.found.items():
            V[i, k], period[i, k], share[i, k], (low[i, k], high[i, k]), state[i, k] = (
                a.mean_velocity,
                a.period,
                a.share,
                a.interval,
                a.state,
            )
    both = ("attractor", parameter)
    columns: dict[str, Any] = {
        "mean_velocity": (both, V, {"units": "m/s", "long_name": "mean velocity"}),
        "period": (both, period, {"units": "1", "long_name": "motion period (0: none, -1: absent)"}),
        "share": (both, share, {"units": "1", "long_name": "share of the starts"}),
        "share_low": (both, low, {"units": "1", "long_name": "share of the starts, 95 % lower bound"}),
        "share_high": (both, high, {"units": "1", "long_name": "share of the starts, 95 % upper bound"}),
        "unsolved": ((parameter,), lost, {"units": "1", "long_name": "starts that reach no attractor (-1: not computed)"}),
    }
    columns |= {name: (both, state[..., i], strobe_attrs(name)) for i, name in enumerate(at.names)}
    coords = {parameter: (parameter, values, robots.describe(parameter)), "attractor": np.arange(len(tracks))}
    return xr.Dataset(columns, coords, {"parameter": parameter, "starts": starts})
