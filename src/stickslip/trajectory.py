"""What happened in one run: every column, every event, and the dense output behind them."""

from __future__ import annotations

import html
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from stickslip import forces
from stickslip.arguments import Numbers, explains_arguments
from stickslip.errors import InputError
from stickslip.friction.adapter import law_of
from stickslip.machine import machine_of
from stickslip.pieces import Event, HarmonicArcs, Pieces, PolynomialPieces, events_of, inner_rates, nodes_at
from stickslip.sealing import sealed
from stickslip.steadiness import Steadiness, of_run
from stickslip.summary import STATUS, Summary
from stickslip.variables import VARIABLES

#: Samples of a run that has no period: this many times `samples` in all.
APERIODIC = 10

__all__ = ["STATUS", "Event", "HarmonicArcs", "Pieces", "PolynomialPieces", "Summary", "Trajectory"]


def _as_column(z: Any) -> Any:
    return None if z.shape[1] == 0 else z[:, 0] if z.shape[1] == 1 else z


def _force_column(name: str) -> property:
    variable = VARIABLES[name]

    def column(self: Any) -> Any:
        if name not in self._forces:
            raise AttributeError(f"this run has no {name}: {type(self.model).__name__} has no drive")
        return self._forces[name]

    return property(column, doc=f"{variable.long_name[0].upper()}{variable.long_name[1:]} [{variable.unit}].")


