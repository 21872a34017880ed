"""Curves of a study as interactive charts: along its axis, or cuts through its plane."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip.show.figures.style import prefix
from stickslip.show.reports.charts import chart, curve
from stickslip.studies.result_columns import is_of_cases

if TYPE_CHECKING:
    import xarray as xr


_LINES = 5
_TYPES = ("I", "II", "III", "IV", "other", "presliding", "rest")


def speeds(grid: xr.Dataset) -> tuple[float, str]:
    """Factor and unit for the velocities of a study in a figure; the unit is "" for dimensionless robots."""
    unit = str(grid["mean_velocity"].attrs.get("units", "m/s"))
    return (1e3, "mm/s") if unit == "m/s" else (1.0, "" if unit == "1" else unit)


def types_of(grid: xr.Dataset) -> Any:
    """The motion type of each case; empty with several contacts, which have one each."""
    import numpy as np

    return grid["motion_type"].values if is_of_cases(grid, "motion_type") else np.full(grid["mean_velocity"].shape, "")


def _up(grid: xr.Dataset) -> tuple[str, str]:
    return ("mean velocity V", speeds(grid)[1])


def along(grid: xr.Dataset, axis: str, label: str = "") -> dict[str, Any]:
    """The mean velocity along the only axis, and the same by motion type, as points."""
    import numpy as np

    order, x, across = _axis(grid, axis)
    v, kinds = speeds(grid)[0] * grid["mean_velocity"].values[order], types_of(grid)[order]
    curves = [curve("mean velocity", v, emphasis=True)]
    there = [(number, kind) for number, kind in enumerate(_TYPES) if kind in kinds]
    curves += [
        curve(kind, np.where(kinds == kind, v, np.nan), points=True, number=number, emphasis=kind == "rest") for number, kind in there
    ]
    return chart(f"mean velocity along {axis}{label}", x, across, _up(grid), curves)


def together(parts: list[tuple[str, Any]], axis: str) -> dict[str, Any]:
    """The mean velocities of several studies along their only axis, labelled by name."""
    order, x, across = _axis(parts[0][1], axis)
    factor = speeds(parts[0][1])[0]
    curves = [curve(name, factor * part["mean_velocity"].values[order], number=i) for i, (name, part) in enumerate(parts)]
    return chart(f"mean velocity along {axis}", x, across, _up(parts[0][1]), curves)


def cuts(grid: xr.Dataset, across: str, other: str, label: str = "") -> dict[str, Any]:
    """The mean velocity along one axis of a plane, for up to five values of the other.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> plane = ss.sweep(ss.presets.coulomb_robot, alpha_plus=np.linspace(0.2, 1.2, 11), alpha_minus=[0.5, 0.9])
    >>> found = cuts(plane, "alpha_plus", "alpha_minus")
    >>> [one["label"] for one in found["curves"]], len(found["x"])
    (['alpha_minus 0.5', 'alpha_minus 0.9'], 11)
    """
    plane = speeds(grid)[0] * grid["mean_velocity"].transpose(across, other).values
    order, x, along_it = _axis(grid, across)
    _, values, (name, unit) = _axis(grid, other, sort=False)
    curves = [curve(f"{name} {values[i]:.4g} {unit}".rstrip(), plane[order, i], number=n) for n, i in enumerate(chosen(len(values)))]
    return chart(f"mean velocity along {across} for values of {other}{label}", x, along_it, _up(grid), curves)


def chosen(count: int) -> list[int]:
    """Indices of the values that have a line: both ends, and some between."""
    import numpy as np

    return [int(i) for i in np.unique(np.linspace(0, count - 1, min(_LINES, count)).round())]


def _axis(grid: xr.Dataset, name: str, sort: bool = True) -> tuple[Any, Any, tuple[str, str]]:
    """Sorting order, values with an SI prefix, and name with unit."""
    import numpy as np

    unit, values = str(grid[name].attrs.get("units", "1")), np.asarray(grid[name].values, float)
    order = np.argsort(values, kind="stable") if sort else np.arange(len(values))
    factor, letter = prefix(values) if unit in ("m", "s", "N", "N/m", "V", "Hz") else (1.0, "")
    return order, factor * values[order], (name, "" if unit == "1" else letter + unit)
