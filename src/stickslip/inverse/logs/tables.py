"""Tables without times: forces of a bench at constant speeds, and mean speeds of a shaken robot over its settings, a row each."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.units import quantity_of, unit_named
from stickslip.inverse.identification.constant_speeds import is_of_constant_speeds
from stickslip.inverse.logs.machines import Rig, Shaken, Task, quantity_in, scaled

if TYPE_CHECKING:
    from stickslip.records.record import Record

_ERROR = re.compile(r"(.*[_ .])?(sd|std|sigma|err|error|unc|uncertainty)([_ .].*)?", re.I)
#: What a setting of a shaken robot measures: its argument in `piezo_rig`, and the quantity of its column.
_SETTINGS = {"amplitude": "position", "frequency": "frequency", "tilt_deg": "angle"}


class Bench(Rig):
    """A bench that slides at constant speeds, with a row for each: a speed and the force."""

    name = "bench"
    words = "a friction bench: forces at constant speeds, a row each"
    richer: ClassVar[tuple[str, ...]] = ()
    timed = False
    advises = False

    def suits(self, rec: Record) -> str:
        """What of a record speaks for it; empty where something is missing."""
        able = quantity_in(rec, "force") == "force" and quantity_in(rec, "velocity") == "velocity"
        return "a force beside a velocity, in rows without times" if able and is_of_constant_speeds(rec) else ""


class Speeds(Shaken):
    """Mean speeds of a shaken robot over amplitude, frequency or tilt."""

    name = "speeds"
    words = "a robot shaken by an inner mass: its mean speeds over settings of the drive, a row each"
    timed = False
    needs: ClassVar[dict[str, str]] = {"amplitude": "5e-4", "frequency": "40.0", "tilt_deg": "1.7"}
    by_file: ClassVar[frozenset[str]] = frozenset()

    def suits(self, rec: Record) -> str:
        """What of a record speaks for it; empty where something is missing."""
        if {"force", "current"} & {c.role for c in rec.channels.values()} or _speed(rec) is None:
            return ""
        settings = [name for name in _SETTINGS if name in _columns(rec)]
        return f"a velocity beside {' and '.join(settings)}, in rows without times" if {"amplitude", "frequency"} & {*settings} else ""

    def missing(self, records: Sequence[Record], given: dict[str, Any]) -> list[str]:
        """Numbers without which nothing can be fitted, and that neither the records have nor the user gave."""
        return [name for name in super().missing(records, given) if any(name not in _columns(rec) for rec in records)]

    def assumed(self, records: Sequence[Record], given: dict[str, Any]) -> dict[str, tuple[str, str]]:
        """Numbers that nobody gave: name -> (value in words, why)."""
        of_table = {name: (f"column {column}", "its unit") for name, (column, _) in _columns(records[0]).items() if name not in given}
        return of_table | super().assumed(records, {"frequency": 1.0} | given)

    def task(self, records: Sequence[Record], law: str, given: dict[str, Any], asymmetric: bool) -> Task:
        """How a law is fitted."""
        speeds = [_known(rec) for rec in records]
        rows = sum(len(each) for each in speeds)
        settings = {name: given[name] for name in given if name not in _SETTINGS}
        for name in _SETTINGS:
            settings[name] = float(given[name]) if name in given else [float(x) for rec in records for x in _columns(rec)[name][1]]
            if isinstance(settings[name], list) and len(settings[name]) != rows:
                raise InputError("fit", [f"{name} has {len(settings[name])} values and the speed {rows}; give a table with a row for each"])
        settings["omega"] = scaled(settings.pop("frequency"), 2 * math.pi)
        made = super().task(records, law, {"frequency": 1.0}, asymmetric)
        return replace(made, options=settings | {"law": law}, values=_values, values_by=_expression(records))


def _columns(rec: Record) -> dict[str, tuple[str, Any]]:
    """Columns with settings: name -> (name of the column, values in SI units, angles in degrees)."""
    columns: dict[str, tuple[str, Any]] = {}
    for name, quantity in _SETTINGS.items():
        own = {c.name: c.si for c in rec.channels.values() if quantity_of(c.unit) == quantity}
        for c in rec.channels.values():  # a column of rising frequencies is the axis of the others
            unit = unit_named(c.axis_unit)
            if unit is not None and unit.quantity == quantity:
                own[str(c.axis_name)] = c.t * unit.factor
        if len(own) == 1:
            column, values = next(iter(own.items()))
            columns[name] = column, np.degrees(values) if name == "tilt_deg" else values
    return columns


def _speed(rec: Record) -> Any:
    """The column of the mean speed; None where there is none, or more than one."""
    able = [c for c in rec.channels.values() if quantity_of(c.unit) == "velocity" and not _ERROR.fullmatch(c.name)]
    return able[0] if len(able) == 1 else None


def _spread(rec: Record) -> Any:
    """The column of the standard errors of the speed; None where there is none."""
    able = [c for c in rec.channels.values() if quantity_of(c.unit) == "velocity" and _ERROR.fullmatch(c.name)]
    return able[0] if len(able) == 1 else None


def _known(rec: Record) -> list[Any]:
    """Mean speeds as `identify` takes them: numbers, or with their standard errors."""
    speed, spread = _speed(rec), _spread(rec)
    values = [float(v) for v in speed.si]
    return values if spread is None else [("normal", v, float(sd)) for v, sd in zip(values, spread.si, strict=True)]


def _values(records: list[Any]) -> list[Any]:
    return [each for rec in records for each in _known(rec)]


def _expression(records: Sequence[Record]) -> str:
    """The Python that makes the mean speeds of a record, or of several."""
    speed, spread = _speed(records[0]).name, _spread(records[0])
    one, every = ("{0}", "") if len(records) == 1 else ("record", "for record in {0} ")
    if spread is None:
        return f"[float(v) {every}for v in {one}[{speed!r}].si]"
    return f'[("normal", v, sd) {every}for v, sd in zip({one}[{speed!r}].si, {one}[{spread.name!r}].si)]'
