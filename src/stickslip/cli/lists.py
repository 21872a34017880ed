"""``stickslip presets``, ``laws``, ``drives`` and ``mechanisms``: what there is, and the arguments it takes."""

from __future__ import annotations

import inspect
import re
from typing import Any

from stickslip.cli import show
from stickslip.cli.arguments import parser
from stickslip.cli.docstrings import about, meanings
from stickslip.errors import InputError, did_you_mean

__all__ = ["act", "things"]

_FEW = 4  # things of which every argument is shown at once

#: Argument -> the letter that it has in the paper's equations and in ours.
SYMBOLS = {
    "amplitude": "A", "omega": "ω", "frequency": "ω/2π", "tilt_deg": "θ", "mu0": "μ0", "f0": "f0", "mu_plus": "μ+", "mu_minus": "μ-",
    "f_plus": "f+", "f_minus": "f-", "sigma0": "σ0", "sigma1": "σ1", "sigma2": "σ2", "v_s": "v_s", "gravity": "g", "body_mass": "M",
    "inner_mass": "m", "voltage": "V", "length": "L", "thickness": "h1", "patch_length": "l0", "tip_mass": "m", "damping": "ζ",
}  # fmt: skip


def act(command: str, words: list[str]) -> int:
    """Do the command."""
    parse = parser(command, f"List the {command}; of those that are named, also their arguments.", robot=False)
    parse.add_argument("names", metavar="NAME", nargs="*", help=f"{command} to explain (default: a line on each)")
    asked = parse.parse_intermixed_args(words)
    known = things(command)
    unknown = [f"{name!r} is not known; {did_you_mean(name, known)}" for name in asked.names if name not in known]
    if unknown:
        raise InputError(command, unknown)
    symbols = {} if command == "mechanisms" else SYMBOLS  # their letters are their own
    found = {name: _entry(known[name], symbols) for name in asked.names or known}
    if asked.json:
        show.print_json({command: found})
    elif asked.names or len(found) <= _FEW:
        print("\n".join(_told(name, entry) for name, entry in found.items()))
    else:
        print(show.facts((name, entry["about"]) for name, entry in found.items()))
        print(f"stickslip {command} NAME explains one of them, --json all.")
    return 0


def _told(name: str, entry: dict[str, Any]) -> str:
    rows = [[n, a["symbol"], a["unit"], _default(a), a["meaning"]] for n, a in entry["arguments"].items()]
    lines = show.table(["name", "symbol", "unit", "default", "meaning"], rows).splitlines()
    return "\n".join([f"{name}: {entry['about']}", *(f"  {line}" for line in lines)])


def things(command: str) -> dict[str, Any]:
    """What the command lists, by name."""
    if command == "presets":
        from stickslip.presets import PRESETS

        return dict(PRESETS)
    if command == "laws":
        from stickslip.friction import LAWS

        return dict(LAWS)
    if command == "mechanisms":
        from stickslip.mechanisms import MECHANISMS

        return dict(MECHANISMS)
    from stickslip.robot import Robot

    return dict(Robot.part_kinds["drive"])


def _entry(thing: Any, symbols: dict[str, str]) -> dict[str, Any]:
    """First line of the docstring; and of each argument its default, symbol, unit and meaning."""
    from stickslip.sweeps.naming import AXES

    told = meanings(thing)
    arguments = {}
    for p in inspect.signature(thing).parameters.values():
        words = told.get(p.name, {"type": "", "unit": "", "meaning": ""})
        same = re.fullmatch(r"As for (\w+)\.", words["meaning"])
        if same:
            words = meanings(things("presets")[same[1]])[p.name]
        if p.name in AXES and [t["meaning"] for t in told.values()].count(told.get(p.name, {}).get("meaning", "")) > 1:
            own = AXES[p.name][0].rpartition(" ")[0]  # described together with others: say which one it is
            words = {**words, "meaning": f"{own}. {words['meaning']}"}
        needed = p.default is p.empty
        arguments[p.name] = {"needed": needed, "default": None if needed else p.default, "symbol": symbols.get(p.name, ""), **words}
    return {"about": about(thing), "arguments": arguments}


def _default(argument: dict[str, Any]) -> str:
    if argument["needed"]:
        return "needed"
    value = argument["default"]
    return "optional" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)
