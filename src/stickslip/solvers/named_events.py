"""Events of the user in what `solve` returns: in the run itself, or as columns of a batch, whose cases are asked as they are solved.

Steps are recorded then, one case after the other in each thread. Cases of closed arcs, which have no steps, and of ``settle="auto"``, which
end before their time, are run once more by themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.batch import Labels, cases_of
from stickslip.basics.errors import InputError, SolveError
from stickslip.basics.interruption import look
from stickslip.basics.status import ENDS, Status
from stickslip.models.crossings import Crossing, checked_crossings
from stickslip.models.model_adapter import adapter_of
from stickslip.results.named_events import found_events
from stickslip.results.trajectory import Trajectory
from stickslip.solvers.gather import trajectory

if TYPE_CHECKING:
    from stickslip.results.summary import Summary
    from stickslip.solvers.settings import Request


def events_of_model(what: str, model: Any, events: Any) -> dict[str, Crossing]:
    """The events that were asked for, by name; none may be called as a contact or a stop of the model is."""
    if events is None:
        return {}
    return checked_crossings(what, events, adapter_of(model).event_names)


Watch = Callable[[int, Trajectory | None], Any]  # takes the number of a case and its run, None where it could not be followed


class Watched:
    """The events of a batch, and what is known of them: rows of columns by case."""

    def __init__(self, todo: Request, events: Mapping[str, Crossing], watch: Watch | None = None):
        self.todo, self.events, self.watch = todo, events, watch
        self.rows: dict[int, dict[str, Any]] = {}

    def note(self, k: int, method: str, pieces: Any, status: int) -> None:
        """Look for the events in the dense output of case k, which ended with a status."""
        if status == Status.NOT_COMPUTED:
            return
        if status > Status.REPEATS and status not in ENDS:
            self.note_run(k, None)
            return
        (case,) = cases_of(self.todo.model, slice(k, k + 1))
        self.note_run(k, trajectory(_one_case(self.todo, case, k), method, pieces, {}, status if status in ENDS else 0))

    def note_run(self, k: int, run: Trajectory | None) -> None:
        """The same of its run; None where it could not be followed."""
        self.rows[k] = lacking_columns(self.events) if run is None else event_columns(run, self.events)
        if self.watch is not None:
            self.watch(k, run)


def watching(todo: Request, events: Mapping[str, Crossing], watch: Watch | None = None) -> Request:
    """The request, with events that are looked for as its cases are solved; and who is shown them."""
    asked = (events or watch is not None) and todo.keep == "summary" and not todo.auto
    return replace(todo, watched=Watched(todo, events, watch)) if asked else todo


def with_events(todo: Request, result: Any, events: Mapping[str, Crossing], run: Callable[[Request], Any]) -> Any:
    """A result of `solve` with the events that were asked for; `run` solves a request."""
    if not events:
        return result
    return marked(result, events) if isinstance(result, Trajectory) else _with_columns(todo, result, events, run)


def marked(run: Trajectory, events: Mapping[str, Crossing]) -> Trajectory:
    """A run with its events; up to the first one that ends it."""
    located = found_events(run, events)
    end = next((event for event in located if events[event.part].terminal), None)
    if end is None:
        return replace(run, named_events=tuple(located))
    pieces = run.pieces.until(end.t) if end.t < run.pieces.t[-1] else run.pieces
    known = tuple(event for event in located if event.t <= end.t)
    return replace(run, pieces=pieces, status=f"ended by the event {end.part!r}", named_events=known)


def event_columns(run: Trajectory, events: Mapping[str, Crossing]) -> dict[str, Any]:
    """The first instant of each event of a run (NaN: none), and how often it happens."""
    times = {name: [event.t for event in found_events(run, {name: each})] for name, each in events.items()}
    first = {column_of("first", name): own[0] if own else np.nan for name, own in times.items()}
    return first | {column_of("number", name): len(own) for name, own in times.items()}


def refuse_terminal(what: str, events: Mapping[str, Crossing]) -> None:
    """`InputError` where an event would end a run whose numbers are those of all of it."""
    if any(each.terminal for each in events.values()):
        mistake = "an event is terminal, and the numbers of a batch are those of whole runs; allowed are events that end nothing"
        raise InputError(what, [f'{mistake}; leave "ends" out, and read the column first_... for where a run would end'])


def column_of(what: str, name: str) -> str:
    """The name of a column of a batch: "first" or "number" of an event.

    Examples
    --------
    >>> column_of("first", "passes the mark")
    'first_passes_the_mark'
    """
    return f"{what}_" + "".join(letter if letter.isalnum() else "_" for letter in name)


def _with_columns(todo: Request, summary: Summary, events: Mapping[str, Crossing], run: Callable[[Request], Any]) -> Summary:
    """The summary with two more columns for each event: its first instant (NaN: none), and how often it happens (-1: not known)."""
    refuse_terminal("solve", events)
    return replace(summary, columns={**summary.columns, **event_columns_of_cases(todo, events, run)})


def event_columns_of_cases(todo: Request, events: Mapping[str, Crossing], run: Callable[[Request], Any]) -> dict[str, Any]:
    """These columns by name, in the shape of the batch: cases that were not asked as they were solved are run over all of their time."""
    known = {} if todo.watched is None else todo.watched.rows
    rows: list[dict[str, Any]] = []
    for k, case in enumerate(cases_of(todo.model)):
        look()
        if k not in known:
            try:
                known[k] = event_columns(run(_one_case(todo, case, k)), events)
            except SolveError:
                known[k] = lacking_columns(events)
        rows.append(known[k])
    return {name: np.array([row[name] for row in rows]).reshape(todo.labels.shape) for name in lacking_columns(events)}


def lacking_columns(events: Mapping[str, Crossing]) -> dict[str, Any]:
    """The columns of a case of which they are not known."""
    return {column_of("first", name): np.nan for name in events} | {column_of("number", name): -1 for name in events}


def _one_case(todo: Request, case: Any, k: int) -> Request:
    """The request for one case of a batch as a run."""
    numbers = {name: float(np.ravel(value)[0]) for name, value in todo.numbers_of(slice(k, k + 1)).items()}
    return replace(
        todo,
        model=case,
        labels=Labels(()),
        start=todo.start[k : k + 1],
        keep="trajectory",
        auto=False,
        span=np.ravel(todo.span)[k : k + 1],
        numbers=numbers,
        observe=(),
        given_start={},
        progress=lambda done, cases: None,
        partial=False,
        modes=todo.modes[k : k + 1],
        watched=None,
    )
