"""The errata of the paper, each with its proof; what can be checked by computing is checked in this run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from stickslip.paper.amplitudes import Amplitudes
from stickslip.paper.table import Row

__all__ = ["Erratum", "errata"]


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


def errata(table: tuple[Row, ...], amplitudes: Amplitudes) -> tuple[Erratum, ...]:
    """Every erratum, in the order of the paper."""
    from stickslip.paper import errata_checks as check

    checks: tuple[Callable[[], Erratum], ...] = (
        check.at_rest,
        check.beam_equation,
        check.patch_moment,
        check.transient,
        lambda: check.weight(table),
        lambda: check.incline(table),
        check.figure_numbers,
        lambda: check.third_type(table),
        check.steady_velocity,
        lambda: check.missing_amplitudes(amplitudes),
        check.letter,
        check.third_ratio,
        check.ratios,
    )
    return tuple(make() for make in checks)
