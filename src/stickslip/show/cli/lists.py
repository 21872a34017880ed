"""What ``stickslip presets``, ``laws``, ``drives`` and ``mechanisms`` share: what there is, and the arguments it takes."""

from __future__ import annotations

import importlib
import inspect
import re
from typing import TYPE_CHECKING, Any

from stickslip.basics.arguments import described_arguments
from stickslip.basics.errors import InputError, did_you_mean
from stickslip.basics.quantities import symbol_text
from stickslip.show.cli import show
from stickslip.show.cli.docstrings import first_line, meanings
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


_LISTED = {"presets": ("presets", "PRESETS"), "laws": ("friction", "LAWS"), "mechanisms": ("mechanisms", "MECHANISMS")}
_FEW = 4  # lists of at most this many entries show every argument


def listing(asked: Namespace) -> Outcome:
    """What there is, or those that are named."""
    command, known = asked.command, things(asked.command)
    unknown = [f"{name!r} is not known; {did_you_mean(name, known)}" for name in asked.names if name not in known]
    if unknown:
        raise InputError(command, unknown)
    entries = {name: _entry(known[name]) for name in asked.names or known}
    if asked.names or len(entries) <= _FEW:
        return Outcome({command: entries}, lambda: "\n".join(_text(name, entry) for name, entry in entries.items()))
    brief = show.facts((name, entry["about"]) for name, entry in entries.items())
    return Outcome({command: entries}, f"{brief}\nstickslip {command} NAME explains one of them, --json all.")


def _text(name: str, entry: dict[str, Any]) -> str:
    rows = [[n, a["symbol"], a["unit"], _default(a), a["meaning"]] for n, a in entry["arguments"].items()]
    lines = show.aligned_table(["name", "symbol", "unit", "default", "meaning"], rows).splitlines()
    return "\n".join([f"{name}: {entry['about']}", *(f"  {line}" for line in lines)])


def things(command: str) -> dict[str, Any]:
    """The entries of a list, by name."""
    if command in _LISTED:
        module, name = _LISTED[command]
        return dict(getattr(importlib.import_module(f"stickslip.{module}"), name))
    from stickslip.models.robot import Robot

    return dict(Robot.part_kinds["drive"])


def _entry(thing: Any) -> dict[str, Any]:
    """First line of the docstring; and for each argument its default, symbol, unit and meaning."""
    documented, described = meanings(thing), described_arguments(thing)
    arguments = {}
    for p in inspect.signature(thing).parameters.values():
        words = documented.get(p.name, {"type": "", "unit": "", "meaning": ""})
        same = re.fullmatch(r"As for (\w+)\.", words["meaning"])
        if same:
            words = meanings(things("presets")[same[1]])[p.name]
        of_field = described.get(p.name, {})
        if "label" in of_field and [t["meaning"] for t in documented.values()].count(documented.get(p.name, {}).get("meaning", "")) > 1:
            words = {**words, "meaning": f"{of_field['label']}. {words['meaning']}"}  # described together with others: add its own name
        needed = p.default is p.empty
        arguments[p.name] = {
            "needed": needed,
            "default": None if needed else p.default,
            "symbol": symbol_text(of_field.get("symbol", "")),
            **words,
        }
    return {"about": first_line(thing), "arguments": arguments}


def _default(argument: dict[str, Any]) -> str:
    if argument["needed"]:
        return "needed"
    value = argument["default"]
    return "optional" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)
