"""Logs of a command and of the angle that followed: which numbers of a servo made that motion? It is simulated, many cases at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, SolveError
from stickslip.basics.fields import leaves
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.phrases import counted
from stickslip.inverse.identification.parameters import OverParameters, Parameters
from stickslip.inverse.identification.rounding import count_of
from stickslip.inverse.identification.targets import Compared
from stickslip.inverse.identification.weighting import weights_at
from stickslip.models.machine_adapter import machine_of
from stickslip.records.overview import noise
from stickslip.solvers.followed import followed

if TYPE_CHECKING:
    from stickslip.records.record import Record

_FEWEST = 40  # samples of a log
_STEP = 1e-5  # of the distance between the bounds: differences for derivatives
_EXACT = 1e-6  # of the range of an angle: noise that is left to a simulation, of which a record may be one
_KEPT = 256  # motions of each log that are remembered
_RESTS = 1e-6  # of the largest velocity: less is that of a servo at rest
_GAP = 3.0  # usual times between samples: what was commanded in a longer one nobody knows
_FORGOTTEN = 8.0  # times by which a servo lags behind its command, after which it has forgotten a gap
_FIRST, _VERY_FIRST = 8, 4  # samples at the beginning that say how fast the motion begins, and those of them that must go that way
_MOVES = 5.0  # standard errors of that velocity above which the motion does not begin at rest


@sealed
@dataclass(frozen=True, eq=False)
class CommandLog(Compared):
    """The angle of a servo over time, with the command that it was given.

    Each value of the command holds until the next one.

    Parameters
    ----------
    t : array (n,)
        Instants of the angles [s].
    y : array (n,)
        The angles as the encoder shows them [rad].
    sigma : float
        Standard deviation of the noise of one of them.
    weight : array (n,)
    role : str
        What commands the servo: a role of `stickslip.models.machine_adapter.MachineAdapter.commands`.
    instants : array (m,)
        Of angles and command together [s].
    command : array (m - 1,)
        From each of these instants to the next.
    at : array (n,)
        Which of these instants those of the angles are.
    rate : float
        Velocity at the first sample [rad/s].
    """

    kind: ClassVar[str] = "angle"

    t: Any
    y: Any
    sigma: float
    weight: Any
    role: str
    instants: Any
    command: Any
    at: Any
    rate: float
    label: str
    given_sigma: bool = False
    cut: str | None = None

    @property
    def step(self) -> float:
        """Usual time between samples [s]."""
        return float(np.median(np.diff(self.t)))

    @property
    def most_noise(self) -> float:
        """The most that the noise of an angle can be: what neighbours scatter, and rounding that they do not show at rest [rad]."""
        return max(float(np.hypot(self.sigma, count_of(self.y) / np.sqrt(12))), _EXACT * float(np.ptp(self.y)))

    @property
    def time(self) -> Any:
        """Times of the values, counted from the middle of the record [s]."""
        return self.t - 0.5 * (self.t[0] + self.t[-1])

    def moved(self, met: Any = None) -> tuple[Any, Any, Any]:
        """Times, angles and velocities of the motion of a model, or of the one that was measured, with its noise."""
        angles = self.y if met is None else met
        v = np.gradient(angles, self.t)
        return self.t, angles, np.where(abs(v) > _RESTS * np.max(abs(v), initial=0.0), v, 0.0)

    def delayed(self, h: Array, delay: float) -> Any:
        """Values a little later; before the first one the angle is that."""
        from scipy.interpolate import PchipInterpolator

        return PchipInterpolator(self.t, h)(np.clip(self.t - delay, self.t[0], self.t[-1]))


def takes_commands(model: Model, records: list[Any]) -> bool:
    """Whether all records have the angle of a machine, and what a controller, or a motor, of it was commanded."""
    return all(hasattr(rec, "channels") and "position" in rec and _role(model, rec) is not None for rec in records)


def _role(model: Model, rec: Record) -> str | None:
    """Which channel of a record commands a machine; None if none does."""
    return next((role for role in machine_of(model).commands if role in rec), None)


def command_log(model: Model, rec: Record, sigma: float | None, label: str) -> CommandLog:
    """The log of a machine; `InputError` where something is missing."""
    role = _role(model, rec)
    if role is None or "position" not in rec:
        roles = " or ".join(machine_of(model).commands) or "command, since this machine has neither controller nor motor"
        typed = 'roles={"goal": "command", "pos": "position"}'
        raise InputError("identify", [f"{label}: allowed is a record with position and {roles}; type {typed} when reading"])
    angle, own, notes = rec["position"], rec[role], list[str]()
    t, y, weight = angle.time, angle.si, weights_at(rec, angle.time)
    known = np.isfinite(t) & np.isfinite(y) & np.concatenate([[True], np.diff(t) > 0])
    if not known.all():
        notes.append(f"{int((~known).sum())} of {len(t)} angles are missing and left out")
    t, y, weight = t[known], y[known], weight[known]
    given = np.isfinite(own.si) & np.isfinite(own.time)
    when, what = own.time[given], own.si[given]
    if len(t) < _FEWEST or not len(when):
        raise InputError("identify", [f"{label} has {len(t)} angles and {len(when)} commands; allowed are {_FEWEST} angles or more"])
    inside = (when > t[0]) & (when < t[-1])
    instants = np.union1d(t, when[inside])
    command = what[np.maximum(np.searchsorted(when, instants[:-1], side="right") - 1, 0)]
    level, rate = _noise(y) if sigma is None else float(sigma), _rate(t, y)
    if rate:
        notes.append(f"the motion begins with {rate:.3g} rad/s")
    log = CommandLog(t, y, level, weight, role, instants, command, np.searchsorted(instants, t), rate, label, sigma is not None)
    log, said = _across_gaps(log, when, what)
    return replace(log, cut="; ".join(notes + said) or None)


def _across_gaps(log: CommandLog, when: Array, what: Array) -> tuple[CommandLog, list[str]]:
    """A log in whose gaps the command goes on from sample to sample, without the angles for which that matters; and what was done.

    A controller brings a servo back to its command; without one the angle after a gap is never known.
    """
    from scipy.interpolate import PchipInterpolator

    steps = np.diff(log.instants)
    usual = float(np.median(steps))
    gaps = np.flatnonzero(steps > _GAP * usual)
    if not len(gaps) or len(np.unique(when)) < 2:
        return log, []
    parts = [log.instants[k] + usual * np.arange(1, int(steps[k] / usual - 0.5) + 1) for k in gaps]
    instants = np.union1d(log.instants, np.concatenate(parts))
    held = log.command[np.searchsorted(log.instants, instants[:-1], side="right") - 1]
    evenly = np.where(np.isin(instants[:-1], log.instants), held, PchipInterpolator(when, what, extrapolate=False)(instants[:-1]))
    evenly = np.where(np.isfinite(evenly), evenly, held)
    at, late = np.searchsorted(instants, log.t), _FORGOTTEN * _lag(log, usual)
    known = np.ones(len(log.t), bool)  # the same for all laws, so that they can be compared
    for k in gaps if log.role == "command" else gaps[:1]:
        end = log.instants[k + 1] + late if log.role == "command" else np.inf
        known &= (log.t <= log.instants[k]) | (log.t > end)
    if int(known.sum()) < _FEWEST:
        long = f"{counted(len(gaps), 'gap')} of up to {float(steps.max()):.3g} s"
        mend = "give the parts between them as records of their own: rec.segments()"
        raise InputError("identify", [f"{log.label} has {long}, in which nobody knows what was commanded; {mend}"])
    kept = replace(log, t=log.t[known], y=log.y[known], weight=log.weight[known], instants=instants, command=evenly, at=at[known])
    lost = f" and {counted(int((~known).sum()), 'angle')} after that, which would depend on it, left out" if not known.all() else ""
    said = f"{counted(len(gaps), 'gap')} of up to {float(steps.max()):.3g} s: the command is interpolated there{lost}"
    return kept, [said]


def _lag(log: CommandLog, step: float) -> float:
    """By how much the angle follows its command later: where both are most alike, a sample at least and a second at most [s]."""
    t = np.arange(log.t[0], log.t[-1], step)
    goal = log.command[np.clip(np.searchsorted(log.instants, t, side="right") - 1, 0, len(log.command) - 1)]
    angle = np.interp(t, log.t, log.y)
    tried = range(1, int(np.clip(1.0 / step, 2, len(t) // 4)))
    return step * (1 + int(np.argmin([np.mean((angle[k:] - goal[:-k]) ** 2) for k in tried])))


def _motions(machines: Model, role: str, angle: Any, instants: Array, command: Array, rate: float, rtol: float = 1e-8) -> Any:
    """Angles at some instants under a command for each case, from an angle and a velocity on: array (cases, instants)."""
    moved, name, start = machine_of(machines).commands[role]
    first = np.broadcast_to(angle, command.shape[:-1])
    moved = moved.replace({start: first if first.ndim else float(first)})
    moving = {"v": {machine_of(moved).mechanics.bodies[0]: rate}} if rate else None
    return followed(moved, instants, {name: command}, rtol=rtol, start=moving)[0]


def _noise(y: Array) -> float:
    """The noise of one angle, that of its counts at least [rad]."""
    scatter = noise(y)
    return max(scatter if np.isfinite(scatter) else 0.0, count_of(y) / np.sqrt(12), 1e-9 * float(np.ptp(y))) or 1.0


def _rate(t: Array, y: Array) -> float:
    """The velocity at the first sample, where the first ones clearly move; else zero.

    A motion that begins at rest and then goes faster than its square of time has a parabola that begins backwards: the first few samples
    must go the same way.
    """
    level = _noise(y)
    rate, error = _slope(t[:_FIRST], y[:_FIRST], 2)
    before, its_error = _slope(t[:_VERY_FIRST], y[:_VERY_FIRST], 1)
    return rate if abs(rate) > _MOVES * level * error and before * np.sign(rate) > level * its_error else 0.0


def _slope(t: Array, y: Array, order: int) -> tuple[float, float]:
    """The slope at the first value of a polynomial through some, and its standard error for values with a noise of 1."""
    columns = (t - t[0])[:, None] ** np.arange(order + 1)
    numbers, *_ = np.linalg.lstsq(columns, y, rcond=None)
    return float(numbers[1]), float(np.sqrt(np.linalg.inv(columns.T @ columns)[1, 1]))


@dataclass(eq=False)
class CommandedProblem(OverParameters):
    """Fit of the angles that follow a command. All derivatives, and all places of a multistart, are one batch.

    Parameters
    ----------
    parameters : Parameters
    targets : tuple of CommandLog
    rtol : float
        Relative tolerance of dynamic laws.
    remembers : bool
        Whether the law has inner states, which begin undeflected.
    """

    resolution: ClassVar[float] = 1e-4  # singular values of the derivatives, which are of first order, below this are zero

    parameters: Parameters
    targets: tuple[CommandLog, ...]
    rtol: float = 1e-8
    solves: int = 0
    values: Any = None
    _motions: dict[tuple[Any, ...], Any] = field(default_factory=dict)

    @property
    def y(self) -> Any:
        """All measured values."""
        return super().y if self.values is None else self.values

    def _like(self, **changes: Any) -> CommandedProblem:
        return replace(self, **{"_motions": {}, **changes})

    def afresh(self) -> CommandedProblem:
        """The same fit with a memory and a count of its own, which begin with what is remembered here."""
        return replace(self, solves=0, _motions=dict(self._motions))

    def with_values(self, y: Any) -> CommandedProblem:
        """The same fit for other measured values, of the same motions."""
        return replace(self, values=y)

    def rough(self) -> CommandedProblem:
        """The same fit, with a count of its own; it shares what is remembered."""
        return replace(self, solves=0)

    def guesses(self) -> list[Any]:
        """The place of the numbers that the machine has, where it has them all between the bounds."""
        if callable(self.parameters.make):
            return []
        own = dict(leaves(self.parameters.make))
        values = {f.name: own.get(f.argument) for f in self.parameters.free}
        inside = [value is not None and f.low <= value <= f.high for f, value in zip(self.parameters.free, values.values(), strict=True)]
        return [self.parameters.point({name: float(value) for name, value in values.items() if value is not None})] if all(inside) else []

    def ends(self, places: Array, readings: Sequence[Mapping[str, Any]]) -> tuple[Any, Any]:
        """Angles of all records for many places (cases, parameters) and readings of the sensors: array (values, cases), twice the same."""
        places = np.asarray(places, float)
        parts = [self._angles(i, places, reading) for i, reading in enumerate(readings)]
        whole = np.concatenate(parts, axis=0)
        return whole, whole

    def _angles(self, i: int, places: Any, reading: Mapping[str, Any]) -> Any:
        """Angles of one record: array (values, cases)."""
        own = np.column_stack([np.broadcast_to(reading.get(what, 0.0), len(places)) for what in ("zero", "begin", "goal")])
        keys = [(i, *map(float, at), *map(float, each)) for at, each in zip(places, own, strict=True)]
        new = list({key: k for k, key in enumerate(keys) if key not in self._motions}.values())
        if len(self._motions) > _KEPT * len(self.targets):
            kept = {key: self._motions[key] for key in keys if key in self._motions}
            self._motions.clear()
            self._motions.update(kept)
        if new:
            for k, motion in zip(new, self._followed(i, places[new], own[new]), strict=True):
                self._motions[keys[k]] = motion
        return np.stack([self._motions[key] for key in keys], axis=1)

    def _followed(self, i: int, places: Any, own: Any) -> Any:
        """The motions of some cases: array (cases, values); NaN where there is none."""
        target, whole = self.targets[i], np.full((len(places), self.targets[i].count), np.nan)
        good, batch = self._machines(i, places)
        if not good.any():
            return whole
        zero, begin, goal = own[good].T
        shift = zero + goal if target.role == "command" else np.zeros_like(zero)  # in either case a command for each place
        command = target.command - shift[:, None]
        self.solves += int(good.sum())
        try:
            angles = _motions(batch, target.role, target.y[0] + begin - zero, target.instants, command, target.rate, self.rtol)
        except (InputError, SolveError):
            return whole
        whole[good] = angles[:, target.at] + zero[:, None]
        return whole

    def _machines(self, i: int, places: Any) -> tuple[Any, Any]:
        """Which places make machines, and those of one record as a batch: made at once where a machine, and no function, is at hand."""
        if (batch := self.parameters.at_once(places, i)) is not None:
            return np.ones(len(places), bool), batch
        good, batches = self.parameters.batches(places)
        return good, batches[i] if good.any() else None

    def slopes(self, point: Array, readings: Sequence[Mapping[str, Any]]) -> tuple[Any, Any]:
        """Derivatives by differences, all parameters in one batch."""
        point = np.asarray(point, float)
        if not len(point):
            return (np.empty((len(self.y), 0)),) * 2
        allowed = self.parameters.limits.allows
        sign = np.array([1.0 if max(ahead) <= 1.0 and allowed(ahead) else -1.0 for ahead in point + np.diag(np.full(len(point), _STEP))])
        places = np.concatenate([point[None, :], point + np.diag(sign * _STEP)])
        angles, _ = self.ends(places, readings)
        slopes = np.nan_to_num((angles[:, 1:] - angles[:, :1]) / (sign * _STEP))
        return slopes, slopes
