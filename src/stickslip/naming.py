"""What the axes of a sweep are called: what the maker's own description of a number says."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from typing import Any

from stickslip.arguments import described_arguments
from stickslip.fields import told_by_field
from stickslip.quantities import axis_in, quantity

__all__ = ["axis_of", "described", "example_for"]

_START = {
    "start.x": quantity("position at the start", "m", "x"),
    "start.v": quantity("velocity at the start", "m/s", "v"),
    "start.z": quantity("inner state at the start", "m", "z"),
}


def described(name: str, make: Any = None) -> Mapping[str, Any]:
    """The description of a number of a record, or of an argument of its maker; empty where nobody described it."""
    if name in _START:
        return _START[name]
    return described_arguments(make).get(name, {}) if callable(make) else told_by_field(make, name)


def axis_of(name: str, make: Any = None) -> tuple[str, str] | None:
    """What a number is called and its unit; None where nobody knows.

    Of a function that does not describe its arguments, those that are called as the presets' mean what theirs do.

    Examples
    --------
    >>> import stickslip as ss
    >>> axis_of("link.stiffness", ss.Chain.example()), axis_of("amplitude", lambda amplitude: None)
    (('stiffness of the spring k', 'N/m'), ('amplitude of the inner mass A', 'm'))
    """
    told = described(str(name), make)
    return axis_in(told) or (axis_in(_of_presets().get(str(name), {})) if make is None or callable(make) else None)


def example_for(name: str) -> float:
    """An ordinary value of an argument that is called as the presets'; 1 of others."""
    return float(_of_presets().get(name, {}).get("example", 1.0))


@functools.cache
def _of_presets() -> dict[str, Mapping[str, Any]]:
    """The arguments of the presets, those of the first that has one of this name."""
    from stickslip.presets import PRESETS

    makers: list[Callable[..., Any]] = list(PRESETS.values())
    return {name: told for make in reversed(makers) for name, told in described_arguments(make).items()}
