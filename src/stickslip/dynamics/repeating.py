"""Whether a motion repeats, and how sure that is: a repeated strobe point, a slow transient, or neither."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.dynamics.diagrams import LONGEST, dying
from stickslip.dynamics.mapping import coordinates, strobe_orbit

__all__ = ["LONGEST", "Repetition", "repetition"]

Array = Any


@dataclass(frozen=True, eq=False)
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


def repetition(model: Any, state: Any, rtol: float = 1e-9, points: int = 96) -> Repetition:
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
    at = coordinates(model)
    kept = np.vstack([np.asarray(state, float)[None, :], strobe_orbit(model, np.asarray(state, float)[None, :], points, rtol)[0][:, 0]])
    tolerance = max(30 * rtol, 1e-9)
    best: tuple[float, int, float] | None = None
    for p in range(1, min(LONGEST, points // 3) + 1):
        miss = at.distance(kept[p:], kept[:-p])
        late, early = float(miss[-p:].max()), float(miss[-2 * p : -p].max())
        if late <= tolerance and not dying(kept, at.scales, p):
            return Repetition(p, kept[-1], late, f"the last {points} strobe points repeat after {p} within {late:.1e} of their scales")
        if best is None or late < best[0]:
            best = (late, p, late / early if early > 0 else 1.0)
    late, p, ratio = best or (np.inf, 1, 1.0)
    if shorter := int(dying(kept, at.scales, p)):  # it swings around a motion of a shorter period
        p, miss = shorter, at.distance(kept[shorter:], kept[:-shorter])
        late, ratio = float(miss[-p:].max()), float(miss[-p:].max() / miss[-2 * p : -p].max())
    if late < 0.1 and 0.0 < ratio < 1.0 and _steady(at.distance(kept[p:], kept[:-p])[p - 1 :: p]):
        more = p * int(np.ceil(np.log(tolerance / late) / np.log(ratio)))
        about = f"about {more} more periods to settle"
        why = f"it moves towards period {p}, but is still {late:.1e} away: a slow transient (ratio {ratio:.4g}); {about}"
    else:
        why = f"the last {points} strobe points do not repeat within {LONGEST} periods (nearest: {late:.1e} after {p})"
    return Repetition(None, kept[-1], late, why)


def _steady(miss: Array) -> bool:
    """Whether distances shrink geometrically: every one is smaller than the one before, over the last half."""
    late = miss[len(miss) // 2 :]
    return len(late) > 2 and bool(np.all(np.diff(late) < 0))
