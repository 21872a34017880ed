"""Contacts that lose contact when their load falls to zero, and land again."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.solvers.plain.plain_equations import SHORT, ContactModes, Equations


def begun_aloft(e: Equations, t: float, y: ArrayLike) -> frozenset[int]:
    """The contacts that begin a run in flight: above what they rub on, moving away from it, or pulled off it."""
    loads = e.loads(t, y)
    return frozenset(i for i in e.flying if any(v > 0.0 for v in e.z(y, i)) or loads[i] <= 0.0)


def turned_aloft(e: Equations, t: float, y: Any, mode: ContactModes, rows: list[int]) -> ContactModes:
    """Sides to which slips go that are zero in flight."""
    rates = e.slip_rates(t, y, mode.moved(dict.fromkeys(rows, 1)))
    return mode.moved({i: 1 if rates[i] >= 0.0 else -1 for i in rows})


def taken_off(e: Equations, t: float, y: ArrayLike, mode: ContactModes, rows: list[int]) -> ContactModes:
    """The mode once some contacts have left."""
    mode = replace(mode, aloft=mode.aloft | set(rows))
    return turned_aloft(e, t, y, mode, [i for i in rows if mode.sides[i] == 0])


def landed(e: Equations, t: float, y: Array, mode: ContactModes, i: int) -> tuple[Any, ContactModes, bool]:
    """State and mode after a hit across, with its impulse along; whether the slip has come to zero."""
    gap, c, e_n = e.inner[i][0], e.alone[i] or 0, float(e.laws[i].restitution)
    mass, side, speed = e.masses[c], mode.sides[i], -float(y[gap + 1])
    w, load = e.slips(t, *e.state(y))[i], e.loads(t, y)[i]
    rebound = e_n * max(speed, 0.0)
    over = load > 0.0 and 2.0 * rebound * mass <= SHORT * e.scale_of_time * load * (1.0 - e_n)
    rebound = 0.0 if over else rebound  # one that stays lands without it: the load makes up for the rebounds
    impulse = mass * (max(speed, 0.0) + rebound)
    lost = min(abs(w), _coefficient(e, i, side, w) * impulse / mass)
    stopped = lost >= abs(w)
    y[e.n + c] -= side * lost * e.rows[i][c]
    y[gap], y[gap + 1] = 0.0, rebound
    return y, replace(mode, aloft=mode.aloft - {i} if over else mode.aloft), stopped


def _coefficient(e: Equations, i: int, side: int, w: float) -> float:
    """The part of the sliding force that is proportional to the load [-]."""
    unit = e.first_loads[i] if e.first_loads[i] > 0.0 else 1.0
    return side * (e.sliding(i, side, w, 2.0 * unit) - e.sliding(i, side, w, unit)) / unit
