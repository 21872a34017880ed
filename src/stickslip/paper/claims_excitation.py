"""Claims of sections 5.1 and 5.2: what amplitude and frequency of the drive do."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.paper.borders import exact_types, in_words, stretches
from stickslip.paper.cases import AMPLITUDE_5, CASES, OMEGA, rig
from stickslip.paper.claims_page import CONFIRMED, Claim, Part, Study, verdict
from stickslip.paper.followed_motions import followed
from stickslip.paper.solved_runs import batch
from stickslip.paper.words import listed, millimetres, percent, plain

__all__ = ["all_types_by_amplitude", "always_periodic", "harmonic", "omega_as_amplitude"]

FOUR = ("I", "II", "III", "IV")


def _words(study: Study, section: str) -> list[tuple[Any, str, str]]:
    """For each figure of a section: the case, the exact type, and the LuGre word."""
    from stickslip.analysis.motion import motion

    cases = [c for c in CASES if c.section == section]
    return [(c, motion(study.runs.twins[c.figure]).type, motion(study.runs.figures[c.figure]).type) for c in cases]


def harmonic(study: Study) -> Claim:
    """Harmonic motion at 1e-6 m."""
    run = study.runs.figures[11]
    t = np.linspace(run.strobe_times[-2], run.strobe_times[-1], 2049)[:-1]
    lines = abs(np.fft.rfft(run.at(t)["v"])) * 2 / len(t) / run.model.velocity_scale
    distortion = float(np.sqrt((lines[2:] ** 2).sum()) / lines[1])
    law, robot = run.model.friction, run.model
    a, b, c = law.sigma0 / (OMEGA**2 * robot.total_mass), law.sigma1 / (OMEGA * robot.total_mass), law.sigma2 / (OMEGA * robot.total_mass)
    linear = robot.mass_ratio / np.hypot(a - 1, b + c)
    return Claim(
        "harmonic",
        "5.1",
        "At the very small amplitude A = 10⁻⁶ m the body moves harmonically.",
        "under the low excitation amplitude, the dimensionless velocity meet simple harmonic vibration",
        verdict(distortion < 0.01 and abs(lines[1] / linear - 1) < 0.01),
        (
            f"All higher harmonics together are {percent(distortion)} of the first.",
            f"The amplitude of v/(Aω) is {plain(lines[1], 6)}; the linearised bristle gives μ/√((a−1)²+(b+c)²) = {plain(linear, 6)}.",
            "The body only deflects its bristles and never slides: presliding.",
        ),
        "high: agrees with the closed formula",
        {"distortion": distortion, "amplitude": float(lines[1]), "linear": float(linear)},
    )


def all_types_by_amplitude(study: Study) -> Claim:
    """All four types by the amplitude."""
    rows = _words(study, "5.1")[1:]
    found = {exact for _, exact, _ in rows}
    parts = tuple(
        Part(f"Figure {c.figure}, {c.varied}", verdict(exact in FOUR), f"exact Coulomb {exact}, LuGre word {word}")
        for c, exact, word in rows
    )
    return Claim(
        "all_types_by_amplitude",
        "5.1",
        "Changing the excitation amplitude gives all four types of motion.",
        "by variation the excitation amplitude A, one can simulate all the four movement forms",
        verdict(found >= set(FOUR)),
        (f"The five printed amplitudes give, exactly, {listed(exact for _, exact, _ in rows)}.", _borders()),
        "high: the amplitudes are printed and the types exact",
        {"exact": [exact for _, exact, _ in rows], "lugre_word": [word for _, _, word in rows]},
        parts,
    )


def _borders() -> str:
    """The amplitudes at which the exact type changes at 1.7 degrees."""
    found = stretches(lambda A: exact_types(rig(CASES[1], amplitude=A, law="coulomb")), 2e-4, 8e-4)
    return f"Along the amplitude, by the exact borders: {in_words(found, millimetres)}."


def always_periodic(study: Study) -> Claim:
    """Always periodic along the amplitude."""
    low, high = CASES[0].amplitude, 8e-4
    found = followed("amplitude", high, low, high, step=0.1, rtol=1e-6)
    holds = found.low.kind == "range"
    return Claim(
        "always_periodic",
        "5.1",
        "Along the amplitude the motion is always periodic.",
        "the phase portrait of the system is always periodic",
        verdict(holds),
        (
            f"The periodic motion at 0.8 mm was followed down to {'10⁻⁶ m' if holds else f'{found.low.text()} mm'} by continuation of its "
            f"orbit, in {found.orbits} steps: "
            + (f"it repeats after one drive period, and no multiplier is larger than {plain(found.multiplier, 3)}." if holds else
               f"there it {found.low.why}."),
        ),
        "high: an orbit with its multipliers, not a run that may not have settled; between the steps it was not computed, and "
        "other coexisting motions were not searched for",
        {"low": found.low.value, "high": high, "ends": found.low.kind, "largest_multiplier": found.multiplier, "orbits": found.orbits},
    )  # fmt: skip


def omega_as_amplitude(study: Study) -> Claim:
    """The frequency acts as the amplitude."""
    rows = _words(study, "5.2")
    types = [exact for _, exact, _ in rows]
    omega = np.pi * np.linspace(30, 80, 26 if study.fast else 251)
    same = AMPLITUDE_5 * (omega / OMEGA) ** 2  # the amplitude with the same A omega^2
    w = {
        law: [_scaled(omega=omega, amplitude=AMPLITUDE_5, law=law), _scaled(omega=OMEGA, amplitude=same, law=law)]
        for law in ("coulomb", "lugre")
    }
    gap = {law: float(abs(one - two).max() / abs(two).max()) for law, (one, two) in w.items()}
    parts = tuple(
        Part(f"Figure {c.figure}, {c.varied}", verdict(e == want), f"exact Coulomb {e}, LuGre word {x}")
        for (c, e, x), want in zip(rows, ("rest", *_ORDER), strict=True)
    )
    return Claim(
        "omega_as_amplitude",
        "5.2",
        "The excitation frequency has the same effect as the amplitude, and also gives all four types.",
        "The excitation frequency has the same effect as the excitation amplitude A",
        verdict(gap["coulomb"] < 1e-9 and gap["lugre"] < 0.05 and all(p.verdict == CONFIRMED for p in parts)),
        (
            f"At A = 0.6 mm (inferred) the five frequencies give {listed(types)}: the order in which a growing amplitude passes "
            "through the types.",
            f"Coulomb: only Aω² matters. V/(Aμω) at {len(omega)} frequencies and at the amplitudes with the same Aω² agree to "
            f"{plain(gap['coulomb'], 2)}.",
            f"LuGre: a, b, c and v_s* change with ω as well, and V/(Aμω) differs by up to {percent(gap['lugre'])} of its largest value.",
        ),
        "high for Coulomb (it follows from the equations); for LuGre nearly, not exactly",
        {"types": types, "coulomb_gap": gap["coulomb"], "lugre_gap": gap["lugre"]},
        parts,
    )


_ORDER = ("II", "I", "III", "IV")


def _scaled(omega: Any, amplitude: Any, law: str) -> Any:
    """V/(A mu omega) of a batch."""
    robot = rig(CASES[0], omega=omega, amplitude=amplitude, law=law)
    return np.asarray(batch(robot, periods=200).mean_velocity) / np.asarray(robot.mass_ratio * robot.velocity_scale)
