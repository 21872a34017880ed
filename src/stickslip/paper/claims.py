"""The claims page: each claim of the paper with a verdict that was computed, its evidence, and how sure it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from stickslip.drives import PiezoBeam
from stickslip.paper.amplitudes import Amplitudes
from stickslip.paper.around import Around, around
from stickslip.paper.beam import Beam
from stickslip.paper.coexistence import Coexistence, coexistence
from stickslip.paper.motions import Motion, motions
from stickslip.paper.runs import Runs, Tell
from stickslip.paper.table import Row

__all__ = ["CONFIRMED", "NOT_CONFIRMED", "UNDECIDED", "VERDICTS", "Claim", "Part", "Study", "claims", "study_of", "verdict"]

CONFIRMED, NOT_CONFIRMED, UNDECIDED = "confirmed", "not confirmed", "cannot be decided from the text"
VERDICTS = (CONFIRMED, NOT_CONFIRMED, UNDECIDED)


@dataclass(frozen=True)
class Part:
    """A claim about one case or one reading, when the whole claim has several."""

    label: str
    verdict: str
    evidence: str


@dataclass(frozen=True, eq=False)
class Claim:
    """One claim of the paper.

    Parameters
    ----------
    key : str
        Short name.
    section : str
        Where the paper makes it.
    claim : str
        What is claimed, in a sentence.
    quote : str
        The paper's own words.
    verdict : str
        One of `VERDICTS`.
    evidence : tuple of str
        Sentences with the numbers of this run.
    certainty : str
        "high", "moderate" or "low", and why.
    numbers : dict
        The same numbers for machines, SI units.
    parts : tuple of Part
        Verdicts case by case or reading by reading, where there are several.
    """

    key: str
    section: str
    claim: str
    quote: str
    verdict: str
    evidence: tuple[str, ...]
    certainty: str
    numbers: dict[str, Any] = field(default_factory=dict)
    parts: tuple[Part, ...] = ()


@dataclass(frozen=True, eq=False)
class Study:
    """What the claims are judged on."""

    fast: bool
    runs: Runs
    table: tuple[Row, ...]
    amplitudes: Amplitudes
    motions: dict[int, Motion]
    around: Around
    static_map: dict[str, Any]
    coexistence: Coexistence
    beam: Beam
    tell: Tell


def study_of(fast: bool, runs: Runs, table: tuple[Row, ...], amplitudes: Amplitudes, tell: Tell) -> Study:
    """Do the scans that claims and figures share."""
    from stickslip.paper.claims_static import static_map

    judged, near = motions(runs, tell), around(fast, tell)
    tell("scanning static friction", 0, 2)
    scanned = static_map(fast)
    tell("scanning static friction from several starts", 1, 2)
    return Study(fast, runs, table, amplitudes, judged, near, scanned, coexistence(fast), Beam(PiezoBeam()), tell)


def verdict(holds: Any) -> str:
    """Confirmed or not."""
    return CONFIRMED if bool(holds) else NOT_CONFIRMED


def claims(study: Study) -> tuple[Claim, ...]:
    """Every claim, in the order of the paper."""
    judges, found = _judges(), []
    for i, judge in enumerate(judges):
        study.tell(f"judging claims: {(judge.__doc__ or '').splitlines()[0].rstrip('.')}", i, len(judges))
        found.append(judge(study))
    study.tell("judging claims", len(judges), len(judges))
    return tuple(found)


def _judges() -> tuple[Callable[[Study], Claim], ...]:
    from stickslip.paper import (
        claims_beam as beam,
        claims_comparison as comparison,
        claims_excitation as excitation,
        claims_friction as friction,
        claims_irregular as irregular,
        claims_laws as laws,
        claims_static as static,
    )

    return (
        laws.bristle_is_slow,
        laws.dahl_without_stick_slip,
        comparison.anisotropy,
        beam.sum_of_modes,
        beam.sinusoidal_tip,
        comparison.folding_coulomb,
        comparison.folding_lugre,
        comparison.four_types,
        comparison.six_groups,
        comparison.closer_in_number,
        comparison.closer_in_shape,
        comparison.type_four_same,
        excitation.harmonic,
        excitation.all_types_by_amplitude,
        excitation.always_periodic,
        excitation.omega_as_amplitude,
        friction.ratios_above_one,
        friction.kinetic_range,
        irregular.quasi_periodic,
        irregular.period_two,
        friction.only_three_and_four,
        static.all_types_by_static,
        friction.all_types_by_kinetic,
    )
