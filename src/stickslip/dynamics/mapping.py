"""The strobe map: where a state at t = 0 is after some drive periods, for many starts and many robots in one batch.

The position of a robot appears nowhere in its equations. It is no coordinate of the map, and its multiplier, which is 1, is
left out; a mechanism with a spring has x as its first coordinate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.errors import InputError
from stickslip.fields import leaves, replace_leaf
from stickslip.forces import inner_start, rest_velocity
from stickslip.friction.adapter import law_of
from stickslip.machine import is_machine, machine_of
from stickslip.mechanics import normal_load
from stickslip.position import knows_position
from stickslip.sealing import sealed

__all__ = ["Coordinates", "Ends", "at_rest", "coordinates", "difference_jacobian", "flight", "flow_map", "strobe_map", "strobe_orbit"]

Array = Any


@sealed
@dataclass(frozen=True, eq=False)
class Coordinates:
    """The coordinates of a strobe state: their names, and the size against which each is measured."""

    names: tuple[str, ...]
    scales: Array
    memories: int = 0  # the last so many coordinates are whole numbers that the law remembers

    @property
    def smooth(self) -> int:
        """How many coordinates are no memories."""
        return len(self.names) - self.memories

    def start(self, state: Any) -> dict[str, Any]:
        """A state, or a table of them, as `solve` takes a start."""
        state = np.asarray(state, float)
        first = self.names.index("v") + 1
        found: dict[str, Any] = {name: state[..., i] for i, name in enumerate(self.names[:first])}
        for name, part in (("z", state[..., first : self.smooth]), ("memory", state[..., self.smooth :])):
            if part.shape[-1]:
                found[name] = part[..., 0] if part.shape[-1] == 1 else part
        return {name: value[()] for name, value in found.items()}

    def distance(self, a: Any, b: Any) -> Any:
        """The largest difference of two states in their scales."""
        return np.max(abs(np.asarray(a, float) - np.asarray(b, float)) / self.scales, axis=-1)


@sealed
@dataclass(frozen=True, eq=False)
class Ends:
    """What the strobe map gives for each start: the state, the way made, and extremes of v in the last motion period."""

    state: Array  # (cases, coordinates)
    displacement: Array  # [m]
    status: Array
    v_max: Array
    v_min: Array


def coordinates(model: Any) -> Coordinates:
    """The coordinates of a model's strobe state.

    Examples
    --------
    >>> import stickslip as ss
    >>> coordinates(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)).names
    ('v', 'z')
    """
    law = law_of(model)
    count, memories = law.states, law.modes
    inner = (*_numbered("z", count), *_numbered("memory", memories))
    speed = _largest(machine_of(model).free_velocity) or _largest(model.velocity_scale) or 1.0
    shift = ("x",) if knows_position(model) else ()
    time = _largest(machine_of(model).time_scale)
    scales = [speed * time / (2 * np.pi)] * len(shift) + [speed]
    if count:
        typical = law.scale(normal_load(model, 0.0, 0.0))
        scales += [_largest(s) for s in ((speed * time,) * count if typical is None else typical)]
    return Coordinates((*shift, "v", *inner), np.array(scales + [1.0] * memories), memories)


def at_rest(model: Any) -> Array:
    """The strobe state in which a run from rest begins: array (cases, coordinates); all zeros but for what the law itself says.

    Examples
    --------
    >>> import stickslip as ss
    >>> at_rest(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[5e-4, 6e-4])).tolist()
    [[0.0, 0.0], [0.0, 0.0]]
    """
    at, z = coordinates(model), inner_start(model)
    found = np.zeros((len(z), len(at.names)))
    found[:, at.smooth - z.shape[1] : at.smooth] = z
    return found


def _numbered(name: str, count: int) -> tuple[str, ...]:
    return (name,) if count == 1 else tuple(f"{name}{i}" for i in range(count))


def _largest(value: Any) -> float:
    return float(np.max(np.abs(np.asarray(value, float))))


def spread_over(model: Any, cases: int) -> Any:
    """A single case as a batch of `cases` equal ones; a batch stays what it is."""
    numbers = dict(leaves(model))
    if any(np.ndim(value) for value in numbers.values()):
        return model
    name = next(iter(numbers))
    return replace_leaf(model, {name: np.full(cases, float(numbers[name]))})


def strobe_map(model: Any, states: Any, periods: int = 1, rtol: float = 1e-12) -> Ends:
    """The states after some drive periods.

    Parameters
    ----------
    model : Robot
        One robot, or a batch of as many as there are states.
    states : array (cases, coordinates)
        States at t = 0 in the order of `coordinates`.
    periods : int
        How many drive periods.
    rtol : float
        Tolerance for dynamic laws.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb")
    >>> strobe_map(robot, [[0.0], [1e-3]], periods=3).displacement.round(9).tolist()
    [0.000185664, 0.000186046]
    """
    states = np.atleast_2d(np.asarray(states, float))
    if law_of(model).random:
        raise InputError(
            type(model.friction).__name__,
            ["its bonds form again at random places, so no two drive periods are alike and there is no strobe map that orbits, "
             "exponents or basins could belong to; allowed are laws without chance, such as ss.GMS or ss.LuGre; for this one type "
             "ss.strobe(ss.solve(robot, periods=400)) and compare several seeds"],
        )  # fmt: skip
    if not law_of(model).compiles:
        return _one_by_one(model, states, periods, rtol)
    from stickslip.solvers.arcs import handles

    if not law_of(model).dynamic and handles(model) is None:
        return _by_arcs(model, states, periods)
    return _in_lanes(model, states, periods, rtol)


def _in_lanes(model: Any, states: Array, periods: int, rtol: float, span: Any = None) -> Ends:
    """The engine's lanes: their table has x, then v at the contact, inner states, x again where the equations know it, memories.

    `span` [s] is how long a period is, for models that have none.
    """
    from stickslip.batch import rows_of
    from stickslip.engine import lanes, tableaux, trace
    from stickslip.solvers.exact import REPEAT
    from stickslip.solvers.repeating import check_period
    from stickslip.solvers.rosenbrock import LOOSE, SAFETY
    from stickslip.solvers.stepping import BUDGET

    cyclic, dynamic = not knows_position(model), law_of(model).dynamic
    tableau = None if not dynamic else tableaux.RODAS4 if rtol >= LOOSE else tableaux.RODAS5P
    check_period(model)
    kernel = lanes.kernel_of(model, tableau, record=False)
    rows = rows_of(model, tuple(name for name in kernel.names if name != trace.SPAN))
    rows = np.array(np.broadcast_to(rows, (len(states), rows.shape[1])), order="C")
    rows = rows if span is None else np.column_stack([rows, np.broadcast_to(span, len(states))])
    offset = np.broadcast_to(np.asarray(rest_velocity(model), float), len(states))[:, None]
    whole = np.hstack([np.zeros((len(states), 1)), states]) if cyclic else states
    x, v, z, memory = np.split(whole, [1, 2, 2 + law_of(model).states], axis=1)
    table = np.hstack([x, v - offset, z, *(() if cyclic else (x,)), np.round(memory)])
    job = lanes.Job(periods, 0, False, SAFETY * rtol if dynamic else REPEAT / 10, 0.75, BUDGET * periods)
    found = lanes.run(kernel, rows, table, job)
    y = np.where(found.status[:, None] <= 1, found.end[:, 1:], np.nan)
    end = np.hstack([y[:, :1] + offset, y[:, 1:]] if cyclic else [y[:, -1:], y[:, :1] + offset, y[:, 1:-1]])
    end = np.hstack([end, found.memory])
    carried = offset[:, 0] * periods * model.period if cyclic and not dynamic and np.any(offset) else 0.0
    return Ends(end, found.end[:, 0] - table[:, 0] + carried, found.status, found.v_max + offset[:, 0], found.v_min + offset[:, 0])


def flow_map(model: Any, states: Any, duration: Any, rtol: float = 1e-12) -> Ends:
    """The states of a model without a period after some time, one duration for all or one for each.

    Examples
    --------
    >>> import stickslip as ss
    >>> belt = ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5))
    >>> flow_map(belt, [[0.0, 0.1], [0.0, 0.1]], [1.0, 2.0]).state.round(12).tolist()  # it rides along
    [[0.1, 0.1], [0.2, 0.1]]
    """
    if not law_of(model).compiles:
        raise InputError(
            type(model.friction).__name__, ["it cannot be compiled, and cycles are looked for by the compiled solvers; take another law"]
        )
    return _in_lanes(model, np.atleast_2d(np.asarray(states, float)), 1, rtol, np.asarray(duration, float))


def _by_arcs(model: Any, states: Array, periods: int) -> Ends:
    from stickslip.solvers.exact import solve_batch

    raw = solve_batch(spread_over(model, len(states)), periods, 0, {"x": 0.0, "v": states[:, 0]})
    return Ends(raw["v_end"][:, None], raw["x_end"], raw["status"], raw["v_max"], raw["v_min"])


def _one_by_one(model: Any, states: Array, periods: int, rtol: float) -> Ends:
    """Any other method: a run for each case."""
    cases = _cases(model, len(states))
    runs = [flight(case, state, periods, rtol) for case, state in zip(cases, states, strict=True)]
    ends = np.array([strobe_states(run)[-1] for run in runs])
    way = np.array([run.strobe_x[-1] - run.strobe_x[0] for run in runs])
    top, low = (np.array([extreme(run.v) for run in runs]) for extreme in (np.max, np.min))
    return Ends(ends, way, np.zeros(len(runs), int), top, low)


def _cases(model: Any, count: int) -> list[Any]:
    """Every case of a batch as a model of its own."""
    from stickslip.batch import rows_of

    names = tuple(name for name, _ in leaves(model))
    rows = rows_of(model, names)
    rows = np.broadcast_to(rows, (count, len(names)))
    return [replace_leaf(model, dict(zip(names, map(float, row), strict=True))) for row in rows]


def flight(model: Any, state: Any, periods: int = 1, rtol: float = 1e-12) -> Any:
    """The trajectory from a strobe state, with its dense output and its events."""
    from stickslip.solvers import solve

    options = {"rtol": rtol} if law_of(model).dynamic else {}
    return solve(model, periods=periods, settle=0, start=coordinates(model).start(state), keep="trajectory", **options)


def strobe_states(run: Any) -> Array:
    """The strobe states of a run, one row for each drive period and one for its end."""
    columns = [run.strobe_x] if knows_position(run.model) else []
    columns += [run.strobe_v] + ([] if run.strobe_z is None else [run.strobe_z])
    return np.column_stack(columns + ([] if run.strobe_memory is None else [run.strobe_memory]))


def strobe_orbit(model: Any, states: Any, count: int, rtol: float = 1e-9) -> tuple[Array, Array]:
    """The states and the displacement of `count` periods in a row: arrays (count, cases, coordinates) and (count, cases)."""
    state, kept, ways = np.atleast_2d(np.asarray(states, float)), [], []
    for _ in range(count):
        end = strobe_map(model, state, 1, rtol)
        state = end.state
        kept.append(state)
        ways.append(end.displacement)
    return np.array(kept), np.array(ways)


def difference_jacobian(model: Any, state: Any, periods: int = 1, rtol: float = 1e-12, step: float = 1e-6) -> Array:
    """The derivative of the strobe map by central differences of one batch; a law's memories are kept as they are.

    Parameters
    ----------
    step : float
        Half the distance of the two points, in the scales of `coordinates`.
    """
    at = coordinates(model)
    d, scales = at.smooth, at.scales[: at.smooth]
    shifts = np.vstack([np.eye(d, len(at.names)), -np.eye(d, len(at.names))]) * (step * at.scales)
    ends = strobe_map(model, np.asarray(state, float) + shifts, periods, rtol).state[:, :d]
    return ((ends[:d] - ends[d:]) / (2 * step * scales[:, None])).T


def needs_model(what: str, model: Any, driven: bool = True, batch: bool = False) -> None:
    """Say what to type where something else than one robot (or, with `batch`, than one or many) was given."""
    if not is_machine(model):
        raise InputError(
            what, [f"{model!r} is no model; allowed is a Robot; type ss.{what}(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4))"]
        )
    if not batch and any(np.ndim(value) for _, value in leaves(model)):
        raise InputError(
            what, ["the robot is a batch (some of its numbers are arrays); allowed is one robot; type each number as a single value"]
        )
    if driven and model.period is None:
        why = f"{type(model).__name__} has no period, so it has no strobe; allowed are models with a periodic drive"
        raise InputError(what, [f"{why}; for its limit cycle type ss.periodic_orbit(mechanism), to follow it ss.continuation"])
