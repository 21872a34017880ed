"""Which motions attract at every point of a grid: runs in lanes, from several starts and from the motions of the neighbours."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.dynamics.atlas.parameter_plane import Cell, Plane
from stickslip.dynamics.attractors.kinds_of_motion import PERIODIC, UNSETTLED
from stickslip.dynamics.attractors.motion_features import features_of, motion_numbers
from stickslip.dynamics.attractors.settled_motions import Settling, motion_times, settled_motions
from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit
from stickslip.dynamics.stroboscopic.strobe_maps import spread_over, state_at_rest
from stickslip.models.machine_adapter import machine_of
from stickslip.solvers import solve

_LOOKED = 64  # drive periods over which a motion is named
_TYPED = 1e-10  # tolerance of the run by which a cycle is named
_JOINED = " | "  # the patterns of several contacts


@dataclass(frozen=True)
class MotionThere:
    """A motion that attracts at a point of the grid.

    Parameters
    ----------
    word : str
        Its type and its period, such as "III" or "II, period 2"; of several contacts their patterns; "quasi-periodic" or "chaotic" where
        it has no period.
    period : int
        Drive periods until it repeats; 0 where it does not.
    mean_velocity : float
        V [m/s].
    state : tuple of float
        A strobe state on it.
    hits : int
        How many of the starts it attracts; 0 of what was reached from a neighbour alone.
    """

    word: str
    period: int
    mean_velocity: float
    state: tuple[float, ...]
    hits: int


@dataclass(frozen=True)
class PointOfGrid:
    """The result at a point: motions, the most attracting first; number of starts without one; why there is no machine.

    `more`: how many starts it had beyond those that every point has. `unsettled`: how many of the starts without a motion have not settled.
    """

    motions: tuple[MotionThere, ...] = ()
    lost: int = 0
    refused: str = ""
    more: int = 0
    unsettled: int = 0

    @property
    def words(self) -> tuple[str, ...]:
        """The motions by name, in the order of the alphabet."""
        return tuple(sorted(motion.word for motion in self.motions))

    @property
    def label(self) -> str:
        """All of them in one word, such as "I + III" or "2 × II"; "not settled" where no start has."""
        words = self.words
        if not words and self.unsettled:
            return UNSETTLED
        counted = {word: words.count(word) for word in words}
        return " + ".join(word if n == 1 else f"{n} × {word}" for word, n in counted.items())


@dataclass(frozen=True)
class Look:
    """How points are looked at: drive periods before looking, their largest number, and the tolerance of dynamic laws."""

    settle: int
    limit: int
    rtol: float


def motions_at(plane: Plane, cells: list[Cell], look: Look, more: dict[Cell, Array] | None = None) -> dict[Cell, PointOfGrid]:
    """The motions at some points of the grid, all run together.

    Parameters
    ----------
    more : dict, optional
        Strobe states to begin with besides the starts, by point. A point that has some is begun with these alone.
    """
    rests, refused = rests_of(plane, cells)
    begun = {cell: plane.states(rest, cell) if more is None else more[cell] for cell, rest in rests.items()}
    return refused | (_run(plane, begun, look) if begun else {})


def rests_of(plane: Plane, cells: list[Cell]) -> tuple[dict[Cell, Array], dict[Cell, PointOfGrid]]:
    """The state of rest at each point, array (coordinates,), and the points at which there is no machine, with the reason."""
    try:
        return dict(zip(cells, _at_rest(plane, cells), strict=True)), {}
    except InputError:
        return _one_by_one(plane, cells)


def _at_rest(plane: Plane, cells: list[Cell]) -> Array:
    rest = state_at_rest(plane.family.robots(*np.array([plane.point(cell) for cell in cells]).T), plane.at)
    return np.broadcast_to(rest, (len(cells), rest.shape[1]))


def _one_by_one(plane: Plane, cells: list[Cell]) -> tuple[dict[Cell, Array], dict[Cell, PointOfGrid]]:
    kept: dict[Cell, Array] = {}
    refused: dict[Cell, PointOfGrid] = {}
    for cell in cells:
        try:
            kept[cell] = state_at_rest(plane.family.robot(*plane.point(cell)), plane.at)[0]
        except InputError as error:
            refused[cell] = PointOfGrid(refused=error.problems[0])
    return kept, refused


def _run(plane: Plane, begun: dict[Cell, Array], look: Look) -> dict[Cell, PointOfGrid]:
    """Run every point from its states, tell the motions apart, and name them."""
    owner = np.repeat(np.arange(len(begun)), [len(states) for states in begun.values()])
    values = np.array([plane.point(cell) for cell in begun])[owner]
    model = plane.family.robots(*values.T)
    states = np.vstack(list(begun.values()))
    T, at = None if model.period is None else np.broadcast_to(np.asarray(model.period, float), owner.shape), plane.on(model, states, owner)
    settled = settled_motions(model, states, at, Settling(look.settle, look.limit, look.rtol), groups=owner)
    motions, times = features_of(T, settled, at), motion_times(settled)
    first: list[int] = []  # one run of each motion
    by_point: list[list[tuple[int, int, float, int]]] = []
    lost = np.bincount(owner, ~settled.attracted, len(begun)).astype(int).tolist()
    unsettled = np.bincount(owner, settled.kind == UNSETTLED, len(begun)).astype(int).tolist()
    for k in range(len(begun)):
        numbers = motion_numbers(motions, settled.attracted & (owner == k))
        own = [np.flatnonzero(numbers == n) for n in range(numbers.max() + 1)]
        V = [float(motions.mean_velocity[m].mean()) for m in own]
        by_point.append([(len(first) + i, int(settled.period[m[0]]), V[i], len(m)) for i, m in enumerate(own)])
        first += [int(m[0]) for m in own]
    states, kinds = settled.points[first, -1], settled.kind[first]
    periods = [p for of in by_point for _, p, _, _ in of]
    words = _words(plane, values[first], states, periods, times[first], look) if first else []
    return {
        cell: PointOfGrid(
            _sorted([MotionThere(_named(words[i], str(kinds[i]), p), p, V, tuple(states[i].tolist()), n) for i, p, V, n in of]),
            lost[k],
            unsettled=unsettled[k],
        )
        for k, (cell, of) in enumerate(zip(begun, by_point, strict=True))
    }


def _sorted(motions: list[MotionThere]) -> tuple[MotionThere, ...]:
    """The most attracting first."""
    return tuple(sorted(motions, key=lambda m: (-m.hits, m.word, m.mean_velocity)))


def _named(word: str, kind: str, period: int) -> str:
    """A motion by its type and period; by its kind where it has no period, as its type would change from one look to the next."""
    return kind if kind != PERIODIC else word if period == 1 else f"{word}, period {period}"


def _words(plane: Plane, values: Array, states: Array, periods: list[int], times: Array, look: Look) -> list[str]:
    """The type of each motion; of several contacts the pattern of each; of a flow its modes in turn. `times` are those of cycles."""
    if plane.sample.period is None or not plane.at.in_lanes:
        models = (plane.family.robot(*point) for point in values)
        along = zip(models, states, periods, times, strict=True)
        return [_label(model, state, p, float(T)) if p else "" for model, state, p, T in along]
    model = spread_over(plane.family.robots(*values.T), len(states))
    options = {"rtol": look.rtol} if machine_of(model).has_inner_states else {}
    summary = solve(model, periods=_LOOKED, settle="auto", start=plane.at.start(states), keep="summary", **options)
    words = np.asarray(summary.motion_type)
    words = words if words.ndim == 1 else np.asarray(summary.pattern)
    return [_JOINED.join(np.atleast_1d(word).tolist()) for word in words]


def _label(model: Any, state: Array, period: int, duration: float) -> str:
    """The name of the periodic motion through a state."""
    return PeriodicOrbit(model, period, state, np.nan, _TYPED, duration=duration if model.period is None else None).label


def unmatched(here: PointOfGrid, there: PointOfGrid) -> list[MotionThere]:
    """The motions of a point that a neighbour does not have: by name, and of one name those with the nearest velocities go together."""
    left, free = [], list(there.motions)
    for motion in here.motions:
        alike = [other for other in free if other.word == motion.word]
        if alike:
            free.remove(min(alike, key=lambda other: abs(other.mean_velocity - motion.mean_velocity)))
        else:
            left.append(motion)
    return left


def taken_over(plane: Plane, grid: dict[Cell, PointOfGrid], run: Callable[[dict[Cell, Array]], dict[Cell, PointOfGrid]]) -> int:
    """Carry every motion to the neighbours that do not have it, until nothing new is found; `grid` is changed.

    Parameters
    ----------
    run : callable
        Finds the motions that are reached from some strobe states at some points; what it leaves out is not tried again.

    Returns
    -------
    int
        How many motions the starts had missed.
    """
    tried: set[tuple[Cell, Cell, str]] = set()
    missed = 0
    while todo := _to_try(plane, grid, tried):
        for cell, point in run(todo).items():
            more = unmatched(point, grid[cell])
            grid[cell] = _joined(plane, grid[cell], more)
            missed += len(more)
    return missed


def _joined(plane: Plane, point: PointOfGrid, more: list[MotionThere]) -> PointOfGrid:
    """A point with motions that were reached from its neighbours."""
    added = [replace(m, hits=0) for m in more]
    return replace(point, motions=_sorted([*point.motions, *added]))


def with_more(plane: Plane, point: PointOfGrid, again: PointOfGrid, starts: int) -> PointOfGrid:
    """A point and what further starts found there, as one."""
    new = unmatched(again, point)
    left = [m for m in again.motions if m not in new]
    known = []
    for motion in point.motions:
        alike = [m for m in left if m.word == motion.word]
        same = min(alike, key=lambda m: abs(m.mean_velocity - motion.mean_velocity), default=None)
        known.append(motion if same is None else replace(motion, hits=motion.hits + same.hits))
        left = [m for m in left if m is not same]
    unsettled = point.unsettled + again.unsettled
    return PointOfGrid(_sorted([*known, *new]), point.lost + again.lost, point.refused, point.more + starts, unsettled)


def _to_try(plane: Plane, grid: dict[Cell, PointOfGrid], tried: set[tuple[Cell, Cell, str]]) -> dict[Cell, Array]:
    """States to begin with at points whose neighbours have other motions, with the motions that are there; each is tried once."""
    todo: dict[Cell, list[tuple[float, ...]]] = {}
    for cell, point in grid.items():
        if point.refused:
            continue
        for other in neighbours_on_grid(plane, cell):
            for motion in unmatched(grid[other], point) if other in grid else ():
                if (cell, other, motion.word) not in tried:
                    tried.add((cell, other, motion.word))
                    todo.setdefault(cell, [m.state for m in point.motions]).append(motion.state)
    return {cell: np.array(states) for cell, states in todo.items()}


def neighbours_on_grid(plane: Plane, cell: Cell) -> list[Cell]:
    """The points beside a point of the grid."""
    i, j = cell
    adjacent = ((i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1))
    return [(a, b) for a, b in adjacent if 0 <= a < plane.shape[0] and 0 <= b < plane.shape[1]]
