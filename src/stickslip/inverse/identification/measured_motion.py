"""Which channels of a record say how a contact or a machine moved, and the motion behind them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import ArrayLike
from stickslip.basics.errors import InputError
from stickslip.inverse.identification.smoothing import EDGES, MotionChannel, Smooth, channel, edges_too_few, smoothed

if TYPE_CHECKING:
    from stickslip.records.record import Record


_DISAGREE = 1.5  # times their noise by which channels of one motion may differ
_LOOKED = 6  # repetitions that tell the noise of a velocity
_ORDERS = {"position": 0, "velocity": 1, "acceleration": 2}
_SAID = ("", "/s", "/s²")


def motion_behind(rec: Record) -> tuple[Smooth | None, list[str]]:
    """The motion behind the position, velocity and acceleration of a record, and what to say of it; None where its noise is nothing.

    `InputError` for a position of so few counts that it shows no motion: between them a contact would be taken to rest.
    """
    channels = {order: rec[role] for role, order in _ORDERS.items() if role in rec}
    if 0 in channels and len(np.unique(channels[0].si[np.isfinite(channels[0].si)])) == 1:
        what = f"{channels[0].name} does not change in {len(channels[0])} samples"
        raise InputError("identify", [f"{what}; allowed is a motion; a longer record, longer strokes or a finer encoder show it"])
    own = {order: made for order, c in channels.items() if (made := channel(order, c.time, c.si)) is not None}
    first = min(own, default=2)
    if first == 2:
        return None, []
    if len(own) == 1 and (edges := edges_too_few(channels[first].si)) is not None:
        what = f"{channels[first].name} changes {edges} times in {len(channels[first])} samples"
        advice = f"allowed are {EDGES} times or more; a longer record, longer strokes or a finer encoder show the motion"
        raise InputError("identify", [f"{what}: so few counts of an encoder do not; {advice}"])
    motion = smoothed((own[first],))
    if motion is None:
        return None, []
    used, notes = [own[first]], []
    for order in (o for o in sorted(own) if o > first):
        calibrated = _calibrated(own[order], motion)
        if calibrated is None:
            notes.append(f"the {channels[order].name} does not agree with the {channels[first].name} within its noise and is not used")
        else:
            used.append(calibrated)
            motion = smoothed(tuple(used)) or motion
    unit = channels[first].unit or ""
    size = motion.noise[first] / (float(np.median(abs(channels[first].si[np.isfinite(channels[first].si)]))) or 1.0)
    noise_text = f"noise of the {channels[first].name} {_shown(motion.noise[first], channels[first])} {unit}".rstrip()
    combined = "".join(f", with the {channels[c.order].name}" for c in used[1:])
    if size > 0:
        ends = f"{motion.end:.2g} s at either end are left out"
        notes.append(f"the motion is smoothed to a bandwidth of {motion.bandwidth:.3g} Hz{combined} ({noise_text}); {ends}")
    return motion, notes


def _shown(value: float, c: Any) -> str:
    """A number in SI in the unit of a channel."""
    scale = float(np.nanmax(abs(c.si))) / (float(np.nanmax(abs(np.asarray(c.values, float)))) or 1.0)
    return f"{value / (scale or 1.0):.3g}"


def _calibrated(c: MotionChannel, motion: Smooth) -> MotionChannel | None:
    """A channel with the gain and the zero that another one gives it; None where it shows another motion."""
    if c.count:
        c = replace(c, count=0.0, sigma=float(np.hypot(c.sigma, c.count / np.sqrt(12))))
    expected = motion.at(c.t, c.order)
    columns = np.stack([expected, np.ones(len(c.t))], axis=1)
    (gain, zero), *_ = np.linalg.lstsq(columns, c.y, rcond=None)
    if not 0.5 < gain < 2.0:
        return None
    rest = float(np.std((c.y - zero) / gain - expected))
    open_ = float(np.std(motion.again(0).at(c.t, c.order) - expected))
    sigma = c.sigma / gain
    return replace(c, y=(c.y - zero) / gain, sigma=sigma) if rest <= _DISAGREE * np.hypot(sigma, open_) else None


def noise_of_velocity(motion: Smooth, t: ArrayLike) -> float:
    """Standard deviation of the velocity of a smoothed motion, over some instants."""
    here = motion.at(t, 1)
    return float(np.sqrt(np.mean([np.mean((motion.again(k).at(t, 1) - here) ** 2) for k in range(_LOOKED)])))
