"""Predictions of one model for several records, with their derivatives: steady motion of robots."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike, Numeric
from stickslip.basics.errors import InputError, SolveError
from stickslip.inverse.identification.drive_harmonics import ripple_of, rippled
from stickslip.inverse.identification.parameters import OverParameters, Parameters
from stickslip.inverse.identification.steady_curves import SteadyCurve, periods_to_settle, steady_curve, transient_curve
from stickslip.inverse.identification.targets import Target, of_body
from stickslip.solvers import solve

_STEP = 2e-5  # of the distance between the bounds: differences for derivatives
_PLACES = (0.0, 0.25, -0.25, 0.5, -0.5)  # of its reach, where a transient is tried to begin
_GRID = 256  # phases tried for the alignment of a curve
_KEPT = 8  # curves of each record that are remembered


@dataclass(eq=False)
class SteadyProblem(OverParameters):
    """Fit of steady curves and of mean velocities.

    A search moves the points of the free parameters (0 to 1 between their bounds) and, for each curve, the drive's phase in the middle of
    the record and, where the frequency was found in the data, by how much the phase slips from its first to its last sample. A record
    that begins with a transient has the velocity at the strobe time before its first sample besides, and the position there if the motion
    depends on it; a position has an offset, which is linear and is taken out.

    Parameters
    ----------
    parameters : Parameters
    targets : tuple of Target
    rtol : float
        Relative tolerance of the solver.
    """

    batched: ClassVar[bool] = False

    parameters: Parameters
    targets: tuple[Target, ...]
    rtol: float = 1e-8
    kinked: bool = True  # not in the search, whose derivatives are one-sided
    solves: int = 0
    _warm: dict[int, Any] = field(default_factory=dict)
    _curves: dict[tuple[Any, ...], Any] = field(default_factory=dict)

    # ---- layout ----
    @property
    def curves(self) -> tuple[int, ...]:
        """Which records are curves and so have a phase of their own."""
        return tuple(i for i, t in enumerate(self.targets) if t.kind != "mean")

    @property
    def nuisances(self) -> int:
        """How many phases and offsets are fitted besides the free parameters."""
        return self.timing + sum(t.kind == "position" for t in self.targets)

    @property
    def timing(self) -> int:
        """How many numbers a point has behind the free parameters."""
        return len(self._timing)

    @property
    def _timing(self) -> tuple[tuple[int, str], ...]:
        """Quantities fitted for each curve besides the free parameters: (record, "phase", "slip", "start" or "place")."""
        wanted = {"phase": lambda t: True, "slip": lambda t: t.slips, "start": lambda t: t.transient, "place": lambda t: t.placed}
        return tuple((i, what) for i in self.curves for what, of in wanted.items() if of(self.targets[i]))

    def _phase(self, point: Array, i: int) -> Any:
        """Drive phases of the samples of record i."""
        target, n = self.targets[i], len(self.parameters.free)
        phase = target.phase + point[n + self._timing.index((i, "phase"))]
        return phase + point[n + self._timing.index((i, "slip"))] * target.course if target.slips else phase

    def _like(self, **changes: Any) -> SteadyProblem:
        return dataclasses.replace(self, **{"solves": 0, "_warm": dict(self._warm), "_curves": {}, **changes})

    def afresh(self) -> SteadyProblem:
        """The same fit with a memory and a count of its own, which begin with what is remembered here."""
        return self._like(_curves=dict(self._curves))

    def with_values(self, y: ArrayLike) -> SteadyProblem:
        """The same fit for other measured values, of the same motions."""
        return dataclasses.replace(super().with_values(y), _curves=dict(self._curves))

    def leaving_out(self, effects: Iterable[str]) -> SteadyProblem:
        """The same fit of a law without some effects, which moves otherwise."""
        return dataclasses.replace(super().leaving_out(effects), _warm={})

    def rough(self) -> SteadyProblem:
        """The same fit for the search: looser tolerance, one-sided differences."""
        return self._like(rtol=max(self.rtol, 1e-6), kinked=False)

    # ---- predictions ----
    def predicted(self, point: Any, readings: Any = None) -> Any:
        """Values of all records in the order of `y`; None where the parameters make no model.

        Of the readings of a record the harmonics of its drive count, which are of the motion.
        """
        motions = self._motions(point, readings)
        if motions is None:
            return None
        parts = []
        for i, (target, motion) in enumerate(zip(self.targets, motions, strict=True)):
            if target.kind == "mean":
                parts.append(np.array([motion.mean_velocity]))
                continue
            parts.append(modelled_values(target, motion, _counted(target, motion, self._phase(point, i))))
        return np.concatenate(parts)

    def _starts(self, point: Array) -> dict[int, dict[str, float]]:
        """Velocities, and positions, at the strobe time before the first sample; at rest at zero where the point does not say."""
        n, starts = len(self.parameters.free), dict[int, dict[str, float]]()
        for k, (i, what) in enumerate(self._timing, n):
            if what in _BEGINS:
                name, size = _BEGINS[what]
                starts.setdefault(i, {})[name] = float(point[k]) * size(self.targets[i]) if len(point) > n else 0.0
        return starts

    def _motions(self, point: Any, readings: Any = None) -> list[Any] | None:
        """The curve of each record; the last few of each are remembered."""
        starts, free = self._starts(point), np.asarray(point[: len(self.parameters.free)], float)
        curves = []
        for i in range(len(self.targets)):
            ripple = ripple_of(readings[i]) if readings else {}
            key = (i, *free.tolist(), *starts.get(i, {}).values(), *ripple.items())
            curve = (
                self._curves.pop(key) if key in self._curves else self._solved(free, i, starts.get(i, {}), readings[i] if ripple else {})
            )
            self._curves[key] = curve  # as the last one that was asked for
            curves.append(curve)
        while len(self._curves) > _KEPT * len(self.targets):
            self._curves.pop(next(iter(self._curves)))
        return None if any(curve is None for curve in curves) else curves

    def _solved(self, free: Any, i: int, start: dict[str, float], reading: dict[str, Any]) -> Any:
        """The curve of one record; None where there is none."""
        target = self.targets[i]
        self.solves += 1
        try:
            model = rippled(self.parameters.model(self.parameters.values(free), i), reading)
            if target.transient:
                return transient_curve(model, start, int(target.phase[-1]) + 3, self.rtol, target.body)
            motion = steady_curve(model, self._warm.get(i), self.rtol, target.body)
        except (InputError, SolveError):
            return None
        self._warm[i] = motion.end
        return motion

    def ends(self, points: Any, readings: Any = None) -> tuple[Any, Any]:
        """The least and the greatest values for many points (cases, numbers): arrays (values, cases), of motions one and the same.

        NaN where a point makes no model.
        """
        predictions = [self.predicted(point, _case(readings, k)) for k, point in enumerate(points)]
        values = np.stack([np.full(len(self.y), np.nan) if each is None else each for each in predictions], axis=1)
        return values, values

    def slopes(self, point: Any, readings: Any = None) -> tuple[Any, Any]:
        """Derivatives of the least and the greatest values, which are the same; those for the phases need no solve."""
        one = _case(readings, 0)
        n, here = len(self.parameters.free), self.predicted(point, one)
        columns = []
        for k in range(n):
            columns.append(self._slope(point, k, here, one))
        slopes = {i: self._phase_slope(point, i, one) for i in self.curves}
        for k, (i, what) in enumerate(self._timing):
            course = self._course(i) if what == "slip" else 1.0
            columns.append(self._slope(point, n + k, here, one) if what in _BEGINS else slopes[i] * course)
        derivatives = np.stack(columns, axis=1) if columns else np.empty((len(self.y), 0))
        return derivatives, derivatives

    def _slope(self, point: Array, k: int, here: Any, readings: Sequence[Mapping[str, Any]]) -> Any:
        """Derivative of the values by one free parameter: one-sided in the search, else central where both sides make a model."""
        h, sides = 10 * _STEP if not self.kinked else _STEP, []
        for sign in (1.0, -1.0):
            moved = np.array(point, float)
            moved[k] += sign * h
            shifted = self.predicted(moved, readings) if k >= len(self.parameters.free) or 0.0 <= moved[k] <= 1.0 else None
            if shifted is not None:
                sides.append((sign * h, shifted))
            if sides and not self.kinked:
                break
        if len(sides) == 2:
            return (sides[0][1] - sides[1][1]) / (2 * h)
        if len(sides) == 1 and here is not None:
            step, once = sides[0]
            moved = np.array(point, float)
            moved[k] += 2 * step
            inside = self.kinked and k < len(self.parameters.free) and 0.0 <= moved[k] <= 1.0
            twice = self.predicted(moved, readings) if inside else None
            return (once - here) / step if twice is None else (4 * (once - here) - (twice - here)) / (2 * step)
        return np.zeros(len(self.y))

    def _phase_slope(self, point: Array, i: int, readings: Sequence[Mapping[str, Any]], h: float = 1e-6) -> Any:
        """Derivative of the values of record i by its phase; zero for the others."""
        motions = self._motions(point, readings)
        parts = [np.zeros(t.count) for t in self.targets]
        if motions is not None:
            phase = _counted(self.targets[i], motions[i], self._phase(point, i))
            up, down = (modelled_values(self.targets[i], motions[i], phase + sign * h) for sign in (1, -1))
            parts[i] = (up - down) / (2 * h)
        return np.concatenate(parts)

    def _course(self, i: int) -> Any:
        return np.concatenate([t.course if k == i else np.zeros(t.count) for k, t in enumerate(self.targets)])

    # ---- search ----
    def aligned(self, point: Array) -> Any:
        """The point of the free parameters with the best phase of each curve behind it."""
        motions = self._motions(point)
        phases = {i: 0.0 if motions is None else self._aligned(point, i, motions[i]) for i in self.curves}
        whole = np.concatenate([point, [phases[i] if what == "phase" else 0.0 for i, what in self._timing]])
        for k, (_, what) in enumerate(self._timing, len(self.parameters.free)):
            if what == "place" and motions is not None:
                whole = self._placed(whole, k)
        return whole

    def _placed(self, whole: Any, k: int) -> Any:
        """The place where a transient begins best, of a few."""
        tried = [np.where(np.arange(len(whole)) == k, part, whole) for part in _PLACES]
        values = [self.predicted(each) for each in tried]
        rests = [np.inf if v is None else float(np.sum(((v - self.y) / self.sigma) ** 2)) for v in values]
        return tried[int(np.argmin(rests))]

    def _aligned(self, point: Array, i: int, motion: Any) -> float:
        """The best phase of one curve; that of a transient from its second half, which is taken as steady."""
        target = self.targets[i]
        if not target.transient:
            return best_phase(target, motion)
        late = target.phase > 0.5 * target.phase[-1]
        tail = dataclasses.replace(
            target, phase=target.phase[late], y=target.y[late], clipped=0, weight=(target.weight * target.exact)[late]
        )
        try:
            steady = steady_curve(self.parameters.model(self.parameters.values(point), i), None, self.rtol, target.body)
        except (InputError, SolveError):
            return 0.0
        phase = best_phase(tail, steady) % 1.0
        costs = {p: float(np.sum((modelled_values(target, motion, target.phase + p) - target.y) ** 2)) for p in (phase, phase - 1.0)}
        return min(costs, key=lambda p: costs[p]) if phase > 0.9 else phase

    def settling(self, point: Array) -> dict[str, float]:
        """Drive periods after which a tenth of a start is left, of the motion of each record that is taken as steady: label -> number."""
        motions = self._motions(point) or []
        return {
            self.targets[i].label: periods_to_settle(motions[i], self.rtol)
            for i in self.curves
            if motions and isinstance(motions[i], SteadyCurve)
        }

    def bounds(self) -> tuple[Any, Any]:
        """Bounds of a whole point."""
        n, m = len(self.parameters.free), len(self._timing)
        return np.concatenate([np.zeros(n), np.full(m, -np.inf)]), np.concatenate([np.ones(n), np.full(m, np.inf)])

    def coarse(self, points: Array, offsets: Any) -> Any:
        """How badly many points fit, told from mean and extreme velocities alone: one batch for each record. Lower is better.

        Of a record whose offset is None, the sensor's zero is not known.
        """
        points = np.asarray(points, float)
        good, batches = self.parameters.batches(points)
        score = np.full(len(points), np.inf)
        if not good.any():
            return score
        total = np.zeros(int(good.sum()))
        for target, batch, offset in zip(self.targets, batches, offsets, strict=True):
            many = solve(batch, periods=100, settle="auto", rtol=1e-5, keep="summary")
            self.solves += len(total)
            total = total + _distance(target, {name: of_body(many, name, target.body) for name in _FEATURES}, offset)
        score[good] = np.where(np.isfinite(total), total, np.inf)
        return score


def _case(readings: Sequence[Mapping[str, Any]], k: int) -> Any:
    """The readings of one of many cases."""
    return readings and [
        {name: float(value[k] if np.size(value) > 1 else np.ravel(value)[0]) for name, value in r.items()} for r in readings
    ]


_FEATURES = ("mean_velocity", "velocity_max", "velocity_min")


def _distance(target: Target, computed: dict[str, Any], offset: float | None) -> Any:
    """Squared distance of mean and extreme velocities from those of a record."""
    if target.kind == "mean":
        return ((computed["mean_velocity"] - target.y[0]) / target.sigma) ** 2
    if target.kind == "position":
        slope = np.polyfit(target.phase, target.y, 1)[0] * target.frequency
        return ((computed["mean_velocity"] - slope) / (np.ptp(target.y) * target.frequency)) ** 2
    low, high = np.quantile(_smoothed(target), (0.0, 1.0))
    scale = max(high - low, 1e-300)
    wanted = {"mean_velocity": float(np.average(target.y, weights=target.weight)), "velocity_max": high, "velocity_min": low}
    if offset is None:  # the extremes from the mean, which says nothing
        wanted, computed = ({name: each[name] - each["mean_velocity"] for name in _FEATURES} for each in (wanted, computed))
        offset = 0.0
    apart = {name: (computed[name] + offset - wanted[name]) / scale for name in _FEATURES}
    if np.any(target.clipped > 0):  # an extreme is that or beyond
        apart["velocity_max"] = np.minimum(apart["velocity_max"], 0.0)
    if np.any(target.clipped < 0):
        apart["velocity_min"] = np.maximum(apart["velocity_min"], 0.0)
    return sum(each**2 for each in apart.values())


def _smoothed(target: Target) -> Any:
    """The mean cycle in as many bins as its noise allows."""
    bins = int(np.clip(target.count / 20, 12, 200))
    bins *= target.period
    index = np.minimum((np.mod(target.phase / target.period, 1.0) * bins).astype(int), bins - 1)
    weight = np.bincount(index, target.weight * np.ones(target.count), bins)
    return np.bincount(index, target.weight * target.y, bins)[weight > 0] / weight[weight > 0]


def _speed(target: Target) -> float:
    """The unit of a start's velocity."""
    return float(np.ptp(target.y)) * (1.0 if target.kind == "velocity" else target.frequency) or 1.0


