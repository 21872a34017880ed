"""``stickslip check``: several methods, one robot, and the digits on which they agree."""

from __future__ import annotations

from stickslip.cli import show
from stickslip.cli.arguments import parser, subject

__all__ = ["act"]


def act(command: str, words: list[str]) -> int:
    """Do the command."""
    made = parser(command, "Solve one robot with several methods and report how many digits of its mean velocity are certain.")
    made.add_argument("--no-scipy", action="store_true", help="leave out scipy's integrator, which takes most of the time")
    asked = made.parse_intermixed_args(words)
    study = subject(asked.robot, asked.settings, solver=("periods", "duration", "rtol", "start.x", "start.v", "start.z"), strict=False)
    robot = study.robot()

    from stickslip.checking import check

    found = check(robot, scipy=not asked.no_scipy, progress=show.stages(quiet=True), **study.options)
    if asked.json:
        show.print_json({"robot": study.title(), **found.to_dict()})
    else:
        print(f"{study.title()}\n{found}")
    return 0
