"""One channel of a record: numbers over time as in the file, with everything known about them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.units import unit_named

#: What a channel can be for. "velocity" and "position" are those of the body; the paper calls its velocity convected.
ROLES = (
    "velocity", "absolute velocity", "position", "force", "load", "drive", "acceleration", "pressure", "voltage", "current", "weight",
    "command",
)  # fmt: skip
#: What is typed for a channel that is to have no role, whatever its name and its unit say.
UNUSED = "unused"
#: What the unit of a channel in a role may measure, where that is not what the role is called.
MEASURED = {
    "velocity": ("velocity", "angular velocity"), "absolute velocity": ("velocity", "angular velocity"), "position": ("position", "angle"),
    "acceleration": ("acceleration", "angular acceleration"), "force": ("force", "torque"), "load": ("force",), "weight": ("ratio",),
    "command": ("angle", "position"),
    "drive": ("velocity", "position", "acceleration", "voltage", "angle", "angular velocity", "angular acceleration"),
}  # fmt: skip
#: An interval longer than this many usual ones is a gap.
_GAP = 1.5


@dataclass(frozen=True)
class Gap:
    """A place where samples are missing: when the last sample before it was taken, and how long it lasts (in the unit of the axis)."""

    start: float
    length: float


def _frozen(array: Any) -> Any:
    """An array that nobody can write into: a copy, so that the caller's own array stays as it was, unless it is so already."""
    if array.flags.writeable:
        array = array.copy()
        array.setflags(write=False)
    return array


@sealed
@dataclass(frozen=True, eq=False)
class Channel:
    """Numbers over an axis, nearly always time.

    Parameters
    ----------
    name : str
    values : array (n,)
        As they stand in the file, in `unit`.
    unit : str or None
        None if the file names none. Nothing is guessed.
    t : array (n,)
        The axis, in `axis_unit`.
    axis_name, axis_unit : str or None
    role : str or None
        One of `ROLES`, or None.

    Examples
    --------
    >>> c = Channel("v", np.array([1.0, 2.0, 3.0]), "mm/s", t=np.array([0.0, 0.5, 1.0]), axis_unit="ms")
    >>> c.rate, c.si.tolist()
    (2000.0, [0.001, 0.002, 0.003])
    """

    name: str
    values: Any
    unit: str | None
    t: Any
    axis_name: str | None = "time"
    axis_unit: str | None = None
    role: str | None = None

    def __post_init__(self) -> None:
        for name in ("values", "t"):
            object.__setattr__(self, name, _frozen(np.asarray(getattr(self, name))))

    def __len__(self) -> int:
        return len(self.values)

    @property
    def over_time(self) -> bool:
        """Whether the axis is time, as far as is known."""
        unit = unit_named(self.axis_unit)
        return unit.quantity == "time" if unit else "freq" not in (self.axis_name or "").lower()

    @cached_property
    def interval(self) -> float:
        """The usual interval between samples, in the unit of the axis; NaN if there is none."""
        steps = np.diff(self.t)
        if not (good := np.isfinite(steps) & (steps > 0)).all():
            steps = steps[good]
        if len(steps) == 0:
            return float("nan")
        usual = float(np.median(steps, overwrite_input=True))
        if len(steps) == len(self.t) - 1 and max(steps.max() - usual, usual - steps.min()) < 0.01 * usual:
            return float((self.t[-1] - self.t[0]) / (len(self.t) - 1))
        return usual

    @property
    def rate(self) -> float:
        """Samples per second; where the axis has no unit, samples per unit of the axis."""
        unit = unit_named(self.axis_unit) if self.over_time else None
        return 1.0 / (self.interval * (unit.factor if unit else 1.0))

    @property
    def rate_unit(self) -> str:
        """The unit of `rate`."""
        known = self.over_time and unit_named(self.axis_unit) is not None
        return "Hz" if known else f"1/({self.axis_unit or 'unit of ' + repr(self.axis_name)})"

    @cached_property
    def gaps(self) -> tuple[Gap, ...]:
        """Where samples are missing: intervals of more than 1.5 usual ones."""
        steps = np.diff(self.t)
        where = np.flatnonzero(steps > _GAP * self.interval)
        return tuple(Gap(float(self.t[i]), float(steps[i])) for i in where)

    @property
    def si(self) -> Any:
        """The values in SI units; an error that shows what to type if the unit is not known."""
        return self.values * self._factor(self.unit, f'units={{"{self.name}": "m/s"}}', f"the unit of {self.name!r}")

    @property
    def time(self) -> Any:
        """The time of each sample [s]; an error that shows what to type if its unit is not known."""
        if not self.over_time:
            raise InputError(self.name, [f"stands over {self.axis_name} and not over time; take another channel"])
        return self.t * self._factor(
            self.axis_unit, f'units={{"{self.axis_name or "time"}": "s"}}', f"the unit of time ({self.axis_name!r})"
        )

    def _factor(self, text: str | None, example: str, what: str) -> float:
        unit = unit_named(text)
        if unit is None:
            given = "is not in the file" if text is None else f"is {text!r}, which is not known here"
            raise InputError("record", [f"{what} {given}; type ss.read(path, {example}) with the right unit"])
        return unit.factor

    def __repr__(self) -> str:
        role = f", {self.role}" if self.role else ""
        return f"<Channel {self.name!r} [{self.unit or 'no unit'}]{role}: {len(self)} values at {self.rate:.6g} {self.rate_unit}>"
