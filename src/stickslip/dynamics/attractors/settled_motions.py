"""Whether starts have settled, and on what: one rule for basins, attractors, bifurcation diagrams, atlases and maps of motions.

A start whose strobe points do not repeat yet is run on, each time twice as long, up to a limit. What still moves then is looked at over a
long stretch, and is called by what that shows:

- *periodic*: its strobe points repeat; or a stable orbit of Newton's method is near, and the distance from it shrinks as the
  derivative of the strobe map along that orbit says.
- *quasi-periodic*: its strobe points wind round one closed curve, with a rotation number that is no fraction of a period that is looked
  for; weighted means of the two halves of the stretch agree, as those of a smooth torus do and those of a chaotic motion or of a transient
  do not; neighbours part no faster than linearly, and volumes of states are not preserved.
- *chaotic*: the largest Lyapunov exponent is positive by more than three of its standard errors, volumes are not preserved, and no other
  start of the group left such a motion late: a chaotic transient has a positive exponent too, but an end.
- *runs away*: the state grows without bound.
- *not settled*: everything else, with the reason. A start on a periodic motion that a nudge leaves, where it stays by its symmetry alone,
  is none of that motion's either.
"""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from stickslip.basics.batch import some_of
from stickslip.basics.contracts import Array
from stickslip.basics.errors import Problems, is_whole
from stickslip.basics.executors import HERE, Workers
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import Ending, partial_result
from stickslip.dynamics.attractors.kinds_of_motion import (
    ATTRACTING,
    CHAOTIC,
    PERIODIC,
    QUASI_PERIODIC,
    RUNS_AWAY,
    STEADY,
    UNSETTLED,
    UNSOLVED,
)
from stickslip.dynamics.attractors.motions_without_period import GroupOfStarts, late_ends
from stickslip.dynamics.attractors.period_numbers import POINTS
from stickslip.dynamics.attractors.starts_run_on import NUDGE, NUDGED, ROUNDED, STRETCH, StartsRun, WatchedStarts
from stickslip.dynamics.stroboscopic.chunked_runs import Report, Tell, over_chunks
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates

_LEFT = 10.0  # times as large: a nudge that has grown so much was given to an unstable motion
LIMIT = 8  # times the drive periods of settling: how long a start is run on, unless a limit is given


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
    times : array (cases, points), long_times : dict of array (points,)
        How long each return to the section took [s], of models without a period; NaN of others.
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
    times: Array
    long_times: dict[int, Array]

    @property
    def attracted(self) -> Array:
        """Which starts are on an attractor."""
        return np.isin(self.kind, ATTRACTING)

    def beginning_with(self, first: Settled) -> Settled:
        """The same with the results of the first starts replaced by those of others."""
        n = len(first.kind)
        names = ("kind", "period", "points", "ways", "times", "exponent", "error", "run", "why")
        whole: dict[str, Any] = {name: np.concatenate([getattr(first, name), getattr(self, name)[n:]]) for name in names}
        longs: dict[str, Any] = {
            name: getattr(first, name) | {i: long for i, long in getattr(self, name).items() if i >= n} for name in ("long", "long_times")
        }
        return Settled(ending=self.ending, **longs, **whole)

    def reasons(self) -> list[str]:
        """Why starts have not settled, each with the number of starts."""
        left = self.why[self.kind == UNSETTLED]
        return [f"{np.count_nonzero(left == why)} of {len(self.kind)} starts: {why}" for why in dict.fromkeys(left.tolist())]


def motion_times(settled: Settled) -> Array:
    """How long motions of models without a period take until they repeat [s]: array (cases,); NaN of what does not."""
    p, count = settled.period[:, None], settled.times.shape[1]
    last = np.arange(count) >= count - p
    return np.where((p[:, 0] > 0) & (p[:, 0] <= count), np.where(last, settled.times, 0.0).sum(axis=1), np.nan)


def checked_limit(problems: Problems, settle: Any, limit: Any) -> int:
    """The limit of a run in drive periods, as given or by default; a problem where it is shorter than settling."""
    if limit is None:
        return LIMIT * int(settle) if is_whole(settle) else 0
    if not is_whole(limit) or (is_whole(settle) and limit < settle):
        allowed = f"allowed is a whole number of drive periods from settle = {settle} on, or None for {LIMIT} times settle"
        problems.add(f"limit = {limit!r}; {allowed}; type limit=3000")
        return 0
    return int(limit)


@dataclass(frozen=True)
class Settling:
    """How long starts are run until they have settled, and what of them is looked at.

    Parameters
    ----------
    settle, limit : int
        Drive periods before the first look, and after which no start is run on.
    rtol : float
        Tolerance of the runs.
    points : int
        Strobe points to record.
    exponents : int
        Drive periods over which exponents are averaged; 600 where fewer do not tell them from zero.
    """

    settle: int
    limit: int
    rtol: float
    points: int = POINTS
    exponents: int = STRETCH


