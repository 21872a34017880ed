"""Claims of sections 5.1 and 5.2: the effects of amplitude and frequency of the drive."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.paper.borders import FOUR, exact_types, in_words, stretches
from stickslip.paper.cases import AMPLITUDE_5, CASES, OMEGA, rig
from stickslip.paper.claims_page import Claim, Study, judged
from stickslip.paper.followed_motions import followed
from stickslip.paper.solved_runs import scaled_velocity
from stickslip.paper.words import millimetres

__all__ = ["all_types_by_amplitude", "always_periodic", "harmonic", "omega_as_amplitude"]


def _figures(study: Study, section: str) -> list[dict[str, Any]]:
    """For each figure of a section: the case, the exact type, and the LuGre word."""
    from stickslip.analysis.motion import motion

    cases = [c for c in CASES if c.section == section]
    return [{"c": c, "exact": motion(study.runs.twins[c.figure]).type, "word": motion(study.runs.figures[c.figure]).type} for c in cases]


def harmonic(study: Study) -> Claim:
    """Harmonic motion at 1e-6 m."""
    run = study.runs.figures[11]
    t = np.linspace(run.strobe_times[-2], run.strobe_times[-1], 2049)[:-1]
    lines = abs(np.fft.rfft(run.at(t)["v"])) * 2 / len(t) / run.model.velocity_scale
    distortion = float(np.sqrt((lines[2:] ** 2).sum()) / lines[1])
    law, robot = run.model.friction, run.model
    a, b, c = law.sigma0 / (OMEGA**2 * robot.total_mass), law.sigma1 / (OMEGA * robot.total_mass), law.sigma2 / (OMEGA * robot.total_mass)
    linear = robot.mass_ratio / np.hypot(a - 1, b + c)
    numbers = {"distortion": distortion, "amplitude": float(lines[1]), "linear": float(linear)}
    return judged("harmonic", distortion < 0.01 and abs(lines[1] / linear - 1) < 0.01, numbers)


def all_types_by_amplitude(study: Study) -> Claim:
    """All four types by the amplitude."""
    rows = _figures(study, "5.1")[1:]
    numbers = {"exact": [row["exact"] for row in rows], "lugre_word": [row["word"] for row in rows]}
    borders = in_words(stretches(lambda A: exact_types(rig(CASES[1], amplitude=A, law="coulomb")), 2e-4, 8e-4), millimetres)
    parts = [(row["exact"] in FOUR, row) for row in rows]
    return judged("all_types_by_amplitude", set(numbers["exact"]) >= set(FOUR), numbers, parts, borders=borders)


def always_periodic(study: Study) -> Claim:
    """Always periodic along the amplitude."""
    low, high = CASES[0].amplitude, 8e-4
    found = followed("amplitude", high, low, high, step=0.1, rtol=1e-6)
    end = found.low
    numbers = {"low": end.value, "high": high, "ends": end.kind, "largest_multiplier": found.multiplier, "orbits": found.orbits}
    return judged("always_periodic", end.kind == "range", numbers, end=end)


def omega_as_amplitude(study: Study) -> Claim:
    """The frequency acts as the amplitude."""
    rows, omega = _figures(study, "5.2"), np.pi * np.linspace(30, 80, 26 if study.fast else 251)
    gap = {law: _gap(omega, law) for law in ("coulomb", "lugre")}
    parts = [(row["exact"] == want, row) for row, want in zip(rows, ("rest", "II", "I", "III", "IV"), strict=True)]
    holds = gap["coulomb"] < 1e-9 and gap["lugre"] < 0.05 and all(part for part, _ in parts)
    numbers = {"types": [row["exact"] for row in rows], **{f"{law}_gap": value for law, value in gap.items()}}
    return judged("omega_as_amplitude", holds, numbers, parts, omega=omega)


def _gap(omega: Any, law: str) -> float:
    """Largest difference of V/(A mu omega) over the frequency and over amplitudes with the same A omega^2, relative to its maximum."""
    same = AMPLITUDE_5 * (omega / OMEGA) ** 2
    one, two = (scaled_velocity(rig(CASES[0], omega=w, amplitude=A, law=law)) for w, A in ((omega, AMPLITUDE_5), (OMEGA, same)))
    return float(abs(one - two).max() / abs(two).max())
