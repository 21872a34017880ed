"""The columns of a run whose model names its states itself, such as that of a flow: states, modes, contacts and strobe points."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError, NoBodies, did_you_mean
from stickslip.basics.frozen_arrays import sealed
from stickslip.models.flow_contacts import ContactColumns, contact_columns, modes_passed
from stickslip.results.flow_drift import NO_BODIES, drift_velocity, mean_rates
from stickslip.results.flow_pieces import ModeChange, extremes
from stickslip.results.run_columns import APERIODIC, RunColumns

_OF_A_CONTACT = ("slip", "load", "friction_force")  # columns of files, with the contact's name behind


@sealed
class StateColumns(RunColumns):
    """The columns of a run of a flow: its states by their names, the modes by theirs, and its contacts.

    Examples
    --------
    >>> import stickslip as ss
    >>> fall = ss.SwitchingFlow(lambda t, y: (y[1], -10.0), states=("h", "v"))
    >>> run = ss.solve(fall, start={"h": 5.0}, duration=1.0)
    >>> StateColumns(run.model, run.pieces, 4).y[-1].tolist()
    [0.0, -10.0]
    """

    drawn_by = "states"

    # ---- time ----
    @cached_property
    def instants(self) -> tuple[Array, Array]:
        """The sampled times with the piece of each; each event appears twice, before and after."""
        nodes = self.pieces.t
        first, last = float(nodes[0]), float(nodes[-1])
        T = self.model.period
        count = APERIODIC * self.samples if T is None else max(int(np.ceil((last - first) / T * self.samples)), 1)
        grid = np.linspace(first, last, count + 1)
        at = self._at_switches + 1
        t = np.concatenate([grid, nodes[at], nodes[at]])
        index = np.concatenate([self.index(grid), at - 1, at])
        order = np.lexsort((index, t))
        return t[order], index[order]

    @property
    def _at_switches(self) -> Array:
        """Numbers of the pieces that end with a switch."""
        return np.flatnonzero(np.isin(self.pieces.t[1:-1], self.pieces.switch_times))

    # ---- events ----
    def events(self, run: Any) -> list[ModeChange]:
        """The switches in order: t, before and after."""
        return self.switches

    @cached_property
    def switches(self) -> list[ModeChange]:
        """The same."""
        modes, pieces = list(self.model.modes), self.pieces
        pairs = zip(pieces.switch_times.tolist(), pieces.switch_modes.tolist(), strict=True)
        return [ModeChange(t, modes[before], modes[after]) for t, (before, after) in pairs]

    def switch_times(self, run: Any, name: str) -> Array:
        """The instants of a switch by its name, such as "free to hunted"."""
        before, after = (dict(zip(self.model.modes, of, strict=True)) for of in modes_passed(self.model, name))
        return np.array([event.t for event in self.switches if before[event.before] and after[event.after]])

    def beside_switches(self, name: str) -> tuple[Array, Array]:
        """A state right before and right after each switch."""
        i, at, c = self.names.index(name), self._at_switches, self.pieces.coefficients
        return c[at, i].sum(axis=-1), c[at + 1, i, 0]

    # ---- columns ----
    @property
    def names(self) -> tuple[str, ...]:
        """The names of the states."""
        return tuple(self.model.names(self.pieces.coefficients.shape[1]))

    @cached_property
    def y(self) -> Array:
        """The states (time, state)."""
        return self.pieces.states(*self.instants)

    def state_named(self, name: str) -> Array:
        """The column of a state."""
        if name not in self.names:
            raise InputError("Trajectory", [f"{name!r} is not a state of the flow; {did_you_mean(str(name), self.names)}"])
        return self.y[:, self.names.index(name)]

    @cached_property
    def mode(self) -> Array:
        """The modes at the sampled times, by their names."""
        return self.labels(self.instants[1])

    def labels(self, index: Array) -> Array:
        """The modes on some pieces, by their names."""
        known = list(self.model.modes)
        labels = np.empty(len(known), object)
        labels[:] = known
        plain = np.array(known) if len({type(mode) for mode in known}) == 1 and not isinstance(known[0], tuple) else labels
        named: Array = plain[self.pieces.mode[index]]
        return named

    @cached_property
    def _contacts(self) -> Mapping[str, ContactColumns]:
        t, index = self.instants
        return contact_columns(self.model, t, self.y, self.pieces.mode[index])

    def contacts(self, run: Any) -> Mapping[str, ContactColumns]:
        """Slip, load, friction force and mode of each contact at the sampled times, by its name."""
        return self._contacts

    def states_at(self, t: ArrayLike, index: Any) -> tuple[Any, Any, Any]:
        """There is no body of which to give a position: `NoBodies`."""
        raise self.lacking("position")

    def at(self, t: Array, index: Array) -> dict[str, Any]:
        """The mode, each state by its name, and slip, load and friction force of each contact, with its name behind."""
        y = self.pieces.states(t, index)
        columns = {"mode": self.labels(index), **{name: y[:, i] for i, name in enumerate(self.names)}}
        rubbing = contact_columns(self.model, t, y, self.pieces.mode[index]) if self.model.contacts else {}
        return columns | _of_contacts(rubbing)

    # ---- extremes, strobe and end ----
    @cached_property
    def _extremes(self) -> tuple[Array, Array]:
        return extremes(self.pieces.coefficients, np.vstack([self.pieces.passed, self.pieces.end]))

    @property
    def lowest(self) -> Array:
        """The smallest value of each state, also between the steps."""
        return self._extremes[0]

    @property
    def highest(self) -> Array:
        """The largest value of each state, also between the steps."""
        return self._extremes[1]

    @cached_property
    def strobe(self) -> Array:
        """The states at the strobe times (strobe, state), after a switch that falls there."""
        t = self.strobe_times
        y: Array = self.pieces.states(t, self.index(t))
        if t[-1] >= self.pieces.t[-1]:
            y[-1] = self.pieces.end
        return y

    @property
    def state(self) -> Array:
        """The state at the end, after a switch at that instant."""
        end: Array = self.pieces.end
        return end

    @property
    def end_mode(self) -> Any:
        """The mode there."""
        return list(self.model.modes)[self.pieces.end_mode]

    @property
    def strobe_state(self) -> Array:
        """The end as analyses take a state of a flow: the state, with the place of its mode behind."""
        return np.append(self.state, self.pieces.end_mode)

    def mean_rates(self, run: Any) -> dict[str, float]:
        """Mean rate of each cyclic coordinate, by name."""
        return mean_rates(run)

    # ---- tables ----
    @cached_property
    def table(self) -> dict[str, Any]:
        """Time, states, contacts and modes by the names that files give them; modes of several kinds as words."""
        states = {name: self.y[:, i] for i, name in enumerate(self.names)}
        mode = np.array([str(mode) for mode in self.mode]) if self.mode.dtype == object else self.mode
        return {"time": self.instants[0], **states, **_of_contacts(self._contacts), "mode": mode}

    def dims_of(self, name: str) -> tuple[str, ...]:
        """Every column is one over time."""
        return ("time",)

    @property
    def flat(self) -> dict[str, tuple[Any, str]]:
        """The same columns; states have no units."""
        return {name: (column, "") for name, column in self.table.items()}

    @property
    def head(self) -> list[tuple[str, str, str]]:
        """Heading and meaning of each."""
        meanings = {"time": "time", "mode": "mode of the flow"}
        return [(name, "", meanings.get(name, "state of the flow")) for name in self.table]

    def unit(self, name: str) -> str:
        """A flow's states have no units."""
        return ""

    def description(self, name: str) -> dict[str, str]:
        """Nothing is known of a state but its name."""
        return {}

    def about(self) -> dict[str, Any]:
        """The flow's numbers."""
        return {name: float(value) for name, value in self.model.numbers.items()}

    # ---- words ----
    def notes(self, run: Any) -> list[str]:
        """Remarks on the run: an early end, and why another method replaced the compiled engine."""
        early = [f"the run was {run.status}"] if run.interrupted else []
        return [*early, *([f"{run.method}: {run.provenance['why']}"] if run.provenance.get("why") else [])]

    def words(self, run: Any) -> str:
        """States, length, method, how many switches there were, and status."""
        length = f"{float(self.pieces.t[-1] - self.pieces.t[0]):.6g}"
        return f"{', '.join(self.names)} over {length} by {run.method}, {len(self.pieces.switch_times)} switches, {run.status}"

    def facts(self, run: Any) -> dict[str, Any]:
        """How it was solved, how long it is, and how often it switches."""
        length = f"{float(self.pieces.t[-1] - self.pieces.t[0]):.6g}"
        return {"method": run.method, "status": run.status, "length": length, "switches": len(self.pieces.switch_times)}

    def mean_velocity(self, run: Any) -> float:
        """Mean rate of the first cyclic coordinate; `NoBodies` of a flow without one."""
        return drift_velocity(run)

    def lacking(self, name: str) -> AttributeError:
        """A flow has no bodies."""
        return NoBodies("Trajectory", [NO_BODIES])


def _of_contacts(rubbing: Mapping[str, ContactColumns]) -> dict[str, Array]:
    """Slip, load and friction force of each contact, by the names that they have among the states."""
    return {f"{what}_{name}": getattr(contact, what) for name, contact in rubbing.items() for what in _OF_A_CONTACT}
