"""Claims of sections 5 to 5.4 about the friction coefficients: their ratios, their range, and the types they give."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np

from stickslip.paper.cases import AMPLITUDE_5, CASES, rig
from stickslip.paper.claims import CONFIRMED, Claim, Part, Study, verdict
from stickslip.paper.runs import batch
from stickslip.paper.words import listed, millimetres, plain

__all__ = ["all_types_by_static", "kinetic_range", "only_three_and_four", "ratios_above_one", "static_map"]

FOUR = ("I", "II", "III", "IV")
#: Pairs of thresholds (slip_ratio, dwell) under which the LuGre words are read; the first is the default.
RULES = ((0.75, 0.03), (0.5, 0.03), (0.9, 0.03), (0.75, 0.01), (0.75, 0.08))


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
    dense = np.round(np.arange(0.05, 0.2101, 0.01 if study.fast else 0.001), 4)
    parts, numbers = [], {}
    for A in amplitudes:
        exact = batch(rig(CASES[-1], amplitude=A, mu0=dense, f0=0.21, law="coulomb"), settle="auto").motion_type
        at = {float(m): str(exact[int(np.argmin(abs(dense - m)))]) for m in printed}
        words = batch(rig(CASES[-1], amplitude=A, mu0=printed, f0=0.21), periods=200).motion_type.tolist()
        ok, numbers[f"{A:.4e}"] = set(at.values()) <= {"III", "IV"}, {"exact": at, "lugre_word": words}
        parts.append(
            Part(
                f"A = {millimetres(A)}",
                verdict(ok),
                f"exact: {', '.join(f'{t} at {m:g}' for m, t in at.items())} (LuGre words: {listed(words)}); over 0.05 ≤ μ₀ ≤ 0.21: "
                f"{_runs(dense, exact)}",
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
            f"it would hold for amplitudes from {millimetres(window[0], 3)} to {millimetres(window[1], 3)} and beyond."
            if window
            else "No amplitude makes it hold.",
            f"Of these, {millimetres(common[0], 3)} to {millimetres(common[1], 3)} also fit the five frequencies of section 5.2; but "
            "the figures use round numbers everywhere else."
            if common and common[0] <= common[1]
            else "None of these fits the five frequencies of section 5.2.",
        ),
        "moderate: the amplitude is inferred, and a motion next to a border looks like both of its neighbours",
        numbers,
        tuple(parts),
    )


def _runs(values: Any, types: Any) -> str:
    """Which types follow each other along a scan, with the first and last value of each."""
    edges = [0, *(np.flatnonzero(types[1:] != types[:-1]) + 1), len(types)]
    return ", ".join(f"{types[a]} from {values[a]:g} to {values[b - 1]:g}" for a, b in itertools.pairwise(edges))


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
        Part("the four figures, LuGre words", verdict(figures["lugre"][1]), _figures_text(found, default, figures["lugre"][0])),
        Part("the whole range 0.18 ≤ f₀ ≤ 1 at the inferred 0.6 mm", verdict(len(here["exact"]) == 4), _whole_text(here)),
        Part("the whole range at other amplitudes", verdict(len(wide["exact"])), _wide_text(wide, n)),
    )
    return Claim(
        "all_types_by_static",
        "5.4",
        "Changing the static coefficient gives all four types of motion, as Figures 27 to 30 show.",
        "From these figures, one can find that [...] through adjusting the static friction coefficient, one can obtain all the four "
        "types movement forms",
        verdict(figures["exact"][1] or figures["lugre"][1] or len(here["exact"]) == 4),
        (
            f"Scan of {n} amplitudes from {millimetres(A[0], 1)} to {millimetres(A[-1], 1)} by {len(found['f0'])} static coefficients "
            "from 0.18 to 1: at none of these amplitudes do the four printed ones show the four types, neither exactly nor by the LuGre "
            "words at the default thresholds.",
            f"At f₀ = 1 {_still(found)}.",
            "Read more widely, some f₀ for each type at one well-chosen amplitude, it can be had: with break-away at f₀ the exact "
            "motion passes through "
            f"IV, III, I and II {_span(wide['exact'], n)}.",
        ),
        "moderate: no amplitude is printed, and the word for a LuGre motion depends on thresholds that the paper does not state",
        {
            "most_types_in_the_figures": {k: v[0] for k, v in figures.items()},
            "amplitudes": n,
            "whole_range": {k: {"count": len(v), "ends": [float(v[0]), float(v[-1])] if len(v) else None} for k, v in wide.items()},
        },
        parts,
    )


def _figures_text(found: dict[str, Any], rule: Any, most: int) -> str:
    types = found["exact"] if rule == "exact" else found["words"][rule]
    chosen = int(np.argmin(abs(found["amplitude"] - AMPLITUDE_5)))
    return f"at most {most} of the four at any of {len(types)} amplitudes; at 0.6 mm {listed(types[chosen, found['printed']])}"


def _still(found: dict[str, Any]) -> str:
    """What the last of the four figures can show."""
    last, words = found["printed"][-1], next(iter(found["words"].values()))
    rest, slides = (found["exact"][:, last] == "rest").sum(), found["amplitude"][~np.isin(words[:, last], ("rest", "presliding"))]
    first = (
        f"the LuGre body slides only from {millimetres(slides[0], 2)} on, and else stretches its bristles"
        if len(slides)
        else "the LuGre body never slides"
    )
    return (
        f"the exact body rests at {rest} of the {len(words)} amplitudes (the drive force stays below break-away), "
        f"and {first}; rest and presliding are none of the four"
    )


def _whole_text(here: dict[str, set[str]]) -> str:
    return "; ".join(f"{name}: {listed(t for t in FOUR if t in found)}" for name, found in here.items())


def _wide_text(wide: dict[str, Any], n: int) -> str:
    """At how many amplitudes each way of reading finds all four."""
    notes = {name: ", slip ratio/dwell" if name.startswith("LuGre") else " with break-away at f₀" for name in wide}
    return "all four appear " + "; ".join(f"{_span(A, n)} ({name}{notes[name]})" for name, A in wide.items())


def _span(A: Any, n: int) -> str:
    return f"at {len(A)} of {n} amplitudes, {millimetres(A[0], 2)} to {millimetres(A[-1], 2)}" if len(A) else "at no amplitude"
