"""The strobe map: where a state at t = 0 is after some drive periods, for many starts and many robots in one batch.

The position of a robot appears nowhere in its equations. It is not a coordinate of the map, and its multiplier, which is 1, is
left out; a mechanism with a spring has x as its first coordinate. Of several bodies that move along a track only the differences of
their positions are coordinates, and the way made is that of their centre of mass.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.state_order import Order, coordinates_in, numbered_names, order_of, order_of_names, states_of_run
from stickslip.basics.batch import cases_of, labels_of, spread_over_cases
from stickslip.basics.contracts import Array, ArrayLike, Model
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.status import Status
from stickslip.models.cyclic_coordinates import CyclicCoordinates
from stickslip.models.machine_adapter import MachineAdapter, machine_of
from stickslip.models.model_adapter import ModelAdapter, adapter_of
from stickslip.models.turning_coordinates import TURN, turning, wave_of
from stickslip.results.segments import intervals_of
from stickslip.results.steadiness import way_of_machine
from stickslip.solvers.flow_starts import changed_at_once, places_of_starts
from stickslip.solvers.initial_states import start_states
from stickslip.solvers.plain.composed_flows import mode_of_strobe_state

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


_DWELL = 0.03  # of a period: how long elastic contact lasts that counts as rest
_RESTS = 1e-13  # of the velocity scale: a slip that is rounding
_HALVINGS = 30  # of a drive period, in search of the instant at which a run ends
_FINEST = 1e-12  # tolerance of series on the slow manifold: below it two sweeps differ by rounding


@sealed
class Coordinates:
    """The coordinates of a strobe state: their names, and the size against which each is measured.

    Of a machine of several bodies they are velocities of the bodies, inner states by contact, and positions: those of all bodies where
    forces depend on them, else what those of all but the first are more than that of the first.
    """

    names: tuple[str, ...]
    scales: Array
    order: Order
    memories: int = 0  # the last so many coordinates are whole numbers that laws remember
    mechanics: Any = None  # of a machine; None of a flow
    named: bool = False  # whether starts go by the names of bodies and contacts; of one body on one contact they are numbers
    wavelength: float | None = None  # of one body: its position counts modulo this, as the track repeats [m]
    section: Any = None  # of a model without a period: where its motions are looked at (see return_maps.py)
    drifts: CyclicCoordinates = CyclicCoordinates()  # what drifts while the motion repeats: in a flow, and angles modulo a turn

    @property
    def smooth(self) -> int:
        """How many coordinates are not memories."""
        return len(self.names) - self.memories

    @property
    def free(self) -> Array:
        """The coordinates that are no memories, of which motions depend on their values, and vary on the section if there is one."""
        places = np.delete(np.arange(self.smooth), self.drifts.free)
        return places if self.section is None else places[places != self.section.index]

    def of(self, cases: Any) -> Coordinates:
        """The same for some cases of a batch, each of which has its own section where there is one."""
        return self if self.section is None else replace(self, section=self.section.of(cases))

    @property
    def inner_states(self) -> int:
        """How many inner states there are."""
        return self.order.inner.stop - self.order.inner.start

    @property
    def speed(self) -> float:
        """Size of the velocities [m/s]."""
        return float(self.scales[self.order.velocities.start])

    def start(self, state: ArrayLike) -> dict[str, Any]:
        """A state, or a table of them, as `solve` takes a start: positions and velocities by body, inner states and memories by contact."""
        state = np.asarray(state, float)
        columns, m = np.moveaxis(state[..., : self.smooth], -1, 0), self.mechanics
        q, u, z = self.order.split(columns, np.zeros_like(columns[0]))
        z = m.completed(q, u, z)
        start = {
            what: {name: np.asarray(value)[()] for name, value in zip(m.bodies, values, strict=True)}
            for what, values in (("x", m.positions(0.0, q)), ("v", m.velocities(0.0, u)))
        }
        memory = np.moveaxis(state[..., self.smooth :], -1, 0)
        inner = sum(law.states for law in m.laws)
        for what, values, counts, names in (
            ("z", np.array(z[:inner]), [c.states for c in m.laws], m.contacts),
            ("control", np.array(z[inner:]), m.controllers.counts, m.controllers.names),
            ("memory", memory, [c.modes for c in m.laws], m.contacts),
        ):
            own = np.split(values, np.cumsum(counts)[:-1]) if sum(counts) else []
            named = {name: np.moveaxis(each, 0, -1) for name, each in zip(names, own, strict=False) if len(each)}
            start |= {what: {name: each[..., 0][()] if each.shape[-1] == 1 else each for name, each in named.items()}} if named else {}
        if self.named:
            return start
        placed = start if self.order.kept else {what: parts for what, parts in start.items() if what != "x"}
        return {what: value for what, parts in placed.items() for value in parts.values()}

    def begun(self, model: Any, state: Array) -> dict[str, Any]:
        """What `solve` takes to begin a run in a state."""
        return {"start": self.start(state)}

    def at_rest(self, model: Any) -> Array:
        """The states in which runs from rest begin (cases, coordinates)."""
        return states_of_start("start", model, None, self)

    def map_of(self, model: Any, rtol: float) -> Callable[[Array, int], Ends]:
        """The strobe map of a model as a function of states and of periods."""
        if not all(law.compiles for law in machine_of(model).laws):
            return lambda states, periods: _one_by_one(model, states, periods, rtol)
        return partial(_by_arcs, model) if has_arcs(model) else _map_by_lanes(model, rtol, self)

    def after(self, model: Any, states: Array, duration: Array, rtol: float) -> Ends:
        """The states of a model without a period after some time."""
        if not all(law.compiles for law in machine_of(model).laws):
            name, why = type(model.friction).__name__, "it cannot be compiled, and cycles are looked for by the compiled solvers"
            raise InputError(name, [f"{why}; take another law"])
        check_equations(model)
        return _ended(model, *run_lanes(model, states, 1, rtol, duration), 1)

    has_phase = True  # whether a start may be given with the phase of the drive

    @property
    def start_names(self) -> tuple[str, ...]:
        """Names of what may be given of a start."""
        return self.names

    def before_end(self, model: Any, states: Array) -> Array:
        """The last states before a run could not be followed on, where they are known."""
        return np.empty((0, len(self.names)))

    in_lanes = True  # whether runs and small changes of their starts go in lanes of one kernel

    def time_of(self, model: Any) -> Any:
        """A typical time of a model [s], of which a return takes some; None where runs have to show it."""
        time = machine_of(model).time_scale
        if time is None:
            mistake = "it has neither a period nor a time_scale, so the time within which its motions come back is not known"
            raise InputError(type(model).__name__, [f"{mistake}; give the class a time_scale, such as time_scale = 1.0"])
        return time

    def last(self, run: Any) -> Array:
        """The state at the end of a run."""
        return state_at(run, float(run.pieces.t[-1]))

    def states_in(self, run: Any, t: Array) -> Array:
        """The states at some instants of a run, with what laws remember; a spring is measured from its far end."""
        states, far_end = [], float(machine_of(run.model).far_end_velocity)
        for instant in t:
            state = state_at(run, float(instant))
            state[0] -= far_end * instant
            piece = min(int(np.searchsorted(run.pieces.t, instant, side="right")) - 1, len(run.pieces.mode) - 1)
            states.append(np.concatenate([state, np.ravel(np.asarray(run.pieces.memory[piece], float))]))
        return np.array(states)

    def placed(self, model: Any, states: Array) -> Array:
        """States with the place of what follows from them."""
        return states

    def changed_at_once(self, model: Any, states: Array) -> Array:
        """Which states are others at once, as they lie beyond all guards."""
        return np.zeros(len(states), bool)

    @property
    def comes_again(self) -> bool:
        """Whether states that differ may be one: on a track that repeats, and of cyclic coordinates."""
        return self.wavelength is not None or bool(self.drifts)

    def difference(self, a: Any, b: Any) -> Any:
        """One state less another; of positions on a track that repeats, and of cyclic coordinates, modulo their length."""
        difference = np.asarray(a, float) - np.asarray(b, float)
        if self.wavelength is not None:
            difference[..., self.order.places] -= self.wavelength * np.round(difference[..., self.order.places] / self.wavelength)
        return self.drifts.wrapped(difference) if self.drifts else difference

    def wrapped(self, states: Array) -> Array:
        """States with cyclic coordinates brought back: angles to within half a turn of zero."""
        return self.drifts.wrapped(states) if self.drifts else states

    def embedded(self, points: Array) -> tuple[Array, Array]:
        """States and their scales, as numbers that are near one another where the states are: angles as points on a circle."""
        return self.drifts.embedded(points, self.scales) if self.drifts else (points, self.scales)

    def distance(self, a: Any, b: Any) -> Any:
        """The largest difference of two states in their scales."""
        return np.max(abs(self.difference(a, b)) / self.scales, axis=-1)


@sealed
class FlowCoordinates(Coordinates):
    """Those of a flow that switches: its states by their names, and the place of its mode among its modes, which is a memory."""

    def start(self, state: ArrayLike) -> dict[str, Any]:
        """A state, or a table of them, by the names of its numbers."""
        state = np.asarray(state, float)
        return {name: state[..., i][()] for i, name in enumerate((*self.names[: self.smooth], "memory"))}

    def begun(self, model: Any, state: Array) -> dict[str, Any]:
        """What `solve` takes to begin a run in a state."""
        state = np.asarray(state, float)
        return {"start": state[:-1], "mode": mode_of_strobe_state(model, state)}

    def at_rest(self, model: Any) -> Array:
        """All states zero, in the mode in which a run begins there."""
        rest = np.zeros((labels_of(model).cases, len(self.names)))
        rest[:, -1] = [places_of_starts(case, rest[:1, :-1])[0] for case in cases_of(model)]
        return rest

    def map_of(self, model: Any, rtol: float) -> Callable[[Array, int], Ends]:
        """The strobe map, which is exact to rounding."""
        return lambda states, periods: _of_flow(model, states, periods * np.asarray(model.period, float))

    def after(self, model: Any, states: Array, duration: Array, rtol: float) -> Ends:
        """The states after some time."""
        return _of_flow(model, states, duration)

    has_phase = in_lanes = False

    def time_of(self, model: Any) -> None:
        """Its functions do not say it."""

    def last(self, run: Any) -> Array:
        """The state and the mode at the end of a run."""
        return np.asarray(run.strobe_state)

    def states_in(self, run: Any, t: Array) -> Array:
        """The states at some instants of a run, with the places of the modes; at a switch those after it."""
        index = run._index(t)
        return np.column_stack([run.pieces.states(t, index), run.pieces.mode[index]])

    def placed(self, model: Any, states: Array) -> Array:
        """States with the place of the mode in which a run begins there."""
        return np.column_stack([states[:, :-1], places_of_starts(model, states[:, :-1])])

    def changed_at_once(self, model: Any, states: Array) -> Array:
        """Those of which a reset makes others."""
        return changed_at_once(model, states[:, :-1])

    @property
    def start_names(self) -> tuple[str, ...]:
        """Names of its states; the mode follows."""
        return self.names[: self.smooth]

    def before_end(self, model: Any, states: Array) -> Array:
        """The last states within the next period before a flow cannot be solved any more, by halving the time."""
        from stickslip.solvers.flow_engine import ends

        low, high = np.zeros(len(states)), np.ones(len(states))
        T, last = np.asarray(model.period if self.section is None else self.section.longest, float), states.copy()
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            y, _, status = ends(model, states[:, :-1], np.round(states[:, -1]), middle * T)
            fine = (status <= Status.REPEATS) & np.isfinite(y).all(axis=1)
            last[fine, :-1] = y[fine]
            low, high = np.where(fine, middle, low), np.where(fine, high, middle)
        return last


@sealed
class Ends:
    """The strobe map of each start: the state, the distance travelled, and extremes of v in the last motion period.

    Of a machine of several bodies the way is that of their centre of mass, and extremes of one velocity are not known (NaN).
    """

    state: Array  # (cases, coordinates)
    displacement: Array  # [m]
    status: Array
    v_max: Array
    v_min: Array
    segments: tuple[tuple[Array, Array, Array], ...] = ()  # of each contact (see segments.py), in the last drive period
    duration: Any = None  # of returns to a section: how long they took [s]

    @property
    def patterns(self) -> tuple[Array, ...]:
        """Of each contact the signs of its slip in the last drive period in order, such as "+0-0", of every case."""
        return tuple(intervals_of(*each, dwell=_DWELL).pattern for each in self.segments)


def coordinates(model: Model, count: int | None = None) -> Coordinates:
    """The coordinates of a model's strobe state.

    Parameters
    ----------
    count : int, optional
        How many numbers the state has, of a flow whose states have no names.

    Examples
    --------
    >>> import stickslip as ss
    >>> coordinates(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)).names
    ('v', 'z')
    """
    if not adapter_of(model).has_bodies:
        return coordinates_of_flow(model, count)
    machine = machine_of(model)
    order = order_of(model, machine)
    mechanics, laws = machine.mechanics, machine.laws
    speed = largest_size(machine.free_velocity) or largest_size(machine.velocity_scale) or 1.0
    time = largest_size(machine.time_scale)
    places = [speed * time / (2 * np.pi)] * mechanics.coordinates
    sizes: list[float] = []
    if any(law.states for law in laws):
        for law, load in zip(laws, mechanics.loads(0.0, mechanics.start), strict=True):
            typical = law.scale(load) if law.states else ()
            sizes += [largest_size(s) for s in ((speed * time,) * law.states if typical is None else typical)]
    sizes += [largest_size(size) for size in mechanics.controllers.scales]
    scales = order.joined([0.0, *places[1:]] if order.cyclic else places, [speed] * mechanics.coordinates, sizes)
    memories = sum(law.modes for law in laws)
    names = (*order.names, *_memory_names(machine))
    sized = np.array(scales + [1.0] * memories)
    turns = _turns(machine, order)
    return Coordinates(
        names, sized, order, memories, mechanics, machine.names_parts, wave_of(machine) if order.kept else None, drifts=turns
    )


def _turns(machine: Any, order: Order) -> CyclicCoordinates:
    """The positions in a state that are angles modulo a turn."""
    if order.cyclic:
        return CyclicCoordinates()
    places = tuple(order.places.start + order.kept.index(j) for j in turning(machine, order.kept))
    return CyclicCoordinates(tuple(order.names[i] for i in places), places, (TURN,) * len(places))


def state_at_rest(model: Model, at: Coordinates | None = None) -> Array:
    """The strobe state in which a run from rest begins: array (cases, coordinates); all zeros but for what the law itself says.

    Who knows its coordinates gives them too.

    Examples
    --------
    >>> import stickslip as ss
    >>> state_at_rest(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[5e-4, 6e-4])).tolist()
    [[0.0, 0.0], [0.0, 0.0]]
    """
    return (coordinates(model) if at is None else at).at_rest(model)


def states_of_start(what: str, model: Model, start: Any, at: Coordinates | None = None) -> Array:
    """Strobe states of a machine from a start as `solve` takes it: array (cases, coordinates)."""
    problems, at = Problems(what), coordinates(model) if at is None else at
    n = at.mechanics.coordinates
    table = start_states(model, labels_of(model), start, problems)
    if start is not None or not at.mechanics.flying:  # whose coordinates are all zero may stand in the ground
        problems.check()
    q, u, rest = np.split(table, [n, 2 * n], axis=1)
    inner = rest.shape[1] - at.memories
    return np.column_stack([*at.order.joined(list(q.T), list(u.T), list(rest.T[:inner])), rest[:, inner:]])


def _memory_names(machine: MachineAdapter) -> tuple[str, ...]:
    """Names of what laws remember, by contact where there are several."""
    if not machine.names_parts:
        return numbered_names("memory", machine.laws[0].modes)
    contacts = zip(machine.mechanics.contacts, machine.laws, strict=True)
    return tuple(f"memory.{name}.{k}" for name, law in contacts for k in range(law.modes))


def largest_size(value: Any) -> float:
    """The largest size of a number or of an array of them."""
    return float(np.max(np.abs(np.asarray(value, float))))


def spread_over(model: Model, cases: int) -> Any:
    """A single case as a batch of `cases` equal ones; a batch stays what it is."""
    numbers = dict(leaves(model))
    if not adapter_of(model).has_bodies or any(np.ndim(value) for value in numbers.values()):
        return model
    name = next(iter(numbers))
    return replace_leaf(model, {name: np.full(cases, float(numbers[name]))})


def strobe_map(
    model: Model, states: ArrayLike, periods: int = 1, rtol: float = 1e-12, at: Coordinates | None = None, stepped: bool = False
) -> Ends:
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
    at : Coordinates, optional
        Where they are known.
    stepped : bool
        Go by steps without asking first whether there are closed arcs and whether the equations come back after the period, as of
        machines beside one that has been asked.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static")
    >>> strobe_map(robot, [[0.0], [1e-3]], periods=3).displacement.round(9).tolist()
    [0.00018731, 0.000187693]
    """
    states = np.atleast_2d(np.asarray(states, float))
    if stepped:
        return _ended(model, *run_lanes(model, states, periods, rtol, at=at), periods)
    return _map_of(model, rtol, at)(states, periods)


