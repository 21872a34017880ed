"""The claim of section 5.4 about the static friction coefficient: all four types, judged from rest and from other initial states."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.show.paper.borders import FOUR, all_four, kinds
from stickslip.show.paper.cases import AMPLITUDE_5, CASES, rig
from stickslip.show.paper.claims_page import ClaimData, PaperClaim, judged, together
from stickslip.show.paper.coexistence import STARTS
from stickslip.show.paper.solved_runs import batch
from stickslip.show.paper.words import millimetres

__all__ = ["all_types_by_static", "static_map"]

#: Pairs of thresholds (slip_ratio, dwell) for the LuGre labels; the first is the default.
RULES = ((0.75, 0.03), (0.5, 0.03), (0.9, 0.03), (0.75, 0.01), (0.75, 0.08))


def static_map(fast: bool) -> dict[str, Any]:
    """Motion types over static coefficient and amplitude: exact with break-away at f0, and the LuGre labels for each pair of thresholds."""
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


def all_types_by_static(study: ClaimData) -> PaperClaim:
    """All four types by f0."""
    static_map, both = study.static_map, study.coexistence
    A, at, n = static_map["amplitude"], static_map["printed"], len(static_map["amplitude"])
    chosen, most = int(np.argmin(abs(A - AMPLITUDE_5))), max(both.types(i) for i in range(len(both.fine)))
    figures = {"exact": static_map["exact"][:, at], "lugre": next(iter(static_map["words"].values()))[:, at]}
    shown = {name: max(kinds(row) for row in types.tolist()) for name, types in figures.items()}
    whole = {"exact": static_map["exact"], **{f"LuGre {r[0]:g}/{r[1]:g}": words for r, words in static_map["words"].items()}}
    wide = {name: all_four(A, types) for name, types in whole.items()}
    here = {name: [t for t in FOUR if t in types[chosen]] for name, types in whole.items()}
    hold = [False, shown["exact"] == 4, shown["lugre"] == 4, most == 4, len(here["exact"]) == 4, len(wide["exact"]) > 0]
    figures_hold, range_holds = any(hold[1:4]), hold[4]
    numbers = {
        "most_types_in_the_figures": shown,
        "amplitudes": n,
        "whole_range": {k: {"count": len(v), "ends": [float(v[0]), float(v[-1])] if len(v) else None} for k, v in wide.items()},
        "coexistence": both.as_data(),
    }
    return judged(
        "all_types_by_static",
        together(figures_hold, range_holds),
        numbers,
        [(part, {}) for part in hold],
        n=n,
        A=A,
        f0=static_map["f0"],
        rest=(figures["exact"][:, -1] == "rest").sum(),
        both=both,
        starts=STARTS,
        most=most,
        wide=wide,
        here=here,
        chosen={name: types[chosen] for name, types in figures.items()},
        span=_span,
        A_taken=AMPLITUDE_5,
    )


def _span(A: Any, n: int) -> str:
    return f"at {len(A)} of {n} amplitudes, {millimetres(A[0], 2)} to {millimetres(A[-1], 2)}" if len(A) else "at no amplitude"
