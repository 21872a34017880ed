"""A sweep that is ready to run: the maker of the robots, the space, the solver's arguments, and the division into tiles."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.batch import Labels, cases_of, some_of, spread_over_cases
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.variables import VARIABLES
from stickslip.models.model_adapter import adapter_of, is_model
from stickslip.models.observables import by_time_of_computation, checked_observables
from stickslip.solvers.methods import SLOW
from stickslip.solvers.named_events import column_of, events_of_model, refuse_terminal
from stickslip.solvers.settings import Settings
from stickslip.studies.models_of_points import groups_of_points, refusals, start_of_points, starts_at
from stickslip.studies.result_columns import COLUMNS, part_columns
from stickslip.studies.self_excited import names_of_cycles, settled_after
from stickslip.studies.space import Column, Space, names_columns, space_of

#: Arguments of `solve` that a sweep passes on, with their defaults in a sweep.
SOLVER: dict[str, Any] = {
    "periods": 200, "duration": None, "settle": "auto", "rtol": 1e-6, "method": "auto", "slip_ratio": 0.75, "dwell": 0.03,
    "observe": None,
}  # fmt: skip
_LARGEST, _SMALLEST = 16384, 1024  # cases per tile: some tens of milliseconds of work, a file of some megabytes
_SLOW = 16  # cases per tile if a case takes seconds


@dataclass(frozen=True, eq=False)
class Plan:
    """The computation of a sweep.

    Parameters
    ----------
    make : callable or Robot
        The maker of the robots.
    space : Space
        The space of their numbers.
    options : dict
        Arguments of `solve`.
    start : dict
        Initial values: a number, or an array with one for each point.
    along : str, optional
        Dimension along which each case starts from the final state of the previous one.
    tile : int
        Cases (with `along`: lines of cases) per tile.
    """

    make: Any
    space: Space
    options: dict[str, Any]
    start: dict[str, Any] = field(default_factory=dict)
    along: str | None = None
    tile: int = _LARGEST

    @property
    def tiles(self) -> int:
        """Number of tiles."""
        return -(-self._units // self.tile)

    @cached_property
    def cases(self) -> int:
        """Number of results: with `along`, two for each point, on the way up and on the way down."""
        return self.space.cases * (2 if self.along else 1)

    @property
    def _units(self) -> int:
        return self.space.cases // (self.space.sizes[self.along] if self.along else 1)

    @property
    def dims(self) -> tuple[str, ...]:
        """Dimensions of the result; the followed one comes last."""
        rest = tuple(d for d in self.space.dims if d != self.along)
        return (*rest, "way", self.along) if self.along else rest

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the result."""
        return tuple(2 if d == "way" and d not in self.space.sizes else self.space.sizes[d] for d in self.dims)

    def bounds(self, k: int) -> tuple[int, int]:
        """Index of the first result of tile k, and of the one after its last."""
        each = self.cases // max(self._units, 1)
        return k * self.tile * each, min((k + 1) * self.tile, self._units) * each

    def points(self, k: int) -> Array:
        """Indices, within the space, of the points of tile k: (cases,), or with `along` (lines, points of a line)."""
        units = np.arange(k * self.tile, min((k + 1) * self.tile, self._units))
        if self.along is None:
            return units
        sizes = self.space.sizes
        rest = [d for d in self.space.dims if d != self.along]
        index = dict(zip(rest, np.unravel_index(units, [sizes[d] for d in rest]), strict=True)) if rest else {}
        steps = np.arange(sizes[self.along])
        grid = [steps[None, :] if d == self.along else index[d][:, None] for d in self.space.dims]
        return np.ravel_multi_index(np.broadcast_arrays(*grid), self.space.shape)

    def alone(self, points: Array) -> Plan:
        """Some points of the space as a plan of its own with one tile: it holds the numbers of these cases only."""
        dims = ("case",) if self.along is None else ("line", self.along)
        columns = {name: Column(dims, values) for name, values in self.space.at(points).items()}
        space = Space(dict(zip(dims, points.shape, strict=True)), columns, self.space.fixed, {})
        start = {name: value if np.ndim(value) == 0 else value.ravel() for name, value in starts_at(self.start, points).items()}
        plan = Plan(self.make, space, self.options, start, self.along, max(space.cases, 1))
        plan.__dict__["sample"] = self.sample  # its columns are those of the whole plan
        return plan

    @cached_property
    def parts(self) -> dict[str, tuple[str, ...]]:
        """Names of the bodies, contacts and stops of the first machine by dimension; empty for one body on one contact."""
        return {} if self.sample is None else adapter_of(self.sample).part_names

    @cached_property
    def own(self) -> tuple[str, ...]:
        """The columns that are named after the states of the models; none of machines, which have those of `COLUMNS`."""
        names = () if self.sample is None else adapter_of(self.sample).column_names(self.start)
        if names and settled_after("sweep", self.sample, self.options["settle"], self.options["duration"]) is not None:
            names = (*names, *names_of_cycles(names, self.sample.modes))
        return (*names, "status") if names else ()

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """The stored columns, with a separate one for each part."""
        if self.own:
            return (*self.own, *(name for name in self.observed if name not in self.own))
        return (*(each for name in COLUMNS for each in part_columns(name, self.parts)), *self.observed)

    @property
    def observed(self) -> tuple[str, ...]:
        """Names of user-defined columns: observables, and the first instants and numbers of events."""
        events = [column_of(what, name) for name in self.options.get("events") or () for what in ("first", "number")]
        return (*(name for name in self.own if name not in COLUMNS), *(self.options.get("observe") or ()), *events)

    @cached_property
    def sample(self) -> Any:
        """The first robot that can be made, from the first points; None if there is none."""
        parts = itertools.pairwise(np.minimum([0, *4 ** np.arange(7)], self.space.cases))
        tried = (groups_of_points(self.make, self.space, np.arange(*part), None)[0] for part in parts)
        return next((groups[0].robot for groups in tried if groups), None)