def _map_of(model: Model, rtol: float, at: Coordinates | None) -> Callable[[Array, int], Ends]:
    """The strobe map of a model as a function of as many states each time, and of periods; what it depends on is asked once."""
    refuse_chance(adapter_of(model))
    if at is not None and at.section is not None:
        returned: Callable[[Array, int], Ends] = at.section.map_of(model, rtol, at)
        return returned
    return (coordinates(model) if at is None else at).map_of(model, rtol)


def _map_by_lanes(model: Model, rtol: float, at: Coordinates) -> Callable[[Array, int], Ends]:
    """The same by the engine's lanes, whose table of cases is made once."""
    table = None

    def mapped(states: Array, periods: int) -> Ends:
        nonlocal table
        if table is None:
            check_equations(model)
        results, table, end = run_lanes(model, states, periods, rtol, at=at, table=table)
        return _ended(model, results, table, end, periods)

    return mapped


def refuse_chance(machine: ModelAdapter) -> None:
    """`InputError` for a machine with a law of chance."""
    random = next((law.name for law in machine.laws if law.random), None)
    if random is not None:
        raise InputError(
            random,
            ["its bonds form again at random places, so no two drive periods are alike and there is no strobe map that orbits, "
             "exponents or basins could belong to; allowed are deterministic laws, such as ss.friction.GMS or ss.LuGre; for this one type "
             "ss.dynamics.strobe(ss.solve(robot, periods=400)) and compare several seeds"],
        )  # fmt: skip


