"""Which machines the compiled methods do not solve, and why; asked before anything is traced."""

from __future__ import annotations

from typing import Any

from stickslip.machine import machine_of

__all__ = ["refused"]


def _apart(stops: tuple[Any, ...]) -> bool:
    """Whether no two stops move the same body, but for the two ends of one way."""
    rows = {tuple(map(abs, stop.direction)) for stop in stops}
    return all(sum(column) <= 1.0 for column in zip(*rows, strict=True))


def refused(model: Any) -> str:
    """What of a machine the compiled methods do not solve; "" where they do.

    Examples
    --------
    >>> from stickslip.machines import Chain
    >>> refused(Chain.example())
    ''
    """
    m = machine_of(model).mechanics
    other = 'type method="dop853" (SciPy on the machine in plain Python: slower)'
    if not m.contacts:
        return f"it has no contact, so that nothing rubs; the compiled methods are for machines with friction; {other}"
    if not all(law.compiles for law in m.laws):
        return f"one of its laws is written for plain numbers only; {other}"
    if not _apart(m.stops):
        return f"several of its stops can be hit at one instant; {other}, or give the stops a stiffness"
    dynamic = [law.dynamic for law in m.laws]
    if any(dynamic) and not all(dynamic):
        return f"some of its laws rest exactly and others have inner states; {other}"
    if not all(dynamic) and any(sum(map(abs, row)) != 1.0 for row in m.directions):
        return f"bodies rub on one another under a law that rests exactly; {other}"
    if m.jumps and any(law.switching for law in m.laws):
        return f"its velocities jump and a law remembers; {other}"
    return ""
