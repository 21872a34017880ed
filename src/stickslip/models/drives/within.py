"""The drives of a machine, in any of its parts."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from typing import Any

from stickslip.basics.fields import is_record
from stickslip.models.drives.drive_adapter import lacking


def drives_within(record: Any) -> Iterator[Any]:
    """The drives of a machine, whatever part has them.

    Examples
    --------
    >>> import stickslip as ss
    >>> [type(drive).__name__ for drive in drives_within(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4))]
    ['Harmonic']
    """
    parts = record if isinstance(record, tuple) else [getattr(record, field.name) for field in fields(record)] if is_record(record) else ()
    for part in parts:
        if not lacking(part):
            yield part
        elif is_record(part) or isinstance(part, tuple):
            yield from drives_within(part)


def with_drives(record: Any, change: Callable[[Any], Any]) -> Any:
    """A machine with each drive, whatever part has it, replaced by what `change` makes of it; itself where it has none.

    Examples
    --------
    >>> import stickslip as ss
    >>> rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4)
    >>> float(with_drives(rig, lambda drive: drive.replace(amplitude=6e-4)).drive.amplitude)
    0.0006
    """
    if isinstance(record, tuple):
        return tuple(with_drives(part, change) for part in record)
    if not isinstance(record, type) and not lacking(record):
        return change(record)
    if not is_record(record):
        return record
    parts = {field.name: getattr(record, field.name) for field in fields(record) if field.init}
    changed = {name: made for name, part in parts.items() if _differs(part, made := with_drives(part, change))}
    return replace(record, **changed) if changed else record


def _differs(part: Any, made: Any) -> bool:
    """Whether something in a part was replaced."""
    if isinstance(part, tuple):
        return any(_differs(one, other) for one, other in zip(part, made, strict=True))
    return made is not part
