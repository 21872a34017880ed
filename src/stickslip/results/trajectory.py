"""The result of one run: every column, every event, and the dense output."""

from __future__ import annotations

from collections.abc import Mapping
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
from stickslip.basics.presenting import presenter
from stickslip.basics.status import INTERRUPTED, Status
from stickslip.basics.variables import VARIABLES
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.machine_adapter import machine_of
from stickslip.models.rounding import without_rounding
from stickslip.results.body_columns import BodyColumns
from stickslip.results.part_runs import BodyRun, ControllerRun, PlacedBodyRun
from stickslip.results.run_columns import RunColumns
from stickslip.results.run_files import RunFiles
from stickslip.results.state_columns import StateColumns
from stickslip.results.steadiness import Steadiness, steadiness_of_run

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from stickslip.results.events import Event

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
    **{name: f"run.pieces.{name}, of a flow" for name in ("coefficients", "passed")},
    "modes": "run.pieces.mode for the mode of each step, by its place, or run.mode for that at run.t",
}


class _Column(property):
    """A property that is a column, of which type checkers know that it is an array."""

    if TYPE_CHECKING:

        def __get__(self, run: Trajectory, of: type | None = None) -> NDArray[np.float64]: ...  # type: ignore[override]


def _column(name: str, about: str) -> _Column:
    """A column of the run's own columns."""

    def column(self: Any) -> Any:
        return getattr(self._columns, name)

    column.__doc__ = about  # given as doc=, that of the class hides it
    return _Column(column)


def _force(name: str) -> _Column:
    variable = VARIABLES[name]
    return _column(name, f"{variable.long_name[0].upper()}{variable.long_name[1:]} [{variable.unit}].")


