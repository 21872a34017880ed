"""``stickslip presets``, ``laws`` and ``drives``: what there is, and the arguments it takes."""

from __future__ import annotations

import inspect
import re
from typing import Any

from stickslip.cli import show
from stickslip.cli.arguments import parser
from stickslip.cli.docstrings import about, meanings

__all__ = ["act"]

#: Argument -> the letter that it has in the paper's equations and in ours.
SYMBOLS = {
    "amplitude": "A", "omega": "ω", "frequency": "ω/2π", "tilt_deg": "θ", "mu0": "μ0", "f0": "f0", "mu_plus": "μ+", "mu_minus": "μ-",
    "f_plus": "f+", "f_minus": "f-", "sigma0": "σ0", "sigma1": "σ1", "sigma2": "σ2", "v_s": "v_s", "gravity": "g", "body_mass": "M",
    "inner_mass": "m", "voltage": "V", "length": "L", "thickness": "h1", "patch_length": "l0", "tip_mass": "m", "damping": "ζ",
}  # fmt: skip


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
        rows = [[n, a["symbol"], a["unit"], _default(a), a["meaning"]] for n, a in entry["arguments"].items()]
        print("\n".join(f"  {line}" for line in show.table(["name", "symbol", "unit", "default", "meaning"], rows).splitlines()))
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
    """First line of the docstring; and of each argument its default, symbol, unit and meaning."""
    from stickslip.sweeps.naming import AXES

    told = meanings(thing)
    arguments = {}
    for p in inspect.signature(thing).parameters.values():
        words = told.get(p.name, {"type": "", "unit": "", "meaning": ""})
        same = re.fullmatch(r"As for (\w+)\.", words["meaning"])
        if same:
            words = meanings(_things("presets")[same[1]])[p.name]
        if p.name in AXES and [t["meaning"] for t in told.values()].count(told.get(p.name, {}).get("meaning", "")) > 1:
            own = AXES[p.name][0].rpartition(" ")[0]  # described together with others: say which one it is
            words = {**words, "meaning": f"{own}. {words['meaning']}"}
        needed = p.default is p.empty
        arguments[p.name] = {"needed": needed, "default": None if needed else p.default, "symbol": SYMBOLS.get(p.name, ""), **words}
    return {"about": about(thing), "arguments": arguments}


def _default(argument: dict[str, Any]) -> str:
    if argument["needed"]:
        return "needed"
    value = argument["default"]
    return "optional" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)
