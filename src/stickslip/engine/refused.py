"""Which machines the compiled methods do not solve, and why; asked before anything is traced."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Model
from stickslip.models.machine_adapter import MachineAdapter, machine_of
from stickslip.models.mechanics import SOME, brakes_one

#: Contacts of one group, of which all combinations of rest and slip are tried.
MOST = 4


def _alone(directions: tuple[tuple[float, ...], ...]) -> bool:
    """Whether each contact brakes one coordinate, and no two the same."""
    return all(map(brakes_one, directions)) and all(sum(map(bool, column)) <= 1 for column in zip(*directions, strict=True))


def _apart(stops: tuple[Any, ...]) -> bool:
    """Whether no two stops move the same body, but for the two ends of one way."""
    rows = {tuple(map(abs, stop.direction)) for stop in stops}
    return all(sum(column) <= 1.0 for column in zip(*rows, strict=True))


def refused(model: Model) -> str:
    """The reason why the compiled methods refuse a machine; "" if they accept it.

    Examples
    --------
    >>> from stickslip.machines import Chain
    >>> refused(Chain.example())
    ''
    """
    return refusal_of(machine_of(model))


def refusal_of(machine: MachineAdapter) -> str:
    """The same of a machine's adapter, where it is at hand."""
    m = machine.mechanics
    other = 'type method="dop853" (SciPy on the machine in plain Python: slower)'
    if not all(law.compiles for law in m.laws):
        return f"one of its laws is written for plain numbers only; {other}"
    if not _apart(m.stops):
        return f"several of its stops can be hit at one instant; {other}, or give the stops a stiffness"
    dynamic = [law.dynamic for law in m.laws]
    if any(dynamic) and not all(dynamic) and (beside := _alone_only(machine)):
        return f"some of its laws rest exactly and others have inner states, and {beside}; {other}"
    reach = tuple((SOME,) * len(row) for row in m.directions) if m.joined else m.directions
    for group in groups_of(reach, [i for i, inner in enumerate(dynamic) if not inner]):
        rows = [m.directions[i] for i in group]
        alike = len(set(rows)) == 1 and brakes_one(rows[0])
        if not alike and not m.together and (len(group) > MOST or _rank(machine, group) < len(group)):
            names = ", ".join(m.contacts[i] for i in group)
            why = f"more than {MOST} of them" if len(group) > MOST else "and the slips of some follow from those of others"
            return f"bodies rub on one another under laws that rest exactly ({names}), {why}; {other}"
    if any(law.needs_applied for law in m.laws) and (m.joined or not _alone(m.directions) or m.coordinates < len(m.bodies)):
        return f"a law asks for the force that would hold its contact, and other contacts decide on that too; {other}"
    return ""


def _rank(machine: MachineAdapter, group: list[int]) -> int:
    """How many of the slips of some contacts do not follow from the others, in the case that has fewest."""
    m = machine.mechanics
    rows = [m.directions[i] for i in group]
    if any(SOME in row for row in rows):
        given = m.rows(0.0, m.start)
        each = np.array(np.broadcast_arrays(*(number for i in group for number in given[i])), float)
        rows = np.moveaxis(each.reshape(len(group), m.coordinates, -1), -1, 0)
    return int(np.min(np.linalg.matrix_rank(np.array(rows, float))))


def _alone_only(machine: MachineAdapter) -> str:
    """What a machine has that is not compiled where its laws are of both sorts, in words; "" if nothing."""
    laws = machine.laws
    if machine.mechanics.stops:
        return "it has a stop with restitution"
    if any(law.modes or law.switching for law in laws):
        return "one of them remembers"
    if any(law.needs_applied for law in laws):
        return "one of them asks for the force that would hold its contact"
    return "a contact flies" if any(law.flies for law in laws) else ""


def groups_of(directions: tuple[tuple[float, ...], ...], which: list[int]) -> list[list[int]]:
    """Contacts that act on one another in the same instant, because they share a coordinate: the blocks of G.

    Examples
    --------
    >>> groups_of(((1.0, 0.0, 0.0), (0.0, 1.0, -1.0), (0.0, 0.0, 1.0)), [0, 1, 2])
    [[0], [1, 2]]
    """
    moved = {i: [c for c, g in enumerate(directions[i]) if g] for i in which}
    by_coordinate: dict[int, list[int]] = {}
    for i, coordinates in moved.items():
        for c in coordinates:
            by_coordinate.setdefault(c, []).append(i)
    groups, placed = [], set[int]()
    for i in which:
        if i in placed:
            continue
        group = {i: None}  # grows while it is walked
        for k in (waiting := [i]):
            new = [n for c in moved[k] for n in by_coordinate[c] if n not in group]
            group |= dict.fromkeys(new)
            waiting += dict.fromkeys(new)
        placed |= group.keys()
        groups.append(sorted(group))
    return sorted(groups)
