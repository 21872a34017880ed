"""Features that distinguish attractors: period number, means over whole motion periods, mean velocity."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.contracts import Array
from stickslip.dynamics.attractors.bifurcation_diagrams import UNDONE, periods_of, steady_velocity, whole_motions
from stickslip.sealing import sealed

_SAME = 1e-4  # two motions whose features differ by less, in scales, are one
_ALIKE = 0.2  # the same of motions without a period, whose means over a stretch scatter


@sealed
class Features:
    """Features of settled motions, one row for each start.

    Parameters
    ----------
    period : array (cases,)
        Drive periods until a motion repeats; 0: none up to 32.
    mean_velocity : array (cases,)
        V [m/s].
    means : array (cases, features)
        Means and mean squares of the strobe points and the mean velocity, in scales; NaN of what was not solved.
    """

    period: Array
    mean_velocity: Array
    means: Array

    def distance(self, i: int, others: Array) -> Array:
        """How far the means of some motions (features,) or (n, features) are from those of one, in scales."""
        return np.max(abs(others - self.means[i]), axis=-1)

    def same(self, i: int, period: int, means: Array) -> bool:
        """Whether motion i is the one of this period and these means."""
        return bool(self.period[i] == period and self.distance(i, means) < (_SAME if period else _ALIKE))


def features_of(T: Any, points: Array, ways: Array, at: Any, rtol: float, by_phase: bool = False) -> Features:
    """Features of motions from their strobe points (cases, points, d) and ways (cases, points) [m] in drive periods T [s].

    With `by_phase` the strobe is at another phase for each start, and only the mean velocity counts.
    """
    period = periods_of(points, at.scales, max(1e-6, 100 * rtol))
    V = steady_velocity(ways, period, T)
    return Features(period, V, _means(points, period, V, at, by_phase))


def numbered(motions: Features, good: Array) -> Array:
    """A number for each motion, in the order of the starts; all motions without a period whose means lie near each other are one."""
    number: Array = np.full(len(good), -1)
    kept: list[int] = []
    for i in np.flatnonzero(good & np.isfinite(motions.means).all(axis=1)):
        same = [k for k, j in enumerate(kept) if motions.same(int(i), int(motions.period[j]), motions.means[j])]
        number[i] = same[0] if same else len(kept)
        if not same:
            kept.append(int(i))
    return number


def numbered_motions(
    T: Any, points: Array, ways: Array, good: Array, at: Any, rtol: float, by_phase: bool = False
) -> tuple[Array, Array, Array]:
    """Period, mean velocity, and the number of its motion, of every start; -1 for what has none."""
    motions = features_of(T, points, ways, at, rtol, by_phase)
    return np.where(good == UNDONE, UNDONE, motions.period), motions.mean_velocity, numbered(motions, good > 0)


def _means(points: Array, period: Array, V: Array, at: Any, by_phase: bool) -> Array:
    """Numbers that are the same for two starts on one motion, whichever of its periods they are in: means over whole ones, in scales."""
    speed = (V / at.speed)[:, None]
    if by_phase:
        return speed
    count = whole_motions(points.shape[1], period)[:, None]
    last = (np.arange(points.shape[1]) >= points.shape[1] - count)[..., None]
    scaled = np.where(last, _without_shifts(points, at) / at.scales, 0.0)
    return np.hstack([scaled.sum(axis=1) / count, (scaled**2).sum(axis=1) / count, speed])


def _without_shifts(points: Array, at: Any) -> Array:
    """Strobe points in which bodies that rest at every one of them have one place in common: where they stopped is chance.

    The rests of several bodies that a spring joins come as continua, and all of one are one attractor.
    """
    if at.mechanics is None or at.mechanics.coordinates < 2 or at.inner_states:
        return points
    order, found = at.order, points.copy()
    still = np.all(points[..., order.velocities] == 0.0, axis=1)  # (cases, coordinates)
    first = np.argmax(still, axis=1)
    for body, j in zip(order.kept, range(order.places.start, order.places.stop), strict=True):
        chance = still[:, body] & (first != body if order.cyclic else True)
        found[chance, :, j] = 0.0
    return found
