"""Whether a motion repeats, and how sure that is: a repeated strobe point, a slow transient, or neither."""

from __future__ import annotations

import numpy as np

from stickslip.basics.contracts import Array, Model, Numeric
from stickslip.basics.frozen_arrays import sealed
from stickslip.dynamics.attractors.period_numbers import LONGEST, array_period_number
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, strobe_orbit
from stickslip.results.recurrence import apart, approach


@sealed
class Repetition:
    """After how many drive periods a motion comes back, if it does.

    Parameters
    ----------
    period : int or None
        None: not within `LONGEST`, or not yet.
    state : array
        The last strobe state.
    miss : float
        How far the strobe point still is from itself after the period (or after the best candidate), in scales.
    why : str
        The evidence in a sentence.
    """

    period: int | None
    state: Array
    miss: float
    why: str


def repetition(model: Model, state: Numeric, rtol: float = 1e-9, points: int = 96) -> Repetition:
    """Look at the next strobe points from a state on.

    A point that comes back within 30 rtol counts as repeated. One that comes back nearly, each time a little nearer by a steady
    ratio, is a slow transient and no period yet: the sentence says how long it would take.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, mu0=0.04)
    >>> repetition(robot, [-0.002678177, -1.693357e-7]).period
    2
    """
    at, tolerance = coordinates(model), max(30 * rtol, 1e-9)
    states, moved = strobe_orbit(model, np.asarray(state, float)[None, :], points, rtol)
    kept = np.column_stack([np.cumsum(moved[:, 0]), states[:, 0]])
    period, last = array_period_number(kept, at.scales, tolerance)[0], points - 1
    if period:
        miss = apart(kept, last, period, 1, at.scales)
        why = f"the last {points} strobe points repeat after {period} within {miss:.1e} of their scales"
        return Repetition(period, states[-1, 0], miss, why)
    p = approach(kept, last, last, LONGEST, at.scales)
    if p and (reason := _transient(kept, p, at.scales, tolerance)):
        return Repetition(None, states[-1, 0], apart(kept, last, p, 1, at.scales), reason)
    misses = [(apart(kept, last, p, 1, at.scales), p) for p in range(1, min(LONGEST, points // 3) + 1)]
    miss, p = min(misses)
    why = f"the last {points} strobe points do not repeat within {LONGEST} periods (nearest: {miss:.1e} after {p})"
    return Repetition(None, states[-1, 0], miss, why)


def _transient(kept: Array, p: int, scales: Array, tolerance: float) -> str:
    """A sentence on points that close in on a motion of period p; empty where they do not."""
    last = len(kept) - 1
    late, early = (apart(kept, last - k * p, p, 1, scales) for k in (0, 1))
    ratio = late / early if early > 0 else 1.0
    if not (late < 0.1 and 0.0 < ratio < 1.0):
        return ""
    more = p * max(int(np.ceil(np.log(tolerance / late) / np.log(ratio))), 1)
    about = f"about {more} more periods to settle"
    return f"it moves towards period {p}, but is still {late:.1e} away: a slow transient (ratio {ratio:.4g}); {about}"
