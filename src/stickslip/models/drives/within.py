"""The drives of a machine, in any of its parts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
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
