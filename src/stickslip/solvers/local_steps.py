"""Rows of many bodies: each cluster of moving bodies steps by itself, and an event costs what its neighbours cost."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from stickslip.basics.batch import cases_of, flat
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, SolveError
from stickslip.basics.interruption import is_stopped, look
from stickslip.basics.status import Status
from stickslip.engine import local_events
from stickslip.engine.law_checks import check_numbers
from stickslip.engine.symbols import TraceError
from stickslip.models.machine_adapter import machine_of
from stickslip.models.state_layout import BodyStates, ContactStates, StateLayout
from stickslip.results.local_pieces import LocalPieces
from stickslip.results.summary import Summary
from stickslip.results.trajectory import Trajectory
from stickslip.solvers import stopped, strobes
from stickslip.solvers.gather import RawResults, gather, trajectory
from stickslip.solvers.part_results import nothing as no_parts
from stickslip.solvers.settings import Request

#: Contacts up to which equations are written out: more are rows of a table.
WRITTEN_OUT = 16
#: Bytes that the pieces of a run may take.
KEPT = 4_000_000_000


def lacks(model: Model) -> str | None:
    """None if a machine is a row of many bodies whose forces are tables; else why not."""
    machine = machine_of(model)
    count = len(machine.mechanics.contacts)
    if count <= WRITTEN_OUT:
        return f"it is for more than {WRITTEN_OUT} contacts"
    if any(law.dynamic for law in machine.laws):
        return f"it is for set-valued laws; {machine.law_names} has inner states"
    if machine_of(_one(model)).mechanics.separate is None:
        return "it is for bodies on contacts of their own with a ground that moves steadily, and for forces of links and of bodies alone"
    try:
        _row(_one(model))
    except (TraceError, TypeError, ValueError, InputError) as error:
        return f"its forces are no tables ({error})"
    return None


def _one(model: Model) -> Model:
    """The first case."""
    return cases_of(model, slice(1))[0]


def _row(model: Model) -> local_events.Row:
    return local_events.row_of(machine_of(model).mechanics)


def run(todo: Request) -> Trajectory | Summary:
    """Solve as asked, case by case."""
    if todo.keep == "summary":
        return gather(todo, "exact", _parts(todo))
    model = _one(todo.model)
    outcome, pieces = _solved(todo, model, 0)
    counts = {"steps": outcome.steps, "rejected": outcome.rejected}
    if outcome.status == 0:
        if not todo.partial:
            look()
        return trajectory(todo, "exact", pieces, counts, Status.NOT_COMPUTED)
    return trajectory(todo, "exact", pieces, counts)


def _solved(todo: Request, model: Model, case: int) -> tuple[local_events.RowOutcome, LocalPieces]:
    """One case: what became of it, and its dense output; `SolveError` if it stopped early."""
    mechanics: Any = machine_of(model).mechanics
    span, bodies = float(todo.span[case]), len(mechanics.bodies)
    end = span * todo.periods if todo.duration is None else min(span * todo.periods, todo.duration)
    x, v = todo.start[case, :bodies], todo.start[case, bodies : 2 * bodies]
    width = 8 * (local_events.ORDER + 4)

    def go_on(t: float) -> bool:
        one = todo.keep == "trajectory"
        if one:
            todo.progress(int(t / span), todo.periods)
        if not (one and todo.partial):
            look()
        return not is_stopped()

    outcome = local_events.run(_row(model), x, v, end, float(mechanics.velocity_scale), KEPT // width, go_on)
    until = end if outcome.status == 1 else outcome.t
    pieces = pieces_of(mechanics, outcome.first_modes, outcome.pieces, outcome.events, 0.0, until)
    if outcome.status > 1:
        check_numbers(model)
        raise SolveError(_message(todo, outcome, mechanics, pieces), outcome.status)
    return outcome, pieces


def _message(todo: Request, outcome: local_events.RowOutcome, mechanics: Any, pieces: LocalPieces) -> str:
    """Where and why a run stopped early."""
    recent = outcome.events[-200:, 1].astype(int)
    body = int(np.bincount(recent).argmax()) if len(recent) else 0
    where = f"at t = {outcome.t:.9g} s, where {mechanics.bodies[body]!r} has changed its mode most often of late"
    state = f"that of {len(mechanics.bodies)} bodies"
    return stopped.stopping_message(outcome.status, where, state, stopped.remedy(outcome.status, todo.rtol, False))


def pieces_of(mechanics: Any, first_modes: Array, pieces: list[Array], events: Array, begin: float, end: float) -> LocalPieces:
    """The dense output of a row between two times.

    Parameters
    ----------
    mechanics : Mechanics
    first_modes : array (bodies,)
        Their modes where it begins.
    pieces : list of array (pieces, 2 + coefficients)
        Body, beginning, coefficients of its position; those of a body in order of time.
    events : array (events, 3)
        Time, body, new mode, in order of time.
    begin, end : float
        [s]
    """
    bodies, of = len(mechanics.bodies), bodies_of_contacts(mechanics)
    counts = sum((np.bincount(part[:, 0].astype(np.int64), minlength=bodies) for part in pieces), np.zeros(bodies, np.int64))
    first = np.concatenate([[0], np.cumsum(counts)])
    begins, c = np.empty(first[-1]), np.empty((first[-1], local_events.ORDER + 2))
    positions = first[:-1].copy()
    for part in pieces:  # those of one body come in order of time
        body = part[:, 0].astype(np.int64)
        order = np.argsort(body, kind="stable")
        own = np.bincount(body, minlength=bodies)
        within = np.arange(len(part)) - np.repeat(np.cumsum(own) - own, own)
        at = positions[body[order]] + within
        begins[at], c[at] = part[order, 1], part[order, 2:]
        positions += own
    times = np.unique(events[:, 0])
    inside = times[(times > begin) & (times < end)]
    mode = np.empty((len(inside) + 1, len(of)), np.int8)
    number = np.searchsorted(inside, events[:, 0], side="right")  # of the piece that begins there
    changed = events[:, 1].astype(np.int64)
    order = np.argsort(changed, kind="stable")
    borders = np.searchsorted(changed[order], np.arange(bodies + 1))
    for i, rubs in enumerate(of):
        own = order[borders[rubs] : borders[rubs + 1]]
        edges = [0, *number[own].tolist(), len(mode)]
        values = [first_modes[rubs], *events[own, 2].astype(np.int8)]
        mode[:, i] = np.repeat(values, np.diff(edges))
    return LocalPieces(np.concatenate([[begin], inside, [end]]), mode, begins, c, first, layout_of(mechanics))


def bodies_of_contacts(mechanics: Any) -> list[int]:
    """The number of the body of each contact."""
    number = {name: i for i, name in enumerate(mechanics.bodies)}
    return [number[contact.body] for contact in mechanics.joints.values()]


def layout_of(mechanics: Any) -> StateLayout:
    """The states: velocities, then positions."""
    count = len(mechanics.bodies)
    return StateLayout(
        tuple(BodyStates(name, velocity=i, position=count + i) for i, name in enumerate(mechanics.bodies)),
        tuple(ContactStates(name, row) for name, row in zip(mechanics.contacts, mechanics.slips_of, strict=True)),
        principal=getattr(mechanics.model, "principal", None),
    )


def _parts(todo: Request) -> Iterator[tuple[tuple[int, int], RawResults]]:
    """Raw results case by case."""
    m = machine_of(flat(todo.model)).mechanics
    nothing = {**strobes.NOTHING, "parts": no_parts(len(m.bodies), len(m.contacts), 0)}
    for i in range(todo.cases):
        (model,) = cases_of(todo.model, slice(i, i + 1))
        solved = strobes.case_or_nothing(partial(_reduced, todo, model, i, nothing), nothing, todo.partial)
        yield (i, i + 1), strobes.raw(solved)
        todo.progress(i + 1, todo.cases)


def _reduced(todo: Request, model: Model, i: int, nothing: dict[str, Any]) -> dict[str, Any]:
    """The results of one case; one that fails has a status."""
    from stickslip.solvers.plain.reduction import reduced

    try:
        return reduced(todo, model, _solved(todo, model, i)[1], i)
    except SolveError as error:
        return {**nothing, "status": Status.TOO_SMALL if error.status is None else error.status, "failure": str(error)}