def _reach(target: Target) -> float:
    """The unit of the position where a transient begins."""
    return float(np.ptp(target.y)) / (1.0 if target.kind == "position" else target.frequency) or 1.0


#: What is fitted of the start of a transient: its name in a run's start, and what it is counted in.
_BEGINS: dict[str, tuple[str, Callable[[Target], float]]] = {"start": ("v", _speed), "place": ("x", _reach)}


def modelled_values(target: Target, motion: Any, phase: Numeric) -> Any:
    """The model's prediction for one record; the offset of a position is that of least squares."""
    if target.kind == "velocity":
        return motion.v(phase)
    x = motion.x(phase)
    return x + np.average(target.y - x, weights=target.weight * target.exact)


def _counted(target: Target, motion: Any, phase: Any) -> Any:
    """Phases in a motion of several drive periods, counted from the one with which the record agrees best.

    From which period a run counts depends on where it was started: of a curve that is nearly the same another period would be compared, so
    that derivatives are wrong and steps lead nowhere.
    """
    period = getattr(motion, "period", 1)
    if period == 1:
        return phase
    weight = (target.weight * target.exact) / np.sum(target.weight * target.exact)
    apart = [modelled_values(target, motion, phase + k) - target.y for k in range(period)]
    return phase + int(np.argmin([weight @ (rest - weight @ rest) ** 2 for rest in apart]))


