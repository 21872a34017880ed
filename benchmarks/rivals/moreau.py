"""Moreau's time stepping: velocities and impulses of one step, for any number of contacts and stops.

The step is not refined where a contact changes its mode; that is what makes it simple, and of first order. References: M. Jean, The
non-smooth contact dynamics method, Comput. Methods Appl. Mech. Eng. 177 (1999) 235-257; the midpoint for the gap is Moreau's.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numba import njit

Array = Any
SWEEPS = 200  # of Gauss-Seidel at most
SETTLED = 1e-14  # change of the velocities in a sweep, over the velocity scale


@cache
def stepper(force: Any, offset: Any, load: Any) -> Any:
    """The compiled loop over the steps of a machine with these functions."""

    @njit
    def run(q, u, h, steps, mass, rows, mu, static, stops, pressing, numbers, tiny):
        p, P = np.zeros(len(rows)), np.zeros(len(stops))
        stuck = np.zeros(len(rows), dtype=np.bool_)
        for n in range(steps):
            t = h * n
            q = q + 0.5 * h * u
            u = u + h * force(t + 0.5 * h, q, u, numbers) / mass
            b, N = offset(t + 0.5 * h, numbers), load(t + 0.5 * h, numbers)
            p[:], P[:] = 0.0, 0.0
            for _ in range(SWEEPS):
                most = 0.0
                for s in range(len(stops)):
                    if stops[s] @ q <= 0.0:  # closed at the midpoint: what comes nearer is stopped
                        new = max(P[s] - (stops[s] @ u) / (stops[s] ** 2 / mass).sum(), 0.0)
                        u, P[s], most = u + stops[s] * (new - P[s]) / mass, new, max(most, abs(new - P[s]) / mass.min())
                for i in range(len(rows)):
                    pressed = h * N[i] if pressing[i] < 0 else P[pressing[i]]
                    rise = static if stuck[i] else 1.0
                    wanted = p[i] + (rows[i] @ u + b[i]) / (rows[i] ** 2 / mass).sum()
                    limit = -mu[i, 1] * pressed if wanted < 0 else mu[i, 0] * pressed
                    new = wanted if abs(wanted) <= rise * abs(limit) else limit
                    u, p[i], most = u - rows[i] * (new - p[i]) / mass, new, max(most, abs(new - p[i]) / mass.min())
                if most <= tiny:
                    break
            for i in range(len(rows)):
                stuck[i] = abs(rows[i] @ u + b[i]) <= 100 * tiny
            q = q + 0.5 * h * u
        return q

    return run


def displacement(machine: Any, steps: int) -> float:
    """How far a machine goes, with so many steps in a period."""
    run = stepper(machine.force, machine.offset, machine.load)
    q = np.zeros(len(machine.mass))
    shape = machine.mass, machine.rows, machine.mu, machine.static, machine.stops, machine.pressing, machine.numbers
    end = run(q, machine.rates, machine.period / steps, steps * machine.periods, *shape, SETTLED * machine.speed)
    return float(machine.weights @ end)
