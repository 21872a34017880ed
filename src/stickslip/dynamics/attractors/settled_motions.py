"""Whether starts have settled, and on what: one rule for basins, attractors, bifurcation diagrams, atlases and maps of motions.

A start whose strobe points do not repeat yet is run on, each time twice as long, up to a limit. What still moves then is looked at over a
long stretch, and is called by what that shows:

- *periodic*: its strobe points repeat; or a stable orbit of Newton's method is near, and the distance from it shrinks as the
  derivative of the strobe map along that orbit says.
- *quasi-periodic*: weighted means of the two halves of the stretch agree, as those of a smooth torus do and those of a chaotic motion or
  of a transient do not; neighbours part no faster than linearly, and volumes of states
  are not preserved.
- *chaotic*: the largest Lyapunov exponent is positive by more than three of its standard errors, volumes are not preserved, and no other
  start of the group left such a motion late: a chaotic transient has a positive exponent too, but an end.
- *runs away*: the state grows without bound.
- *not settled*: everything else, with the reason.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext, suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.batch import cases_of, some_of
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, Problems, SolveError, StickslipError, is_whole
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import Ending, partial_result
from stickslip.basics.status import Status
from stickslip.dynamics.exponents.motion_exponents import exponents_from
from stickslip.dynamics.exponents.rotation import smooth_weights
from stickslip.dynamics.stroboscopic.chunked_runs import Report, shared
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, difference_jacobian, strobe_map, strobe_orbit
from stickslip.engine.texts import recurrence
from stickslip.models.switching_flow import is_flow

if TYPE_CHECKING:
    from stickslip.models.switching_flow import SwitchingFlow


LONGEST = 32  # largest period number that is looked for
UNDONE = -1  # period number of what was not computed
POINTS = 64  # strobe points of a look
LIMIT = 8  # times the drive periods of settling: how long a start is run on, unless a limit is given
STRETCH = 600  # drive periods over which a motion without a period is looked at
_EARLY = 24  # drive periods after which it is asked whether a state stands still to the last bit
_RETURN = 1e-6  # strobe points closer than this, in scales, count as one

PERIODIC, QUASI_PERIODIC, CHAOTIC = "periodic", "quasi-periodic", "chaotic"
UNSETTLED, RUNS_AWAY, UNSOLVED, NOT_COMPUTED = "not settled", "runs away", "not solved", "not computed"
#: Kinds of motion that are attractors.
ATTRACTING = (PERIODIC, QUASI_PERIODIC, CHAOTIC)
#: All kinds, in the order of legends and tables.
KINDS = (*ATTRACTING, UNSETTLED, RUNS_AWAY, UNSOLVED, NOT_COMPUTED)
#: What the numbers of a motion beside its period are.
OF_MOTIONS = {
    "motion": {"long_name": "motion: periodic, quasi-periodic, chaotic, not settled, runs away, not solved, not computed"},
    "exponent": {"long_name": "largest Lyapunov exponent per drive period", "units": "1"},
    "error": {"long_name": "standard error of the exponent", "units": "1"},
    "run": {"long_name": "drive periods until it was recognised, or given up", "units": "1"},
}

_AGREE = 1e-3  # of the spread: weighted means of two halves of a quasi-periodic motion differ by less
_ERRORS = 3.0  # a positive exponent is so many of its standard errors from zero
_ZERO = 1e-3  # per drive period: smaller exponents are not told from zero by a stretch
_LINEAR = 2.0  # times log(n)/n: the exponent of neighbours that part linearly in n periods, as on a torus with shear
_PRESERVED = 1e-4  # per drive period: mean logarithm of volumes of what neither shrinks nor grows
_VOLUMES = 16  # strobe points at which volumes are measured
_NEAR = 0.05  # in scales: a start that closes in on an orbit is nearer than this
_RATE = 0.5  # of the orbit's own rate: how fast it must close in at least
_CARRIED = 0.05  # of a difference from an orbit: how far it may be from what the derivative says of it
_SLOW = 3.0  # e-foldings of a stretch: an orbit that attracts more slowly
_TRIES = 4  # orbits that are looked for in a group, at most one for each start
_FAR = 1e4  # in scales: a state beyond this, which has grown by half in each of the last stages, runs away
_HALVINGS = 30  # of a drive period, in search of the instant at which a run ends
_EXPECTED = 5.0  # ends of transients that should have been seen, had the rate of before gone on, where none was: e^-5 < 1 %


@sealed
class Settled:
    """What starts have settled on: one row for each.

    Parameters
    ----------
    kind : array of str (cases,)
        One of `KINDS`.
    period : array (cases,)
        Drive periods until it repeats; 0: it does not up to 32, -1: not computed.
    points : array (cases, points, coordinates)
        Strobe points at the end of the run, NaN where there are none.
    ways : array (cases, points)
        Displacement in each drive period [m].
    long : dict of array (points, coordinates)
        By case, the long stretch of what has no period.
    exponent, error : array (cases,)
        Largest Lyapunov exponent per drive period and its standard error of what has no period; NaN of what has one.
    run : array (cases,)
        Drive periods until it was recognised, or given up.
    why : array of str (cases,)
        Why a start has not settled; empty of others.
    ending : Ending
        Whether that was interrupted, so that the rest is not computed.
    """

    kind: Array
    period: Array
    points: Array
    ways: Array
    long: dict[int, Array]
    exponent: Array
    error: Array
    run: Array
    why: Array
    ending: Ending

    @property
    def attracted(self) -> Array:
        """Which starts are on an attractor."""
        return np.isin(self.kind, ATTRACTING)

    def beginning_with(self, first: Settled) -> Settled:
        """The same with the results of the first starts replaced by those of others."""
        n = len(first.kind)
        names = ("kind", "period", "points", "ways", "exponent", "error", "run", "why")
        whole = {name: np.concatenate([getattr(first, name), getattr(self, name)[n:]]) for name in names}
        return Settled(ending=self.ending, long=first.long | {i: long for i, long in self.long.items() if i >= n}, **whole)

    def reasons(self) -> list[str]:
        """Why starts have not settled, each with the number of starts."""
        left = self.why[self.kind == UNSETTLED]
        return [f"{np.count_nonzero(left == why)} of {len(self.kind)} starts: {why}" for why in dict.fromkeys(left.tolist())]


def checked_limit(problems: Problems, settle: Any, limit: Any) -> int:
    """The limit of a run in drive periods, as given or by default; a problem where it is shorter than settling."""
    if limit is None:
        return LIMIT * int(settle) if is_whole(settle) else 0
    if not is_whole(limit) or (is_whole(settle) and limit < settle):
        allowed = f"allowed is a whole number of drive periods from settle = {settle} on, or None for {LIMIT} times settle"
        problems.add(f"limit = {limit!r}; {allowed}; type limit=3000")
        return 0
    return int(limit)


def settled_motions(
    batch: Any, states: Array, at: Coordinates, settle: int, limit: int, rtol: float, *, groups: Array | None = None, points: int = POINTS,
    exponents: int = STRETCH, workers: int = 1, progress: Report | None = None, partly: bool = False,
) -> Settled:  # fmt: skip
    """Run starts until they have settled, up to a limit, and say on what.

    Parameters
    ----------
    batch : Robot, machine or SwitchingFlow
        A batch of as many cases as there are starts.
    states : array (cases, coordinates)
        The starts.
    settle, limit : int
        Drive periods before the first look, and after which no start is run on.
    groups : array (cases,), optional
        Starts of one model have one number: one orbit may explain several of them, and a late end of one transient speaks against chaos of
        the others. All starts if not given.
    points : int
        Strobe points to record.
    exponents : int
        Drive periods over which exponents are averaged; 600 where fewer do not tell them from zero.
    partly : bool
        Whether an interruption gives the starts that are done; else it goes on to the caller.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.dynamics.stroboscopic.strobe_maps import coordinates
    >>> logistic = ss.SwitchingFlow.of_map(lambda y, n: (n.r * y[0] * (1 - y[0]),), {"r": [2.8, 3.2, 3.9, 4.5]}, ("x",))
    >>> found = settled_motions(logistic, np.full((4, 2), [0.3, 0.0]), coordinates(logistic), 100, 800, 1e-7, groups=np.arange(4))
    >>> found.kind.tolist(), found.period.tolist()
    (['periodic', 'periodic', 'chaotic', 'runs away'], [1, 2, 0, 0])
    """
    cases = len(states)
    groups = np.zeros(cases, int) if groups is None else groups
    whole = _Watched(at, cases, states.shape[1], points)

    def work(part: slice, tell: Callable[[float], None]) -> _Watched:
        run = _Run(some_of(batch, part), np.array(states[part], float), at, rtol, points)
        run.settle(settle, limit, tell)
        run.look_long(exponents)
        return run.seen

    with partial_result() if partly else nullcontext(Ending()) as ending:
        for part, watched in shared(cases, work, workers, progress):
            whole.put(part, watched)
    left = np.flatnonzero(whole.kind == UNSETTLED)
    for group in np.unique(groups[left]):
        own = np.flatnonzero(groups == group)
        _Group(batch, whole, rtol, np.intersect1d(left, own), _late_ends(whole, own)).judge()
    return whole.settled(ending)


class _Watched:
    """What is known of some starts: arrays with a row for each."""

    def __init__(self, at: Coordinates, cases: int, d: int, points: int):
        self.at, self.count = at, points
        self.points, self.ways = np.full((cases, points, d), np.nan), np.full((cases, points), np.nan)
        self.kind, self.period = np.full(cases, NOT_COMPUTED, dtype="<U16"), np.full(cases, UNDONE)
        self.exponent, self.error, self.run = np.full(cases, np.nan), np.full(cases, np.nan), np.zeros(cases, int)
        self.why, self.long = np.full(cases, "", dtype="<U200"), dict[int, Array]()
        self.grows = np.zeros(cases, bool)  # far away, and ever farther
        self.half, self.end = np.zeros(cases, bool), np.zeros(cases, bool)  # irregular when the second half of the run began, at its end

    def put(self, part: slice, watched: _Watched) -> None:
        """Note what is known of a part."""
        for name in ("points", "ways", "kind", "period", "exponent", "error", "run", "why", "grows", "half", "end"):
            getattr(self, name)[part] = getattr(watched, name)
        self.long |= {part.start + i: long for i, long in watched.long.items()}

    def settled(self, ending: Ending) -> Settled:
        """The result."""
        self.period[np.isin(self.kind, (UNSOLVED, RUNS_AWAY, UNSETTLED))] = 0
        why = np.where(self.kind == UNSETTLED, self.why, "")
        return Settled(self.kind, self.period, self.points, self.ways, self.long, self.exponent, self.error, self.run, why, ending)


class _Run:
    """Starts that run side by side until they repeat, or the limit is reached."""

    def __init__(self, batch: Any, states: Array, at: Coordinates, rtol: float, points: int):
        self.batch, self.at, self.rtol, self.starts = batch, at, rtol, states
        self.tolerance, self.seen = return_tolerance(rtol), _Watched(at, states.shape[0], states.shape[1], points)
        self.left = np.zeros(0, int)
        self.sizes: list[Array] = []  # of all states in their scales, after each stage

    def settle(self, first: int, limit: int, tell: Callable[[float], None]) -> None:
        """Run all for the first drive periods and what does not repeat twice as long each time, up to the limit."""
        rows, count = np.arange(len(self.starts)), self.seen.count
        self._take(rows, _first(self.batch, self.starts, self.at, first, self.rtol, count, tell), first)
        total, halfway = first, limit // 2
        while len(self.left):
            if total >= halfway and not self.seen.half.any():
                self.seen.half[self.left] = ~self._closing_in(self.left)
            if total >= limit:
                break
            step, rows = min(total, limit - total), self.left
            self._take(rows, _later(some_of(self.batch, rows), self.seen.points[rows, -1], step, self.rtol, count), total + step)
            total += step
            tell(0.2 + 0.4 * total / limit)
        self.seen.end[self.left] = ~self._closing_in(self.left)

    def _take(self, rows: Array, result: tuple[Any, ...], total: int) -> None:
        """Note what a look shows: what repeats is settled, what is not solved has ended, and the rest is left."""
        watched = self.seen
        watched.points[rows], watched.ways[rows], good = result
        fine = good & np.isfinite(watched.points[rows]).all(axis=(1, 2))
        period = np.where(fine, periods_of(watched.points[rows], self.at.scales, self.tolerance), 0)
        watched.period[rows], watched.run[rows] = period, total
        watched.kind[rows] = np.where(period > 0, PERIODIC, np.where(fine, UNSETTLED, UNSOLVED))
        self.left = rows[fine & (period == 0)]
        with np.errstate(invalid="ignore"):
            self.sizes.append(np.max(abs(watched.points[:, -1]) / self.at.scales, axis=1))

    def _closing_in(self, rows: Array) -> Array:
        """Which starts come steadily nearer to a periodic motion, and so are not irregular."""
        ask, scales, last = recurrence().approach, np.array(self.at.scales, float), self.seen.count - 1
        return np.array([bool(ask(_rows(self.seen.points[i]), last, last, LONGEST, scales)) for i in rows], bool)

    def look_long(self, exponents: int) -> None:
        """Run what is left over a long stretch, and measure its exponents; find what ran away."""
        watched, rows = self.seen, self.left
        if len(rows):
            model, begun, count = some_of(self.batch, rows), watched.points[rows, -1], max(STRETCH, watched.count)
            kept, ways = strobe_orbit(model, begun, count, self.rtol)
            states = np.moveaxis(kept, 0, 1)
            watched.long = {int(i): np.column_stack([state, way]) for i, state, way in zip(rows, states, ways.T, strict=True)}
            good = np.isfinite(states).all(axis=(1, 2))
            self._take(rows, (states[:, -watched.count :], ways.T[:, -watched.count :], good), int(watched.run[rows].max()) + count)
            rows = self.left
        if len(rows):
            start, apart = np.array([watched.long[int(i)][0, :-1] for i in rows]), max(1e-7, 100 * self.rtol)
            for periods in dict.fromkeys((exponents, max(exponents, STRETCH))):  # longer where the first is not sure
                value, error = watched.exponent[rows], watched.error[rows]
                unsure = np.flatnonzero(~(abs(value) > _ERRORS * error))
                if len(unsure):
                    own = some_of(self.batch, rows[unsure])
                    exponents_now = exponents_from(own, start[unsure], periods, rtol=self.rtol, apart=apart)
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
                after = strobe_map(model, state, 1, self.rtol).state
                fine = np.isfinite(after).all(axis=1)
                state[fine] = after[fine]
                if not fine.any():
                    break
        last = np.abs(np.vstack([state, *([_before_end(model, state)] if is_flow(model) else [])])[:, :smooth]) / self.at.scales[:smooth]
        most = last.reshape(-1, len(rows), smooth).max(axis=(0, 2), initial=0.0)
        return np.asarray(most > np.minimum(_FAR, 1e2 * (1.0 + first.max(axis=1, initial=0.0))))  # squared, a number is soon infinite


def _late_ends(watched: _Watched, own: Array) -> str:
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


class _Group:
    """Starts of one model without a period within the limit, and what they are."""

    def __init__(self, batch: Any, watched: _Watched, rtol: float, rows: Array, late: str):
        self.of, self.rtol, self.rows, self.late = watched, rtol, rows, late
        self.model = cases_of(some_of(batch, rows[:1]))[0]
        self.orbits: list[tuple[Array, float, Array]] = []
        self.tries = 0

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
        if period := _long_period(long[:, :-1], of.at, return_tolerance(self.rtol)):
            of.period[i], of.exponent[i], of.error[i] = period, np.nan, np.nan
            return PERIODIC, ""
        positive = exponent > max(_ERRORS * error, _ZERO)
        if _agree(long, of.at) and exponent <= _ERRORS * error + _LINEAR * np.log(len(long)) / len(long):
            return (PERIODIC, "") if not positive and self._closes_in(i) else (QUASI_PERIODIC, "")
        if positive:
            return (UNSETTLED, self.late) if self.late else (CHAOTIC, "")
        if self._closes_in(i):
            return PERIODIC, ""
        return UNSETTLED, f"still moves after {of.run[i]} drive periods, and neither repeats nor is chaotic or quasi-periodic"

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
        from stickslip.dynamics.periodic.periodic_orbits import periodic_orbit

        of = self.of
        self.tries += 1
        misses = [(float(of.at.distance(long[-1], long[-1 - p])), p) for p in range(1, LONGEST + 1)]
        for p in dict.fromkeys([1, min(misses)[1], 2]):
            with suppress(SolveError, InputError):
                orbit = periodic_orbit(self.model, p, guess=long[-1])
                if orbit.stable:
                    state = np.asarray(orbit.strobe_state, float)[None, :]
                    points = np.vstack([state, strobe_orbit(self.model, state, p, self.rtol)[0][:-1, 0]]) if p > 1 else state
                    largest = float(np.max(abs(orbit.multipliers), initial=0.0)) ** (1.0 / p)
                    orbit_found = (points, largest, np.asarray(orbit.monodromy, float))
                    if any(np.min(of.at.distance(points[0], other[0])) < 1e-6 for other in self.orbits):
                        continue
                    if _approaches(of.at, long, *orbit_found):
                        return orbit_found
        return None

    def _take(self, i: int, orbit: tuple[Array, float, Array]) -> bool:
        of, points = self.of, orbit[0]
        k = int(np.argmin(of.at.distance(points, of.points[i, -1])))
        kept, ways = strobe_orbit(self.model, points[[k]], of.count, self.rtol)
        of.points[i], of.ways[i], of.period[i] = kept[:, 0], ways[:, 0], len(points)
        of.exponent[i] = of.error[i] = np.nan
        return True

    def _volumes(self, i: int) -> float:
        """Mean logarithm of the growth of volumes of states in a drive period."""
        of, long = self.of, self.of.long[i][:, :-1]
        if not of.at.smooth:
            return 0.0
        logs, scales = [], of.at.scales[: of.at.smooth]
        for state in long[:: max(len(long) // _VOLUMES, 1)][:_VOLUMES]:
            M = difference_jacobian(self.model, state, 1, min(self.rtol, 1e-9)) / scales[:, None] * scales
            with np.errstate(divide="ignore"):
                logs.append(float(np.log(abs(np.linalg.det(M)))) if np.isfinite(M).all() else np.nan)
        return float(np.nanmean(np.maximum(logs, -700.0))) if np.isfinite(logs).any() or np.isneginf(logs).any() else 0.0


def _before_end(flow: SwitchingFlow, states: Array) -> Array:
    """The last states within the next period before a flow cannot be solved any more, by halving the time."""
    from stickslip.solvers.flow_engine import ends

    low, high = np.zeros(len(states)), np.ones(len(states))
    T, last = np.asarray(flow.period, float), states.copy()
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        y, _, status = ends(flow, states[:, :-1], np.round(states[:, -1]), middle * T)
        fine = (status <= Status.REPEATS) & np.isfinite(y).all(axis=1)
        last[fine, :-1] = y[fine]
        low, high = np.where(fine, middle, low), np.where(fine, high, middle)
    return last


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
    p, smooth = len(points), at.smooth
    first = int(np.argmin(at.distance(long[:p], points[0])))
    turns = (len(long) - 1 - first) // p
    early, late = (at.difference(long[k], points[0])[:smooth] / at.scales[:smooth] for k in (first, first + turns * p))
    scales = at.scales[:smooth]
    carried = np.linalg.matrix_power(derivative / scales[:, None] * scales, turns) @ early
    return bool(np.max(abs(late - carried)) <= _CARRIED * np.max(abs(late)))


def _long_period(long: Array, at: Coordinates, tolerance: float) -> int:
    """The period number of a stretch that repeats after more than 32 drive periods, 0 of others."""
    for p in range(LONGEST + 1, len(long) - POINTS):
        if at.distance(long[-1], long[-1 - p]) <= tolerance and np.all(at.distance(long[p:], long[:-p]) <= tolerance):
            return p
    return 0


def _agree(long: Array, at: Coordinates) -> bool:
    """Whether weighted means and mean squares of two halves of a stretch agree, in terms of its spread."""
    _, errors, spread = smooth_means(long[:, : at.smooth] / at.scales[: at.smooth])
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


def _first(model: Model, states: Array, at: Coordinates, settle: int, rtol: float, points: int, tell: Any) -> tuple[Array, Array, Array]:
    """Strobe points (cases, points, d), ways (cases, points) after settling, and which cases could be solved."""
    early = min(settle, _EARLY)
    begun = strobe_map(model, states, early, rtol)
    kept, made = _still(model, begun.state, rtol, points)
    good = begun.status <= Status.REPEATS
    tell(0.2)
    late = np.flatnonzero(np.isnan(made[:, 0]))
    if len(late):
        kept[late], made[late], solved = _later(some_of(model, late), begun.state[late], settle - early, rtol, points)
        good[late] &= solved
    return kept, made, good


def _still(model: Model, states: Array, rtol: float, points: int) -> tuple[Array, Array]:
    """Strobe points and ways of those states that the strobe map does not change by a single bit: all later points are the same.

    NaN of all others.
    """
    end = strobe_map(model, states, 1, rtol)
    still = np.all(end.state == states, axis=1)
    kept, ways = np.where(still[:, None], states, np.nan), np.where(still, end.displacement, np.nan)
    return np.repeat(kept[:, None], points, axis=1), np.repeat(ways[:, None], points, axis=1)


def _later(model: Model, states: Array, periods: int, rtol: float, points: int) -> tuple[Array, Array, Array]:
    """Strobe points and ways after some more drive periods, and what could be solved."""
    good = np.full(len(states), True)
    if periods:
        end = strobe_map(model, states, periods, rtol)
        states, good = end.state, end.status <= Status.REPEATS
    kept, made = strobe_orbit(model, states, points, rtol)
    return np.moveaxis(kept, 0, 1), made.T, good


# ---- period numbers ----
def return_tolerance(rtol: float) -> float:
    """How near strobe points come that count as one, in scales, by the tolerance of the run."""
    return max(_RETURN, 100 * rtol)


def _rows(points: Array) -> Array:
    """Strobe points as `recurrence` takes them, the position first."""
    return np.column_stack([np.zeros(len(points)), points])


def periods_of(points: Array, scales: Array, tolerance: float = _RETURN) -> Array:
    """Period numbers of strobe points (..., points, d): the smallest after which all of them come back; 0 if none up to 32.

    What still settles, or swings ever closer around a motion of a part of the period, has none yet; see `stickslip.results.recurrence`.
    """
    cases = points.reshape(int(np.prod(points.shape[:-2])), *points.shape[-2:])
    return np.array([_lasting(_rows(case), scales, tolerance) for case in cases], int).reshape(points.shape[:-2])


def _lasting(points: Array, scales: Array, tolerance: float) -> int:
    """The period number, if every point is on the motion, the first ones too."""
    p = repeated(points, scales, tolerance)[0]
    return p if p and (abs(points[p:, 1:] - points[:-p, 1:]) <= tolerance * scales).all() else 0


def repeated(points: Array, scales: Array, tolerance: float) -> tuple[int, int]:
    """`recurrence.period_number` of an array of strobe points, x first, up to period 32."""
    last = len(points) - 1
    return recurrence().period_number(points, last, last, LONGEST, np.array(scales, float), tolerance, tolerance)


def steady_velocity(ways: Array, period: Array, T: Any) -> Array:
    """Mean velocity [m/s] over the whole motion periods that ways [m] in drive periods T [s] hold (..., points); all where there is none.

    Examples
    --------
    >>> float(steady_velocity(np.array([1.0, 3.0, 1.0]), np.array(2), 0.5))
    4.0
    """
    points = ways.shape[-1]
    count = whole_motions(points, period)
    return np.where(np.arange(points) < count[..., None], ways, 0.0).sum(axis=-1) / (count * T)


def whole_motions(points: int, period: Array) -> Array:
    """How many of so many drive periods make whole motion periods; all where there is no period, or one that is longer.

    Examples
    --------
    >>> whole_motions(64, np.array([0, 1, 3])).tolist()
    [64, 64, 63]
    """
    return np.where((period > 0) & (period <= points), points - points % np.maximum(period, 1), points)
