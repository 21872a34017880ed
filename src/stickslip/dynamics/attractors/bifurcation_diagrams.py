"""Brute-force bifurcation diagrams: the attractor after transients for each value of a parameter, upwards and downwards."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.arguments import Maker, Numbers, explains_arguments
from stickslip.contracts import Array
from stickslip.dynamics.continuation.one_parameter import Family, family
from stickslip.dynamics.periodic.given_states import states_of
from stickslip.dynamics.stroboscopic.chunked_runs import Report, shared
from stickslip.dynamics.stroboscopic.refusals import needs_model
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, strobe_map, strobe_orbit
from stickslip.engine.texts import recurrence
from stickslip.errors import Problems
from stickslip.fields import floats
from stickslip.flow import is_flow
from stickslip.interruption import interruptible, look, partial_result
from stickslip.naming import in_its_unit
from stickslip.sweeps.progress import Watch

if TYPE_CHECKING:
    import xarray as xr

DIRECTIONS = ("up", "down")
LONGEST = 32  # largest period number that is looked for
UNDONE = -1  # period number of what was not computed
_RETURN = 1e-6  # strobe points closer than this, in scales, count as one


@explains_arguments
@interruptible
def bifurcation(
    make: Maker,
    *,
    parameter: str,
    values: Numbers,
    settle: int = 200,
    points: int = 64,
    follow: bool = True,
    start: Any = None,
    rtol: float = 1e-7,
    workers: int = 1,
    progress: Report | None = None,
    **fixed: Any,
) -> xr.Dataset:
    """A bifurcation diagram by brute force: the strobe points after settling, for every value of a parameter.

    Parameters
    ----------
    make : callable or Robot
        A function that makes a robot from keyword arguments, or a robot whose numbers have dotted names.
    parameter : str
        The keyword that varies.
    values : array
        Its values, ascending.
    settle, points : int
        Drive periods that are discarded, and that are recorded.
    follow : bool
        True: sweep up through the values and down again, each case starting where the previous one ended, which reveals hysteresis. False:
        every case starts at `start` and all run in one batch, which is much faster.
    start : dict, array or orbit, optional
        Initial state; rest if not given.
    rtol : float
        Tolerance for dynamic laws.
    workers : int
        Threads, where `follow` is False (following goes from value to value). The results do not depend on it.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with a `Progress`; return False to stop. Cases not computed are then NaN,
        with the period -1.
    **fixed
        The other arguments of `make`.

    Returns
    -------
    xarray.Dataset
        Over direction ("up", "down"), the parameter and point: the strobe state (v, z, ...), displacement in each period [m]; over
        direction and parameter: mean_velocity [m/s], period (0: none up to 32, -1: not computed), v_max, v_min [m/s] of the last period
        (of one body).

    Examples
    --------
    >>> import stickslip as ss
    >>> d = ss.bifurcation(ss.presets.piezo_rig, parameter="mu0", values=[0.04, 0.05], settle=100, points=32, follow=False,
    ...                    amplitude=6e-4, tilt_deg=1.7)
    >>> d.period.values.tolist()
    [[2, 1]]
    """
    robots = family("bifurcation", make, (parameter,), fixed)
    problems = Problems("bifurcation")
    problems.whole("settle", settle, 1, example=200)
    problems.whole("points", points, 2, example=64)
    problems.whole("workers", workers, 1, example=2)
    values = checked_values(problems, values, robots)
    needs_model("bifurcation", robots.robot(values[0]), flows=True)
    at = coordinates(robots.robots(values))
    first = states_of(start, robots.robots(values))
    n, d = first.shape
    directions = DIRECTIONS if follow else ("from start",)
    found = [np.full((len(directions), n, *rest), np.nan) for rest in ((points, d), (points,), (1,), (1,))]
    with partial_result() as ending:
        if follow:
            _hysteresis(found, robots, values, first, settle, points, rtol, progress)
        else:
            _anew(found, robots, values, first, settle, points, rtol, workers, progress)
    grid = _dataset(robots, parameter, values, at, found, directions, settle)
    if not ending.interrupted:
        return grid
    done = int(np.isfinite(found[0]).all(axis=(-1, -2)).sum())
    return grid.assign_attrs(note=ending.note(f"{done} of {grid.period.size} motions are computed"))


def checked_values(problems: Problems, values: Any, robots: Family) -> Array:
    """The values of a parameter, rising; `InputError` if they are not, or anything else is wrong."""
    values = in_its_unit(robots.parameters[0], values, robots.make, problems, "values")
    array = floats(values)
    if array.ndim != 1 or len(array) < 2 or not np.all(np.isfinite(array)) or not np.all(np.diff(array) > 0):
        problems.add(f"values = {values!r}; allowed are two or more rising finite numbers; type values=np.linspace(0.03, 0.06, 300)")
    problems.check()
    return array


def _anew(
    whole: list[Array], robots: Family, values: Array, first: Array, settle: int, points: int, rtol: float, workers: int, progress: Any
) -> None:
    """Every value from its own start, into the columns."""

    def part_of(part: slice, tell: Callable[[float], None]) -> list[Array]:
        return _batch(robots, values[part], first[part], settle, points, rtol, tell)

    for part, found in shared(len(first), part_of, workers, progress):
        for column, rows in zip(whole, found, strict=True):
            column[0, part] = rows


def _batch(robots: Family, values: Array, states: Array, settle: int, points: int, rtol: float, tell: Any = None) -> list[Array]:
    """States (values, points, d), displacements (values, points), v_max and v_min (values, 1) of cases that run side by side."""
    model = robots.robots(values)
    state = strobe_map(model, states, settle, rtol).state
    if tell is not None:
        tell(0.5)
    kept, ways = strobe_orbit(model, state, points, rtol)
    last = strobe_map(model, kept[-1], 1, rtol)
    return [np.moveaxis(kept, 0, 1), ways.T, last.v_max[:, None], last.v_min[:, None]]


def _hysteresis(
    whole: list[Array], robots: Family, values: Array, first: Array, settle: int, points: int, rtol: float, progress: Any
) -> None:
    """Upwards and downwards side by side, each value from the end of the one before, into the columns."""
    n, states, watch = len(values), first[[0, -1]], Watch(len(values), progress)
    for k in range(n):
        look()
        found = _batch(robots, values[[k, n - 1 - k]], states, settle, points, rtol)
        states = np.where(np.isfinite(found[0][:, -1]), found[0][:, -1], first[[k, n - 1 - k]])
        for column, rows in zip(whole, found, strict=True):
            column[0, k], column[1, n - 1 - k] = rows
        watch.finished(k, np.zeros(1, int))


def periods_of(points: Array, scales: Array, tolerance: float = _RETURN) -> Array:
    """Period numbers of strobe points (..., points, d): the smallest after which all of them come back; 0 if none up to 32.

    What still settles, or swings ever closer around a motion of a part of the period, has none yet; see `stickslip.recurrence`.
    """
    cases = np.zeros((int(np.prod(points.shape[:-2])), points.shape[-2], 1 + points.shape[-1]))
    cases[..., 1:] = points.reshape(len(cases), *points.shape[-2:])
    return np.array([_lasting(case, scales, tolerance) for case in cases], int).reshape(points.shape[:-2])


def _lasting(points: Array, scales: Array, tolerance: float) -> int:
    """The period number, if every point is on the motion, the first ones too."""
    p = seen(points, scales, tolerance)[0]
    return p if p and (abs(points[p:, 1:] - points[:-p, 1:]) <= tolerance * scales).all() else 0


def seen(points: Array, scales: Array, tolerance: float) -> tuple[int, int]:
    """`recurrence.period_number` of an array of strobe points, x first, up to period 32."""
    last = len(points) - 1
    return recurrence().period_number(points, last, last, LONGEST, np.array(scales, float), tolerance, tolerance)


def steady_velocity(ways: Array, period: Array, T: Any) -> Array:
    """Mean velocity [m/s] over the whole motion periods that ways [m] in drive periods T [s] hold (..., points); all where there is none.

    Examples
    --------
    >>> float(steady_velocity(np.array([1.0, 3.0, 1.0]), np.array(2), 0.5))
    4.0
    """
    points = ways.shape[-1]
    count = whole_motions(points, period)
    return np.where(np.arange(points) < count[..., None], ways, 0.0).sum(axis=-1) / (count * T)


def whole_motions(points: int, period: Array) -> Array:
    """How many of so many drive periods make whole motion periods; all where there is no period.

    Examples
    --------
    >>> whole_motions(64, np.array([0, 1, 3])).tolist()
    [64, 64, 63]
    """
    return np.where(period > 0, points - points % np.maximum(period, 1), points)


def _dataset(robots: Family, parameter: str, values: Array, at: Any, found: list[Array], directions: tuple[str, ...], settle: int) -> Any:
    import xarray as xr

    points, ways, v_max, v_min = found
    whole, flat = ("direction", parameter, "point"), ("direction", parameter)
    T = np.asarray(robots.robots(values).period, float)
    period = periods_of(points, at.scales)
    period[~np.isfinite(points).all(axis=(-1, -2))] = UNDONE
    flow = is_flow(robots.robot(values[0]))
    columns: dict[str, Any] = {n: (whole, points[..., i], state_attrs(n, "on the strobe", flow)) for i, n in enumerate(at.names)}
    if not flow:  # which makes no way
        columns["displacement"] = (whole, ways, {"units": "m", "long_name": "displacement in a drive period"})
        columns["mean_velocity"] = (flat, steady_velocity(ways, period, T), {"units": "m/s", "long_name": "mean velocity"})
    columns |= {
        "period": (flat, period, {"units": "1", "long_name": "drive periods until it repeats (0: none found, -1: not computed)"}),
    }
    if at.mechanics is None and not flow:
        columns["v_max"] = (flat, v_max[..., 0], {"units": "m/s", "long_name": "largest velocity"})
        columns["v_min"] = (flat, v_min[..., 0], {"units": "m/s", "long_name": "smallest velocity"})
    coords = {parameter: (parameter, values, robots.describe(parameter)), "direction": list(directions)}
    return xr.Dataset(columns, coords, {"parameter": parameter, "settle": settle})


def state_attrs(name: str, when: str, flow: bool = False) -> dict[str, str]:
    """Unit and name of a coordinate of a strobe state at some time; nobody knows the units of a flow's states.

    Examples
    --------
    >>> state_attrs("v.head", "at the start"), state_attrs("z0", "on the strobe")["units"], state_attrs("memory", "on the strobe")["units"]
    ({'units': 'm/s', 'long_name': 'velocity of head at the start'}, 'm', '1')
    """
    letter, _, part = name.partition(".")
    if flow or letter.startswith("memory"):
        return {"units": "1", "long_name": f"{name} {when}" if flow else f"what the law remembers {when}, {name}"}
    known = {"v": "velocity", "x": "position", "l": "position, less that of the first body,"}
    whose = f" of {part}" if part and letter in known else ""
    return {"units": "m/s" if letter == "v" else "m", "long_name": f"{known.get(letter, f'inner state {name}')}{whose} {when}"}
