"""Starts that are run until they repeat or a limit is reached, and what is left over a long stretch: see `settled_motions`."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.batch import some_of
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import StickslipError
from stickslip.basics.status import Status
from stickslip.dynamics.attractors.kinds_of_motion import NOT_COMPUTED, PERIODIC, RUNS_AWAY, STEADY, UNDONE, UNSETTLED, UNSOLVED
from stickslip.dynamics.attractors.period_numbers import LONGEST, POINTS, periods_of, return_tolerance, rows_of_points
from stickslip.dynamics.exponents.motion_exponents import exponents_from
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, Ends, strobe_map, strobe_points
from stickslip.engine.texts import recurrence
from stickslip.results.recurrence import scales_of

if TYPE_CHECKING:
    pass

STRETCH = 600  # drive periods over which a motion without a period is looked at
ERRORS = 3.0  # a positive exponent is so many of its standard errors from zero
NUDGE, NUDGED = 1e-6, 128  # in scales: how far a start is moved aside, and for how many drive periods it is watched then
_EARLY = 24  # drive periods after which it is asked whether a state stands still to the last bit
_FAR = 1e4  # in scales: a state beyond this, which has grown by half in each of the last stages, runs away
_ROUNDING = 1e-14  # in scales: what a return to a section makes of a state that comes back
_NEAR, _NEARER, _RETURNS = 1e-7, 0.5, 8  # of the tolerance of returns; of the distance before; so many returns are looked at
_WITHIN = 0.37  # of a return: the instant at which a motion that is no rest is somewhere else
_STILL = 10.0  # times the tolerance of returns: what moves by less stands still
ROUNDED = 1e-12  # of the longest time of a return: what took so long did not come back
_AWAY = 1e-3  # in scales: what moves by more in that time is not about to come to rest


class WatchedStarts:
    """What is known of some starts: arrays with a row for each."""

    def __init__(self, at: Coordinates, cases: int, d: int, points: int):
        self.at, self.count = at, points
        self.points, self.ways, self.times = np.full((cases, points, d), np.nan), *np.full((2, cases, points), np.nan)
        self.kind, self.period = np.full(cases, NOT_COMPUTED, dtype="<U16"), np.full(cases, UNDONE)
        self.exponent, self.error, self.run = np.full(cases, np.nan), np.full(cases, np.nan), np.zeros(cases, int)
        self.why, self.long, self.long_times = np.full(cases, "", dtype="<U300"), dict[int, Array](), dict[int, Array]()
        self.grows = np.zeros(cases, bool)  # far away, and ever farther
        self.leaves = np.zeros(cases)  # how many times as large a nudge has become, of starts that never moved from a periodic motion
        self.half, self.end = np.zeros(cases, bool), np.zeros(cases, bool)  # irregular when the second half of the run began, at its end

    def put(self, part: slice, watched: WatchedStarts) -> None:
        """Note what is known of a part."""
        names = ("points", "ways", "times", "kind", "period", "exponent", "error", "run", "why", "grows", "leaves", "half", "end")
        for name in names:
            getattr(self, name)[part] = getattr(watched, name)
        self.long |= {part.start + i: long for i, long in watched.long.items()}
        self.long_times |= {part.start + i: times for i, times in watched.long_times.items()}


class StartsRun:
    """Starts that run side by side until they repeat, or the limit is reached."""

    def __init__(self, batch: Any, states: Array, at: Coordinates, rtol: float, points: int):
        self.batch, self.at, self.rtol, self.starts = batch, at, rtol, states
        self.tolerance, self.watched = return_tolerance(rtol), WatchedStarts(at, states.shape[0], states.shape[1], points)
        self.left = np.zeros(0, int)
        self.sizes: list[Array] = []  # of all states in their scales, after each stage

    def settle(self, first: int, limit: int, tell: Callable[[float], None]) -> None:
        """Run all for the first drive periods and what does not repeat twice as long each time, up to the limit."""
        rows, count = np.arange(len(self.starts)), self.watched.count
        self._take(rows, _first(self.batch, self.starts, self.at, first, self.rtol, count, tell), first)
        total, halfway = first, limit // 2
        while len(self.left):
            if total >= halfway and not self.watched.half.any():
                self.watched.half[self.left] = ~self._closing_in(self.left)
            if total >= limit:
                break
            step, rows = min(total, limit - total), self.left
            self._take(
                rows,
                _later(some_of(self.batch, rows), self.watched.points[rows, -1], self.at.of(rows), step, self.rtol, count),
                total + step,
            )
            total += step
            tell(0.2 + 0.4 * total / limit)
        self.watched.end[self.left] = ~self._closing_in(self.left)
        self._mark_what_stands_still()

    def _mark_what_stands_still(self) -> None:
        """Of a model without a period: a state that comes back because it does not change is no oscillation."""
        watched = self.watched
        rows = np.flatnonzero((watched.kind == PERIODIC) & (watched.period == 1))
        if self.at.section is None or not len(rows):
            return
        own, states = self.at.of(rows), watched.points[rows, -1]
        soon = replace(own, section=replace(own.section, longest=_WITHIN * watched.times[rows, -1] / own.section.turns, turns=1))
        within = strobe_map(some_of(self.batch, rows), states, 1, self.rtol, soon).state
        still = rows[own.distance(within, states) <= _STILL * self.tolerance]
        watched.kind[still], watched.period[still] = STEADY, 0

    def _take(self, rows: Array, result: tuple[Any, ...], total: int) -> None:
        """Note what a look shows: what repeats is settled, what is not solved has ended, and the rest is left."""
        watched = self.watched
        watched.points[rows], watched.ways[rows], watched.times[rows], good = result
        fine = good & np.isfinite(watched.points[rows]).all(axis=(1, 2))
        period = np.where(fine, periods_of(*self.at.embedded(watched.points[rows]), self.tolerance), 0)
        watched.period[rows], watched.run[rows] = period, total
        watched.kind[rows] = np.where(period > 0, PERIODIC, np.where(fine, UNSETTLED, UNSOLVED))
        self.left = rows[fine & (period == 0) & ~self._gone(rows)]
        with np.errstate(invalid="ignore"):
            self.sizes.append(np.max(abs(self.at.wrapped(watched.points[:, -1])) / self.at.scales, axis=1))

    def _gone(self, rows: Array) -> Array:
        """Which starts never come back to the section, and still move: they are not run on, as more returns show nothing else."""
        section = self.at.section
        if section is None:
            return np.zeros(len(rows), bool)
        longest = section.turns * np.broadcast_to(np.asarray(section.longest, float), self.watched.kind.shape)[rows]
        late = np.all(self.watched.times[rows] >= (1.0 - ROUNDED) * longest[:, None], axis=1)
        steps = self.at.distance(self.watched.points[rows, 1:], self.watched.points[rows, :-1])
        return np.asarray(late & np.all(steps > _AWAY, axis=1))

    def _closing_in(self, rows: Array) -> Array:
        """Which starts come steadily nearer to a periodic motion, and so are not irregular."""
        ask, scales, last = recurrence().approach, scales_of(self.at.scales), self.watched.count - 1
        return np.array([bool(ask(rows_of_points(self.watched.points[i]), last, last, LONGEST, scales)) for i in rows], bool)

    def nudge(self) -> None:
        """Nudge the starts that are on their motion from the first: what stays on an unstable one, or at rest, by chance leaves it then."""
        watched, at = self.watched, self.at
        repeats = np.flatnonzero(np.isin(watched.kind, (PERIODIC, STEADY)))
        back = [np.min(at.distance(watched.points[i, -watched.period[i] :], self.starts[i])) for i in repeats]
        rows = repeats[np.array(back) <= self.tolerance] if back else repeats
        if not len(rows):
            return
        states, nudge = watched.points[rows, -1], np.zeros(len(at.names))
        nudge[at.free] = NUDGE * (-1.0) ** np.arange(len(at.free))
        both = np.vstack([states, states + nudge * at.scales])
        twice = np.tile(rows, 2)
        after = strobe_map(some_of(self.batch, twice), both, NUDGED, self.rtol, at.of(twice)).state
        with np.errstate(invalid="ignore"):
            watched.leaves[rows] = np.nan_to_num(at.distance(after[len(rows) :], after[: len(rows)]) / NUDGE)

    def look_long(self, exponents: int) -> None:
        """Run what is left over a long stretch, and measure its exponents; find what ran away."""
        watched, rows = self.watched, self.left
        if len(rows):
            model, begun, count = some_of(self.batch, rows), watched.points[rows, -1], max(STRETCH, watched.count)
            kept, ways, times = strobe_points(model, begun, count, self.rtol, self.at.of(rows))
            states = np.moveaxis(kept, 0, 1)
            watched.long_times = {int(i): time for i, time in zip(rows, times.T, strict=True)}
            watched.long = {int(i): np.column_stack([state, way]) for i, state, way in zip(rows, states, ways.T, strict=True)}
            good = np.isfinite(states).all(axis=(1, 2))
            last = slice(-watched.count, None)
            self._take(rows, (states[:, last], ways.T[:, last], times.T[:, last], good), int(watched.run[rows].max()) + count)
            rows = self.left
        if len(rows):
            start, apart = np.array([watched.long[int(i)][0, :-1] for i in rows]), max(1e-7, 100 * self.rtol)
            for periods in dict.fromkeys((exponents, max(exponents, STRETCH))):  # longer where the first is not sure
                value, error = watched.exponent[rows], watched.error[rows]
                unsure = np.flatnonzero(~(abs(value) > ERRORS * error))
                if len(unsure):
                    own = some_of(self.batch, rows[unsure])
                    exponents_now = exponents_from(own, start[unsure], periods, rtol=self.rtol, apart=apart, at=self.at.of(rows[unsure]))
                    watched.exponent[rows[unsure]], watched.error[rows[unsure]] = exponents_now
            sizes = np.array(self.sizes[-3:])[:, rows]
            watched.grows[rows] = (sizes[-1] > _FAR) & np.all(sizes[1:] > 1.5 * sizes[:-1], axis=0)
        lost = np.flatnonzero(watched.kind == UNSOLVED)
        if len(lost):
            watched.kind[lost[self._run_away(lost)]] = RUNS_AWAY

    def _run_away(self, rows: Array) -> Array:
        """Which runs that could not be solved had grown beyond all bounds before."""
        model, state, smooth = some_of(self.batch, rows), self.starts[rows].copy(), self.at.smooth
        first = abs(state[:, :smooth]) / self.at.scales[:smooth]
        with suppress(StickslipError), np.errstate(all="ignore"):
            for _ in range(POINTS):
                after = strobe_map(model, state, 1, self.rtol, self.at.of(rows)).state
                fine = np.isfinite(after).all(axis=1)
                state[fine] = after[fine]
                if not fine.any():
                    break
        last = np.abs(np.vstack([state, self.at.of(rows).before_end(model, state)])[:, :smooth]) / self.at.scales[:smooth]
        most = last.reshape(-1, len(rows), smooth).max(axis=(0, 2), initial=0.0)
        return np.asarray(most > np.minimum(_FAR, 1e2 * (1.0 + first.max(axis=1, initial=0.0))))  # squared, a number is soon infinite


def _first(model: Model, states: Array, at: Coordinates, settle: int, rtol: float, points: int, tell: Any) -> tuple[Array, ...]:
    """Strobe points (cases, points, d), ways and times (cases, points) after settling, and which cases could be solved."""
    early = min(settle, _EARLY)
    begun = strobe_map(model, states, early, rtol, at)
    kept, made, times = _still(model, begun.state, at, rtol, points)
    good = begun.status <= Status.REPEATS
    tell(0.2)
    late = np.flatnonzero(np.isnan(made[:, 0]))
    if len(late):
        kept[late], made[late], times[late], solved = _later(
            some_of(model, late), begun.state[late], at.of(late), settle - early, rtol, points
        )
        good[late] &= solved
    return kept, made, times, good


def _still(model: Model, states: Array, at: Coordinates, rtol: float, points: int) -> tuple[Array, ...]:
    """Strobe points, ways and times of those states that the strobe map does not change by a single bit: all later points are the same.

    A section is met to rounding only, and runs of one return have other steps than a run of many. A state on it is taken to stay there
    if it comes back to it much nearer than the time before, by a small part of what counts as one point.

    NaN of all others.
    """
    end = strobe_map(model, states, 1, rtol, at)
    still = np.all(end.state == states, axis=1)
    if at.section is not None:
        return _still_on_a_section(model, states, end, still, at, rtol, points)
    return _repeated(
        np.where(still[:, None], states, np.nan), np.where(still, end.displacement, np.nan), np.full(len(states), np.nan), points
    )


def _still_on_a_section(
    model: Model, states: Array, end: Ends, still: Array, at: Coordinates, rtol: float, points: int
) -> tuple[Array, ...]:
    """The same of a section, after its first return."""
    before = at.distance(end.state, states)
    still = still | (before <= _ROUNDING)
    kept = np.where(still[:, None], states, np.nan)
    ways, times = np.where(still, end.displacement, np.nan), np.array(end.duration, float)
    rows, begun = np.flatnonzero(~still), end.state[~still]
    before, near = before[~still], _NEAR * return_tolerance(rtol)
    for _ in range(_RETURNS):
        if not len(rows):
            break
        after = strobe_map(some_of(model, rows), begun, 1, rtol, at.of(rows))
        away = at.distance(after.state, begun)
        come = (after.status <= Status.REPEATS) & (away <= near) & ((away <= _NEARER * before) | (away <= _ROUNDING))
        kept[rows[come]], ways[rows[come]], times[rows[come]] = after.state[come], after.displacement[come], after.duration[come]
        rows, begun, before = rows[~come], after.state[~come], away[~come]
    return _repeated(kept, ways, times, points)


def _repeated(kept: Array, ways: Array, times: Array, points: int) -> tuple[Array, ...]:
    """One point of each start, with its way and its time, as so many."""
    return tuple(np.repeat(each[:, None], points, axis=1) for each in (kept, ways, times))


def _later(model: Model, states: Array, at: Coordinates, periods: int, rtol: float, points: int) -> tuple[Array, ...]:
    """Strobe points, ways and times after some more drive periods, and what could be solved."""
    good = np.full(len(states), True)
    if periods:
        end = strobe_map(model, states, periods, rtol, at)
        states, good = end.state, end.status <= Status.REPEATS
    kept, made, times = strobe_points(model, states, points, rtol, at)
    return np.moveaxis(kept, 0, 1), made.T, times.T, good
