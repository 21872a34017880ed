"""A law in other units: a dimensionally correct formula is unchanged when newtons, metres and seconds change."""

from __future__ import annotations

import dataclasses
import inspect
import re
from typing import Any

from stickslip.basics.field_types import field_types
from stickslip.basics.fields import replace_leaf

#: A newton, a metre and a second of the old units, in the new ones.
FACTORS = {"N": 3.0, "m": 7.0, "s": 0.5}
_BASE = {**{name: {name: 1} for name in FACTORS}, "kg": {"N": 1, "s": 2, "m": -1}, "Hz": {"s": -1}, "J": {"N": 1, "m": 1}}


def units(cls: type) -> dict[str, str]:
    """Field -> unit given in brackets in its line of the docstring, as in "Bristle stiffness [N/m]"."""
    units: dict[str, str] = {}
    names: list[str] = []
    for line in (inspect.getdoc(cls) or "").splitlines():
        head = re.match(r"(\w+(?:, \w+)*) : ", line)
        if head:
            names = head[1].split(", ")
        bracket = re.findall(r"\[([^\]\d][^\]]*|1)\]", line) if line.startswith(" ") else []
        if bracket:
            units.update(dict.fromkeys(names, bracket[-1]))
    return units


def factor(unit: str) -> float:
    """Conversion factor of a unit; `LookupError` if the unit is unknown."""
    result = 1.0
    over, *under = unit.split("/")
    for text, sign in ((over, 1), *((part, -1) for part in under)):
        for word in text.split():
            if word in ("-", "1", "rad"):
                continue
            name, _, power = word.partition("^")
            for base, exponent in _BASE[name].items():
                result *= FACTORS[base] ** (sign * exponent * int(power or 1))
    return result


def in_other_units(law: Any) -> Any:
    """The same law with all its numbers in other units; `LookupError` names the first field without a unit."""
    known_units, values = units(type(law)), {}
    for field in dataclasses.fields(law):
        value = getattr(law, field.name)
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            values[field.name] = in_other_units(value)
        elif field_types(type(law))[field.name].holds in ("number", "numbers") and value is not None:
            if field.name not in known_units:
                raise LookupError(field.name)
            by = factor(known_units[field.name])
            values[field.name] = tuple(by * x for x in value) if isinstance(value, tuple) else by * value
    return replace_leaf(law, values)
