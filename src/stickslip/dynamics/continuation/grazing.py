"""Stops that a motion just reaches, or just misses: where a branch of motions ends at one, it is said."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.flow import is_flow
from stickslip.machine_adapter import machine_of

__all__ = ["grazed"]

Array = Any
_NEAR = 1e-5  # of the largest gap in the motion: what is missed by less is grazed
_SLOW = 1e-3  # of the velocity scale: a hit that slow is one that begins
_HALVINGS = 50


def grazed(orbit: Any) -> str:
    """Name of a stop that a motion grazes, by a hit without speed or by missing it by nothing; "" where there is none."""
    if is_flow(orbit.model) or machine_of(orbit.model).is_single:
        return ""
    machine, run = machine_of(orbit.model), orbit.run.parted
    speed = float(machine.velocity_scale)
    slow = [event.part for event in run.events if event.kind == "hit" and abs(event.velocity) < _SLOW * speed]
    for name, stop in machine.mechanics.named_stops:
        if name in slow or _least_gap(run, machine.mechanics, stop) < _NEAR:
            return str(name)
    return ""


def _least_gap(run: Any, mechanics: Any, stop: Any) -> float:
    """The smallest gap at which a stop is turned away from without being touched, over the largest one."""

    def gap_and_rate(t: Array) -> tuple[Array, Array]:
        x, v, _ = run._states_at(t, run._index(t))
        q, u = mechanics.coordinates_of(tuple(x.T)), mechanics.coordinates_of(tuple(v.T))
        return stop.gap(t, q), stop.rate(t, u)

    struck = [event.t for event in run.events if event.kind == "hit"]
    t = np.unique(run.t)
    gaps, rates = gap_and_rate(t)
    turns = np.flatnonzero((rates[:-1] < 0) & (rates[1:] >= 0) & ~np.isin(t[1:], struck))
    low, high = t[turns], t[turns + 1]
    for _ in range(_HALVINGS if len(turns) else 0):
        middle = 0.5 * (low + high)
        falling = gap_and_rate(middle)[1] < 0
        low, high = np.where(falling, middle, low), np.where(falling, high, middle)
    least = gap_and_rate(high)[0] if len(turns) else np.array([np.inf])
    return float(np.min(abs(least)) / np.max(abs(gaps)))
