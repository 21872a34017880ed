"""Units that channels without one may have: suggestions to type, by the words of a name and the size of the values. None is taken."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

import numpy as np

from stickslip.records.channel import Channel

_TURN = 6.5  # of an angle in radians, beyond which degrees are likelier
_FAST = 5.0  # of a velocity in m/s, beyond which mm/s are likelier
#: Words in names, and the unit that they suggest; more special ones first.
_WORDS = (
    (r"time|zeit|timestamp|tick|elapsed|^t$", "s"),
    (r"torque|drehmoment|moment|^tau|effort|^tq", "N m"),
    (r"current|strom|amp|^cur|^i$|^i_|_i$", "A"),
    (r"rpm|drehzahl", "rpm"),
    (r"omega|ang.*vel|gyro|dq|qd|joint_?vel", "rad/s"),
    (r"angle|winkel|observation|theta|phi|^q\d*$|joint|enc|count|tick", "rad"),
    (r"acc|^a$", "m/s^2"),
    (r"press|druck|^p$", "bar"),
    (r"volt|spann|^u$", "V"),
    (r"force|kraft|load|fric|reib|normal|cell|^f\d*$|^f_|^n$", "N"),
    (r"vel|speed|geschw|ldv|laser|vibro|^v\d*$|^v_", "m/s"),
    (r"pos|disp|weg|stroke|dist|lvdt|way|^[xyz]\d*$|^s$", "mm"),
)


def without_unit(channels: Iterable[Channel]) -> dict[str, Any]:
    """Names and values of the channels, and of the axes beside them, whose unit is not known."""
    bare: dict[str, Any] = {}
    for c in channels:
        if c.axis_unit is None and c.axis_name not in (None, "sample") and c.over_time:
            bare[str(c.axis_name)] = c.t
        if c.unit is None:
            bare[c.name] = c.values
    return bare


def typed_units(bare: dict[str, Any]) -> str:
    """What to type for channels without a unit, each with a unit that it may have.

    Examples
    --------
    >>> typed_units({"LDV": [0.1, 0.2], "Kraft": [2.0, 3.0]})
    'units={"LDV": "m/s", "Kraft": "N"}'
    """
    pairs = ", ".join(f'"{name}": "{candidate_unit(name, values)}"' for name, values in bare.items())
    return f"units={{{pairs}}}"


def candidate_unit(name: str, values: Any) -> str:
    """A unit that a channel may have; "1" where its name says nothing.

    Parameters
    ----------
    name : str
    values : array (n,)
        As in the file.

    Examples
    --------
    >>> [candidate_unit(name, [0.0, 90.0]) for name in ("LDV", "Kraft", "angle", "lvdt_2", "battery")]
    ['mm/s', 'N', 'deg', 'mm', '1']
    """
    unit = next((unit for pattern, unit in _WORDS if re.search(pattern, name.strip(), re.I)), "1")
    numbers = np.real(np.asarray(values))
    largest = float(np.max(np.abs(numbers[np.isfinite(numbers)]), initial=0.0))
    if unit == "rad" and largest > _TURN:
        return "deg"
    if unit == "m/s" and largest > _FAST:
        return "mm/s"
    if unit == "s" and len(numbers) > 1 and float(np.median(np.abs(np.diff(numbers)))) >= 1.0:
        return "ms"
    return unit
