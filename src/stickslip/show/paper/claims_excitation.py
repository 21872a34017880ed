"""Claims of sections 5.1 and 5.2: the effects of amplitude and frequency of the drive."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.show.paper.borders import FOUR, exact_types, in_words, stretches
from stickslip.show.paper.cases import AMPLITUDE_5, CASES, OMEGA, rig
from stickslip.show.paper.claims_page import ClaimData, PaperClaim, judged, together
from stickslip.show.paper.followed_motions import stable_range
from stickslip.show.paper.one_amplitude import WANTED
from stickslip.show.paper.readings import PRINTED_READING, STATED, Reading
from stickslip.show.paper.solved_runs import scaled_velocity
from stickslip.show.paper.words import millimetres

__all__ = ["all_types_by_amplitude", "always_periodic", "harmonic", "omega_as_amplitude"]


def _figures(study: ClaimData, section: str) -> list[dict[str, Any]]:
    """For each figure of a section: the case, the exact type, and the LuGre label."""
    from stickslip.analysis.motion import motion

    cases = [c for c in CASES if c.section == section]
    return [{"c": c, "exact": motion(study.runs.twins[c.figure]).type, "word": motion(study.runs.figures[c.figure]).type} for c in cases]


def harmonic(study: ClaimData) -> PaperClaim:
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


def all_types_by_amplitude(study: ClaimData) -> PaperClaim:
    """All four types by the amplitude."""
    rows, A = _figures(study, "5.1")[1:], np.array([c.amplitude for c in CASES if c.section == "5.1"][1:])
    printed = exact_types(PRINTED_READING.coulomb(CASES[1], amplitude=A)).tolist()
    numbers = {"exact": [row["exact"] for row in rows], "lugre_label": [row["word"] for row in rows], "as_printed": printed}
    borders = [_borders(reading) for reading in (STATED, PRINTED_READING)]
    hold = (set(numbers["exact"]) >= set(FOUR), not study.type_two.misses_all)
    parts: list[tuple[Any, dict[str, Any]]] = [(part, {}) for part in hold]
    return judged("all_types_by_amplitude", together(*hold), numbers, parts, borders=borders, rows=rows)


def _borders(reading: Reading) -> str:
    """The types along the amplitude at 1.7 degrees."""

    def types(A: Any) -> Any:
        return exact_types(reading.coulomb(CASES[1], amplitude=A))

    return in_words(stretches(types, 2e-4, 8e-4, points=601, within=1e-9), millimetres)


def always_periodic(study: ClaimData) -> PaperClaim:
    """Always periodic along the amplitude."""
    low, high = CASES[0].amplitude, 8e-4
    branch = stable_range("amplitude", high, low, high, step=0.1, rtol=1e-6)
    end = branch.low
    numbers = {"low": end.value, "high": high, "ends": end.kind, "largest_multiplier": branch.multiplier, "orbits": branch.orbits}
    return judged("always_periodic", end.kind == "range", numbers, end=end)


def omega_as_amplitude(study: ClaimData) -> PaperClaim:
    """The frequency acts as the amplitude."""
    rows, omega = _figures(study, "5.2"), np.pi * np.linspace(30, 80, 26 if study.fast else 251)
    gap = {law: _gap(omega, law) for law in ("coulomb-static", "lugre")}
    types, search = [row["exact"] for row in rows], study.amplitudes.section5.stated
    hold = (gap["coulomb-static"] < 1e-9 and gap["lugre"] < 0.05, types == list(WANTED), not study.type_two.misses_all)
    numbers = {"types": types, "coulomb_gap": gap["coulomb-static"], "lugre_gap": gap["lugre"]}
    values = {"omega": omega, "window": search.window("frequencies"), "A": AMPLITUDE_5, "rows": rows}
    return judged("omega_as_amplitude", together(*hold), numbers, [(part, {}) for part in hold], **values)


def _gap(omega: Any, law: str) -> float:
    """Largest difference of V/(A mu omega) over the frequency and over amplitudes with the same A omega^2, relative to its maximum."""
    same = AMPLITUDE_5 * (omega / OMEGA) ** 2
    one, two = (scaled_velocity(rig(CASES[0], omega=w, amplitude=A, law=law)) for w, A in ((omega, AMPLITUDE_5), (OMEGA, same)))
    return float(abs(one - two).max() / abs(two).max())
