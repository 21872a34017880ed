"""Sensitivities: from a sensor's voltage to the measured quantity."""

from __future__ import annotations

import dataclasses
import math
import re
from typing import Any

from stickslip.basics.errors import Problems, did_you_mean
from stickslip.basics.units import SI, Unit, unit_named
from stickslip.records.raw import Raw

_VOLT = unit_named("V")
_NUMBER = r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*)"
_TYPE = 'type for example scale={{"{name}": "25 mm/s/V"}}, or "100 mV/g0"'


def scaled(raw: Raw, scale: dict[str, Any], problems: Problems) -> None:
    """Multiply columns by numbers, or by sensitivities such as ``"25 mm/s/V"`` and ``"100 mV/g"`` (where g is gravity)."""
    names = [c.name for c in raw.columns]
    for name, given in scale.items():
        if name not in names:
            problems.add(f"scale names {name!r}; {did_you_mean(name, names)}")
            continue
        at = names.index(name)
        scaling = _factor(name, given, raw.columns[at].unit, problems)
        if scaling is None:
            continue
        factor, unit = scaling
        raw.columns[at] = dataclasses.replace(raw.columns[at], values=raw.columns[at].values * factor, unit=unit)
        raw.notes.append(f"{name} is scaled by {given if isinstance(given, str) else f'{given:g}'}, as was typed")


def _factor(name: str, given: Any, unit: str | None, problems: Problems) -> tuple[float, str | None] | None:
    """The factor for the numbers, and their unit after it."""
    typed = _TYPE.format(name=name)
    if isinstance(given, (int, float)) and not isinstance(given, bool) and math.isfinite(given) and given != 0:
        return float(given), unit
    match = re.fullmatch(_NUMBER, given.strip()) if isinstance(given, str) else None
    number = float(match[1]) if match else 0.0
    if match is None or not number or not math.isfinite(number):
        problems.add(f"scale of {name!r} = {given!r}; allowed is a number that is not zero, alone or with a unit per volt; {typed}")
        return None
    if not match[2]:
        return number, unit
    sensitivity = unit_named(re.sub(r"\bg\b", "g0", match[2]))
    volts = _VOLT if unit is None else unit_named(unit)
    if sensitivity is None or volts is None or volts.quantity != "voltage":
        what = f"the unit {match[2]!r} is not known" if sensitivity is None else f"it is in {unit}, and no voltage"
        problems.add(f"scale of {name!r} = {given!r}: {what}; {typed}")
        return None
    for sign in (1, -1):  # what a volt is, or how many volts one is
        powers = tuple(v + sign * s for v, s in zip(volts.powers, sensitivity.powers, strict=True))
        quantity = Unit("", 1.0, powers).quantity
        if quantity not in (None, "ratio", "voltage"):
            return volts.factor * (number * sensitivity.factor) ** sign, SI[quantity]
    problems.add(f"scale of {name!r} = {given!r} makes of volts nothing that is known here; {typed}")
    return None
