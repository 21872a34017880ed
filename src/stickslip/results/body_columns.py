"""The columns of a run of bodies: positions, velocities, inner states, forces, strobe points and events, from its pieces."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.presenting import presenter
from stickslip.basics.variables import VARIABLES
from stickslip.models import forces
from stickslip.models.contact_forces import held_by_controllers
from stickslip.models.drives.drive_adapter import LEVEL, MISTAKEN
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.machine_adapter import machine_of
from stickslip.models.normal_loads import normal_load
from stickslip.models.state_layout import of_one_contact
from stickslip.results.datasets import COLUMNS, column_description, columns_with_units, explained_columns, unit_of_parts
from stickslip.results.dense_output import inner_rates
from stickslip.results.events import Event, aloft_of, events_of, flights_of, hits_of, nodes_at
from stickslip.results.part_notes import shared_at_rest
from stickslip.results.part_runs import ContactRun
from stickslip.results.run_columns import RunColumns
from stickslip.results.steadiness import drifting_apart

_PARTS = "run.x, run.v and run.z, or run.bodies[name] and run.contacts[name], for the states of a machine"
_SEVERAL = ("slip", "load")  # columns that files have only where there are several contacts


def _as_column(z: Array) -> Any:
    """None for no inner states; the only one without an axis of its own, where there is none for contacts either."""
    return None if z.shape[-1] == 0 else z[:, 0] if z.shape[1:] == (1,) else z


def _at_distances(mechanics: Any, t: Any, x: Any, v: Any) -> tuple[Any, Any]:
    """Positions and velocities of bodies at prescribed distances, whose columns hold those of the coordinates they move with."""
    first = {mechanics.coordinate_of(name): i for i, name in reversed(list(enumerate(mechanics.bodies)))}
    q, u = (tuple(of[:, first[c]] for c in range(mechanics.coordinates)) for of in (x, v))
    rows = (mechanics.positions(t, q), mechanics.velocities(t, u))
    x, v = (np.stack([np.broadcast_to(each, t.shape) for each in of], axis=1) for of in rows)
    return x, v


def _force(name: str) -> property:
    return property(lambda self: self.force(name))


@sealed
class BodyColumns(RunColumns):
    """The columns of a run of bodies and contacts, with or without axes for them as the pieces' layout says.

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=2)
    >>> columns = BodyColumns(run.model, run.pieces, 400)
    >>> bool((columns.v == run.v).all()), columns.unit("v")
    (True, 'm/s')
    """

    drawn_by = "velocity"

    # ---- events ----
    def events(self, run: Any) -> list[Event]:
        """Hits, flights, the run's named events, and changes of modes, in order."""
        hits = [hit for _, hit in (*self.hits, *self.flights)]
        changes = events_of(self.pieces, self.impulses, run._lost, self.aloft)
        return sorted([*hits, *run.named_events, *changes], key=lambda event: event.t)

    @cached_property
    def hits(self) -> list[tuple[int, Event]]:
        """Hits on stops, each with the number of its node."""
        machine = machine_of(self.model)
        if not machine.mechanics.stops:
            return []
        return hits_of(self.pieces, machine.mechanics, float(machine.velocity_scale), float(machine.time_scale or 1.0))

    @cached_property
    def aloft(self) -> Any:
        """On which pieces contacts fly: array (pieces, contacts)."""
        return aloft_of(self.pieces, machine_of(self.model).laws)

    @cached_property
    def flights(self) -> list[tuple[int, Event]]:
        """Take-offs and landings, each with the number of its node."""
        return flights_of(self.pieces, self.aloft)

    @cached_property
    def thrown_together(self) -> tuple[str, ...]:
        """Names of the points that landed at one instant and of which some were thrown up: a motion beside hits with one after the other.

        Where and how fast it goes on then is something else, however near it began: there is no derivative through such a hit.
        """
        landed: dict[int, list[str]] = {}
        for node, event in self.flights:
            if event.kind == "landing":
                landed.setdefault(node, []).append(event.part)
        names = [contact.name for contact in self.pieces.layout.contacts]
        thrown = (of for node, of in landed.items() if len(of) > 1 and any(self.aloft[node, names.index(name)] for name in of))
        return tuple(dict.fromkeys(name for of in thrown for name in of))

    def switch_times(self, run: Any, name: str) -> Array:
        """The instants of a switch by its name, such as "stick of block"."""
        kind, _, contact = name.partition(" of ")
        return np.array([event.t for event in run.events if event.kind == kind and event.part == contact])

    def beside_switches(self, name: str) -> tuple[Array, Array]:
        """None of a position, which does not jump."""
        return np.zeros(0), np.zeros(0)

    @cached_property
    def impulses(self) -> list[tuple[float, float]]:
        """Instants at which the drive's velocity jumps, and by how much."""
        return forces.impulses_until(self.model, float(self.pieces.t[-1]))

    @cached_property
    def instants(self) -> tuple[Any, Any]:
        """The sampled times and the piece of each; an event at which v jumps stands there with both its pieces."""
        nodes, step = self.pieces.t, self.step
        grid = np.arange(max(int(np.ceil((nodes[-1] - nodes[0]) / step - 1e-6)), 1) + 1) * step + nodes[0]
        grid[-1] = nodes[-1]
        changes = np.flatnonzero(np.any(np.diff(self.pieces.mode, axis=0) != 0, axis=1)) + 1
        thrown = nodes_at(self.pieces, [t for t, _ in self.impulses])
        if others := [*thrown, *(node for node, _ in (*self.hits, *self.flights))]:
            changes = np.union1d(changes, others)
        events = nodes[changes]
        if len(events):
            after = np.minimum(np.searchsorted(events, grid), len(events) - 1)
            near = np.minimum(abs(grid - events[after]), abs(grid - events[np.maximum(after - 1, 0)]))
            grid = grid[near > 1e-12 * step * self.samples]
        jumps = changes[self.pieces.jumps(changes, 1e-6 * machine_of(self.model).velocity_scale)] if len(changes) else changes
        t = np.concatenate([grid, nodes[jumps], events])
        index = np.concatenate([self.index(grid), jumps - 1, changes])
        order = np.lexsort((index, t))
        return t[order], index[order]

    # ---- columns ----
    def own(self, name: str, column: Any) -> Any:
        """A column with axes for all parts, as this run has it: without those of length one, and of its principal body or contact alone."""
        number = next((self.pieces.layout.own[dim] for dim in VARIABLES[name].dims if dim in self.pieces.layout.own), None)
        if name == "z":
            layout = self.pieces.layout
            return _as_column(column if number is None else column[:, number, : len(layout.contacts[number].inner)])
        return column if number is None or column is None else column[:, number]

    def states_at(self, t: ArrayLike, index: Any) -> tuple[Any, Any, Any]:
        """x and v (time, body) and z (time, contact or controller, state) at times on given pieces."""
        x, v, z = self.pieces.evaluate(t, index)
        bodies = self.pieces.layout.bodies
        if len({body.velocity for body in bodies}) < len(bodies):
            x, v = _at_distances(machine_of(self.model).mechanics, t, x, v)
        return x, v, z

    @cached_property
    def states(self) -> tuple[Any, Any, Any]:
        """x, v and z of all bodies and contacts at the sampled times, as `states_at` gives them."""
        return self.states_at(*self.instants)

    @property
    def t(self) -> Array:
        """The sampled times."""
        return self.instants[0]

    @property
    def x(self) -> Any:
        """Positions."""
        return self.own("x", self.states[0])

    @property
    def v(self) -> Any:
        """Velocities."""
        return self.own("v", self.states[1])

    @property
    def z(self) -> Any:
        """Inner states of the laws."""
        return self.own("z", self.of_laws(self.states[2]))

    def of_laws(self, z: Array) -> Any:
        """The inner states of the laws among those of laws and controllers."""
        layout = self.pieces.layout
        if not layout.controllers:
            return z
        return z[:, : len(layout.contacts), : max((len(contact.inner) for contact in layout.contacts), default=0)]

    @cached_property
    def mode(self) -> Any:
        """Modes of the contacts."""
        return self.own("mode", self.pieces.mode[self.instants[1]])

    def contacts(self, run: Any) -> dict[str, ContactRun]:
        """The columns of each contact by its name."""
        return {contact.name: ContactRun(run.with_axes, i) for i, contact in enumerate(self.pieces.layout.contacts)}

    # ---- forces ----
    @cached_property
    def _forces(self) -> dict[str, Any]:
        return self._at_door(self.forces_at(*self.instants, *self.states))

    def _at_door(self, columns: dict[str, Any]) -> dict[str, Any]:
        """Columns with axes for all parts as this run has them; slip and load only of machines that may have several contacts."""
        hidden = _SEVERAL if self.pieces.layout.single else ()
        return {name: self.own(name, column) for name, column in columns.items() if name not in hidden}

    def forces_at(self, t: Array, index: Any, x: Array, v: Array, z: Array) -> dict[str, Any]:
        """Every force of all bodies and contacts, from states as `states_at` gives them."""
        z, rates = (np.moveaxis(of, -1, 0) for of in (z, inner_rates(self.pieces, t, index)))
        memory = tuple(self.pieces.memory[index].T)
        return forces.columns(self.model, self.pieces.mode[index], self.within(t, index), x, v, z, rates, memory)

    def within(self, t: ArrayLike, index: Any) -> Any:
        """Times moved off the ends of their pieces where the drive may jump there, so that it answers for the right piece."""
        if not (machine_of(self.model).breaks or self.impulses):
            return t
        aside, nodes = 1e-12 * self.period_time, self.pieces.t
        return np.clip(t, nodes[index] + aside, np.maximum(nodes[index + 1] - aside, nodes[index] + aside))

    def force(self, name: str) -> Any:
        """A column of forces or accelerations, or of the inner mass; `AttributeError` where the machine has none."""
        if name not in self._forces:
            of_contacts = VARIABLES[name].dims != ("time",)
            why = "only machines of several contacts have it" if of_contacts else f"{type(self.model).__name__} has no drive"
            raise AttributeError(f"this run has no {name}: {why}")
        return self._forces[name]

    acceleration, friction_force, slip, load = (_force(name) for name in ("acceleration", "friction_force", "slip", "load"))
    drive_force, actuator_force, actuator_power = (_force(name) for name in ("drive_force", "actuator_force", "actuator_power"))
    xi, xi_rate, xi_acceleration = (_force(name) for name in ("xi", "xi_rate", "xi_acceleration"))

    def at(self, t: Array, index: Array) -> dict[str, Any]:
        """x, v, z, mode and all forces at times (time,) on given pieces."""
        x, v, z = self.states_at(t, index)
        every = {"x": x, "v": v, "mode": self.pieces.mode[index], **self.forces_at(t, index, x, v, z), "z": self.of_laws(z)}
        return self._at_door(every)

    # ---- strobe ----
    @cached_property
    def strobe_points(self) -> tuple[Any, Any, Any, Any]:
        """States and memories at the strobe times, after an impulse or a sample that falls on one."""
        t, nodes = self.strobe_times, self.pieces.t
        index = self.index(t + 1e-12 * self.period_time)
        x, v, z = self.states_at(np.maximum(t, nodes[index]), index)
        memory = np.array(self.pieces.memory[index])
        jump = sum(jump for time, jump in self.impulses if abs(time - t[-1]) < 1e-9 * self.period_time and t[-1] >= nodes[-1])
        if memory.shape[1] and np.any(jump):
            z[-1], memory[-1] = self._thrown(float(t[-1]), x[-1], v[-1], z[-1], memory[-1], jump)
        v[-1] += jump
        if t[-1] >= nodes[-1]:
            z[-1:] = self._sampled(t[-1:], x[-1:], v[-1:], z[-1:])
        return x, v, z, memory

    def _sampled(self, t: Array, x: Array, v: Array, z: Array) -> Any:
        """Inner states after a sample of the controllers at the end of the run, where one falls on it."""
        mechanics: Any = machine_of(self.model).mechanics
        every = mechanics.controllers.sample
        if every is None or abs(t[0] / every - np.rint(t[0] / every)) > 1e-9 * t[0] / every:
            return z
        q, u = mechanics.coordinates_of(tuple(x.T)), mechanics.coordinates_of(tuple(v.T))
        states, z = (np.ravel(new) for new in mechanics.control_sampled(t, q, u, held_by_controllers(mechanics, z))), z.copy()
        for i, count in enumerate(mechanics.controllers.counts):
            for k in range(count):
                z[:, len(mechanics.contacts) + i, k] = next(states)
        return z

    def _thrown(self, t: float, x: ArrayLike, v: ArrayLike, z: ArrayLike, memory: Any, jump: Any) -> tuple[Any, Any]:
        """Inner states and memories after an impulse, which may carry the slip through zero."""
        of_one_contact("run.strobe_z", self, "an impulse at its end carries the memories of one law through zero")
        x, v, jump = (float(np.ravel(of)[0]) for of in (x, v, jump))
        slip = float(self.model.contact_velocity(v))
        if slip * (slip + jump) >= 0:
            return z, memory
        load = normal_load(self.model, t, x)
        return law_of(self.model).passed_zero(tuple(map(float, np.ravel(z))), load, tuple(map(int, memory)))

    @property
    def strobe_x(self) -> Any:
        """Positions at the strobe times."""
        return self.own("x", self.strobe_points[0])

    @property
    def strobe_v(self) -> Any:
        """Velocities at the strobe times."""
        return self.own("v", self.strobe_points[1])

    @property
    def strobe_z(self) -> Any:
        """Inner states of the laws at the strobe times."""
        return self.own("z", self.of_laws(self.strobe_points[2]))

    @property
    def strobe_memory(self) -> Any:
        """Memories of the laws at the strobe times."""
        return _as_column(self.strobe_points[3])

    # ---- tables ----
    @property
    def table(self) -> dict[str, Any]:
        """Every column by name; those that it does not have are left out, such as z under a set-valued law."""
        columns = {name: getattr(self, name, None) for name in COLUMNS}
        return {name: column for name, column in columns.items() if column is not None}

    @property
    def dims(self) -> dict[str, list[str]]:
        """The names of the bodies and contacts by dimension; none if the columns are those of one body and contact."""
        layout = self.pieces.layout
        return {} if layout.own else {"body": [b.name for b in layout.bodies], "contact": [c.name for c in layout.contacts]}

    def dims_of(self, name: str) -> tuple[str, ...]:
        """The dimensions of a column."""
        return VARIABLES[name].dims

    @property
    def flat(self) -> dict[str, tuple[Any, str]]:
        """Columns of numbers (time,) with their units; those of parts with the part's name behind."""
        return columns_with_units(self.table, self.dims, self.model)

    @property
    def head(self) -> list[tuple[str, str, str]]:
        """Heading, unit and meaning of each of these."""
        return explained_columns(self.flat)

    def unit(self, name: str) -> str:
        """The unit of a column; where its parts have different ones, that of each in their order."""
        return unit_of_parts(name, self.model, self.dims)

    def description(self, name: str) -> dict[str, str]:
        """Units, long name and symbol of a column."""
        return column_description(name, self.model) | ({} if name == "t" else {"units": self.unit(name) or "1"})

    def about(self) -> dict[str, Any]:
        """The model as TOML, or in words."""
        try:
            return {"robot": self.model.to_toml()}
        except (InputError, AttributeError):
            return {"robot": repr(self.model)}

    # ---- words ----
    def notes(self, run: Any) -> list[str]:
        """Remarks on the machine's numbers, an early end, motion not settled, bodies that drift apart, and friction not determined."""
        early = f"the run was {run.status}; type run.shortened() for what analyses take" if run.interrupted else ""
        machine = machine_of(self.model)
        remarks = (early, *machine.notes, self._settled(run), drifting_apart(run.with_axes), shared_at_rest(run))
        return [note for note in remarks if note]

    def _settled(self, run: Any) -> str:
        if run.interrupted:
            return ""
        layout = self.pieces.layout
        if len(layout.bodies) != len(machine_of(self.model).mechanics.bodies):
            return f"whether a motion of {layout.description} has settled is not judged"
        return str(run.steadiness.note)

    def words(self, run: Any) -> str:
        """Length, method, status and motion, and numbers of the machine that look mistaken."""
        seconds = f"{float(self.pieces.t[-1] - self.pieces.t[0]):.6g} s"
        length = seconds if self.model.period is None else f"{run.periods} periods of {self.period_time:.6g} s"
        notes = machine_of(self.model).notes
        mistaken = "".join(f"; {note}" for note in notes if note.startswith(MISTAKEN))
        mistaken += "".join(f"; {note.partition(';')[0]} (see run.notes)" for note in notes if note.startswith(LEVEL))
        moves = ", ".join(f"mean velocity {text}" if name == "mean velocity" else text for name, text in run._moves.items())
        return f"{length} by {run.method}, {run.status}{'; ' * bool(moves)}{moves}{mistaken}"

    def facts(self, run: Any) -> dict[str, Any]:
        """The machine, how it was solved, how long it runs, and how it moves."""
        length = f"{float(self.pieces.t[-1] - self.pieces.t[0]):.6g} s"
        periods = {} if self.model.period is None else {"periods": f"{run.periods} of {self.period_time:.6g} s ({run.settle} to settle)"}
        about = {"machine": type(self.model).__name__, "method": run.method, "status": run.status, "length": length}
        return {**about, **periods, **run._moves}

    def state_named(self, name: str) -> Array:
        """There are no states with names of their own: `InputError`."""
        raise InputError("Trajectory", [f"run[{name!r}] is a state of a flow, and this run is that of a machine; type {_PARTS}"])

    def mean_velocity(self, run: Any) -> float:
        """Mean steady velocity, as `stickslip.analysis` has it."""
        velocity: float = presenter("number", "mean_velocity")(run)
        return velocity

    def lacking(self, name: str) -> AttributeError:
        """States by names of their own are a flow's."""
        return AttributeError(f"this run has no {name}: it is of a flow, which names its states itself; type {_PARTS}")
