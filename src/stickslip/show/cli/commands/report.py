"""``stickslip report``: one robot, one run or one study as a self-contained HTML page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.basics.errors import InputError, as_path
from stickslip.show.cli import show
from stickslip.show.cli.arguments import subject
from stickslip.show.cli.declaring import ROBOT, argument, command
from stickslip.show.cli.outputs import Outcome, is_run

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="Write one HTML page about a robot (it is solved now), a run (.nc) or a study (a folder, or .nc of a sweep).",
    arguments=(
        *ROBOT,
        argument("--out", metavar="FILE", default="report.html", ends=(".html",), help="the .html file to write (default: report.html)"),
        argument("--title", metavar="TEXT", help="its heading"),
    ),
    example="""\
$ stickslip report piezo_rig tilt_deg=1.7 amplitude=5.56e-4 law=coulomb-static periods=40 --out report.html
a report on one run of piezo_rig tilt_deg=1.7 amplitude=0.000556 law=coulomb-static, … kB; written to report.html
$ stickslip sweep coulomb_robot alpha_plus=0.2..1.2:11 alpha_minus=0.5,0.9 --out study
…
coulomb_robot: 22 cases: 22 settled; written to study
$ stickslip report study --out study.html
a report on 22 cases in study, … kB; written to study.html
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    text, what = _page(asked, " ".join(["stickslip report", asked.robot, *asked.settings]))

    from stickslip.show.reports import write

    write(asked.out, text)
    size = len(text.encode())
    record = {"what": what, "written": str(asked.out), "bytes": size}
    return Outcome(record, f"a report on {what}, {size / 1e3:.0f} kB; written to {asked.out}")


def _page(asked: Namespace, typed: str) -> tuple[str, str]:
    """The text of the page, and its subject."""
    path = as_path(asked.robot, "report")
    if (path / "manifest.json").exists() or path.suffix.lower() == ".nc":
        if asked.settings:
            raise InputError("report", [f"{asked.robot!r} is finished; it takes no {asked.settings[0]!r}; leave the settings out"])
        return _kept(path, asked.title, typed)
    study = subject(asked.robot, asked.settings)
    robot = study.robot()

    from stickslip.show.reports.run import run_page
    from stickslip.solvers import solve

    run = solve(robot, **study.options, keep="trajectory")
    return run_page(run, asked.title or study.title(), typed, study.dimensionless), f"one run of {study.title()}"


def _kept(path: Path, title: str | None, typed: str) -> tuple[str, str]:
    """The page on a folder or a file of results."""
    from stickslip.show.reports.run import run_page
    from stickslip.show.reports.study import study_page

    if path.is_dir() or not is_run(path, "report"):
        from stickslip.studies import open_study

        grid = open_study(path)
        return study_page(grid, title or path.name, typed), f"{show.counted(int(grid['mean_velocity'].size), 'case')} in {path}"

    from stickslip.results.loading import load

    return run_page(load(path), title or path.name, typed), f"the run in {path}"