@sealed
@dataclass(frozen=True, eq=False)
class Trajectory:
    """One run of one robot or mechanism. It is computed once by `solve`; everything here only reads it.

    The columns ``t, x, v, z, mode, acceleration, friction_force, drive_force, xi, xi_rate, xi_acceleration,
    actuator_force, actuator_power`` are arrays over the same instants: `samples` in each drive period (ten times `samples`
    over the whole run where the model has no period) and, exactly, every event (twice where v jumps). Units and meanings
    stand in `stickslip.variables`. Columns from ``drive_force`` on exist where there is a drive.

    Parameters
    ----------
    model : Robot or a mechanism
        What was solved.
    pieces : Pieces
        The dense output.
    periods, settle : int
        Drive periods run, and how many of them the mean velocity leaves out.
    rtol : float
        Relative tolerance of the run.
    method : str
        Name of the solver.
    status : str
        A sentence that says how the run ended.
    samples : int
        Instants per drive period in the columns, a tenth of all instants where there is no period.
    start : dict
        The state it started from.
    provenance : dict
        Versions and settings that make the run again.
    counts : dict
        Steps taken, rejected, and so on.
    known_period : int, optional
        Drive periods after which it repeats, where that is known beforehand: the run of a periodic orbit.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=1e-3, law="coulomb")
    >>> arcs = HarmonicArcs(np.array([0.0, robot.period]), np.array([0]), np.zeros(1), np.zeros(1), 1.0, robot.drive.omega, 2.0, 2.0)
    >>> run = Trajectory(robot, arcs, periods=1, settle=0, rtol=1e-6, method="by hand")
    >>> run.t.size, run.events, float(run.at(0.01)["v"])
    (401, [], 0.0)
    """

    model: Any
    pieces: Any
    periods: int
    settle: int
    rtol: float
    method: str
    status: str = STATUS[0]
    samples: int = 400
    start: dict[str, Any] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)
    counts: dict[str, Any] = field(default_factory=dict)
    known_period: int | None = None

    # ---- time ----
    @property
    def period_time(self) -> float:
        """Period T of the drive [s]; an error where the model has none."""
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
        return self.status == STATUS[6]

    @cached_property
    def events(self) -> list[Event]:
        """Every change of mode, impulse and switch of a memory, in order. Under a dynamic law changes of mode are reversals of v."""
        return events_of(self.pieces, [t for t, _ in self._impulses], self.lost_contact)

    @cached_property
    def _impulses(self) -> list[tuple[float, float]]:
        return forces.impulses_until(self.model, float(self.pieces.t[-1]))

    @cached_property
    def _instants(self) -> tuple[Any, Any]:
        """The sampled times and the piece of each; an event at which v jumps stands there with both its pieces."""
        nodes, step = self.pieces.t, self._step
        grid = np.arange(max(int(np.ceil((nodes[-1] - nodes[0]) / step - 1e-6)), 1) + 1) * step + nodes[0]
        grid[-1] = nodes[-1]
        changes = np.flatnonzero(np.diff(self.pieces.mode)) + 1
        changes = np.union1d(changes, nodes_at(self.pieces, [t for t, _ in self._impulses])).astype(int)
        events = nodes[changes]
        if len(events):
            after = np.minimum(np.searchsorted(events, grid), len(events) - 1)
            near = np.minimum(abs(grid - events[after]), abs(grid - events[np.maximum(after - 1, 0)]))
            grid = grid[near > 1e-12 * step * self.samples]
        jumps = changes[self._jumps(changes)]
        t = np.concatenate([grid, nodes[jumps], events])
        index = np.concatenate([self._index(grid), jumps - 1, changes])
        order = np.lexsort((index, t))
        return t[order], index[order]

    def _jumps(self, changes: Any) -> Any:
        before, after = (self.pieces.evaluate(self.pieces.t[changes], index)[1] for index in (changes - 1, changes))
        return abs(after - before) > 1e-6 * self.model.velocity_scale

    def _index(self, t: Any) -> Any:
        """The piece on which a time lies (the later one at a node)."""
        return np.clip(np.searchsorted(self.pieces.t, t, side="right") - 1, 0, len(self.pieces.mode) - 1)

    # ---- columns ----
    @property
    def t(self) -> Any:
        """Times of the columns [s]."""
        return self._instants[0]

    @cached_property
    def _states(self) -> tuple[Any, Any, Any]:
        return self.pieces.evaluate(*self._instants)

    @property
    def x(self) -> Any:
        """Position of the body [m]."""
        return self._states[0]

    @property
    def v(self) -> Any:
        """Velocity of the body [m/s]."""
        return self._states[1]

    @property
    def z(self) -> Any:
        """Inner state of the law: (n,) if it has one, (n, states) if more, None if it has none."""
        return _as_column(self._states[2])

    @cached_property
    def mode(self) -> Any:
        """+1 forwards, 0 stuck, -1 backwards (dynamic laws: the sign of v at the contact)."""
        return np.asarray(self.pieces.mode)[self._instants[1]]

    @cached_property
    def _forces(self) -> dict[str, Any]:
        return self._forces_at(*self._instants, *self._states)

    def _forces_at(self, t: Any, index: Any, x: Any, v: Any, z: Any) -> dict[str, Any]:
        rates = inner_rates(self.pieces, t, index)
        memory = tuple(self.pieces.memory[index].T) if hasattr(self.pieces, "memory") else ()
        return forces.columns(self.model, np.asarray(self.pieces.mode)[index], self._within(t, index), x, v, z.T, rates.T, memory)

    def _within(self, t: Any, index: Any) -> Any:
        """Times moved off the ends of their pieces where the drive may jump there, so that it answers for the right piece."""
        if not (machine_of(self.model).breaks or self._impulses):
            return t
        aside, nodes = 1e-12 * self.period_time, self.pieces.t
        return np.clip(t, nodes[index] + aside, np.maximum(nodes[index + 1] - aside, nodes[index] + aside))

    acceleration = _force_column("acceleration")
    friction_force = _force_column("friction_force")
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
            Times within the run [s]. At an event the later piece counts.

        Returns
        -------
        dict
            t, x, v, z, mode and all forces, each of the shape of `t` (z with a last axis if it has several states).
        """
        shape, t = np.shape(t), np.atleast_1d(np.asarray(t, float)).ravel()
        first, last = float(self.pieces.t[0]), float(self.pieces.t[-1])
        slack = 1e-12 * (last - first)
        if not np.all((t >= first - slack) & (t <= last + slack)):
            given, allowed = f"t reaches from {t.min():.9g} to {t.max():.9g} s", f"{first:.9g} to {last:.9g} s"
            raise InputError("Trajectory.at", [f"{given}; allowed is {allowed}, the time of the run"])
        t = np.clip(t, first, last)
        index = self._index(t)
        x, v, z = self.pieces.evaluate(t, index)
        found = {"t": t, "x": x, "v": v, "mode": np.asarray(self.pieces.mode)[index], **self._forces_at(t, index, x, v, z)}
        inner = {"z": None if z.shape[1] == 0 else z.reshape(shape + (() if z.shape[1] == 1 else z.shape[1:]))}
        return {name: column.reshape(shape)[()] for name, column in found.items()} | inner

    # ---- strobe ----
    @cached_property
    def strobe_times(self) -> Any:
        """The starts of the drive periods, k T [s], and the end of the last whole one."""
        count = int(float(self.pieces.t[-1] - self.pieces.t[0]) / self.period_time + 1e-9)
        return np.minimum(self.pieces.t[0] + np.arange(count + 1) * self.period_time, self.pieces.t[-1])

    @cached_property
    def _strobe(self) -> tuple[Any, Any, Any, Any]:
        """States and memories at the strobe times, after an impulse that falls on one."""
        t, nodes = self.strobe_times, self.pieces.t
        index = self._index(t + 1e-12 * self.period_time)
        x, v, z = self.pieces.evaluate(np.maximum(t, nodes[index]), index)
        memory = np.array(self.pieces.memory[index]) if hasattr(self.pieces, "memory") else np.empty((len(t), 0), int)
        jump = sum(jump for time, jump in self._impulses if abs(time - t[-1]) < 1e-9 * self.period_time and t[-1] >= nodes[-1])
        slip = float(self.model.contact_velocity(float(v[-1])))
        if memory.shape[1] and slip * (slip + jump) < 0:
            load = forces.normal_load(self.model, float(t[-1]), float(x[-1]))
            z[-1], memory[-1] = law_of(self.model).passed_zero(tuple(map(float, z[-1])), load, tuple(map(int, memory[-1])))
        v[-1] += jump
        return x, v, z, memory

    @property
    def strobe_x(self) -> Any:
        """Position at the strobe times [m]."""
        return self._strobe[0]

    @property
    def strobe_v(self) -> Any:
        """Velocity at the strobe times [m/s], after an impulse at that instant."""
        return self._strobe[1]

    @property
    def strobe_z(self) -> Any:
        """Inner state at the strobe times, shaped like `z`."""
        return _as_column(self._strobe[2])

    @property
    def strobe_memory(self) -> Any:
        """Whole numbers that the law remembers, at the strobe times, shaped like `z`; None where it remembers none."""
        return _as_column(self._strobe[3])

    # ---- doors ----
    @cached_property
    def steadiness(self) -> Steadiness:
        """Whether its mean velocity is that of a steady motion, and how far from it that is."""
        return of_run(self)

    @property
    def notes(self) -> list[str]:
        """Remarks on the robot's numbers, and on a motion that has not settled."""
        return [*machine_of(self.model).notes, *([self.steadiness.note] if self.steadiness.note else [])]

    def to_xarray(self) -> Any:
        """The columns as an `xarray.Dataset` over time, with units, names and provenance."""
        from stickslip.datasets import trajectory_dataset

        return trajectory_dataset(self)

    @explains_arguments
    def to_mat(self, path: str | Path) -> Path:
        """Write the columns to a MATLAB file; returns its path."""
        from stickslip.storage import to_mat

        return to_mat(self, path)

    @explains_arguments
    def save(self, path: str | Path) -> Path:
        """Write the run to a netCDF4 file (.nc) that `stickslip.load` reads back, or its columns to .csv or .mat; returns its path."""
        from stickslip.storage import save

        return save(self, path)

    def __repr__(self) -> str:
        seconds = f"{float(self.pieces.t[-1] - self.pieces.t[0]):.6g} s"
        length = seconds if self.model.period is None else f"{self.periods} periods of {self.period_time:.6g} s"
        return f"<Trajectory: {length} by {self.method}, {self.status}>"

    def _repr_html_(self) -> str:
        rows = {"method": self.method, "status": self.status, "periods": f"{self.periods} ({self.settle} to settle)", "rtol": self.rtol}
        cells = "".join(f"<tr><td>{k}</td><td>{html.escape(str(v))}</td></tr>" for k, v in {**rows, **self.counts}.items())
        return f"<table><caption>Trajectory</caption>{cells}</table>{self.model._repr_html_()}"
