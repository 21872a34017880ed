"""The normal force on the contact of one body, given as a number or as a function."""

from __future__ import annotations

from typing import Any


def normal_load(model: Any, t: Any, x: Any) -> Any:
    """Normal force N on the contact [N]; a model's `load` is a number, or a function of time and position."""
    return model.load(t, x) if callable(model.load) else model.load
