"""Exponents of directions that are lost: those that a rest, a controller's sample or a switch wipes out, and those below rounding."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.dynamics.exponents.general_exponents import Lyapunov, gathered

_ROUNDING = 1e-12  # a direction that shrinks by more than this beside another in a period is lost in its digits

_FORGOTTEN = (
    "at rest, at a controller's sample, or where a law sets its state anew, the one before is forgotten: a multiplier of exactly 0, or "
    "beside it one below 1e-12 in a period"
)

_TOUCHED = (
    "a switch is touched without being crossed, as by a state that stays at a limit where the equations change: there they have no "
    "derivative, and the exponents are not known; type ss.dynamics.largest_exponents(machine) for the largest, from neighbours"
)


def summary(logs: Array, time: float = 1.0, unit: str = "drive period") -> Lyapunov:
    """The result; an exponent that is -inf in any period is -inf, comes last, and has no error."""
    dead = np.isneginf(logs).any(axis=0)
    with np.errstate(invalid="ignore"):
        exponents = gathered(np.where(dead, -np.inf, logs), time, unit)
    if np.isnan(logs).any():
        return replace(exponents, note=_TOUCHED)
    if not dead.any():
        return exponents
    return replace(exponents, errors=np.where(np.isneginf(exponents.spectrum), 0.0, exponents.errors), note=_FORGOTTEN)


def with_lost(logs: Array, volume: float, rests: int) -> Array:
    """The growth in a period: -inf of what rest ends, and of what is lost below rounding an equal part of what the volume leaves over.

    A volume that is lost leaves nothing over: then what is lost below rounding is so for good.
    """
    lost = logs < logs.max() + np.log(_ROUNDING)
    if rests or np.isneginf(volume):
        logs[-max(int(rests), 1) :] = -np.inf
        logs[lost & np.isneginf(volume)] = -np.inf
        return logs
    if lost.any() and np.isfinite(volume):
        logs[lost] = (volume - logs[~lost].sum()) / lost.sum()
    return logs
