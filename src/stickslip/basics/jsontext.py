"""Conversion to strict JSON."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any


def as_plain(
    value: Any, key: Callable[[Any], str] = str, other: Callable[[Any], Any] = str, number: Callable[[float], Any] = lambda x: x
) -> Any:
    """A value as dicts, lists, text and numbers: arrays become lists.

    Parameters
    ----------
    value : object
    key : callable
        Converts the keys of a mapping.
    other : callable
        Converts anything that JSON does not support.
    number : callable
        Converts a float; by default it is unchanged, also if it is NaN, which Python's JSON supports and others do not.

    Returns
    -------
    dict, list, str, int, float, bool or None

    Examples
    --------
    >>> as_plain({"a": (1, float("nan")), 3: ValueError})
    {'a': [1, nan], '3': "<class 'ValueError'>"}
    """
    if isinstance(value, Mapping):
        return {key(k): as_plain(v, key, other, number) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [as_plain(v, key, other, number) for v in value]
    if hasattr(value, "tolist"):
        return as_plain(value.tolist(), key, other, number)
    if isinstance(value, float):
        return number(value)
    return value if isinstance(value, (str, int, bool, type(None))) else other(value)


def strict(value: Any, key: Callable[[Any], str] = str, other: Callable[[Any], Any] = str) -> Any:
    """A value that strict JSON can hold: as by `as_plain`, with None for NaN and infinite numbers.

    Examples
    --------
    >>> strict({"a": (1, 2.5), 3: float("nan")})
    {'a': [1, 2.5], '3': None}
    """
    return as_plain(value, key, other, lambda number: number if math.isfinite(number) else None)
