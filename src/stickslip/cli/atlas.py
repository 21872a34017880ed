"""``stickslip atlas``: motions over two numbers, and the borders between them."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from stickslip.cli import show
from stickslip.cli.arguments import check_driven, parser, subject
from stickslip.cli.resuming import remembered
from stickslip.cli.sweep import out_file, watcher
from stickslip.errors import InputError

__all__ = ["act"]

_ROWS = 40  # of the table of special points that are printed
_MORE = """\
values
  amplitude=3e-4..9e-4:24 mu0=0.1..0.3:16      two numbers, each with a range; the others have one value

The computing time is estimated first and reported on stderr; --estimate stops there. Ctrl-C prints the results so far.
With --out FOLDER every result is saved as it is found, and `stickslip resume FOLDER` goes on."""


def act(command: str, words: list[str]) -> int:
    """Do the command."""
    made = parser(
        command, "All motions found over two numbers of a robot, the regions in which each attracts, and their borders.", more=_MORE
    )
    made.add_argument("--starts", type=int, default=5, metavar="N", help="starts at each point (default 5)")
    made.add_argument("--branches", type=int, default=40, metavar="N", help="largest number of motions to follow (default 40; 0: none)")
    made.add_argument("--refine", type=int, default=1, metavar="N", help="how often cells in doubt are halved (default 1; 0: never)")
    made.add_argument("--estimate", action="store_true", help="report the expected computing time, and stop")
    made.add_argument("--figure", metavar="FILE", help="draw the atlas (.png, .svg or .pdf)")
    made.add_argument("--report", metavar="FILE", help="write an offline HTML page (.html)")
    made.add_argument(
        "--out", metavar="PATH", help="a folder, filled as it is found, or a .nc, .mat, .csv, .xlsx or .parquet file of the grid"
    )
    made.add_argument("--resume", action="store_true", help="continue the atlas in --out")
    asked = made.parse_intermixed_args(words)
    check_driven(command, asked.robot)
    figure, report = show.writable("--figure", asked.figure, (".png", ".svg", ".pdf")), show.writable("--report", asked.report, (".html",))
    file = out_file(asked.out)
    if asked.resume and (file is not None or not asked.out):
        raise InputError("--resume", ["this is for a folder; type for example --out atlas"])
    study = subject(asked.robot, asked.settings, many=True, solver=("settle", "rtol", "workers"), strict=False)
    job = {**_over(command, study.arguments), **study.options, "starts": asked.starts, "branches": asked.branches, "refine": asked.refine}

    from stickslip.dynamics.atlas.making_an_atlas import atlas, atlas_time

    told = atlas_time(study.make, **job)
    if asked.estimate:
        show.print_json({"grid": told.grid, "branch": told.branch, "most": told.most}) if asked.json else print(told)
        return 0
    print(told, file=sys.stderr)
    with remembered(command, words, asked, file):
        kept = {"out": asked.out, "resume": asked.resume} if asked.out and file is None else {}
        found = atlas(study.make, progress=watcher(), **kept, **job)
    written = _written(found, study, (figure, report, file), " ".join(["stickslip", command, *words]))
    written += [asked.out] if kept else []
    if asked.json:
        show.print_json({**_record(study, found), "written": written})
    else:
        print("\n".join([_text(study, found), *(f"written to {path}" for path in written)]))
    return 0


def _over(command: str, arguments: dict[str, Any]) -> dict[str, Any]:
    """The two arguments that have several values, and the others."""
    many = [name for name, value in arguments.items() if isinstance(value, list)]
    if len(many) != 2:
        given = f"{' and '.join(many)} {'has' if len(many) == 1 else 'have'} several" if many else "no argument has several"
        typed = "amplitude=3e-4..9e-4:24 mu0=0.1..0.3:16"
        raise InputError(command, [f"{given} values; allowed are exactly two, as NAME=a..b:n; type for example {typed}"])
    fixed = {name: value for name, value in arguments.items() if name not in many}
    return {"over": {name: sorted(arguments[name]) for name in many}, **fixed}


def _written(found: Any, study: Any, files: tuple[Path | None, ...], again: str) -> list[str]:
    """Draw and write what was asked for; returns where."""
    figure, report, file = files
    if figure is not None:
        show.draw_to(figure, found.plot().figure)
    if report is not None:
        from stickslip.report import atlas_page, write

        write(str(report), atlas_page(found, f"Atlas of {study.name}", again))
    if file is not None:
        from stickslip.sweeps import export

        export(found.map, file)
    return [str(path) for path in files if path is not None]


def _record(study: Any, found: Any) -> dict[str, Any]:
    special = [{"kind": s.kind, "values": s.values, "accuracy": s.accuracy, "change": s.change, "stable": s.stable} for s in found.found]
    borders = [{"kind": b.kind, "values": b.values, "accuracy": b.accuracy, "change": b.change, "ended": b.ended} for b in found.borders]
    axes = {name: found.map[name].values for name in found.parameters}
    columns = {str(name): found.map[name].values for name in found.map.data_vars}
    return {
        "robot": study.name, "axes": axes, "regions": found.regions, "columns": columns, "special": special, "borders": borders,
        "notes": found.notes,
    }  # fmt: skip


def _text(study: Any, found: Any) -> str:
    """Regions, borders and special points as a person reads them."""
    p, q = found.parameters
    lines = [
        f"{study.name}: {p} {found.plane.shape[0]} values, {q} {found.plane.shape[1]} values, {found.plane.count} starts at each point"
    ]
    lines.append(show.table(["region", "share"], [[label, f"{100 * share:.1f} %"] for label, share in found.regions.items()]))
    rows = found.rows()
    if rows:
        lines.append(show.table(["special point", p, q, "accuracy", "what changes"], [list(row) for row in rows[:_ROWS]]))
    lines += [f"… {len(rows) - _ROWS} more; --report FILE or --json gives all"] if len(rows) > _ROWS else []
    lines += [f"border: {b.kind}, {b.change}, {show.counted(len(b.values), 'point')}" for b in found.borders]
    return "\n".join([*lines, *(f"note: {note}" for note in found.notes)])
