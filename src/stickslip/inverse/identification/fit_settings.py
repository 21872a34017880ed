"""How records are compared with a model: the arguments of `identify` that are not the records, the maker and its numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, eq=False)
class FitSettings:
    """Arguments of `identify` as they are given; its docstring says what they are.

    Examples
    --------
    >>> FitSettings(noise=1e-3).using, FitSettings().starts
    ('auto', 64)
    """

    using: str = "auto"
    noise: float | None = None
    frequency: float | None = None
    load: float | None = None
    settle: int | str = "auto"
    transient: bool = False
    sensor: dict[str, Any] | None = None
    harmonics: Any = None
    body: str | None = None
    starts: int = 64
    seed: int = 0
    rtol: float = 1e-8
