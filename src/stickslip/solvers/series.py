"""Which order of Taylor series a tolerance asks for, and whether a machine's law has the inner state that they need."""

from __future__ import annotations

from stickslip.basics.contracts import Model
from stickslip.engine.kinds import known_kind
from stickslip.engine.law_checks import check_numbers
from stickslip.engine.remembered import Remembered
from stickslip.engine.slaved import SERIES, Series
from stickslip.engine.slaving import slaving
from stickslip.engine.trace import trace

#: The steps are held to a part of the tolerance asked for: with it the map of one period is within 10 times the tolerance for each of
#: ten thousand random robots, also where errors grow a hundredfold in a period (verification/series_of_robots.py).
SAFETY = 0.05

_reasons: Remembered[str | None] = Remembered()


def method(rtol: float) -> tuple[Series, float]:
    """The series for a tolerance, and the tolerance to which their steps are held."""
    held = SAFETY * rtol
    return next(series for least, series in SERIES if held >= least), held


def series_refusal(model: Model) -> str | None:
    """None where Taylor series take a machine, or why not; a kind that was asked before costs nothing."""

    def reason() -> str | None:
        check_numbers(model)
        law = slaving(trace(model))
        return law if isinstance(law, str) else None

    return _reasons(known_kind(model), reason)
