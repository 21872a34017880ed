"""What is told of the best candidate: everything computed anew from the machine alone."""

from __future__ import annotations

from functools import reduce
from typing import Any

import numpy as np

from stickslip.drives.within import drives_within
from stickslip.dynamics.derivatives.sensitivity import directions_of
from stickslip.dynamics.stroboscopic.strobe_maps import spread_over
from stickslip.errors import StickslipError
from stickslip.optimising.candidates import Candidates
from stickslip.optimising.coexisting import continued, from_other_starts
from stickslip.optimising.constraints import KEPT, Limit
from stickslip.optimising.gradients import Gradient, gradient
from stickslip.optimising.optimum import Optimum, Search
from stickslip.optimising.optimum_cuts import cuts_of
from stickslip.optimising.peaks import LIMITS, peaks_of
from stickslip.optimising.results import results_of
from stickslip.optimising.small_friction import small_friction_limit
from stickslip.optimising.unknowns import Unknowns

__all__ = ["optimum_of", "values_of"]

Array = Any
_ACTIVE = 1e-6  # how near a limit or a bound is active, as a part of it
_SAME = 1e-5  # of the mean velocity: attractors nearer to each other are one; dynamic laws are run to 1e-6


def optimum_of(worth: Candidates, notes: list[str], search: Search) -> Optimum:
    """The result of a search that has met a machine within the limits."""
    model, space = worth.space.machine(worth.best), worth.space
    values, given = values_of(model), values_of(space.model)
    V = float(values.get("mean_velocity", np.nan))
    limit, what = small_friction_limit(model, worth.limits, forwards=V >= 0.0)
    numbers = space.numbers(worth.best)
    way = continued(space.model, model, numbers)
    notes = [*notes, *from_other_starts(model, V), *_another_way(V, way), *_remarks(values), *_not_kept(worth.limits, given)]
    slopes = _sensitivities(model, worth, notes)
    return Optimum(
        model,
        of=worth.quantity,
        values=values,
        varied=numbers,
        of_limit=None if limit is None else abs(V) / limit,
        limit=what,
        active=(*_active_limits(worth.limits, values), *_active_bounds(space, worth.best)),
        sensitivities=slopes,
        tried=worth.tried,
        given=given,
        search=search,
        notes=tuple(notes),
        continued=way,
        robust=None if worth.sample is None else worth.sign * worth.least,
        given_model=space.model,
        cuts=cuts_of(worth),
    )


def _remarks(values: dict[str, Any]) -> list[str]:
    rests = ["the best machine does not move: its mean velocity is 0"] if values.get("mean_velocity") == 0.0 else []
    return [*rests, *(["the motion had not settled: V is that of its last periods"] if values.get("steadiness", 0) != 0 else [])]


def _not_kept(limits: list[Limit], given: dict[str, Any]) -> list[str]:
    """Sentences on limits beyond which the search began."""
    beyond = [limit for limit in limits if limit.name in given and np.min(limit.margins(given[limit.name])) < -KEPT]
    return [f"the given machine violates the limit of {limit.in_words()}" for limit in beyond]


def values_of(model: Any, rtol: float = 1e-9) -> dict[str, Any]:
    """Numbers of the motion from rest, and the peaks of the drives."""
    columns = results_of(spread_over(model, 1), 1, rtol=rtol)
    found = {name: values[0].item() for name, values in columns.items() if not name.startswith("end.")}
    drives = list(drives_within(model))
    return found | {name: float(reduce(max, [peaks_of(drive, name) for drive in drives])) for name in (LIMITS if drives else ())}


def _another_way(V: float, way: float | None) -> list[str]:
    """A sentence where the motion that is continued from that of the given machine is another one than that from rest."""
    if way is None or abs(way - V) <= _SAME * abs(V):
        return []
    return [f"continued from the motion of the given machine, V = {way:.6g} m/s; from rest it is {V:.6g}"]


def _active_limits(limits: list[Limit], values: dict[str, Any]) -> list[str]:
    return [limit.name for limit in limits if limit.name in values and np.min(limit.margins(values[limit.name])) <= _ACTIVE]


def _active_bounds(space: Unknowns, u: Array) -> list[str]:
    numbers = [(each, float(u[place.start])) for each, place in zip(space.varied, space.slices, strict=True) if each.form is None]
    return [each.name for each, value in numbers if min(value, 1.0 - value) <= _ACTIVE]


def _sensitivities(model: Any, worth: Candidates, notes: list[str]) -> Gradient:
    """Derivatives by all numbers but those of waveforms."""
    forms = [each.leaves[0] + "." for each in worth.space.varied if each.form is not None]
    try:
        names = [name for name in directions_of("optimise", model, None) if not name.startswith(tuple(forms))] if forms else None
        return gradient(model, worth.quantity, names)
    except StickslipError as error:
        notes.append(f"no derivatives: {error}")
        return Gradient({}, worth.quantity, float("nan"), (str(error),))
