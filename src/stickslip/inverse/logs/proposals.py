"""What a file is taken for: a line for each channel and each number, how it was decided, and the flag that changes it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from stickslip.basics.units import unit_of_heading
from stickslip.records.channel import ROLES

if TYPE_CHECKING:
    from stickslip.inverse.logs.joints import JointChoice
    from stickslip.records.record import Record


@dataclass(frozen=True)
class Proposal:
    """What one thing is taken for.

    Parameters
    ----------
    what : str
        A channel, or a number that is needed besides.
    taken : str
        What it is taken for.
    why : str
        How that was decided.
    flag : str
        What to type for another.
    """

    what: str
    taken: str
    why: str
    flag: str


HEAD = ("", "taken as", "because", "to change it")


def table(proposals: Sequence[Proposal]) -> str:
    """The proposals as a table of text.

    Examples
    --------
    >>> print(table([Proposal("x", "position [mm]", "its name", "--role x=ROLE")]))
       taken as       because   to change it
    x  position [mm]  its name  --role x=ROLE
    """
    rows = [HEAD, *((p.what, p.taken, p.why, p.flag) for p in proposals)]
    widths = [max(len(row[k]) for row in rows) for k in range(4)]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows)


def of_channels(rec: Record, units: dict[str, str], roles: dict[str, str], joint: JointChoice) -> list[Proposal]:
    """A line for the time axis and for each channel of a record, of which `units` and `roles` were typed and a `joint` was proposed."""
    lines, axes = [], dict.fromkeys((c.axis_name or "", c.axis_unit) for c in rec.channels.values() if c.axis_name != "sample")
    lines += [Proposal(name, f"time {_in(unit)}", _unit_why(name, unit, units), f"--unit {_word(name)}=UNIT") for name, unit in axes]
    for c in rec.channels.values():
        if c.role is None:
            why = "of another joint" if c.name in joint.others else "neither its name nor its unit says what it is for"
            lines.append(Proposal(c.name, "left out", why, f"--role {_word(c.name)}={joint.others.get(c.name, 'ROLE')}"))
            continue
        how = "role typed" if c.name in roles else "of the first joint that moves" if c.name in joint.roles else "role by name or unit"
        flags = f"--role {_word(c.name)}=ROLE --unit {_word(c.name)}=UNIT"
        lines.append(Proposal(c.name, f"{c.role} {_in(c.unit)}", f"{how}, {_unit_why(c.name, c.unit, units)}", flags))
    return lines


def _in(unit: str | None) -> str:
    return f"[{unit}]" if unit else "[no unit]"


def _unit_why(name: str, unit: str | None, units: dict[str, str]) -> str:
    if name in units:
        return "unit typed"
    if unit is None:
        return "unit missing"
    return "unit at the end of its name" if unit_of_heading(name)[1] == unit else "unit in the file"


def _word(name: str) -> str:
    """A name as a shell takes it."""
    return name if name.replace("_", "").replace(".", "").isalnum() else f'"{name}"'


def missing_units(rec: Record) -> list[str]:
    """Channels with a role, and time axes, whose unit is not known; nothing can be fitted before it is."""
    axes = {c.axis_name or "": c.axis_unit for c in rec.channels.values() if c.axis_name != "sample" and c.role in ROLES}
    return [c.name for c in rec.channels.values() if c.role in ROLES and c.unit is None] + [n for n, unit in axes.items() if unit is None]


def of_numbers(given: dict[str, Any], assumed: dict[str, tuple[str, str]]) -> list[Proposal]:
    """A line for each number that the user typed, and for each that was assumed: name -> (value in words, why)."""
    each = {name: value if isinstance(value, (list, tuple)) else [value] for name, value in given.items()}
    lines = [Proposal(name, ", ".join(f"{v:g}" for v in values), "typed", f"--set {name}=VALUE") for name, values in each.items()]
    return lines + [Proposal(name, value, why, f"--set {name}=VALUE") for name, (value, why) in assumed.items() if name not in given]
