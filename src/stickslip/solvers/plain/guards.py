"""Guards: numbers that are positive until a mode ends."""

from __future__ import annotations

from typing import NamedTuple

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.solvers.plain.deciding import ROUNDING
from stickslip.solvers.plain.plain_equations import ContactModes, Equations

NOTHING = 1e-100  # a velocity that a body at rest gets from the least velocity at which laws are asked


class Guard(NamedTuple):
    """One of them.

    `sort` is "slip" (a slip velocity comes to zero), "load", "take-off" or "landing" of a contact that flies, "border" of the places
    where one load follows from the motion, "switch" of a memory, "limit" of what a resting row can bear, "gap" of an open stop, or
    "kink" of forces or loads; `part` and `which` say of what.
    """

    sort: str
    part: int
    which: int
    value: float
    noise: float  # rounding: nothing has happened before it lies this far below zero


def guards(e: Equations, t: float, y: Array, mode: ContactModes, with_noise: bool = True) -> list[Guard]:
    """All of a mode, in an order that the mode alone decides; without the noise of slips where nobody asks for it."""
    if (of_points := e.guards_of_points(t, y, mode)) is not None:
        return of_points
    q, u = e.state(y)
    w = e.slips(t, q, u)
    noise = e.noise_of_slips(t, q, u, w) if with_noise else [0.0] * len(w)
    guards = [
        Guard("slip", i, 0, side * w[i] + e.no_reversal[i], noise[i] or NOTHING)
        for i, side in enumerate(mode.sides[: e.k])
        if side and not (e.mechanics.joined and i in mode.aloft)
    ]  # fmt: skip
    guards += [_of_load(e, t, y, mode, i, load) for i, load in enumerate(e.least_loads(t, y, mode))]
    guards += [Guard("border", i, 0, border, 0.0) for i, border in e.borders(t, y, mode).items()]
    if e.switching:
        for i, load in enumerate(e.kept_positive(e.loads(t, y, mode))):
            guards += [Guard("switch", i, n, float(guard), 0.0) for n, (guard, _, _) in enumerate(e.switches(y, i, mode, w[i], load))]
    guards += _limits(e, t, y, mode)
    small = e.noise_of_gaps(q)
    guards += [
        Guard("gap", e.k + s, 0, gap, small)
        for s, gap in enumerate(e.gaps(t, q) if e.stops else [])
        if mode.sides[e.k + s]
    ]  # fmt: skip
    return guards + kinks_of(e, t, y, mode)


def _of_load(e: Equations, t: float, y: ArrayLike, mode: ContactModes, i: int, load: float) -> Guard:
    """Guards that end the touch of a contact, or its flight."""
    if i in mode.aloft:
        return Guard("landing", i, 0, e.z(y, i)[0], ROUNDING * 0.01 * e.scale_of_velocity * e.scale_of_time)
    if e.laws[i].flies:
        return Guard("take-off", i, 0, e.presses(t, y, i, load), 0.0)
    return Guard("load", i, 0, load + e.unpressed[i], 0.0)


def _limits(e: Equations, t: float, y: ArrayLike, mode: ContactModes) -> list[Guard]:
    if 0 not in mode.sides:
        return []
    R = e.motion(t, y, mode).R
    limits = e.limits(e.pressed(e.time(t), y, mode))
    limit_guards: list[Guard] = []
    for group in e.groups(mode.sides):
        for row, side, margin, size in group.margins([R[i] for i in group.rows], limits):
            limit_guards.append(Guard("limit", group.rows[0] if row is None else row, side, margin, ROUNDING * size))
    return limit_guards


def kinks_of(e: Equations, t: float, y: ArrayLike, mode: ContactModes) -> list[Guard]:
    """Those of conditions of forces and loads."""
    if not any(mode.kinks):
        return []
    kinks = []
    for what, (values, sides) in enumerate(zip(e.differences(t, y, mode.kinks), mode.kinks, strict=True)):
        largest = e.largest[what]
        for n, (value, side) in enumerate(zip(values, sides, strict=False)):
            largest[n] = max(largest.get(n, 0.0), abs(value))
            kinks.append(Guard("kink", what, n, value if side else -value, ROUNDING * largest[n]))
    return kinks
