"""The values that the report's template uses."""

from __future__ import annotations

from typing import Any

from stickslip.basics.phrases import listed
from stickslip.show.paper.amplitudes import ROUNDING, Interval
from stickslip.show.paper.cases import AMPLITUDE_5, CASES, EXPERIMENTS
from stickslip.show.paper.one_amplitude import STATEMENTS
from stickslip.show.paper.parameter_map import FULL
from stickslip.show.paper.sentences import filled, texts
from stickslip.show.paper.words import percent, plain

__all__ = ["content", "side_by_side"]

#: The evidence figure for a claim.
EVIDENCE = {"quasi_periodic": "evidence-step-size", "all_types_by_static": "evidence-static-friction"}


def content(result: Any, notes: list[str]) -> dict[str, Any]:
    """All values for ``paper.html``."""
    data = {"result": result, "cases": CASES, "contents": _contents(result), "evidence": EVIDENCE, "full": FULL, "notes": notes}
    data |= {"rounding": ROUNDING, "taken": AMPLITUDE_5, "statements": STATEMENTS}
    return {**_head(result), **data, **{say.__name__: say for say in (listed, percent, plain, span)}}


def _contents(result: Any) -> list[tuple[str, str, list[tuple[str, str]]]]:
    """Anchor and name of every section, with those of its claims and figures."""
    below = {
        "claims": [(f"claim-{c.key}", f"{c.section}: {c.claim}") for c in result.claims],
        "figures": [(p.key, p.title) for p in result.figures if p.section not in ("evidence", "around", "3", "omitted")],
    }
    return [(name, text, below.get(name, [])) for name, text in texts("sections").items()]


def _head(result: Any) -> dict[str, str]:
    """The title, and the results in a few sentences."""
    verdicts, fit = [c.verdict for c in result.claims], result.amplitudes.fits[0]
    head: dict[str, str] = filled(texts("page"), {"verdicts": verdicts, "fit": fit, "errata": len(result.errata)})
    return head


def side_by_side(result: Any) -> dict[str, Any]:
    """All values for ``side_by_side.html``: each figure with what was printed, what we get, and why."""
    pictures = {p.key: p for p in result.figures}
    why = {key: {c.figure: filled(text, _of(result, c)) for c in CASES} for key, text in texts("side_by_side").items() if key == "case"}[
        "case"
    ]
    rows = []
    for number in range(6, 31):
        picture = pictures.get(f"figure-{number:02}")
        if picture is not None:
            rows.append({"number": number, "picture": picture, **_row(result, number, why)})
    return {"rows": rows, "fast": result.fast, "title": "Printed, computed, and why: Figures 6 to 30"}


def _row(result: Any, number: int, cases: dict[int, Any]) -> dict[str, Any]:
    """What was printed, what we get, and why, for a figure."""
    if number in cases:
        of_case: dict[str, Any] = cases[number]
        return of_case
    words, e = texts("side_by_side"), next((e for e in EXPERIMENTS if e.figure == number), None)
    if e is None:
        return dict(filled(words["types"], {"table": result.table}))
    row = next(r for r in result.table if r.experiment is e)
    bracket = next(b for b in result.amplitudes.section4 if b.experiment is e)
    printed = next(
        b for f in result.amplitudes.fits if f.reading.name == "break-away at μ, weight (M+m)g" for b in f.brackets if b.experiment is e
    )
    return dict(filled(words["experiment"], {"e": e, "row": row, "bracket": bracket, "other": printed, "say": span}))


def _of(result: Any, case: Any) -> dict[str, Any]:
    """The values of a figure of section 5."""
    data = next(c for c in result.cases if c["figure"] == case.figure)
    claims = {c.key: c for c in result.claims}
    key = {"5.1": "all_types_by_amplitude", "5.2": "omega_as_amplitude", "5.3": "only_three_and_four", "5.4": "all_types_by_static"}[
        case.section
    ]
    key = {11: "harmonic", 22: "quasi_periodic", 23: "period_two"}.get(case.figure, key)
    ratio = result.type_two.figures[case.figure]
    return {
        "case": case,
        "data": data,
        "motion": result.motions[case.figure],
        "claim": claims[key],
        "ratio": ratio,
        "velocity": data["lugre"]["mean_velocity"],
    }


def span(interval: Interval) -> str:
    """An interval of amplitudes in mm, without the unit."""
    if interval is None:
        return "none"
    low, high = (f"{1e3 * end:.4f}" for end in interval)
    return low if low == high else f"{low} to {high}"
