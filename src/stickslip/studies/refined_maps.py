"""`map`: two axes, with the work concentrated where the motion changes."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import partial, reduce
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Maker, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.executors import Workers
from stickslip.basics.interruption import interruptible, look, partial_result, taking_some_cases
from stickslip.basics.pool import handed_out
from stickslip.basics.status import Status
from stickslip.studies.execution import Execution
from stickslip.studies.labelling import coordinates_of_grid, dataset, provenance_of
from stickslip.studies.models_of_points import starts_at
from stickslip.studies.planning import SOLVER, Plan, planned
from stickslip.studies.progress import Watch
from stickslip.studies.result_columns import all_failed, empty, part_columns
from stickslip.studies.running import carried_out
from stickslip.studies.solving import solved_points

if TYPE_CHECKING:
    import xarray as xr

_CHUNK, _SMALLEST = 16384, 64  # points that are solved together


@explains_arguments
@interruptible
def map(make: Maker, refine: bool = False, coarse: int = 33, **arguments: Any) -> xr.Dataset:
    """Solve a robot over a plane: two axes of numbers.

    Parameters
    ----------
    make : callable or Robot
        As for `sweep`.
    refine : bool
        Compute a coarse grid first and then halve its cells wherever the corners differ in type, period or status, down to the grid
        asked for. The other points are filled in from the corners and have the status 102. A region thinner than a cell of the coarse grid
        can be missed.
    coarse : int
        Least number of points of the coarse grid along each axis.
    **arguments
        As for `sweep`; exactly two of them hold several numbers. With `refine` everything is in memory: no ``out`` or
        ``continue_along``.

    Returns
    -------
    xarray.Dataset
        As from `sweep`; `stickslip.plot.motion_map` and `stickslip.plot.velocity_map` draw it.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> grid = ss.map(ss.presets.piezo_rig, refine=True, amplitude=np.linspace(2e-4, 8e-4, 257), omega=np.linspace(120, 240, 257),
    ...               tilt_deg=1.7, law="coulomb")
    >>> bool((grid.status == 102).mean() > 0.6), grid.motion_type.sel(amplitude=6e-4, omega=205, method="nearest").item()
    (True, 'III')
    """
    how = {name: arguments.pop(name) for name in _HOW if name in arguments}
    if refine:
        _check_refining({**how, **arguments}, coarse)
    start, along, tile = (arguments.pop(name, None) for name in ("start", "continue_along", "tile"))
    options = {name: arguments.pop(name, default) for name, default in SOLVER.items()}
    plan = planned(make, (), arguments, start, along, tile, **options)
    _check_plane(plan)
    if refine and plan.own:
        raise InputError("map", ["refine=True looks for borders of motion types, which a flow has not; leave it out"])
    if not refine:
        return carried_out(plan, Execution(tile=tile, **how))
    return _Refined(plan, Execution(**how).checked_crew(), Watch(plan.cases, how.get("progress"))).grid(coarse)


_HOW = ("workers", "out", "resume", "shard", "client", "executor", "retries", "progress")


def _check_refining(given: dict[str, Any], coarse: Any) -> None:
    problems = Problems("map")
    refused = [n for n in ("out", "resume", "shard", "continue_along", "tile") if given.get(n)]
    if refused:
        problems.add(f"{', '.join(refused)} cannot go with refine=True, which works in memory; leave it out, or type refine=False")
    problems.whole("coarse", coarse, 2, example=33)
    problems.check()


def _check_plane(plan: Plan) -> None:
    """Check that the plan has two numeric axes, before anything is computed."""
    labels = coordinates_of_grid(plan)
    if len(plan.dims) != 2 or not all(d in labels and labels[d].values.dtype.kind in "if" for d in plan.dims):
        raise InputError("map", [_other_axes(plan.dims)])


def _other_axes(names: Sequence[str]) -> str:
    """The error for other than two numeric axes, with alternatives."""
    drawn = f', and ss.plot.line_cut(grid, "{names[0]}") to draw it' if len(names) == 1 else ""
    axes = f"the axes are {', '.join(names)}" if len(names) > 1 else f"the only axis is {names[0]}" if names else "there is no axis"
    return f"{axes}; allowed are exactly two, of numbers; type ss.sweep with the same arguments for others{drawn}"


class _Refined:
    """A map during refinement: the columns of the whole grid, and which of its points have been computed."""

    def __init__(self, plan: Plan, crew: Workers, watch: Watch):
        self.plan, self.crew, self.watch, self.shape = plan, crew, watch, plan.shape
        self.columns = {name: values.reshape(self.shape) for name, values in empty(plan.cases, plan.columns).items()}
        self.known, self.asked = np.zeros(self.shape, bool), np.zeros(self.shape, bool)
        self.kind = np.full(self.shape, "", "U24")
        self.notes = Counter[str]()

    def grid(self, coarse: int) -> Any:
        """Compute the map and return the dataset."""
        stride = 1
        while min(self.shape) > 2 * stride * (coarse - 1) + 1:
            stride *= 2
        lines = self._lines(stride)
        with partial_result() as ending, taking_some_cases():
            self._compute(_crossed(*lines, self.shape))
            while True:
                changing = self._settled(lines)
                if stride == 1:
                    break
                stride //= 2
                finer = self._lines(stride)
                self._fill(lines, finer)
                self._compute(self._next_to_changes(changing, lines, finer))
                lines = finer
        self.columns["status"][~self.known & (self.kind != "")] = Status.FILLED
        if ending.interrupted:
            self._leave_blank()
            self.notes[ending.note(Status.NOT_COMPUTED.sentence)] = int((self.columns["status"] == Status.NOT_COMPUTED).sum())
        if all_failed(self.columns["status"][self.known]):
            raise InputError("map", list(self.notes))
        result = dataset(self.plan, {n: v.ravel() for n, v in self.columns.items()}, {"provenance": provenance_of(self.plan)}, self.notes)
        return result.assign_attrs(refined=json.dumps({"computed": int(self.known.sum()), "cases": self.plan.cases, "coarse": coarse}))

    def _leave_blank(self) -> None:
        """After an interruption: points that were to be computed, since motions differ about them, and were only filled."""
        blank = self.asked & ~self.known
        for name, values in empty(int(blank.sum()), self.columns).items():
            self.columns[name][blank] = values

    def _lines(self, stride: int) -> tuple[Array, Array]:
        first, second = (np.unique([*range(0, n, stride), n - 1]) for n in self.shape)
        return first, second

    def _compute(self, points: Array) -> None:
        """Solve those of some points, given by their indices, that are not known yet."""
        points = points[~self.known.ravel()[points]]
        self.asked.reshape(-1)[points] = True
        for part, (solved, notes) in self._solved(points) if len(points) else ():
            there = solved["status"] != Status.NOT_COMPUTED
            part, solved = part[there], {name: values[there] for name, values in solved.items()}
            for name in self.columns:
                self.columns[name].reshape(-1)[part] = solved[name]
            self.notes.update(notes)
            words = [solved[name] for name in part_columns("motion_type", self.plan.parts)]
            words += [solved["period"].astype("U4"), np.where(solved["status"] <= 1, "ok", solved["status"].astype("U4"))]
            kinds = reduce(np.char.add, words)
            self.kind = self.kind.astype(np.promote_types(self.kind.dtype, kinds.dtype))
            self.kind.reshape(-1)[part] = kinds
            self.known.reshape(-1)[part] = True
            self.watch.finished(-1, solved["status"])
            if not there.all():
                look()

    def _solved(self, points: Array) -> Iterator[tuple[Array, tuple[dict[str, Array], Counter[str]]]]:
        """Some points at a time, with their columns and notes."""
        if self.crew.elsewhere:
            size = max(min(_CHUNK, -(-len(points) // (2 * self.crew.count))), _SMALLEST)
            alone = ((part, self.plan.alone(part)) for part in _split(points, size))
            yield from ((part, result) for (part, _), result in handed_out(_solved_alone, alone, self.crew))
            return

        def work(part: Array) -> tuple[dict[str, Array], Counter[str]]:
            return solved_points(self.plan, part, starts_at(self.plan.start, part), self.crew.threads, partial(self.watch.at_work, -1))

        yield from handed_out(work, _split(points, _CHUNK))

    def _settled(self, lines: tuple[Array, Array]) -> Array:
        """The cells whose corners differ; interpolated corners of such cells are computed first, until none is left."""
        while True:
            kind = self.kind[np.ix_(*lines)]
            corners = np.s_[:-1, :-1], np.s_[1:, :-1], np.s_[:-1, 1:], np.s_[1:, 1:]
            changing = np.logical_or.reduce([kind[corner] != kind[corners[0]] for corner in corners[1:]])
            need = np.zeros(kind.shape, bool)
            for corner in corners:
                need[corner] |= changing
            need &= ~self.known[np.ix_(*lines)]
            if not need.any():
                return changing
            self._compute(_crossed(*lines, self.shape).reshape(kind.shape)[need])

    def _next_to_changes(self, changing: Array, lines: tuple[Array, Array], finer: tuple[Array, Array]) -> Array:
        """The points of the finer grid inside or on the border of a changing cell."""
        near = np.zeros((len(finer[0]), len(finer[1])), bool)
        sides = [
            [np.clip(np.searchsorted(old, new, side) - 1, 0, len(old) - 2) for side in ("left", "right")]
            for old, new in zip(lines, finer, strict=True)
        ]
        for i in sides[0]:
            for j in sides[1]:
                near |= changing[np.ix_(i, j)]
        return _crossed(*finer, self.shape).reshape(near.shape)[near]

    def _fill(self, lines: tuple[Array, Array], finer: tuple[Array, Array]) -> None:
        """Interpolate columns at the unknown points of the finer grid from the corners of their cells."""
        axes = [self.plan.space.coords[d].values for d in self.plan.dims]
        (i0, i1, u), (j0, j1, w) = (_between(x, old, new) for x, old, new in zip(axes, lines, finer, strict=True))
        cells = np.ix_(*finer)
        new = ~self.known[cells]
        for values in [*self.columns.values(), self.kind]:
            if values.dtype.kind == "f":
                low = values[np.ix_(i0, j0)] * (1 - u) + values[np.ix_(i1, j0)] * u
                high = values[np.ix_(i0, j1)] * (1 - u) + values[np.ix_(i1, j1)] * u
                filled = low * (1 - w.T) + high * w.T
            else:
                filled = values[np.ix_(np.where(u[:, 0] < 0.5, i0, i1), np.where(w[:, 0] < 0.5, j0, j1))]
            values[cells] = np.where(new, filled, values[cells])


def _split(points: Array, size: int) -> list[Array]:
    return np.array_split(points, -(-len(points) // size))


def _solved_alone(part: tuple[Array, Plan]) -> tuple[dict[str, Array], Counter[str]]:
    """Solve some points in a worker."""
    plan = part[1]
    points = np.arange(plan.cases)
    return solved_points(plan, points, starts_at(plan.start, points))


def _crossed(first: Array, second: Array, shape: tuple[int, ...]) -> Array:
    """Indices of the points at which the lines cross."""
    return (first[:, None] * shape[1] + second[None, :]).ravel()


def _between(x: Array, old: Array, new: Array) -> tuple[Array, Array, Array]:
    """For each new line, the neighbouring old ones and its relative position between them."""
    low = np.clip(np.searchsorted(old, new, "right") - 1, 0, len(old) - 2)
    i0, i1 = old[low], old[low + 1]
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(x[i1] != x[i0], (x[new] - x[i0]) / (x[i1] - x[i0]), 0.0)
    return i0, i1, share[:, None]
