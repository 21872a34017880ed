"""How near a machine at rest is to being moved, which says where to look where all mean velocities are 0."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import StickslipError
from stickslip.models.machine_adapter import machine_of

_POINTS = 256  # of a period


def nearness(machines: Any, count: int, forwards: bool) -> Array | None:
    """The largest force on a body at rest, in one direction, as a part of that which friction holds: array (count,).

    It is above 1 where the body moves. None of machines of several contacts, and of laws that have no such force.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.Robot(0.8, 0.2, ss.Harmonic(amplitude=1e-4, omega=100.0), ss.Coulomb(0.1, 0.3))
    >>> round(float(nearness(robot, 1, forwards=True)[0]), 4)  # 0.2 A omega^2 / (0.1 g)
    0.2039
    """
    mechanics = machine_of(machines).mechanics
    if mechanics.directions != ((1.0,),):
        return None
    T = np.broadcast_to(np.asarray(machines.period, float), (count,))
    t = np.arange(_POINTS)[:, None] / _POINTS * T
    try:
        limits = mechanics.laws[0].limits(mechanics.loads(t, (0.0,))[0])
        force = mechanics.masses[0] * mechanics.accelerations(t, (0.0,), (0.0,), (0.0,))[0]
    except (StickslipError, TypeError):
        return None
    if limits is None:
        return None
    back, ahead = (abs(np.asarray(limit, float)) for limit in limits)
    with np.errstate(invalid="ignore", divide="ignore"):
        part = force / ahead if forwards else -force / back
    return np.nanmax(np.broadcast_to(part, t.shape), axis=0)
