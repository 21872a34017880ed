"""A model with constant sliding friction under a harmonic drive, in the numbers of its arcs.

The equations are those of the model and of its law: they are asked for numbers (resistance while sliding, limits of
rest), never typed again. The motion is v' = a sin(omega t) - r, with r = r_plus forwards and -r_minus backwards, at rest
while -s_minus <= a sin(omega t) <= s_plus.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.batch import rows_of
from stickslip.drives import Harmonic
from stickslip.fields import leaves, replace_leaf
from stickslip.forces import is_set_valued

__all__ = ["Arcs", "handles", "reduced"]

Array = Any
_SPEEDS = (1e-9, 1e-3, 1.0, 1e3)  # of the velocity scale: sliding friction must be the same at all of them


@dataclass(frozen=True, eq=False)
class Arcs:
    """A model in the numbers of its arcs; each is an array (cases,), accelerations in m/s^2.

    Parameters
    ----------
    drive : array
        a, the amplitude of the acceleration that the drive gives to a free body.
    omega, period : array
        Angular frequency [rad/s] and period [s] of the drive.
    resist_plus, resist_minus : array
        Deceleration while sliding forwards, and backwards (with gravity along the track).
    hold_plus, hold_minus : array
        Drive acceleration at which the body breaks away forwards, and backwards.
    along : array
        Acceleration of gravity along the track.
    """

    drive: Array
    omega: Array
    period: Array
    resist_plus: Array
    resist_minus: Array
    hold_plus: Array
    hold_minus: Array
    along: Array


def reduced(model: Any) -> Arcs:
    """The arcs' numbers of every case of a model, asked from its own equations.

    Examples
    --------
    >>> import stickslip as ss
    >>> arcs = reduced(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb"))
    >>> round(float(arcs.resist_plus[0] / arcs.drive[0]), 6)  # alpha_plus
    0.480458
    """
    flat = _flat(model)
    count = len(rows_of(model, ()))
    tick, x = np.zeros(count), np.zeros(count)
    load, law = flat.load(tick, x), flat.friction
    backward, forward = law.breakaway(load)

    def acceleration(t: Any, v: float, R: Any) -> Array:
        return np.broadcast_to(np.asarray(flat.acceleration(t, x, v, R), float), (count,)) + 0.0

    speed = float(np.max(flat.velocity_scale)) or 1.0
    along = acceleration(tick, 0.0, 0.0)
    return Arcs(
        drive=abs(acceleration(flat.period / 4, 0.0, 0.0) - along),
        omega=np.broadcast_to(flat.drive.omega, (count,)) + 0.0,
        period=np.broadcast_to(flat.period, (count,)) + 0.0,
        resist_plus=-acceleration(tick, speed, law.sliding(speed, load)),
        resist_minus=acceleration(tick, -speed, law.sliding(-speed, load)),
        hold_plus=-acceleration(tick, 0.0, forward),
        hold_minus=acceleration(tick, 0.0, backward),
        along=along,
    )


def _flat(model: Any) -> Any:
    """The model with every number an array (cases,)."""
    names = tuple(name for name, _ in leaves(model))
    table = rows_of(model, names)
    return replace_leaf(model, {name: np.ascontiguousarray(table[:, k]) for k, name in enumerate(names)})


def handles(model: Any) -> str | None:
    """None if this solver can solve the model, else the reason why it cannot.

    Examples
    --------
    >>> import stickslip as ss
    >>> handles(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb"))
    >>> handles(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4))
    'LuGre is a dynamic law (rate and force); exact arcs need a set-valued law (sliding and breakaway)'
    """
    law, name = model.friction, type(model.friction).__name__
    if not is_set_valued(law):
        return f"{name} is a dynamic law (rate and force); exact arcs need a set-valued law (sliding and breakaway)"
    if not isinstance(getattr(model, "drive", None), Harmonic):
        drive = f"the drive is {type(model.drive).__name__}" if hasattr(model, "drive") else f"{type(model).__name__} has no drive"
        return f"{drive}; exact arcs are closed formulas for Harmonic drives only"
    if not getattr(model, "cyclic", False):
        return f"position appears in the equations of {type(model).__name__}; exact arcs are for robots"
    if hasattr(model.track, "grip"):
        return f"the friction of {type(model.track).__name__} varies in time; exact arcs are closed formulas for a constant one only"
    return _unfit(_flat(model), name)


def _unfit(flat: Any, name: str) -> str | None:
    """What the numbers of a law forbid, if anything."""
    load, scale = flat.load(0.0, 0.0), float(np.max(flat.velocity_scale)) or 1.0
    ahead, back = (np.array([np.asarray(flat.friction.sliding(sign * scale * s, load), float) for s in _SPEEDS]) for sign in (1.0, -1.0))
    bound = 1e-14 * np.max(abs(np.stack([ahead, back])), axis=(0, 1))
    if np.any(np.ptp(ahead, axis=0) > bound) or np.any(np.ptp(back, axis=0) > bound):
        return f"the sliding friction of {name} depends on the speed; exact arcs are closed formulas for a constant one (Coulomb) only"
    lowest, highest = (np.asarray(limit, float) for limit in flat.friction.breakaway(load))
    if np.any(ahead[0] < back[0]):
        return f"the sliding friction of {name} feeds the motion; exact arcs need sliding(+v) >= sliding(-v)"
    if np.any(highest < ahead[0] - bound) or np.any(lowest > back[0] + bound):
        return f"{name} breaks away below its sliding friction; exact arcs need breakaway() at or beyond sliding()"
    return None
