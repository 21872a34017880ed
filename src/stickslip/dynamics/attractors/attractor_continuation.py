"""Coexisting attractors tracked along a parameter: which there are at each value, what each becomes, and its share of the starts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.arguments import Maker, Numbers, explains_arguments
from stickslip.dynamics.attractors.basins import Attractor, grid_of, on_grid, settled_points, start_axes, wilson
from stickslip.dynamics.attractors.bifurcation_diagrams import UNDONE, checked_values, own_attrs, strobe_attrs
from stickslip.dynamics.attractors.motion_features import Features, features_of, numbered
from stickslip.dynamics.continuation.one_parameter import Family, family
from stickslip.dynamics.stroboscopic.chunked_runs import Report
from stickslip.dynamics.stroboscopic.refusals import needs_model
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, spread_over
from stickslip.errors import InputError
from stickslip.flow import is_flow
from stickslip.sweeps.progress import Watch

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["attractors"]

Array = Any


@dataclass(eq=False)
class _Track:
    """One attractor through the values: a strobe state on it, its features, and what it was at each value where it is."""

    state: Array
    found: dict[int, Attractor]
    means: Array = ()
    became: str = ""  # to what its last state led, where it ended


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

    An attractor is continued by the motion that attracts its last strobe state. If this motion also continues another attractor, it is that
    one whose features (means of the strobe points and mean velocity) changed less, and the other ends, as it does if there is no such motion;
    an attractor that continues no other one is new. Shares count the grid only. Between values that lie far apart the last state of an
    attractor may lead elsewhere although the attractor still exists: it then ends, and another begins; take more values there.

    Parameters
    ----------
    make : callable, Robot, machine or SwitchingFlow
        A function that makes a robot from keyword arguments, or a robot whose numbers have dotted names; a flow, or a map by
        ``SwitchingFlow.of_map``, by the names of its numbers.
    parameter : str
        The keyword that varies.
    values : array
        Its values, rising.
    starts : dict, optional
        The grid of starts as `basins` takes it: v [m/s], z [m], x [m], memory; single values or lists.
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
        Over attractor (in the order in which they appear) and the parameter: mean_velocity [m/s] (not of a flow), period (drive periods until it
        repeats; 0: none up to 32, -1: it is not there), share of the starts with its 95 % interval share_low to share_high (Wilson), the
        strobe state (v, z, ...); over attractor: begins and ends, between which values it appears and vanishes, and what its last state
        leads to then; over the parameter: unsolved, the number of starts that reach no attractor (-1: not computed).

    Examples
    --------
    >>> import stickslip as ss
    >>> d = ss.attractors(ss.presets.piezo_rig, parameter="mu0", values=[0.17, 0.18], starts=dict(v=[-0.01, 0.01]), settle=60,
    ...                   amplitude=6e-4, tilt_deg=1.7)
    >>> d.period.values.tolist(), d.share.values.tolist()
    ([[1, 1]], [[1.0, 1.0]])

    A saddle-node of a map, at h = 2 ((r - 1)/3)^(3/2) = 0.136:

    >>> cubic = ss.SwitchingFlow.of_map(lambda y, n: (n.r * y[0] - y[0] ** 3 + n.h,), {"r": 1.5, "h": 0.0}, ("x",))
    >>> d = ss.attractors(cubic, parameter="h", values=[0.0, 0.13, 0.14], starts=dict(x=[-0.8, 0.8]), settle=100)
    >>> print(d.ends.values[0])
    vanishes between 0.13 and 0.14; its last state leads to attractor 1
    """
    robots = family("attractors", make, (parameter,), fixed)
    values = checked_values("attractors", values)
    first = robots.robot(values[0])
    needs_model("attractors", first, flows=True)
    at = coordinates(robots.robots(values))
    if "phase" in (starts or {}):
        raise InputError("attractors", ["phase is not part of the strobe state that is tracked; take ss.basins(robot, phase=...)"])
    axes = start_axes("attractors", at, starts or {}, settle, workers, first)
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
    motions = features_of(float(model.period), points, ways, at, rtol)
    number = numbered(motions, good > 0)
    carried, ours = number[: len(alive)], number[len(alive) :]
    taken: dict[int, _Track] = {}
    for i in _nearest_first(motions, alive):
        if carried[i] >= 0 and carried[i] not in taken:
            taken[int(carried[i])] = alive[i]
    for n in sorted(set(ours[ours >= 0].tolist()) - set(taken), key=lambda n: -np.count_nonzero(ours == n)):
        taken[n] = _Track(first[0], {})
        tracks.append(taken[n])
    for n, track in taken.items():
        _note(track, k, number == n, ours == n, points, motions)
    for track, n in zip(alive, carried.tolist(), strict=True):
        if k not in track.found:
            track.became = f"attractor {tracks.index(taken[n])}" if n >= 0 else "no attractor"
    return int(np.count_nonzero(ours < 0))


def _nearest_first(motions: Features, alive: list[_Track]) -> list[int]:
    """Tracks in the order in which they may claim a motion: those whose features changed least come first."""
    return sorted(range(len(alive)), key=lambda i: float(motions.distance(i, alive[i].means)))


def _note(track: _Track, k: int, members: Array, hit: Array, points: Array, motions: Features) -> None:
    first, hits, count = int(np.flatnonzero(members)[0]), int(np.count_nonzero(hit)), len(hit)
    V = float(np.mean(motions.mean_velocity[members]))
    track.state, track.means = points[first, -1], motions.means[first]
    track.found[k] = Attractor(int(motions.period[first]), V, track.state, hits / count, wilson(hits, count), None)


def _begins(track: _Track, values: Array) -> str:
    """Between which values an attractor appears."""
    k = min(track.found)
    return f"appears between {values[k - 1]:.9g} and {values[k]:.9g}" if k else "is there at the first value"


def _ends(track: _Track, values: Array) -> str:
    """Between which values an attractor vanishes, and what becomes of a motion on it."""
    k = max(track.found)
    if not track.became:
        return "is there at the last value" if k == len(values) - 1 else "is there at the last value that was computed"
    return f"vanishes between {values[k]:.9g} and {values[k + 1]:.9g}; its last state leads to {track.became}"


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
    flow = is_flow(robots.robot(values[0]))
    columns: dict[str, Any] = {} if flow else {"mean_velocity": (both, V, {"units": "m/s", "long_name": "mean velocity"})}
    columns |= {
        "period": (both, period, {"units": "1", "long_name": "motion period (0: none, -1: not there)"}),
        "share": (both, share, {"units": "1", "long_name": "share of the starts"}),
        "share_low": (both, low, {"units": "1", "long_name": "share of the starts, 95 % lower bound"}),
        "share_high": (both, high, {"units": "1", "long_name": "share of the starts, 95 % upper bound"}),
        "unsolved": ((parameter,), lost, {"units": "1", "long_name": "starts that lead nowhere (-1: not computed)"}),
    }
    for name, told in (("begins", _begins), ("ends", _ends)):
        texts = np.array([told(track, values) for track in tracks], dtype=str)
        columns[name] = (("attractor",), texts, {"long_name": f"where the attractor {name}"})
    columns |= {
        name: (both, state[..., i], own_attrs(name, "on the strobe") if flow else strobe_attrs(name)) for i, name in enumerate(at.names)
    }
    coords = {parameter: (parameter, values, robots.describe(parameter)), "attractor": np.arange(len(tracks))}
    return xr.Dataset(columns, coords, {"parameter": parameter, "starts": starts})