#: The models of some starts, their states and coordinates.
_Starts = tuple[Any, Array, Coordinates]


def settled_motions(
    batch: Any, states: Array, at: Coordinates, how: Settling, *, groups: Array | None = None, workers: Workers = HERE,
    progress: Report | None = None, partly: bool = False,
) -> Settled:  # fmt: skip
    """Run starts until they have settled, up to a limit, and say on what.

    Parameters
    ----------
    batch : Robot, machine or SwitchingFlow
        A batch of as many cases as there are starts.
    states : array (cases, coordinates)
        The starts.
    how : Settling
        How long they are run.
    groups : array (cases,), optional
        Starts of one model have one number: one orbit may explain several of them, and a late end of one transient speaks against chaos of
        the others. All starts if not given.
    partly : bool
        Whether an interruption gives the starts that are done; else it goes on to the caller.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.dynamics.stroboscopic.strobe_maps import coordinates
    >>> logistic = ss.SwitchingFlow.of_map(lambda y, n: (n.r * y[0] * (1 - y[0]),), {"r": [2.8, 3.2, 3.9, 4.5]}, ("x",))
    >>> found = settled_motions(logistic, np.full((4, 2), [0.3, 0.0]), coordinates(logistic), Settling(100, 800, 1e-7), groups=np.arange(4))
    >>> found.kind.tolist(), found.period.tolist()
    (['periodic', 'periodic', 'chaotic', 'runs away'], [1, 2, 0, 0])
    """
    cases = len(states)
    groups = np.zeros(cases, int) if groups is None else groups
    whole = WatchedStarts(at, cases, states.shape[1], how.points)

    def starts(part: slice) -> _Starts:
        return some_of(batch, part), np.array(states[part], float), at.of(part)

    work = partial(_watched, how)
    with partial_result() if partly else nullcontext(Ending()) as ending:
        for part, watched in over_chunks(cases, starts, work, workers, progress):
            whole.put(part, watched)
    left = np.flatnonzero(whole.kind == UNSETTLED)
    for group in np.unique(groups[left]):
        own = np.flatnonzero(groups == group)
        looked = np.array([i for i in np.intersect1d(left, own).tolist() if i in whole.long], int)
        if len(looked):
            GroupOfStarts(batch, whole, how.rtol, looked, late_ends(whole, own)).judge()
    _off_the_section(whole)
    _on_unstable_motions(whole)
    whole.period[np.isin(whole.kind, (UNSOLVED, RUNS_AWAY, UNSETTLED))] = 0
    why = np.where(whole.kind == UNSETTLED, whole.why, "")
    return Settled(
        whole.kind, whole.period, whole.points, whole.ways, whole.long, whole.exponent, whole.error, whole.run, why, ending,
        whole.times, whole.long_times,
    )  # fmt: skip


def _watched(how: Settling, starts: _Starts, tell: Tell) -> WatchedStarts:
    """Run some starts until they have settled."""
    run = StartsRun(*starts, how.rtol, how.points)
    run.settle(how.settle, how.limit, tell)
    run.nudge()
    run.look_long(how.exponents)
    return run.watched


def _off_the_section(whole: WatchedStarts) -> None:
    """Of a model without a period: what moves and does not come back to the section in time is looked at at any times, and not known."""
    section = whole.at.section
    if section is None:
        return
    longest = section.turns * np.broadcast_to(np.asarray(section.longest, float), whole.kind.shape)
    late = np.any(whole.times >= (1.0 - ROUNDED) * longest[:, None], axis=1)
    for i in np.flatnonzero(late & np.isin(whole.kind, (PERIODIC, QUASI_PERIODIC, CHAOTIC, UNSETTLED))).tolist():
        where = f"it moves, and does not come back to the section ({section.of([i]) if np.ndim(section.value) else section})"
        whole.kind[i], whole.why[i] = UNSETTLED, f"{where} within {longest[i]:.4g}; type section=(name, value) for one that it passes"


def _on_unstable_motions(whole: WatchedStarts) -> None:
    """Starts on periodic motions that a nudge leaves have not settled."""
    unit = "drive periods" if whole.at.section is None else "returns"
    for i in np.flatnonzero(np.isin(whole.kind, (PERIODIC, STEADY)) & (whole.leaves > _LEFT)).tolist():
        grown = f"a nudge of {NUDGE:g} of the scales grows {whole.leaves[i]:.3g}-fold in {NUDGED} {unit}"
        lies = f"on an unstable motion of period {whole.period[i]}" if whole.kind[i] == PERIODIC else "at an unstable rest"
        whole.kind[i], whole.why[i] = UNSETTLED, f"the start lies {lies}: {grown}; move it aside"
