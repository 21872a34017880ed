"""`atlas`: motions on a grid, completed from neighbours, then branches and borders; and an estimate of its time."""

from __future__ import annotations

import contextlib
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.basics.arguments import Executes, Maker, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, SolveError
from stickslip.basics.executors import Workers
from stickslip.basics.interruption import Ending, interruptible, look, partial_result
from stickslip.dynamics.atlas.atlas_result import Atlas, without_twins
from stickslip.dynamics.atlas.atlas_study import AtlasStudy
from stickslip.dynamics.atlas.borders_followed import Border, BordersOfBranch, PointOfBorder, follow_borders
from stickslip.dynamics.atlas.changes_between_neighbours import Change, changes, seeds_of
from stickslip.dynamics.atlas.levels import RefinementLevel, points_within, shared_upwards
from stickslip.dynamics.atlas.motions_on_the_grid import Look, PointOfGrid, motions_at, rests_of, taken_over, with_more
from stickslip.dynamics.atlas.parameter_plane import Cell, Plane, plane_over
from stickslip.dynamics.atlas.uncertain_places import UncertainPlaces, explained_by
from stickslip.dynamics.attractors.settled_motions import checked_limit
from stickslip.dynamics.attractors.starts_run_on import STRETCH
from stickslip.dynamics.continuation.branches import Branch, continuation
from stickslip.dynamics.continuation.two_parameters import special_curve
from stickslip.dynamics.stroboscopic.chunked_runs import Report, Tell, over_chunks
from stickslip.studies.progress import Watch

_TILE = 32  # points of the grid that run together and are kept together
_PROBED = 16  # points of the grid that an estimate runs
_ON_IT = 2e-3  # of the plane: a special point so near to a curve of its kind is on it


@explains_arguments
@interruptible
def atlas(
    make: Maker,
    *,
    over: dict[str, Any],
    starts: int | dict[str, Any] = 5,
    settle: int = 200,
    limit: int | None = None,
    rtol: float = 1e-7,
    section: Any = None,
    turns: int = 1,
    branches: int = 40,
    refine: int = 1,
    workers: int = 1,
    executor: Executes = None,
    out: str | Path | None = None,
    resume: bool = False,
    progress: Report | None = None,
    **fixed: Any,
) -> Atlas:
    """All motions found over two parameters of a machine or flow, the regions in which each attracts, and the borders between them.

    Runs from several starts find the motions at each point of a grid, and every motion is tried at the neighbours too. Where neighbours
    differ, a motion of one of them is followed across the plane by `continuation`; its special points there are followed in both numbers
    by `special_curve`. Borders that cannot be followed in this way are located on every grid line that they cross; `notes` lists them.

    Parameters
    ----------
    make : callable, Robot or SwitchingFlow
        A function that makes a robot from keyword arguments, or a robot or machine whose numbers have dotted names, or a flow with numbers.
        A map by ``SwitchingFlow.of_map``. Motions of a flow are named by their modes in turn, or by the number of their switches where it
        has one mode; those of a machine without a period as `ss.motion` names them.
    over : dict
        Two parameters by name, each with a range (least, largest), which is divided evenly (24 and 16 values), or with a list of ascending
        values.
    starts : int or dict
        Number of initial states at each point: rest, and states evenly scattered over twice the scales; or a grid of them as for `basins`.
    settle : int
        Drive periods to discard at least.
    limit : int, optional
        Drive periods up to which a start is run on that has not settled, eight times `settle` if not given; see `basins` for what is then
        said of it.
    rtol : float
        Tolerance of these runs for dynamic laws.
    section : str or tuple, optional
        Of a model without a period: where its motions are looked at, by the name of a state, ``section="v"``, with the value that it
        passes, ``section=("v", 0.0)``, and the direction, 1 where it rises and -1 where it falls. If not given, it is chosen from a run.
    turns : int
        Of a model without a period: after how many returns to the section it is looked at again.
    branches : int
        Largest number of motions to follow; with 0 only the grid is computed.
    refine : int
        How many times cells are halved in which the motions at some places are in doubt, most often as corners have different ones and no
        border between was followed. Each time takes about as long as the grid, or twice as long.
    workers : int
        Threads for the grid. The results do not depend on it.
    executor : executor or callable, optional
        Compute the grid there, as for `sweep`; `workers` is then the number of its workers.
    out : path, optional
        A folder to which every result is written as soon as it is found.
    resume : bool
        Continue the computation in `out`.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with a `Progress`; return False to stop. The results so far are then
        returned, as they are after Ctrl-C, and `notes` says that the rest is missing.
    **fixed
        The other arguments of `make`.

    Returns
    -------
    Atlas
        `map` (labelled Dataset), `regions`, `borders`, `special_points` with their accuracy (`special` has them as a dataset), `branches`,
        `notes`.

    Raises
    ------
    InputError
        All errors of the arguments, reported together before the computation.

    Examples
    --------
    >>> import stickslip as ss
    >>> over = {"amplitude": [3.3e-4, 3.6e-4, 3.9e-4], "mu0": [0.17, 0.18]}
    >>> atlas = ss.atlas(ss.presets.piezo_rig, over=over, tilt_deg=1.7, law="coulomb")
    >>> [border.kind for border in atlas.borders], atlas.at(amplitude=3.7e-4, mu0=0.18), atlas.at(amplitude=3.71e-4, mu0=0.18)
    (['type-border'], ('II',), ('I',))
    """
    asked = _Asked(settle, limit, rtol, branches, refine, Workers(workers, executor), resume, out)
    plane = plane_over("atlas", make, over, starts, fixed, asked.check, (section, turns))
    study = AtlasStudy(out, plane, asked.look, bool(resume))
    with asked.workers.kept() as kept:
        return _Making(plane, asked.look, study, kept, progress).made(branches, refine)


