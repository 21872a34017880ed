"""The fastest cases of a study, and a run of the fastest one if the study contains its robot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr

    from stickslip.results.trajectory import Trajectory


def order(grid: xr.Dataset, most: int) -> list[dict[str, int]]:
    """Indices of the fastest cases, the fastest first; cases without a velocity are left out.

    Examples
    --------
    >>> import stickslip as ss
    >>> grid = ss.sweep(ss.presets.coulomb_robot, alpha_plus=[0.3, 0.2, 0.4], alpha_minus=0.5)
    >>> order(grid, 2)
    [{'alpha_plus': 1}, {'alpha_plus': 0}]
    """
    import numpy as np

    V = grid["mean_velocity"]
    speed = np.where(np.isfinite(V.values), abs(V.values), -1.0).ravel()
    first = [int(i) for i in np.argsort(-speed, kind="stable")[:most] if speed[i] >= 0]
    return [dict(zip(map(str, V.dims), map(int, np.unravel_index(i, V.shape)), strict=True)) for i in first]


def run_again(grid: xr.Dataset) -> Any:
    """A run of the fastest case; None if the study does not contain its robot, or if the motion differs.

    A study contains the name of a preset, or the robot itself, and the arguments only. User functions are not looked up.
    """
    from stickslip.basics.errors import StickslipError
    from stickslip.solvers import solve

    places = order(grid, 1)
    if not places or "way" in grid.dims:
        return None
    case = grid.isel(places[0])
    try:
        robot = _robot(case)
        if robot is None or robot.period is None:
            return None
        run = solve(robot, periods=int(case["periods_run"]) + 100, settle="auto", keep="trajectory")
    except StickslipError:
        return None
    return run if _alike(run, float(case["mean_velocity"])) else None


def _robot(case: Any) -> Any:
    """The machine of one case, from its preset or from the stored one with its changes; None if neither is known."""
    import inspect
    import json

    from stickslip.basics.fields import leaves
    from stickslip.basics.number_names import numbers_meant
    from stickslip.models.presets import PRESETS
    from stickslip.results.storage import from_text

    maker: Any = PRESETS.get(str(case.attrs.get("maker")))
    if maker is not None:
        return maker(**_arguments(case, inspect.signature(maker).parameters))
    given = from_text(case.attrs["robot"]) if "robot" in case.attrs else None
    if given is None or case.attrs.get("maker") != type(given).__name__:
        return None
    numbers = [name for name, _ in leaves(given)]
    named = [*case.coords, *json.loads(case.attrs.get("fixed", "{}"))]
    return given.replace(_arguments(case, {str(name) for name in named if numbers_meant(str(name), numbers)}))


def _arguments(case: Any, known: Any) -> dict[str, Any]:
    """The arguments of one case that its maker takes, both varying and fixed."""
    import json

    fixed = json.loads(case.attrs.get("fixed", "{}"))
    return {
        **{name: value for name, value in fixed.items() if name in known},
        **{str(name): value.values.item() for name, value in case.coords.items() if name in known},
    }


def _alike(run: Trajectory, velocity: float) -> bool:
    """Whether the run agrees with the case of the study; with coexisting motions it may not."""
    from stickslip.analysis.steady import mean_velocity

    return abs(mean_velocity(run) - velocity) <= 1e-3 * abs(velocity)
