"""``stickslip sweep``: a grid of robots, as a table or a netCDF file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from stickslip.cli import show
from stickslip.cli.arguments import SOLVER, parser, subject

__all__ = ["act"]

_SHOWN = 60  # rows of the table that are printed
_COLUMNS = ("mean_velocity", "motion_type", "pattern", "period", "margin")
_SETTLED = 1  # the status of a case whose strobe point repeats
_MORE = "example: stickslip sweep piezo_rig law=lugre,coulomb tilt_deg=1.7 amplitude=4e-4..8e-4:9 --out grid.nc"


def act(command: str, words: list[str]) -> int:
    """Do the command."""
    made = parser(command, "Simulate a robot over a grid of its numbers: a..b:n gives n values from a to b, a,b,c gives three.", more=_MORE)
    made.add_argument("--out", metavar="FILE", help="write the grid (.nc or .csv)")
    asked = made.parse_intermixed_args(words)
    out = show.writable("--out", asked.out, (".nc", ".csv"))
    study = subject(asked.robot, asked.settings, many=True, solver=tuple(name for name in SOLVER if name not in ("samples", "steps")))

    from stickslip.sweeps import sweep

    grid = sweep(study.make, progress=show.progress("cases begun"), **study.options, **study.arguments)
    _write(grid, out)
    if asked.json:
        columns = {name: _column(grid, name) for name in grid.data_vars}
        axes = {name: grid[name].values for name in _axes(grid)}
        written = str(out) if out else None
        show.print_json({"robot": study.name, "axes": axes, "columns": columns, "attributes": dict(grid.attrs), "written": written})
    else:
        print(_told(grid, study, out))
    return 0


def _axes(grid: Any) -> list[str]:
    """The axes in the order of the results. A dataset keeps its own, which is another one once it was transposed."""
    return [str(d) for d in grid["mean_velocity"].dims]


def _column(grid: Any, name: Any) -> Any:
    """A result or a coordinate at every point of the grid, in the order of the axes."""
    return grid[name].broadcast_like(grid["mean_velocity"]).transpose(*_axes(grid)).values


def _write(grid: Any, out: Path | None) -> None:
    if out is None:
        return
    if out.suffix.lower() == ".nc":
        grid.to_netcdf(out, engine="h5netcdf")
        return
    import csv

    axes, meanings = _axes(grid), _meanings(grid)
    names = [*axes, *(str(n) for n in grid.coords if n not in axes), *(str(n) for n in grid.data_vars)]
    columns = {name: _column(grid, name).ravel().tolist() for name in names}
    columns["status"] = [meanings[code] for code in columns["status"]]
    with out.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([_headed(grid, name) for name in names])
        writer.writerows(zip(*columns.values(), strict=True))


def _headed(grid: Any, name: str) -> str:
    """A name and its unit, if it has one."""
    unit = grid[name].attrs.get("units", "1")
    return name if unit in ("", "1") else f"{name} [{unit}]"


def _meanings(grid: Any) -> dict[int, str]:
    """What a status code says."""
    parts = (part.split(": ", 1) for part in grid["status"].attrs["flag_meanings"].split("; "))
    return {int(code): sentence for code, sentence in parts} | {_SETTLED: "settled"}


def _told(grid: Any, study: Any, out: Path | None) -> str:
    """The first rows of the grid, and how its cases ended."""
    axes = _axes(grid)
    columns = [_column(grid, name).ravel() for name in (*axes, *_COLUMNS)]
    cases = len(columns[0])
    head = [*(_headed(grid, d) for d in axes), "mean velocity [m/s]", "type", "pattern", "period", "margin"]
    names = (*axes, *_COLUMNS)
    rows = [[_cell(name, column[i]) for name, column in zip(names, columns, strict=True)] for i in range(min(cases, _SHOWN))]
    lines = [show.table(head, rows)]
    if cases > _SHOWN:
        lines.append(f"… {cases - _SHOWN} more rows; --out FILE or --json gives all")
    lines.append(f"{study.name}: {show.counted(cases, 'case')}: {_ends(grid)}" + (f"; written to {out}" if out else ""))
    return "\n".join([*lines, *_unperiodic(grid, study)])


def _ends(grid: Any) -> str:
    """How many cases ended how."""
    import numpy as np

    meanings = _meanings(grid)
    codes, counts = np.unique(grid["status"].values, return_counts=True)
    return ", ".join(f"{n} {meanings[int(c)]}" for c, n in zip(codes, counts, strict=True))


def _unperiodic(grid: Any, study: Any) -> list[str]:
    """A sentence on the cases that ran to their end and did not repeat."""
    import inspect

    from stickslip.sweeps import sweep

    number = int(((grid["period"] == 0) & (grid["status"] <= _SETTLED)).sum())
    periods = study.options.get("periods", inspect.signature(sweep).parameters["periods"].default)
    return [f"{show.counted(number, 'case')}: {show.no_period(periods)}"] if number else []


def _cell(name: str, value: Any) -> str:
    if name == "period":
        return str(int(value)) if value > 0 else "none"
    if hasattr(value, "dtype") and value.dtype.kind == "f":
        return show.quantity(float(value), digits=3 if name == "margin" else 7)
    return str(value)
