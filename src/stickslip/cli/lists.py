"""``stickslip presets``, ``laws`` and ``drives``: what there is, and the arguments it takes."""

from __future__ import annotations

import inspect
from typing import Any

from stickslip.cli import show
from stickslip.cli.arguments import parser

__all__ = ["act"]


def act(command: str, words: list[str]) -> int:
    """Do the command."""
    parse = parser(command, f"List the {command} and their arguments.", robot=False)
    asked = parse.parse_args(words)
    found = {name: _entry(thing) for name, thing in _things(command).items()}
    if asked.json:
        show.print_json({command: found})
        return 0
    for name, entry in found.items():
        print(f"{name}: {entry['about']}")
        print(
            show.facts([(name, "needed" if default == "needed" else f"default {default}") for name, default in entry["arguments"].items()])
        )
    return 0


def _things(command: str) -> dict[str, Any]:
    if command == "presets":
        from stickslip.presets import PRESETS

        return PRESETS
    if command == "laws":
        from stickslip.friction import LAWS

        return dict(LAWS)
    from stickslip.drives import DRIVES

    return dict(DRIVES)


def _entry(thing: Any) -> dict[str, Any]:
    """First line of the docstring, and the arguments with their defaults."""
    parameters = inspect.signature(thing).parameters.values()
    arguments = {p.name: "needed" if p.default is p.empty else p.default for p in parameters}
    return {"about": (inspect.getdoc(thing) or "").partition("\n")[0], "arguments": arguments}
