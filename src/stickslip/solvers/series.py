"""Which order of Taylor series a tolerance asks for, and whether a machine's law has the inner state that they need."""

from __future__ import annotations

from typing import Any

from stickslip.engine.slaved import SERIES, Series
from stickslip.engine.slaving import slaving
from stickslip.engine.trace import kind_of, trace

__all__ = ["SAFETY", "lacks", "method"]

#: The steps are held to a part of the tolerance asked for: with it the map of one period is within 10 times the tolerance for each of
#: ten thousand random robots, also where errors grow a hundredfold in a period (verification/series_of_robots.py).
SAFETY = 0.05

_said: dict[Any, str | None] = {}


def method(rtol: float) -> tuple[Series, float]:
    """The series for a tolerance, and the tolerance to which their steps are held."""
    held = SAFETY * rtol
    return next(series for least, series in SERIES if held >= least), held


def lacks(model: Any) -> str | None:
    """None where Taylor series take a machine, or why not; a kind that was seen before costs nothing."""
    key = kind_of(model)
    try:
        if key not in _said:
            _said[key] = _asked(model)
        return _said[key]
    except TypeError:  # a part of the kind that cannot be compared, such as a list
        return _asked(model)


def _asked(model: Any) -> str | None:
    found = slaving(trace(model))
    return found if isinstance(found, str) else None