def map_method(model: Model, rtol: float) -> tuple[Any, float]:
    """The tableau by which lanes carry states and their changes from strobe to strobe (None: Taylor steps), and their tolerance."""
    from stickslip.solvers.rosenbrock import SAFETY, tableau
    from stickslip.solvers.set_valued import REPEAT

    return (tableau(model, rtol), SAFETY * rtol) if machine_of(model).has_inner_states else (None, REPEAT / 10)


def _steps(model: Model, rtol: float) -> tuple[Any, float]:
    """The same of the states alone, for which Taylor series know some laws with inner states."""
    from stickslip.solvers import series

    return (
        series.method(max(rtol, _FINEST))
        if machine_of(model).has_inner_states and not series.series_refusal(model)
        else map_method(model, rtol)
    )


def _ended(model: Model, results: Any, table: Any, end: Array, periods: int) -> Ends:
    """Results of lanes in the form of the strobe map."""
    segments = _segments(results, len(machine_of(model).laws), table.span)
    if results.parts is not None:
        none = np.full(len(end), np.nan)
        return Ends(end, results.displacement, results.status, none, none, segments)
    offset = table.offsets[:, 0]
    carried = table.carried * periods * model.period if np.any(table.carried) else 0.0
    return Ends(
        end, results.end[:, 0] - table.start[:, 0] + carried, results.status, results.v_max + offset, results.v_min + offset, segments
    )


