"""Claims of section 3.1 about the beam that shakes the inner mass: a sum of modes (3.3), and a tip that moves as a sine (3.7)."""

from __future__ import annotations

import itertools

import numpy as np

from stickslip.show.paper.beam import VOLTAGE
from stickslip.show.paper.cases import CASES, EXPERIMENTS, OMEGA
from stickslip.show.paper.claims_page import ClaimData, PaperClaim, judged

__all__ = ["sinusoidal_tip", "sum_of_modes"]

#: Frequencies [Hz] around the drive's and below the second resonance at which the sum of modes is tested.
FREQUENCIES = np.concatenate([np.linspace(5, 30, 26), np.linspace(36, 60, 25)])
#: Slope [rad] above which linear theory is off by more than about 1 per cent (docs, the piezo beam).
STEEP = 0.15


def sum_of_modes(study: ClaimData) -> PaperClaim:
    """The beam is a sum of modes."""
    beam, counts = study.beam, (1, 3, 8, 40)
    products = float(abs(beam.products() - np.eye(5)).max())
    misses = {str(n): beam.misses(n, FREQUENCIES) for n in counts}
    falls = all(b < a / 10 for a, b in itertools.pairwise(misses.values()))
    numbers = {"products": products, "misses": misses, "curvature_over_shape": beam.curvature(np.array([0.25, 0.5, 0.75])).tolist()}
    return judged("sum_of_modes", products < 1e-12 and falls, numbers, hertz=beam.frequency, frequencies=len(FREQUENCIES))


def sinusoidal_tip(study: ClaimData) -> PaperClaim:
    """The tip moves as a sine."""
    beam = study.beam
    lines = np.fft.rfft(beam.settled())
    distortion = float(np.sqrt((abs(lines[2:]) ** 2).sum()) / abs(lines[1]))
    amplitude, expected = float(abs(lines[1]) * 2 / (2 * (len(lines) - 1))), float(beam.amplitude(OMEGA))
    error, slopes = abs(amplitude / expected - 1), [beam.slope(e.amplitude) for e in EXPERIMENTS]
    omegas = np.array([c.changes["omega"] for c in CASES if c.section == "5.2"])
    numbers = {
        "distortion": distortion,
        "amplitude": amplitude,
        "by_formula": expected,
        "slopes": slopes,
        "added_harmonics": {tilt: float(shares.max()) for tilt, shares in beam.shaken(study.runs).items()},
        "first_harmonic_of_recoil": beam.recoil(study.runs),
        "tips_at_5_2": beam.amplitude(omegas).tolist(),
        "voltage": VOLTAGE,
    }
    hold = (distortion < 1e-5 and error < 1e-4, max(slopes) < STEEP)
    values = {"error": error, "steep": STEEP, "hertz": beam.frequency, "drive": OMEGA / (2 * np.pi)}
    return judged("sinusoidal_tip", all(hold), numbers, [(part, {}) for part in (*hold, None)], **values)
