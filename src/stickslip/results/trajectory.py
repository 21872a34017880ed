"""The result of one run: every column, every event, and the dense output."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Numbers, described_as, explains_arguments
from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError, StickslipError, did_you_mean
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.notebook_display import Drawn
from stickslip.basics.status import INTERRUPTED, Status
from stickslip.basics.variables import VARIABLES
from stickslip.models import forces
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.contact_forces import held_by_controllers
from stickslip.models.drives.drive_adapter import LEVEL, MISTAKEN
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.machine_adapter import machine_of
from stickslip.models.normal_loads import normal_load
from stickslip.models.rounding import without_rounding
from stickslip.models.state_layout import of_one_contact
from stickslip.results.dense_output import inner_rates
from stickslip.results.events import Event, aloft_of, events_of, flights_of, hits_of, nodes_at
from stickslip.results.part_notes import shared_at_rest
from stickslip.results.part_runs import BodyRun, ContactRun, ControllerRun, PlacedBodyRun
from stickslip.results.run_files import RunFiles
from stickslip.results.steadiness import Steadiness, drifting_apart, steadiness_of_run
from stickslip.results.verbs import Judged

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Samples of a run that has no period: this many times `samples` in all.
APERIODIC = 10
#: Velocities of bodies in the columns of a run up to which its motion is judged when it is printed.
_AT_A_GLANCE = 200_000
#: What to type for names that a run does not have.
_INSTEAD = {
    "velocity": "run.v",
    **dict.fromkeys(("position", "displacement"), "run.x"),
    **dict.fromkeys(("time", "times"), "run.t"),
    "force": "run.friction_force",
    "motion_type": "run.motion.type",
    "pattern": "run.motion.pattern",
    "stick_fraction": "run.motion.stick_fraction, of one contact, or motion.contacts[name].stick_fraction",
    "amplitude": "run.motion.amplitude, of a machine without a period, or np.ptp(run.v[run.t > run.t[-1] - run.period_time]) / 2",
    "energy": "ss.energy(run)",
    "spectrum": "ss.dynamics.spectrum(run)",
    "period": "run.motion.period, in drive periods, or run.period_time [s]",
    **dict.fromkeys(("savefig", "figure", "save_figure"), 'run.plot().figure.savefig("run.png", dpi=600)'),
    **dict.fromkeys(("to_pandas", "to_frame", "df"), "run.to_dataframe()"),
}


def _as_column(z: Array) -> Any:
    """None for no inner states; the only one without an axis of its own, where there is none for contacts either."""
    return None if z.shape[-1] == 0 else z[:, 0] if z.shape[1:] == (1,) else z


_SEVERAL = ("slip", "load")  # columns that files have only where there are several contacts


def _at_distances(mechanics: Any, t: Any, x: Any, v: Any) -> tuple[Any, Any]:
    """Positions and velocities of bodies at prescribed distances, whose columns hold those of the coordinates they move with."""
    first = {mechanics.coordinate_of(name): i for i, name in reversed(list(enumerate(mechanics.bodies)))}
    q, u = (tuple(of[:, first[c]] for c in range(mechanics.coordinates)) for of in (x, v))
    rows = (mechanics.positions(t, q), mechanics.velocities(t, u))
    x, v = (np.stack([np.broadcast_to(each, t.shape) for each in of], axis=1) for of in rows)
    return x, v


class _Column(property):
    """A property, of which type checkers know that it is an array."""

    if TYPE_CHECKING:

        def __get__(self, run: Trajectory, of: type | None = None) -> NDArray[np.float64]: ...  # type: ignore[override]


def _force_column(name: str) -> _Column:
    variable = VARIABLES[name]

    def column(self: Any) -> Any:
        if name not in self._forces:
            why = f"{type(self.model).__name__} has no drive" if variable.dims == ("time",) else "only machines of several contacts have it"
            raise AttributeError(f"this run has no {name}: {why}")
        return self._forces[name]

    column.__doc__ = (
        f"{variable.long_name[0].upper()}{variable.long_name[1:]} [{variable.unit}]."  # given as doc=, that of the class hides it
    )
    return _Column(column)


@described_as("a Trajectory; type for example ss.solve(robot)")
@sealed
@dataclass(frozen=True, eq=False)
class Trajectory(Drawn, Judged, RunFiles):
    """One run of one machine. It is computed once by `solve`; everything here only reads it.

    Its columns are arrays over the same instants: `samples` in each drive period (ten times `samples` over the whole run where the model
    has no period) and, exactly, every event (twice where v jumps).

    ===============  =====  ===============================================================================
    column           unit   meaning
    ===============  =====  ===============================================================================
    t                s      time
    x                m      position of the body
    v                m/s    velocity of the body
    z                m      inner state of the friction law (mean bristle deflection)
    mode             1      +1 forwards, 0 stuck, -1 backwards (dynamic laws: the sign of v at the contact)
    acceleration     m/s^2  acceleration of the body
    xi               m      position of the inner mass relative to the body
    xi_rate          m/s    velocity of the inner mass relative to the body
    xi_acceleration  m/s^2  acceleration of the inner mass relative to the body
    friction_force   N      friction force on the body, positive against forward motion
    slip             m/s    slip velocity of the contact
    load             N      normal force that presses the contact
    drive_force      N      inertial drive force on the whole system
    actuator_force   N      force of the actuator on the body (Eq. 2.1)
    actuator_power   W      mechanical power that the actuator delivers
    ===============  =====  ===============================================================================

    The columns of the inner mass (xi), of the drive and of the actuator exist where there is a drive, slip and load for machines with
    several contacts. A machine that turns about an axis has rad instead of m, and N m instead of N.

    A `Robot` or a mechanism has one body on one contact, and a column is an array (time,). Of a machine of several x, v and
    acceleration are (time, body), mode and friction_force (time, contact), and z is (time, contact, state), NaN where a law has fewer
    states than another. Where a machine names a principal body, columns are those of this body and of its contact, (time,) as a Robot's
    are. Of any run ``run.bodies[name].x`` and ``run.contacts[name].mode`` are (time,); the names of a Robot's are "body" and "contact".

    Parameters
    ----------
    model : Robot or a mechanism
        What was solved.
    pieces : DensePieces
        The dense output.
    periods, settle : int
        Drive periods simulated, and how many of them the mean velocity excludes.
    rtol : float
        Relative tolerance of the run.
    method : str
        Name of the solver.
    status : str
        How the run ended, in words.
    samples : int
        Instants per drive period in the columns, a tenth of all instants where there is no period.
    start : dict
        The state it started from.
    provenance : dict
        Versions and settings that reproduce the run.
    counts : dict
        Steps taken, rejected, and so on.
    known_period : int, optional
        Drive periods, or turns of a cycle, after which it repeats, where that is known beforehand: of the run once around a periodic orbit.
    named_events : tuple of Event
        Where functions of the user passed zero, ``solve(events=...)``, by their names in `part`.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.results.dense_output import HarmonicArcs
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=1e-3, law="coulomb")
    >>> arcs = HarmonicArcs(np.array([0.0, robot.period]), np.array([0]), np.zeros(1), np.zeros(1), 1.0, robot.drive.omega, 2.0, 2.0)
    >>> run = Trajectory(robot, arcs, periods=1, settle=0, rtol=1e-6, method="by hand")
    >>> run.t.size, run.events, float(run.at(0.01)["v"])
    (401, [], 0.0)
    >>> run.x.shape, bool((run.bodies["body"].x == run.x).all())
    ((401,), True)
    """

    model: Any
    pieces: Any
    periods: int
    settle: int
    rtol: float
    method: str
    status: str = Status.FINISHED.sentence
    samples: int = 400
    start: dict[str, Any] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)
    counts: dict[str, Any] = field(default_factory=dict)
    known_period: int | None = None
    named_events: tuple[Event, ...] = ()

    # ---- time ----
    @property
    def period_time(self) -> float:
        """Period T of the drive [s]; an error if the model has none."""
        if self.model.period is None:
            why = f"{type(self.model).__name__} has no period, so this run has neither period_time nor strobe points"
            raise InputError("Trajectory", [f"{why}; type run.at(t) for its state at times of your own"])
        return float(self.model.period)

    @property
    def _step(self) -> float:
        """Time between the samples of the columns [s]."""
        if self.model.period is None:
            return float(self.pieces.t[-1] - self.pieces.t[0]) / (APERIODIC * self.samples)
        return self.period_time / self.samples

    @property
    def window(self) -> tuple[float, float]:
        """Start and end of the part after settling [s]; all of a run that ended before it had settled."""
        first, last = float(self.pieces.t[0]), float(self.pieces.t[-1])
        settled = self.settle * self.period_time if self.settle else first
        return (settled if settled < last else first), last

    @property
    def lost_contact(self) -> bool:
        """Whether the run ended because the load fell to zero."""
        return self.status == Status.LOST.sentence

    @property
    def interrupted(self) -> bool:
        """Whether the run was interrupted: then `status` says when, and analyses take `shortened` instead."""
        return self.status.startswith(INTERRUPTED)

    def shortened(self) -> Trajectory:
        """An interrupted run as one that was asked for the whole drive periods it has, of which at most half are to settle.

        Raises
        ------
        InputError
            If there is no whole drive period.

        Examples
        --------
        >>> import stickslip as ss
        >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb")
        >>> run = ss.solve(robot, periods=100_000, progress=lambda done, periods: done < 100)  # stopped by progress, as by Ctrl-C
        >>> run.interrupted, run.shortened().interrupted, round(ss.mean_velocity(run.shortened()), 9)
        (True, False, 0.002035336)
        """
        if self.model.period is None:
            return replace(self, status=Status.FINISHED.sentence)
        periods = len(self.strobe_times) - 1
        if not periods:
            raise InputError("shortened", [f"the run was {self.status}, before its first drive period was over; type ss.solve again"])
        whole, settle = self.pieces.until(self.strobe_times[-1]), min(self.settle, periods // 2)
        return replace(self, pieces=whole, periods=periods, settle=settle, status=Status.FINISHED.sentence)

    @cached_property
    def events(self) -> list[Event]:
        """Every change of mode, impulse, switch of a memory, hit on a stop, take-off and landing, and the named events, in order.

        Under a dynamic law modes change where v reverses. At one instant there is one for each contact that changed, in the order of
        `contacts`, after hits and landings.
        """
        hits = [hit for _, hit in (*self._hits, *self._flights)]
        changes = events_of(self.pieces, self._impulses, self._lost, self._aloft)
        return sorted([*hits, *self.named_events, *changes], key=lambda event: event.t)

    @cached_property
    def _hits(self) -> list[tuple[int, Event]]:
        """Hits on stops, each with the number of its node."""
        machine = machine_of(self.model)
        if not machine.mechanics.stops:
            return []
        return hits_of(self.pieces, machine.mechanics, float(machine.velocity_scale), float(machine.time_scale or 1.0))

    @cached_property
    def _aloft(self) -> Any:
        """On which pieces contacts fly: array (pieces, contacts)."""
        return aloft_of(self.pieces, machine_of(self.model).laws)

    @cached_property
    def _flights(self) -> list[tuple[int, Event]]:
        """Take-offs and landings, each with the number of its node."""
        return flights_of(self.pieces, self._aloft)

    @cached_property
    def _thrown_together(self) -> tuple[str, ...]:
        """Names of the points that landed at one instant and of which some were thrown up: a motion beside hits with one after the other.

        Where and how fast it goes on then is something else, however near it began: there is no derivative through such a hit.
        """
        landed: dict[int, list[str]] = {}
        for node, event in self._flights:
            if event.kind == "landing":
                landed.setdefault(node, []).append(event.part)
        names = list(self.contacts)
        thrown = (of for node, of in landed.items() if len(of) > 1 and any(self._aloft[node, names.index(name)] for name in of))
        return tuple(dict.fromkeys(name for of in thrown for name in of))

    @property
    def _lost(self) -> list[str]:
        """Names of the contacts that were lost at the end."""
        names = list(self.contacts)
        if not self.lost_contact or len(names) == 1:
            return names if self.lost_contact else []
        last, most = self.with_axes.load[-1], abs(self.with_axes.load).max(axis=0)
        return [name for name, load, largest in zip(names, last, most, strict=True) if load <= 1e-9 * largest]

    def _switch_times(self, name: str) -> Array:
        """The instants of a switch by its name, such as "stick of block"."""
        kind, _, contact = name.partition(" of ")
        return np.array([event.t for event in self.events if event.kind == kind and event.part == contact])

    @cached_property
    def _impulses(self) -> list[tuple[float, float]]:
        return forces.impulses_until(self.model, float(self.pieces.t[-1]))

    @cached_property
    def _instants(self) -> tuple[Any, Any]:
        """The sampled times and the piece of each; an event at which v jumps stands there with both its pieces."""
        nodes, step = self.pieces.t, self._step
        grid = np.arange(max(int(np.ceil((nodes[-1] - nodes[0]) / step - 1e-6)), 1) + 1) * step + nodes[0]
        grid[-1] = nodes[-1]
        changes = np.flatnonzero(np.any(np.diff(self.pieces.mode, axis=0) != 0, axis=1)) + 1
        thrown = nodes_at(self.pieces, [t for t, _ in self._impulses])
        if others := [*thrown, *(node for node, _ in (*self._hits, *self._flights))]:
            changes = np.union1d(changes, others)
        events = nodes[changes]
        if len(events):
            after = np.minimum(np.searchsorted(events, grid), len(events) - 1)
            near = np.minimum(abs(grid - events[after]), abs(grid - events[np.maximum(after - 1, 0)]))
            grid = grid[near > 1e-12 * step * self.samples]
        jumps = changes[self.pieces.jumps(changes, 1e-6 * machine_of(self.model).velocity_scale)] if len(changes) else changes
        t = np.concatenate([grid, nodes[jumps], events])
        index = np.concatenate([self._index(grid), jumps - 1, changes])
        order = np.lexsort((index, t))
        return t[order], index[order]

    def _index(self, t: ArrayLike) -> Any:
        """The piece on which a time lies (the later one at a node)."""
        return np.clip(np.searchsorted(self.pieces.t, t, side="right") - 1, 0, len(self.pieces.mode) - 1)

    # ---- bodies and contacts ----
    @cached_property
    def with_axes(self) -> Trajectory:
        """The same run, whose columns have axes for bodies and contacts even where it has one of each, or a principal body.

        Examples
        --------
        >>> import stickslip as ss
        >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=2)
        >>> run.v.ndim, run.with_axes.v.ndim
        (1, 2)
        """
        layout = self.pieces.layout
        return self if not layout.own else replace(self, pieces=replace(self.pieces, layout=replace(layout, single=False, principal=None)))

    def _own(self, name: str, column: Any) -> Any:
        """A column with axes for all parts, as this run has it: without those of length one, and of its principal body or contact alone."""
        number = next((self.pieces.layout.own[dim] for dim in VARIABLES[name].dims if dim in self.pieces.layout.own), None)
        if name == "z":
            layout = self.pieces.layout
            return _as_column(column if number is None else column[:, number, : len(layout.contacts[number].inner)])
        return column if number is None or column is None else column[:, number]

    def _states_at(self, t: ArrayLike, index: Any) -> tuple[Any, Any, Any]:
        """x and v (time, body) and z (time, contact or controller, state) at times on given pieces."""
        x, v, z = self.pieces.evaluate(t, index)
        bodies = self.pieces.layout.bodies
        if len({body.velocity for body in bodies}) < len(bodies):
            x, v = _at_distances(machine_of(self.model).mechanics, t, x, v)
        return x, v, z

    def _beside_switches(self, name: str) -> tuple[Any, Any]:
        """A state right before and right after each switch; none of a position, which does not jump."""
        return np.zeros(0), np.zeros(0)

    @property
    def bodies(self) -> dict[str, Any]:
        """The columns of each body by its name; of a machine whose `places` say where bodies are, their x, z and angle."""
        mechanics = machine_of(self.model).mechanics if self.pieces.layout.bodies else None
        if mechanics is not None and mechanics.has_places:
            return {name: PlacedBodyRun(self.with_axes, name) for name in mechanics.along(0.0, mechanics.start)}  # type: ignore[attr-defined]
        return dict(self.body_columns)

    @property
    def coordinates(self) -> dict[str, Any]:
        """Each coordinate by its name, as an array (time,): those that a machine names, or the positions of its bodies."""
        return {name: body.x for name, body in self.body_columns.items()}

    @property
    def body_columns(self) -> dict[str, BodyRun]:
        """For each entry of the axis of bodies, or of a machine's own coordinates, its columns by its name."""
        return {body.name: BodyRun(self.with_axes, i) for i, body in enumerate(self.pieces.layout.bodies)}

    @property
    def contacts(self) -> dict[str, ContactRun]:
        """The columns of each contact by its name."""
        return {contact.name: ContactRun(self.with_axes, i) for i, contact in enumerate(self.pieces.layout.contacts)}

    @property
    def controllers(self) -> dict[str, ControllerRun]:
        """The columns of each controller by its name; none of a machine without."""
        return {part.name: ControllerRun(self.with_axes, i) for i, part in enumerate(self.pieces.layout.controllers)}

    # ---- columns ----
    @property
    def t(self) -> NDArray[np.float64]:
        """Times of the columns [s]."""
        return self._instants[0]

    @cached_property
    def _states(self) -> tuple[Any, Any, Any]:
        """x, v and z of all bodies and contacts, as `_states_at` gives them."""
        return self._states_at(*self._instants)

    @property
    def _held(self) -> Any:
        """Inner states of laws and controllers (time, contact or controller, state)."""
        return self._states[2]

    @property
    def x(self) -> NDArray[np.float64]:
        """Position of the body [m]; (time, body) for several bodies."""
        return self._own("x", self._states[0])

    @property
    def v(self) -> NDArray[np.float64]:
        """Velocity of the body [m/s]; (time, body) for several bodies."""
        return self._own("v", self._states[1])

    @property
    def z(self) -> NDArray[np.float64] | None:
        """Inner state of the law: (time,) if it has one, (time, state) if more, None if it has none; (time, contact, state) of several."""
        return self._own("z", self._of_laws(self._states[2]))

    def _of_laws(self, z: Array) -> Any:
        """The inner states of the laws among those of laws and controllers."""
        layout = self.pieces.layout
        if not layout.controllers:
            return z
        return z[:, : len(layout.contacts), : max((len(contact.inner) for contact in layout.contacts), default=0)]

    @cached_property
    def mode(self) -> NDArray[np.int8]:
        """+1 forwards, 0 stuck, -1 backwards (dynamic laws: the sign of v at the contact); (time, contact) of several."""
        return self._own("mode", self.pieces.mode[self._instants[1]])

    @cached_property
    def _forces(self) -> dict[str, Any]:
        return self._at_door(self._forces_at(*self._instants, *self._states))

    def _at_door(self, columns: dict[str, Any]) -> dict[str, Any]:
        """Columns with axes for all parts as this run has them; slip and load only of machines that may have several contacts."""
        hidden = _SEVERAL if self.pieces.layout.single else ()
        return {name: self._own(name, column) for name, column in columns.items() if name not in hidden}

    def _forces_at(self, t: Array, index: Any, x: Array, v: Array, z: Array) -> dict[str, Any]:
        """Every force of all bodies and contacts, from states as `_states_at` gives them."""
        z, rates = (np.moveaxis(of, -1, 0) for of in (z, inner_rates(self.pieces, t, index)))
        memory = tuple(self.pieces.memory[index].T)
        return forces.columns(self.model, self.pieces.mode[index], self._within(t, index), x, v, z, rates, memory)

    def _within(self, t: ArrayLike, index: Any) -> Any:
        """Times moved off the ends of their pieces where the drive may jump there, so that it answers for the right piece."""
        if not (machine_of(self.model).breaks or self._impulses):
            return t
        aside, nodes = 1e-12 * self.period_time, self.pieces.t
        return np.clip(t, nodes[index] + aside, np.maximum(nodes[index + 1] - aside, nodes[index] + aside))

    acceleration = _force_column("acceleration")
    friction_force = _force_column("friction_force")
    slip = _force_column("slip")
    load = _force_column("load")
    drive_force = _force_column("drive_force")
    xi = _force_column("xi")
    xi_rate = _force_column("xi_rate")
    xi_acceleration = _force_column("xi_acceleration")
    actuator_force = _force_column("actuator_force")
    actuator_power = _force_column("actuator_power")

    @explains_arguments
    def at(self, t: Numbers) -> dict[str, Any]:
        """Everything at any time of the run, from the dense output.

        Parameters
        ----------
        t : float or array
            Times within the run [s]. At an event the values after it are returned.

        Returns
        -------
        dict
            t, x, v, z, mode and all forces, each of the shape of `t` (z with a last axis if it has several states); for a machine of
            several bodies and contacts their axis follows.
        """
        shape, t, index = self._placed(t)
        x, v, z = self._states_at(t, index)
        every = {"x": x, "v": v, "mode": self.pieces.mode[index], **self._forces_at(t, index, x, v, z), "z": self._of_laws(z)}
        columns = {"t": t, **self._at_door(every)}
        return {name: None if column is None else column.reshape(shape + column.shape[1:])[()] for name, column in columns.items()}

    def _placed(self, t: Any) -> tuple[Any, Array, Array]:
        """The shape of some times, the times themselves and the pieces on which they lie; `InputError` for times outside of the run."""
        shape, t = np.shape(t), np.atleast_1d(np.asarray(t, float)).ravel()
        first, last = float(self.pieces.t[0]), float(self.pieces.t[-1])
        slack = 1e-12 * (last - first)
        if not np.all((t >= first - slack) & (t <= last + slack)):
            given, allowed = f"t reaches from {t.min():.9g} to {t.max():.9g} s", f"{first:.9g} to {last:.9g} s"
            raise InputError(f"{type(self).__name__}.at", [f"{given}; allowed is {allowed}, the time of the run"])
        t = np.clip(t, first, last)
        return shape, t, self._index(t)

    # ---- strobe ----
    @cached_property
    def strobe_times(self) -> NDArray[np.float64]:
        """The starts of the drive periods, k T [s], and the end of the last whole one."""
        count = int(float(self.pieces.t[-1] - self.pieces.t[0]) / self.period_time + 1e-9)
        return np.minimum(self.pieces.t[0] + np.arange(count + 1) * self.period_time, self.pieces.t[-1])

    @cached_property
    def _strobe(self) -> tuple[Any, Any, Any, Any]:
        """States and memories at the strobe times, after an impulse or a sample that falls on one."""
        t, nodes = self.strobe_times, self.pieces.t
        index = self._index(t + 1e-12 * self.period_time)
        x, v, z = self._states_at(np.maximum(t, nodes[index]), index)
        memory = np.array(self.pieces.memory[index])
        jump = sum(jump for time, jump in self._impulses if abs(time - t[-1]) < 1e-9 * self.period_time and t[-1] >= nodes[-1])
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
    def strobe_x(self) -> NDArray[np.float64]:
        """Position at the strobe times [m], shaped like `x`."""
        return self._own("x", self._strobe[0])

    @property
    def strobe_v(self) -> NDArray[np.float64]:
        """Velocity at the strobe times [m/s], after an impulse at that instant, shaped like `v`."""
        return self._own("v", self._strobe[1])

    @property
    def strobe_z(self) -> NDArray[np.float64] | None:
        """Inner state at the strobe times, shaped like `z`."""
        return self._own("z", self._of_laws(self._strobe[2]))

    @property
    def _strobe_inner(self) -> Any:
        """Inner states of laws and controllers at the strobe times (time, contact or controller, state)."""
        return self._strobe[2]

    @property
    def strobe_memory(self) -> NDArray[np.float64] | None:
        """Discrete memories of laws at the strobe times: (time,), or (time, memory) if there are several; None if none."""
        return _as_column(self._strobe[3])

    # ---- doors ----
    @cached_property
    def steadiness(self) -> Steadiness:
        """Whether its mean velocity is that of a steady motion, and how far from it that is."""
        return steadiness_of_run(self)

    @property
    def notes(self) -> list[str]:
        """Remarks on the machine's numbers, an early end, motion not settled, bodies that drift apart, and friction not determined."""
        remarks = (self._early_end, *machine_of(self.model).notes, self._settled, drifting_apart(self.with_axes), shared_at_rest(self))
        return [note for note in remarks if note]

    @property
    def _early_end(self) -> str:
        return f"the run was {self.status}; type run.shortened() for what analyses take" if self.interrupted else ""

    @property
    def _settled(self) -> str:
        if self.interrupted:
            return ""
        layout = self.pieces.layout
        if len(layout.bodies) != len(machine_of(self.model).mechanics.bodies):
            return f"whether a motion of {layout.description} has settled is not judged"
        return self.steadiness.note

    if not TYPE_CHECKING:  # a type checker would take every name for one of ours

        def __getattr__(self, name: str) -> Any:
            if name in dir(type(self)):
                return object.__getattribute__(self, name)  # raises its own error again
            hint = (
                f"type {_INSTEAD[name]}" if name in _INSTEAD else did_you_mean(name, [n for n in dir(type(self)) if not n.startswith("_")])
            )
            raise AttributeError(f"a run has no {name!r}" + ("" if name.startswith("_") else f"; {hint}"))

    def __repr__(self) -> str:
        seconds = f"{float(self.pieces.t[-1] - self.pieces.t[0]):.6g} s"
        length = seconds if self.model.period is None else f"{self.periods} periods of {self.period_time:.6g} s"
        notes = machine_of(self.model).notes
        mistaken = "".join(f"; {note}" for note in notes if note.startswith(MISTAKEN))
        mistaken += "".join(f"; {note.partition(';')[0]} (see run.notes)" for note in notes if note.startswith(LEVEL))
        words = self._moves
        moves = ", ".join(f"mean velocity {text}" if name == "mean velocity" else text for name, text in words.items())
        return f"<Trajectory: {length} by {self.method}, {self.status}{'; ' * bool(words)}{moves}{mistaken}>"

    @cached_property
    def _moves(self) -> dict[str, str]:
        """Mean velocity, motion and steadiness in words, as far as the run has them; the motion of a long run is not judged for it."""
        words: dict[str, str] = {}
        numbers = float(self.pieces.t[-1] - self.pieces.t[0]) / self._step * len(self.pieces.layout.bodies)
        with suppress(StickslipError):
            whole = " over the run" * (self.model.period is None)  # its transient included; `motion` has that of the cycle
            way = without_rounding(self.mean_velocity, self.model)
            words["mean velocity"] = f"{way:.6g} {unit_of_part('v', self.model, '')}{whole}"
            if numbers <= _AT_A_GLANCE:
                words["motion"] = self.motion.brief
            if self.model.period is not None:
                words["steadiness"] = self.steadiness.word
        return words

    _drawn_by = "velocity"

    def _facts(self) -> dict[str, Any]:
        length = f"{float(self.pieces.t[-1] - self.pieces.t[0]):.6g} s"
        periods = {} if self.model.period is None else {"periods": f"{self.periods} of {self.period_time:.6g} s ({self.settle} to settle)"}
        return {
            "machine": type(self.model).__name__,
            "method": self.method,
            "status": self.status,
            "length": length,
            **periods,
            **self._moves,
        }
