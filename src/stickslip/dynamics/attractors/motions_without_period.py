"""What starts are that have no period within the limit: slow approaches, quasi-periodic, chaotic or not settled; see `settled_motions`."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np

from stickslip.basics.batch import cases_of, some_of
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, SolveError
from stickslip.dynamics.attractors.kinds_of_motion import CHAOTIC, PERIODIC, QUASI_PERIODIC, RUNS_AWAY, UNSETTLED
from stickslip.dynamics.attractors.period_numbers import LONGEST, long_period, return_tolerance
from stickslip.dynamics.attractors.starts_run_on import ERRORS, STRETCH, WatchedStarts
from stickslip.dynamics.exponents.closed_curves import smooth_weights, winding_number
from stickslip.dynamics.stroboscopic.differences import difference_jacobian
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, strobe_orbit, strobe_points

_AGREE = 1e-3  # of the spread: weighted means of two halves of a quasi-periodic motion differ by less
_ZERO = 1e-3  # per drive period: smaller exponents are not told from zero by a stretch
_LINEAR = 2.0  # times log(n)/n: the exponent of neighbours that part linearly in n periods, as on a torus with shear
_PRESERVED = 1e-4  # per drive period: mean logarithm of volumes of what neither shrinks nor grows
_VOLUMES = 16  # strobe points at which volumes are measured
_NEAR = 0.05  # in scales: a start that closes in on an orbit is nearer than this
_RATE = 0.5  # of the orbit's own rate: how fast it must close in at least
_CARRIED = 0.05  # of a difference from an orbit: how far it may be from what the derivative says of it
_SLOW = 3.0  # e-foldings of a stretch: an orbit that attracts more slowly
_TRIES = 4  # orbits that are looked for in a group, at most one for each start, and starts that are looked at for longer
_LONG = 2000  # strobe points of these
_EXPECTED = 5.0  # ends of transients that should have been seen, had the rate of before gone on, where none was: e^-5 < 1 %


def late_ends(watched: WatchedStarts, own: Array) -> str:
    """A reason why motions of a group that look chaotic may be transients: others that ended late. Empty where none did."""
    end, left = own[watched.end[own]], watched.kind[own] == UNSETTLED
    last = np.count_nonzero(watched.kind[end] != UNSETTLED)
    if last:
        return f"{last} of {len(end)} such starts settled within the last {STRETCH} drive periods: chaos may be a transient"
    half, here = np.count_nonzero(watched.half[own]), len(end)
    if half <= here or not here:
        return ""
    span = max(int(watched.run[own[left]].max()) - STRETCH, 2) / 2
    rate = (half - here) / (0.5 * (half + here) * span)
    if rate * here * STRETCH >= _EXPECTED:
        return ""
    return f"{half - here} of {half} such starts settled in the second half of the run: chaos may be a transient"


class GroupOfStarts:
    """Starts of one model without a period within the limit, and what they are."""

    def __init__(self, batch: Any, watched: WatchedStarts, rtol: float, rows: Array, late: str):
        self.of, self.rtol, self.rows, self.late = watched, rtol, rows, late
        self.model, self.at = cases_of(some_of(batch, rows[:1]))[0], watched.at.of(int(rows[0]))
        self.orbits: list[tuple[Array, float, Array]] = []
        self.tries, self.longer = 0, _TRIES

    def judge(self) -> None:
        """Say of each what it is."""
        volumes: dict[str, float] = {}
        for i in self.rows.tolist():
            kind, why = self._kind(i)
            if kind in (QUASI_PERIODIC, CHAOTIC):
                if kind not in volumes:
                    volumes[kind] = self._volumes(i)
                if abs(volumes[kind]) < _PRESERVED:
                    kind, why = UNSETTLED, "volumes of states are preserved: every start moves on a motion of its own, and none attracts"
            self.of.kind[i], self.of.why[i] = kind, why

    def _kind(self, i: int) -> tuple[str, str]:
        of, long = self.of, self.of.long[i]
        exponent, error = float(of.exponent[i]), float(of.error[i])
        if of.grows[i]:
            return RUNS_AWAY, ""
        if period := long_period(long[:, :-1], of.at, return_tolerance(self.rtol)):
            of.period[i], of.exponent[i], of.error[i] = period, np.nan, np.nan
            return PERIODIC, ""
        positive = exponent > max(ERRORS * error, _ZERO)
        if _agree(long, of.at) and exponent <= ERRORS * error + _LINEAR * np.log(len(long)) / len(long):
            if not positive and self._closes_in(i):
                return PERIODIC, ""
            if self._winds(long):
                return QUASI_PERIODIC, ""
            no_curve = "nor do its strobe points wind round one closed curve, as those of a quasi-periodic motion do"
            return UNSETTLED, f"after {of.run[i]} drive periods it does not repeat, neighbours do not part as in chaos, {no_curve}"
        if positive:
            return (UNSETTLED, self.late) if self.late else (CHAOTIC, "")
        if self._closes_in(i):
            return PERIODIC, ""
        return UNSETTLED, f"still moves after {of.run[i]} drive periods, and neither repeats nor is chaotic or quasi-periodic"

    def _winds(self, long: Array) -> bool:
        """Whether strobe points wind round one closed curve; some are looked at for longer, to tell a winding from a fraction beside it."""
        if winding_number(self._on_circles(long)) is not None:
            return True
        if not self.longer:
            return False
        self.longer -= 1
        more = strobe_orbit(self.model, long[-1:, :-1], _LONG - len(long), self.rtol, self.at)[0][:, 0]
        return winding_number(np.vstack([self._on_circles(long), self._on_circles(more)])) is not None

    def _on_circles(self, points: Array) -> Array:
        """What varies of strobe points, with angles as points on a circle: an angle that turns on makes a closed curve too."""
        states = points[:, : len(self.at.scales)]
        whole = self.at.embedded(states)[0]
        return whole[:, [*self.at.free, *range(states.shape[1], whole.shape[1])]]

    def _closes_in(self, i: int) -> bool:
        """Whether a start closes in on a stable orbit; if so, it has the strobe points of that orbit from now on."""
        of, long = self.of, self.of.long[i][:, :-1]
        for known in self.orbits:
            if _approaches(of.at, long, *known):
                return self._take(i, known)
        while self.tries < min(_TRIES, len(self.rows)) and (orbit := self._orbit(long)):
            self.orbits.append(orbit)
            return _approaches(of.at, long, *orbit) and self._take(i, orbit)
        return False

    def _orbit(self, long: Array) -> tuple[Array, float, Array] | None:
        """A stable orbit that a stretch approaches: strobe points, largest multiplier per drive period, derivative after a motion."""
        from stickslip.dynamics.periodic.periodic_orbits import derivative_of, orbit_near

        of = self.of
        self.tries += 1
        misses = [(float(of.at.distance(long[-1], long[-1 - p])), p) for p in range(1, LONGEST + 1)]
        for p in dict.fromkeys([1, min(misses)[1], 2]):
            with suppress(SolveError, InputError):
                orbit = orbit_near(self.model, p, long[-1], self.at)
                if orbit.stable:
                    state = np.asarray(orbit.strobe_state, float)[None, :]
                    points = np.vstack([state, strobe_points(self.model, state, p, self.rtol, self.at)[0][:-1, 0]]) if p > 1 else state
                    largest = float(np.max(abs(orbit.multipliers), initial=0.0)) ** (1.0 / p)
                    candidate = (points, largest, derivative_of(orbit, self.at))
                    if any(np.min(of.at.distance(points[0], other[0])) < 1e-6 for other in self.orbits):
                        continue
                    if _approaches(of.at, long, *candidate):
                        return candidate
        return None

    def _take(self, i: int, orbit: tuple[Array, float, Array]) -> bool:
        of, points = self.of, orbit[0]
        k = int(np.argmin(of.at.distance(points, of.points[i, -1])))
        kept, ways, times = strobe_points(self.model, points[[k]], of.count, self.rtol, self.at)
        of.points[i], of.ways[i], of.times[i], of.period[i] = kept[:, 0], ways[:, 0], times[:, 0], len(points)
        of.exponent[i] = of.error[i] = np.nan
        return True

    def _volumes(self, i: int) -> float:
        """Mean logarithm of the growth of volumes of states in a drive period."""
        of, long = self.of, self.of.long[i][:, :-1]
        if not len(of.at.free):
            return 0.0
        logs, scales = [], of.at.scales[of.at.free]
        for state in long[:: max(len(long) // _VOLUMES, 1)][:_VOLUMES]:
            M = difference_jacobian(self.model, state, 1, min(self.rtol, 1e-9), at=self.at) / scales[:, None] * scales
            with np.errstate(divide="ignore"):
                logs.append(float(np.log(abs(np.linalg.det(M)))) if np.isfinite(M).all() else np.nan)
        return float(np.nanmean(np.maximum(logs, -700.0))) if np.isfinite(logs).any() or np.isneginf(logs).any() else 0.0


def _approaches(at: Coordinates, long: Array, points: Array, multiplier: float, derivative: Array) -> bool:
    """Whether a stretch closes in on the strobe points of a stable orbit as the derivative of the strobe map there says.

    If the orbit attracts fast, by coming near, and at least half as fast as its largest multiplier. If slowly, state by state: the
    difference from the orbit at the end is that at the beginning, carried along by the derivative.
    """
    part = len(long) // 4
    expected = -(len(long) - part) * np.log(max(multiplier, 1e-300))
    if multiplier >= 1.0:
        return False
    if expected <= _SLOW:
        return _carried(at, long, points, derivative)
    apart = np.min([at.distance(long, point) for point in points], axis=0)
    early, late = float(apart[:part].max()), float(apart[-part:].max())
    return bool(late < _NEAR and (late <= 1e-6 or np.log(early / late) >= _RATE * expected))


def _carried(at: Coordinates, long: Array, points: Array, derivative: Array) -> bool:
    """Whether the derivative of the strobe map along an orbit carries the first difference of a stretch from it to the last."""
    p, free = len(points), at.free
    first = int(np.argmin(at.distance(long[:p], points[0])))
    turns = (len(long) - 1 - first) // p
    early, late = (at.difference(long[k], points[0])[free] / at.scales[free] for k in (first, first + turns * p))
    scales = at.scales[free]
    carried = np.linalg.matrix_power(derivative / scales[:, None] * scales, turns) @ early
    return bool(np.max(abs(late - carried)) <= _CARRIED * np.max(abs(late)))


def _agree(long: Array, at: Coordinates) -> bool:
    """Whether weighted means and mean squares of two halves of a stretch agree, in terms of its spread."""
    points, scales = at.embedded(long[:, : len(at.scales)])
    kept = [*range(at.smooth), *range(len(at.scales), points.shape[1])]
    _, errors, spread = smooth_means(points[:, kept] / scales[kept])
    return bool(np.all(errors <= _AGREE * np.maximum(spread, 1e-9)))


def smooth_means(x: Array) -> tuple[Array, Array, Array]:
    """Weighted means and root mean squares about them of columns (n, d), their differences between two halves, and the spread.

    Arrays (2d,), (2d,), (2d,). On a smooth torus they converge faster than any power of n (Das, Saiki, Sander and Yorke 2017).
    """
    spread = np.std(x, axis=0)
    centre = x.mean(axis=0)

    def both(part: Array) -> Array:
        w = smooth_weights(len(part))[:, None]
        return np.concatenate([(w * part).sum(axis=0), np.sqrt((w * (part - centre) ** 2).sum(axis=0))])

    half = len(x) // 2
    return both(x), abs(both(x[:half]) - both(x[half:])), np.concatenate([spread, spread])
