"""The result of one run of a switching flow: states, modes, switches and dense output."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial.polynomial import polyval

from stickslip.basics.arguments import Numbers, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, did_you_mean
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.notebook_display import Drawn
from stickslip.basics.status import INTERRUPTED
from stickslip.models.flow_contacts import ContactColumns, contact_columns
from stickslip.results.datasets import FileColumns
from stickslip.results.run_files import RunFiles
from stickslip.results.storage import save_table

_OF_A_CONTACT = ("slip", "load", "friction_force")  # columns of files, with the contact's name behind
_LOOKS = 33  # samples of a polynomial on one step, from which its extremes are refined
_FREE = 10  # instants of a run without a period, in units of `samples`


class ModeChange(NamedTuple):
    """A switch: its time, and the modes before and after it."""

    t: float
    before: Any
    after: Any


@sealed
@dataclass(frozen=True, eq=False)
class FlowRun(RunFiles, Drawn):
    """One run of a switching flow, made by `solve`. ``run[name]`` is the column of a state over the instants `t`.

    Parameters
    ----------
    model : SwitchingFlow
    nodes : array (n + 1,)
        Ends of the steps.
    modes : array (n,) of int
        The mode of each step, as its position in `model.fields`.
    coefficients : array
        Polynomials of the states in (t - start of the step) / (its length), lowest power first.
    passed : array
        States between two switches at the same instant.
    events : list of ModeChange
        The switches in order; t, before and after.
    method : str
        "exact" by Taylor steps of the compiled engine, "dop853" by SciPy's integrator on plain Python.
    state, mode
        Final state and mode, after a switch at that instant.
    periods : int, optional
        Periods of the forcing.
    samples : int
        Instants per period in the columns; without a period, the run has ten times as many in all.

    Examples
    --------
    >>> import stickslip as ss
    >>> hit = ss.Switch(lambda t, y: y[0], 0, lambda t, y: (0.0, -0.8 * y[1]))
    >>> ball = ss.SwitchingFlow({0: lambda t, y: (y[1], -9.81)}, {0: (hit,)}, states=("height", "v"))
    >>> run = ss.solve(ball, start={"height": 1.0}, duration=1.0)
    >>> run.method, round(run.events[0].t, 6), round(float(run.at(0.7)["height"]), 6), round(float(run.highest[0]), 6)
    ('exact', 0.451524, 0.577653, 1.0)
    """

    model: Any
    nodes: Array
    modes: Array
    coefficients: Array
    passed: Array
    events: list[ModeChange]
    method: str
    state: Array
    mode: Any
    periods: int | None = None
    settle: int = 0
    status: str = "finished"
    samples: int = 400
    start: dict[str, Any] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)
    counts: dict[str, Any] = field(default_factory=dict)

    # ---- columns ----
    @property
    def names(self) -> tuple[str, ...]:
        """The names of the states."""
        return tuple(self.model.names(self.coefficients.shape[1]))

    @cached_property
    def _instants(self) -> tuple[Array, Array]:
        """The sampled times with the piece of each; each event appears twice, before and after."""
        first, last = float(self.nodes[0]), float(self.nodes[-1])
        count = (
            _FREE * self.samples if self.model.period is None else max(int(np.ceil((last - first) / self.model.period * self.samples)), 1)
        )
        grid = np.linspace(first, last, count + 1)
        at = np.flatnonzero(np.isin(self.nodes[1:-1], [event.t for event in self.events])) + 1
        t = np.concatenate([grid, self.nodes[at], self.nodes[at]])
        index = np.concatenate([self._index(grid), at - 1, at])
        order = np.lexsort((index, t))
        return t[order], index[order]

    def _index(self, t: Array) -> Array:
        """The piece on which a time lies (the later one at a node)."""
        return np.clip(np.searchsorted(self.nodes, t, side="right") - 1, 0, len(self.modes) - 1)

    @property
    def t(self) -> Array:
        """Times of the columns: evenly spaced, and every switch twice."""
        return self._instants[0]

    @cached_property
    def y(self) -> Array:
        """The states (time, state)."""
        return self._evaluated(*self._instants)

    @cached_property
    def mode_at(self) -> Array:
        """The mode at the times of the columns."""
        return self._labels(self._instants[1])

    @cached_property
    def contacts(self) -> Mapping[str, ContactColumns]:
        """Slip, load, friction force and mode of each contact at the times of the columns, by its name."""
        t, index = self._instants
        return contact_columns(self.model, t, self.y, self.modes[index])

    def __getitem__(self, name: str) -> Array:
        if name not in self.names:
            raise InputError("FlowRun", [f"{name!r} is not a state of the flow; {did_you_mean(str(name), self.names)}"])
        return self.y[:, self.names.index(name)]

    def _evaluated(self, t: Array, index: Array) -> Array:
        start = self.nodes[index]
        return polynomials(self.coefficients[index], (t - start) / (self.nodes[index + 1] - start))

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
            t, mode, and each state by its name, each of the shape of `t`.
        """
        shape, t = np.shape(t), np.atleast_1d(np.asarray(t, float)).ravel()
        first, last = float(self.nodes[0]), float(self.nodes[-1])
        slack = 1e-12 * (last - first)
        if not np.all((t >= first - slack) & (t <= last + slack)):
            raise InputError(
                "FlowRun.at", [f"t reaches from {t.min():.9g} to {t.max():.9g}; allowed is {first:.9g} to {last:.9g}, the time of the run"]
            )
        t = np.clip(t, first, last)
        index = self._index(t)
        y = self._evaluated(t, index)
        columns = {"t": t, "mode": self._labels(index), **{name: y[:, i] for i, name in enumerate(self.names)}}
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

    @property
    def strobe_times(self) -> Array:
        """The starts of the periods of the forcing, and the end of the last whole one."""
        if self.model.period is None:
            raise InputError(
                "FlowRun", ["the flow has no period, so its run has no strobe points; type run.at(t) for its state at times of your own"]
            )
        T, first, last = float(self.model.period), float(self.nodes[0]), float(self.nodes[-1])
        return np.minimum(first + np.arange(int((last - first) / T + 1e-9) + 1) * T, last)

    @cached_property
    def strobe(self) -> Array:
        """The states at the strobe times (strobe, state), after a switch that falls there."""
        t = self.strobe_times
        y = self._evaluated(t, self._index(t))
        if t[-1] >= self.nodes[-1]:
            y[-1] = self.state
        return y

    # ---- doors ----
    @property
    def notes(self) -> list[str]:
        """Remarks on the run: an early end, and why another method replaced the compiled engine."""
        early = [f"the run was {self.status}"] if self.interrupted else []
        return [*early, *([f"{self.method}: {self.provenance['why']}"] if self.provenance.get("why") else [])]

    def __getattr__(self, name: str) -> Any:
        if name in ("mean_velocity", "motion"):
            raise AttributeError(
                f"the run of a flow has no {name}: a flow has no bodies; type run[name] for a state, run.strobe for its strobe points"
            )
        raise AttributeError(f"the run of a flow has no {name!r}")

    @property
    def interrupted(self) -> bool:
        """Whether the run was interrupted before its end: `status` says when."""
        return self.status.startswith(INTERRUPTED)

    def to_xarray(self) -> Any:
        """The columns as an `xarray.Dataset` over time."""
        import xarray as xr

        columns: dict[str, Any] = {name: ("time", self.y[:, i]) for i, name in enumerate(self.names)}
        columns |= {f"{what}_{name}": ("time", getattr(c, what)) for name, c in self.contacts.items() for what in _OF_A_CONTACT}
        columns["mode"] = ("time", np.array([str(mode) for mode in self.mode_at]) if self.mode_at.dtype == object else self.mode_at)
        numbers = {name: float(value) for name, value in self.model.numbers.items()}
        return xr.Dataset(columns, {"time": self.t}, {"method": self.method, "status": self.status, **numbers})

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
        """Write the columns to a netCDF4 file (.nc), .csv, .xlsx or .mat; returns its path.

        The columns can be read back, but not the run: the functions of a flow are Python code, which cannot be stored in a file.
        An existing file is replaced in a single step at the end.
        """
        return save_table(self, path, "run of a flow", "run")

    _drawn_by = "states"

    def _facts(self) -> dict[str, Any]:
        length = f"{float(self.nodes[-1] - self.nodes[0]):.6g}"
        return {"method": self.method, "status": self.status, "length": length, "switches": len(self.events)}

    def __repr__(self) -> str:
        length = f"{float(self.nodes[-1] - self.nodes[0]):.6g}"
        return f"<FlowRun: {', '.join(self.names)} over {length} by {self.method}, {len(self.events)} switches, {self.status}>"