@described_as("a Trajectory; type for example ss.solve(robot)")
@sealed
@dataclass(frozen=True, eq=False)
class Trajectory(Drawn, RunFiles):
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

    A `SwitchingFlow` names its states itself and has no bodies: ``run[name]`` is the column of a state, ``run.y`` all of them, ``run.mode``
    the mode by its name, ``run.events`` the switches (t, before, after), and ``run.contacts[name]`` has slip, load, friction force and mode
    of a contact. ``run.state`` and ``run.end_mode`` are where it ends, after a switch at that instant. Their units are those of the flow.

    Parameters
    ----------
    model : Robot, a mechanism, a machine of several bodies, or SwitchingFlow
        What was solved.
    pieces : DensePieces
        The dense output, which says what the columns hold: those of bodies and contacts, or of states by their names.
    periods, settle : int
        Drive periods simulated, as many as a duration begins (1 without a period), and how many of them the mean velocity excludes.
    rtol : float
        Relative tolerance of the run; of a flow that of its steps, 0 where they are exact to rounding.
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

    The run of a flow:

    >>> hit = ss.Switch(lambda t, y: y[0], 0, lambda t, y: (0.0, -0.8 * y[1]))
    >>> ball = ss.SwitchingFlow({0: lambda t, y: (y[1], -9.81)}, {0: (hit,)}, states=("height", "v"))
    >>> run = ss.solve(ball, start={"height": 1.0}, duration=1.0)
    >>> run.method, round(run.events[0].t, 6), round(float(run.at(0.7)["height"]), 6), round(float(run.highest[0]), 6)
    ('exact', 0.451524, 0.577653, 1.0)
    """

    model: Any
    pieces: Any
    periods: Any
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
    @cached_property
    def _columns(self) -> Any:
        """What its columns hold: those of bodies and contacts, or, of a run without bodies, of states by their names."""
        kind: type[RunColumns] = BodyColumns if self.pieces.layout.bodies else StateColumns
        return kind(self.model, self.pieces, self.samples)

    @property
    def period_time(self) -> float:
        """Period T of the drive [s]; an error if the model has none."""
        return float(self._columns.period_time)

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
    def events(self) -> list[Any]:
        """Every change of mode, impulse, switch of a memory, hit on a stop, take-off and landing, and the named events, in order.

        Under a dynamic law modes change where v reverses. At one instant there is one for each contact that changed, in the order of
        `contacts`, after hits and landings. Of a flow these are its switches: t, and the modes before and after.
        """
        return list(self._columns.events(self))

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
        times: Array = self._columns.switch_times(self, name)
        return times

    @property
    def nodes(self) -> NDArray[np.float64]:
        """Times between which every state is smooth: the ends of the pieces [s]."""
        return self.pieces.nodes

    def _index(self, t: ArrayLike) -> Any:
        """The piece on which a time lies (the later one at a node)."""
        return self._columns.index(t)

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

    def _states_at(self, t: ArrayLike, index: Any) -> tuple[Any, Any, Any]:
        """x and v (time, body) and z (time, contact or controller, state) at times on given pieces; `NoBodies` of the run of a flow."""
        states: tuple[Any, Any, Any] = self._columns.states_at(t, index)
        return states

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
    def contacts(self) -> Mapping[str, Any]:
        """The columns of each contact by its name."""
        contacts: Mapping[str, Any] = self._columns.contacts(self)
        return contacts

    @property
    def controllers(self) -> dict[str, ControllerRun]:
        """The columns of each controller by its name; none of a machine without."""
        return {part.name: ControllerRun(self.with_axes, i) for i, part in enumerate(self.pieces.layout.controllers)}

    # ---- columns ----
    @property
    def t(self) -> NDArray[np.float64]:
        """Times of the columns [s]."""
        times: NDArray[np.float64] = self._columns.instants[0]
        return times

    @property
    def _held(self) -> Any:
        """Inner states of laws and controllers (time, contact or controller, state)."""
        return self._columns.states[2]

    x = _column("x", "Position of the body [m]; (time, body) for several bodies.")
    v = _column("v", "Velocity of the body [m/s]; (time, body) for several bodies.")

    @property
    def z(self) -> NDArray[np.float64] | None:
        """Inner state of the law: (time,) if it has one, (time, state) if more, None if it has none; (time, contact, state) of several."""
        z: NDArray[np.float64] | None = self._columns.z
        return z

    @property
    def mode(self) -> Any:
        """+1 forwards, 0 stuck, -1 backwards (dynamic laws: the sign of v at the contact); (time, contact) of several; a flow's by name."""
        return self._columns.mode

    acceleration = _force("acceleration")
    friction_force = _force("friction_force")
    slip = _force("slip")
    load = _force("load")
    drive_force = _force("drive_force")
    xi = _force("xi")
    xi_rate = _force("xi_rate")
    xi_acceleration = _force("xi_acceleration")
    actuator_force = _force("actuator_force")
    actuator_power = _force("actuator_power")

    # ---- states that the model names itself ----
    @property
    def names(self) -> tuple[str, ...]:
        """The names of a flow's states."""
        names: tuple[str, ...] = self._columns.names
        return names

    y = _column("y", "A flow's states (time, state).")
    lowest = _column("lowest", "The smallest value of each state of a flow (state,), also between the steps.")
    highest = _column("highest", "The largest value of each state of a flow (state,), also between the steps.")
    strobe = _column("strobe", "A flow's states at the strobe times (strobe, state), after a switch that falls there.")
    state = _column("state", "A flow's state at the end (state,), after a switch at that instant.")
    strobe_state = _column("strobe_state", "The same as analyses take it, with the place of its mode behind.")

    @property
    def end_mode(self) -> Any:
        """A flow's mode at the end, after a switch at that instant."""
        return self._columns.end_mode

    @property
    def mode_at(self) -> Any:
        """The same as `mode`."""
        return self.mode

    @property
    def mean_velocity(self) -> float:
        """Mean steady velocity [m/s], that of ``ss.mean_velocity(run)``.

        Of several bodies it is that of their centre of mass, of a flow the mean rate of its first cyclic coordinate; a flow without one
        has no displacement, and the attribute is missing.
        """
        velocity: float = self._columns.mean_velocity(self)
        return velocity

    @cached_property
    def motion(self) -> Any:
        """The motion at its end, that of ``ss.motion(run)``, which takes other thresholds."""
        return presenter("number", "motion")(self)

    @cached_property
    def mean_rates(self) -> dict[str, float]:
        """Mean rate of each cyclic coordinate of a flow, by name, over whole motion periods after settling (else over all of the run)."""
        return dict(self._columns.mean_rates(self))

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        column: NDArray[np.float64] = self._columns.state_named(name)
        return column

    __iter__ = None  # a run is no sequence, though it has states by name

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
            several bodies and contacts their axis follows. For a flow t, mode, each state by its name, and slip, load and friction force
            of each contact with its name behind, as "friction_force_belt".
        """
        shape, t, index = self._placed(t)
        columns = {"t": t, **self._columns.at(t, index)}
        return {name: None if column is None else column.reshape(shape + column.shape[1:])[()] for name, column in columns.items()}

    def _placed(self, t: Any) -> tuple[Any, Array, Array]:
        """The shape of some times, the times themselves and the pieces on which they lie; `InputError` for times outside of the run."""
        shape, t = np.shape(t), np.atleast_1d(np.asarray(t, float)).ravel()
        first, last = float(self.pieces.t[0]), float(self.pieces.t[-1])
        slack = 1e-12 * (last - first)
        if not np.all((t >= first - slack) & (t <= last + slack)):
            given, allowed = f"t reaches from {t.min():.9g} to {t.max():.9g} s", f"{first:.9g} to {last:.9g} s"
            raise InputError("Trajectory.at", [f"{given}; allowed is {allowed}, the time of the run"])
        t = np.clip(t, first, last)
        return shape, t, self._index(t)

    # ---- strobe ----
    @property
    def strobe_times(self) -> NDArray[np.float64]:
        """The starts of the drive periods, k T [s], and the end of the last whole one."""
        times: NDArray[np.float64] = self._columns.strobe_times
        return times

    @property
    def _strobe(self) -> tuple[Any, Any, Any, Any]:
        """States and memories at the strobe times, after an impulse or a sample that falls on one."""
        points: tuple[Any, Any, Any, Any] = self._columns.strobe_points
        return points

    @property
    def _strobe_inner(self) -> Any:
        """Inner states of laws and controllers at the strobe times (time, contact or controller, state)."""
        return self._strobe[2]

    strobe_x = _column("strobe_x", "Position at the strobe times [m], shaped like `x`.")
    strobe_v = _column("strobe_v", "Velocity at the strobe times [m/s], after an impulse at that instant, shaped like `v`.")

    @property
    def strobe_z(self) -> NDArray[np.float64] | None:
        """Inner state at the strobe times, shaped like `z`."""
        z: NDArray[np.float64] | None = self._columns.strobe_z
        return z

    @property
    def strobe_memory(self) -> NDArray[np.float64] | None:
        """Discrete memories of laws at the strobe times: (time,), or (time, memory) if there are several; None if none."""
        memory: NDArray[np.float64] | None = self._columns.strobe_memory
        return memory

    # ---- doors ----
    @cached_property
    def steadiness(self) -> Steadiness:
        """Whether its mean velocity is that of a steady motion, and how far from it that is."""
        return steadiness_of_run(self)

    @property
    def notes(self) -> list[str]:
        """Remarks on the machine's numbers, an early end, motion not settled, bodies that drift apart, and friction not determined."""
        return list(self._columns.notes(self))

    if not TYPE_CHECKING:  # a type checker would take every name for one of ours

        def __getattr__(self, name: str) -> Any:
            if name in dir(type(self)):
                return object.__getattribute__(self, name)  # raises its own error again
            hint = (
                f"type {_INSTEAD[name]}" if name in _INSTEAD else did_you_mean(name, [n for n in dir(type(self)) if not n.startswith("_")])
            )
            raise AttributeError(f"a run has no {name!r}" + ("" if name.startswith("_") else f"; {hint}"))

    def __repr__(self) -> str:
        return f"<Trajectory: {self._columns.words(self)}>"

    @cached_property
    def _moves(self) -> dict[str, str]:
        """Mean velocity, motion and steadiness in words, as far as the run has them; the motion of a long run is not judged for it."""
        words: dict[str, str] = {}
        numbers = float(self.pieces.t[-1] - self.pieces.t[0]) / self._columns.step * len(self.pieces.layout.bodies)
        with suppress(StickslipError):
            whole = " over the run" * (self.model.period is None)  # its transient included; `motion` has that of the cycle
            way = without_rounding(self.mean_velocity, self.model)
            words["mean velocity"] = f"{way:.6g} {unit_of_part('v', self.model, '')}{whole}"
            if numbers <= _AT_A_GLANCE:
                words["motion"] = self.motion.brief
            if self.model.period is not None:
                words["steadiness"] = self.steadiness.word
        return words

    @property
    def _drawn_by(self) -> str:  # type: ignore[override]
        return str(self._columns.drawn_by)

    def _facts(self) -> dict[str, Any]:
        return dict(self._columns.facts(self))
