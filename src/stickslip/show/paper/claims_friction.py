"""Claims of sections 5 to 5.4 about the friction coefficients: their ratios, their range, and the types they give."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from stickslip.show.paper.borders import FOUR, exact_types, in_words, stretches
from stickslip.show.paper.cases import AMPLITUDE_5, CASES, rig
from stickslip.show.paper.claims_page import IN_PART, ClaimData, PaperClaim, judged, together
from stickslip.show.paper.one_amplitude import KINETIC
from stickslip.show.paper.readings import PRINTED_READING, STATED, Reading
from stickslip.show.paper.solved_runs import batch

__all__ = ["all_types_by_kinetic", "kinetic_range", "only_three_and_four", "ratios_above_one"]

#: Relative distance of the start of the scan from the lower end of the range, where mu_plus is zero.
ABOVE = 1e-9
#: The round amplitude nearest to the one taken at which Eq. 2.4 satisfies most [m].
ROUND = 6e-4


def ratios_above_one(study: ClaimData) -> PaperClaim:
    """k1, k2, k3 > 1."""
    laws = {str(c.figure): rig(c).friction for c in CASES}
    k = {n: [law.f_plus / law.mu_plus, law.f_minus / law.mu_minus, law.mu_minus / law.mu_plus] for n, law in laws.items()}
    equal = [n for n, (k1, k2, _) in k.items() if not (k1 > 1 and k2 > 1)]
    thirds = all(values[2] > 1 for values in k.values())
    holds = IN_PART if equal and thirds else thirds
    parts: list[tuple[Any, dict[str, Any]]] = [(thirds, {}), (not equal, {})]
    return judged(
        "ratios_above_one", holds, {"k": k}, parts, equal=equal, first=k[equal[0]] if equal else None, thirds=[v[2] for v in k.values()]
    )


def kinetic_range(study: ClaimData) -> PaperClaim:
    """0.03 <= mu0 <= 0.21."""
    from stickslip.basics.errors import InputError

    slope, mu_plus = math.tan(math.radians(1.7)), rig(CASES[11]).friction.mu_plus

    def allowed(mu0: float) -> bool:
        try:
            return bool(rig(CASES[-1], mu0=mu0, f0=0.21).friction.mu_plus > 0)
        except InputError:
            return False

    holds = round(slope, 2) == 0.03 and allowed(0.03) and allowed(0.21) and not allowed(slope * (1 - 1e-9)) and not allowed(0.2101)
    return judged("kinetic_range", holds, {"tan_tilt": slope, "mu_plus_at_0.03": mu_plus}, mu_plus=mu_plus)


def only_three_and_four(study: ClaimData) -> PaperClaim:
    """Only types three and four at larger mu0."""
    section5 = study.amplitudes.section5
    windows = {s.reading.breakaway: s.window("three_and_four") for s in section5.searches}
    rows = [(s.reading, A) for s in section5.searches for A in (AMPLITUDE_5, ROUND)]
    rows_of_types: list[dict[str, Any]] = [{"exact": types_at(r, A), "A": A, "reading": r, "borders": _borders(r, A)} for r, A in rows]
    parts = [(set(row["exact"].values()) <= {"III", "IV"}, row) for row in rows_of_types]
    words = batch(rig(CASES[-1], amplitude=AMPLITUDE_5, mu0=KINETIC, f0=0.21), periods=200).motion_type.tolist()
    numbers = {
        "types": [{"breakaway": row["reading"].breakaway, "A": row["A"], "exact": row["exact"]} for row in rows_of_types],
        "windows": windows,
    }
    return judged("only_three_and_four", parts[0][0], numbers, parts, A=AMPLITUDE_5, labels=words, search=section5.stated)


def types_at(reading: Reading, A: float) -> dict[float, str]:
    """Exact types at the printed coefficients of Figures 24 to 26."""
    return {float(m): str(t) for m, t in zip(KINETIC, along_mu0(reading, A)(KINETIC), strict=True)}


def along_mu0(reading: Reading, A: float) -> Any:
    """Exact types over the kinetic coefficient at one amplitude."""
    return lambda mu0: exact_types(reading.coulomb(CASES[-1], amplitude=A, mu0=mu0, f0=0.21))


def _borders(reading: Reading, A: float) -> str:
    return in_words(stretches(along_mu0(reading, A), 0.05, 0.21, points=401, within=1e-8), _six)


def _six(mu0: float) -> str:
    return f"{mu0:.6f}"


def all_types_by_kinetic(study: ClaimData) -> PaperClaim:
    """All four types by amplitude, frequency and static coefficient, but not by mu0."""
    low, high = math.tan(math.radians(1.7)) * (1 + ABOVE), 0.21
    section5, by_static = study.amplitudes.section5, _by_static(study)
    by_mu0 = stretches(along_mu0(STATED, AMPLITUDE_5), low, high, points=401, within=1e-8)
    by_printed = stretches(along_mu0(PRINTED_READING, AMPLITUDE_5), low, high)
    at_round = stretches(along_mu0(PRINTED_READING, ROUND), low, high)
    kinds = {
        name: {s.word for s in intervals} & set(FOUR) for name, intervals in (("f0", by_mu0), ("mu", by_printed), ("mu, 0.6 mm", at_round))
    }
    hold = (True, bool(section5.stated.window("frequencies")), len(by_static) == 4, len(kinds["f0"]) < 4)
    numbers = {
        "borders": {name: [[str(s.word), s.low, s.high] for s in intervals] for name, intervals in (("f0", by_mu0), ("mu", by_printed))},
        "types": {name: sorted(types) for name, types in kinds.items()},
        "by_static": by_static,
        "windows": {s.reading.breakaway: s.window("not_by_kinetic") for s in section5.searches},
    }
    values: dict[str, Any] = {"order": in_words(by_mu0, _six), "printed": in_words(by_printed, _six), "at_round": in_words(at_round, _six)}
    values |= {"low": low, "A": AMPLITUDE_5, "round_A": ROUND}
    return judged("all_types_by_kinetic", together(*hold), numbers, [(part, {}) for part in hold], **values)


def _by_static(study: ClaimData) -> list[str]:
    """The types along 0.18 <= f0 <= 1 at the amplitude taken, with break-away at f0."""
    static_map = study.static_map
    row = int(np.argmin(abs(static_map["amplitude"] - AMPLITUDE_5)))
    return [t for t in FOUR if t in static_map["exact"][row]]
