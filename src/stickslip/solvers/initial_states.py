"""Where a machine begins: positions, velocities, inner states and memories, by the names of its parts where they have names."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.batch import Labels, flat, spread_over_cases
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import Problems, did_you_mean
from stickslip.basics.fields import number
from stickslip.basics.variables import unit_of
from stickslip.models.forces import inner_start
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.kept_heights import above, least_height
from stickslip.models.machine_adapter import machine_of

if TYPE_CHECKING:
    from stickslip.models.mechanics import Mechanics


_SAME = 1e-9  # of the largest position or velocity: how well bodies at a prescribed distance must keep it
_EXAMPLE = {name: f"{name}={{name: {value}}}" for name, value in (("x", 0.0), ("v", 0.1), ("z", 0.0), ("memory", 0), ("control", 0.0))}


LARGEST_START = 1e9
#: A position is told from its neighbours by this part of the distance that the drive moves the body in a period, or nearer.
RESOLVED = 1e-8


def start_states(model: Model, labels: Labels, start: Any, problems: Problems) -> Any:
    """Where the cases of a machine begin, from a start as `solve` takes it; all that is wrong with it is added to the problems.

    A table (cases, 2 coordinates + inner states + memories): coordinates, their velocities, and what laws and controllers hold.
    """
    if machine_of(model).names_parts:
        return _of_parts(model, labels, start, problems)
    return _of_one_body(model, labels, start, problems)


def _of_one_body(model: Any, labels: Labels, start: Any, problems: Problems) -> Array:
    """The same of one body on one contact, whose states have no names of parts."""
    law, cases = law_of(model), labels.cases
    inner, memories = law.states, law.modes
    table = np.zeros((cases, 2 + inner + memories))
    if start is None:
        if law.has_start:
            table[:, 2 : 2 + inner] = inner_start(model)
        return table
    if not isinstance(start, dict):
        problems.add(f"start = {start!r}; allowed is a dict; type for example start=dict(v=0.01)")
        return table
    columns = {"x": [0], "v": [1], "z": list(range(2, 2 + inner))}
    columns |= {"memory": list(range(2 + inner, 2 + inner + memories))} if memories else {}
    for name, value in start.items():
        if name not in columns:
            problems.add(f"start has no {name!r}; {did_you_mean(str(name), columns)}")
            continue
        several = len(columns[name])
        try:
            value = number(value, unit_of(name, model) if name in ("x", "v") else None)
            values = np.asarray(value, dtype=float)
            if name == "memory" and np.any(values != np.round(values)):
                problems.add(f"start[{name!r}] = {value!r}; allowed are whole numbers; type memory={(0,) * memories}")
            elif several > 1:
                values = values if values.ndim else np.repeat(values, several)
                table[:, columns[name]] = np.broadcast_to(values, (*labels.shape, several)).reshape(cases, several)
            elif columns[name] or np.any(values != 0.0):
                if not columns[name]:
                    problems.add(f"start has z = {value!r}, but {law_of(model).name} has no inner state; leave z out")
                    continue
                table[:, columns[name][0]] = spread_over_cases(value, labels)
        except (TypeError, ValueError) as error:
            allowed = f"a finite number or an array that broadcasts to {(*labels.shape, *([several] if several > 1 else []))}"
            problems.add(f"start[{name!r}] = {value!r}; allowed is {allowed} ({error})")
    if inner and "z" not in start and not problems.mistakes:
        table[:, 2 : 2 + inner] = inner_start(model, table[:, 0] if cases > 1 else float(table[0, 0]))
    if not np.all(np.isfinite(table)):
        problems.add(f"start = {start!r} is not finite; allowed are finite numbers")
    elif not problems.mistakes:
        _check_sizes(model, labels, table, problems)
    return table


def _check_sizes(model: Any, labels: Labels, table: Any, problems: Problems) -> None:
    """Note starts that are out of this world, and positions beside which the motion would be lost in rounding."""
    worst = float(np.max(np.abs(table), initial=0.0))
    if worst > LARGEST_START:
        problems.add(f"start has a number of {worst:.6g}; allowed are sizes up to {LARGEST_START:.0e}, in SI units")
        return
    time = machine_of(model).time_scale
    moved = spread_over_cases(model.velocity_scale * (1.0 if time is None else time), labels)
    lost = (moved > 0) & (np.spacing(np.abs(table[:, 0])) > RESOLVED * moved)
    if np.any(lost):
        case = int(np.argmax(lost))
        most = RESOLVED * moved[case] / np.finfo(float).eps
        x = f"start x = {table[case, 0]:.6g} m, where neighbouring numbers are {np.spacing(abs(table[case, 0])):.2g} m apart"
        problems.add(
            f"{x}: too far for a motion of {moved[case]:.2g} m in a period; allowed are sizes up to {most:.2g} m; measure x from nearby"
        )


def _of_parts(model: Model, labels: Labels, start: Any, problems: Problems) -> Array:
    """The same of a machine that names its parts."""
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
    _check_heights(mechanics, q, u, problems)
    loads = mechanics.loads(0.0, tuple(q.T), tuple(u.T))
    _check_loads(mechanics, loads, problems)
    begun = [state for law, load in zip(laws, loads, strict=True) for state in law.start(load)]
    begun = mechanics.completed(tuple(q.T), tuple(u.T), begun)
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
    for i, (name, law, load) in enumerate(zip(mechanics.contacts, mechanics.laws, loads, strict=True)):
        none = np.asarray(load, float) <= 0.0 if not mechanics.of_motion or not mechanics.of_motion[i] else np.asarray(load, float) < 0.0
        if not law.flies and np.all(none):
            mistake = f"the load of the contact {name!r} is {float(np.max(load)):.4g} N at the start, so there is no contact"
            problems.add(f"{mistake}; allowed is more than zero; give another load=, or restitution=0.0 for a body that flies and lands")


def _check_heights(mechanics: Mechanics, q: Array, u: Array, problems: Problems) -> None:
    """Note points that a contact keeps on the ground and that do not begin there, or leave it; those that fly begin nowhere below it."""
    low, slow = least_height(mechanics)
    flies = {name for name, law in zip(mechanics.contacts, mechanics.laws, strict=True) if law.flies}
    for name, (height, rate) in mechanics.heights(0.0, tuple(q.T), tuple(u.T)).items():
        where = f"the point of the contact {name!r}"
        if name in flies:
            gap, speed = above(mechanics, (height, rate))
            _check_above(where, gap, speed, problems)
            continue
        for value, least, what, unit in ((height, low, "is", "m above"), (rate, slow, "moves at", "m/s away from")):
            if np.max(abs(np.asarray(value, float))) > least:
                worst = float(np.ravel(value)[int(np.argmax(abs(np.ravel(value))))])
                problems.add(
                    f"{where} {what} {worst:.4g} {unit} what it rubs on at the start; allowed is zero; type coordinates and rates of the "
                    "start={'x': {...}, 'v': {...}} with which it is, or restitution=0.0 for a point that flies and lands"
                )


def _check_above(where: str, gap: Any, rate: Any, problems: Problems) -> None:
    """Note a point that may fly and begins below what it rubs on, or in a hit."""
    if np.any(gap < 0.0):
        problems.add(
            f"{where} is {-float(np.min(gap)):.4g} m below what it rubs on at the start; allowed is on it or above; "
            "type coordinates of the start={'x': {...}} with which it is"
        )
    elif np.any((gap == 0.0) & (rate < 0.0)):
        problems.add(
            f"{where} is on what it rubs on at the start and moves into it at {-float(np.min(rate)):.4g} m/s; allowed there is a rate of "
            "zero, or upwards; type start={'x': {...}, 'v': {...}} a moment before it lands, or after"
        )


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
