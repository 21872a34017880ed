"""Report on the best candidate, with everything recomputed from the machine alone."""

from __future__ import annotations

from functools import reduce
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import StickslipError
from stickslip.basics.fields import leaves
from stickslip.dynamics.derivatives.sensitivity import directions_of
from stickslip.dynamics.stroboscopic.strobe_maps import spread_over
from stickslip.inverse.optimisation.candidates import Candidates
from stickslip.inverse.optimisation.coexisting_motions import continued, from_other_starts
from stickslip.inverse.optimisation.constraints import KEPT, Limit
from stickslip.inverse.optimisation.gradients import Gradient, gradient
from stickslip.inverse.optimisation.optimum import Optimum, Search
from stickslip.inverse.optimisation.optimum_cuts import cuts_of
from stickslip.inverse.optimisation.peaks import LIMITS, peaks_of
from stickslip.inverse.optimisation.perturbed_machines import moves_of, sizes_of
from stickslip.inverse.optimisation.results import moved_by, results_of
from stickslip.inverse.optimisation.small_friction import small_friction_limit
from stickslip.inverse.optimisation.unknowns import Unknowns
from stickslip.models.drives.within import drives_within

_ACTIVE = 1e-6  # how near a limit or a bound is active, as a part of it
_OFF, _LOST = 1e-4, 0.01  # how far a number may be off, and which part of the optimum that may cost
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
    notes += _on_an_edge(model, worth, float(values.get(worth.quantity, np.nan)))
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


def _on_an_edge(model: Model, worth: Candidates, own: float) -> list[str]:
    """A sentence on an optimum that is lost if a number of the machine is a little off: from rest it then reaches another motion."""
    moved: dict[str, tuple[str, ...]] = {name: (name,) for name in _not_of_waveforms(model, worth)}
    try:
        near = moved_by(model, moves_of(moved, sizes_of(model, moved), [-_OFF, _OFF]))
        neighbours = np.asarray(results_of(near, 2 * len(moved), rtol=1e-9)[worth.quantity], float).reshape(-1, 2)
    except (StickslipError, KeyError, ValueError):  # a number at the end of its range, or a quantity of the drive alone
        return []
    losses = worth.sign * (neighbours - own)
    worst = np.unravel_index(np.nanargmax(losses), losses.shape) if np.isfinite(losses).any() else (0, 0)
    if not losses[worst] > _LOST * abs(own):
        return []
    name = list(moved)[worst[0]]
    change = f"with {name} off by {_OFF:.2%} {worth.quantity} is {neighbours[worst]:.6g} instead of {own:.6g}"
    return [f'the optimum is at an edge: {change}; type robust={{"{name}": ({dict(leaves(model))[name]:.6g}, "1%")}} for one that is not']


def _not_kept(limits: list[Limit], given: dict[str, Any]) -> list[str]:
    """Sentences on limits beyond which the search began."""
    beyond = [limit for limit in limits if limit.name in given and np.min(limit.margins(given[limit.name])) < -KEPT]
    return [f"the given machine violates the limit of {limit.in_words()}" for limit in beyond]


def values_of(model: Model, rtol: float = 1e-9) -> dict[str, Any]:
    """Numbers of the motion from rest, and the peaks of the drives."""
    columns = results_of(spread_over(model, 1), 1, rtol=rtol)
    numbers = {name: values[0].item() for name, values in columns.items() if not name.startswith("end.")}
    drives = list(drives_within(model))
    return numbers | {name: float(reduce(max, [peaks_of(drive, name) for drive in drives])) for name in (LIMITS if drives else ())}


def _another_way(V: float, way: float | None) -> list[str]:
    """A sentence where the motion that is continued from that of the given machine is another one than that from rest."""
    if way is None or abs(way - V) <= _SAME * abs(V):
        return []
    return [f"continued from the motion of the given machine, V = {way:.6g} m/s; from rest it is {V:.6g}"]


def _active_limits(limits: list[Limit], values: dict[str, Any]) -> list[str]:
    return [limit.name for limit in limits if limit.name in values and np.min(limit.margins(values[limit.name])) <= _ACTIVE]


def _active_bounds(space: Unknowns, u: Array) -> list[str]:
    numbers = [(each, float(u[part.start])) for each, part in zip(space.varied, space.slices, strict=True) if each.form is None]
    return [each.name for each, value in numbers if min(value, 1.0 - value) <= _ACTIVE]


def _not_of_waveforms(model: Model, worth: Candidates) -> list[str]:
    """All numbers but those of waveforms, which do not change one by one."""
    forms = tuple(each.leaves[0] + "." for each in worth.space.varied if each.form is not None)
    return [name for name in directions_of("optimise", model, None) if not name.startswith(forms)]


def _sensitivities(model: Model, worth: Candidates, notes: list[str]) -> Gradient:
    """Derivatives by all numbers but those of waveforms."""
    try:
        return gradient(model, worth.quantity, _not_of_waveforms(model, worth))
    except StickslipError as error:
        notes.append(f"no derivatives: {error}")
        return Gradient({}, worth.quantity, float("nan"), (str(error),))
