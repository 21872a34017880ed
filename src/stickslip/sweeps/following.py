"""Cases that start where their neighbour along an axis ended, up and down again: transients are short, and hysteresis shows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.errors import InputError
from stickslip.forces import is_dynamic
from stickslip.solvers import exact, rosenbrock, stepping
from stickslip.solvers.arcs import handles
from stickslip.solvers.gather import NEEDED, Raw, gather
from stickslip.solvers.request import Request, request
from stickslip.summary import Summary
from stickslip.sweeps.columns import COLUMNS, empty
from stickslip.sweeps.planning import Plan, solver_arguments

__all__ = ["followed", "solve_to_end"]

Array = Any


def solve_to_end(robot: Any, options: dict[str, Any], start: dict[str, Any], workers: int) -> tuple[Summary, dict[str, Array]]:
    """A summary, and v, z and the law's memory of each case at its end."""
    asked = solver_arguments(options)
    todo = request(robot, start=start, workers=workers, keep="summary", samples=400, progress=None, options={}, **asked)
    if is_dynamic(robot.friction) and todo.method in ("auto", "rodas4", "rodas5p") and not getattr(robot.friction, "scalar_only", False):
        return _stepped(todo, *rosenbrock.method(todo))
    if not is_dynamic(robot.friction) and todo.method in ("auto", "exact"):
        return _exact(todo, start) if handles(robot) is None else _stepped(todo, None, exact.REPEAT / 10)
    what = f"method {todo.method!r} with {type(robot.friction).__name__}"
    raise InputError("sweep", [f"continue_along needs the end states, which {what} does not give; leave it out, or type method='auto'"])


def _stepped(todo: Request, tableau: Any, rtol: float) -> tuple[Summary, dict[str, Array]]:
    summary, v, *more = stepping.run_to_end(todo, tableau, rtol)
    inner = {name: part[:, 0] if part.shape[1] == 1 else part for name, part in zip(("z", "memory"), more, strict=True) if part.shape[1]}
    return summary, {"v": v, **inner}


def _exact(todo: Request, start: dict[str, Any]) -> tuple[Summary, dict[str, Array]]:
    raw = exact.solve_batch(todo.model, todo.periods, "auto" if todo.auto else todo.settle, start, todo.workers)
    parts = Raw(**{n: raw[n] * np.reshape(todo.span, (-1, 1)) if n == "seg_time" else raw[n] for n in NEEDED})
    return gather(todo, "exact", [((0, todo.cases), parts)]), {"v": raw["v_end"]}


def followed(plan: Plan, k: int, workers: int, tell: Callable[[int], None] | None) -> tuple[dict[str, Array], dict[str, int]]:
    """The columns of tile k: all its lines at once, from value to value up the axis, and down again."""
    lines = plan.points(k)
    count, steps = lines.shape
    result, notes = empty(2 * lines.size), dict[str, int]()
    whole = {name: values.reshape(count, 2, steps, *values.shape[1:]) for name, values in result.items()}
    ends: dict[str, Any] = {}
    for n, (way, step) in enumerate([(0, s) for s in range(steps)] + [(1, s) for s in reversed(range(steps))]):
        columns, ends = _one_step(plan, lines[:, step], ends, workers, notes)
        for name, values in columns.items():
            whole[name][:, way, step] = values
        if tell is not None:
            tell(count * (n + 1))
    return result, notes


def _one_step(
    plan: Plan, points: Array, ends: dict[str, Any], workers: int, notes: dict[str, int]
) -> tuple[dict[str, Array], dict[str, Any]]:
    """All lines at one value of the axis; where a case fails, the next one starts as the study says."""
    from stickslip.sweeps.columns import BAD
    from stickslip.sweeps.robots import groups_of
    from stickslip.sweeps.solving import _alphas

    first = plan.start_at(points)
    groups, refused = groups_of(plan.make, plan.space, points, first)
    columns, after = empty(len(points)), dict[str, Any]()
    columns["status"][list(refused)] = BAD
    for sentence in refused.values():
        notes[sentence] = notes.get(sentence, 0) + 1
    for group in groups:
        start = _start(group.start, ends, group.at, len(points))
        many, end = solve_to_end(_spread(group.robot, len(group.at)), plan.options, start, workers)
        found = {n: many.columns[n] for n in COLUMNS if n in many.columns} | _alphas(group.robot)
        for name, values in found.items():
            columns[name][group.at] = np.ravel(values)
        for name, values in end.items():
            place = after.setdefault(name, np.full((len(points), *values.shape[1:]), np.nan))
            place[group.at] = np.where((columns["status"][group.at] <= 1).reshape(-1, *[1] * (values.ndim - 1)), values, np.nan)
    return columns, after


def _spread(robot: Any, count: int) -> Any:
    """A robot as a batch of this length."""
    from stickslip.batch import shape_of
    from stickslip.fields import leaves, replace_leaf

    return robot if shape_of(robot) else replace_leaf(robot, {name: np.full(count, value) for name, value in leaves(robot)})


def _start(given: dict[str, Any], ends: dict[str, Any], at: Array, count: int) -> dict[str, Any]:
    """Where the neighbours ended; where there is no such end, the start of the study."""
    start = dict(given)
    for name, values in ends.items():
        mine = values[at]
        usual = np.broadcast_to(np.asarray(given.get(name, 0.0), float).reshape(-1, *[1] * (mine.ndim - 1)), mine.shape)
        start[name] = np.where(np.isfinite(mine), mine, usual)
    return start
