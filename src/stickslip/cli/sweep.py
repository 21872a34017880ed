"""``stickslip sweep``: a grid of robots, as a table or a netCDF file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from stickslip.cli import show
from stickslip.cli.arguments import SOLVER, parser, subject

__all__ = ["act"]

_SHOWN = 60  # rows of the table that are printed
_COLUMNS = ("mean_velocity", "motion_type", "pattern", "period", "margin")
_MORE = "example: stickslip sweep piezo_rig law=lugre,coulomb tilt_deg=1.7 amplitude=4e-4..8e-4:9 --out grid.nc"


def act(command: str, words: list[str]) -> int:
    """Do the command."""
    made = parser(command, "Simulate a robot over a grid of its numbers: a..b:n gives n values from a to b, a,b,c gives three.", more=_MORE)
    made.add_argument("--out", metavar="FILE", help="write the grid (.nc or .csv)")
    asked = made.parse_intermixed_args(words)
    out = show.writable("--out", asked.out, (".nc", ".csv"))
    study = subject(asked.robot, asked.settings, many=True, solver=tuple(name for name in SOLVER if name not in ("samples", "steps")))

    from stickslip.sweeping import sweep

    grid = sweep(study.make, progress=show.progress("cases begun"), **study.options, **study.arguments)
    _write(grid, out)
    if asked.json:
        columns = {name: grid[name].values for name in grid.data_vars}
        axes = {str(name): grid[name].values for name in grid.dims}
        written = str(out) if out else None
        show.print_json({"robot": study.name, "axes": axes, "columns": columns, "attributes": dict(grid.attrs), "written": written})
    else:
        print(_told(grid, study, out))
    return 0


def _write(grid: Any, out: Path | None) -> None:
    if out is None:
        return
    if out.suffix.lower() == ".nc":
        grid.to_netcdf(out, engine="h5netcdf")
    else:
        grid.to_dataframe().to_csv(out)


def _told(grid: Any, study: Any, out: Path | None) -> str:
    """The first rows of the grid, and how its cases ended."""
    import numpy as np

    axes = [str(d) for d in grid.dims]
    flat = {name: np.broadcast_to(grid[name].values, grid[name].shape).ravel() for name in _COLUMNS}
    points = list(np.ndindex(*(grid.sizes[d] for d in grid.dims)))
    head = [f"{d} [{grid[d].attrs['units']}]" if grid[d].attrs.get("units", "1") != "1" else d for d in axes]
    head += ["mean velocity [m/s]", "type", "pattern", "period", "margin"]
    rows = []
    for i, point in enumerate(points[:_SHOWN]):
        places = [_cell(grid[d].values[k]) for d, k in zip(axes, point, strict=True)]
        rows.append([*places, *(_cell(flat[name][i]) for name in _COLUMNS)])
    codes, counts = np.unique(grid.status.values, return_counts=True)
    meanings = dict(part.split(": ", 1) for part in grid.status.attrs["flag_meanings"].split("; "))
    ends = ", ".join(f"{n} {meanings.get(str(c), c)}" for c, n in zip(codes, counts, strict=True))
    lines = [show.table(head, rows)]
    if len(points) > _SHOWN:
        lines.append(f"… {len(points) - _SHOWN} more rows; --out FILE or --json gives all")
    lines.append(f"{study.name}: {len(points)} case{'s' if len(points) > 1 else ''}: {ends}" + (f"; written to {out}" if out else ""))
    return "\n".join(lines)


def _cell(value: Any) -> str:
    return show.quantity(float(value)) if hasattr(value, "dtype") and value.dtype.kind == "f" else str(value)
