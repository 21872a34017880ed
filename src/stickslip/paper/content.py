"""The values that the report's template uses."""

from __future__ import annotations

from typing import Any

from stickslip.paper.amplitudes import Interval
from stickslip.paper.cases import CASES
from stickslip.paper.parameter_map import FULL
from stickslip.paper.sentences import filled, texts
from stickslip.paper.words import listed, percent, plain

__all__ = ["content"]

#: The evidence figure for a claim.
EVIDENCE = {"quasi_periodic": "evidence-step-size", "all_types_by_static": "evidence-static-friction"}


def content(result: Any, notes: list[str]) -> dict[str, Any]:
    """All values for ``paper.html``."""
    data = {"result": result, "cases": CASES, "contents": _contents(result), "evidence": EVIDENCE, "full": FULL, "notes": notes}
    return {**_head(result), **data, **{say.__name__: say for say in (listed, percent, plain, span)}}


def _contents(result: Any) -> list[tuple[str, str, list[tuple[str, str]]]]:
    """Anchor and name of every section, with those of its claims and figures."""
    below = {
        "claims": [(f"claim-{c.key}", f"{c.section}: {c.claim}") for c in result.claims],
        "figures": [(p.key, p.title) for p in result.figures if p.section not in ("evidence", "around", "3")],
    }
    return [(name, text, below.get(name, [])) for name, text in texts("sections").items()]


def _head(result: Any) -> dict[str, str]:
    """The title, and the results in two sentences."""
    verdicts = [c.verdict for c in result.claims]
    worst = max(max(abs(r.coulomb - r.experiment.coulomb), abs(r.lugre - r.experiment.lugre)) for r in result.table)
    types = all(r.type == r.experiment.type for r in result.table)
    found: dict[str, str] = filled(texts("page"), {"verdicts": verdicts, "worst": worst, "types": types, "errata": len(result.errata)})
    return found


def span(interval: Interval) -> str:
    """An interval of amplitudes in mm, without the unit."""
    if interval is None:
        return "none"
    low, high = (f"{1e3 * end:.4f}" for end in interval)
    return low if low == high else f"{low} to {high}"
