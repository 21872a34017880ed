"""The result of a batch: one number for each case and column, without trajectories."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stickslip.basics.errors import did_you_mean
from stickslip.basics.frozen_arrays import seal, sealed
from stickslip.basics.notebook_display import Drawn
from stickslip.basics.status import Status, code_counts
from stickslip.basics.variables import VARIABLES
from stickslip.models.mechanics import declares_parts
from stickslip.results.batch_files import BatchFiles
from stickslip.results.part_notes import notes_of_cases
from stickslip.results.steadiness import IRREGULAR, STEADINESS, UNSETTLED, unsettled_note

_RESTLESS = (STEADINESS[UNSETTLED], STEADINESS[IRREGULAR])


class Columns(Mapping[str, Any]):
    """Columns by name, of which each is computed when it is read for the first time.

    Examples
    --------
    >>> columns = Columns({"mean_velocity": lambda: np.array([1e-3]), "margin": lambda: 1 / 0})
    >>> columns["mean_velocity"].tolist(), list(columns)
    ([0.001], ['mean_velocity', 'margin'])
    """

    def __init__(self, made: dict[str, Callable[[], Any]]):
        self._made, self._computed = made, dict[str, Any]()

    def __getitem__(self, name: str) -> Any:
        if name not in self._computed:
            self._computed[name] = seal(self._made[name]())
        return self._computed[name]

    def __contains__(self, name: object) -> bool:
        return name in self._made

    def __iter__(self) -> Iterator[str]:
        return iter(self._made)

    def __len__(self) -> int:
        return len(self._made)

    def __repr__(self) -> str:
        return repr(dict(self))

    def __reduce__(self) -> Any:  # copies, and what is pickled, have the numbers
        return dict, (dict(self),)


@sealed
@dataclass(frozen=True, eq=False, repr=False)
class Summary(Drawn, BatchFiles):
    """Results of a batch; each column is an attribute with the shape of the batch.

    Parameters
    ----------
    model : Robot
        The batch that was solved.
    labels : batch.Labels
        Its shape, and the names of its dimensions.
    columns : mapping of arrays
        mean_velocity [m/s], motion_type, pattern, direction, period, margin, stick_fraction, forward_fraction,
        backward_fraction, velocity_max [m/s], velocity_min [m/s] (over the last motion period; over the window of the mean velocity
        where that is not steady), friction_power [W], steadiness (a code: `STEADINESS` has its words), settling_error [m/s], status,
        displacement [m], periods_run.
        Of a machine that lists its bodies, those that are of a body have a last axis for the bodies and those of a contact one for the
        contacts, in the machine's order; and there are body_velocity and body_displacement (bodies), slip_max and slip_min (contacts),
        hits, impulse_max [N s] and stop_force_max [N] (stops).
    provenance : dict
        Versions and settings that make the batch again.
    failures : dict
        Of the first cases that ended before their time, by index, a sentence with the instant, the contact, its slip velocity and why.

    Examples
    --------
    >>> from stickslip.basics.batch import Labels
    >>> many = Summary(None, Labels((2,)), {"mean_velocity": np.array([1e-3, 2e-3]), "status": np.array([0, 2])})
    >>> many.mean_velocity.tolist(), many.status_counts
    ([0.001, 0.002], {'finished': 1, 'step budget used up': 1})
    """

    model: Any
    labels: Any
    columns: Mapping[str, Any]
    provenance: dict[str, Any] = field(default_factory=dict)
    failures: dict[tuple[int, ...], str] = field(default_factory=dict)

    def __getattr__(self, name: str) -> Any:
        columns = self.__dict__.get("columns", {})
        if name in columns:
            return np.asarray(columns[name])
        if name == "motion":
            raise AttributeError(
                "a batch has no motion as a whole; type many.motion_type, many.pattern or many.margin for those of its cases"
            )
        model, known = self.__dict__.get("model"), VARIABLES.get(name)
        if known is not None and known.dims in ((), ("stop",)) and declares_parts(model):  # machines of parts have not all columns
            kind = type(model).__name__
            why = f"of stops, and this {kind} has none" if known.dims else f"of one body on one contact, and a {kind} lists several"
            raise AttributeError(f"Summary has no {name!r}: it is {why}; there are {', '.join(columns)}")
        raise AttributeError(f"Summary has no {name!r}" + ("" if name.startswith("_") else f"; {did_you_mean(name, columns)}"))

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.columns]

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch."""
        return self.labels.shape

    @property
    def interrupted(self) -> bool:
        """Whether the batch was interrupted before all its cases were solved: their status is "not computed"."""
        return bool(np.any(np.asarray(self.columns.get("status", 0)) == Status.NOT_COMPUTED))

    @property
    def status_counts(self) -> dict[str, int]:
        """How many cases ended with each sentence."""
        return code_counts(self.columns["status"])

    @property
    def steadiness_counts(self) -> dict[str, int]:
        """How many cases are steady, have not settled, or do not repeat."""
        return code_counts(self.columns.get("steadiness", []), STEADINESS)

    @property
    def notes(self) -> list[str]:
        """Sentences on cases that are not steady, and what to type, whose bodies moved apart, or whose forces at rest are undetermined."""
        counts = notes_of_cases(self.model, self.columns)
        of_parts = [f"{count} of {np.size(self.columns['status'])} cases: {sentence}" for sentence, count in counts.items()]
        left = int(np.sum(np.asarray(self.columns.get("status", 0)) == Status.NOT_COMPUTED))
        early = [f"interrupted: {left} of {np.size(self.columns['status'])} cases are not computed"] if left else []
        unsettled = unsettled_note(self.columns.get("steadiness", []), self.columns.get("settling_error", []))
        return early + self._first_failures + unsettled + of_parts

    @property
    def _first_failures(self) -> list[str]:
        """Of each status with which cases ended before their time, the first case."""
        status, firsts = np.asarray(self.columns.get("status", 0)), dict[int, str]()
        for at, sentence in self.failures.items():
            count, case = int(np.sum(status == status[at])), at[0] if len(at) == 1 else at
            which = f"{count} of {status.size} cases, the first of them case {case}: " if at else ""
            firsts.setdefault(int(status[at]), f"{which}{sentence}")
        return list(firsts.values())

    _drawn_by = "batch"

    def __repr__(self) -> str:
        ends = "; ".join(f"{n} {sentence}" for sentence, n in self.status_counts.items()) if "status" in self.columns else ""
        restless = "".join(f"; {n} {word}" for word, n in self.steadiness_counts.items() if word in _RESTLESS)
        return f"<Summary of shape {self.shape}: {ends}{restless}>"

    def _repr_html_(self) -> str:
        return self.to_xarray()._repr_html_()
