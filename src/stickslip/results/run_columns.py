"""What the columns of any run are computed from: its pieces, its model, and how many samples they have."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed

#: Samples of a run that has no period: this many times `samples` in all.
APERIODIC = 10


@sealed
@dataclass(frozen=True, eq=False)
class RunColumns(ABC):
    """Base of what a run's columns hold: `BodyColumns` of bodies and contacts, `StateColumns` of states that a model names itself.

    Which of them it is, the layout of the pieces says. A column that only the other one has is refused in words.
    """

    model: Any
    pieces: Any
    samples: int

    #: Name of the figure that draws the run.
    drawn_by = ""

    # ---- time ----
    @property
    def period_time(self) -> float:
        """Period T of the drive [s]; an error if the model has none."""
        if self.model.period is None:
            why = f"{type(self.model).__name__} has no period, so this run has neither period_time nor strobe points"
            raise InputError("Trajectory", [f"{why}; type run.at(t) for its state at times of your own"])
        return float(self.model.period)

    @property
    def step(self) -> float:
        """Time between the samples of the columns [s]."""
        if self.model.period is None:
            return float(self.pieces.t[-1] - self.pieces.t[0]) / (APERIODIC * self.samples)
        return self.period_time / self.samples

    @cached_property
    def strobe_times(self) -> Array:
        """The starts of the drive periods, k T [s], and the end of the last whole one."""
        count = int(float(self.pieces.t[-1] - self.pieces.t[0]) / self.period_time + 1e-9)
        times: Array = np.minimum(self.pieces.t[0] + np.arange(count + 1) * self.period_time, self.pieces.t[-1])
        return times

    def index(self, t: ArrayLike) -> Any:
        """The piece on which a time lies (the later one at a node)."""
        return np.clip(np.searchsorted(self.pieces.t, t, side="right") - 1, 0, len(self.pieces.mode) - 1)

    @property
    @abstractmethod
    def instants(self) -> tuple[Array, Array]:
        """The sampled times and the piece of each."""

    # ---- columns ----
    @property
    @abstractmethod
    def mode(self) -> Array:
        """Modes at the sampled times."""

    @abstractmethod
    def at(self, t: Array, index: Array) -> dict[str, Any]:
        """Every column but the time at times (time,) on given pieces."""

    @abstractmethod
    def states_at(self, t: ArrayLike, index: Any) -> tuple[Any, Any, Any]:
        """x and v (time, body) and z (time, contact or controller, state) at times on given pieces; `NoBodies` where there is no body."""

    @abstractmethod
    def contacts(self, run: Any) -> Mapping[str, Any]:
        """The columns of each contact of the run by its name."""

    @abstractmethod
    def state_named(self, name: str) -> Array:
        """The column of a state by the name that the model gives it; `InputError` where there is none of this name."""

    @abstractmethod
    def mean_velocity(self, run: Any) -> float:
        """Mean velocity of the run."""

    # ---- events ----
    @abstractmethod
    def events(self, run: Any) -> list[Any]:
        """What happened in the run, in order."""

    @abstractmethod
    def switch_times(self, run: Any, name: str) -> Array:
        """The instants of a switch by its name."""

    @abstractmethod
    def beside_switches(self, name: str) -> tuple[Array, Array]:
        """A state right before and right after each switch."""

    # ---- tables ----
    @property
    @abstractmethod
    def table(self) -> dict[str, Any]:
        """Every column by the name that it has in files, that of time first."""

    @property
    def dims(self) -> dict[str, list[str]]:
        """Names of the parts along the axes that columns have behind that of time, by dimension."""
        return {}

    @abstractmethod
    def dims_of(self, name: str) -> tuple[str, ...]:
        """The dimensions of a column of the table."""

    @property
    @abstractmethod
    def flat(self) -> dict[str, tuple[Any, str]]:
        """The columns of the table as columns of numbers (time,) with their units, by name."""

    @property
    @abstractmethod
    def head(self) -> list[tuple[str, str, str]]:
        """Heading, unit and meaning of each of these."""

    @abstractmethod
    def unit(self, name: str) -> str:
        """The unit of a column of the table; "" for none."""

    @abstractmethod
    def description(self, name: str) -> dict[str, str]:
        """Attributes of a column of the table: units, long name and symbol, as far as they are known."""

    @abstractmethod
    def about(self) -> dict[str, Any]:
        """The model, as attributes of a table."""

    # ---- words ----
    @abstractmethod
    def notes(self, run: Any) -> list[str]:
        """Remarks on the run."""

    @abstractmethod
    def words(self, run: Any) -> str:
        """The run in a line."""

    @abstractmethod
    def facts(self, run: Any) -> dict[str, Any]:
        """What a notebook shows of it."""

    @abstractmethod
    def lacking(self, name: str) -> AttributeError:
        """What is raised for a column that it does not have."""

    def __getattr__(self, name: str) -> Any:
        if name in dir(type(self)):
            return object.__getattribute__(self, name)  # raises its own error again
        raise AttributeError(name) if name.startswith("__") else self.lacking(name)
