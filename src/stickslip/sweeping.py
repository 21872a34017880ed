"""Many solves over a grid of keywords, as one labelled dataset."""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable, Sequence
from itertools import product
from typing import Any

import numpy as np

from stickslip.errors import InputError, Problems, did_you_mean
from stickslip.fields import leaves, replace_leaf
from stickslip.robot import Robot
from stickslip.solvers import solve

__all__ = ["AXES", "sweep"]

#: What the axes of a sweep are called on a plot, and their units: by the last part of a dotted name.
AXES: dict[str, tuple[str, str]] = {
    "amplitude": ("amplitude of the inner mass A", "m"),
    "omega": ("angular frequency ω", "rad/s"),
    "frequency": ("frequency", "Hz"),
    "voltage": ("voltage on the patches", "V"),
    "length": ("length of the beam L", "m"),
    "thickness": ("thickness of the beam h1", "m"),
    "patch_length": ("length of the patches l0", "m"),
    "tip_mass": ("tip mass m", "kg"),
    "damping": ("damping ratio of the beam ζ", "1"),
    "tilt_deg": ("tilt of the track θ", "degrees"),
    "tilt": ("tilt of the track θ", "rad"),
    "mu0": ("kinetic friction coefficient μ0", "1"),
    "f0": ("static friction coefficient f0", "1"),
    "mu_plus": ("kinetic friction coefficient forwards μ+", "1"),
    "mu_minus": ("kinetic friction coefficient backwards μ-", "1"),
    "f_plus": ("static friction coefficient forwards f+", "1"),
    "f_minus": ("static friction coefficient backwards f-", "1"),
    "sigma0": ("bristle stiffness σ0", "N/m"),
    "sigma1": ("bristle damping σ1", "N s/m"),
    "sigma2": ("viscous friction σ2", "N s/m"),
    "v_s": ("Stribeck velocity v_s", "m/s"),
    "body_mass": ("mass of the body M", "kg"),
    "inner_mass": ("inner mass m", "kg"),
    "gravity": ("acceleration of gravity g", "m/s^2"),
}


def sweep(
    make: Callable[..., Robot] | Robot,
    *,
    periods: int = 200,
    settle: int | str | None = "auto",
    rtol: float = 1e-6,
    workers: int = 1,
    start: dict[str, Any] | None = None,
    method: str = "auto",
    slip_ratio: float = 0.75,
    dwell: float = 0.03,
    progress: Callable[[int, int], None] | None = None,
    **axes: Any,
) -> Any:
    """Solve a robot over a grid of its numbers.

    Every keyword that holds several values becomes a dimension of that name, in the order in which they are written; single values
    stay single and are kept as coordinates. All cases are solved at once, as one batch.

    Parameters
    ----------
    make : callable or Robot
        What makes a robot from the keywords, such as a preset; or a robot, whose fields are then named with dots:
        ``sweep(robot, **{"drive.amplitude": [4e-4, 5e-4]})``.
    periods, settle, rtol, workers, start, method, slip_ratio, dwell, progress
        As for `solve`. `settle` is "auto" here: a case ends when its strobe point repeats, at most after `periods`, and its mean
        velocity is that of the periodic motion.
    **axes
        Arguments of `make`. A list, an array or an `xarray.DataArray` is an axis; words such as ``law=["coulomb", "lugre"]`` too.

    Returns
    -------
    xarray.Dataset
        mean_velocity, motion_type, pattern, period, margin, fractions, extremes and status, with units and names.

    Examples
    --------
    >>> import stickslip as ss
    >>> grid = ss.sweep(ss.presets.piezo_rig, amplitude=[3e-4, 6e-4], tilt_deg=[1.7, 2.7], law="coulomb")
    >>> dict(grid.sizes), grid.motion_type.sel(tilt_deg=1.7).values.tolist()
    ({'amplitude': 2, 'tilt_deg': 2}, ['II', 'III'])
    """
    single, many, words = _sorted(make, axes)
    options = dict(
        periods=periods,
        settle=settle,
        rtol=rtol,
        workers=workers,
        start=start,
        method=method,
        slip_ratio=slip_ratio,
        dwell=dwell,
        progress=progress,
    )
    parts = []
    for choice in product(*words.values()):
        chosen = dict(zip(words, choice, strict=True))
        parts.append(
            _solved(_batch(make, {**single, **many, **chosen}, many), many, options).expand_dims(
                {name: [value] for name, value in chosen.items()}
            )
        )
    grid = _joined(parts, words)
    order = [d for name in axes for d in (many[name].dims if name in many else [name] if name in words else [])]
    return _described(grid.transpose(*dict.fromkeys(order)), single, make)


def _joined(parts: list[Any], words: dict[str, list[Any]]) -> Any:
    """The datasets of all choices of words, put together along the axes of words."""
    import xarray as xr

    made = [json.loads(part.attrs["provenance"]) for part in parts]
    for name, values in reversed(words.items()):
        many = len(values)
        parts = [xr.concat(parts[i : i + many], dim=name, join="exact", combine_attrs="override") for i in range(0, len(parts), many)]
    return parts[0].assign_attrs(provenance=json.dumps(made[0] if len(made) == 1 else made))