@dataclass(frozen=True)
class _Asked:
    """How a plane is looked at, as it was asked for."""

    settle: Any
    limit: Any
    rtol: Any
    branches: Any
    refine: Any
    workers: Workers
    resume: Any = False
    out: Any = None

    def check(self, problems: Problems) -> None:
        """Note everything that is wrong."""
        problems.whole("settle", self.settle, 1, example=200)
        checked_limit(problems, self.settle, self.limit)
        problems.whole("branches", self.branches, 0, example=40)
        problems.whole("refine", self.refine, 0, example=1)
        self.workers.note(problems)
        if isinstance(self.rtol, bool) or not isinstance(self.rtol, (int, float, np.number)) or not 0 < self.rtol < 1:
            problems.add(f"rtol = {self.rtol!r}; allowed is a number between 0 and 1; type rtol=1e-7")
        if self.resume and self.out is None:
            problems.add("resume is for a folder; give one with out=, such as out='atlas'")

    @property
    def look(self) -> Look:
        """What was checked, as numbers."""
        return Look(int(self.settle), checked_limit(Problems("atlas"), self.settle, self.limit), float(self.rtol))


#: Points of the grid, and more starts at each of them.
_Numbers = tuple[list[Cell], dict[Cell, Array] | None]


def _motions_at(plane: Plane, look: Look, numbers: _Numbers, tell: Tell) -> dict[Cell, PointOfGrid]:
    return motions_at(plane, numbers[0], look, numbers[1])


