"""The kinds of machines that `fit` knows, in the order in which a file is taken for one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from stickslip.basics.errors import InputError, did_you_mean
from stickslip.inverse.logs.commanded_servos import CommandedServo
from stickslip.inverse.logs.machines import JointLog, Kind, Rig, Shaken, Slider, over_time
from stickslip.inverse.logs.tables import Bench, Speeds

if TYPE_CHECKING:
    from stickslip.records.record import Record

KINDS: tuple[Kind, ...] = (Rig(), Slider(), JointLog(), CommandedServo(), Shaken(), Bench(), Speeds())


def kinds_for(records: Sequence[Record]) -> dict[str, tuple[Kind, str]]:
    """The kinds that records may be of, each with what speaks for it."""
    reasons = {kind.name: (kind, [over_time(rec) == kind.timed and kind.suits(rec) for rec in records]) for kind in KINDS}
    return {name: (kind, str(why[0])) for name, (kind, why) in reasons.items() if all(why)}


def kinds_but_for_times(records: Sequence[Record]) -> list[Kind]:
    """The kinds that records without times would be of if they had them."""
    if any(map(over_time, records)):
        return []
    return [kind for kind in KINDS if kind.timed and all(kind.suits(rec) for rec in records)]


def kind_named(name: str) -> Kind:
    """The kind of a name that was typed."""
    known = {kind.name: kind for kind in KINDS}
    if name not in known:
        raise InputError("fit", [f"machine = {name!r}; {did_you_mean(name, known)}"])
    return known[name]
