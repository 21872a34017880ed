"""What strict JSON can hold."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

__all__ = ["strict"]


def strict(value: Any, key: Callable[[Any], str] = str, other: Callable[[Any], Any] = str) -> Any:
    """A value as dicts, lists, text and numbers: arrays become lists, numbers that are no numbers null.

    Parameters
    ----------
    value : object
    key : callable
        What becomes of the keys of a mapping.
    other : callable
        What becomes of anything that JSON does not know.

    Examples
    --------
    >>> strict({"a": (1, 2.5), 3: float("nan")})
    {'a': [1, 2.5], '3': None}
    """
    if isinstance(value, Mapping):
        return {key(k): strict(v, key, other) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [strict(v, key, other) for v in value]
    if hasattr(value, "tolist"):
        return strict(value.tolist(), key, other)
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if isinstance(value, (str, int, bool, type(None))) else other(value)