@dataclass
class _Making:
    """An atlas that is being made, and how that ended."""

    plane: Plane
    look: Look
    study: AtlasStudy
    workers: Workers
    progress: Any
    ending: Ending = field(default_factory=Ending)
    missed: int = 0  # motions that no start had led to
    reasons: Counter[str] = field(default_factory=Counter)
    without_curve: set[str] = field(default_factory=set)  # changes whose borders are located line by line

    def made(self, most: int, depth: int) -> Atlas:
        """All of it, or what there is when it is interrupted."""
        levels = [RefinementLevel(self.plane, {})]
        outcomes: list[BordersOfBranch] = []
        left: list[Change] = []
        with partial_result() as ending:
            self._filled(levels[0], 0, [self.plane.cell(k) for k in range(self.plane.cells)])
            left = changes(levels[0].points)
            self._follow(levels[0].points, left, outcomes, most)
            self._look_closer(levels, outcomes, depth)
        self.ending = ending
        branches = tuple(outcome.branch for outcome in outcomes if outcome.branch)
        uncertain = self._uncertain(levels, outcomes)
        notes = self._notes(levels, left, len(outcomes), most, uncertain)
        return Atlas(self.plane, levels[0].points, uncertain.borders, uncertain.points, branches, notes, tuple(levels[1:]))

    def _uncertain(self, levels: list[RefinementLevel], outcomes: list[BordersOfBranch]) -> UncertainPlaces:
        """Doubts besides the borders that were followed."""
        points = [p for outcome in outcomes for p in (*outcome.points, *(m for b in outcome.borders for m in b.special))]
        borders = tuple(border for outcome in outcomes for border in outcome.borders)
        return UncertainPlaces(tuple(levels), borders, without_twins(self.plane, points))

    # ---- the grid ----
    def _filled(self, level: RefinementLevel, depth: int, asked: list[Cell]) -> None:
        """Find the motions at points of a level, from starts, from those of neighbours, and from more starts where some were missed."""
        kept = self.study.grid(depth, asked)
        if kept is not None:
            level.points.update(kept[0])
            self.missed += kept[1]
            return
        wanted = set(asked)
        level.points.update({cell: point for cell, point in self.study.points(depth).items() if cell in wanted})
        begun = partial(self._looked_at, level.plane)
        begun([cell for cell in asked if cell not in level.points], None, level.points, partial(self.study.keep_points, level=depth))
        missed = taken_over(level.plane, level.points, lambda more: begun(list(more), more, {}))
        while more := _to_start_again(level):
            for cell, point in begun(list(more), more, {}).items():
                level.points[cell] = with_more(level.plane, level.points[cell], point, len(more[cell]))
            missed += taken_over(level.plane, level.points, lambda more: begun(list(more), more, {}))
        self.missed += missed
        self.study.keep_grid(level.points, missed, depth, asked)

    def _looked_at(
        self, plane: Plane, cells: list[Cell], more: dict[Cell, Array] | None, results: dict[Cell, PointOfGrid],
        keep: Callable[[int, dict[Cell, PointOfGrid]], None] | None = None,
    ) -> dict[Cell, PointOfGrid]:  # fmt: skip
        """The motions at some points, in parts and threads."""

        def numbers(part: slice) -> _Numbers:
            return cells[part], None if more is None else {cell: more[cell] for cell in cells[part]}

        for _, points in over_chunks(len(cells), numbers, partial(_motions_at, plane, self.look), self.workers, self.progress, _TILE):
            results |= points
            if keep:
                keep(plane.number(min(points)), points)
        return results

    def _look_closer(self, levels: list[RefinementLevel], outcomes: list[BordersOfBranch], depth: int) -> None:
        """Halve the cells in which places are in doubt, as often as is allowed."""
        for k in range(1, depth + 1):
            doubtful = self._uncertain(levels, outcomes).cells()
            finer = levels[-1].halved()
            asked = {point for cell in doubtful for point in points_within(cell)} - set(finer.points)
            if not asked:
                return
            levels.append(finer)
            self._filled(finer, k, sorted(asked))
            shared_upwards(levels)

    # ---- borders ----
    def _follow(self, grid: dict[Cell, PointOfGrid], left: list[Change], outcomes: list[BordersOfBranch], most: int) -> None:
        """Follow motions until every change between neighbours is explained, or given up; `left` keeps those that are not."""
        watch = Watch(len(left), self.progress)
        whole, given_up = len(left), list[Change]()
        while left and len(outcomes) < most:
            look()
            change = _next(left)
            left.remove(change)
            if not self._explained(grid, change, left, outcomes, most):
                given_up.append(change)
            done = whole - len(left) - len(given_up)
            watch.begun(0, done + len(given_up))
        left += given_up

    def _explained(
        self, grid: dict[Cell, PointOfGrid], change: Change, left: list[Change], outcomes: list[BordersOfBranch], most: int
    ) -> bool:
        """Follow the motions of a change until one of them shows what is between the neighbours, and strike off what that explains."""
        seeds = seeds_of(self.plane, grid, change)
        if not seeds:
            self.reasons[f"{change.words}: neither repeats, and only motions that repeat can be followed"] += 1
        for k, seed in enumerate(seeds):
            name = f"{change.axis}-{change.near[0]:04d}-{change.near[1]:04d}-{k}"
            outcome = self.study.outcome(name)
            if outcome is None:
                known = [border for other in outcomes for border in other.borders]
                new = partial(_is_new, self.plane, known)
                outcome = follow_borders(self.plane, seed, change, new, change.words in self.without_curve)
                self.study.keep_outcome(name, outcome)
            outcomes.append(outcome)
            self.reasons.update(outcome.refused)
            if outcome.refused and not outcome.borders:
                self.without_curve.add(change.words)
            for done in explained_by(self.plane, outcome.borders, outcome.points, left):
                left.remove(done)
            explained = bool(explained_by(self.plane, outcome.borders, outcome.points, [change]))
            if explained or len(outcomes) >= most:
                return explained
        return False

    # ---- what was not reached ----
    def _notes(
        self, levels: list[RefinementLevel], left: list[Change], followed: int, most: int, uncertain: UncertainPlaces
    ) -> tuple[str, ...]:
        notes, grid, missed = [], levels[0].points, self.missed
        unsure = sum(self.plane.point(cell) in uncertain.of_points for cell in grid)
        if self.ending.interrupted:
            there = f"{len(grid)} of {self.plane.cells} points of the grid are there; with a folder, resume=True continues"
            notes.append(self.ending.note(there))
        if missed:
            notes.append(f"the starts had missed {missed} motions that were found from those of neighbours (their share is 0)")
        notes += _of_grid(grid, self.look.limit)
        more = [len(level.points) - len(before.points) for before, level in pairwise(levels)]
        notes += [f"cells in doubt were halved: {n} more points at 1/{2**k} of a cell" for k, n in enumerate(more, 1)]
        notes += [f"{unsure} of {self.plane.cells} points are in doubt; map.doubt gives the reason at each"] if unsure else []
        notes += [f"{why} ({n} times)" if n > 1 else why for why, n in sorted(self.reasons.items())]
        if left and not followed:
            why = f"no motion was followed, so borders are known to within a grid cell only ({len(left)} pairs of neighbours differ)"
            return (*notes, *self.study.unchecked, why)
        if followed == most:
            notes.append(f"{most} motions were followed, the largest number allowed; increase branches= for more")
        places = Counter(change.words for change in left)
        return (
            *notes,
            *self.study.unchecked,
            *(f"between {what} no border was located ({n} pair{'s' * (n != 1)} of neighbours)" for what, n in sorted(places.items())),
        )


