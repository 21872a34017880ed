"""The output of a format's reader: columns as they are in the file, before any interpretation."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, eq=False)
class RawColumn:
    """One column of numbers of a file.

    Parameters
    ----------
    name : str
        "" if the file has none.
    unit : str or None
    values : array (n,)
    axis : RawColumn, optional
        What the values stand over, where the file says so.
    role : str, optional
        Where the file says so; "" where it says that there is none.
    """

    name: str
    unit: str | None
    values: Any
    axis: RawColumn | None = None
    role: str | None = None


@dataclass(eq=False)
class Raw:
    """The columns of a file, what else it says, and what there is to remark."""

    format: str
    columns: list[RawColumn] = field(default_factory=list)
    info: dict[str, Any] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    table: bool = False  # columns of one table share an axis, which is one of them


def unmarked(data: bytes) -> str:
    """The text in bytes that do not say its code: UTF-8, or else Latin-1, in which all bytes are letters."""
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data.decode("latin-1")