def planned(
    make: Model | Callable[..., Any],
    designs: Sequence[Any],
    axes: dict[str, Any],
    start: Any,
    along: Any,
    tile: Any,
    **options: Any,
) -> Plan:
    """Check all arguments of a sweep, and divide it into tiles."""
    space = space_of(make, designs, axes, [*_ARGUMENTS])
    problems = Problems("sweep")
    taken = () if names_columns(make) else tuple(name for name in COLUMNS if not name.startswith("alpha_"))
    for name in (n for n in dict.fromkeys([*space.columns, *space.dims]) if n in taken):
        problems.add(f"{name} is the name of a result, so no axis may have it; give the maker's argument another name")
    for sentence in refusals(make, space):
        problems.add(sentence)
    if along is not None and (along not in space.sizes or along not in space.columns):
        problems.add(f"continue_along = {along!r} is not an axis; allowed is one of {', '.join(space.dims) or 'none: there is no axis'}")
    if tile is not None:
        problems.whole("tile", tile, 1, example=4096, what=" of cases")
    if names_columns(make) and along is not None:
        problems.add("continue_along is not known of a flow; leave it out")
    starts = _starts(make, start, space, problems)
    problems.check()
    plan = Plan(make, space, options, starts, along, 1)
    for name in (n for n in dict.fromkeys([*space.columns, *space.dims]) if n in plan.parts):
        problems.add(f"{name} is the dimension of the machine's parts, so no axis may have it; give the maker's argument another name")
    problems.check()
    checked_observables("sweep", options.get("observe"), (*COLUMNS, *VARIABLES, *space.columns, *space.dims, *plan.parts), derived=True)
    _check_derived(plan)
    refuse_terminal("sweep", {} if plan.sample is None else events_of_model("sweep", plan.sample, options.get("events")))
    if len(set(plan.observed)) < len(plan.observed):
        raise InputError("sweep", ["two names of observe and events make the same column; give one of them another name"])
    if plan.observed and along is not None:
        raise InputError("sweep", ["observe or events and continue_along cannot go together; leave one of them out"])
    _check_options(plan)
    return replace(plan, tile=int(tile) if tile else _tile(plan))