def _to_start_again(level: RefinementLevel) -> dict[Cell, Array]:
    """Further starts at the points where the first had missed a motion, once each; none where the starts were given as a grid."""
    if isinstance(level.plane.starts, dict):
        return {}
    missed = [cell for cell, point in level.points.items() if not point.more and any(not m.hits for m in point.motions)]
    return {cell: level.plane.more_states(rest, cell) for cell, rest in rests_of(level.plane, missed)[0].items()} if missed else {}


def _of_grid(grid: dict[Cell, PointOfGrid], limit: int) -> list[str]:
    """Notes on points of the grid."""
    moving, starts = sum(point.unsettled > 0 for point in grid.values()), sum(point.unsettled for point in grid.values())
    lost, none = sum(point.lost - point.unsettled for point in grid.values()), Counter(p.refused for p in grid.values() if p.refused)
    longer = f"type limit={10 * limit} to run them on for longer"
    why = f"at {moving} points some starts ({starts} in all) have not settled within {limit + STRETCH} drive periods; {longer}"
    notes = [why] * (moving > 0) + [f"{lost} starts led nowhere: they run away, or could not be solved"] * (lost > 0)
    return notes + [f"at {n} points no machine can be made: {why}" for why, n in none.items()]


def _next(left: list[Change]) -> Change:
    """The middle one of the changes that are most frequent."""
    kinds: dict[tuple[int, str], list[Change]] = {}
    for change in left:
        kinds.setdefault((change.axis, change.words), []).append(change)
    most = max(kinds.values(), key=len)
    return most[len(most) // 2]


def _is_new(plane: Plane, known: list[Border], point: PointOfBorder) -> bool:
    """Whether a special point lies on none of the borders that are known."""
    spans = np.array([float(np.ptp(axis)) for axis in plane.axes])
    return not any(border.distance(point.values, spans) < _ON_IT for border in known if border.kind == point.kind)


# ---- how long it takes ----
@dataclass(frozen=True)
class AtlasTime:
    """An estimate of the time that an atlas takes, from a part of it that was run.

    Parameters
    ----------
    grid : float
        For the points of the grid [s].
    branch : float
        For each motion that is followed [s], with its curves; NaN if none could be followed. Borders that are located line by line take
        less.
    most : int
        Largest number of motions that are followed.

    Examples
    --------
    >>> AtlasTime(grid=12.0, branch=5.0, most=40)
    about 12 s for the grid, then about 5 s for each motion that is followed (at most 40: 200 s)
    """

    grid: float
    branch: float
    most: int

    def __repr__(self) -> str:
        first = f"about {self.grid:.2g} s for the grid"
        if not self.most:
            return first
        if not np.isfinite(self.branch):
            return f"{first}; no motion in its middle could be followed, so the time for borders is not known"
        whole = f"at most {self.most}: {self.branch * self.most:.3g} s"
        return f"{first}, then about {self.branch:.2g} s for each motion that is followed ({whole})"


@explains_arguments
@interruptible
def atlas_time(
    make: Maker, *, over: dict[str, Any], starts: int | dict[str, Any] = 5, settle: int = 200, limit: int | None = None,
    rtol: float = 1e-7, section: Any = None, turns: int = 1, branches: int = 40, refine: int = 1, workers: int = 1, **fixed: Any,
) -> AtlasTime:  # fmt: skip
    """Estimate how long `atlas` takes with the same arguments, from sixteen points of its grid, one branch from its middle and one curve.

    The number of motions that are followed is known only after the grid: usually one for a region bordered by a curve, and one for each
    grid line of a border that has to be located line by line. Compilation is not counted, nor are cells that are halved: which are in doubt
    is known when the borders are.

    Parameters
    ----------
    make, over, starts, settle, limit, rtol, section, turns, branches, refine, workers, **fixed
        As for `atlas`.

    Returns
    -------
    AtlasTime
        Seconds for the grid, and for each motion that is followed.

    Examples
    --------
    >>> import stickslip as ss
    >>> over = {"amplitude": (3e-4, 9e-4), "mu0": (0.1, 0.3)}
    >>> time = ss.dynamics.atlas_time(ss.presets.piezo_rig, over=over, tilt_deg=1.7, law="coulomb")
    >>> 0 < time.grid < 60
    True
    """
    asked = _Asked(settle, limit, rtol, branches, refine, Workers(workers))
    plane = plane_over("atlas_time", make, over, starts, fixed, asked.check, (section, turns))
    probed = [plane.cell(int(k)) for k in np.unique(np.linspace(0, plane.cells - 1, min(_PROBED, plane.cells)).round())]
    probes = motions_at(plane, probed[:1], asked.look)  # compiles
    began = time.perf_counter()
    probes |= motions_at(plane, probed, asked.look)
    grid = (time.perf_counter() - began) / len(probed) * plane.cells / workers
    return AtlasTime(grid, _time_of_a_branch(plane, probes) if branches else 0.0, branches)


def _time_of_a_branch(plane: Plane, probes: dict[Cell, PointOfGrid]) -> float:
    """Seconds that a branch across the plane takes: of the first that can be followed from near its middle."""
    middle = plane.cell(plane.cells // 2)
    for cell in sorted(probes, key=lambda cell: abs(cell[0] - middle[0]) + abs(cell[1] - middle[1])):
        p, q = plane.point(cell)
        axis, name, other = plane.axes[0], *plane.names
        end = float(axis[-1] if axis[-1] - p > p - axis[0] else axis[0])
        for motion in (m for m in probes[cell].motions if m.period):
            more = {"period": motion.period, "guess": np.array(motion.state), **plane.family.fixed, other: q}
            try:
                continuation(plane.family.make, parameter=name, start=p, stop=p + 1e-3 * (end - p), points=3, **more)  # compiles
                began = time.perf_counter()
                branch = continuation(plane.family.make, parameter=name, start=p, stop=end, **more)
            except (SolveError, InputError):
                continue
            taken = time.perf_counter() - began
            return taken + _time_of_a_curve(branch, other, float(plane.axes[1][-1 if q < plane.axes[1][-1] else 0]))
    return float("nan")


def _time_of_a_curve(branch: Branch, other: str, end: float) -> float:
    """Seconds for the curve of the first special point of a branch that has one, both ways; 0 where none has."""
    for special in branch.special:
        began = time.perf_counter()
        with contextlib.suppress(SolveError, InputError):
            special_curve(branch, special, other, stop=end)
            return 2 * (time.perf_counter() - began)
    return 0.0
