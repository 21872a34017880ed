"""The errata of the paper, each with its proof; what can be checked by computing is checked in this run."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

__all__ = ["Erratum"]


@dataclass(frozen=True, eq=False)
class Erratum:
    """Something printed that is not right.

    Parameters
    ----------
    equation : str
        Where it stands.
    printed, right : str
        What is printed, and what is right.
    proof : str
        Why.
    holds : bool or None
        Whether the check of this run agrees; None if there was nothing to compute.
    numbers : dict
        The numbers of the check.
    """

    equation: str
    printed: str
    right: str
    proof: str
    holds: bool | None = None
    numbers: dict[str, Any] = field(default_factory=dict)
