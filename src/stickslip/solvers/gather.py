"""From raw results to columns for users, in one place for all solvers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, dataclass, fields
from functools import cached_property, partial
from typing import Any

import numpy as np

from stickslip.basics.batch import spread_over_cases
from stickslip.basics.coded_words import CodedWords
from stickslip.basics.contracts import Array
from stickslip.basics.errors import SolveError
from stickslip.basics.interruption import look
from stickslip.basics.status import ENDS, STATUS, Status, interrupted_at
from stickslip.results.steadiness import STEADY, UNKNOWN, mean_tolerance, steadiness_codes
from stickslip.results.summary import Columns, Summary
from stickslip.results.trajectory import Trajectory
from stickslip.solvers.part_results import RawParts, columns_of_parts, of_own_parts, per_case, types_of
from stickslip.solvers.request import provenance
from stickslip.solvers.settings import Request
from stickslip.solvers.stopped import FAILURES, remedy as remedy_of


@dataclass(frozen=True, eq=False)
class RawResults:
    """Raw results of a batch solver for each case, before any words are added."""

    displacement: Any  # [m] over the window
    window: Any  # [drive periods]
    period: Any  # period number, 0 if none
    periods_run: Any
    status: Any
    limit: Any  # displacement in a drive period that the motion approaches [m], see stickslip.results.recurrence
    parts: RawParts
    observed: dict[str, Any] | None = None  # a user's own columns
    failures: dict[int, str] | None = None  # where and why the first cases ended before their time


#: Numbers of the cases themselves.
OF_CASES = tuple(f.name for f in fields(RawResults) if f.default is MISSING and f.name != "parts")

#: Places for segments, of all cases, and chunks up to which columns are computed when they are read: until then a summary
#: holds all raw results.
_LATER, _FEW = 1 << 20, 16


def gather(todo: Request, method: str, parts: Iterable[tuple[tuple[int, int], RawResults]], chunks: int | None = None) -> Summary:
    """A summary from raw results that arrive in so many chunks, or case by case, in any order."""
    cases = todo.cases
    few = (cases if chunks is None else chunks) <= _FEW
    T, tolerance, shape = todo.span, mean_tolerance(method, todo.rtol), todo.labels.shape
    columns: dict[str, Any] = {}
    coded: dict[str, dict[int, CodedWords]] = {}
    failures: dict[int, str] = {}
    later: dict[int, Columns] = {}
    for (first, last), raw in parts:
        failures |= {first + case: sentence for case, sentence in (raw.failures or {}).items()}
        made = _Cases(todo, raw, T[first:last], slice(first, last), tolerance).columns
        if few and raw.parts.seg_time[:1].size * cases <= _LATER:
            later[first] = Columns(made)
            continue
        for name, make in made.items():
            values = make()
            if isinstance(values, CodedWords):
                coded.setdefault(name, {})[first] = values
                continue
            if name not in columns:
                columns[name] = np.empty((cases, *values.shape[1:]), values.dtype)
            elif values.itemsize > columns[name].itemsize:  # longer words
                columns[name] = columns[name].astype(values.dtype)
            columns[name][first:last] = values
    if later:
        whole = [later[first] for first in sorted(later)]
        return summary(todo, method, Columns({name: partial(_joined, whole, name, shape) for name in whole[0]}), failures)
    for name, by_case in coded.items():
        begins, *others = (by_case[case] for case in sorted(by_case))
        columns[name] = begins.joined(others)
    return summary(todo, method, {name: columns[name].reshape((*shape, *columns[name].shape[1:])) for name in made}, failures)


def _joined(chunks: list[Columns], name: str, shape: tuple[int, ...]) -> Any:
    """A column of all cases."""
    begins, *others = values = [each[name] for each in chunks]
    whole = begins if not others else begins.joined(others) if isinstance(begins, CodedWords) else np.concatenate(values)
    return whole.reshape((*shape, *whole.shape[1:]))


def summary(todo: Request, method: str, columns: Mapping[str, Any], failures: dict[int, str]) -> Summary:
    """A summary of columns in the shape of the batch, with why the first cases of those that failed did."""
    shape, first = todo.labels.shape, sorted(failures.items())[:FAILURES]
    reasons = {tuple(map(int, np.unravel_index(case, shape))): sentence for case, sentence in first}
    return Summary(todo.model, todo.labels, columns, provenance(todo, method, None if method == "exact" else todo.rtol), reasons)


class _Cases:
    """Columns of some cases: intermediate results that several columns share are computed once, on first use."""

    def __init__(self, todo: Request, raw: RawResults, T: Any, at: slice, tolerance: float):
        self.raw, self.T, self.at, self.tolerance = raw, T, at, tolerance
        self.labels, self.dwell, self.machine = todo.labels, todo.dwell, todo.machine
        self.periodic, self.rtol = todo.model.period is not None, todo.rtol if self.machine.has_inner_states else 0.0

    @property
    def columns(self) -> dict[str, Callable[[], Any]]:
        """Functions that compute each column, by name."""
        raw = self.raw
        of_parts = of_own_parts(columns_of_parts(self), self.machine)
        power = of_parts.pop("friction_power", None)
        return {
            "mean_velocity": lambda: self.velocity,
            **of_parts,
            "period": lambda: np.where(self.good, raw.period, 0),
            "displacement": lambda: raw.displacement,
            **({} if power is None else {"friction_power": power}),
            "steadiness": lambda: self.steadiness.astype(np.int8),
            "settling_error": lambda: np.where(np.isfinite(self.approached), abs(self.velocity - self.approached), np.nan),
            "periods_run": lambda: raw.periods_run,
            "status": lambda: raw.status,
            **{name: partial(self.known, values) for name, values in (raw.observed or {}).items()},
        }

    def known(self, values: Array) -> Any:
        """Values of the cases, or of their parts, where a case was solved."""
        return np.where(per_case(self.good, values), values, np.nan)

    def extreme(self, last: Any, wide: Any, larger: Any) -> Any:
        """Extremes over the last motion period, or over the window where that does not say all."""
        return self.known(np.where(per_case(self.lasting, last), last, larger(last, wide)))

    def over_time(self, displacement: Any) -> Any:
        """Mean velocities over the window."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return self.known(displacement / per_case(self.raw.window * self.T, displacement))

    @cached_property
    def types(self) -> dict[str, Any]:
        """What several columns say of how contacts move."""
        return types_of(self)

    @cached_property
    def good(self) -> Any:
        return self.raw.status <= Status.REPEATS

    @cached_property
    def velocity(self) -> Any:
        return self.over_time(self.raw.displacement)

    @cached_property
    def approached(self) -> Any:
        """The mean velocities that the motions approach [m/s]."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(self.good & self.periodic, self.raw.limit / self.T, np.nan)

    @cached_property
    def steadiness(self) -> Any:
        if not self.periodic:
            return np.full(len(self.T), UNKNOWN)
        free = spread_over_cases(self.machine.free_velocity, self.labels)[self.at]
        return steadiness_codes(self.velocity, self.approached, self.raw.period, free, self.tolerance)

    @cached_property
    def lasting(self) -> Any:
        """Where the last motion period says all; elsewhere the extremes are those of the window of the mean."""
        return self.steadiness == STEADY


def trajectory(todo: Request, method: str, pieces: Any, counts: dict[str, Any], status: int = 0) -> Trajectory:
    """A trajectory from dense output, cut at the duration that was asked for; `SolveError` where there is no motion at all.

    With the status "not computed" it was interrupted, and its own status says when.
    """
    if status == Status.NOT_COMPUTED and len(pieces.mode) == 0:
        look()
    if len(pieces.mode) == 0 or not pieces.t[-1] > pieces.t[0]:
        remedy = remedy_of(status, todo.rtol, False) if status in ENDS else "give a longer run or other numbers"
        raise SolveError(f"the run ended at its start, t = {float(pieces.t[0]):.6g} s: {STATUS[status]}; {remedy}")
    tolerance = None if method == "exact" else todo.rtol
    if todo.duration is not None and pieces.t[-1] > todo.duration:
        pieces, status = pieces.until(todo.duration), 0
    sentence = interrupted_at(pieces.t[-1]) if status == Status.NOT_COMPUTED else STATUS[status]
    return Trajectory(
        model=todo.model, pieces=pieces, periods=todo.periods, settle=todo.settle, rtol=todo.rtol, method=method,
        status=sentence, samples=todo.samples, start=dict(todo.given_start),
        provenance=provenance(todo, method, tolerance), counts=counts,
    )  # fmt: skip
