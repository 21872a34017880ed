"""What the report's template asks for, in the words in which it is shown."""

from __future__ import annotations

from collections import Counter
from typing import Any

from stickslip.paper.amplitudes import Bracket, Interval
from stickslip.paper.cases import CASES
from stickslip.paper.claims_page import CONFIRMED, NOT_CONFIRMED
from stickslip.paper.parameter_map import FULL
from stickslip.paper.words import listed, millimetres, percent, plain, speed

__all__ = ["content"]

TITLE = "Friction in a vibration-driven system: the paper, computed again"
#: The evidence figure that belongs to a claim.
EVIDENCE = {"quasi_periodic": "evidence-step-size", "all_types_by_static": "evidence-static-friction"}
SECTIONS = (
    ("equations", "Equations"),
    ("beam", "Section 3: the beam"),
    ("table", "Section 4: four angles, two laws, one experiment"),
    ("claims", "Claims"),
    ("motions", "Section 5 by multipliers and exponents"),
    ("figures", "Figures"),
    ("amplitudes", "Amplitudes that the paper leaves out"),
    ("errata", "Errata"),
    ("provenance", "Provenance"),
)


def content(result: Any, notes: list[str]) -> dict[str, Any]:
    """Everything for ``paper.html``."""
    section5 = result.amplitudes.section5
    return {
        "title": TITLE,
        "lead": _lead(result),
        "contents": _contents(result),
        "equations": result.equations,
        "table": result.table,
        "rules": sum(result.table[0].lugre_words.values()),
        "claims": result.claims,
        "motions": _motions(result),
        "around": _around(result.around),
        "evidence": EVIDENCE,
        "pictures": result.figures,
        "fast": result.fast,
        "brackets": [_bracket(b) for b in result.amplitudes.section4],
        "common": f"{_span(result.amplitudes.common)} mm" if result.amplitudes.common else "no amplitude serves",
        "round_values": section5.round_values,
        "chosen": section5.chosen,
        "intervals": {n: f"{_span(getattr(section5, n))} mm" for n in ("frequencies", "only_three_and_four")}
        | {"period_two": f"{section5.period_two.low.text()} to {section5.period_two.high.text()} mm"},
        "errata": result.errata,
        "provenance": result.provenance,
        "notes": notes,
    }


def _contents(result: Any) -> list[tuple[str, str, list[tuple[str, str]]]]:
    """Anchor and name of every section, with those of the claims and figures in it."""
    below = {
        "claims": [(f"claim-{c.key}", f"{c.section}: {c.claim}") for c in result.claims],
        "figures": [(p.key, p.title) for p in result.figures if p.section not in ("evidence", "around", "3")],
    }
    return [(name, text, below.get(name, [])) for name, text in SECTIONS]


def _lead(result: Any) -> str:
    counts = Counter(c.verdict for c in result.claims)
    rest = len(result.claims) - counts[CONFIRMED] - counts[NOT_CONFIRMED]
    worst = max(max(abs(r.coulomb - r.experiment.coulomb), abs(r.lugre - r.experiment.lugre)) for r in result.table)
    types = all(r.type == r.experiment.type for r in result.table)
    return (
        f"{'All' if types else 'Not all'} printed types of section 4 come out again, and its simulated mean velocities to within "
        f"{speed(worst, 1)}. Of {len(result.claims)} "
        f"claims {counts[CONFIRMED]} are confirmed, {counts[NOT_CONFIRMED]} are not, and {rest} cannot be decided from the text. "
        f"{len(result.errata)} errata are listed with their proofs."
    )


def _motions(result: Any) -> list[dict[str, Any]]:
    """The rows of section 5's table, figure by figure."""
    return [
        {
            "case": case, "motion": result.motions[case.figure], "twin": _zero(result.motions[case.figure].twin),
            "drawn": any(p.key == f"figure-{case.figure:02}" for p in result.figures),
        }
        for case in CASES
    ]  # fmt: skip


def _zero(multiplier: float | None) -> str:
    return "none" if multiplier is None else "0, exactly" if multiplier == 0 else plain(multiplier, 3)


def _around(found: Any) -> dict[str, Any]:
    top = found.largest
    return {
        "points": found.grid.period.size,
        "shares": [(name, percent(share)) for name, share in found.shares.items()],
        "flips": listed(found.rounded_flips),
        "largest": f"{plain(top['exponent'], 2)} ± {plain(top['error'], 1)}",
        "where": f"A = {millimetres(top['amplitude'], 3)}, μ₀ = {plain(top['mu0'], 3)}",
        "full": FULL,
    }


def _span(interval: Interval, digits: int = 4) -> str:
    if interval is None:
        return "none"
    low, high = (f"{1e3 * end:.{digits}f}" for end in interval)
    return low if low == high else f"{low} to {high}"


def _bracket(b: Bracket) -> dict[str, Any]:
    e = b.experiment
    inside = b.good is not None and b.good[0] - 1e-9 <= e.amplitude <= b.good[1] + 1e-9
    remarks = [] if b.joint else [f"the LuGre velocity misses its rounding by {plain(1e3 * b.misses, 2)} mm/s where the other two hold"]
    if not inside:
        remarks.append(
            "the amplitude taken lies between two steps of this scan"
            if b.good and b.good[1] - b.good[0] < 3 * b.step
            else "the amplitude taken is outside"
        )
    return {
        "tilt": e.tilt_deg,
        **{name: _span(getattr(b, name)) for name in ("coulomb", "lugre", "type", "joint")},
        "taken": millimetres(e.amplitude).removesuffix(" mm"),
        "remark": listed(remarks) if remarks else f"scanned in steps of {plain(1e6 * b.step, 1)} µm",
    }