_ARGUMENTS = (*SOLVER, "start", "workers", "progress", "out", "resume", "shard", "client", "executor", "retries", "tile", "continue_along")


def _tile(plan: Plan) -> int:
    """A tile size that depends only on the study, so that it can be resumed with a different number of workers."""
    if plan.along:
        return max(1, min(plan._units, 4096 // plan.space.sizes[plan.along] or 1, 256))
    model = None if plan.sample is None else adapter_of(plan.sample)
    slow = model is not None and (model.numbers_by_case or plan.options["method"] in SLOW or not all(law.compiles for law in model.laws))
    return _SLOW if slow else min(_LARGEST, max(_SMALLEST, plan.cases // 64))


def _starts(make: Any, start: Any, space: Space, problems: Problems) -> dict[str, Any]:
    """Initial values as a number, or as one for each point."""
    if start is not None and not isinstance(start, dict) and not is_model(make):
        problems.add(f"start = {start!r}; allowed is a dict; type for example start=dict(v=0.01)")
        return {}
    try:
        named = adapter_of(make).named_start(start) if is_model(make) else dict(start or {})
    except InputError as error:
        problems.include(error)
        return {}
    starts: dict[str, Any] = {}
    for name, value in named.items():
        starts[name] = value
        if np.ndim(value) == 0:
            continue
        try:
            starts[name] = spread_over_cases(value, Labels(space.shape, space.dims)) + 0.0
        except ValueError as error:
            problems.add(f"start[{name!r}] does not fit the axes: {error}; allowed is a number or an array of shape {space.shape}")
    return starts


def _check_derived(plan: Plan) -> None:
    """Check derivatives: they are defined for the steady motion from rest; further errors are found with the first robot."""
    derived = by_time_of_computation(plan.options.get("observe"))[1]
    if not derived:
        return
    if plan.start or plan.options["settle"] != "auto":
        raise InputError("sweep", ['derivatives are of the steady motion from rest; leave start out, and settle="auto" as it is'])
    if plan.sample is not None:
        next(iter(derived.values())).values(some_of(plan.sample, [0]), 0, derived, 0)


def _check_options(plan: Plan) -> None:
    """Check the solver's arguments with the first robot."""
    from stickslip.solvers.request import request

    if plan.sample is None:
        groups, refused = groups_of_points(plan.make, plan.space, np.arange(min(plan.space.cases, 64)), None)
        if not groups and plan.space.cases <= 64:
            raise InputError("sweep", list(dict.fromkeys(refused.values())) or ["no robot can be made"])
        return
    settle = settled_after("sweep", plan.sample, plan.options["settle"], plan.options["duration"])
    options = plan.options if settle is None else {**plan.options, "settle": "auto"}
    if plan.own:  # whose modes, and how many states there are, may follow from the start
        start = start_of_points(plan.space, plan.start, np.array([0]))
        request(cases_of(plan.sample)[0], settings_of(options, keep="summary", start=one_start(start, 0)))
        return
    request(plan.sample, settings_of(options, keep="summary"))
    if plan.along is not None:
        from stickslip.studies.following import unfollowed

        why = unfollowed(plan.sample, plan.options["method"])
        if why is not None:
            raise InputError("sweep", [why])


def settings_of(options: dict[str, Any], **more: Any) -> Settings:
    """The settings of `solve` for options of a sweep; with a duration, there are no periods to count."""
    known = {name: value for name, value in options.items() if name != "events"}  # cases of closed arcs have none
    settings = Settings(**{**known, "observe": by_time_of_computation(options.get("observe"))[0] or None}, **more)
    if settings.duration is None:
        return settings
    periods = None if settings.periods == SOLVER["periods"] else settings.periods
    return replace(settings, periods=periods, settle=None if settings.settle == "auto" else settings.settle)


def one_start(start: dict[str, Any], k: int) -> dict[str, Any] | None:
    """The initial values of one case; None where none are given."""
    return {name: float(np.ravel(value)[k if np.ndim(value) else 0]) for name, value in start.items()} or None