def check_equations(model: Model) -> None:
    """`InputError` for functions that a kernel would not know, and for equations that do not come back after the period."""
    from stickslip.engine.kinds import check_functions
    from stickslip.solvers.time_dependence import check_period

    check_functions(model)
    check_period(model)


def run_lanes(
    model: Model, states: Array, periods: int, rtol: float, span: Any = None, auto: bool = False, at: Coordinates | None = None,
    table: Any = None,
) -> tuple[Any, Any, Array]:  # fmt: skip
    """Results of lanes for runs from some states, the table of their cases, and the final states; with `auto` of settled runs.

    `table`: of earlier runs of the same cases. Who asks for the first checks the equations before.
    """
    from stickslip.engine import lanes
    from stickslip.solvers.lane_tables import CaseTable
    from stickslip.solvers.stepping import BUDGET, budget_of

    at, cases = coordinates(model) if at is None else at, len(states)
    order, (tableau, tolerance) = at.order, _steps(model, rtol)
    kernel = lanes.kernel_of(model, tableau, record=auto and cases == 1)
    q, u, z = order.split(list(states.T[: at.smooth]), np.zeros(cases))
    span = (0.0 if model.period is None else spread_over_cases(model.period, labels_of(model))) if span is None else span
    start = np.column_stack([*q, *u, *z, np.round(states[:, at.smooth :])])
    table = CaseTable(model, kernel, start, span) if table is None else table.restarted(start)
    job = lanes.Job(periods, periods // 2 if auto else 0, auto, tolerance, 0.75, budget_of(model, periods) if auto else BUDGET * periods)
    results = lanes.run(kernel, table.rows, table.start, job)
    positions, v, inner = table.ends(results)
    zero = (np.zeros(cases),) if order.cyclic else ()
    y = np.column_stack([*order.joined([*zero, *positions.T], list(v.T), list(inner.T))])
    return results, table, np.hstack([np.where(results.status[:, None] <= 1, y, np.nan), results.memory])


def _segments(results: Any, contacts: int, span: Array) -> tuple[tuple[Array, Array, Array], ...]:
    """Segments of each contact, in drive periods."""
    counts, width = results.seg_count, results.seg_time.shape[1] // max(results.seg_count.shape[1], 1)
    parts = [slice(i * width, (i + 1) * width) for i in range(min(contacts, counts.shape[1]))]
    return tuple((counts[:, i], results.seg_time[:, part] / span[:, None], results.seg_code[:, part]) for i, part in enumerate(parts))


def has_arcs(model: Model) -> bool:
    """Whether the motion is made of closed arcs."""
    from stickslip.solvers.closed_arcs import handles

    return handles(model) is None


def coordinates_of_flow(flow: Any, count: int | None = None) -> Coordinates:
    """The states of a flow by their names, and the place of its mode among its modes, which is a memory."""
    if flow.states is None and count is not None:
        order, sizes = order_of_names(flow.names(count - 1)), (1.0,) * (count - 1)
    else:
        order, sizes = order_of(flow), flow.sizes
    return FlowCoordinates((*order.names, "mode"), np.append(sizes, 1.0), order, 1, drifts=flow.drifts)


def _of_flow(flow: Any, states: Array, duration: Any) -> Ends:
    """The states of a flow that switches after some time, and the way that its first cyclic coordinate makes."""
    from stickslip.solvers.flow_engine import ends, unknown
    from stickslip.solvers.flow_requests import untraced

    if why := unknown(flow, states.shape[1] - 1):
        raise InputError("SwitchingFlow", [untraced(why)])
    y, modes, status = ends(flow, states[:, :-1], np.round(states[:, -1]), duration)
    return ends_of_flow(flow, states, y, modes, status)


def ends_of_flow(flow: Any, begun: Array, y: Array, modes: Array, status: Array, duration: Any = None) -> Ends:
    """The ends of runs of a flow from some starts: cyclic coordinates count as a way, and are brought back."""
    none, drifts = np.full(len(y), np.nan), flow.drifts
    way = y[:, drifts.places[0]] - begun[:, drifts.places[0]] if drifts else np.zeros(len(y))
    states = np.column_stack([drifts.wrapped(y) if drifts else y, np.where(modes < 0, np.nan, modes)])
    return Ends(states, way, status, none, none, duration=duration)


def flow_map(model: Any, states: Array, duration: Any, rtol: float = 1e-12) -> Ends:
    """The states of a model without a period after some time, one duration for all or one for each.

    Examples
    --------
    >>> import stickslip as ss
    >>> belt = ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5))
    >>> flow_map(belt, [[0.0, 0.1], [0.0, 0.1]], [1.0, 2.0]).state.round(12).tolist()  # it rides along
    [[0.1, 0.1], [0.2, 0.1]]
    """
    states = np.atleast_2d(np.asarray(states, float))
    return coordinates(model).after(model, states, np.asarray(duration, float), rtol)


def _by_arcs(model: Model, states: Array, periods: int) -> Ends:
    from stickslip.solvers.set_valued import solve_batch

    raw = solve_batch(spread_over(model, len(states)), periods, 0, {"x": 0.0, "v": states[:, 0]})
    segments = ((raw["seg_count"], raw["seg_time"], raw["seg_code"]),)
    return Ends(raw["v_end"][:, None], raw["x_end"], raw["status"], raw["v_max"], raw["v_min"], segments)


def _one_by_one(model: Model, states: Array, periods: int, rtol: float) -> Ends:
    """Any other method: a run for each case."""
    cases = cases_of(model)
    cases = cases * (len(states) // len(cases))
    runs = [flight(case, state, periods, rtol) for case, state in zip(cases, states, strict=True)]
    ends = np.array([strobe_states(run)[-1] for run in runs])
    way = np.array([position_of(run)[-1] - position_of(run)[0] for run in runs])
    if np.ndim(runs[0].v) > 1:
        none = np.full(len(runs), np.nan)
        return Ends(ends, way, np.zeros(len(runs), int), none, none)
    top, low = (np.array([extreme(run.v) for run in runs]) for extreme in (np.max, np.min))
    return Ends(ends, way, np.zeros(len(runs), int), top, low)


def flight(model: Any, state: Array, periods: int = 1, rtol: float = 1e-12) -> Any:
    """The trajectory from a strobe state, with its dense output and its events."""
    from stickslip.solvers import solve

    options = {"rtol": rtol} if adapter_of(model).has_tolerance else {}
    return solve(model, periods=periods, settle=0, keep="trajectory", **coordinates(model).begun(model, state), **options)


def strobe_states(run: Any) -> Array:
    """The strobe states of a run, one row for each drive period and one for its end."""
    run = run.with_axes
    x, v, z, memory = run.strobe_x, run.strobe_v, run._strobe_inner, run.strobe_memory
    return np.column_stack([*coordinates_in(run.model, x, v, z), *([] if memory is None else [memory])])


def state_at(run: Any, t: float) -> Array:
    """The state within a run at one time, in the order of `coordinates`, without what laws remember."""
    return np.array([column[0] for column in states_of_run(run, np.array([t])).values()])


def position_of(run: Trajectory) -> Array:
    """Position of the body, of the principal body, or of the centre of mass of several, at the strobe times [m]."""
    return way_of_machine(run.model, run.with_axes.strobe_x)


def with_rests(model: Model, state: Array, periods: int, rtol: float) -> Array:
    """A state that comes back, in which contacts that rest on the strobe rest exactly: Newton's method leaves rounding in their velocities.

    A slip of rounding would be an arc of its own, and a gap of rounding a flight, above the track or below it. A single body is told apart
    by its own arcs.
    """
    at, machine = coordinates(model), machine_of(model)
    if not at.named or machine.has_inner_states:
        return state
    closed = np.where(abs(state) <= _RESTS * at.scales, 0.0, state)
    return as_it_ends(at, closed, strobe_map(model, closed, periods, rtol).state[0])


def as_it_ends(at: Coordinates, state: Array, end: Array) -> Array:
    """A state in which what rests at the end of a run from nearby has the velocities that it has there."""
    v, settled = at.order.velocities, np.array(state)
    slips = at.mechanics.slips(0.0, tuple(end[v]), at.order.split(list(end[: at.smooth]), 0.0)[0])
    for row, slip in zip(at.mechanics.directions, slips, strict=True):
        if abs(float(slip)) <= _RESTS * at.speed:
            brakes = v.start + np.flatnonzero(row)
            settled[brakes] = end[brakes]
    return settled


def strobe_orbit(model: Model, states: ArrayLike, count: int, rtol: float = 1e-9, at: Coordinates | None = None) -> tuple[Array, Array]:
    """The states and the displacement of `count` periods in a row: arrays (count, cases, coordinates) and (count, cases)."""
    kept, ways, _ = strobe_points(model, states, count, rtol, at)
    return kept, ways


def strobe_points(
    model: Model, states: ArrayLike, count: int, rtol: float = 1e-9, at: Coordinates | None = None
) -> tuple[Array, Array, Array]:
    """The same, and how long each return to a section took [s] (count, cases): NaN of drive periods."""
    state, kept, ways, times = np.atleast_2d(np.asarray(states, float)), [], [], []
    mapped = _map_of(model, rtol, at)
    for _ in range(count):
        end = mapped(state, 1)
        state = end.state
        kept.append(state)
        ways.append(end.displacement)
        times.append(np.full(len(state), np.nan) if end.duration is None else end.duration)
    return np.array(kept), np.array(ways), np.array(times)
