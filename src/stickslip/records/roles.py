"""Roles of the channels of a record, and what users must know about them."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Any

import numpy as np

from stickslip.basics.phrases import counted
from stickslip.basics.units import parted_name, quantity_of, unit_named
from stickslip.records.candidates import candidate_unit, typed_units
from stickslip.records.channel import MEASURED, UNUSED, Channel
from stickslip.records.overview import clipped, dead_zone, runs_of
from stickslip.records.raw import RawColumn

_LARGEST, _LEAST = 1e18, 1e-100  # sizes beyond which a number is not a measurement
_TOGETHER = 1 << 16  # values that are judged at once, which takes little memory
_ROLE_WORDS = (
    (r"absolute.*", "absolute velocity"),
    (r"convected.*|body velocity", "velocity"),
    (r"normal.*|load|.*normal force.*", "load"),
    (r"drive.*|relative velocity|xi_rate", "drive"),
    (r"friction.*|force|kraft|torque|drehmoment", "force"),
    (r"weights?", "weight"),
    (r"(command|cmd|goal|target|set_?point|desired|commanded|soll)([ _](position|pos|angle|q))?", "command"),
    (r"(q|pos|position|angle)_(cmd|des|ref|target|soll)", "command"),
    (r"v|velocity|vel|geschwindigkeit", "velocity"),
    (r"x|position|pos|displacement|weg|angle|winkel", "position"),
)
#: The role of a channel whose unit alone says what it is.
_BY_UNIT = {name: name for name in ("velocity", "position", "force", "acceleration", "pressure", "voltage", "current")} | {
    "angular velocity": "velocity", "angle": "position", "angular acceleration": "acceleration", "torque": "force",
}  # fmt: skip
#: The columns of a run that we wrote, and what they are for; a table that has all of these is one.
OURS = {"x": "position", "v": "velocity", "acceleration": "acceleration", "xi": None, "xi_rate": "drive", "friction_force": "force"}


def roles_of(columns: list[RawColumn], typed: dict[str, str]) -> dict[str, str | None]:
    """Roles of channels: as typed, else as the file says, else as name and unit determine without doubt.

    A name says more than a unit, and what is typed most; of several joints the other channels are those of the one that was typed.
    """
    alias = {"convected velocity": "velocity"}
    ours = set(OURS) <= {c.name for c in columns}
    candidates = {c.name: (OURS.get(c.name), True) if ours and c.role is None else _role_and_why(c) for c in columns}
    named = {role for role, by_name in candidates.values() if by_name}
    roles = {name: None if role in named and not by_name else role for name, (role, by_name) in candidates.items()}
    given = {name: None if role == UNUSED else alias.get(role, role) for name, role in typed.items()}
    open_yet = {name: None if role in given.values() else role for name, role in roles.items()} | given
    return of_one_joint(open_yet, [name for name, role in given.items() if role is not None])


def of_one_joint(roles: dict[str, str | None], chosen: Collection[str]) -> dict[str, str | None]:
    """Roles, of which each that several channels may have goes to the one that shares most of its name with a chosen channel.

    Examples
    --------
    >>> names = {f"{joint}.{what}": what for joint in ("hip", "knee") for what in ("position", "velocity")}
    >>> [name for name, role in of_one_joint(names, ["knee.position"]).items() if role is not None]
    ['knee.position', 'knee.velocity']
    """
    words = {name: set(re.findall(r"[^\W\d_]+|\d+", name.lower())) for name in (*roles, *chosen)}
    kept = dict(roles)
    for role in {role for role in roles.values() if role is not None}:
        rivals = [name for name, own in roles.items() if own == role]
        own = [name for name in rivals if name in chosen]
        shared = {name: max((len(words[name] & words[each]) for each in chosen), default=0) for name in rivals}
        nearest = own or [name for name in rivals if shared[name] == max(shared.values())]
        kept |= dict.fromkeys(rivals, None) | {nearest[0]: role} if len(nearest) == 1 else {}
    return kept


def _role_and_why(c: RawColumn) -> tuple[str | None, bool]:
    """The role of a channel, and whether its name (or the file) determines it."""
    if c.role is not None:
        return c.role or None, True
    quantity, name = quantity_of(c.unit), parted_name(c.name)[0]
    for pattern, role in _ROLE_WORDS:
        if re.fullmatch(pattern, name, re.I) and (quantity is None or quantity in MEASURED[role]):
            return role, True
    return _BY_UNIT.get(quantity or ""), False


def remarks(channels: list[Channel]) -> list[str]:
    """Facts about these channels that a user must know before using them."""
    notes: list[str] = []
    bare = {c.name: c.values for c in channels if c.unit is None}
    if any(c.role is not None and c.unit is not None for c in channels):  # then a channel of no use, such as a temperature, takes no unit
        roles = {c.name: c.role for c in channels}
        bare = {name: values for name, values in bare.items() if roles[name] is not None or candidate_unit(name, values) != "1"}
    if bare:
        shown = ", ".join(map(repr, [*bare][:6])) + (", ..." if len(bare) > 6 else "")
        notes.append(f"no unit in the file for {shown}; type {typed_units(bare)} with the right one{'s' * (len(bare) > 1)}")
    for c in channels:
        if c.unit is not None and unit_named(c.unit) is None:
            notes.append(f"the unit {c.unit!r} of {c.name!r} is kept but not understood")
        if c.unit == "g":
            notes.append(f'{c.name!r} is in "g", read as grams; if it is multiples of gravity, type units={{"{c.name}": "g0"}}')
        if c.unit in ("lb", "lbs"):
            notes.append(f'{c.name!r} is in {c.unit!r}, read as pounds of mass; if it is a force, type units={{"{c.name}": "lbf"}}')
    axes = {id(c.t): c for c in channels}
    for c in axes.values():
        if c.over_time and c.axis_unit is None and c.axis_name != "sample":
            notes.append(f'no unit in the file for the time axis {c.axis_name!r}; type units={{"{c.axis_name}": "s"}} with the right one')
        if c.axis_name != "sample":  # a count has no gaps
            _remark_axis(c, notes)
    for c in channels:
        _remark_values(c, notes)
    return notes


def _remark_axis(c: Channel, notes: list[str]) -> None:
    steps = np.diff(c.t)
    back, missing = int((steps <= 0).sum()), int((~np.isfinite(c.t)).sum())
    if back:
        first = int(np.flatnonzero(steps <= 0)[0])
        notes.append(f"{c.axis_name} does not rise at {back} places, the first after {c.t[first]:.9g}")
    if missing:
        notes.append(f"{c.axis_name} is missing at {missing} samples")
    if c.gaps:
        longest = max(c.gaps, key=lambda g: g.length)
        count, unit = f"{len(c.gaps)} gap{'' if len(c.gaps) == 1 else 's'}", f" {c.axis_unit}" if c.axis_unit else ""
        notes.append(f"{count} in {c.axis_name}: the longest is {longest.length:.6g}{unit}, after {longest.start:.9g}{unit}")


def remark_range(c: Channel, notes: list[str]) -> None:
    """A sensor that reads no further, and one that reads nothing near zero."""
    if not c.over_time or c.values.dtype.kind != "f" or np.isinf(c.values).any():
        return
    if ends := clipped(c.values):
        notes.append(f"{c.name}: {ends} values sit at the end of its range: saturated? Leave them out with rec.masked(start, end)")
    if width := dead_zone(c.values):
        notes.append(f"{c.name}: nothing between zero and {width:.3g}{f' {c.unit}' if c.unit else ''}, and zero often: a dead zone?")


def _remark_values(c: Channel, notes: list[str]) -> None:
    missing, infinite = np.isnan(c.values), np.isinf(c.values)
    if missing.any():
        longest = int(np.diff(runs_of(missing)).max())
        notes.append(f"{c.name}: {counted(int(missing.sum()), 'value')} missing (NaN), the longest run has {longest}")
    if infinite.any():
        notes.append(f"{c.name}: {int(infinite.sum())} values are infinite")
    strange = sum(_senseless(c.values[begin : begin + _TOGETHER]) for begin in range(0, len(c.values), _TOGETHER))
    if strange:
        notes.append(f"{c.name}: {strange} values have sizes that no sensor gives: the file may be damaged, or its byte order wrong")


def _senseless(values: Any) -> int:
    """How many values are finite, and too large or too small for a measurement."""
    size = abs(values[np.isfinite(values)])
    return int(np.sum((size > _LARGEST) | ((size > 0) & (size < _LEAST))))
