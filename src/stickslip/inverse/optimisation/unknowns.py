"""The unknowns of a search: numbers between bounds and waveforms, as one table with values from 0 to 1."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, Problems, did_you_mean, other_words
from stickslip.basics.fields import field_description, leaves
from stickslip.basics.number_names import numbers_meant
from stickslip.basics.quantities import allowed_in, example_of
from stickslip.inverse.optimisation.bounds import typed_ends
from stickslip.inverse.optimisation.waveforms import Scales, Waveform, drive_of_waveform, unknowns_of
from stickslip.inverse.scales import Scale
from stickslip.models.drives.drive_adapter import lacking

_DECADES = 100.0  # positive bounds further apart than this are searched on a logarithmic scale
_INWARD = 1e-9  # of the way between two bounds: how far within them a number has to be allowed
_TYPED = 'type for example over={"drive.amplitude": (2e-4, 8e-4)} or over={"drive": ss.optimisation.waveform(pieces=4)}'


@dataclass(frozen=True)
class Varied:
    """Something that varies: numbers that are moved together, or the drive at a path."""

    name: str  # as it was typed
    leaves: tuple[str, ...]  # the numbers, or the path of the drive
    low: float = 0.0
    high: float = 1.0
    form: Waveform | None = None

    @property
    def count(self) -> int:
        """Unknowns."""
        return 1 if self.form is None else unknowns_of(self.form)

    @property
    def scale(self) -> Scale:
        """The scale of the search between the bounds."""
        return Scale(self.low, self.high, self.low > 0.0 and self.high / self.low > _DECADES)

    def value(self, u: Array) -> Array:
        """The number at an unknown."""
        return self.scale.outer(u)

    def unknown(self, value: float) -> float:
        """The unknown of a number, within the bounds."""
        return float(np.clip(self.scale.inner(max(value, self.low)), 0.0, 1.0))


class Unknowns:
    """The machines of a table of unknowns.

    Parameters
    ----------
    model : Robot or machine
    varied : list of Varied
    scales : Scales or None
        The size of waveforms, where there are any.
    make : callable, optional
        Makes the machine, or a batch, of what varies by name; by default that is put into `model`.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> space = Unknowns(robot, [Varied("drive.amplitude", ("drive.amplitude",), 2e-4, 8e-4)], None)
    >>> space.machine(np.array([0.5])).drive.amplitude
    0.0005
    """

    def __init__(self, model: Any, varied: list[Varied], scales: Scales | None, make: Callable[[dict[str, Any]], Any] | None = None):
        self.model, self.varied, self.scales, self.make = model, varied, scales, make or model.replace
        ends = np.cumsum([each.count for each in varied])
        self.count = int(ends[-1])
        self.slices = [slice(int(end) - each.count, int(end)) for end, each in zip(ends, varied, strict=True)]

    def changes(self, u: Array) -> dict[str, Any]:
        """Values for the machine: numbers by name, drives by path."""
        changes: dict[str, Any] = {}
        for each, part in zip(self.varied, self.slices, strict=True):
            if each.form is not None:
                changes[each.leaves[0]] = drive_of_waveform(each.form, u[part], self.scales or Scales(1.0))
            else:
                value = each.value(u[part.start])
                changes |= {name: float(value) if np.ndim(value) == 0 else value for name in each.leaves}
        return changes

    def machine(self, u: Array) -> Any:
        """The machine of one row of unknowns, checked."""
        changes = self.changes(np.asarray(u, float))
        return self.make({name: change.replace() if hasattr(change, "replace") else change for name, change in changes.items()})

    def numbers(self, u: Array) -> dict[str, float]:
        """The numbers that vary, for one row of unknowns."""
        return {name: float(value) for name, value in _numbers_in(self.changes(np.asarray(u, float))).items()}

    def machines(self, U: Array) -> tuple[Any, Array]:
        """A batch from a table (cases, unknowns), of the cases that make a machine, and which these are."""
        changes = self.changes(U.T)
        at = np.flatnonzero(np.all([np.isfinite(v) for v in _numbers_in(changes).values()], axis=0) & np.ones(len(U), bool))
        parts = self._made(U, at, changes if len(at) == len(U) else None)
        if len(parts) == 1:
            return parts[0]
        good = np.concatenate([places for _, places in parts]) if parts else np.empty(0, int)
        return (self.make(self.changes(U[good].T)) if len(good) else None), good

    def _made(self, U: Array, at: Array, changes: dict[str, Any] | None = None) -> list[tuple[Any, Array]]:
        """Machines of the cases that make one: what a record refuses as a whole is tried in halves."""
        if not len(at):
            return []
        try:
            return [(self.make(changes or self.changes(U[at].T)), at)]
        except InputError:
            return [] if len(at) == 1 else [part for half in np.array_split(at, 2) for part in self._made(U, half)]

    def slopes(self, u: Array, step: float = 1e-6) -> dict[str, Array]:
        """Derivatives of the numbers that vary by the unknowns, formulas that differences give nearly to rounding: arrays (unknowns,)."""
        shifts = step * np.eye(self.count)
        numbers = _numbers_in(self.changes(np.vstack([u + shifts, u - shifts]).T))
        slopes = {name: (v[: self.count] - v[self.count :]) / (2 * step) for name, v in numbers.items() if np.ndim(v)}
        return {name: slope for name, slope in slopes.items() if np.any(slope != 0.0)}


def _numbers_in(changes: dict[str, Any]) -> dict[str, Any]:
    """The numbers among what is put into a machine, by name."""
    numbers: dict[str, Any] = {}
    for name, change in changes.items():
        numbers |= {name: change} if isinstance(change, (float, np.ndarray)) else dict(leaves(change, name + "."))
    return numbers


def checked_over(model: Model, over: Any, problems: Problems) -> list[Varied]:
    """The unknowns as typed, with all errors reported together."""
    if not isinstance(over, dict) or not over:
        problems.add(f"over = {over!r}; allowed is a dict of what varies; {_TYPED}")
        return []
    known = [name for name, _ in leaves(model)]
    varied = [each for name, what in over.items() if (each := _varied(model, str(name), what, known, problems)) is not None]
    for i, one in enumerate(varied):
        for other in varied[i + 1 :]:
            if same := _both(one, other):
                problems.add(f"{one.name!r} and {other.name!r} cannot both vary: {same} would be set twice; leave one of them out")
    return varied


def _both(one: Varied, other: Varied) -> str:
    """A number or a drive that two of them set."""
    pairs = [(a, b) for a in one.leaves for b in other.leaves]
    return next((max(a, b, key=len) for a, b in pairs if a == b or a.startswith(b + ".") or b.startswith(a + ".")), "")


def _varied(model: Model, name: str, what: Any, known: list[str], problems: Problems) -> Varied | None:
    if isinstance(what, Waveform):
        return _of_drive(model, name, what, known, problems)
    meant = numbers_meant(name, known)
    if not meant:
        hint = other_words(name, None, known) or did_you_mean(name, known)
        problems.add(f"over: {name!r} is not a number of {type(model).__name__}; {hint}")
        return None
    descriptions = {leaf: field_description(model, leaf) for leaf in meant}
    try:
        low, high = typed_ends(what, str(descriptions[meant[0]].get("unit", "")))
        if low is None or high is None:
            raise ValueError("a bound is missing")
    except ValueError as error:
        problems.add(f"over[{name!r}] = {what!r}: {error}; allowed is (low, high), or a waveform for a drive; {_TYPED}")
        return None
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        swapped = f"type ({high:g}, {low:g})" if np.isfinite(low) and np.isfinite(high) else _TYPED
        typed = "type a dict without it" if low == high else swapped
        problems.add(f"over[{name!r}] = ({low:g}, {high:g}); allowed are finite bounds, the lower one first; {typed}")
        return None
    if why := next((why for each in descriptions.values() if (why := _left(each, low, high))), ""):
        problems.add(f"over[{name!r}] = ({low:g}, {high:g}) leaves what {name.rpartition('.')[2]} may be; {why}")
        return None
    return Varied(name, meant, low, high)


def _left(description: Mapping[str, Any], low: float, high: float) -> str:
    """The allowed part of a number's bounds; a bound itself may lie on the limit, such as 0 for a positive number."""
    rule, inward = description.get("rule"), _INWARD * (high - low)
    if rule is None or (rule(low + inward) and rule(high - inward)):
        return ""
    typed = (
        f"type (0, {high:g})" if low < 0.0 and rule(inward) and rule(high - inward) else f"an ordinary value is {example_of(description)}"
    )
    return f"allowed is {allowed_in(description)}; {typed}"


def _of_drive(model: Any, name: str, form: Waveform, known: list[str], problems: Problems) -> Varied | None:
    """The drive at a path."""
    path, part = name.replace("[", ".").replace("]", ""), model
    for step in path.split("."):
        part = part[int(step)] if isinstance(part, tuple) and step.isdigit() and int(step) < len(part) else getattr(part, step, None)
    if part is None or isinstance(part, tuple) or lacking(part):
        paths = sorted({each.rpartition(".")[0] for each in known if ".drive." in f".{each}"})
        mistake = f"over: {name!r} is not a drive of {type(model).__name__}, and a waveform stands for one"
        problems.add(f"{mistake}; known: {', '.join(paths) or 'none'}")
        return None
    return Varied(name, (path,), form=form)
