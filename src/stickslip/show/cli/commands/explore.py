"""``stickslip explore``: open a page with a slider for each number of a robot."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError
from stickslip.show.cli.arguments import subject
from stickslip.show.cli.declaring import CODE, argument, command

if TYPE_CHECKING:
    from argparse import Namespace


@command(
    about="Open a page with a slider for each number of a robot, and see how it moves.",
    more="""\
With ROBOT the page opens with its numbers: a preset, a study file (such as the study.toml that the page saves), or a function of your own.
A chain, a bench, a machine or a robot with parts of your own has a page with a slider for each of its numbers. The page works without
a network. It is served to this machine only, unless --host says otherwise. Its address carries a token: whoever has it may use
this machine's processors, and nobody else. --no-token does without, for an address to be kept as a bookmark on a machine that has no
other users. Ctrl-C ends it.""",
    arguments=(
        *CODE,
        argument("robot", metavar="ROBOT", nargs="?", help="preset, TOML study file or module:function to begin with (optional)"),
        argument("settings", metavar="NAME=VALUE", nargs="*", default=[], help="numbers of the robot (optional)"),
        argument("--port", metavar="N", default="8765", help="port to serve on; 0 takes a free one (8765)"),
        argument("--host", metavar="HOST", default="127.0.0.1", help="where to listen (127.0.0.1: this machine only)"),
        argument("--workers", metavar="N", help="threads that compute (as many as there are processors, from 2 to 8)"),
        argument("--no-token", action="store_true", help="let every user of this machine use the page, at an address without a token"),
        argument("--no-browser", action="store_true", help="only print the address"),
    ),
    example="""\
$ stickslip explore --port 8765 --no-browser
http://127.0.0.1:8765/?token=…
""",
)
def act(asked: Namespace) -> int:
    """Do the command."""
    port = _whole("--port", asked.port, 0, 65535, "8765")
    workers = None if asked.workers is None else _whole("--workers", asked.workers, 1, 64, "2")
    fragment, shown = ("", None) if asked.robot is None else _opened(asked.robot, asked.settings)

    from stickslip.show.explorer.server import server_of

    tell = _announced(not asked.no_browser, asked.json, fragment)
    with contextlib.suppress(KeyboardInterrupt):  # how it is meant to end: its server has closed by then
        server_of(asked.host, port, tell, workers, not asked.no_token, shown=shown).run()
    return 0


def _opened(robot: str, words: list[str]) -> tuple[str, Any]:
    """The part of the address that shows a robot; or, if the page has no control for it, the machine for the general page."""
    study = subject(robot, words, strict=False)
    made = study.robot()

    from stickslip.show.explorer.from_robot import hash_of, state_of
    from stickslip.show.explorer.machines import Shown

    try:
        return hash_of(state_of(made)), None
    except InputError:
        from stickslip.show.reports.run import UNITLESS

        return "", Shown(made, study.title(), study.options, (UNITLESS,) if study.dimensionless else ())


def _whole(option: str, text: str, least: int, most: int, example: str) -> int:
    if not text.isascii() or not text.isdigit() or not least <= int(text) <= most:
        allowed = f"a whole number from {least} to {most}"
        raise InputError("explore", [f"{option} {text}; allowed is {allowed}; type for example {option} {example}"])
    return int(text)


def _announced(browser: bool, as_json: bool, fragment: str) -> Callable[[str], None]:
    """A function that prints the address, and opens it, once the page is ready."""

    def tell(root: str) -> None:
        address = root + fragment
        from stickslip.show.cli.show import print_json

        if as_json:
            print_json({"address": address})
        else:
            print(address, flush=True)
        if browser:
            import webbrowser

            webbrowser.open(address)

    return tell
