"""Maps over two parameters: after how many drive periods a motion repeats, and its largest exponent, for every point of a grid."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.dynamics.diagrams import periods_of
from stickslip.dynamics.exponents import largest_exponents
from stickslip.dynamics.family import family
from stickslip.dynamics.mapping import coordinates, strobe_map, strobe_orbit
from stickslip.dynamics.orbits import states_of
from stickslip.errors import InputError

__all__ = ["chaos_map"]

_POINTS = 64
_CHUNK = 512


def chaos_map(
    make: Any,
    *,
    settle: int = 300,
    periods: int = 200,
    start: Any = None,
    rtol: float = 1e-8,
    progress: Callable[[int, int], None] | None = None,
    **arguments: Any,
) -> Any:
    """A map over two parameters of period number, largest Lyapunov exponent and mean velocity.

    Parameters
    ----------
    make : callable or Robot
        What makes a robot from keywords, or a robot whose numbers are named with dots.
    settle, periods : int
        Drive periods to run before looking, and to average the exponent over.
    start : dict, array or orbit, optional
        Where every case begins; rest if not given.
    rtol : float
        Tolerance for dynamic laws.
    progress : callable, optional
        Called with (cases done, cases).
    **arguments
        Arguments of `make`; exactly two of them are lists or arrays.

    Returns
    -------
    xarray.Dataset
        Over the two parameters: period (0: none up to 32), exponent and its error per drive period, mean_velocity [m/s].

    Examples
    --------
    >>> import stickslip as ss
    >>> m = ss.chaos_map(ss.presets.piezo_rig, mu0=[0.04, 0.05], amplitude=[4e-4, 6e-4], tilt_deg=1.7, settle=200, periods=40)
    >>> m.period.values.tolist(), (m.exponent > 0.1).values.tolist()  # chaos at mu0 = .05, A = 0.4 mm
    ([[1, 2], [0, 1]], [[False, False], [True, False]])
    """
    import xarray as xr

    axes = {name: np.asarray(value, float) for name, value in arguments.items() if np.ndim(value) == 1 and not isinstance(value, str)}
    if len(axes) != 2:
        raise InputError(
            "chaos_map", [f"{len(axes)} arguments have several values; allowed are exactly two, such as mu0=[...], amplitude=[...]"]
        )
    fixed = {name: value for name, value in arguments.items() if name not in axes}
    robots = family("chaos_map", make, tuple(axes), fixed)
    grid = [column.ravel() for column in np.meshgrid(*axes.values(), indexing="ij")]
    parts = []
    for i in range(0, grid[0].size, _CHUNK):
        model = robots.robots(*(column[i : i + _CHUNK] for column in grid))
        parts.append(_looked_at(model, len(grid[0][i : i + _CHUNK]), start, settle, periods, rtol))
        if progress is not None:
            progress(min(i + _CHUNK, grid[0].size), grid[0].size)
    shape = tuple(len(axis) for axis in axes.values())
    told = {
        "period": {"long_name": "drive periods until it repeats (0: none found)", "units": "1"},
        "exponent": {"long_name": "largest Lyapunov exponent per drive period", "units": "1"},
        "error": {"long_name": "standard error of the exponent", "units": "1"},
        "mean_velocity": {"long_name": "mean velocity", "units": "m/s"},
    }
    whole = [np.concatenate(column).reshape(shape) for column in zip(*parts, strict=True)]
    columns = {name: (tuple(axes), column, told[name]) for name, column in zip(told, whole, strict=True)}
    return xr.Dataset(columns, {name: (name, axis, robots.describe(name)) for name, axis in axes.items()})


def _looked_at(model: Any, cases: int, start: Any, settle: int, periods: int, rtol: float) -> tuple[Any, Any, Any, Any]:
    """Period, exponent, error and mean velocity of a batch."""
    at = coordinates(model)
    state = strobe_map(model, np.tile(states_of(start, at), (cases, 1)), settle, rtol).state
    kept, ways = strobe_orbit(model, state, _POINTS, rtol)
    period = periods_of(np.moveaxis(kept, 0, 1), at.scales, max(1e-6, 30 * rtol))
    count = np.where(period > 0, _POINTS - _POINTS % np.maximum(period, 1), _POINTS)
    way = np.where(np.arange(_POINTS)[:, None] < count, ways, 0.0).sum(axis=0)
    exponent, error = largest_exponents(model, periods, settle=0, start=kept[-1], rtol=rtol, apart=max(1e-7, 100 * rtol))
    return period, exponent, error, way / (count * np.broadcast_to(np.asarray(model.period, float), count.shape))
