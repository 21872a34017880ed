"""What a search has found, and how far that is from what is possible."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.errors import InputError, did_you_mean
from stickslip.faces import Drawn
from stickslip.optimising.gradients import Gradient
from stickslip.sealing import sealed

__all__ = ["Optimum", "Search"]


@sealed
@dataclass(frozen=True, eq=False)
class Search:
    """What a search was asked, and how it went.

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


@sealed
@dataclass(frozen=True, eq=False)
class Optimum(Drawn):
    """The best machine that a search found. Global optimality is not proved. `stickslip.plot.optimum` draws it.

    Parameters
    ----------
    model : Robot or machine
        The machine.
    of : str
        The quantity that was made large or small.
    values : dict
        Numbers of its motion from rest, and stroke [m], relative velocity [m/s] and relative acceleration [m/s^2] of its drives; also by
        ``best["mean_velocity"]``.
    varied : dict
        The numbers that varied, as they were found; of a waveform those of its drive.
    of_limit : float or None
        The mean velocity as a part of the small-friction limit that `limit` names; None where none is known.
    limit : str
        Which limit that is, or why there is none.
    active : tuple of str
        The limits that it reaches, and the numbers that are at one of their bounds.
    sensitivities : Gradient
        Derivatives of the quantity by all numbers of the machine but those of waveforms, with notes on those that hold on one side only.
    tried : int
        Candidates that were run.
    given : dict
        The same numbers as `values` of the machine that was given: what the best one costs more, and what it gains.
    search : Search
        What was asked, and how the search went.
    notes : tuple of str
        Remarks.
    robust : float or None
        Where numbers were uncertain, the quantile of the quantity, or its worst value, over the sample.
    continued : float or None
        Mean velocity of the motion that is reached from that of the given machine as its numbers become those of the best one, slowly; a
        note says where it is another one than that from rest. None where no way leads there, as from one kind of drive to another.
    given_model : Robot or machine, optional
        The machine that was given.
    cuts : dict of array (4, looks)
        What one number does from bound to bound while the others stay: by the name of the number the part of the way between its bounds,
        the number itself, the quantity (over the sample where numbers were uncertain), and 1 where every limit is kept, else 0.

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
        return f"Optimum: {self.of} = {self[self.of]:.7g}"

    def _facts(self) -> dict[str, Any]:
        share = {} if self.of_limit is None else {f"of the limit ({self.limit})": f"{100 * self.of_limit:.4g} %"}
        robust = {} if self.robust is None else {"over the sample": f"{self.robust:.7g}"}
        return {**share, **robust, "active limits": ", ".join(self.active) or "none", "candidates tried": self.tried}

    def _tables(self) -> list[list[tuple[str, ...]]]:
        known = [name for name, value in self.values.items() if isinstance(value, float) and isinstance(self.given.get(name), float)]
        varied: list[tuple[str, ...]] = [(name, f"{value:.6g}") for name, value in self.varied.items()]
        found: list[tuple[str, ...]] = [(name, f"{self.given[name]:.6g}", f"{self.values[name]:.6g}") for name in known]
        return [[("number", "best"), *varied], [("result", "given", "best"), *found]]

    def __repr__(self) -> str:
        share = f"{100 * self.of_limit:.4g} % of the limit ({self.limit})" if self.of_limit is not None else self.limit
        active = f"active: {', '.join(self.active)}" if self.active else "no limit is active"
        active += f"; over the sample {self.robust:.9g}" if self.robust is not None else ""
        more = "".join(f"; {note}" for note in self.notes)
        return f"<Optimum: {self.of} = {self[self.of]:.9g}, {share}; {active}; {self.tried} candidates{more}>"
