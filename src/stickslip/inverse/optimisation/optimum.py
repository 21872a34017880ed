"""The result of a search, and its distance from the theoretical limit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.arguments import described_as
from stickslip.basics.errors import InputError, did_you_mean
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.notebook_display import Drawn
from stickslip.inverse.optimisation.gradients import Gradient
from stickslip.inverse.optimisation.results import unit_of_result
from stickslip.models.naming import unit_in


@sealed
@dataclass(frozen=True, eq=False)
class Search:
    """The settings of a search, and its course.

    Parameters
    ----------
    maximised : bool
        Whether the quantity was to be large.
    over : dict
        What varied: (low, high) of numbers, and waveforms of drives, by the names that were typed.
    subject_to : dict
        Limits as (least, largest), None where there is none.
    robust : dict
        What was uncertain.
    quantile : float or None
        The part of the sample that may be worse than what counts.
    starts : str or None
        "closed" where drives known in closed form were tried with the first generation.
    seed : int
    history : array (improvements, 2)
        Candidates tried until each improvement, and the best value from then on.
    """

    maximised: bool
    over: dict[str, Any]
    subject_to: dict[str, Any]
    robust: dict[str, Any]
    quantile: float | None
    starts: str | None
    seed: int
    history: Any


@described_as("what ss.optimise returns; type ss.optimise(robot, over=..., maximise=...)")
@sealed
@dataclass(frozen=True, eq=False)
class Optimum(Drawn):
    """The best machine that a search found. Global optimality is not proved. `stickslip.plot.optimum` draws it.

    Parameters
    ----------
    model : Robot or machine
        The machine.
    of : str
        The quantity that was maximised or minimised.
    values : dict
        Numbers of its motion from rest, and stroke [m], relative velocity [m/s] and relative acceleration [m/s^2] of its drives; also by
        ``best["mean_velocity"]``.
    varied : dict
        The optimal values of the varied numbers; for a waveform those of its drive.
    of_limit : float or None
        The mean velocity as a fraction of the small-friction limit named by `limit`; None if none is known.
    limit : str
        The name of this limit, or the reason why there is none.
    active : tuple of str
        The active limits, and the numbers at one of their bounds.
    sensitivities : Gradient
        Derivatives of the quantity with respect to all numbers of the machine except those of waveforms, with notes on one-sided ones.
    tried : int
        Number of candidates that were simulated.
    given : dict
        The same numbers as `values`, for the given machine: they show the gain and the additional cost of the best one.
    search : Search
        The settings and the course of the search.
    notes : tuple of str
        Remarks.
    robust : float or None
        For uncertain numbers, the quantile of the quantity over the sample, or its worst value.
    continued : float or None
        Mean velocity of the motion reached by slowly changing the numbers of the given machine into those of the best one; a note
        reports if it differs from the motion from rest. None if there is no such path, as between different kinds of drive.
    given_model : Robot or machine, optional
        The machine that was given.
    cuts : dict of array (4, looks)
        The effect of one number between its bounds with the others fixed: by its name, the fraction of the range, the number itself, the
        quantity (over the sample for uncertain numbers), and 1 where every limit is satisfied, else 0.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> best = ss.optimise(robot, over={"drive.amplitude": (2e-4, 8e-4)}, maximise="mean_velocity")
    >>> best.active, round(best["mean_velocity"], 9)
    (('drive.amplitude',), 0.004308808)
    """

    model: Any
    of: str
    values: dict[str, Any]
    varied: dict[str, float]
    of_limit: float | None
    limit: str
    active: tuple[str, ...]
    sensitivities: Gradient
    tried: int
    given: dict[str, Any]
    search: Search
    notes: tuple[str, ...] = field(default=())
    robust: float | None = None
    continued: float | None = None
    given_model: Any = None
    cuts: dict[str, Any] = field(default_factory=dict)

    _drawn_by = "optimum"

    def __getitem__(self, name: str) -> Any:
        """A number of the motion or of the drives by its name."""
        if name not in self.values:
            raise InputError("optimise", [f"{name!r} is not known of the best machine; {did_you_mean(name, self.values)}"])
        return self.values[name]

    def _title(self) -> str:
        return f"Optimum: {self.of} = {self[self.of]:.7g} {self._unit(self.of)}".rstrip()

    def _facts(self) -> dict[str, Any]:
        share = {} if self.of_limit is None else {f"of the limit ({self.limit})": f"{100 * self.of_limit:.4g} %"}
        robust = {} if self.robust is None else {"over the sample": f"{self.robust:.7g} {self._unit(self.of)}".rstrip()}
        return {**share, **robust, "active limits": ", ".join(self.active) or "none", "candidates tried": self.tried}

    def _tables(self) -> list[list[tuple[str, ...]]]:
        known = [name for name, value in self.values.items() if isinstance(value, float) and isinstance(self.given.get(name), float)]
        varied: list[tuple[str, ...]] = [(name, f"{value:.6g}", unit_in(name, self.model)) for name, value in self.varied.items()]
        compared: list[tuple[str, ...]] = [
            (name, f"{self.given[name]:.6g}", f"{self.values[name]:.6g}", self._unit(name)) for name in known
        ]
        return [[("number", "best", "unit"), *varied], [("result", "given", "best", "unit"), *compared]]

    def _unit(self, name: str) -> str:
        return unit_of_result(name, self.model)

    def __repr__(self) -> str:
        share = f"{100 * self.of_limit:.4g} % of the limit ({self.limit})" if self.of_limit is not None else self.limit
        active = f"active: {', '.join(self.active)}" if self.active else "no limit is active"
        active += f"; over the sample {self.robust:.9g} {self._unit(self.of)}".rstrip() if self.robust is not None else ""
        more = "".join(f"; {note}" for note in self.notes)
        best = f"{self.of} = {self[self.of]:.9g} {self._unit(self.of)}".rstrip()
        at = ", ".join(f"{name} = {value:.6g} {unit_in(name, self.model)}".rstrip() for name, value in self.varied.items())
        return f"<Optimum: {best} at {at}; {share}; {active}; {self.tried} candidates{more}>"
