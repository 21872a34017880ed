"""Evaluation of candidates: one batch for each table of unknowns, and the best candidate so far."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stickslip.basics.batch import some_of
from stickslip.basics.contracts import Array
from stickslip.basics.errors import StickslipError
from stickslip.basics.executors import HERE, Workers
from stickslip.dynamics.derivatives.tangents import not_followed
from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit
from stickslip.dynamics.periodic.periodic_orbits import periodic_orbit
from stickslip.dynamics.periodic.steady_motions import Closing
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates
from stickslip.inverse.optimisation.constraints import KEPT, Limit
from stickslip.inverse.optimisation.exact_derivatives import exactly
from stickslip.inverse.optimisation.rest_margin import nearness
from stickslip.inverse.optimisation.results import results_of
from stickslip.inverse.optimisation.uncertainty_samples import allowed_with, sampled
from stickslip.inverse.optimisation.unknowns import Unknowns
from stickslip.models.drives.within import drives_within

_BEYOND, _NONE = 1e9, 1e12  # what is minimised of candidates beyond a limit, and of those that are not machines
_GUIDE, _GUIDE_BEYOND = 1e-12, 1e-6  # what nearness to motion counts of machines at rest, and of those beyond a limit: less than any motion
_STEP = 1e-5  # of unknowns, for what has no exact derivative
_FINE = 1e-9  # tolerance of dynamic laws where differences are taken


@dataclass(eq=False)
class Candidates:
    """The objective on tables of unknowns, smaller is better; it remembers the best that keeps all limits.

    Parameters
    ----------
    space : Unknowns
    quantity : str
        The column that is asked for.
    sign : float
        -1 where it is to be large, 1 where it is to be small.
    limits : list of Limit
    workers : Workers
        Threads, or an executor.
    tell : callable
        Called with the number of candidates tried so far; may raise `Interrupted`, which ends the search.
    sample : dict of arrays, optional
        Uncertain numbers: every candidate is run with all of them, the same for all candidates.
    quantile : float, optional
        The part of the sample that may be worse than what counts; None for the worst of all.
    rtol : float
        Tolerance of dynamic laws.
    watch : callable, optional
        Called with (candidates begun, of how many) while a generation is run; may raise `Interrupted`.
    """

    space: Unknowns
    quantity: str
    sign: float
    limits: list[Limit]
    workers: Workers = HERE
    tell: Callable[[int], None] = lambda tried: None
    sample: dict[str, Array] | None = None
    quantile: float | None = None
    rtol: float = 1e-6
    watch: Callable[[int, int], None] | None = None
    tried: int = 0
    best: Any = None
    least: float = np.inf
    history: list[tuple[int, float]] = field(default_factory=list)  # candidates tried, and the best from then on
    nearest: dict[str, tuple[float, float]] = field(default_factory=dict)  # of limits: how far beyond, and the value
    _orbit: PeriodicOrbit | None = None
    _rests: Any = None  # which candidates of the last table stay where they are

    def __call__(self, U: Array) -> Array:
        """The objective of each row: penalised beyond a limit, and worst if there is no machine."""
        values, over = self.values(U)
        objective = np.where(np.isnan(values), _NONE, np.where(over > 0.0, _BEYOND * (1.0 + np.minimum(over, 100.0)), values))
        return objective + np.where(over > 0.0, _BEYOND * _GUIDE_BEYOND, _GUIDE) * self._guide(np.atleast_2d(U))

    def _guide(self, U: Array) -> Array:
        """Which way leads off a plateau: of machines at rest, how near they are to being moved."""
        guide, rests, way = np.zeros(len(U)), np.flatnonzero(self._rests), self._way()
        if way and len(rests):
            machines, good = self._machines(U[rests])
            near = nearness(machines, len(good), forwards=way < 0.0) if len(good) else None
            if near is not None:
                guide[rests[good]] = -np.clip(np.nan_to_num(near), 0.0, 1.0)
        return guide

    def _way(self) -> float:
        """-1 where machines are to go forwards, 1 backwards, 0 where that is not asked."""
        if self.quantity == "mean_velocity":
            return self.sign
        asked = [limit for limit in self.limits if limit.name == "mean_velocity" and (limit.low > 0.0 or limit.high < 0.0)]
        return 0.0 if not asked else -1.0 if asked[0].low > 0.0 else 1.0

    def values(self, U: Array) -> tuple[Array, Array]:
        """The objective itself for each row, NaN where there is none, and by how much the row is beyond its limits."""
        U = np.atleast_2d(np.asarray(U, float))
        self.tell(self.tried)
        values, over, self._rests = self.judged(U)
        self.tried += len(U)
        kept = np.where((over > 0.0) | np.isnan(values), np.inf, values)
        k = int(np.argmin(kept))
        if kept[k] < self.least:
            self.best, self.least = U[k].copy(), float(kept[k])
            self.history.append((self.tried, self.sign * self.least))
        return values, over

    def judged(self, U: Array) -> tuple[Array, Array, Array]:
        """The same of a table, and which of its machines rest; nothing of it is remembered."""
        machines, good = self._machines(U)
        values, over, rests = np.full(len(U), np.nan), np.zeros(len(U)), np.zeros(len(U), bool)
        if len(good):
            values[good], over[good], rests[good] = self._values(machines, len(good))
        return values, over, rests

    def _machines(self, U: Array) -> tuple[Any, Array]:
        """A batch of the rows that make a machine, with every number of the sample, and which these are."""
        machines, good = self.space.machines(U)
        if self.sample is None or not len(good):
            return machines, good
        kept = np.flatnonzero(allowed_with(machines, len(good), self.sample))
        return (machines if len(kept) == len(good) else some_of(machines, kept) if len(kept) else None), good[kept]

    def _values(self, machines: Any, count: int) -> tuple[Array, Array, Array]:
        early = [limit for limit in self.bounding if limit.of_drive]
        late = [limit for limit in self.limits if not limit.of_drive]
        over = self._over(early, machines, {}, count)
        results, columns = self._results(machines, count)
        return results, np.maximum(over, self._over(late, machines, columns, count)), columns["mean_velocity"] == 0.0

    def _results(self, machines: Any, count: int, rtol: float | None = None) -> tuple[Array, dict[str, Array]]:
        """The objective, and columns for limits; over a sample their quantile and their worst."""
        if self.sample is None:
            columns = results_of(machines, count, self.workers, rtol=rtol or self.rtol, watch=self.watch)
            return self.sign * columns.get(self.quantity, np.full(count, np.nan)), columns
        many, cases = sampled(machines, count, self.sample)
        columns = results_of(many, cases, self.workers, rtol=rtol or self.rtol, watch=self.watch)
        each = self.sign * columns.get(self.quantity, np.full(cases, np.nan)).reshape(count, -1)
        kept: dict[str, Array] = {"mean_velocity": columns["mean_velocity"].reshape(count, -1).mean(axis=1)}
        kept |= {limit.name: _worst_of(limit, columns[limit.name].reshape(count, -1)) for limit in self.limits if not limit.of_drive}
        return (each.max(axis=1) if self.quantile is None else np.quantile(each, 1.0 - self.quantile, axis=1)), kept

    @property
    def bounding(self) -> list[Limit]:
        """The limits that candidates can be beyond."""
        return [limit for limit in self.limits if not (limit.of_drive and self._is_kept(limit))]

    def _is_kept(self, limit: Limit) -> bool:
        """Whether all drives are waveforms, which keep the limit by themselves."""
        drives, forms = list(drives_within(self.space.model)), [each for each in self.space.varied if each.form is not None]
        return len(drives) == len(forms) and np.isinf(limit.low)

    def _over(self, limits: list[Limit], machines: Any, columns: dict[str, Array], count: int) -> Array:
        """By how much each candidate is beyond its limits, the worst of them."""
        over = np.zeros(count)
        for limit in limits:
            values = np.broadcast_to(limit.values(machines, columns), (count,))
            worst = -np.min(limit.margins(values), axis=0)
            over = np.maximum(over, np.where(worst > KEPT, worst, np.where(np.isnan(worst), 1e3, 0.0)))
            if not np.all(np.isnan(worst)):
                k = int(np.nanargmin(worst))
                if worst[k] < self.nearest.get(limit.name, (np.inf, 0.0))[0]:
                    self.nearest[limit.name] = (float(worst[k]), float(values[k]))
        return over

    # ------------------------------------------------------------------------------------------------ derivatives

    def slope(self, u: Array) -> Array:
        """Derivatives of the objective, without its limits, by the unknowns: exact where `exactly` knows them."""
        if self.sample is None and not not_followed(self.space.model):
            try:
                exact = self._exact(u)
                if np.isfinite(exact).all():
                    return exact
            except StickslipError:
                pass
        return self._differences(u)

    def _exact(self, u: Array) -> Array:
        machine, slopes = self.space.machine(u), self.space.slopes(u)
        self._orbit = periodic_orbit(machine, 1 if self._orbit is None else self._orbit.period, guess=self._orbit)
        at, count = coordinates(machine), self.space.count
        exact = exactly(self.quantity, machine, at, slopes, count)
        if exact is None:
            return np.full(count, np.nan)
        along = Closing(machine, at, slopes, count, self._orbit.rtol, means=exact.means)
        return self.sign * exact.of(along.at_state(self._orbit.state[None], self._orbit.period))[1][0]

    def _differences(self, u: Array) -> Array:
        """Central differences, as far as the bounds leave room."""
        n = self.space.count
        ends = np.clip(np.vstack([u + _STEP * np.eye(n), u - _STEP * np.eye(n)]), 0.0, 1.0)
        machines, good = self._machines(ends)
        values = np.full(2 * n, np.nan)
        if len(good):
            values[good] = self._results(machines, len(good), _FINE)[0]
        width = np.diag(ends[:n] - ends[n:])
        return np.nan_to_num((values[:n] - values[n:]) / width)

    def margins(self, U: Array) -> Array:
        """How far within all limits each row is: array (sides, rows)."""
        machines, good = self._machines(np.atleast_2d(U))
        sides = sum(np.isfinite(end) for limit in self.bounding for end in (limit.low, limit.high))
        whole = np.full((sides, len(np.atleast_2d(U))), -1.0)
        if not len(good):
            return whole
        columns = self._results(machines, len(good), _FINE)[1] if any(not limit.of_drive for limit in self.bounding) else {}
        margins = [limit.margins(np.broadcast_to(limit.values(machines, columns), (len(good),))) for limit in self.bounding]
        whole[:, good] = np.nan_to_num(np.concatenate(margins), nan=-1.0)
        return whole


def _worst_of(limit: Limit, values: Array) -> Array:
    """Of each candidate the value that is furthest beyond a limit."""
    margins = np.min(limit.margins(values), axis=0)
    return np.take_along_axis(values, np.argmin(np.nan_to_num(margins, nan=-np.inf), axis=1)[:, None], axis=1)[:, 0]
