"""Records as Python: the expression that makes one again."""

from __future__ import annotations

import dataclasses
from typing import Any

from stickslip.basics.lazy_names import typed_name


def spelled(record: Any, depth: int = 0) -> str:
    """A record as the expression that recreates it, to the last digit.

    Examples
    --------
    >>> import stickslip as ss
    >>> spelled(ss.Harmonic(amplitude=5e-4, omega=205.0))
    'ss.Harmonic(amplitude=0.0005, omega=205.0)'
    """
    if not dataclasses.is_dataclass(record):
        return repr(record)
    typed = (f for f in dataclasses.fields(record) if f.init and not f.metadata.get("found"))  # others follow from these
    given = [(f.name, getattr(record, f.name)) for f in typed if not _is_default(f, getattr(record, f.name))]
    inner = [f"{name}={spelled(value, depth + 1)}" for name, value in given]
    whole = f"{typed_name(type(record).__name__)}({', '.join(inner)})"
    if depth or len(whole) < 80:
        return whole
    return f"{typed_name(type(record).__name__)}(\n" + "".join(f"    {line},\n" for line in inner) + ")"


def _is_default(field: dataclasses.Field[Any], value: Any) -> bool:
    if field.default_factory is not dataclasses.MISSING:
        return bool(value == field.default_factory())
    return field.default is not dataclasses.MISSING and bool(value == field.default)