def best_phase(target: Target, motion: SteadyCurve) -> float:
    """The phase of the first sample at which curve and record agree best: on a grid, then by a parabola."""
    period = motion.period
    grid = np.arange(_GRID * period) / _GRID
    if target.kind == "velocity":
        wave = motion.v(grid)
        bins = _binned(target, target.y, period)
    else:
        drift = motion.mean_velocity / target.frequency
        wave = motion.x(grid) - drift * grid
        bins = _binned(target, target.y - drift * target.phase, period)
        bins, wave = (bins[0] - np.average(bins[0], weights=bins[1]), bins[1]), wave - wave.mean()
    mean, weight = bins
    cost = _lagged(wave**2, weight) - 2 * _lagged(wave, weight * mean)
    k = int(np.argmin(cost))
    left, here, right = cost[k - 1], cost[k], cost[(k + 1) % len(cost)]
    bend = left - 2 * here + right
    return float((k + (0.5 * (left - right) / bend if bend > 0 else 0.0)) / _GRID)


def _binned(target: Target, y: Array, period: int) -> tuple[Any, Any]:
    n = _GRID * period
    index = np.round(np.mod(target.phase, period) * _GRID).astype(int) % n
    weight = np.bincount(index, target.weight * np.ones(len(y)), n)
    return np.bincount(index, target.weight * y, n) / np.where(weight > 0, weight, 1), weight


def _lagged(wave: Any, weights: ArrayLike) -> Any:
    """Sum over i of wave[i + k] weights[i], for every k."""
    return np.fft.irfft(np.fft.rfft(wave) * np.conj(np.fft.rfft(weights)), len(wave))
