"""Contacts that lose contact when their load falls to zero, and land again."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import SolveError
from stickslip.solvers.plain.deciding import ROUNDING
from stickslip.solvers.plain.plain_equations import SHORT, ContactModes, Equations, held


def begun_aloft(e: Equations, t: float, y: ArrayLike) -> frozenset[int]:
    """The contacts that begin a run in flight: above what they rub on, moving away from it, or pulled off it.

    What is pulled off and slips could also stay, where its own friction would press it: that it does not fly ends the run.
    """
    loads, slips = e.loads(t, y), e.slips(t, *e.state(y))
    borders = e.borders(t, y, ContactModes(tuple(int(np.sign(w)) for w in slips), ((),) * e.k))
    pulled = [i for i in e.flying if e.presses(t, y, i, loads[i]) <= 0.0 and (slips[i] == 0.0 or borders.get(i, 1.0) > 0.0)]
    return frozenset(i for i in e.flying if i in pulled or any(v > 0.0 for v in e.z(y, i)))


def turned_aloft(e: Equations, t: float, y: Any, mode: ContactModes, rows: list[int]) -> ContactModes:
    """Sides to which slips go that are zero in flight; points of bodies in the plane are not watched there."""
    if e.mechanics.joined:
        return mode.moved(dict.fromkeys(rows, 1))
    rates = e.slip_rates(t, y, mode.moved(dict.fromkeys(rows, 1)))
    return mode.moved({i: 1 if rates[i] >= 0.0 else -1 for i in rows})


def taken_off(e: Equations, t: float, y: ArrayLike, mode: ContactModes, rows: list[int]) -> ContactModes:
    """The mode once some contacts have left."""
    mode = replace(mode, aloft=mode.aloft | set(rows))
    return turned_aloft(e, t, y, mode, [i for i in rows if mode.sides[i] == 0])


def landed(e: Equations, t: float, y: Array, mode: ContactModes, i: int) -> tuple[Any, ContactModes, bool]:
    """State and mode after a hit across, with its impulse along; whether the slip has come to zero."""
    if e.mechanics.joined:
        return _landed_in_plane(e, t, y, mode, i)
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


def _landed_in_plane(e: Equations, t: float, y: Array, mode: ContactModes, i: int) -> tuple[Any, ContactModes, bool]:
    """The same of a point of a body in the plane."""
    (gap, _), e_n, n = e.inner[i], float(e.laws[i].restitution), e.n
    speed, (q, u) = -float(y[gap + 1]), e.state(y)
    stays, side = _hit(e, t, q, u, i, speed, 0.0)
    falling = -e.own.rising(i, e.time(t), q, stays, e.controlled(y))
    over = 2.0 * e_n * speed < SHORT * e.scale_of_time * (1.0 - e_n) * falling
    if not over:
        stays, side = _hit(e, t, q, u, i, speed, e_n)
    y[n : 2 * n], y[gap], y[gap + 1] = stays, 0.0, 0.0 if over else e_n * speed
    mode = replace(mode.moved({i: side} if side else {}), aloft=mode.aloft - {i} if over else mode.aloft)
    return y, mode, side == 0


def _hit(e: Equations, t: float, q: list[float], u: list[float], i: int, speed: float, restitution: float) -> tuple[list[float], int]:
    """Velocities after a hit, and the side of the slip: of rest, forwards and backwards the one that agrees with its own impulses."""
    t, n = e.time(t), e.n
    shape, w, before = e.own.shape(t, q, u), e.slips(t, q, u)[i], np.array(u)
    M, g, up = np.array(shape.M, float), np.array(shape.slips[i].row, float), np.array(shape.slips[i].point[1].slopes, float)
    still = w - float(g @ before)  # what the ground does to the slip
    A = np.zeros((n + 2, n + 2))
    A[:n, :n], A[:n, n], A[:n, n + 1], A[n, :n] = M, -up, g, up
    right = np.append(M @ before, [float(up @ before) + (1.0 + restitution) * speed, 0.0])
    per_load = {side: e.own.steepness(i, shape) * float(e.laws[i].sliding(held(w, side), 1.0)) for side in (1, -1)}
    for side in (0, 1, -1):
        A[n + 1], right[n + 1] = 0.0, 0.0 if side else -still
        if side:
            A[n + 1, n], A[n + 1, n + 1] = -per_load[side], 1.0
        else:
            A[n + 1, :n] = g
        after = np.linalg.solve(A, right)
        P, Q = after[n:].tolist()
        slack = ROUNDING * (abs(P) + abs(Q))
        agrees = side * (float(g @ after[:n]) + still) > 0.0 if side else per_load[-1] * P - slack <= Q <= per_load[1] * P + slack
        if agrees and P + slack >= 0.0:
            return after[:n].tolist(), side
    raise SolveError(f"no impulse of the contact {e.mechanics.contacts[i]!r} agrees with its hit at t = {t:.6g} s")


def _coefficient(e: Equations, i: int, side: int, w: float) -> float:
    """The part of the sliding force that is proportional to the load [-]."""
    unit = e.first_loads[i] if e.first_loads[i] > 0.0 else 1.0
    return side * (e.sliding(i, side, w, 2.0 * unit) - e.sliding(i, side, w, unit)) / unit
