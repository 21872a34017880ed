"""The errata of the paper, each with its proof; whatever can be checked by computation is checked in this run."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

__all__ = ["Erratum"]


@dataclass(frozen=True, eq=False)
class Erratum:
    """An error in the printed paper.

    Parameters
    ----------
    equation : str
        Its place in the paper.
    printed, right : str
        The printed text, and the correct one.
    proof : str
        The proof.
    holds : bool or None
        Whether the check in this run confirms it; None if there is nothing to compute.
    numbers : dict
        The numbers of the check.
    """

    equation: str
    printed: str
    right: str
    proof: str
    holds: bool | None = None
    numbers: dict[str, Any] = field(default_factory=dict)
