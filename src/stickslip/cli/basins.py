"""``stickslip basins``: which start leads to which of several coexisting motions."""

from __future__ import annotations

import re
from typing import Any

from stickslip.cli import show
from stickslip.cli.arguments import parser, subject, values
from stickslip.errors import InputError, Problems

__all__ = ["act"]

_START = re.compile(r"(x|v|z\d*|phase)=(.+)")


def act(command: str, words: list[str]) -> int:
    """Do the command."""
    made = parser(
        command,
        "Which of several coexisting motions a robot settles on, over a grid of starts: v=a..b:n [m/s], z=a..b:n [m], phase=0..0.9:10.",
    )
    made.add_argument("--figure", metavar="FILE", help="draw the map (.png, .svg or .pdf)")
    made.add_argument("--out", metavar="FILE", help="write the map (.nc)")
    asked = made.parse_intermixed_args(words)
    figure, out = show.writable("--figure", asked.figure, (".png", ".svg", ".pdf")), show.writable("--out", asked.out, (".nc",))
    starts = _starts(asked.settings)
    if figure is not None and sum(isinstance(v, list) and len(v) > 1 for v in starts.values()) < 2:
        raise InputError("--figure", ["a map needs two coordinates with several values; type for example v=-0.1..0.1:41 z=-2e-6..2e-6:21"])
    study = subject(asked.robot, [w for w in asked.settings if not _START.fullmatch(w)], solver=("settle", "rtol"))

    from stickslip.dynamics.attractors import basins

    found = basins(study.robot(), **study.options, **starts)
    if figure is not None:
        from stickslip import plot

        plot.basins(found).figure.savefig(figure)
    if out is not None:
        found.map.to_netcdf(out, engine="h5netcdf")
    written = [str(path) for path in (figure, out) if path is not None]
    if asked.json:
        attractors = [
            {"period": a.period, "mean_velocity": a.mean_velocity, "share": a.share, "interval": a.interval} for a in found.attractors
        ]
        axes = {str(name): found.map[name].values for name in found.map.attractor.dims}
        columns = {str(name): found.map[name].values for name in found.map.data_vars}
        show.print_json({"robot": study.title(), "attractors": attractors, "axes": axes, "columns": columns, "written": written})
    else:
        print(_told(study, found, written))
    return 0


def _starts(words: list[str]) -> dict[str, Any]:
    """The words that are coordinates of the start."""
    problems, found = Problems("arguments"), {}
    for match in filter(None, map(_START.fullmatch, words)):
        try:
            found[match[1]] = values(match[2])
        except ValueError as error:
            problems.add(f"{match[1]}: {error}")
    problems.check()
    return found


def _told(study: Any, found: Any, written: list[str]) -> str:
    head = ["attractor", "period", "mean velocity [m/s]", "share", "95 %"]
    rows = [
        [str(k), str(a.period or "none"), f"{a.mean_velocity:.7g}", f"{a.share:.4f}", f"{a.interval[0]:.4f} to {a.interval[1]:.4f}"]
        for k, a in enumerate(found.attractors)
    ]
    lost = int((found.map.attractor == -1).sum())
    lines = [study.title(), show.table(head, rows), f"{show.counted(int(found.map.attractor.size), 'start')}, {lost} not solved"]
    return "\n".join([*lines, *(f"written to {path}" for path in written)])
