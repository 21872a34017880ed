"""Page on a study: its axes, shares of motion types, maps or curves, the fastest cases, and provenance."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip.basics.contracts import Array
from stickslip.show.reports.charts import chart_library
from stickslip.show.reports.fastest import order, run_again
from stickslip.show.reports.html import page
from stickslip.show.reports.moving import moments
from stickslip.show.reports.run import UNITLESS, numbers, sources
from stickslip.show.reports.study_charts import speeds
from stickslip.show.reports.study_figures import figures, plain
from stickslip.studies.result_columns import column_of, is_of_cases

if TYPE_CHECKING:
    import xarray as xr


_BEST = 12  # rows in the table of the fastest cases


def study_page(grid: xr.Dataset, title: str, command: str = "") -> str:
    """The page on the results of `sweep` or `map`.

    Parameters
    ----------
    grid : Dataset
    title : str
        Title of the page.
    command : str
        The command that makes the page, if it was made by one.

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
    fastest = run_again(grid)
    return page(
        "study.html",
        title=title,
        axes=_axes(grid),
        numbers=_numbers(grid),
        toml=grid.attrs.get("robot", ""),
        shares=_shares(grid),
        ends=_ends(grid),
        figures=figures(grid),
        library=chart_library(),
        best=_best(grid),
        moments=moments(fastest) if fastest else None,
        sources=sources(fastest.model) if fastest else [],
        notes=_notes(grid),
        command=command,
        provenance=_provenance(grid),
    )


def _provenance(grid: xr.Dataset) -> list[tuple[str, str]]:
    """Provenance of the numbers, one line for each entry."""
    import json

    made = json.loads(grid.attrs.get("provenance", "{}"))
    parts = [*made.get("versions", {}).items(), *made.get("settings", {}).items(), *made.get("kinds", {}).items()]
    rest = [(k, grid.attrs[k]) for k in ("maker", "study") if k in grid.attrs]
    return [(str(k), "-" if v is None else str(v)) for k, v in [*rest, *parts]]


def _axes(grid: xr.Dataset) -> list[tuple[str, str]]:
    """Each axis with its range, and each single argument with its value."""
    import json

    rows = []
    for name in grid.coords:
        values, unit = grid[name].values, str(grid[name].attrs.get("units", ""))
        unit = "" if unit in ("", "1") else f" {unit}"
        if values.ndim == 0:
            rows.append((str(name), f"{plain(values.item())}{unit}"))
        elif values.dtype.kind in "if":
            rows.append((str(name), f"{len(values)} values, {plain(values.min())} to {plain(values.max())}{unit}"))
        else:
            rows.append((str(name), ", ".join(map(str, values))))
    fixed = json.loads(grid.attrs.get("fixed", "{}"))
    return [*rows, *((name, str(value)) for name, value in fixed.items() if name not in grid.coords)]


def _numbers(grid: xr.Dataset) -> list[tuple[str, str, str]]:
    """The numbers that the robots of all cases share, besides the axes and arguments."""
    import json

    shared = json.loads(grid.attrs.get("numbers", "{}"))
    described = json.loads(grid.attrs.get("described", "{}"))
    own = {name: value for name, value in shared.items() if name not in grid.coords}
    return numbers(((name, value, described.get(name)) for name, value in own.items()), units=bool(speeds(grid)[1]))


def _shares(grid: xr.Dataset) -> list[tuple[str, int, float]]:
    """Number and share of each motion type; with several contacts, for each of them."""
    if is_of_cases(grid, "motion_type") or "contact" not in grid.dims:
        return _counted(column_of("report", grid, "motion_type").values)
    types = grid["motion_type"]
    named = [(str(name), types.sel(contact=name).values) for name in grid["contact"].values]
    return [(f"{name}: {kind}", count, share) for name, values in named for kind, count, share in _counted(values)]


def _counted(values: Array) -> list[tuple[str, int, float]]:
    import numpy as np

    names, counts = np.unique(values, return_counts=True)
    order = np.argsort(-counts)
    return [(str(names[i]), int(counts[i]), 100 * counts[i] / values.size) for i in order]


def _ends(grid: xr.Dataset) -> list[tuple[str, int, float]]:
    """Number and share of each status, in words."""
    from stickslip.basics.status import STATUS

    return [(STATUS.get(int(code), "settled"), n, share) for code, n, share in _counted(grid["status"].values)]


def _best(grid: xr.Dataset) -> tuple[list[str], list[list[str]]]:
    """The fastest cases, as a table."""
    dims = [str(d) for d in grid["mean_velocity"].dims]
    head = [*(headed(grid, d) for d in dims), headed(grid, "mean_velocity"), "type", "period", "margin"]
    rows = []
    for indices in order(grid, _BEST):
        case = grid.isel(indices)
        axes = [plain(case[d].values[()]) if d in case.coords else str(indices[d]) for d in dims]
        types, period = " | ".join(map(str, case["motion_type"].values.ravel())), str(int(case["period"]) or "none")
        rows.append([*axes, f"{float(case['mean_velocity']):.6g}", types, period, f"{float(case['margin'].min()):.3g}"])
    return head, rows


def headed(grid: xr.Dataset, name: str) -> str:
    """A name and its unit, if it has one."""
    unit = grid[name].attrs.get("units", "1") if name in grid.variables else "1"
    name = name.replace("mean_velocity", "mean velocity")
    return name if unit in ("", "1") else f"{name} [{unit}]"


def _notes(grid: xr.Dataset) -> list[str]:
    import json

    from stickslip.results.steadiness import unsettled_note

    late = unsettled_note(grid["steadiness"].values, grid["settling_error"].values) if "steadiness" in grid else []
    notes = late + [f"{n} cases: {sentence}" for sentence, n in json.loads(grid.attrs.get("notes", "{}")).items()]
    return notes if speeds(grid)[1] else [*notes, UNITLESS]
