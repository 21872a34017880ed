"""Estimate of the work of a run from its numbers, before it begins; a run that would take too long is refused with a message."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from typing import Any

from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError
from stickslip.models.friction.law_adapter import LawAdapter
from stickslip.models.machine_adapter import machine_of
from stickslip.models.mechanics import Mechanics

#: Largest number of oscillations of the bristles in one drive period, and in a whole run, which may be shortened for it.
MOST, MOST_IN_ALL = 1000.0, 40_000.0
#: The explicit steps of a law without inner states are limited by its damping: at most this many decay times fit into a drive period.
MOST_DECAYS = 5000.0
#: Relative tolerance of the page's runs.
RTOL = 1e-4
#: Velocities at which the slope of friction is evaluated [m/s].
_SPEEDS = (1e-4, 1e-3, 1e-2, 0.1, 1.0)
#: Slopes are taken over this fraction of a typical deflection, and up to this velocity [m/s].
_PART, _SLOW = 1e-3, 1e-12


def effort(robot: Model) -> tuple[Any, Any]:
    """Oscillations of mass and bristles, and decay times of a damped law, in one drive period; arrays for a batch.

    Examples
    --------
    >>> import stickslip as ss
    >>> swings, decays = effort(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4))
    >>> round(float(swings), 1), decays
    (11.5, 0.0)
    """
    scale = machine_of(robot).time_scale  # an array where the period varies
    period = 1.0 if scale is None else scale
    contacts = [_of_contact(law, load, mass, period) for law, load, mass in _contacts(machine_of(robot).mechanics)]
    swings, decays = ([each[k] for each in contacts] for k in (0, 1))
    return _largest(swings), _largest(decays)


def _largest(values: list[Any]) -> Any:
    """The largest value for each case; 0 without contacts."""
    import numpy as np

    return functools.reduce(np.maximum, values) if values else 0.0


def _contacts(mechanics: Mechanics) -> Iterator[tuple[LawAdapter, Any, Any]]:
    """The law of each contact, its initial load, and the first mass that moves with it."""
    loads = mechanics.loads(0.0, mechanics.start[: mechanics.coordinates])
    for law, load, row in zip(mechanics.laws, loads, mechanics.directions, strict=True):
        yield law, load, mechanics.masses[next((c for c, g in enumerate(row) if g), 0)]


def _of_contact(law: LawAdapter, load: Any, mass: Any, period: Any) -> tuple[Any, Any]:
    """Oscillations of the bristles, and decay times, in a period."""
    import numpy as np

    swings = np.sqrt(np.maximum(_stiffness(law, load), 0.0) / mass) * period / (2 * math.pi) if law.dynamic else 0.0
    return swings, 0.0 if law.dynamic else _damping(law, load) / mass * period


def _stiffness(law: LawAdapter, load: Any) -> Any:
    """Stiffness of a contact at rest against a small displacement, from its inner states [N/m]."""
    z, mode, sizes = law.start(load), (0.0,) * law.modes, law.scale(load) or (1.0,) * law.states
    still, slow = (law.rate(v, z, load, mode) for v in (0.0, _SLOW))
    held, stiffness = law.force(0.0, z, still, load, mode), 0.0
    for i, size in enumerate(sizes):
        bent = (*z[:i], z[i] + _PART * size, *z[i + 1 :])
        stiffness += (law.force(0.0, bent, still, load, mode) - held) / (_PART * size) * (slow[i] - still[i]) / _SLOW
    return stiffness


def _damping(law: LawAdapter, load: Any) -> Any:
    """The largest slope of sliding friction over the speed [N s/m]."""
    import numpy as np

    rises = [(abs(law.sliding(2 * v, load)) - abs(law.sliding(v, load))) / abs(v) for speed in _SPEEDS for v in (speed, -speed)]
    return functools.reduce(np.maximum, rises, 0.0)


def too_much(swings: Any, decays: Any) -> Any:
    """Whether even a few periods of such a robot would take too long."""
    return (swings > MOST) | (decays > MOST_DECAYS)


def affordable(robot: Model, periods: int) -> int:
    """The number of periods, reduced if the bristles oscillate too fast; `InputError` if even a few periods would take too long."""
    swings, decays = map(float, effort(robot))
    if swings > MOST:
        how = "choose a higher frequency, a larger mass or softer bristles"
        raise InputError("run", [f"the bristles oscillate {swings:.4g} times in a drive period; allowed here are {MOST:g}; {how}"])
    if decays > MOST_DECAYS:
        how = "choose a higher frequency, a larger mass or less viscous friction"
        raise InputError("run", [f"viscous friction decays {decays:.4g} times in a drive period; allowed here are {MOST_DECAYS:g}; {how}"])
    return max(min(periods, int(MOST_IN_ALL / max(swings, 1.0))), min(periods, 40))
