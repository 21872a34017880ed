"""``stickslip export``: write the results of a sweep as one .nc, .mat, .csv, .xlsx or .parquet file, or a .zarr store."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.basics.errors import as_path
from stickslip.show.cli import show
from stickslip.show.cli.commands.run import DATA, written_to
from stickslip.show.cli.declaring import argument, command
from stickslip.show.cli.outputs import FILES, Outcome, is_run, study_written

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="Write the results of a study, or every column of a run, to one file.",
    arguments=(
        argument("results", metavar="RESULTS", help="a study folder, the .nc file of a sweep, or the .nc file of a run"),
        argument(
            "file", metavar="FILE", help="a .nc, .mat, .csv, .xlsx or (of a study) .parquet file, or a .zarr store (a folder, or a URL)"
        ),
    ),
    example="""\
$ stickslip sweep coulomb_robot alpha_plus=0.4..0.7:4 alpha_minus=0.9 --out study
alpha_plus  mean velocity  type  pattern  period [drive periods]  margin
0.4         0.2915743      I     +0-0     1                       0.0236
0.5         0.1941414      I     +0-0     1                       0.0708
0.6         0.1181625      I     +0-0     1                       0.117
0.7         0.06152274     I     +0-0     1                       0.166
coulomb_robot: 4 cases: 4 settled; written to study
$ stickslip export study grid.csv
coulomb_robot: alpha_plus 4; written to grid.csv
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    source = as_path(asked.results, "study")
    if source.is_file() and is_run(source, asked.command):
        return _export_run(source, show.writable("FILE", asked.file, DATA))
    target = asked.file if asked.file.endswith(".zarr") else str(show.writable("FILE", asked.file, (*FILES, ".zarr")))

    from stickslip.studies import export, open_study

    grid = open_study(source)
    export(grid, target)
    return study_written(grid, target)


def _export_run(source: Path, target: Path | None) -> Outcome:
    from stickslip.results.loading import load

    run = load(source)
    written, count = str(written_to(run, target)), len(run.t)
    text = f"the run in {source}: {show.counted(count, 'instant')}; written to {written}"
    return Outcome({"written": written, "instants": count}, text)
