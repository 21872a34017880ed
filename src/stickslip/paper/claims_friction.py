"""Claims of sections 5 to 5.4 about the friction coefficients: their ratios, their range, and the types they give."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from stickslip.paper.amplitudes import KINETIC, overlap
from stickslip.paper.borders import FOUR, all_four, exact_types, in_words, stretches
from stickslip.paper.cases import AMPLITUDE_5, CASES, rig
from stickslip.paper.claims_page import Claim, Study, judged
from stickslip.paper.solved_runs import batch

__all__ = ["all_types_by_kinetic", "kinetic_range", "only_three_and_four", "ratios_above_one"]

#: Relative distance of the start of the scan from the lower end of the range, where mu_plus is zero.
ABOVE = 1e-9


def ratios_above_one(study: Study) -> Claim:
    """k1, k2, k3 > 1."""
    laws = {str(c.figure): rig(c).friction for c in CASES}
    k = {n: [law.f_plus / law.mu_plus, law.f_minus / law.mu_minus, law.mu_minus / law.mu_plus] for n, law in laws.items()}
    equal = [n for n, (k1, k2, _) in k.items() if not (k1 > 1 and k2 > 1)]
    holds = all(min(values) > 1 for values in k.values())
    return judged("ratios_above_one", holds, {"k": k}, equal=equal, first=k[equal[0]] if equal else None, thirds=[v[2] for v in k.values()])


def kinetic_range(study: Study) -> Claim:
    """.03 <= mu0 <= .21."""
    from stickslip.errors import InputError

    slope, mu_plus = math.tan(math.radians(1.7)), rig(CASES[11]).friction.mu_plus

    def allowed(mu0: float) -> bool:
        try:
            return bool(rig(CASES[-1], mu0=mu0, f0=0.21).friction.mu_plus > 0)
        except InputError:
            return False

    holds = round(slope, 2) == 0.03 and allowed(0.03) and allowed(0.21) and not allowed(slope * (1 - 1e-9)) and not allowed(0.2101)
    return judged("kinetic_range", holds, {"tan_tilt": slope, "mu_plus_at_0.03": mu_plus}, mu_plus=mu_plus)


def only_three_and_four(study: Study) -> Claim:
    """Only types three and four at larger mu0."""
    window = study.amplitudes.section5.only_three_and_four
    common = overlap(window, study.amplitudes.section5.frequencies)
    amplitudes = [AMPLITUDE_5] + ([0.5 * (common[0] + common[1])] if common else [])
    numbers = {f"{A:.4e}": _at_larger(A) for A in amplitudes}
    parts = [
        (set(found["exact"].values()) <= {"III", "IV"}, {**found, "A": A, "borders": in_words(stretches(_along_mu0(A), 0.05, 0.21), _six)})
        for A, found in zip(amplitudes, numbers.values(), strict=True)
    ]
    return judged("only_three_and_four", parts[0][0], numbers, parts, window=window, common=common, A=AMPLITUDE_5)


def _at_larger(A: float) -> dict[str, Any]:
    """Exact types and LuGre words at the printed coefficients."""
    words = batch(rig(CASES[-1], amplitude=A, mu0=KINETIC, f0=0.21), periods=200).motion_type.tolist()
    return {"exact": {float(m): str(t) for m, t in zip(KINETIC, _along_mu0(A)(KINETIC), strict=True)}, "lugre_word": words}


def _along_mu0(A: float) -> Any:
    """Exact types over the kinetic coefficient at one amplitude, by the closed borders."""
    return lambda mu0: exact_types(rig(CASES[-1], amplitude=A, mu0=mu0, f0=0.21, law="coulomb"))


def _six(mu0: float) -> str:
    return f"{mu0:.6f}"


def all_types_by_kinetic(study: Study) -> Claim:
    """All four types, but not by mu0."""
    low, high, along = math.tan(math.radians(1.7)) * (1 + ABOVE), 0.21, _along_mu0(AMPLITUDE_5)
    found = stretches(along, low, high)
    dense = np.round(np.arange(0.03, 0.2101, 0.01 if study.fast else 0.001), 4)
    solved, static, words = (
        batch(rig(CASES[-1], amplitude=AMPLITUDE_5, mu0=dense, f0=0.21, law=law), **how).motion_type
        for law, how in (("coulomb", {"settle": "auto"}), ("coulomb-static", {"settle": "auto"}), ("lugre", {"periods": 200}))
    )
    A = 1e-5 * np.arange(30, 151)
    four = all_four(A, exact_types(rig(CASES[-1], amplitude=A[:, None], mu0=np.linspace(low, high, 2001), f0=0.21, law="coulomb")))
    rows = {"Eq. 2.4": [s.word for s in found], "break-away at f₀ = 0.21": static.tolist(), "LuGre labels": words.tolist()}
    kinds = {name: [t for t in FOUR if t in types] for name, types in rows.items()}
    count = len(kinds["Eq. 2.4"])
    numbers = {
        "borders": [[str(s.word), s.low, s.high] for s in found],
        "figures": [str(t) for t in along(np.array([c.changes["mu0"] for c in CASES if c.section == "5.3"]))],
        "agree": int((solved == along(dense)).sum()),
        "tried": len(dense),
        "all_four_at": [float(four[0]), float(four[-1])] if len(four) else None,
        "types": {name: sorted(types) for name, types in kinds.items()},
    }
    parts = [(len(types) < 4, {"name": name, "kinds": types}) for name, types in kinds.items()]
    values = {"count": count, "order": in_words(found, _six), "low": low, "high": high, "amplitude": AMPLITUDE_5, "A": A, "all_four": four}
    return judged("all_types_by_kinetic", count < 4, numbers, parts, **values)
