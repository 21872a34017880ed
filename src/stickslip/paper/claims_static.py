"""The claim of section 5.4 about the static friction coefficient: all four types, judged from rest and from other starts."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.paper.cases import AMPLITUDE_5, CASES, rig
from stickslip.paper.claims_page import Claim, Part, Study, verdict
from stickslip.paper.coexistence import STARTS, Coexistence, Range
from stickslip.paper.solved_runs import batch
from stickslip.paper.words import listed, millimetres, plain

__all__ = ["all_types_by_static", "static_map"]

FOUR = ("I", "II", "III", "IV")
#: Pairs of thresholds (slip_ratio, dwell) under which the LuGre words are read; the first is the default.
RULES = ((0.75, 0.03), (0.5, 0.03), (0.9, 0.03), (0.75, 0.01), (0.75, 0.08))


def static_map(fast: bool) -> dict[str, Any]:
    """Motion types over static coefficient and amplitude: exact with break-away at f0, and the LuGre words of each rule."""
    printed = [c.changes["f0"] for c in CASES if c.section == "5.4"]
    f0 = np.unique(np.round(np.concatenate([np.linspace(0.18, 1.0, 22 if fast else 83), printed]), 6))
    A = np.round(np.arange(0.5e-3, 1.5001e-3, 5e-5 if fast else 1e-5), 9)
    grid = {"tilt_deg": 1.7, "amplitude": A[:, None], "f0": f0[None, :]}
    exact = batch(rig(CASES[-1], law="coulomb-static", **grid), settle="auto").motion_type
    rules = RULES[:1] if fast else RULES
    words = {
        rule: batch(rig(CASES[-1], **grid), periods=60, settle=40, rtol=1e-5, slip_ratio=rule[0], dwell=rule[1]).motion_type
        for rule in rules
    }
    at = [int(np.argmin(abs(f0 - value))) for value in printed]
    return {"f0": f0, "amplitude": A, "exact": exact, "words": words, "printed": at}


def _most(types: Any) -> tuple[int, int]:
    """Largest number of the four types along a row, and how many rows have all four."""
    counts = [len(set(row) & set(FOUR)) for row in types.tolist()]
    return max(counts), sum(n == 4 for n in counts)


def all_types_by_static(study: Study) -> Claim:
    """All four types by f0."""
    found = study.static_map
    A, at, n, default = found["amplitude"], found["printed"], len(found["amplitude"]), next(iter(found["words"]))
    chosen = int(np.argmin(abs(A - AMPLITUDE_5)))
    figures = {"exact": _most(found["exact"][:, at]), "lugre": _most(found["words"][default][:, at])}
    whole = {"exact": found["exact"], **{f"LuGre {r[0]:g}/{r[1]:g}": words for r, words in found["words"].items()}}
    wide = {name: A[[len(set(row) & set(FOUR)) == 4 for row in types.tolist()]] for name, types in whole.items()}
    here = {name: set(types[chosen].tolist()) & set(FOUR) for name, types in whole.items()}
    parts = (
        Part("Eq. 2.4", verdict(False), "f₀ does not enter Coulomb friction as the paper writes it"),
        Part(
            "the four figures, exact with break-away at f₀",
            verdict(figures["exact"][1]),
            _figures_text(found, "exact", figures["exact"][0]),
        ),
        Part("the four figures, LuGre labels", verdict(figures["lugre"][1]), _figures_text(found, default, figures["lugre"][0])),
        Part(
            "the four figures, LuGre labels, each from a separate initial state",
            verdict(_any_start(study.coexistence)),
            f"at most {_most_of_any(study.coexistence)} of the four at any of {len(study.coexistence.fine)} amplitudes",
        ),
        Part("the whole range 0.18 ≤ f₀ ≤ 1 at the inferred 0.6 mm", verdict(len(here["exact"]) == 4), _whole_text(here)),
        Part("the whole range at other amplitudes", verdict(len(wide["exact"])), _wide_text(wide, n)),
    )
    return Claim(
        "all_types_by_static",
        "5.4",
        "Changing the static coefficient gives all four types of motion, as Figures 27 to 30 show.",
        "From these figures, one can find that [...] through adjusting the static friction coefficient, one can obtain all the four "
        "types movement forms",
        verdict(figures["exact"][1] or figures["lugre"][1] or len(here["exact"]) == 4 or _any_start(study.coexistence)),
        (
            f"Scan of {n} amplitudes from {millimetres(A[0], 1)} to {millimetres(A[-1], 1)} by {len(found['f0'])} static coefficients "
            "from 0.18 to 1: at none of these amplitudes do the four printed ones show the four types, neither exactly nor by the LuGre "
            "labels at the default thresholds.",
            f"At f₀ = 1 {_still(found, study.coexistence)}. Rest and presliding are not among the four types.",
            *_coexisting(study.coexistence),
            "In a wider reading (any f₀ for each type, at one well-chosen amplitude) the claim holds: with break-away at f₀ the exact "
            "motion passes through "
            f"IV, III, I and II {_span(wide['exact'], n)}.",
        ),
        "moderate: no amplitude is printed, and the label of a LuGre motion depends on thresholds that the paper does not state",
        {
            "most_types_in_the_figures": {k: v[0] for k, v in figures.items()},
            "amplitudes": n,
            "whole_range": {k: {"count": len(v), "ends": [float(v[0]), float(v[-1])] if len(v) else None} for k, v in wide.items()},
            "coexistence": study.coexistence.as_data(),
        },
        parts,
    )


def _any_start(both: Coexistence) -> bool:
    """Whether the four printed f0 show the four types at some amplitude, each from a start of its own choice."""
    return _most_of_any(both) == 4


def _most_of_any(both: Coexistence) -> int:
    """The largest number of the four types that the four figures can show at one amplitude."""
    return max(both.types(i) for i in range(len(both.fine)))


def _figures_text(found: dict[str, Any], rule: Any, most: int) -> str:
    types = found["exact"] if rule == "exact" else found["words"][rule]
    chosen = int(np.argmin(abs(found["amplitude"] - AMPLITUDE_5)))
    return f"at most {most} of the four at any of {len(types)} amplitudes; at 0.6 mm {listed(types[chosen, found['printed']])}"


def _still(found: dict[str, Any], both: Coexistence) -> str:
    """What the last of the four figures can show."""
    last, n = found["printed"][-1], len(found["amplitude"])
    rest = (found["exact"][:, last] == "rest").sum()
    return (
        f"the exact body rests at {rest} of the {n} amplitudes: the drive force stays below break-away, so the body stays at rest once "
        "it has stopped" + "".join(f". The LuGre body {_both(r)}" for r in both.ranges if r.f0 == 1.0)
    )


def _both(r: Range) -> str:
    """Where a LuGre body has two motions."""
    low, high = r.slide.low, r.rest.high
    return (
        "slides from some initial states, and from others only deflects its bristles or creeps, at amplitudes from "
        f"{millimetres(low.value, 3)} (below, the sliding motion {low.why}) to {millimetres(high.value, 3)} (above, the motion near rest "
        f"{high.why}), by continuation of both; these initial states reach both from "
        f"{millimetres(r.found[0], 2)} to {millimetres(r.found[1], 2)}"
    )


def _starts() -> str:
    """The starts in words."""
    return f"v = {listed(plain(v, 2) for v in STARTS)} times Aμω at drive phase 0, bristles undeflected"


def _coexisting(both: Coexistence) -> tuple[str, ...]:
    """What several starts find, as sentences."""
    two, cases = int(both.two.sum()), both.two.size
    others = [
        f"at f₀ = {r.f0:g} from {millimetres(r.slide.low.value, 3)} to {millimetres(r.rest.high.value, 3)}"
        for r in both.ranges
        if r.f0 != 1.0
    ]
    return (
        f"From {len(STARTS)} starts ({_starts()}): at {two} of {cases} pairs of f₀ and A two LuGre motions coexist, one that slides and "
        "one near rest"
        + (f", besides f₀ = 1 {listed(others)}" if others else "")
        + f". The exact motion is the same from every initial state at {cases - int((both.exact > 1e-9).sum())} of {cases} pairs.",
        f"Even with a separate initial state for each of the four figures, at most {_most_of_any(both)} of the four types appear at any of "
        f"{len(both.fine)} amplitudes.",
    )


def _whole_text(here: dict[str, set[str]]) -> str:
    return "; ".join(f"{name}: {listed(t for t in FOUR if t in found)}" for name, found in here.items())


def _wide_text(wide: dict[str, Any], n: int) -> str:
    """At how many amplitudes each way of reading finds all four."""
    notes = {name: ", slip ratio/dwell" if name.startswith("LuGre") else " with break-away at f₀" for name in wide}
    return "all four appear " + "; ".join(f"{_span(A, n)} ({name}{notes[name]})" for name, A in wide.items())


def _span(A: Any, n: int) -> str:
    return f"at {len(A)} of {n} amplitudes, {millimetres(A[0], 2)} to {millimetres(A[-1], 2)}" if len(A) else "at no amplitude"
