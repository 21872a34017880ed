"""Where a machine begins: positions, velocities, inner states and memories, by the names of its parts where they have names."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.batch import Labels, flat, of_cases, spread_over_cases
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, Problems, did_you_mean
from stickslip.basics.fields import number, replace_leaf
from stickslip.basics.variables import unit_of
from stickslip.models.kept_heights import above, least_height
from stickslip.models.machine_adapter import MachineAdapter, machine_of

if TYPE_CHECKING:
    from stickslip.models.mechanics import Mechanics


_SAME = 1e-9  # of the largest position or velocity: how well bodies at a prescribed distance must keep it
_FLAT = 1e-12  # of the product of a matrix's diagonal: a determinant that is zero
_LOOKED = 1000  # starts of a batch whose matrices are looked at


LARGEST_START = 1e9
#: A position is told from its neighbours by this part of the distance that the drive moves the body in a period, or nearer.
RESOLVED = 1e-8


def flattened(model: Model, labels: Labels, numbers: dict[str, Any] | None = None) -> MachineAdapter:
    """The adapter of a machine whose numbers are columns of its cases, where these are at hand; of a single case its own."""
    if not labels.shape:
        return machine_of(model)
    return machine_of(flat(model) if numbers is None else replace_leaf(model, of_cases(numbers, labels)))


def start_states(model: Model, labels: Labels, start: Any, problems: Problems, machine: MachineAdapter | None = None) -> Any:
    """Where the cases of a machine begin, from a start as `solve` takes it; all that is wrong with it is added to the problems.

    A table (cases, 2 coordinates + inner states + memories): coordinates, their velocities, and what laws and controllers hold. Who has
    its adapter (`flattened`) gives that too.
    """
    of, counted = machine or flattened(model, labels), len(problems.mistakes)
    m, cases = of.mechanics, labels.cases
    n, (inner, held, memories) = m.coordinates, _held_by(m)
    table = np.zeros((cases, 2 * n + inner + held + memories))
    q, u = table[:, :n], table[:, n : 2 * n]
    parts = {} if start is None else _parts_of(m)
    given = {} if start is None else _given(m, parts, start, problems)
    fill = _Filling(parts, given, labels, problems)
    _move(m, model, fill, q, u)
    places, rates = _numbers(q), _numbers(u)
    _check_heights(m, places, rates, problems)
    loads = [_looked_at(m, i, places, rates) for i in range(len(m.contacts))] if m.joined else m.loads(0.0, places, rates)
    _check_loads(m, loads, problems)
    if inner:
        z = table[:, 2 * n : 2 * n + inner]
        loads = m.loads(0.0, places, rates) if m.joined else loads
        _begin(m, places, rates, loads, z)
        fill.into("z", z)
    if held:
        control = table[:, 2 * n + inner : 2 * n + inner + held]
        _put_columns(m.control_start(0.0, places, rates), control)
        fill.into("control", control)
    if memories:
        memory = table[:, 2 * n + inner + held :]
        fill.into("memory", memory)
        if np.any(memory != np.round(memory)):
            problems.add(f"start memory = {given['memory']!r}; allowed are whole numbers; type memory={(0,) * memories}")
    if given and len(problems.mistakes) == counted:
        _check_sizes(of, q, table, problems)
    return table


def _held_by(m: Mechanics) -> tuple[int, int, int]:
    """How many numbers beside positions and velocities belong to a state: of laws inner ones, of controllers, memories of laws."""
    return sum([law.states for law in m.laws]), sum(m.controllers.counts), sum([law.modes for law in m.laws])


def _parts_of(m: Mechanics) -> dict[str, dict[str, int]]:
    """By what a start may give the parts that have it, with the number of their columns; empty where the machine has no such thing."""
    bodies, laws = dict.fromkeys(m.bodies, 1), m.laws
    inner = {name: law.states for name, law in zip(m.contacts, laws, strict=True)}
    memories = {name: law.modes for name, law in zip(m.contacts, laws, strict=True)}
    control = dict(zip(m.controllers.names, m.controllers.counts, strict=True))
    return {"x": bodies, "v": bodies, "z": inner, "memory": memories, "control": control}


def _given(m: Mechanics, parts: dict[str, dict[str, int]], start: Any, problems: Problems) -> dict[str, Any]:
    """What a start gives by the names of states; else a sentence."""
    if not isinstance(start, dict):
        example = f"{{{m.bodies[0]!r}: 0.01}}" if len(m.bodies) > 1 else "0.01"
        problems.add(f"start = {start!r}; allowed is a dict; type for example start=dict(v={example})")
        return {}
    there = {what for what, counts in parts.items() if any(counts.values())}
    known = [what for what in parts if what in there or what == "z"]
    for name, value in start.items():
        if name not in known:
            problems.add(f"start has no {name!r}; {did_you_mean(str(name), known)}")
        elif name not in there and _is_something(value):
            laws = " and ".join(dict.fromkeys(law.name for law in m.laws))
            problems.add(f"start has z = {value!r}, but {laws or 'the machine'} has no inner state; leave z out")
    return {name: value for name, value in start.items() if name in there}


def _is_something(value: Any) -> bool:
    """Whether a value for states that do not exist is anything but zeros."""
    try:
        return bool(np.any(np.asarray([*value.values()] if isinstance(value, dict) else value, float) != 0.0))
    except (TypeError, ValueError):
        return True


def _move(m: Mechanics, model: Model, fill: _Filling, q: Array, u: Array) -> None:
    """Coordinates and their velocities, from positions and velocities of bodies where these are given."""
    if "x" in fill.given or "v" in fill.given:
        x = _columns(m.positions(0.0, m.start), len(q))
        v = _columns(m.velocities(0.0, (0.0,) * m.coordinates), len(q))
        fill.into("x", x, unit_of("x", model))
        fill.into("v", v, unit_of("v", model))
        _put_columns(m.coordinates_of(tuple(x.T)), q)
        _put_columns(m.coordinates_of(tuple(v.T)), u)
        _check_distances(m, x, q, v, u, fill.problems)
    else:
        _put_columns(m.start, q)
    if m.stops:
        _check_stops(m, q, fill.problems)
    if m.joined:
        _check_inertia(m, q, fill.problems)


def _begin(m: Mechanics, q: Any, u: Any, loads: Any, into: Array) -> None:
    """Inner states of contacts that nobody has moved, as their laws say."""
    if not m.flying and not any(law.has_start for law in m.laws):
        return  # zeros
    begun: list[Any] = []
    for law, load in zip(m.laws, loads, strict=True):
        try:
            own = _columns(law.start(load), len(into))
        except (TypeError, ValueError, ArithmeticError) as error:
            hint = "it gives as many numbers as the law has inner states; take functions from stickslip.maths"
            raise InputError(law.name, [f"start(load) cannot be computed ({error}); {hint}"]) from error
        if not np.all(np.isfinite(own)):
            raise InputError(law.name, [f"start(load) gives {law.start(load)!r}; allowed are finite numbers"])
        begun.extend(own.T)
    _put_columns(m.completed(q, u, begun), into)


def _numbers(table: Array) -> tuple[Any, ...]:
    """The columns of a table: floats of a single case, else arrays of all cases."""
    return tuple(table[0].tolist() if len(table) == 1 else table.T)


def _put_columns(columns: Any, into: Array) -> None:
    """Numbers or arrays of cases, one for each column, into a table (cases, columns)."""
    for number_of_column, column in enumerate(columns):
        into[:, number_of_column] = column


def _columns(columns: Any, cases: int) -> Array:
    """The same as a table of its own."""
    table = np.empty((cases, len(columns)))
    _put_columns(columns, table)
    return table


@dataclass(frozen=True)
class _Filling:
    """What a start gives, by the parts that have it."""

    parts: dict[str, dict[str, int]]
    given: dict[str, Any]
    labels: Labels
    problems: Problems

    def into(self, what: str, table: Array, unit: str | None = None) -> None:
        """What was given into a table: by name, or one number for each column along the last axis."""
        value = self.given.get(what)
        if value is None:
            return
        parts = self.parts[what]
        if not isinstance(value, dict):
            self._put(f"[{what!r}]", value, table, unit)
            return
        for name, own in value.items():
            if name not in parts:
                self.problems.add(f"start[{what!r}] has no {name!r}; {did_you_mean(str(name), parts)}")
                continue
            first = sum(itertools.islice(parts.values(), list(parts).index(name)))
            self._put(f"[{what!r}][{name!r}]", own, table[:, first : first + parts[name]], unit)

    def _put(self, where: str, value: Any, into: Array, unit: str | None) -> None:
        """Numbers into some columns; a single column takes what broadcasts with the batch."""
        count, shape = into.shape[1], self.labels.shape
        try:
            given = number(value, unit)
            array = np.asarray(given, float)
            if count == 1 and array.ndim <= len(shape):
                into[:, 0] = spread_over_cases(given, self.labels)
            else:
                into[:] = np.broadcast_to(array, (*shape, count)).reshape(-1, count)
            if not np.all(np.isfinite(into)):
                self.problems.add(f"start{where} = {value!r} is not finite; allowed are finite numbers")
        except (TypeError, ValueError) as error:
            allowed = "a finite number" if count == 1 else f"{count} finite numbers along the last axis, or a dict by name"
            broadcast = f" or an array that broadcasts to {(*shape, *([count] if count > 1 else []))}" if shape else ""
            self.problems.add(f"start{where} = {value!r}; allowed is {allowed}{broadcast} ({error})")


def _check_sizes(of: MachineAdapter, q: Array, states: Array, problems: Problems) -> None:
    """Note starts that are out of this world, and positions beside which the motion would be lost in rounding."""
    worst = float(np.max(np.abs(states), initial=0.0))
    if worst > LARGEST_START:
        problems.add(f"start has a number of {worst:.6g}; allowed are sizes up to {LARGEST_START:.0e}, in SI units")
        return
    if not np.any(q):
        return
    time = of.time_scale
    moved = np.broadcast_to(np.asarray(of.velocity_scale * (1.0 if time is None else time), float), len(q))[:, None]
    lost = (moved > 0) & (np.spacing(np.abs(q)) > RESOLVED * moved)
    if np.any(lost):
        case, column = np.unravel_index(int(np.argmax(lost)), lost.shape)
        x, way = float(q[case, column]), float(moved[case, 0])
        most = RESOLVED * way / np.finfo(float).eps
        problems.add(
            f"start x = {x:.6g} m, where neighbouring numbers are {np.spacing(abs(x)):.2g} m apart: too far for a motion of {way:.2g} m "
            f"in a period; allowed are sizes up to {most:.2g} m; measure x from nearby"
        )


def _check_distances(mechanics: Mechanics, x: Array, q: Array, v: Array, u: Array, problems: Problems) -> None:
    """Note bodies at a prescribed distance whose start does not have it."""
    for what, given, kept in (("x", x, mechanics.positions(0.0, tuple(q.T))), ("v", v, mechanics.velocities(0.0, tuple(u.T)))):
        missed = abs(_columns(kept, len(given)) - given)
        if np.any(missed > _SAME * np.max(abs(given), initial=1e-300)):
            name = mechanics.bodies[int(np.argmax(missed.max(axis=0)))]
            why = f"is not at its prescribed distance, by {missed.max():.3g}"
            problems.add(f"start {what} of {name!r} {why}; give {what} for all bodies that it joins")


def _looked_at(m: Any, i: int, places: Any, rates: Any) -> Any:
    """A load that is given; of one that follows from the motion, where friction makes it negative and the rest does not, 1.

    What presses without friction is a contact: whether a load follows is for a run to say. A rail is one always, and what may fly is
    asked for its height.
    """
    touching = m.touching[i]
    if touching.is_held and (m.laws[i].flies or not touching.pushes):
        return 1.0
    load = m.load(i, 0.0, places, rates)
    return np.where(m.free_reaction(i, 0.0, places, rates) >= 0.0, np.maximum(load, 1.0), load) if touching.is_held else load


def _check_loads(mechanics: Mechanics, loads: Any, problems: Problems) -> None:
    """Note contacts that nothing presses together at the start of any case and that do not fly; of some cases the status says it."""
    for i, (name, law, load) in enumerate(zip(mechanics.contacts, mechanics.laws, loads, strict=True)):
        if isinstance(load, float) and load > 0.0:
            continue
        none = np.asarray(load, float) <= 0.0 if not mechanics.of_motion or not mechanics.of_motion[i] else np.asarray(load, float) < 0.0
        if not law.flies and np.all(none):
            where = f" of the contact {name!r}" if mechanics.joints else ""
            mistake = f"the load{where} is {float(np.max(load)):.4g} N at the start, so there is no contact"
            problems.add(f"{mistake}; allowed is more than zero; give another load=, or restitution=0.0 for a body that flies and lands")


def _check_inertia(mechanics: Any, q: Array, problems: Problems) -> None:
    """Note a matrix of inertia without an inverse where a run begins, as at places that do not change with a coordinate there."""
    some = q[:_LOOKED]
    M = np.stack([_columns(row, len(some)) for row in mechanics.matrix(0.0, _numbers(some))], axis=1)
    size = np.prod(np.diagonal(M, axis1=1, axis2=2), axis=1)
    with np.errstate(invalid="ignore"):
        flat = ~(np.linalg.det(M) > _FLAT * size)
    if np.any(flat):
        k = int(np.argmax(flat))
        at = ", ".join(f"{name} = {value:.4g}" for name, value in zip(mechanics.bodies, some[k], strict=True))
        problems.add(
            f"the matrix of inertia has no inverse at the start, where {at}: nothing with mass moves with one of the coordinates there; "
            "allowed are places at which it has one; type start={'x': {...}} away from there, or other coordinates"
        )


def _check_heights(mechanics: Mechanics, q: Any, u: Any, problems: Problems) -> None:
    """Note points that a contact keeps on the ground and that do not begin there, or leave it; those that fly begin nowhere below it."""
    heights = mechanics.heights(0.0, q, u)
    if not heights:
        return
    low, slow = least_height(mechanics)
    flies = {name for name, law in zip(mechanics.contacts, mechanics.laws, strict=True) if law.flies}
    for name, (height, rate) in heights.items():
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
