"""Period numbers of strobe points, and mean velocities over whole motions."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates
from stickslip.engine.texts import recurrence
from stickslip.results.recurrence import scales_of

LONGEST = 32  # largest period number that is looked for
POINTS = 64  # strobe points of a look
_RETURN = 1e-6  # strobe points closer than this, in scales, count as one


def return_tolerance(rtol: float) -> float:
    """How near strobe points come that count as one, in scales, by the tolerance of the run."""
    return max(_RETURN, 100 * rtol)


def rows_of_points(points: Array) -> Array:
    """Strobe points as `recurrence` takes them, the position first."""
    return np.column_stack([np.zeros(len(points)), points])


def periods_of(points: Array, scales: Array, tolerance: float = _RETURN) -> Array:
    """Period numbers of strobe points (..., points, d): the smallest after which all of them come back; 0 if none up to 32.

    What still settles, or swings ever closer around a motion of a part of the period, has none yet; see `stickslip.results.recurrence`.
    """
    cases = points.reshape(int(np.prod(points.shape[:-2])), *points.shape[-2:])
    return np.array([_lasting(rows_of_points(case), scales, tolerance) for case in cases], int).reshape(points.shape[:-2])


def _lasting(points: Array, scales: Array, tolerance: float) -> int:
    """The period number, if every point is on the motion, the first ones too."""
    p = array_period_number(points, scales, tolerance)[0]
    return p if p and (abs(points[p:, 1:] - points[:-p, 1:]) <= tolerance * scales).all() else 0


def array_period_number(points: Array, scales: Array, tolerance: float) -> tuple[int, int]:
    """`recurrence.period_number` of an array of strobe points, x first, up to period 32."""
    last = len(points) - 1
    return recurrence().period_number(points, last, last, LONGEST, scales_of(scales), tolerance, tolerance)


def long_period(long: Array, at: Coordinates, tolerance: float) -> int:
    """The period number of a stretch that repeats after more than 32 drive periods, 0 of others."""
    for p in range(LONGEST + 1, len(long) - POINTS):
        if at.distance(long[-1], long[-1 - p]) <= tolerance and np.all(at.distance(long[p:], long[:-p]) <= tolerance):
            return p
    return 0


def steady_velocity(ways: Array, period: Array, T: Any) -> Array:
    """Mean velocity [m/s] over the whole motion periods that ways [m] in drive periods T [s] hold (..., points); all where there is none.

    Of returns T is as ways are: each took its own time.

    Examples
    --------
    >>> float(steady_velocity(np.array([1.0, 3.0, 1.0]), np.array(2), 0.5))
    4.0
    """
    points = ways.shape[-1]
    count = whole_motions(points, period)
    whole = np.arange(points) < count[..., None]
    time = count * T if np.shape(T) != np.shape(ways) else np.where(whole, T, 0.0).sum(axis=-1)
    return np.where(whole, ways, 0.0).sum(axis=-1) / time


def whole_motions(points: int, period: Array) -> Array:
    """How many of so many drive periods make whole motion periods; all where there is no period, or one that is longer.

    Examples
    --------
    >>> whole_motions(64, np.array([0, 1, 3])).tolist()
    [64, 64, 63]
    """
    return np.where((period > 0) & (period <= points), points - points % np.maximum(period, 1), points)
