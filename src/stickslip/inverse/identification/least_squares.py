"""The least-squares problem of a fit: model curves or forces as sensors show them, and prior knowledge of sensors and numbers."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model, Numeric
from stickslip.basics.distributions import Distribution
from stickslip.inverse.identification.censored import tail, tail_slope
from stickslip.inverse.identification.covariance import information_of
from stickslip.inverse.identification.delays import best_delay
from stickslip.inverse.identification.sensor_readings import change_shown, of_records, shown_by_sensor
from stickslip.inverse.identification.sensors import SensorNumber
from stickslip.inverse.identification.smoothing import REDRAWS
from stickslip.inverse.identification.weak_directions import derivative_along, sharpened

#: Residual of a value that a model cannot give, in standard deviations.
IMPOSSIBLE = 1e4
_LINEAR = ("offset", "drift", "gain", "inertia")
_FAR_OFF = 5.0  # standard deviations from what is known beforehand: once in two million, if that is right
_NEAR_THE_END = 4.0  # standard deviations of a value from the end of a range within which noise may clip it
_NUDGE = 1e-5  # of the mean load, of 1 or of an amplitude: differences for the derivatives by a preload, a start, a harmonic


@dataclass(eq=False)
class MeasuredProblem:
    r"""The least-squares problem of a fit: a model, what its sensors do, and what is known beforehand.

    .. math:: y = g\,h(t - \tau) + b + d\,t + m\,a

    with the model's h, gain g, delay :math:`\tau`, offset b, drift d (t from the middle of the record) and, of forces, the inertia m of
    the parts between contact and sensor, times their acceleration. A preload acts on the model itself. Uncertain numbers add a row each,
    (value - mean) / sd. A point is that of the model (free parameters between 0 and 1, then phases), followed by the numbers of the
    sensors.

    Parameters
    ----------
    model : SteadyProblem or DrivenProblem
    numbers, held : tuple of SensorNumber
        Those that are fitted, and those that are not.
    trust : float
        The noise of records, found from the residuals, over what the problem supposes: rows whose standard deviation is known count by it.
    shifts : array or float
        By how much rows of what is known are moved, in standard deviations (bootstrap).
    given : None or dict
        What the user typed for the sensor.
    harmonics : None, number or dict
        What the user typed for the harmonics of the drive.
    rows : array or float
        Weights by which a robust loss holds outliers back.
    sizes : array or float
        The noise of each record beside that of the others, found from its residuals, over what its target supposes; their mean, that of
        logarithms over all values, is 1, so that sums of squares of different laws can be compared.
    """

    model: Any
    numbers: tuple[SensorNumber, ...] = ()
    held: tuple[SensorNumber, ...] = ()
    trust: float = 1.0
    shifts: Any = 0.0
    given: Any = None
    harmonics: Any = None
    rows: Any = 1.0
    sizes: Any = 1.0
    _memory: dict[tuple[Any, ...], Any] = field(default_factory=dict)

    # ---- what the model says ----
    @property
    def parameters(self) -> Any:
        """Free, fixed and tied parameters."""
        return self.model.parameters

    @property
    def targets(self) -> Any:
        """The data to fit in each record."""
        return self.model.targets

    @property
    def resolution(self) -> float:
        """Singular values of the derivatives below this part of the largest are zero."""
        return float(self.model.resolution)

    @property
    def solves(self) -> int:
        """How many models were solved."""
        return int(self.model.solves)

    @property
    def batched(self) -> bool:
        """Whether many points cost little more than one."""
        return bool(self.model.batched)

    @property
    def nuisances(self) -> int:
        """How many phases, offsets and numbers of sensors are fitted besides the free parameters."""
        return int(self.model.nuisances) + len(self.numbers)

    @property
    def first(self) -> int:
        """Where in a point the numbers of the sensors begin."""
        return len(self.parameters.free) + int(self.model.timing)

    @property
    def y(self) -> Any:
        """All measured values."""
        return self.model.y

    @property
    def sigma(self) -> Any:
        """Standard deviation of each value."""
        each = np.where([t.given_sigma for t in self.targets], 1 / self.trust, self.sizes)
        return self.model.sigma * np.repeat(each, [t.count for t in self.targets]) / np.sqrt(self.rows)

    @property
    def clipped(self) -> Any:
        """Which values sit on the upper end (1) or the lower one (-1) of a sensor's range: array (values,)."""
        return np.concatenate([t.clipped * np.ones(t.count, int) for t in self.targets])

    @property
    def known(self) -> Any:
        """1, or 0 for values of forces that a delay brings from where no motion is recorded: array (values,)."""
        return np.concatenate([t.known * np.ones(t.count) for t in self.targets])

    @property
    def spared(self) -> Any:
        """Standard deviations by which values may be off before they count: array (values,), or 0 for all."""
        return np.concatenate([t.spared * np.ones(t.count) for t in self.targets]) if any(np.ndim(t.spared) for t in self.targets) else 0.0

    def unclipped(self, residuals: Array) -> Any:
        """Which values are measured themselves and, by the model, would be with any noise; array (values,) of bool.

        Of those that are nearly at the end of a range only some noise is seen, so that what is left of them is no sample of it.
        """
        measured = []
        for t, rest, sigma in zip(self.targets, *map(self.parts, (residuals[: len(self.y)], self.sigma)), strict=True):
            inside = t.exact
            for side in (1, -1):
                if np.any(t.clipped == side):
                    inside = inside & (side * (t.y + rest * sigma) < np.max(side * t.y) - _NEAR_THE_END * sigma)
            measured.append(inside)
        return np.concatenate(measured)

    # ---- others like it ----
    def _like(self, model: Model, **changes: Any) -> MeasuredProblem:
        return dataclasses.replace(self, model=model, _memory={}, **changes)

    def afresh(self) -> MeasuredProblem:
        """The same fit with a memory and a count of its own, which begin with what is remembered here."""
        return self._like(self.model.afresh())

    def count(self, solves: int) -> None:
        """Count models that were solved elsewhere."""
        self.model.solves += solves

    def with_values(self, y: Numeric, shifts: Any = 0.0) -> MeasuredProblem:
        """The same fit for other measured values."""
        return self._like(self.model.with_values(y), shifts=shifts)

    def only(self, fixed: dict[str, float]) -> MeasuredProblem:
        """The same fit with some free parameters held."""
        return self._like(self.model.only(fixed))

    def leaving_out(self, effects: Iterable[str]) -> MeasuredProblem:
        """The same fit of a law without some effects."""
        return self._like(self.model.leaving_out(effects))

    def rough(self) -> MeasuredProblem:
        """The same fit for the search, in which drives have no harmonics."""
        return self._like(self.model.rough(), numbers=tuple(n for n in self.numbers if n.searched))

    def whole(self, point: Array) -> Any:
        """A point of the search with the numbers that it lacks, at those of an ideal drive."""
        own = iter(point[self.first :])
        return np.array([*point[: self.first], *(next(own) if n.searched else n.neutral for n in self.numbers)])

    def over(self, model: Any) -> MeasuredProblem:
        """The same fit by a model whose steps are others."""
        return self._like(model)

    def trusting(self, trust: float, sizes: Any = None) -> MeasuredProblem:
        """The same fit where the records' noise is known better, and that of each beside the others."""
        return self._like(self.model, trust=trust, sizes=self.sizes if sizes is None else sizes)

    def weighing(self, rows: Any) -> MeasuredProblem:
        """The same fit where a robust loss gives the values these weights."""
        return self._like(self.model, rows=rows)

    def holding(self, names: Any, point: Any = None) -> MeasuredProblem:
        """The same fit with some numbers of the sensors held: where a point has them, else at those of an ideal sensor."""
        values = [n.neutral for n in self.numbers] if point is None else point[self.first :]
        kept = tuple(n for n in self.numbers if n.name not in names)
        fixed = tuple(dataclasses.replace(n, value=float(v)) for n, v in zip(self.numbers, values, strict=True) if n.name in names)
        return self._like(self.model, numbers=kept, held=(*self.held, *fixed))

    # ---- predictions ----
    def readings(self, points: Array) -> list[dict[str, Any]]:
        """Effects of the sensor of each record: name -> value, or one for each column of points (numbers, cases)."""
        readings: list[dict[str, Any]] = [{} for _ in self.targets]
        values = [*zip(self.numbers, points[self.first :], strict=True), *((n, n.value) for n in self.held)]
        for number, value in values:
            for i in number.records:
                readings[i][number.what] = value
        return readings

    def ends(self, points: Array) -> tuple[Any, Any]:
        """The least and the greatest values for many points (cases, numbers): arrays (values, cases); NaN where a point makes no model.

        They differ where a contact is held, which bears any force between them.
        """
        columns = np.asarray(points, float).T
        readings = self.readings(columns)
        return self._shown(self.model.ends(columns[: self.first].T, readings), readings)

    def batch(self, points: Array) -> Any:
        """Values for many points (cases, numbers): array (values, cases); NaN where a point makes no model."""
        return self._met(self.ends(points))

    def predicted(self, point: Array) -> Any:
        """Values of all records in the order of `y`; None where the parameters make no model."""
        h = self.modelled(point)
        return None if h is None else self._met(self._shown(h, self.readings(point)))

    def _met(self, ends: tuple[Any, Any]) -> Any:
        """The measured value if it lies between the least and the greatest value, else the nearer of these; of clipped samples the farther.

        Arrays (values,) or (values, cases).
        """
        least, most = ends
        y, clipped = (each if least.ndim == 1 else each[:, None] for each in (self.y, self.clipped))
        met = np.clip(y, least, most)
        return np.where(clipped == 0, met, np.where(clipped > 0, most, least)) if clipped.any() else met

    def standardised(self, ends: tuple[Any, Any]) -> Any:
        """(model - measured) / sigma of the least and the greatest values; of clipped samples `tail`."""
        met = self._met(ends)
        y, sigma, clipped = (each if met.ndim == 1 else each[:, None] for each in (self.y, self.sigma, self.clipped))
        known, spared = (each if met.ndim == 1 or np.ndim(each) == 0 else each[:, None] for each in (self.known, self.spared))
        deviation = known * (met - y) / sigma
        deviation = deviation - np.clip(deviation, -spared, spared) if np.ndim(spared) else deviation
        return np.where(clipped == 0, deviation, -clipped * tail(clipped * deviation)) if clipped.any() else deviation

    def _counting(self, ends: tuple[Any, Any]) -> Any:
        """By how much residuals rise for each standard deviation of what is met: 1, and less for clipped samples; array (values,)."""
        clipped = self.clipped
        off = (self._met(ends) - self.y) / self.sigma
        counts = self.known * (np.where(clipped == 0, 1.0, tail_slope(clipped * off)) if clipped.any() else 1.0)
        return counts * ((self.spared == 0) | (abs(off) > self.spared)) if np.ndim(self.spared) else counts

    def modelled(self, point: Array) -> tuple[Any, Any] | None:
        """Least and greatest values that the model gives before any sensor; the last few points are remembered."""
        point = np.asarray(point, float)
        key = tuple(point.tolist())
        if key not in self._memory:
            if len(self._memory) > 4:
                self._memory.clear()
            ends = _both(lambda h: h[:, 0], self.model.ends(point[None, : self.first], self.readings(point[:, None])))
            self._memory[key] = ends if np.isfinite(ends).all() else None
        return self._memory[key]

    def parts(self, whole: Any) -> list[Any]:
        """Values of all records, one by one."""
        edges = np.cumsum([0, *(t.count for t in self.targets)])
        return [whole[a:b] for a, b in pairwise(edges)]

    def _shown(self, ends: tuple[Any, Any], readings: list[dict[str, Any]]) -> tuple[Any, Any]:
        """Sensor readings of the least and the greatest values."""
        return _both(lambda h: self._of_records(shown_by_sensor, h, readings), ends)

    def _of_records(self, function: Any, whole: Any, readings: list[dict[str, Any]]) -> Any:
        """A function of (target, values, readings) for all records."""
        return np.concatenate([function(t, part, r) for t, part, r in zip(self.targets, self.parts(whole), readings, strict=True)])

    def input_changes(self, point: Array, times: int = REDRAWS) -> Any:
        r"""By how much other noise of the input (position, load) changes what is met, in standard deviations: array (values, times).

        None where the input has no noise. Noise of the input is in the derivatives J too, so that the numbers of a fit over another input
        move by the pseudo-inverse of its own derivatives: :math:`-P_k\delta_k`, not :math:`-P\delta_k`. The difference, which makes slopes
        too small on average (attenuation), is added as the change :math:`J(P_k - P)\delta_k`.
        """
        here = self.predicted(point)
        if not self.model.has_noise or here is None:
            return None
        jacobian, count = self.jacobian(point), len(here)
        usual, changes = information_of(self, jacobian).inverse[:, :count], np.zeros((count, times))
        for k in range(times):
            again = self._like(self.model.redrawn(k))
            if (h := again.predicted(point)) is not None:
                change = (h - here) / self.sigma
                moved = information_of(again, again.jacobian(point)).inverse[:, :count] @ change - usual @ change
                changes[:, k] = change + jacobian[:count] @ moved
        return changes

    # ---- residuals ----
    def rest(self, ends: Any, point: Array) -> Any:
        """(model - measured) / sigma of the least and the greatest values that a point gives, then the rows of what is known."""
        possible = ends is not None and np.isfinite(ends).all()
        values = self.standardised(ends) if possible else np.full(len(self.y), IMPOSSIBLE)
        return np.concatenate([values, self._known_rows(point)])

    def _known_rows(self, point: Array) -> Any:
        away = np.array([(k.value(point) - k.prior.mean) / k.prior.sd for k in self._known])
        return self.trust * (away - self.shifts * np.ones(len(away)))

    def penalty(self, point: Array) -> float:
        """Sum of squares of the rows of what is known."""
        rows = self._known_rows(point)
        return float(rows @ rows)

    def residuals(self, point: Array) -> Any:
        """(model - measured) / sigma, then the rows of what is known."""
        h = self.modelled(point)
        return self.rest(None if h is None else self._shown(h, self.readings(point)), point)

    @property
    def has_known_rows(self) -> bool:
        """Whether the noise of some values is known beside that of others, so that it matters how large that is."""
        given = [t.given_sigma for t in self.targets]
        return not all(given) and (any(given) or bool(self._known))

    @property
    def _known(self) -> list[_Known]:
        free = [_Known(k, f.prior, f.name, f) for k, f in enumerate(self.parameters.free) if f.prior]
        return free + [_Known(self.first + k, n.prior, n.name) for k, n in enumerate(self.numbers) if n.prior]

    def against_what_is_known(self, point: Array) -> dict[str, float]:
        """By how many standard deviations numbers are off what is known of them, of those that are far off."""
        away = {k.name: abs(k.value(point) - k.prior.mean) / k.prior.sd for k in self._known if k.prior.kind == "normal"}
        return {name: float(size) for name, size in away.items() if size > _FAR_OFF}

    def jacobian(self, point: Array) -> Any:
        """Derivatives of the residuals."""
        point = np.asarray(point, float)
        readings = self.readings(point)
        h, own = self.modelled(point), self.model.slopes(point[: self.first], self.readings(point[:, None]))
        if h is None:
            slopes = np.zeros((len(self.y), len(point)))
        else:
            columns = _both(lambda each: self._of_records(change_shown, each, readings), own)
            shown = self._shown(h, readings)
            main, counting = self._at_the_nearer(columns, shown), self._counting(shown) / self.sigma
            slopes = np.concatenate([main, self._sensor_slopes(h, point, readings)], axis=1) * counting[:, None]
            slopes = sharpened(slopes, partial(derivative_along, self, point, slopes), self.resolution) if self.model.kinked else slopes
        known = np.zeros((len(self._known), len(point)))
        for row, k in zip(known, self._known, strict=True):
            row[k.index] = self.trust * k.slope(point) / k.prior.sd
        return np.concatenate([slopes, known])

    def _at_the_nearer(self, columns: tuple[Any, Any], ends: tuple[Any, Any]) -> Any:
        """Derivatives of what is met: those of the nearer end, zero where what is measured is between the ends."""
        (of_least, of_most), (least, most) = columns, ends
        if most is least:
            return of_least
        upper, lower = (
            np.where(self.clipped == 0, inside, self.clipped == side) for side, inside in ((1, self.y >= most), (-1, self.y <= least))
        )
        return np.where(upper[:, None], of_most, np.where(lower[:, None], of_least, 0.0))

    def _sensor_slopes(self, h: tuple[Any, Any], point: Array, readings: list[dict[str, Any]]) -> Any:
        """Derivatives of the values by the numbers of the sensors: array (values, numbers). What a contact at rest bears, it bears."""
        slopes = self._in_proportion(h, readings, [n for n in self.numbers if not n.in_the_model])
        inside = [k for k, number in enumerate(self.numbers) if number.in_the_model]
        for k, column in zip(inside, self._model_slopes(point, inside), strict=True):
            slopes = np.insert(slopes, k, column, axis=1)
        return slopes

    def _in_proportion(self, h: tuple[Any, Any], readings: list[dict[str, Any]], numbers: list[SensorNumber]) -> Any:
        """Derivatives by some numbers of the sensors that act on what the model gives."""
        if not numbers:
            return np.zeros((len(self.y), 0))
        parts = _both(lambda each: list(zip(self.targets, self.parts(each), readings, strict=True)), h)
        columns = _both(lambda each: np.stack([of_records(number, each) for number in numbers], axis=1), parts)
        return self._at_the_nearer(columns, self._shown(h, readings))

    def _model_slopes(self, point: Array, which: list[int]) -> list[Any]:
        """Derivatives of the values by preloads, starts or harmonics of the drive, which act on the model itself: in one batch."""
        if not which:
            return []
        steps = np.zeros((len(which), len(point)))
        for row, k in zip(steps, which, strict=True):
            number = self.numbers[k]
            loads = [self.targets[i].load.mean() for i in number.records] if number.what == "preload" else [1.0]
            row[self.first + k] = _NUDGE * float(np.mean(loads))
        met = self._met(self.ends(np.concatenate([point + steps, point - steps])))
        return [(met[:, k] - met[:, k + len(which)]) / (2 * step) for k, step in enumerate(steps.max(axis=1))]

    # ---- search ----
    def aligned(self, point: Array) -> Any:
        """The point of the free parameters with the best phases behind it, and the best numbers of the sensors that act in proportion."""
        own = self.model.aligned(point)
        whole = np.concatenate([own, [n.value for n in self.numbers]])
        h = self.modelled(whole)
        if h is None:
            return whole
        for k in self.delays:
            whole[k] = best_delay(self, h, whole, k)
        return np.concatenate([own, self.lagging(whole).linear(h, whole)[0]])

    @property
    def delays(self) -> list[int]:
        """Which numbers of a point are delays of load cells."""
        numbers = enumerate(self.numbers, self.first)
        return [k for k, n in numbers if n.what == "delay" and all(self.targets[i].kind == "force" for i in n.records)]

    def lagging(self, point: Array) -> MeasuredProblem:
        """The same fit where what is open about jumps of a force is late by the delays of a point."""
        late = {i: float(point[k]) for k in self.delays for i in self.numbers[k - self.first].records}
        targets = tuple(t.late(late[i]) if late.get(i, t.lag) != t.lag else t for i, t in enumerate(self.targets))
        return self if targets == self.targets else self._like(dataclasses.replace(self.model, targets=targets))

    def linear(self, h: tuple[Any, Any], whole: Any) -> tuple[Any, float]:
        """The numbers of the sensors that fit best to what a model gives, those that act in proportion; and the sum of squares then."""
        readings = self.readings(whole)
        shown = self._shown(h, readings)
        rest, counting = self.standardised(shown), self._counting(shown) / self.sigma
        moved = [k for k, n in enumerate(self.numbers) if n.what in _LINEAR]
        values = np.array(whole[self.first :], float)
        if not moved:
            return values, float(rest @ rest)
        columns = self._in_proportion(h, readings, [self.numbers[k] for k in moved]) * counting[:, None]
        sd = np.array([self.trust / p.sd if (p := self.numbers[k].prior) else 0.0 for k in moved])
        away = np.array([(values[k] - p.mean) if (p := self.numbers[k].prior) else 0.0 for k in moved])
        for _ in range(2 if self.has_known_rows else 1):  # what is known beforehand counts by what is left, once that is seen
            rows, target = np.concatenate([columns, np.diag(sd)]), np.concatenate([rest, sd * away])
            size = np.sqrt(np.sum(rows**2, axis=0))
            size = np.where(size > 0, size, 1.0)
            change = np.linalg.lstsq(rows / size, -target, rcond=1e-9)[0] / size
            sd = sd * max(float(np.sqrt(np.mean((rest + columns @ change) ** 2))), 1.0)
        low, high = (np.array([n.bounds[side] for n in self.numbers]) for side in (0, 1))
        left = target + rows @ change
        values[moved] += change
        return np.clip(values, low, high), float(left @ left)

    def bounds(self) -> tuple[Any, Any]:
        """Bounds of a whole point."""
        low, high = self.model.bounds()
        return np.append(low, [n.bounds[0] for n in self.numbers]), np.append(high, [n.bounds[1] for n in self.numbers])

    def coarse(self, points: Array) -> Any:
        """How badly many points fit, as one batch, the best numbers of the sensors taken. Lower is better."""
        whole = np.array([*np.zeros(self.first), *(n.value for n in self.numbers)])
        if not self.batched:
            free = {i for n in self.numbers if n.what == "offset" for i in n.records}
            return self.model.coarse(points, [None if i in free else r.get("offset", 0.0) for i, r in enumerate(self.readings(whole))])
        least, most = self.model.ends(points, self.readings(np.tile(whole[:, None], len(points))))
        cases = [(low, low if most is least else high) for low, high in zip(least.T, most.T, strict=True)]
        return np.array([self.linear(h, whole)[1] if np.isfinite(h).all() else np.inf for h in cases])


@dataclass(frozen=True)
class _Known:
    """A number of a point of which something is known beforehand."""

    index: int
    prior: Distribution
    name: str
    free: Any = None

    def value(self, point: Array) -> float:
        return float(point[self.index] if self.free is None else self.free.outer(point[self.index]))

    def slope(self, point: Array) -> float:
        return 1.0 if self.free is None else float(self.free.slope(point[self.index]))


def _both(function: Any, ends: tuple[Any, Any]) -> tuple[Any, Any]:
    """A function of the least and of the greatest values; once where they are the same."""
    least = function(ends[0])
    return least, least if ends[1] is ends[0] else function(ends[1])
