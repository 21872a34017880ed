"""Claims of sections 5 to 5.4 about the friction coefficients: their ratios, their range, and the types they give."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from stickslip.paper.borders import exact_types, in_words, stretches
from stickslip.paper.cases import AMPLITUDE_5, CASES, rig
from stickslip.paper.claims_page import CONFIRMED, Claim, Part, Study, verdict
from stickslip.paper.solved_runs import batch
from stickslip.paper.words import listed, millimetres, plain

__all__ = ["all_types_by_kinetic", "kinetic_range", "only_three_and_four", "ratios_above_one"]

FOUR = ("I", "II", "III", "IV")
#: At the lower end of the range itself mu_plus is zero: how far above it the scan begins, as a part of it.
ABOVE = 1e-9


def ratios_above_one(study: Study) -> Claim:
    """k1, k2, k3 > 1."""
    laws = {c.figure: rig(c).friction for c in CASES}
    k = {n: (law.f_plus / law.mu_plus, law.f_minus / law.mu_minus, law.mu_minus / law.mu_plus) for n, law in laws.items()}
    equal = [n for n, (k1, k2, _) in k.items() if not (k1 > 1 and k2 > 1)]
    return Claim(
        "ratios_above_one",
        "5",
        "The ratios k₁ = f₊/μ₊, k₂ = f₋/μ₋ and k₃ = μ₋/μ₊ are greater than one.",
        "Due to the physical meanings of the friction coefficients, we may know that k1 > 1, k2 > 1, k3 > 1",
        verdict(all(min(values) > 1 for values in k.values())),
        (
            f"In Figures {listed(equal)} f₀ = μ₀, so k₁ = {plain(k[equal[0]][0], 6)} and k₂ = {plain(k[equal[0]][1], 6)}: the right "
            "statement is k₁, k₂ ≥ 1."
            if equal
            else "All ratios of all figures are above one.",
            f"k₃ is above one for every tilt above zero; here from {plain(min(v[2] for v in k.values()))} to "
            f"{plain(max(v[2] for v in k.values()))}.",
        ),
        "high: from the definitions",
        {"k": {str(n): list(values) for n, values in k.items()}},
    )


def kinetic_range(study: Study) -> Claim:
    """.03 <= mu0 <= .21."""
    from stickslip.errors import InputError

    slope = math.tan(math.radians(1.7))

    def allowed(mu0: float) -> bool:
        try:
            return bool(rig(CASES[-1], mu0=mu0, f0=0.21).friction.mu_plus > 0)
        except InputError:
            return False

    holds = round(slope, 2) == 0.03 and allowed(0.03) and allowed(0.21) and not allowed(slope * (1 - 1e-9)) and not allowed(0.2101)
    return Claim(
        "kinetic_range",
        "5.3",
        "At 1.7° the kinetic coefficient can lie between 0.03 and 0.21.",
        "the range of the dynamic friction coefficient is 0.03 ≤ μ0 ≤ 0.21",
        verdict(holds),
        (
            f"The folded μ₊ is positive above tan 1.7° = {plain(slope, 6)}, which rounds to 0.03; at μ₀ = 0.03 it is "
            f"{plain(rig(CASES[11]).friction.mu_plus, 3)}.",
            "Above f₀ = 0.21 the kinetic friction would exceed the static. At the lower end itself (μ₊ = 0) Eqs 2.6 and 5.2 divide by "
            "zero, so it is excluded.",
        ),
        "high: from Eq. 4.1",
        {"tan_tilt": slope, "mu_plus_at_0.03": rig(CASES[11]).friction.mu_plus},
    )


def only_three_and_four(study: Study) -> Claim:
    """Only types three and four at larger mu0."""
    window, printed = study.amplitudes.section5.only_three_and_four, np.array([0.05, 0.10, 0.21])
    fits = study.amplitudes.section5.frequencies
    common = (max(window[0], fits[0]), min(window[1], fits[1])) if window and fits else None
    amplitudes = [AMPLITUDE_5] + ([0.5 * (common[0] + common[1])] if common and common[0] <= common[1] else [])
    parts, numbers = [], {}
    for A in amplitudes:
        at = {float(m): str(t) for m, t in zip(printed, _along_mu0(A)(printed), strict=True)}
        words = batch(rig(CASES[-1], amplitude=A, mu0=printed, f0=0.21), periods=200).motion_type.tolist()
        ok, numbers[f"{A:.4e}"] = set(at.values()) <= {"III", "IV"}, {"exact": at, "lugre_word": words}
        parts.append(
            Part(
                f"A = {millimetres(A)}",
                verdict(ok),
                f"exact: {', '.join(f'{t} at {m:g}' for m, t in at.items())} (LuGre labels: {listed(words)}); from 0.05 to 0.21: "
                f"{in_words(stretches(_along_mu0(A), 0.05, 0.21), _six)}",
            )
        )
    return Claim(
        "only_three_and_four",
        "5.3",
        "At larger kinetic coefficients (0.05 to 0.21) only types III and IV appear.",
        "for the larger dynamic friction coefficient, no matter how we change its value, [it] just displays the third and fourth type "
        "movement forms",
        parts[0].verdict,
        (
            f"At the inferred amplitude of {millimetres(AMPLITUDE_5, 1)} {'it holds' if parts[0].verdict == CONFIRMED else 'it fails'} "
            "for the printed μ₀; "
            f"it would hold for amplitudes from {millimetres(window[0])} to {millimetres(window[1], 1)} at least."
            if window
            else "No amplitude makes it hold.",
            f"Of these, {millimetres(common[0])} to {millimetres(common[1])} also fit the five frequencies of section 5.2; but "
            "the figures use round numbers everywhere else."
            if common and common[0] <= common[1]
            else "None of these fits the five frequencies of section 5.2.",
        ),
        "moderate: the amplitude is inferred, and a motion next to a border looks like both of its neighbours",
        numbers,
        tuple(parts),
    )


def _along_mu0(A: float, law: str = "coulomb") -> Any:
    """Exact types over the kinetic coefficient at one amplitude, by the closed borders."""
    return lambda mu0: exact_types(rig(CASES[-1], amplitude=A, mu0=mu0, f0=0.21, law=law))


def _six(mu0: float) -> str:
    return f"{mu0:.6f}"


def all_types_by_kinetic(study: Study) -> Claim:
    """All four types, but not by mu0."""
    low, high = math.tan(math.radians(1.7)) * (1 + ABOVE), 0.21
    found = stretches(_along_mu0(AMPLITUDE_5), low, high)
    types = {str(s.word) for s in found} & set(FOUR)
    dense = np.round(np.arange(0.03, 0.2101, 0.01 if study.fast else 0.001), 4)
    solved = batch(rig(CASES[-1], amplitude=AMPLITUDE_5, mu0=dense, f0=0.21, law="coulomb"), settle="auto").motion_type
    agree = int((solved == _along_mu0(AMPLITUDE_5)(dense)).sum())
    figures = [str(t) for t in _along_mu0(AMPLITUDE_5)(np.array([c.changes["mu0"] for c in CASES if c.section == "5.3"]))]
    A = 1e-5 * np.arange(30, 151)
    plane = exact_types(rig(CASES[-1], amplitude=A[:, None], mu0=np.linspace(low, high, 2001), f0=0.21, law="coulomb"))
    all_four = A[[len(set(row) & set(FOUR)) == 4 for row in plane.tolist()]]
    static = batch(rig(CASES[-1], amplitude=AMPLITUDE_5, mu0=dense, f0=0.21, law="coulomb-static"), settle="auto").motion_type
    words = batch(rig(CASES[-1], amplitude=AMPLITUDE_5, mu0=dense, f0=0.21), periods=200).motion_type
    rows = {"Eq. 2.4": types, "break-away at f₀ = 0.21": set(static.tolist()) & set(FOUR), "LuGre labels": set(words.tolist()) & set(FOUR)}
    parts = tuple(
        Part(f"{name}, A = 0.6 mm", verdict(len(kinds) < 4), f"types {listed(t for t in FOUR if t in kinds)} along 0.03 ≤ μ₀ ≤ 0.21")
        for name, kinds in rows.items()
    )
    return Claim(
        "all_types_by_kinetic",
        "6",
        "Amplitude, frequency and static coefficient give all four types of motion; the dynamic coefficient does not.",
        "By changing the magnitude of the amplitude and frequency of the excitation and static friction coefficient, one can obtain all "
        "the four types movement forms, except the dynamic friction coefficient",
        verdict(len(types) < 4),
        (
            f"It does, at the inferred amplitude of {millimetres(AMPLITUDE_5, 1)} too: along μ₀, from tan 1.7° = {plain(low, 6)} on, the "
            f"exact type is {in_words(found, _six)} (to {high:g})."
            if len(types) == 4
            else f"Along μ₀ the exact type is {in_words(found, _six)}: {len(types)} of the four.",
            f"The borders are closed formulas; at {agree} of {len(dense)} coefficients the exact solver gives the same type.",
            f"Figures 22 to 26 show {listed(figures)}.",
            _where(A, all_four),
            "That amplitude and frequency give all four types is confirmed above; that the static coefficient does is not.",
        ),
        "high for the exact types, whose borders are formulas; the amplitude is inferred, but a wide range of others does the same",
        {
            "borders": [[str(s.word), s.low, s.high] for s in found], "figures": figures, "agree": agree, "tried": len(dense),
            "all_four_at": [float(all_four[0]), float(all_four[-1])] if len(all_four) else None,
            "types": {name: sorted(kinds) for name, kinds in rows.items()},
        },
        parts,
    )  # fmt: skip


def _where(A: Any, good: Any) -> str:
    """At which amplitudes of a scan all four types appear along mu0."""
    if not len(good):
        return f"At none of {len(A)} amplitudes from {millimetres(A[0], 1)} to {millimetres(A[-1], 1)} do all four appear."
    return (
        f"All four appear along μ₀ at {len(good)} of {len(A)} amplitudes from {millimetres(A[0], 1)} to {millimetres(A[-1], 1)}: "
        f"those from {millimetres(good[0], 2)} to {millimetres(good[-1], 2)}."
    )
