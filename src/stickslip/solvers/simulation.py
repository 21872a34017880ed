"""A machine that goes on step by step, in a loop of its user's: inputs between the steps, events within them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError
from stickslip.basics.status import ENDS, Status
from stickslip.engine.held_lane import Image
from stickslip.models.crossings import Crossing
from stickslip.models.model_adapter import adapter_of
from stickslip.results.named_events import found_events
from stickslip.solvers.held_bodies import check_one_machine
from stickslip.solvers.held_cases import HeldCase
from stickslip.solvers.held_flows import FlowCase
from stickslip.solvers.held_machines import MachineCase
from stickslip.solvers.held_rows import RowCase
from stickslip.solvers.methods import LocalSteps
from stickslip.solvers.moments import Kept, Moment, after_step, changes_in, end_of, first_moment
from stickslip.solvers.named_events import events_of_model


@dataclass(frozen=True)
class Snapshot:
    """A simulation at an instant, in memory: what `Simulation.restore` takes."""

    image: Image
    moment: Moment
    of: object

    @property
    def t(self) -> float:
        """The instant [s]."""
        return self.moment.t


class Simulation:
    """A machine, or a switching flow, that goes on step by step; `stickslip.simulation` makes it.

    Attributes
    ----------
    machine : Robot or machine, or SwitchingFlow
        With the numbers that it has now, applied forces left out.
    method : str
        "exact", or the name of the steps of a dynamic law.
    now : Moment
        All that it is, of which a step makes another one.
    made_with : dict
        The inputs with which it was made.

    Examples
    --------
    >>> import stickslip as ss
    >>> joint = ss.Joint(inertia=0.01, friction=ss.Coulomb(0.02, 0.02, f_plus=0.03, f_minus=0.03), torque=0.0)
    >>> sim = ss.simulation(joint)
    >>> for torque in (0.02, 0.04):
    ...     state = sim.step(0.1, inputs={"torque on joint": torque})
    ...     print(f"{state['v']:.9f}", [event.kind for event in sim.events])
    0.000000000 []
    0.200000000 ['slip']
    """

    def __init__(
        self,
        case: HeldCase,
        record: bool = False,
        moment: Moment | None = None,
        made_with: dict[str, float] | None = None,
        events: Mapping[str, Crossing] | None = None,
    ):
        self._watched = {} if events is None else events
        self.now, self._record, self._own = first_moment(case) if moment is None else moment, record, object()
        self.made_with = case.numbers() if made_with is None else made_with

    # ---- what it is ----
    @property
    def machine(self) -> Any:
        """The machine or the flow with the numbers that it has now."""
        return self.now.case.changed(self.now.inputs).machine

    @property
    def method(self) -> str:
        """Name of the solver."""
        return self.now.case.method

    @property
    def t(self) -> float:
        """Time [s]: where the last step has come to."""
        return self.now.t

    @property
    def inputs(self) -> dict[str, float]:
        """All that may be given as inputs, as it is now: numbers of the machine by their names, and forces on its bodies."""
        now = self.now
        return {
            name: now.inputs.get(number, value)
            for (name, number), value in zip(now.case.names.items(), now.case.numbers().values(), strict=True)
        }

    @property
    def status(self) -> str:
        """How the last step ended: "finished" at its end or at an event; else why it could not be made, and `t` is where it has come to."""
        return self.now.sentence or Status.FINISHED.sentence

    @property
    def state(self) -> dict[str, Any]:
        """t [s], x [m], v [m/s], mode and z as `Trajectory.at` has them; of a flow t, its states by their names, and its mode."""
        now = self.now
        return now.case.state(now.side, now.t)

    @property
    def parts(self) -> dict[str, dict[str, Any]]:
        """x and v of each body, mode and z of each contact, the states of each controller, by the names of the parts."""
        now = self.now
        return now.case.parts(now.side, now.t)

    @property
    def start(self) -> dict[str, Any]:
        """The state as `solve` and `simulation` take it, ``start=sim.start``."""
        now = self.now
        return now.case.start(now.side, now.t)

    @property
    def events(self) -> list[Any]:
        """What happened in the last step, with exact instants: a list of `Event`, of a flow of `ModeChange`, and events of the user.

        What happens at the end of a step belongs to that step, and what a jump of an input does at once to the step that begins with it.
        """
        last = self.now.last
        if last is None:
            return []
        events = [*last.early, *(last.case.events(last.before, last.rows, last.after) if len(last.rows) else ())]
        return sorted(events, key=lambda event: event.t) if self._watched else events

    @property
    def columns(self) -> dict[str, Any]:
        """Every column at the present instant, forces too, as `Trajectory.at` gives them; at a jump the values after it.

        They are those of the motion that follows with the present inputs, which is looked at and not made.

        Raises
        ------
        InputError
            If no motion follows, as where a contact is lost.
        """
        now = self.now
        rows = now.lane.ahead(now.side, now.case.budget(1.0))
        if rows is not None:
            run = now.case.changed(now.inputs).run(rows, {"samples": 4})
            return dict(run.at(run.pieces.t[0])) | {"t": now.t}
        raise InputError("columns", [f"no motion follows from t = {now.t:.9g} s: {self.status}; type sim.state for the state there"])

    # ---- on ----
    def step(
        self, dt: float | None = None, inputs: dict[str, float] | None = None, *, until: float | None = None, stop_at_events: bool = False
    ) -> dict[str, Any]:
        """Go on by `dt`, or to a time, under constant inputs.

        Within the step the motion is that of `solve`: events at their exact instants, whatever the length of the step.

        Parameters
        ----------
        dt : float
            Length of the step [s].
        inputs : dict of float, optional
            Numbers that change at its beginning, by the names in `inputs`; they stay until they are given again. Positions, velocities and
            inner states do not jump, and whether a contact sticks or slips is decided anew, as at an impulse.
        until : float, optional
            Where it ends [s], instead of `dt`.
        stop_at_events : bool
            Whether it ends at the first event after its beginning; `t` says where that is.

        Returns
        -------
        dict
            `state` at its end.

        Raises
        ------
        InputError
            For an input that is not known or not allowed, or a length that is no time; the simulation is as it was.

        Notes
        -----
        A step that cannot be made raises nothing: `status` says why, and `t` and `state` where it has come to. Ctrl-C within a step raises
        KeyboardInterrupt and leaves the simulation as it was before the step.
        """
        now = self.now
        end = end_of(now.t, dt, until)
        given = {} if inputs is None else changes_in(now, inputs)
        if now.status in ENDS:
            return self.state
        moment = after_step(now if self._record else now._replace(kept=None), end, dt, given, stop_at_events, self._record or self._watches)
        moment = self._with_named(moment, now.kept) if self._watches else moment
        self.now = moment  # all at once: Ctrl-C comes before or after it
        return moment.case.state(moment.side, moment.t)

    @property
    def _watches(self) -> bool:
        return bool(self._watched)

    def _with_named(self, moment: Moment, since: Kept | None) -> Moment:
        """A moment after a step that knows where functions of the user passed zero in it."""
        own, kept = list[Any](), moment.kept
        while kept is not None and not (self._record and kept is since):
            own = [*found_events(kept.case.run(kept.rows, {"samples": 4}), self._watched), *own]
            kept = kept.before
        if moment.last is not None and own:
            moment = moment._replace(last=moment.last._replace(early=(*moment.last.early, *own)))
        return moment if self._record else moment._replace(kept=None)

    # ---- what is kept ----
    def snapshot(self) -> Snapshot:
        """The simulation as it is now, in memory; `restore` takes it back there, and what follows is the same to the last bit."""
        return Snapshot(self.now.side.image, self.now, self._own)

    def restore(self, snapshot: Snapshot) -> None:
        """Take the simulation back to where a snapshot was taken of it.

        Raises
        ------
        InputError
            For a snapshot of another simulation.
        """
        if not isinstance(snapshot, Snapshot) or snapshot.of is not self._own:
            raise InputError("restore", ["allowed is a snapshot of this simulation; type before = sim.snapshot() and sim.restore(before)"])
        before = snapshot.moment
        now = self.now.side if self.now.lane is before.lane else before.lane.first
        self.now = before._replace(side=before.lane.draft_of(snapshot.image, now))

    def trajectories(self) -> list[Any]:
        """What happened so far, if it is recorded: a `Trajectory` for each stretch of constant inputs, in order.

        Raises
        ------
        InputError
            If nothing is recorded.
        """
        if not self._record:
            raise InputError("trajectories", ["nothing is recorded; type ss.simulation(machine, record=True)"])
        stretches: list[list[Kept]] = []
        kept = self.now.kept
        while kept is not None:
            if stretches and kept.case.is_as(stretches[-1][-1].case):
                stretches[-1].append(kept)
            else:
                stretches.append([kept])
            kept = kept.before
        return [each[0].case.run(np.concatenate([part.rows for part in reversed(each)]), {}) for each in reversed(stretches)]

    def save(self, path: str | Path) -> Path:
        """Write the simulation to a file (.json), from which `Simulation.load` makes it again; returns the path.

        What follows there is the same to the last bit, with the same version of stickslip on the same kind of machine; with another
        version it is the same to rounding, or to the tolerance of a dynamic law.
        """
        from stickslip.solvers.simulation_files import save

        return save(self, path)

    @classmethod
    def load(cls, path: str | Path, machine: Any = None, events: dict[str, Any] | None = None) -> Simulation:
        """The simulation that `save` wrote.

        Parameters
        ----------
        path : str or Path
        machine : Robot or machine, or SwitchingFlow, optional
            The machine that was given to `simulation`; needed where a file cannot hold it, as with a flow or a class of your own.
        events : dict, optional
            As for `simulation`: functions are in no file.

        Raises
        ------
        InputError
            If the file is not one of these, is damaged, or is that of another machine.
        """
        from stickslip.solvers.simulation_files import load

        loaded = load(path, machine)
        loaded._watched = _watched(loaded.machine, events)
        return loaded

    def __repr__(self) -> str:
        return f"<Simulation: {type(self.machine).__name__} at t = {self.t:.9g} s by {self.method}, {self.status}>"


@explains_arguments
def simulation(
    machine: Model,
    start: dict[str, Any] | None = None,
    *,
    rtol: float = 1e-6,
    method: str = "auto",
    mode: Any = None,
    record: bool = False,
    events: dict[str, Any] | None = None,
) -> Simulation:
    r"""A machine that goes on step by step, for a loop of your own.

    Parameters
    ----------
    machine : Robot or a mechanism, a machine of several bodies, or a SwitchingFlow
        One case. A machine that only SciPy solves is refused.
    start : dict, optional
        As for `solve`; also `Simulation.start` of another one.
    rtol : float
        Relative tolerance for dynamic laws, 1e-3 to 1e-12. Steps of set-valued laws and of flows are exact to rounding.
    method : str
        "auto", "exact", "taylor", or a Rosenbrock method of `METHODS`.
    mode : optional
        The first mode of a flow; if not given it follows from the state.
    record : bool
        Whether its motion is kept (`Simulation.trajectories`); else the memory that it needs does not grow.
    events : dict, optional
        Events of your own by name, as for `solve`; each step says which were in it. None of them is terminal.

    Returns
    -------
    Simulation

    Raises
    ------
    InputError
        All errors of the arguments, reported together.

    Notes
    -----
    The first one of a kind of machine compiles its kernel, once; steps compile nothing.

    Examples
    --------
    A controller in Python on a joint with stiction:

    >>> import stickslip as ss
    >>> joint = ss.Joint(inertia=0.01, friction=ss.Coulomb(0.02, 0.02, f_plus=0.03, f_minus=0.03), torque=0.0)
    >>> sim, error, integral = ss.simulation(joint), 0.5, 0.0
    >>> for _ in range(2000):
    ...     integral += 1e-3 * error
    ...     state = sim.step(1e-3, inputs={"torque on joint": 2.0 * error + 1.0 * integral - 0.1 * sim.state["v"]})
    ...     error = 0.5 - state["x"]
    >>> round(sim.t, 9), abs(error) < 0.03
    (2.0, True)
    """
    case = case_of(machine, start, rtol, method, mode)
    return Simulation(case, record, events=_watched(machine, events))


def _watched(machine: Any, events: Any) -> dict[str, Crossing]:
    """Events of the user; `InputError` where one would end a run."""
    watched = events_of_model("simulation", machine, events)
    if ending := [name for name, each in watched.items() if each.terminal]:
        how = 'leave "ends" out, and end your loop where sim.events has it'
        raise InputError("simulation", [f"events[{ending[0]!r}] is terminal; allowed are events that end nothing; {how}"])
    return watched


def case_of(machine: Any, start: Any, rtol: float, method: str, mode: Any) -> Any:
    """What a simulation follows; `InputError` for what is wrong with the arguments."""
    bodies = adapter_of(machine).has_bodies
    if mode is not None and bodies:
        raise InputError("simulation", [f"mode = {mode!r} is for a SwitchingFlow; leave it out: modes of contacts follow from start"])
    try:
        if not bodies:
            return FlowCase(machine, start, method, mode)
        check_one_machine(machine, "simulation")
        goes_locally = method in LocalSteps.names and LocalSteps().accepts(machine) is None
        return (RowCase if goes_locally else MachineCase)(machine, start, rtol, method)
    except InputError as error:
        raise InputError("simulation", error.problems) from None
