"""Every claim of the paper, judged by the runs of one study."""

from __future__ import annotations

from collections.abc import Callable

from stickslip.drives import PiezoBeam
from stickslip.paper import (
    claims_beam as beam,
    claims_comparison as comparison,
    claims_excitation as excitation,
    claims_friction as friction,
    claims_irregular as irregular,
    claims_laws as laws,
    claims_static as static,
)
from stickslip.paper.amplitudes import Amplitudes
from stickslip.paper.beam import Beam
from stickslip.paper.claims_page import Claim, Study
from stickslip.paper.claims_static import static_map
from stickslip.paper.coexistence import coexistence
from stickslip.paper.parameter_map import around
from stickslip.paper.section5_motions import motions
from stickslip.paper.solved_runs import Runs, Tell
from stickslip.paper.table import Row

__all__ = ["claims", "study_of"]


def study_of(fast: bool, runs: Runs, table: tuple[Row, ...], amplitudes: Amplitudes, tell: Tell) -> Study:
    """Do the scans that claims and figures share."""
    judged, near = motions(runs, tell), around(fast, tell)
    tell("scanning static friction", 0, 2)
    scanned = static_map(fast)
    tell("scanning static friction from several starts", 1, 2)
    return Study(fast, runs, table, amplitudes, judged, near, scanned, coexistence(fast), Beam(PiezoBeam()), tell)


def claims(study: Study) -> tuple[Claim, ...]:
    """Every claim, in the order of the paper."""
    judges, found = _judges(), []
    for i, judge in enumerate(judges):
        study.tell(f"judging claims: {(judge.__doc__ or '').splitlines()[0].rstrip('.')}", i, len(judges))
        found.append(judge(study))
    study.tell("judging claims", len(judges), len(judges))
    return tuple(found)


def _judges() -> tuple[Callable[[Study], Claim], ...]:
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
