"""The two ends of a range as people type them: numbers, None, and text with a unit."""

from __future__ import annotations

from typing import Any

from stickslip.basics.fields import number


def typed_ends(given: Any, unit: str) -> tuple[float | None, float | None]:
    """The ends of a range in a unit; `ValueError` says why they are none.

    Examples
    --------
    >>> typed_ends(("0.2 mm", 8e-4), "m"), typed_ends((None, 60), "m/s^2")
    ((0.0002, 0.0008), (None, 60.0))
    >>> typed_ends("12", "m")
    Traceback (most recent call last):
    ValueError: these are not two numbers
    """
    if isinstance(given, (str, bytes)) or not hasattr(given, "__len__") or not hasattr(given, "__getitem__") or len(given) != 2:
        raise ValueError("these are not two numbers")
    low, high = (None if end is None else number(end, unit or None) for end in (given[0], given[1]))
    if not all(end is None or isinstance(end, float) for end in (low, high)):
        raise ValueError("an end is not one number")
    return low, high
