"""``stickslip explore``: serve the page on which a robot's numbers are dragged, and open it."""

from __future__ import annotations

from collections.abc import Callable

from stickslip.cli.arguments import parser
from stickslip.errors import InputError

__all__ = ["act"]

_MORE = """\
example: stickslip explore --port 8765 --no-browser
         http://127.0.0.1:8765/

The page needs nothing from elsewhere. It is served to this machine alone, unless --host says otherwise: then its address carries a
token, and whoever has it may use this machine's processors. Ctrl-C ends it.
"""


def act(command: str, words: list[str]) -> int:
    """Do the command."""
    made = parser(command, "Open a page on which a robot's numbers are dragged, and its motion is seen at once.", robot=False, more=_MORE)
    made.add_argument("--port", metavar="N", default="8765", help="port to serve on; 0 takes a free one (8765)")
    made.add_argument("--host", metavar="HOST", default="127.0.0.1", help="where to listen (127.0.0.1: this machine alone)")
    made.add_argument("--workers", metavar="N", help="threads that compute (as many as there are processors, from 2 to 8)")
    made.add_argument("--no-browser", action="store_true", help="only print the address")
    asked = made.parse_args(words)
    port = _whole("--port", asked.port, 0, 65535, "8765")
    workers = None if asked.workers is None else _whole("--workers", asked.workers, 1, 64, "2")

    from stickslip.explorer.server import serve

    serve(asked.host, port, _announced(not asked.no_browser, asked.json), workers)
    return 0


def _whole(option: str, text: str, least: int, most: int, example: str) -> int:
    if not text.isascii() or not text.isdigit() or not least <= int(text) <= most:
        allowed = f"a whole number from {least} to {most}"
        raise InputError("explore", [f"{option} {text}; allowed is {allowed}; type for example {option} {example}"])
    return int(text)


def _announced(browser: bool, as_json: bool) -> Callable[[str], None]:
    """What to do with the address once the page can be opened."""

    def tell(address: str) -> None:
        from stickslip.cli.show import print_json

        if as_json:
            print_json({"address": address})
        else:
            print(address, flush=True)
        if browser:
            import webbrowser

            webbrowser.open(address)

    return tell
