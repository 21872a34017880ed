"""Seeds of a search."""

from __future__ import annotations

from typing import Any

__all__ = ["nested_seeds"]


def nested_seeds(problem: Any, starts: int, seed: int) -> list[Any]:
    """None."""
    return []
