"""Constraints on a machine: peaks of its drives and results of its motion."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import Problems, did_you_mean
from stickslip.basics.quantities import pretty_unit
from stickslip.basics.variables import unit_of
from stickslip.inverse.optimisation.bounds import typed_ends
from stickslip.inverse.optimisation.peaks import LIMITS, peaks_of
from stickslip.inverse.optimisation.results import quantities
from stickslip.inverse.optimisation.waveforms import Scales
from stickslip.models.drives.within import drives_within

#: How far beyond a limit still counts as within, as a part of it: rounding, of formulas that reach it exactly.
KEPT = 1e-9
_TYPED = 'type for example subject_to={"stroke": (None, 0.01), "relative_acceleration": (None, 60.0)}'


@dataclass(frozen=True)
class Limit:
    """A quantity with its least and its largest value; infinite where there is none."""

    name: str
    low: float
    high: float
    unit: str = ""

    @property
    def of_drive(self) -> bool:
        """Whether it follows from the drives alone, without a run."""
        return self.name in LIMITS

    def values(self, machines: Any, columns: dict[str, Array]) -> Array:
        """The values of the machines."""
        if not self.of_drive:
            return columns[self.name]
        return reduce(np.maximum, [peaks_of(drive, self.name) for drive in drives_within(machines)])

    def margins(self, values: Array) -> Array:
        """How far the values are within, as a part of the limit; negative beyond it: array (sides, cases)."""
        ends = [(end, sign) for end, sign in ((self.low, 1.0), (self.high, -1.0)) if np.isfinite(end)]
        return np.array([sign * (np.asarray(values) - end) / (abs(end) or 1.0) for end, sign in ends])

    @property
    def ends(self) -> tuple[float | None, float | None]:
        """As they were typed: None where there is none."""
        low, high = (float(end) if np.isfinite(end) else None for end in (self.low, self.high))
        return low, high

    def in_words(self) -> str:
        """The limit as messages call it.

        Examples
        --------
        >>> Limit("stroke", -np.inf, 0.01, "m").in_words(), Limit("period", 1.0, 2.0).in_words()
        ('stroke (at most 0.01 m)', 'period (from 1 to 2)')
        """
        low, high = self.ends
        ends = f"at most {high:g}" if low is None else f"at least {low:g}" if high is None else f"from {low:g} to {high:g}"
        return f"{self.name} ({f'{ends} {pretty_unit(self.unit)}'.rstrip()})"


def checked_limits(model: Model, subject_to: Any, problems: Problems) -> list[Limit]:
    """The limits that were typed; what is wrong with them is noted."""
    if subject_to is None:
        return []
    if not isinstance(subject_to, dict):
        problems.add(f"subject_to = {subject_to!r}; allowed is a dict of limits; {_TYPED}")
        return []
    limits = [_limit(model, str(name), ends, problems) for name, ends in subject_to.items()]
    return [limit for limit in limits if limit is not None]


def _limit(model: Model, name: str, ends: Any, problems: Problems) -> Limit | None:
    known = [*LIMITS, *quantities(model)]
    if name not in known:
        problems.add(f"subject_to: {name!r} is not a quantity that can be limited; {did_you_mean(name, known)}")
        return None
    if name in LIMITS and not list(drives_within(model)):
        problems.add(f"subject_to: {name!r} is of a drive, and {type(model).__name__} has none; leave it out")
        return None
    try:
        unit = LIMITS.get(name) or unit_of(name, model)
        least, largest = typed_ends(ends, unit)
    except ValueError as error:
        typed = f'type subject_to={{"{name}": (None, {ends!r})}}' if isinstance(ends, (str, int, float)) else _TYPED
        problems.add(f"subject_to[{name!r}] = {ends!r}: {error}; allowed is (least, largest) with None for no limit; {typed}")
        return None
    low, high = -np.inf if least is None else least, np.inf if largest is None else largest
    if not low < high or (np.isinf(low) and np.isinf(high)) or (name in LIMITS and high <= 0.0):
        typed = f'type subject_to={{"{name}": ({high:g}, {low:g})}}' if np.isfinite(low) and 0.0 < high < low else _TYPED
        problems.add(f"subject_to[{name!r}] = {ends!r} cannot be satisfied; allowed is (least, largest), the lesser first; {typed}")
        return None
    return Limit(name, low, high, "" if unit == "1" else unit)


def scales_within(limits: list[Limit], subject_to: Any, problems: Problems) -> Scales:
    """The limits that give a waveform its size; noted where one is missing without which it would grow for ever."""
    known = {limit.name: limit.high for limit in limits if limit.of_drive}
    scales = Scales(*(known.get(name, np.inf) for name in ("relative_acceleration", "stroke", "relative_velocity")))
    wrong = {*subject_to} - {limit.name for limit in limits} if isinstance(subject_to, dict) else set()  # noted already
    if not np.isfinite(scales.acceleration) and "relative_acceleration" not in wrong:
        problems.add(f'a waveform needs a limit of "relative_acceleration", which gives it its size; {_TYPED}')
    if not np.isfinite(min(scales.stroke, scales.velocity)) and wrong.isdisjoint(("stroke", "relative_velocity")):
        problems.add(f'a waveform needs a limit of "stroke" or of "relative_velocity", which gives it its period; {_TYPED}')
    return scales
