"""Every claim of the paper, judged by the runs of one study."""

from __future__ import annotations

from stickslip.models.drives import PiezoBeam
from stickslip.show.paper import (
    claims_beam,
    claims_comparison,
    claims_excitation,
    claims_friction,
    claims_irregular,
    claims_laws,
    claims_static,
    claims_untreated,
)
from stickslip.show.paper.amplitudes import Amplitudes
from stickslip.show.paper.beam import Beam
from stickslip.show.paper.claims_page import ClaimData, PaperClaim
from stickslip.show.paper.claims_static import static_map
from stickslip.show.paper.coexistence import coexistence
from stickslip.show.paper.omitted import omitted
from stickslip.show.paper.parameter_map import around
from stickslip.show.paper.section5_motions import motions
from stickslip.show.paper.sentences import texts
from stickslip.show.paper.solved_runs import Runs, Tell
from stickslip.show.paper.table import TableRow
from stickslip.show.paper.type_two import type_two

__all__ = ["claims", "study_of"]

#: The modules with a function for each claim, named as its text in ``sentences.toml``.
JUDGES = (
    claims_beam,
    claims_comparison,
    claims_excitation,
    claims_friction,
    claims_irregular,
    claims_laws,
    claims_static,
    claims_untreated,
)


def study_of(fast: bool, runs: Runs, table: tuple[TableRow, ...], amplitudes: Amplitudes, tell: Tell) -> ClaimData:
    """Compute the scans that claims and figures share."""
    judged, near = motions(runs, tell), around(fast, tell)
    tell("scanning static friction", 0, 2)
    scanned = static_map(fast)
    tell("scanning static friction from several starts", 1, 2)
    both = coexistence(fast)
    tell("varying the parameters that the paper leaves out", 0, 1)
    return ClaimData(
        fast, runs, table, amplitudes, judged, near, scanned, both, Beam(PiezoBeam()), type_two(runs, fast), omitted(fast), tell
    )


def claims(study: ClaimData) -> tuple[PaperClaim, ...]:
    """Every claim, in the order of the paper."""
    judges, keys, verdicts = {name: getattr(module, name) for module in JUDGES for name in module.__all__}, list(texts("claims")), []
    for i, key in enumerate(keys):
        study.tell(f"judging claims: {(judges[key].__doc__ or '').splitlines()[0].rstrip('.')}", i, len(keys))
        verdicts.append(judges[key](study))
    study.tell("judging claims", len(keys), len(keys))
    return tuple(verdicts)
