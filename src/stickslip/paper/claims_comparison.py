"""Claims of sections 2 to 4: anisotropy, the folded incline, four types, and which law is closer to the experiment."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.paper.cases import EXPERIMENTS, rig
from stickslip.paper.claims_page import CONFIRMED, UNDECIDED, Claim, Part, Study, verdict
from stickslip.paper.solved_runs import batch
from stickslip.paper.words import listed, millimetres, percent, plain, speed

__all__ = [
    "anisotropy",
    "closer_in_number",
    "closer_in_shape",
    "folding_coulomb",
    "folding_lugre",
    "four_types",
    "six_groups",
    "type_four_same",
]


def anisotropy(study: Study) -> Claim:
    """Net motion by anisotropy."""
    A = np.linspace(2e-4, 1.5e-3, 14 if study.fast else 53)
    e, found = EXPERIMENTS[0], {}
    for law in ("coulomb", "lugre"):
        for name, tilt in (("isotropic", 0.0), ("forwards", 1.7), ("mirrored", -1.7)):
            robot = rig(e, amplitude=A, law=law, tilt_deg=tilt)
            w = np.asarray(batch(robot, periods=200).mean_velocity) / np.asarray(robot.mass_ratio * robot.velocity_scale)
            found[law, name] = w
    level = {law: float(abs(found[law, "isotropic"]).max()) for law in ("coulomb", "lugre")}
    mirror = {law: float(abs(found[law, "forwards"] + found[law, "mirrored"]).max()) for law in ("coulomb", "lugre")}
    still = A[found["coulomb", "forwards"] == 0.0]
    moving = A[found["coulomb", "forwards"] > 0.0]
    holds = (
        max(level.values()) < 1e-5
        and max(mirror.values()) < 1e-4
        and len(moving)
        and (found["lugre", "forwards"][-len(moving) :] > 0).all()
    )
    return Claim(
        "anisotropy",
        "2.2.1",
        "Anisotropic friction gives the system a net displacement in every period.",
        "the anisotropic friction will make the whole system have a net periodic displacement",
        verdict(holds),
        (
            f"With μ₊ = μ₋ the mean velocity of {len(A)} amplitudes from {millimetres(A[0], 1)} to {millimetres(A[-1], 1)} is at most "
            f"{plain(level['coulomb'], 2)} (Coulomb) and {plain(level['lugre'], 2)} (LuGre) of Aμω.",
            f"At 1.7° it is up to {plain(found['coulomb', 'forwards'].max(), 3)} Aμω, and it changes sign when μ₊ and μ₋ are exchanged "
            f"(to {plain(max(mirror.values()), 2)} of Aμω, which includes the rest of the transient).",
            f"The drive must overcome friction: at A ≤ {millimetres(still[-1], 3)} the Coulomb robot rests."
            if len(still)
            else "No amplitude here is too small to move.",
        ),
        "high: the mirror image is a symmetry of the equations, and the computed motions of both laws have it to the numbers above",
        {"isotropic_over_scale": level, "mirror_over_scale": mirror, "largest_over_scale": float(found["coulomb", "forwards"].max())},
    )


def folding_coulomb(study: Study) -> Claim:
    """Folding an incline into friction, Coulomb."""
    tilt, A = np.array([e.tilt_deg for e in EXPERIMENTS]), np.array([e.amplitude for e in EXPERIMENTS])
    folded, gravity = (
        batch(rig(EXPERIMENTS[0], tilt_deg=tilt, amplitude=A, law="coulomb", incline=i), periods=200).mean_velocity
        for i in ("folded", "gravity")
    )
    difference = abs(gravity / folded - 1)
    return Claim(
        "folding_coulomb",
        "3.2",
        "An inclined track with isotropic friction can be written as a level track with anisotropic friction: Coulomb friction.",
        "On the inclined slope, anisotropic friction is achieved. (Eqs 3.8 and 4.1)",
        verdict(difference.max() < 1e-10),
        (
            "The mean velocities of the four cases of section 4 with gravity and with folded coefficients differ by at most "
            f"{plain(difference.max(), 2)}, relative.",
        ),
        "high: exact; the constant force only shifts the two friction levels",
        {"folded": folded.tolist(), "gravity": gravity.tolist()},
    )


def folding_lugre(study: Study) -> Claim:
    """Folding an incline into friction, LuGre."""
    difference = [r.gravity / r.lugre - 1 for r in study.table]
    sizes = [abs(d) for d in difference]
    parts = tuple(
        Part(
            f"{r.experiment.tilt_deg}°",
            verdict(abs(d) < 1e-3),
            f"folded {speed(r.lugre)}, true incline {speed(r.gravity)}: {percent(d, 2, True)}",
        )
        for r, d in zip(study.table, difference, strict=True)
    )
    return Claim(
        "folding_lugre",
        "3.2",
        "The same holds for LuGre friction.",
        "On the inclined slope, anisotropic friction is achieved. (Eqs 3.8 and 4.1, used in Eq. 2.6)",
        verdict(max(sizes) < 1e-3),
        (
            f"Gravity acts on the bristle too: on the true incline the mean velocity differs by {percent(min(sizes))} to "
            f"{percent(max(sizes))}.",
            "The paper's own numbers are those of the folded model, and so are all others here.",
        ),
        "high: both are converged; folding is a different model, not an approximation that can be refined",
        {"folded": [r.lugre for r in study.table], "gravity": [r.gravity for r in study.table]},
        parts,
    )


def four_types(study: Study) -> Claim:
    """Four types of motion."""
    parts = tuple(
        Part(
            f"{r.experiment.tilt_deg}°, type {r.experiment.type}",
            verdict(r.type == r.experiment.type),
            f"exact Coulomb motion: {r.type}, signs {r.pattern.replace('-', '−')}, forwards {percent(r.fractions['forward'], 3)}, "
            "backwards "
            f"{percent(r.fractions['backward'], 3)}, at rest {percent(r.fractions['stick'], 3)} of the period",
        )
        for r in study.table
    )
    return Claim(
        "four_types",
        "4.1",
        "The driven system has four types of motion, three with stick-slip and one without, and the four experiments show one each.",
        "The vibration-driven system in this paper shows four types of motion with harmonic excitation",
        verdict(all(p.verdict == CONFIRMED for p in parts)),
        (
            f"The exact types are {listed(r.type for r in study.table)}, as printed, at the inferred amplitudes.",
            "The type is that of the exact Coulomb motion, which needs no threshold. A LuGre body never rests, and its label depends on "
            "thresholds: " + "; ".join(f"at {r.experiment.tilt_deg}° {_words(r.lugre_words)}" for r in study.table) + ".",
        ),
        f"high for the four types; at 1.7° the motion is close to the border of type III (margin {plain(study.table[0].margin, 2)})",
        {"types": [r.type for r in study.table], "lugre_words": [r.lugre_words for r in study.table]},
        parts,
    )


def _words(words: dict[str, int]) -> str:
    total = sum(words.values())
    return listed(f"{word} under {n}" for word, n in words.items()) + f" of {total} rules"


def six_groups(study: Study) -> Claim:
    """Six groups of experiments."""
    tilts = sorted({e.tilt_deg for e in EXPERIMENTS})
    return Claim(
        "six_groups",
        "4.1",
        "Six groups of experiments with different friction were done.",
        "Six groups of experiments of different friction coefficients are conducted",
        UNDECIDED if len(tilts) < 6 else CONFIRMED,
        (
            f"Results are printed for {len(tilts)} angles: {listed(f'{t}°' for t in tilts)}. Nothing is said about the other "
            f"{6 - len(tilts)}.",
        ),
        "high: the printed results can be counted",
        {"reported": len(tilts)},
    )


def closer_in_number(study: Study) -> Claim:
    """LuGre closer in number."""
    parts = []
    for r in study.table:
        e = r.experiment
        text = (
            f"measured {speed(e.measured, 2 if e.measured < 0.01 else 3)}; computed LuGre {speed(r.lugre)} "
            f"({percent(r.lugre / e.measured - 1, 2, True)}), "
            f"Coulomb {speed(r.coulomb)} ({percent(r.coulomb / e.measured - 1, 2, True)}); by the printed values {r.closer_printed} is "
            "closer too"
        )
        parts.append(
            Part(f"{e.tilt_deg}°", verdict(r.closer == "LuGre"), text if r.closer == r.closer_printed else text.replace(" too", ""))
        )
    won = sum(p.verdict == CONFIRMED for p in parts)
    losers = [p.label for p in parts if p.verdict != CONFIRMED]
    return Claim(
        "closer_in_number",
        "4.2, 6",
        "The mean velocity with LuGre friction is closer to the measured one than that with Coulomb friction.",
        "From the view point of quantitative and qualitative, it is found that the LuGre model is a better friction model",
        verdict(won == len(parts)),
        (
            f"It is closer at {won} of {len(parts)} angles, and not at {listed(losers)}." if losers else "It is closer at every angle.",
            f"By chance alone {won} or more of {len(parts)} would happen with probability {plain(_chance(won, len(parts)), 2)}.",
            "One amplitude was inferred for each angle from the printed simulations, so neither law was fitted to the measurement; the "
            "measured values come without error bars.",
        ),
        "high for the numbers, low for the comparison of the laws: four means with two digits",
        {"closer": [r.closer for r in study.table], "won": won},
        tuple(parts),
    )


def _chance(won: int, of: int) -> float:
    from math import comb

    return sum(comb(of, k) for k in range(won, of + 1)) / 2**of


def closer_in_shape(study: Study) -> Claim:
    """LuGre closer in shape."""
    found = {}
    for e in EXPERIMENTS:
        _, lugre, rest = _curves(study, e)
        if rest.any():
            found[e.tilt_deg] = float(abs(lugre[rest]).max()), float(abs(lugre).max())
    return Claim(
        "closer_in_shape",
        "4.2",
        "The velocity curve with LuGre friction is closer in shape to the measured one.",
        "the qualitative feature of the LuGre model is more consistent with the experimental data",
        UNDECIDED,
        (
            "The measured curves are printed as pictures only and are not available as numbers.",
            "The following can be said: while the Coulomb body rests, the LuGre body keeps moving at up to "
            + listed(f"{speed(slow, 3)} at {tilt}° ({percent(slow / fast, 2)} of its peak)" for tilt, (slow, fast) in found.items())
            + "; a vibrometer with a precision of 0.001 mm/s would resolve that.",
        ),
        "moderate: consistent with what the paper describes, but any compliance in the contact or the body would look alike",
        {"velocity_at_rest_and_peak": {str(k): v for k, v in found.items()}},
    )


def _curves(study: Study, e: Any) -> tuple[Any, Any, Any]:
    """Both velocities over the last period, and where the Coulomb body rests."""
    run, other = study.runs.coulomb[e.name], study.runs.lugre[e.name]
    t = np.linspace(run.strobe_times[-2], run.strobe_times[-1], 4001)[:-1]
    exact = run.at(t)
    return exact["v"], other.at(t)["v"], exact["mode"] == 0


def type_four_same(study: Study) -> Claim:
    """Type four cannot tell the laws apart."""
    rows = {}
    for r in study.table:
        coulomb, lugre, _ = _curves(study, r.experiment)
        rows[r.type] = float(np.sqrt(np.mean((lugre - coulomb) ** 2) / np.mean(coulomb**2))), abs(r.lugre / r.coulomb - 1)
    others = [v for k, v in rows.items() if k != "IV"]
    shape, mean = rows["IV"]
    holds = mean < 0.05 and shape < 0.05 and all(shape < o[0] and mean < o[1] for o in others)
    return Claim(
        "type_four_same",
        "4.2.4",
        "In a motion without sticking (type IV) Coulomb and LuGre friction can hardly be told apart.",
        "the simulation results of the Coulomb friction and the LuGre model are nearly the same",
        verdict(holds),
        (
            f"At {EXPERIMENTS[-1].tilt_deg}° the two velocity curves differ by {percent(shape)} (root mean square over that of the "
            f"curve) and the mean velocities by {percent(mean)}.",
            "With sticking they differ by "
            + listed(f"{percent(s)} and {percent(m)} (type {k})" for k, (s, m) in rows.items() if k != "IV")
            + ".",
        ),
        "high for the numbers; 'nearly' depends on the accuracy of the measurement",
        {k: {"curve": s, "mean": m} for k, (s, m) in rows.items()},
    )
