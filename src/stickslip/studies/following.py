"""Cases that start from the final state of their neighbour along an axis, up and down: transients are short, and hysteresis shows."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.basics.batch import spread_over_cases
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError
from stickslip.basics.interruption import Interrupted, takes_some_cases, taking_some_cases
from stickslip.basics.status import Status
from stickslip.engine.tableaux import TABLEAUX
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.machine_adapter import machine_of
from stickslip.models.position_dependence import knows_position
from stickslip.results.summary import Summary
from stickslip.solvers import coulomb_steady_motions as orbits, stepping
from stickslip.solvers.closed_arcs import handles
from stickslip.solvers.methods import steps_of
from stickslip.solvers.part_results import per_case
from stickslip.solvers.request import request
from stickslip.solvers.settings import Request
from stickslip.studies.models_of_points import Group, groups_of_points, starts_at
from stickslip.studies.planning import Plan, settings_of
from stickslip.studies.result_columns import END, empty
from stickslip.studies.solving import columns_of_group


def solve_to_end(robot: Model, start: dict[str, Any], options: dict[str, Any], workers: int, tell: Any) -> tuple[Summary, dict[str, Array]]:
    """A summary, the data for its power, and the final state of each case, under names such as end.v."""
    todo = request(robot, settings_of(options, start=start, workers=workers, keep="summary", progress=tell))
    why = unfollowed(robot, todo.method)
    if why is not None:
        raise InputError("sweep", [why])
    if handles(robot) is not None:
        return _stepped(todo, *steps_of(todo))
    summary, more = orbits.solve_waiting(todo)
    return summary, more | _named({"v": more["v_end"]})


def unfollowed(robot: Model, method: str) -> str | None:
    """The reason why the final states of a robot are unavailable, as a sentence; None if they are available."""
    if machine_of(robot).one_body is None:
        what = f"a {type(robot).__name__} has several bodies, and a case is started from the state of one"
        return f"continue_along needs the end states of one body, and {what}; leave it out"
    law = law_of(robot)
    known = ("auto", "taylor", *TABLEAUX) if law.dynamic else ("auto", "exact")
    if method in known and law.compiles:
        return None
    what = f"method {method!r} with {law.name}"
    return f"continue_along needs the end states, which {what} does not give; leave it out, or type method='auto'"


def _stepped(todo: Request, tableau: Any, rtol: float) -> tuple[Summary, dict[str, Array]]:
    summary, x, v, *more = stepping.run_to_end(todo, tableau, rtol)
    inner = {name: part[:, 0] if part.shape[1] == 1 else part for name, part in zip(("z", "memory"), more, strict=True) if part.shape[1]}
    return summary, _named({**_position(todo, x), "v": v, **inner})


def _position(todo: Request, x: Array) -> dict[str, Array]:
    """Initial position of the next case on its spring: time restarts at zero, and with it the displacement of the spring's far end."""
    if not knows_position(todo.model):
        return {}
    return {"x": x - spread_over_cases(machine_of(todo.model).far_end_velocity, todo.labels) * todo.span}


def _named(state: dict[str, Array]) -> dict[str, Array]:
    return {END + name: values for name, values in state.items()}


def columns_along(plan: Plan, k: int, workers: int, tell: Callable[[int], None] | None) -> tuple[dict[str, Array], dict[str, int]]:
    """The columns of tile k: all its lines together, from value to value up the axis, and down again."""
    lines = plan.points(k)
    count, steps = lines.shape
    result, notes = empty(2 * lines.size, plan.columns), Counter[str]()
    whole = {name: values.reshape(count, 2, steps, *values.shape[1:]) for name, values in result.items()}
    ends: dict[Any, Array] = {}
    for n, (way, step) in enumerate([(0, s) for s in range(steps)] + [(1, s) for s in reversed(range(steps))]):
        try:
            with taking_some_cases(False):
                columns, ends = _one_step(plan, lines[:, step], ends, workers, notes)
        except Interrupted:
            if not takes_some_cases():
                raise
            break
        for name, values in columns.items():
            whole[name][:, way, step] = values
        if tell is not None:
            tell(count * (n + 1))
    return result, notes


def _one_step(
    plan: Plan, points: Array, ends: dict[Any, Array], workers: int, notes: Counter[str]
) -> tuple[dict[str, Array], dict[Any, Array]]:
    """Solve all lines at one value of the axis; after a failed case, the next one starts from the initial state of the study."""
    groups, refused = groups_of_points(plan.make, plan.space, points, starts_at(plan.start, points))
    columns, after = empty(len(points), plan.columns), dict[str, Any]()
    columns["status"][list(refused)] = Status.BAD_INPUT
    notes.update(refused.values())
    for group in groups:
        going_on = Group(group.at, group.robot, _start(group.start, ends, group.at))
        solved = columns_of_group(going_on, plan.options, workers, None, notes, solve_to_end)
        for name, values in solved.items():
            if name in columns:
                columns[name][group.at] = values
            elif name.startswith(END):
                _keep(
                    after, name.removeprefix(END), group.at, np.where(per_case(solved["status"] <= 1, values), values, np.nan), len(points)
                )
    return columns, after


def _keep(ends: dict[Any, Array], name: str, at: Array, values: Array, count: int) -> None:
    """Store the final values of a group; laws of different kinds may have states of the same name but different length."""
    shape = values.shape[1:]
    ends.setdefault((name, shape), np.full((count, *shape), np.nan))[at] = values


def _start(given: dict[str, Any], ends: dict[Any, Array], at: Array) -> dict[str, Any]:
    """The final states of the neighbours; where there is none, the initial state of the study."""
    start = dict(given)
    for (name, _), values in ends.items():
        mine = values[at]
        if np.isfinite(mine).any():
            usual = np.broadcast_to(per_case(np.asarray(given.get(name, 0.0), float), mine), mine.shape)
            start[name] = np.where(np.isfinite(mine), mine, usual)
    return start