def polynomials(coefficients: Array, theta: Array) -> Array:
    """Values (pieces, states) of polynomials (pieces, states, powers) at one point of each piece."""
    value: Array = polyval(theta[:, None], np.moveaxis(coefficients, -1, 0), tensor=False)
    return value


def extremes(coefficients: Array, states: Array) -> tuple[Array, Array]:
    """The smallest and the largest value of each state over all pieces, including interior extremes, and over some additional states.

    Examples
    --------
    >>> low, high = extremes(np.array([[[0.0, 1.0, -1.0]]]), np.zeros((1, 1)))  # t - t^2
    >>> float(low[0]), float(high[0])
    (0.0, 0.25)
    """
    powers, looks = np.arange(coefficients.shape[2]), np.linspace(0.0, 1.0, _LOOKS)
    slope = coefficients[..., 1:] * powers[1:]
    curve = slope[..., 1:] * powers[1:-1]
    rates = slope @ looks[None, :] ** powers[:-1, None]
    rises = rates > 0.0
    piece, state, k = np.nonzero(rises[..., :-1] != rises[..., 1:])  # an extremum between two samples
    before, after = rates[piece, state, k], rates[piece, state, k + 1]
    theta = looks[k] + before / (before - after) / (_LOOKS - 1)
    own, slope, curve = (c[piece, state] for c in (coefficients, slope, curve))
    for _ in range(4):
        power = theta[:, None] ** powers
        d, dd = (slope * power[:, :-1]).sum(axis=1), (curve * power[:, :-2]).sum(axis=1)
        theta = np.clip(theta - d / np.where(dd == 0.0, np.inf, dd), looks[k], looks[k + 1])
    turns = (own * theta[:, None] ** powers).sum(axis=1)
    ends = np.concatenate([coefficients[..., 0], coefficients.sum(axis=-1), states])
    low, high = ends.min(axis=0), ends.max(axis=0)
    np.minimum.at(low, state, turns)
    np.maximum.at(high, state, turns)
    return low, high
