"""Bifurcation diagrams by brute force: what a robot does after settling, at every value of a parameter, upwards and downwards."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.dynamics.family import Family, family
from stickslip.dynamics.mapping import coordinates, strobe_map, strobe_orbit
from stickslip.dynamics.orbits import states_of
from stickslip.errors import Problems

__all__ = ["bifurcation"]

Array = Any
DIRECTIONS = ("up", "down")
_RETURN = 1e-6  # strobe points closer than this, in scales, count as one


def bifurcation(
    make: Any,
    *,
    parameter: str,
    values: Any,
    settle: int = 200,
    points: int = 64,
    follow: bool = True,
    start: Any = None,
    rtol: float = 1e-7,
    progress: Callable[[int, int], None] | None = None,
    **fixed: Any,
) -> Any:
    """A bifurcation diagram by brute force: the strobe points after settling, for every value of a parameter.

    Parameters
    ----------
    make : callable or Robot
        What makes a robot from keywords, or a robot whose numbers are named with dots.
    parameter : str
        The keyword that varies.
    values : array
        Its values, rising.
    settle, points : int
        Drive periods that are left out, and that are kept.
    follow : bool
        True: go up through the values, each case beginning where the last one ended, and down again, so that hysteresis shows. False:
        every case begins at `start` and all run in one batch, which is much faster.
    start : dict, array or orbit, optional
        Where to begin; rest if not given.
    rtol : float
        Tolerance for dynamic laws.
    progress : callable, optional
        Called with (values done, values).
    **fixed
        The other arguments of `make`.

    Returns
    -------
    xarray.Dataset
        Over direction ("up", "down"), the parameter and point: the strobe state (v, z, ...), displacement in each period [m]; over
        direction and parameter: mean_velocity [m/s], period (0: none up to 32), v_max, v_min [m/s] of the last period.

    Examples
    --------
    >>> import stickslip as ss
    >>> d = ss.bifurcation(ss.presets.piezo_rig, parameter="mu0", values=[0.04, 0.05], settle=100, points=32, follow=False,
    ...                    amplitude=6e-4, tilt_deg=1.7)
    >>> d.period.values.tolist()
    [[2, 1]]
    """
    robots = family("bifurcation", make, (parameter,), fixed)
    values = _check(values, settle, points)
    at = coordinates(robots.robots(values))
    first = states_of(start, at)
    if follow:
        found = _hysteresis(robots, values, first, settle, points, rtol, progress)
    else:
        found = [np.expand_dims(part, 0) for part in _batch(robots, values, np.tile(first, (len(values), 1)), settle, points, rtol)]
        if progress is not None:
            progress(len(values), len(values))
    return _dataset(robots, parameter, values, at, found, DIRECTIONS if follow else ("from start",), settle)


def _check(values: Any, settle: Any, points: Any) -> Array:
    problems = Problems("bifurcation")
    try:
        array = np.asarray(values, float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.ndim != 1 or len(array) < 2 or not np.all(np.isfinite(array)) or not np.all(np.diff(array) > 0):
        problems.add(f"values = {values!r}; allowed are two or more rising finite numbers; type values=np.linspace(0.03, 0.06, 300)")
    for name, value, least in (("settle", settle, 1), ("points", points, 2)):
        if not isinstance(value, (int, np.integer)) or isinstance(value, bool) or value < least:
            problems.add(f"{name} = {value!r}; allowed is a whole number from {least}")
    problems.check()
    return array


def _batch(robots: Family, values: Array, states: Array, settle: int, points: int, rtol: float) -> list[Array]:
    """States (values, points, d), displacements (values, points), v_max and v_min (values, 1) of cases that run side by side."""
    model = robots.robots(values)
    state = strobe_map(model, states, settle, rtol).state
    kept, ways = strobe_orbit(model, state, points, rtol)
    last = strobe_map(model, kept[-1], 1, rtol)
    return [np.moveaxis(kept, 0, 1), ways.T, last.v_max[:, None], last.v_min[:, None]]


def _hysteresis(robots: Family, values: Array, first: Array, settle: int, points: int, rtol: float, progress: Any) -> list[Array]:
    """Upwards and downwards side by side, each value from the end of the one before."""
    n, states = len(values), np.tile(first, (2, 1))
    rows: list[list[Array]] = []
    for k in range(n):
        found = _batch(robots, values[[k, n - 1 - k]], states, settle, points, rtol)
        states = np.where(np.isfinite(found[0][:, -1]), found[0][:, -1], first)
        rows.append(found)
        if progress is not None:
            progress(k + 1, n)
    whole = [np.stack([row[i] for row in rows], axis=1) for i in range(4)]
    return [np.stack([part[0], part[1, ::-1]]) for part in whole]


def periods_of(points: Array, scales: Array, tolerance: float = _RETURN) -> Array:
    """Period numbers of strobe points (..., points, d): the smallest after which all come back; 0 if none up to 32."""
    found = np.zeros(points.shape[:-2], int)
    for p in range(min(32, points.shape[-2] // 2), 0, -1):
        miss = np.max(abs(points[..., p:, :] - points[..., :-p, :]) / scales, axis=(-1, -2))
        found = np.where(miss <= tolerance, p, found)
    return found


def _dataset(robots: Family, parameter: str, values: Array, at: Any, found: list[Array], directions: tuple[str, ...], settle: int) -> Any:
    import xarray as xr

    points, ways, v_max, v_min = found
    whole, flat = ("direction", parameter, "point"), ("direction", parameter)
    T = np.asarray(robots.robots(values).period, float)
    period = periods_of(points, at.scales)
    count = points.shape[2]
    lengths = np.where(period > 0, count - count % np.maximum(period, 1), count)
    steady = np.where(np.arange(count) < lengths[..., None], ways, 0.0).sum(axis=-1) / (lengths * T)
    columns: dict[str, Any] = {name: (whole, points[..., i], _UNITS.get(name, {"units": "m"})) for i, name in enumerate(at.names)}
    columns |= {
        "displacement": (whole, ways, {"units": "m", "long_name": "displacement in a drive period"}),
        "mean_velocity": (flat, steady, {"units": "m/s", "long_name": "mean velocity"}),
        "period": (flat, period, {"units": "1", "long_name": "drive periods until it repeats (0: none found)"}),
        "v_max": (flat, v_max[..., 0], {"units": "m/s", "long_name": "largest velocity"}),
        "v_min": (flat, v_min[..., 0], {"units": "m/s", "long_name": "smallest velocity"}),
    }
    coords = {parameter: (parameter, values, robots.describe(parameter)), "direction": list(directions)}
    return xr.Dataset(columns, coords, {"parameter": parameter, "settle": settle})


_UNITS = {"v": {"units": "m/s", "long_name": "velocity on the strobe"}, "x": {"units": "m", "long_name": "position on the strobe"}}
