"""A page about a study: its axes, what moves how and how fast, maps or curves, the fastest cases, and where it comes from."""

from __future__ import annotations

from typing import Any

from stickslip.report.drawn import svg
from stickslip.report.html import page

__all__ = ["study_page"]

_BEST = 12  # rows of the table of the fastest cases


def study_page(grid: Any, title: str, command: str = "") -> str:
    """The page about the results of `sweep` or `map`.

    Parameters
    ----------
    grid : Dataset
    title : str
        What stands at its top.
    command : str
        What to type for the same page, if it was made by a command.

    Returns
    -------
    str

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> grid = ss.sweep(ss.presets.coulomb_robot, alpha_plus=np.linspace(0.2, 1.2, 11), alpha_minus=0.9)
    >>> "<h1>Eleven robots</h1>" in study_page(grid, "Eleven robots")
    True
    """
    return page(
        "study.html",
        title=title,
        axes=_axes(grid),
        shares=_counted(grid["motion_type"].values),
        ends=_ends(grid),
        pictures=_pictures(grid),
        best=_best(grid),
        notes=_notes(grid),
        command=command,
        provenance=_provenance(grid),
    )


def _provenance(grid: Any) -> list[tuple[str, str]]:
    """What made the numbers, one line for each thing."""
    import json

    made = json.loads(grid.attrs.get("provenance", "{}"))
    parts = [*made.get("versions", {}).items(), *made.get("settings", {}).items(), *made.get("kinds", {}).items()]
    rest = [(k, v) for k, v in grid.attrs.items() if k not in ("notes", "provenance")]
    return [(str(k), "-" if v is None else str(v)) for k, v in [*rest, *parts]]


def _axes(grid: Any) -> list[tuple[str, str]]:
    """Each axis with its range, and each single argument with its value."""
    found = []
    for name in grid.coords:
        values, unit = grid[name].values, str(grid[name].attrs.get("units", ""))
        unit = "" if unit in ("", "1") else f" {unit}"
        if values.ndim == 0:
            found.append((str(name), f"{_plain(values.item())}{unit}"))
        elif values.dtype.kind in "if":
            found.append((str(name), f"{len(values)} values, {_plain(values.min())} to {_plain(values.max())}{unit}"))
        else:
            found.append((str(name), ", ".join(map(str, values))))
    return found


def _plain(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) or hasattr(value, "dtype") else str(value)


def _counted(values: Any) -> list[tuple[str, int, float]]:
    import numpy as np

    names, counts = np.unique(values, return_counts=True)
    order = np.argsort(-counts)
    return [(str(names[i]), int(counts[i]), 100 * counts[i] / values.size) for i in order]


def _ends(grid: Any) -> list[tuple[str, int, float]]:
    """How the cases ended, in words."""
    from stickslip.sweeps.columns import STATUSES

    return [(STATUSES.get(int(code), "settled"), n, share) for code, n, share in _counted(grid["status"].values)]


def _numeric(grid: Any) -> list[str]:
    return [str(d) for d in grid["mean_velocity"].dims if d in grid.coords and grid[d].dtype.kind in "if" and grid.sizes[d] > 1]


def _pictures(grid: Any) -> list[tuple[str, str]]:
    """Two maps of a plane, or curves along one axis; for more axes of words one after the other, up to four."""
    from stickslip import plot

    axes, found = _numeric(grid), []
    for label, part in _parts(grid, axes):
        if len(axes) == 2:
            caption = f"Motion types{label}; black: the exact borders with Coulomb friction, where they are known."
            found.append((caption, svg(_drawer(plot.motion_map, part), 4.2, 3.6)))
            found.append((f"Mean velocity{label}.", svg(_drawer(plot.velocity_map, part), 4.6, 3.6)))
        elif len(axes) == 1:
            found.append((f"Mean velocity{label}, coloured by motion type.", svg(_drawer(_curve, part))))
    return found


def _parts(grid: Any, axes: list[str]) -> list[tuple[str, Any]]:
    """The dataset for each choice of its words, with a few words on it."""
    from itertools import islice, product

    others = [str(d) for d in grid["mean_velocity"].dims if d not in axes]
    choices = islice(product(*(range(grid.sizes[d]) for d in others)), 4)
    found = []
    for choice in choices:
        where = dict(zip(others, choice, strict=True))
        label = ", ".join(f"{d} = {_plain(grid[d].values[i])}" for d, i in where.items() if grid.sizes[d] > 1 and d in grid.coords)
        found.append((f" ({label})" if label else "", grid.isel(where)))
    return found


def _drawer(draw: Any, grid: Any) -> Any:
    return lambda ax: draw(grid, ax=ax)


def _curve(grid: Any, ax: Any) -> None:
    """Mean velocity along one axis, a point for each case."""
    from stickslip.plot.maps import TYPE_COLOURS

    (axis,) = _numeric(grid)
    x, v, kinds = grid[axis].values, 1e3 * grid["mean_velocity"].values, grid["motion_type"].values
    ax.plot(x, v, color="#333333", linewidth=0.7, zorder=1)
    for kind in dict.fromkeys(kinds):
        there = kinds == kind
        colour = TYPE_COLOURS.get(str(kind), "#888888")
        ax.scatter(x[there], v[there], s=14, color=colour, edgecolor="#333333", linewidth=0.4, label=str(kind), zorder=2)
    unit = grid[axis].attrs.get("units", "1")
    ax.set_xlabel(axis if unit in ("", "1") else f"{axis} ({unit})")
    ax.set_ylabel("mean velocity $V$ (mm/s)")
    ax.legend(title="motion type")


def _best(grid: Any) -> tuple[list[str], list[list[str]]]:
    """The fastest cases, as a table."""
    import numpy as np

    V = grid["mean_velocity"]
    speed = np.where(np.isfinite(V.values), abs(V.values), -1.0).ravel()
    order = [int(i) for i in np.argsort(-speed)[:_BEST] if speed[i] >= 0]
    dims = [str(d) for d in V.dims]
    head = [*(_headed(grid, d) for d in dims), _headed(grid, "mean_velocity"), "type", "period", "margin"]
    rows = []
    for i in order:
        place = dict(zip(dims, map(int, np.unravel_index(i, V.shape)), strict=True))
        case = grid.isel(place)
        axes = [_plain(case[d].values[()]) if d in case.coords else str(place[d]) for d in dims]
        rows.append(
            [
                *axes,
                f"{float(case['mean_velocity']):.6g}",
                str(case["motion_type"].values),
                str(int(case["period"]) or "none"),
                f"{float(case['margin']):.3g}",
            ]
        )
    return head, rows


def _headed(grid: Any, name: str) -> str:
    unit = grid[name].attrs.get("units", "1") if name in grid.variables else "1"
    name = name.replace("mean_velocity", "mean velocity")
    return name if unit in ("", "1") else f"{name} [{unit}]"


def _notes(grid: Any) -> list[str]:
    import json

    return [f"{n} cases: {sentence}" for sentence, n in json.loads(grid.attrs.get("notes", "{}")).items()]
