"""``stickslip atlas``: motions over two numbers, and the borders between them."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError
from stickslip.show.cli import show
from stickslip.show.cli.arguments import axes_among, section_asked, subject
from stickslip.show.cli.commands.resume import remembered
from stickslip.show.cli.commands.sweep import out_file
from stickslip.show.cli.declaring import EXECUTOR, FIGURES, ROBOT, SECTION, argument, command
from stickslip.show.cli.executors import executor_asked
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


_ROWS = 40  # of the table of special points, as printed


@command(
    about="All motions found over two numbers of a robot, the regions in which each attracts, and their borders.",
    more="""\
values
  amplitude=3e-4..9e-4:24 mu0=0.1..0.3:16      two numbers, each with a range; the others have one value

The computing time is estimated first and reported on stderr; --estimate stops there. Ctrl-C prints the results so far.
With --out FOLDER every result is saved as it is found, and `stickslip resume FOLDER` goes on.""",
    arguments=(
        *ROBOT,
        *SECTION,
        *EXECUTOR,
        argument("--starts", metavar="N", type=int, default=5, help="starts at each point (default 5)"),
        argument("--branches", metavar="N", type=int, default=40, help="largest number of motions to follow (default 40; 0: none)"),
        argument("--refine", metavar="N", type=int, default=1, help="how often cells in doubt are halved (default 1; 0: never)"),
        argument("--estimate", action="store_true", help="report the expected computing time, and stop"),
        argument("--figure", metavar="FILE", ends=FIGURES, help="draw the atlas (.png, .svg or .pdf)"),
        argument("--report", metavar="FILE", ends=(".html",), help="write an offline HTML page (.html)"),
        argument("--out", metavar="PATH", help="a folder, filled as it is found, or a .nc, .mat, .csv, .xlsx or .parquet file of the grid"),
        argument("--resume", action="store_true", help="continue the atlas in --out"),
    ),
    example="""\
$ stickslip atlas piezo_rig tilt_deg=1.7 law=coulomb amplitude=3.3e-4..3.9e-4:4 mu0=0.165..0.185:3
piezo_rig: amplitude 4 values, mu0 3 values, 5 starts at each point
region  share
I       50.0 %
II      50.0 %
special point  amplitude          mu0    accuracy  what changes
type-border    0.000361445394863  0.175  …         pattern +0 becomes +0-0
border: type-border, pattern +0 becomes +0-0, 31 points
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    file = out_file(asked.out)
    if asked.resume and (file is not None or not asked.out):
        raise InputError("--resume", ["this is for a folder; type for example --out atlas"])
    study = subject(asked.robot, asked.settings, many=True, solver=("settle", "limit", "rtol", "workers"), strict=False)
    many, fixed = axes_among(asked.command, study.arguments, 2, "amplitude=3e-4..9e-4:24 mu0=0.1..0.3:16")
    over = {name: sorted(study.arguments[name]) for name in many}
    job = {"over": over, **fixed, **study.options, "starts": asked.starts, "branches": asked.branches, "refine": asked.refine}

    from stickslip.dynamics.atlas.atlas import atlas, atlas_time
    from stickslip.show.reports import atlas_page

    estimate = atlas_time(study.make, **job)
    if asked.estimate:
        return Outcome({"grid": estimate.grid, "branch": estimate.branch, "most": estimate.most}, str(estimate))
    print(estimate, file=sys.stderr)
    with remembered(asked, file):
        kept = {"out": asked.out, "resume": asked.resume} if asked.out and file is None else {}
        where = executor_asked(asked.executor)
        result = atlas(study.make, progress=True, **kept, **section_asked(asked), **{**job, **where})
    draws = ((asked.figure, result.plot), (asked.report, lambda: atlas_page(result, f"Atlas of {study.name}", asked.typed)))
    return Outcome(lambda: _record(study, result), lambda: _text(study, result), draws, file or asked.out, result.map if file else None)


def _record(study: Any, result: Any) -> dict[str, Any]:
    special = [
        {"kind": s.kind, "values": s.values, "accuracy": s.accuracy, "change": s.change, "stable": s.stable} for s in result.special_points
    ]
    borders = [{"kind": b.kind, "values": b.values, "accuracy": b.accuracy, "change": b.change, "ended": b.ended} for b in result.borders]
    axes = {name: result.map[name].values for name in result.parameters}
    columns = {str(name): result.map[name].values for name in result.map.data_vars}
    return {
        "robot": study.name, "axes": axes, "regions": result.regions, "columns": columns, "special": special, "borders": borders,
        "notes": result.notes,
    }  # fmt: skip


def _text(study: Any, result: Any) -> str:
    """Regions, borders and special points as text."""
    p, q = result.parameters
    lines = [
        f"{study.name}: {p} {result.plane.shape[0]} values, {q} {result.plane.shape[1]} values, {result.plane.count} starts at each point"
    ]
    lines.append(show.aligned_table(["region", "share"], [[label, f"{100 * share:.1f} %"] for label, share in result.regions.items()]))
    rows = result.rows()
    if rows:
        lines.append(show.aligned_table(["special point", p, q, "accuracy", "what changes"], [list(row) for row in rows[:_ROWS]]))
    lines += [f"… {len(rows) - _ROWS} more; --report FILE or --json gives all"] if len(rows) > _ROWS else []
    lines += [f"border: {b.kind}, {b.change}, {show.counted(len(b.values), 'point')}" for b in result.borders]
    return "\n".join([*lines, *(f"note: {note}" for note in result.notes)])
