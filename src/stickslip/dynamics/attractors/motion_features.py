"""Features that distinguish attractors: kind, period number, means over whole motion periods, mean velocity."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.frozen_arrays import sealed
from stickslip.dynamics.attractors.kinds_of_motion import CHAOTIC, PERIODIC, STEADY
from stickslip.dynamics.attractors.motions_without_period import smooth_means
from stickslip.dynamics.attractors.period_numbers import POINTS, steady_velocity, whole_motions
from stickslip.dynamics.attractors.settled_motions import Settled
from stickslip.dynamics.exponents.closed_curves import smooth_weights

if TYPE_CHECKING:
    from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates


_SAME = 1e-4  # two motions whose features differ by less, in scales, are one
_SMOOTH = 1e-3  # of the spread: weighted means of one quasi-periodic motion differ by less
_ERRORS = 10.0  # times what two halves of a stretch differ by
_ROUNDING = 1e-13  # of the velocity scale: what rounding makes of the way of a motion that comes back
_COVERED = 0.5  # of the points of a chaotic motion lie among those of another start on the same attractor


@sealed
class Features:
    """Features of settled motions, one row for each start.

    Parameters
    ----------
    kind : array of str (cases,)
        As of `Settled`.
    period : array (cases,)
        Drive periods until a motion repeats; 0: it does not up to 32.
    mean_velocity : array (cases,)
        V [m/s].
    means : array (cases, features)
        Means and mean squares of the strobe points and the mean velocity, in scales; NaN of what was not solved.
    spread : array (cases, features)
        By how much the means of two starts on one motion without a period may differ, in scales.
    clouds : dict of array (points, coordinates)
        Strobe points of chaotic motions, in scales.
    """

    kind: Array
    period: Array
    mean_velocity: Array
    means: Array
    spread: Array
    clouds: dict[int, Array]

    def distance(self, i: int, others: Array) -> Array:
        """How far the means of some motions (features,) or (n, features) are from those of one, in scales."""
        return np.max(abs(others - self.means[i]), axis=-1)

    def same(self, i: int, other: Features, j: int) -> bool:
        """Whether motion i is motion j of these or other features.

        Periodic and quasi-periodic motions are by their means. Of chaotic ones these scatter, and more where a motion stays long in parts
        of its attractor: two are one if half of the points of either lie among those of the other, nearer than these lie to each other.
        """
        if self.kind[i] != other.kind[j] or self.period[i] != other.period[j]:
            return False
        if self.kind[i] == CHAOTIC and i in self.clouds and j in other.clouds:
            return max(_covered(self.clouds[i], other.clouds[j]), _covered(other.clouds[j], self.clouds[i])) >= _COVERED
        return bool(np.all(abs(other.means[j] - self.means[i]) < _SAME + np.maximum(self.spread[i], other.spread[j])))


def _covered(points: Array, among: Array) -> float:
    """The share of points that lie nearer to some others than most of these lie to each other."""
    from scipy.spatial import cKDTree

    tree = cKDTree(among)
    usual = float(np.quantile(tree.query(among, 2)[0][:, 1], 0.9))
    return float(np.mean(tree.query(points)[0] <= usual))


def features_of(T: Any, settled: Settled, at: Coordinates, by_phase: bool = False) -> Features:
    """Features of motions in drive periods T [s]; of models without a period (T is None) in returns, which take their own times.

    With `by_phase` the strobe is at another phase for each start, and only the mean velocity counts.
    """
    T = None if T is None else np.asarray(T, float)
    V = np.array(steady_velocity(settled.ways, settled.period, settled.times if T is None else T))
    if at.section is not None:
        V[abs(V) <= np.where(settled.kind == STEADY, _SAME, _ROUNDING) * at.speed] = 0.0
    means = _means(settled.points, settled.period, V, at, by_phase)
    spread, clouds, span = np.zeros_like(means), dict[int, Array](), None if T is None else np.broadcast_to(T, V.shape)
    for i, long in settled.long.items():
        if settled.kind[i] == PERIODIC and 0 < settled.period[i] <= POINTS // 2:
            continue
        took, weights = settled.long_times[i] if span is None else span[i], smooth_weights(len(long))
        V[i] = float(weights @ long[:, -1]) / (float(weights @ took) if span is None else took)
        points = _in_scales(long[None, :, :-1], at)[0]
        speeds = long[:, -1:] / (np.reshape(took, (-1, 1)) * at.speed)
        kept = speeds if by_phase else np.hstack([points, speeds])
        values, halves, widths = smooth_means(kept)
        n = kept.shape[1]
        row = values[:n] if by_phase else np.concatenate([values[: n - 1], values[n : 2 * n - 1], values[n - 1 : n]])
        width = _ERRORS * halves + _SMOOTH * widths
        means[i] = row
        spread[i] = width[:n] if by_phase else np.concatenate([width[: n - 1], width[n : 2 * n - 1], width[n - 1 : n]])
        if settled.kind[i] == CHAOTIC:
            clouds[i] = speeds if by_phase else points
    return Features(settled.kind, settled.period, V, means, spread, clouds)


def motion_numbers(motions: Features, good: Array) -> Array:
    """A number for each motion, in the order of the starts; -1 of starts that are on none."""
    number: Array = np.full(len(good), -1)
    first: list[int] = []
    for i in np.flatnonzero(good & np.isfinite(motions.means).all(axis=1)):
        same = [k for k, j in enumerate(first) if motions.same(int(i), motions, j)]
        number[i] = same[0] if same else len(first)
        if not same:
            first.append(int(i))
    return number


def _means(points: Array, period: Any, V: Array, at: Coordinates, by_phase: bool) -> Array:
    """Numbers that are the same for two starts on one motion, whichever of its periods they are in: means over whole ones, in scales."""
    speed = (V / at.speed)[:, None]
    if by_phase:
        return speed
    count = whole_motions(points.shape[1], period)[:, None]
    last = (np.arange(points.shape[1]) >= points.shape[1] - count)[..., None]
    scaled = np.where(last, _in_scales(points, at), 0.0)
    return np.hstack([scaled.sum(axis=1) / count, (scaled**2).sum(axis=1) / count, speed])


def _in_scales(points: Array, at: Coordinates) -> Array:
    """Strobe points as numbers that are the same where the states are: without shifts that are no other motion, angles on a circle."""
    numbers, scales = at.embedded(_without_shifts(points, at))
    return np.asarray(numbers / scales)


def _without_shifts(points: Array, at: Coordinates) -> Array:
    """Strobe points in which bodies that rest at every one of them have one place in common: where they stopped is chance.

    The rests of several bodies that a spring joins come as continua, and all of one are one attractor.
    """
    if at.mechanics is None or at.mechanics.coordinates < 2 or at.inner_states:
        return points
    order, shifted = at.order, points.copy()
    still = np.all(points[..., order.velocities] == 0.0, axis=1)  # (cases, coordinates)
    first = np.argmax(still, axis=1)
    for body, j in zip(order.kept, range(order.places.start, order.places.stop), strict=True):
        chance = still[:, body] & (first != body if order.cyclic else True)
        shifted[chance, :, j] = 0.0
    return shifted
