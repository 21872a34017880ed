"""Which order of Taylor series a tolerance asks for, and whether a machine's law has the inner state that they need."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeVar

from stickslip.basics.batch import numbers_by_name
from stickslip.basics.contracts import Model
from stickslip.engine import several_series
from stickslip.engine.kinds import known_kind
from stickslip.engine.law_checks import check_numbers
from stickslip.engine.remembered import Remembered
from stickslip.engine.several_series import SeveralSeries, Swings
from stickslip.engine.slaved import SERIES, Series
from stickslip.engine.slaving import slaving
from stickslip.engine.symbolic import SPAN
from stickslip.engine.trace import trace

if TYPE_CHECKING:
    from stickslip.solvers.settings import Request

#: The steps are held to a part of the tolerance asked for: with it the map of one period is within 10 times the tolerance for each of
#: ten thousand random robots, also where errors grow a hundredfold in a period (verification/series_of_robots.py).
SAFETY = 0.05

_Steps = TypeVar("_Steps")
_reasons: Remembered[str | None] = Remembered()
_swings: Remembered[Swings | str] = Remembered()


def method(rtol: float) -> tuple[Series, float]:
    """The series for a tolerance, and the tolerance to which their steps are held."""
    return _of_table(SERIES, rtol)


def _of_table(table: Sequence[tuple[float, _Steps]], rtol: float) -> tuple[_Steps, float]:
    """The first steps of a table whose least tolerance is not below that to which they are held, and the latter."""
    held = SAFETY * rtol
    return next(steps for least, steps in table if held >= least), held


def series_refusal(model: Model) -> str | None:
    """None where Taylor series take a machine, or why not; a kind that was asked before costs nothing."""

    def reason() -> str | None:
        check_numbers(model)
        law = slaving(trace(model))
        return law if isinstance(law, str) else None

    return _reasons(known_kind(model), reason)


def method_of_several(rtol: float) -> tuple[SeveralSeries, float]:
    """The same of several inner states."""
    return _of_table(several_series.SERIES, rtol)


def swings_of(model: Model) -> Swings | str:
    """How fast the inner states of a machine swing; or why series of several states do not take it. A known kind costs nothing."""

    def asked() -> Swings | str:
        check_numbers(model)
        return several_series.swings(trace(model))

    return _swings(known_kind(model), asked)


def smooth_cases(todo: Request) -> Any:
    """In which cases of a request explicit steps are not kept short by inner states that are fast beside the period: array (cases,)."""
    import numpy as np

    swings = swings_of(todo.model)
    assert not isinstance(swings, str)
    numbers = {SPAN: todo.span} | todo.numbers_of()
    if any(name not in numbers for name in swings.eq.names):  # another model takes the place of the one that was given
        numbers = dict.fromkeys(swings.eq.names, 0.0) | numbers | numbers_by_name(todo.model, slice(None))
    most = swings.in_a_period(numbers)
    return np.broadcast_to(np.ravel(most <= several_series.SMOOTH), (todo.cases,))
