"""``stickslip check``: several methods, one robot, and the digits on which they agree."""

from __future__ import annotations

from typing import Any

from stickslip.show.cli import show
from stickslip.show.cli.arguments import subject
from stickslip.show.cli.outputs import Outcome


def act(asked: Any) -> Outcome:
    """Do the command."""
    study = subject(asked.robot, asked.settings, solver=("periods", "duration", "rtol", "start.x", "start.v", "start.z"), strict=False)
    robot = study.robot()

    from stickslip.analysis.checking import check

    found = check(robot, scipy=not asked.no_scipy, progress=show.stages(quiet=True), **study.options)
    return Outcome({"robot": study.title(), **found.to_dict()}, f"{study.title()}\n{found}")