def _sorted(make: Any, axes: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any], dict[str, list[Any]]]:
    """The keywords as single values, labelled arrays of numbers, and lists of words."""
    problems = Problems("sweep")
    _check_names(make, axes, problems)
    single: dict[str, Any] = {}
    many: dict[str, Any] = {}
    words: dict[str, list[Any]] = {}
    for name, value in axes.items():
        if hasattr(value, "dims") and value.ndim:
            many[name] = value
        elif isinstance(value, (Sequence, np.ndarray, range)) and not isinstance(value, (str, bytes)) and np.ndim(value) >= 1:
            _take(name, value, many, words, problems)
        else:
            single[name] = value
    problems.check()
    return single, many, words


def _take(name: str, value: Any, many: dict[str, Any], words: dict[str, list[Any]], problems: Problems) -> None:
    import xarray as xr

    try:
        array = np.asarray(value)
    except ValueError:
        array = np.empty((0, 0))
    if array.ndim != 1 or array.size == 0:
        problems.add(f"{name} has shape {array.shape}; allowed is a single value, a list of one or more, or a labelled xarray.DataArray")
    elif array.dtype.kind in "iuf":
        numbers = array.astype(float)
        many[name] = xr.DataArray(numbers, dims=(name,), coords={name: numbers})
    elif array.dtype.kind in "OUSb":
        words[name] = [v.item() if isinstance(v, np.generic) else v for v in value]
    else:
        problems.add(f"{name} = {value!r}; allowed are numbers or words")


def _check_names(make: Any, axes: dict[str, Any], problems: Problems) -> None:
    if not callable(make):
        if not hasattr(make, "replace"):
            problems.add(f"make = {make!r}; allowed is a Robot or a function that makes one; type for example ss.presets.piezo_rig")
            return
        known = [name for name, _ in leaves(make)] + ["drive", "friction", "track"]
    else:
        parameters = inspect.signature(make).parameters.values()
        if any(p.kind is p.VAR_KEYWORD for p in parameters):
            return
        known = [p.name for p in parameters]
        for p in parameters:
            if p.default is p.empty and p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY) and p.name not in axes:
                problems.add(f"{p.name} is missing; {getattr(make, '__name__', 'the maker')} has no default for it")
    own = [p for p in inspect.signature(sweep).parameters if p not in ("make", "axes")]
    for name in axes:
        if name not in known:
            problems.add(f"{name!r} is not known; {did_you_mean(name, [*known, *own])}")


def _batch(make: Any, arguments: dict[str, Any], many: dict[str, Any]) -> Robot:
    """The robots of the grid as one batch; a maker that cannot take arrays is called point by point."""
    if not callable(make):
        return make.replace(arguments)
    try:
        return make(**arguments)
    except InputError:
        raise
    except (TypeError, ValueError):
        if not many:
            raise
    return _point_by_point(make, arguments, many)


def _point_by_point(make: Callable[..., Robot], arguments: dict[str, Any], many: dict[str, Any]) -> Robot:
    import xarray as xr

    names = list(many)
    columns = xr.broadcast(*many.values())
    points = zip(*(column.values.ravel().tolist() for column in columns), strict=True)
    robots = [make(**{**arguments, **dict(zip(names, point, strict=True))}) for point in points]
    kinds = {tuple(name for name, _ in leaves(robot)) + tuple(type(part) for part in vars(robot).values()) for robot in robots}
    if len(kinds) > 1:
        raise InputError(
            "sweep", [f"the maker returns robots of {len(kinds)} kinds over the grid; allowed is one kind; sweep each kind by itself"]
        )
    tables = [dict(leaves(robot)) for robot in robots]
    like = columns[0]
    arrays = {name: like.copy(data=np.reshape([float(table[name]) for table in tables], like.shape)) for name in tables[0]}
    return replace_leaf(robots[0], arrays)


def _solved(robot: Robot, many: dict[str, Any], options: dict[str, Any]) -> Any:
    """The results of one batch as a dataset that has all dimensions of the grid, also those that do not change the robot."""
    import xarray as xr

    data = solve(robot, keep="summary", **options).to_xarray()
    if not many:
        return data
    whole = xr.broadcast(*many.values())[0]
    data = data.drop_vars([name for name in data.coords if name not in data.dims and name not in whole.coords])
    missing = [str(d) for d in whole.dims if d not in data.dims]
    return data.expand_dims({d: whole.sizes[d] for d in missing}).assign_coords(whole.coords)


def _described(grid: Any, single: dict[str, Any], make: Any) -> Any:
    """Names and units of the axes; single values as coordinates (numbers) or attributes (words)."""
    for name, value in single.items():
        if isinstance(value, (int, float, np.number)) and not isinstance(value, bool) and name not in grid.coords:
            grid = grid.assign_coords({name: float(value)})
        else:
            grid.attrs[name] = str(value)
    for name in grid.coords:
        known = AXES.get(str(name).rpartition(".")[2])
        if known is not None:
            grid[name].attrs = {**grid[name].attrs, "long_name": known[0], "units": known[1]}
    grid.attrs["maker"] = getattr(make, "__name__", None) or type(make).__name__
    grid.attrs["fixed"] = json.dumps({k: v if isinstance(v, (int, float, str, bool)) else str(v) for k, v in single.items()})
    return grid
