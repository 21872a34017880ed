"""How much work a run will be, told from its numbers before it begins: what would take too long is refused with a sentence."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from typing import Any

from stickslip.errors import InputError
from stickslip.friction.law_adapter import LawAdapter
from stickslip.machine_adapter import machine_of
from stickslip.mechanics import Mechanics

#: Swings of the bristles in one drive period, at most; and at most in a whole run, which may hold fewer periods for it.
MOST, MOST_IN_ALL = 1000.0, 40_000.0
#: Explicit steps of a law without inner states follow its damping: this many times its decay fits into a drive period.
MOST_DECAYS = 5000.0
#: Relative tolerance of the page's runs.
RTOL = 1e-4
_DAMPINGS = ("viscous", "viscous_plus", "viscous_minus")


def effort(robot: Any) -> tuple[Any, Any]:
    """Swings of mass and bristles, and times of decay of a damped law, in one drive period; arrays for a batch.

    Examples
    --------
    >>> import stickslip as ss
    >>> swings, decays = effort(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4))
    >>> round(float(swings), 1), decays
    (11.5, 0.0)
    """
    scale = machine_of(robot).time_scale  # an array where the period varies
    period = 1.0 if scale is None else scale
    found = [_of_contact(law, mass, period) for law, mass in _contacts(machine_of(robot).mechanics)]
    swings, decays = ([each[k] for each in found] for k in (0, 1))
    return _largest(swings), _largest(decays)


def _largest(values: list[Any]) -> Any:
    """The largest for each case; 0 where there is no contact."""
    import numpy as np

    return functools.reduce(np.maximum, values) if values else 0.0


def _contacts(mechanics: Mechanics) -> Iterator[tuple[LawAdapter, Any]]:
    """Each contact's law, and the mass that first moves with it."""
    for law, row in zip(mechanics.laws, mechanics.directions, strict=True):
        yield law, mechanics.masses[next((c for c, g in enumerate(row) if g), 0)]


def _of_contact(law: LawAdapter, mass: Any, period: Any) -> tuple[Any, Any]:
    """Swings of the bristles, and times of decay, in a period."""
    import numpy as np

    swings = np.sqrt(getattr(law.law, "sigma0", 0.0) / mass) * period / (2 * math.pi)
    damping = 0.0 if law.dynamic else functools.reduce(np.maximum, (getattr(law.law, name, 0.0) for name in _DAMPINGS))
    return swings, damping / mass * period


def too_much(swings: Any, decays: Any) -> Any:
    """Whether even a few periods of such a robot would take too long."""
    return (swings > MOST) | (decays > MOST_DECAYS)


def affordable(robot: Any, periods: int) -> int:
    """As many periods as asked for, or as many fewer as the bristles' swings allow; `InputError` where even few would take too long."""
    swings, decays = map(float, effort(robot))
    if swings > MOST:
        how = "choose a higher frequency, a larger mass or softer bristles"
        raise InputError("run", [f"the bristles oscillate {swings:.4g} times in a drive period; allowed here are {MOST:g}; {how}"])
    if decays > MOST_DECAYS:
        how = "choose a higher frequency, a larger mass or less viscous friction"
        raise InputError("run", [f"viscous friction decays {decays:.4g} times in a drive period; allowed here are {MOST_DECAYS:g}; {how}"])
    return max(min(periods, int(MOST_IN_ALL / max(swings, 1.0))), min(periods, 40))
