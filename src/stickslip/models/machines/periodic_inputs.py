"""Inputs of a joint, an applied torque or a target: numbers, periodic functions of time, and the period that they have together."""

from __future__ import annotations

import dataclasses
from fractions import Fraction
from math import lcm
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import Frozen, is_record
from stickslip.models.drives.common import own_time, repeated_instants
from stickslip.models.machines.periodic_record import PeriodicRecord

MOST = 64  # periods of an input that one period of the machine may be
_SAME = 1e-12  # of a period: how exactly a time must divide it


class TakesInput(Frozen):
    """Base of the records some of whose fields are a number or a periodic function of time; (times, values) become a sum of harmonics."""

    _input: ClassVar[tuple[str, tuple[str, ...], str]]  # its name, what a function of time has to say, and what is allowed
    _more_inputs: ClassVar[tuple[tuple[str, tuple[str, ...], str], ...]] = ()

    def __post_init__(self) -> None:
        for name, _, _ in (self._input, *self._more_inputs):
            value = getattr(self, name)
            is_pair = isinstance(value, (tuple, list)) and len(value) == 2 and all(hasattr(each, "__len__") for each in value)
            object.__setattr__(self, name, PeriodicRecord.from_samples(*value) if is_pair else value)
        super().__post_init__()

    def _take(self, field: dataclasses.Field[Any], problems: Problems) -> None:
        own = next((each for each in (self._input, *self._more_inputs) if each[0] == field.name), self._input)
        name, needs, allowed = own
        value = getattr(self, name)
        if field.name != name or not (is_record(value) or hasattr(value, needs[0])):
            super()._take(field, problems)
        elif isinstance(value, type) or not is_record(value):
            problems.add(f"{name} = {value!r}; allowed is {allowed}")
        elif lacking := [each for each in ("period", *needs) if not hasattr(value, each)]:
            problems.add(f"{name} = {value!r} has no {' and no '.join(lacking)}; allowed is {allowed}")


def in_period(t: Numeric, value: Numeric, count: int) -> Any:
    """A time in `count` periods of an input, put into the first of them [s]."""
    period = getattr(value, "period", None)
    return t if period is None else own_time(t, period, count)


def breaks_of(value: Numeric, count: int) -> list[Any]:
    """Instants of `count` periods of an input at which it is not smooth [s], the borders of the periods among them."""
    period = getattr(value, "period", None)
    if period is None:
        return []
    jumps = [instant for instant, _ in getattr(value, "jumps", None) or () if not (isinstance(instant, float) and instant == 0.0)]
    own = [*(getattr(value, "breaks", None) or ()), *jumps]
    return list(repeated_instants(own, period, count))


def most_times(whole: Any, period: Numeric) -> int:
    """How often a period is in a time that is a whole number of it; of several cases the most.

    Examples
    --------
    >>> most_times(3.0, 0.5)
    6
    """
    import numpy as np

    return int(np.max(np.rint(np.asarray(whole, float) / np.asarray(period, float))))


def common_count(period: Numeric, others: list[Any]) -> int:
    """How many periods are also a whole number of each of some other times, for all cases; 0 if none up to `MOST`.

    Examples
    --------
    >>> common_count(1.0, [0.5, 0.001]), common_count(1.0, [0.75]), common_count(1.0, [0.7071067811865476])
    (1, 3, 0)
    """
    import numpy as np

    count = 1
    for other in others:
        for ratio in np.unique(np.asarray(period, float) / np.asarray(other, float)):
            part = Fraction(float(ratio)).limit_denominator(MOST)
            if abs(float(part) - ratio) > _SAME * ratio:
                return 0
            count = lcm(count, part.denominator)
    return count if count <= MOST else 0
