"""The result of one run of a switching flow: states, modes, switches and dense output."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Numbers, described_as, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, NoBodies, did_you_mean
from stickslip.basics.frozen_arrays import sealed
from stickslip.models.flow_contacts import ContactColumns, contact_columns, modes_passed
from stickslip.results.datasets import FileColumns
from stickslip.results.flow_drift import mean_rates
from stickslip.results.flow_pieces import ModeChange, extremes
from stickslip.results.storage import save_flow_run
from stickslip.results.trajectory import APERIODIC, Trajectory

NO_BODIES = (
    "allowed is a run of a machine, and this one is that of a flow, which has states of its own and no bodies; type run[name] for a state, "
    "run.strobe for its strobe points"
)
_OF_A_CONTACT = ("slip", "load", "friction_force")  # columns of files, with the contact's name behind


@described_as("a run of a SwitchingFlow; type for example ss.solve(flow, start=[1.0, 0.0], duration=5.0)")
@sealed
@dataclass(frozen=True, eq=False)
class FlowRun(Trajectory):
    """One run of a switching flow, made by `solve`: a `Trajectory` of states instead of bodies.

    ``run[name]`` is the column of a state over the instants `t`, ``run.y`` all of them, ``run.mode`` the mode at these instants.
    ``run.state`` and ``run.end_mode`` are where it ends, after a switch at that instant.

    Parameters
    ----------
    model : SwitchingFlow
    pieces : FlowPieces
        The dense output.
    periods : int, optional
        Periods of the forcing; None of a run that was given a duration.
    settle, rtol, method, status, samples, start, provenance, counts
        As of a `Trajectory`: "exact" by Taylor steps of the compiled engine, which are exact to rounding; under laws with inner
        states "Rodas5P", whose steps hold a relative tolerance of 1e-9.

    Examples
    --------
    >>> import stickslip as ss
    >>> hit = ss.Switch(lambda t, y: y[0], 0, lambda t, y: (0.0, -0.8 * y[1]))
    >>> ball = ss.SwitchingFlow({0: lambda t, y: (y[1], -9.81)}, {0: (hit,)}, states=("height", "v"))
    >>> run = ss.solve(ball, start={"height": 1.0}, duration=1.0)
    >>> run.method, round(run.events[0].t, 6), round(float(run.at(0.7)["height"]), 6), round(float(run.highest[0]), 6)
    ('exact', 0.451524, 0.577653, 1.0)
    """

    periods: Any

    # ---- steps ----
    @property
    def nodes(self) -> Array:
        """Ends of the steps (n + 1,)."""
        return self.pieces.t

    @property
    def modes(self) -> Array:
        """The mode of each step (n,), as its place among the flow's modes."""
        return self.pieces.mode

    @property
    def coefficients(self) -> Array:
        """Polynomials of the states in (t - start of the step) / (its length), lowest power first."""
        return self.pieces.coefficients

    @property
    def passed(self) -> Array:
        """States between two switches at the same instant."""
        return self.pieces.passed

    @property
    def events(self) -> list[ModeChange]:  # type: ignore[override]
        """The switches in order: t, before and after."""
        return self.pieces.switches

    @property
    def state(self) -> Array:
        """The state at the end, after a switch at that instant."""
        return self.pieces.end

    @property
    def end_mode(self) -> Any:
        """The mode at the end, after a switch at that instant."""
        return self.pieces.end_mode

    @property
    def strobe_state(self) -> Array:
        """The end as analyses take a state of a flow: the state, with the place of its mode behind."""
        return np.append(self.state, list(self.model.modes).index(self.end_mode))

    # ---- columns ----
    @property
    def names(self) -> tuple[str, ...]:
        """The names of the states."""
        return tuple(self.model.names(self.coefficients.shape[1]))

    @cached_property
    def _instants(self) -> tuple[Array, Array]:
        """The sampled times with the piece of each; each event appears twice, before and after."""
        first, last = float(self.nodes[0]), float(self.nodes[-1])
        T = self.model.period
        count = APERIODIC * self.samples if T is None else max(int(np.ceil((last - first) / T * self.samples)), 1)
        grid = np.linspace(first, last, count + 1)
        at = np.flatnonzero(np.isin(self.nodes[1:-1], [event.t for event in self.events])) + 1
        t = np.concatenate([grid, self.nodes[at], self.nodes[at]])
        index = np.concatenate([self._index(grid), at - 1, at])
        order = np.lexsort((index, t))
        return t[order], index[order]

    def _states_at(self, t: Any, index: Any) -> tuple[Any, Any, Any]:
        """There is no body of which to give a position: `NoBodies`."""
        raise NoBodies("FlowRun", [NO_BODIES])

    def _beside_switches(self, name: str) -> tuple[Array, Array]:
        i = self.names.index(name)
        at = np.flatnonzero(np.isin(self.nodes[1:-1], [event.t for event in self.events]))
        return self.coefficients[at, i].sum(axis=-1), self.coefficients[at + 1, i, 0]

    def _switch_times(self, name: str) -> Array:
        before, after = (dict(zip(self.model.modes, of, strict=True)) for of in modes_passed(self.model, name))
        return np.array([event.t for event in self.events if before[event.before] and after[event.after]])

    @cached_property
    def y(self) -> Array:
        """The states (time, state)."""
        return self.pieces.states(*self._instants)

    @cached_property
    def mode(self) -> Array:
        """The mode at the times of the columns."""
        return self._labels(self._instants[1])

    @property
    def mode_at(self) -> Array:
        """The same as `mode`."""
        return self.mode

    @cached_property
    def contacts(self) -> Mapping[str, ContactColumns]:  # type: ignore[override]
        """Slip, load, friction force and mode of each contact at the times of the columns, by its name."""
        t, index = self._instants
        return contact_columns(self.model, t, self.y, self.modes[index])

    def __getitem__(self, name: str) -> Array:
        if name not in self.names:
            raise InputError("FlowRun", [f"{name!r} is not a state of the flow; {did_you_mean(str(name), self.names)}"])
        return self.y[:, self.names.index(name)]

    def modes_of(self, pieces: Array) -> list[Any]:
        """The modes of some steps of the run, by their names."""
        return list(self._labels(pieces).tolist())

    def _labels(self, index: Array) -> Array:
        known = list(self.model.modes)
        labels = np.empty(len(known), object)
        labels[:] = known
        plain = np.array(known) if len({type(mode) for mode in known}) == 1 and not isinstance(known[0], tuple) else labels
        return plain[self.modes[index]]

    @explains_arguments
    def at(self, t: Numbers) -> dict[str, Any]:
        """The states and the mode at any time of the run, from the dense output.

        Parameters
        ----------
        t : float or array
            Times within the run. At a switch the values after it are returned.

        Returns
        -------
        dict
            t, mode, each state by its name, and slip, load and friction force of each contact with its name behind, as
            "friction_force_belt"; each of the shape of `t`.
        """
        shape, t, index = self._placed(t)
        y = self.pieces.states(t, index)
        columns = {"t": t, "mode": self._labels(index), **{name: y[:, i] for i, name in enumerate(self.names)}}
        if self.model.contacts:
            rubbing = contact_columns(self.model, t, y, self.modes[index])
            columns |= {f"{what}_{name}": getattr(contact, what) for name, contact in rubbing.items() for what in _OF_A_CONTACT}
        return {name: column.reshape(shape)[()] for name, column in columns.items()}

    # ---- extremes and strobe ----
    @cached_property
    def _extremes(self) -> tuple[Array, Array]:
        return extremes(self.coefficients, np.vstack([self.passed, self.state]))

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
        y = self.pieces.states(t, self._index(t))
        if t[-1] >= self.nodes[-1]:
            y[-1] = self.state
        return y

    # ---- doors ----
    @property
    def notes(self) -> list[str]:
        """Remarks on the run: an early end, and why another method replaced the compiled engine."""
        early = [f"the run was {self.status}"] if self.interrupted else []
        return [*early, *([f"{self.method}: {self.provenance['why']}"] if self.provenance.get("why") else [])]

    @cached_property
    def mean_rates(self) -> dict[str, float]:
        """Mean rate of each cyclic coordinate, by name, over whole motion periods after settling (of all the run without a period)."""
        return mean_rates(self)

    @property
    def mean_velocity(self) -> float:
        """Mean rate of the first cyclic coordinate; `NoBodies` of a flow without one, which has no displacement."""
        if not self.model.cyclic:
            raise NoBodies("mean_velocity", [f"{NO_BODIES}, or ss.SwitchingFlow(..., cyclic='x') to say which state is a displacement"])
        return next(iter(self.mean_rates.values()))

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name in dir(type(self)):
                return object.__getattribute__(self, name)  # raises its own error again
            raise AttributeError(f"the run of a flow has no {name!r}")

    def to_xarray(self) -> Any:
        """The columns as an `xarray.Dataset` over time."""
        import xarray as xr

        columns: dict[str, Any] = {name: ("time", self.y[:, i]) for i, name in enumerate(self.names)}
        columns |= {f"{what}_{name}": ("time", getattr(c, what)) for name, c in self.contacts.items() for what in _OF_A_CONTACT}
        columns["mode"] = ("time", np.array([str(mode) for mode in self.mode]) if self.mode.dtype == object else self.mode)
        numbers = {name: float(value) for name, value in self.model.numbers.items()}
        marks = {"named_events": json.dumps([[e.t, e.part, e.before, e.after] for e in self.named_events])} if self.named_events else {}
        return xr.Dataset(columns, {"time": self.t}, {"method": self.method, "status": self.status, **numbers, **marks})

    def to_dataframe(self) -> Any:
        """The columns as a `pandas.DataFrame` over time."""
        return self.to_xarray().to_dataframe()

    def _table(self) -> FileColumns:
        """The columns as files hold them; states have no unit."""
        data = self.to_xarray()
        columns = {"time": self.t, **{str(name): data[name].values for name in data.data_vars}}
        meanings = {"time": "time", "mode": "mode of the flow"}
        head = [(name, "", meanings.get(name, "state of the flow")) for name in columns]
        return FileColumns(columns, dict.fromkeys(columns, "1"), {}, head, list(columns.values()), dict(data.attrs))

    @explains_arguments
    def save(self, path: str | Path) -> Path:
        """Write the run to a netCDF4 file (.nc), or its columns to .csv, .xlsx or .mat; returns its path.

        The functions of a flow are Python code, which cannot be stored in a file: ``ss.load(path, machines=[flow])`` reads the run back
        with the flow. An existing file is replaced in a single step at the end.
        """
        return save_flow_run(self, path)

    _drawn_by = "states"

    def _facts(self) -> dict[str, Any]:
        length = f"{float(self.nodes[-1] - self.nodes[0]):.6g}"
        return {"method": self.method, "status": self.status, "length": length, "switches": len(self.events)}

    def __repr__(self) -> str:
        length = f"{float(self.nodes[-1] - self.nodes[0]):.6g}"
        return f"<FlowRun: {', '.join(self.names)} over {length} by {self.method}, {len(self.events)} switches, {self.status}>"
