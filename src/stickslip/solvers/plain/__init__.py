"""scipy's integrators on the same law object, in plain Python floats: the independent judge. Slow, and nothing in it is ours.

Every stretch is integrated on one side of the contact's velocity and with the law's memories held, and ends where that velocity comes
back to zero, where a memory switches, where the load falls to zero, or at an instant that is known beforehand (a break or an impulse
of the drive). So no step crosses the kink of a dynamic law or the jump of a set-valued one. A set-valued law has a third mode, stuck,
which ends where the net applied force reaches break-away. It takes every law, every drive and every mechanism.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

from stickslip.basics.batch import cases_of
from stickslip.basics.contracts import Model
from stickslip.basics.errors import SolveError
from stickslip.basics.status import Status
from stickslip.models.machine_adapter import machine_of
from stickslip.results.summary import Summary
from stickslip.results.trajectory import Trajectory
from stickslip.solvers import strobes
from stickslip.solvers.gather import RawResults, gather, trajectory
from stickslip.solvers.part_results import nothing as no_parts
from stickslip.solvers.plain.marching import march, marched
from stickslip.solvers.plain.reduction import reduced
from stickslip.solvers.plain.stretch import NAMES
from stickslip.solvers.settings import Request

__all__ = ["NAMES", "solve"]


def solve(todo: Request) -> Trajectory | Summary:
    """Solve as asked, case by case."""
    todo = replace(todo, method="dop853") if todo.method == "auto" else todo
    if todo.keep == "summary":
        return gather(todo, todo.method, _parts(todo))
    pieces, counts, status = march(todo, _case(todo, 0), 0)
    return trajectory(todo, todo.method, pieces, counts, status)


def _case(todo: Request, i: int) -> Any:
    """One case of the batch, its numbers plain floats."""
    (case,) = cases_of(todo.model, slice(i, i + 1))
    return case


def _nothing(model: Model) -> dict[str, Any]:
    """Results of a case that could not be solved."""
    m = machine_of(model).mechanics
    return {**strobes.NOTHING, "parts": no_parts(len(m.bodies), len(m.contacts), len(m.named_stops))}


def _parts(todo: Request) -> Iterator[tuple[tuple[int, int], RawResults]]:
    """Raw results case by case."""
    for i in range(todo.cases):
        model = _case(todo, i)
        solved = strobes.case_or_nothing(partial(_solved, todo, model, i), _nothing(model), todo.partial)
        yield (i, i + 1), strobes.raw(solved)
        todo.progress(i + 1, todo.cases)


def _solved(todo: Request, model: Model, i: int) -> dict[str, Any]:
    """The results of one case; one that fails has a status."""
    try:
        run = marched(todo, model, i)
        if run.ended:
            return {**_nothing(model), "status": run.ended, "failure": run.message(run.ended)}
        pieces = run.pieces()
        if todo.watched is not None:
            todo.watched.note(i, todo.method, pieces, Status.FINISHED)
        return reduced(todo, model, pieces, i)
    except SolveError as error:
        return {**_nothing(model), "status": Status.TOO_SMALL if error.status is None else error.status, "failure": str(error)}
