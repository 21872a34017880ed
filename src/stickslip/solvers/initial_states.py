"""Where a machine of several bodies begins: positions, velocities, inner states and memories by the names of its parts."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.batch import Labels, flat, spread_over_cases
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import Problems, did_you_mean
from stickslip.basics.fields import number
from stickslip.basics.variables import unit_of
from stickslip.models.machine_adapter import machine_of

if TYPE_CHECKING:
    from stickslip.models.mechanics import Mechanics


_SAME = 1e-9  # of the largest position or velocity: how well bodies at a prescribed distance must keep it
_EXAMPLE = {name: f"{name}={{name: {value}}}" for name, value in (("x", 0.0), ("v", 0.1), ("z", 0.0), ("memory", 0), ("control", 0.0))}


def start_of_parts(model: Model, labels: Labels, start: Any, problems: Problems) -> Array:
    """A table (cases, 2 coordinates + inner states + memories): coordinates, their velocities, and what laws and controllers hold."""
    batch = flat(model)
    mechanics, cases = machine_of(batch).mechanics, labels.cases
    laws = mechanics.laws
    given = dict(start) if isinstance(start, dict) else {}
    if start is not None and not isinstance(start, dict):
        problems.add(f"start = {start!r}; allowed is a dict; type for example start=dict(v={{{mechanics.bodies[0]!r}: 0.01}})")
    bodies, contacts = {name: 1 for name in mechanics.bodies}, mechanics.contacts
    inner = {name: law.states for name, law in zip(contacts, laws, strict=True)}
    memories = {name: law.modes for name, law in zip(contacts, laws, strict=True)}
    for name in given:
        if name not in _EXAMPLE:
            problems.add(f"start has no {name!r}; {did_you_mean(str(name), _EXAMPLE)}")
    still = (0.0,) * mechanics.coordinates
    first = {"x": mechanics.positions(0.0, mechanics.start), "v": mechanics.velocities(0.0, still)}
    x, v = (
        _filled(what, given.get(what), bodies, _columns(first[what], cases), labels, problems, unit_of(what, model)) for what in ("x", "v")
    )
    q, u = (_columns(mechanics.coordinates_of(tuple(of.T)), cases) for of in (x, v))
    _check_distances(mechanics, x, q, v, u, problems)
    _check_stops(mechanics, q, problems)
    loads = mechanics.loads(0.0, tuple(q.T))
    _check_loads(mechanics, loads, problems)
    begun = [state for law, load in zip(laws, loads, strict=True) for state in law.start(load)]
    z = _filled("z", given.get("z"), inner, _columns(begun, cases), labels, problems)
    memory = _filled("memory", given.get("memory"), memories, np.zeros((cases, sum(memories.values()))), labels, problems)
    if np.any(memory != np.round(memory)):
        problems.add(f"start memory = {given['memory']!r}; allowed are whole numbers")
    controllers = mechanics.controllers
    owned = dict(zip(controllers.names, controllers.counts, strict=True))
    switched_on = mechanics.control_start(0.0, tuple(q.T), tuple(u.T))
    held = _filled("control", given.get("control"), owned, _columns(switched_on, cases), labels, problems)
    return np.hstack([q, u, z, held, memory])


def _columns(rows: Any, cases: int) -> Array:
    """Numbers or arrays of cases, one for each column, as a table (cases, columns)."""
    return np.array([np.broadcast_to(np.asarray(row, float), (cases,)) for row in rows]).reshape(len(rows), cases).T.copy()


def _filled(
    what: str, value: Any, parts: dict[str, int], table: Array, labels: Labels, problems: Problems, unit: str | None = None
) -> Array:
    """The table with what was given: by name, or one number for each column along the last axis."""
    if value is None:
        return table
    if isinstance(value, dict):
        for name, own in value.items():
            if name not in parts:
                problems.add(f"start[{what!r}] has no {name!r}; {did_you_mean(str(name), parts)}")
                continue
            first = sum(itertools.islice(parts.values(), list(parts).index(name)))
            _put(f"{what}[{name!r}]", own, table[:, first : first + parts[name]], labels, problems, unit)
        return table
    _put(what, value, table, labels, problems, unit)
    return table


def _put(what: str, value: Any, into: Array, labels: Labels, problems: Problems, unit: str | None) -> None:
    """Numbers into some columns; a single column takes what broadcasts with the batch."""
    count = into.shape[1]
    try:
        given = number(value, unit)
        array = np.asarray(given, float)
        if count == 1 and array.ndim <= len(labels.shape):
            into[:, 0] = spread_over_cases(given, labels)
        else:
            into[:] = np.broadcast_to(array, (*labels.shape, count)).reshape(-1, count)
        if not np.all(np.isfinite(into)):
            problems.add(f"start {what} = {value!r} is not finite; allowed are finite numbers")
    except (TypeError, ValueError) as error:
        problems.add(f"start {what} = {value!r}; allowed are {count} numbers along the last axis, or a dict by name ({error})")


def _check_distances(mechanics: Mechanics, x: Array, q: Array, v: Array, u: Array, problems: Problems) -> None:
    """Note bodies at a prescribed distance whose start does not have it."""
    for what, given, kept in (("x", x, mechanics.positions(0.0, tuple(q.T))), ("v", v, mechanics.velocities(0.0, tuple(u.T)))):
        missed = abs(_columns(kept, len(given)) - given)
        if np.any(missed > _SAME * np.max(abs(given), initial=1e-300)):
            name = mechanics.bodies[int(np.argmax(missed.max(axis=0)))]
            why = f"is not at its prescribed distance, by {missed.max():.3g}"
            problems.add(f"start {what} of {name!r} {why}; give {what} for all bodies that it joins")


def _check_loads(mechanics: Mechanics, loads: Any, problems: Problems) -> None:
    """Note contacts that nothing presses together at the start of any case and that do not fly; of some cases the status says it."""
    for name, law, load in zip(mechanics.contacts, mechanics.laws, loads, strict=True):
        if not law.flies and np.all(np.asarray(load, float) <= 0.0):
            mistake = f"the load of the contact {name!r} is {float(np.max(load)):.4g} N at the start, so there is no contact"
            problems.add(f"{mistake}; allowed is more than zero; give another load=, or restitution=0.0 for a body that flies and lands")


def _check_stops(mechanics: Mechanics, q: Array, problems: Problems) -> None:
    """Note stops with restitution beyond which all cases begin; of some cases the status says it."""
    size = np.max(abs(q), initial=0.0)
    for stop in mechanics.stops:
        gap = np.asarray(stop.gap(0.0, tuple(q.T)), float)
        if np.all(gap < -_SAME * max(size, 1e-300)):
            mistake, first = f"the run begins beyond the stop {stop.name}, by {-float(np.max(gap)):.3g} m", stop.ends[0]
            x = _columns(mechanics.positions(0.0, tuple(q.T)), len(q))[0, mechanics.bodies.index(first)]
            touching = float(x + stop.part.side * np.broadcast_to(gap, len(q))[0])
            hint = f'type start={{"x": {{"{first}": {touching:.6g}}}}}, where they touch, or a larger gap'
            problems.add(f"{mistake}; allowed is a gap that is open or closed; {hint}")
