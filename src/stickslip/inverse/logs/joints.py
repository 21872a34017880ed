"""Logs of several joints: which of them is proposed for a fit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from stickslip.records.roles import of_one_joint

if TYPE_CHECKING:
    from stickslip.records.channel import Channel
    from stickslip.records.record import Record

_MOVES = 0.1  # of the largest range of a channel like it, from which on a joint is one that moves


@dataclass(frozen=True)
class JointChoice:
    """The joint that is proposed of several.

    Parameters
    ----------
    roles : dict of str -> str
        A channel of it with its role, which as typed roles make the same choice; empty where a log is of one joint.
    others : dict of str -> str
        Channels of other joints, each with the role that it may have.
    """

    roles: dict[str, str] = field(default_factory=dict)
    others: dict[str, str] = field(default_factory=dict)


def of_first_joint(records: Sequence[Record], typed: dict[str, str]) -> tuple[Sequence[Record], JointChoice]:
    """Records with the roles of the first joint that moves alone; of one joint the records as they are.

    A log is of several joints where several channels may have each of two roles or more, and names tell which belong together.

    Examples
    --------
    >>> from stickslip.records import read
    >>> a, b = {"hip.pos [deg]": [0, 1, 0], "hip.cur [A]": [1, 0, 1]}, {"knee.pos [deg]": [5, 0, 5], "knee.cur [A]": [1, 2, 1]}
    >>> (record,), joint = of_first_joint([read({"t [s]": [0.0, 0.1, 0.2]} | a | b)], {})
    >>> joint.roles, record["current"].name, joint.others
    ({'hip.pos': 'position'}, 'hip.cur', {'knee.pos': 'position', 'knee.cur': 'current'})
    """
    first = records[0]
    open_roles = _open_roles(first)
    if len(open_roles) < 2:
        return records, JointChoice()
    role = next((each for each in ("position", "velocity") if each in open_roles), open_roles[0])
    ranges = {c.name: _range(c) for c in first.channels.values() if c.role == role}
    largest = max(ranges.values())
    moving = next((name for name, size in ranges.items() if size >= _MOVES * largest > 0), None)
    if moving is None:
        return records, JointChoice()
    alone = [_with_roles(rec, [*typed, moving]) for rec in records]
    if any(map(_open_roles, alone)):
        return records, JointChoice()
    pairs = [(c, other.channels[c.name]) for rec, other in zip(records, alone, strict=True) for c in rec.channels.values()]
    return alone, JointChoice({moving: role}, {c.name: c.role for c, now in pairs if c.role is not None and now.role is None})


def _range(c: Channel) -> float:
    values = c.si[np.isfinite(c.si)]
    return float(np.ptp(values)) if len(values) else 0.0


def _open_roles(rec: Record) -> list[str]:
    """Roles that several channels may have."""
    return [role for role, count in Counter(c.role for c in rec.channels.values()).items() if role is not None and count > 1]


def _with_roles(rec: Record, chosen: Sequence[str]) -> Record:
    roles = of_one_joint({c.name: c.role for c in rec.channels.values()}, chosen)
    return rec.replace(channels={name: replace(c, role=roles[name]) for name, c in rec.channels.items()})
