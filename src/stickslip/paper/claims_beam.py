"""Claims of section 3.1 about the beam that shakes the inner mass: a sum of modes (3.3), and a tip that moves as a sine (3.7)."""

from __future__ import annotations

import itertools

import numpy as np

from stickslip.paper.beam import VOLTAGE
from stickslip.paper.cases import CASES, EXPERIMENTS, OMEGA
from stickslip.paper.claims_page import CONFIRMED, UNDECIDED, Claim, Part, Study, verdict
from stickslip.paper.words import listed, percent, plain

__all__ = ["sinusoidal_tip", "sum_of_modes"]

OURS = (
    "The paper gives no data of the beam or the patches; this beam is our choice, with the paper's tip mass and a first resonance at "
    "{hertz} Hz"
)
#: Frequencies [Hz] around the drive's and below the second resonance at which the sum of modes is compared.
FREQUENCIES = np.concatenate([np.linspace(5, 30, 26), np.linspace(36, 60, 25)])
#: Slope [rad] above which linear theory is off by more than about 1 per cent (docs, the piezo beam).
STEEP = 0.15


def sum_of_modes(study: Study) -> Claim:
    """The beam is a sum of modes."""
    beam, counts = study.beam, (1, 3, 8, 40)
    products = float(abs(beam.products() - np.eye(5)).max())
    misses = {n: beam.misses(n, FREQUENCIES) for n in counts}
    bent = beam.curvature(np.array([0.25, 0.5, 0.75]))
    falls = all(misses[b] < misses[a] / 10 for a, b in itertools.pairwise(counts))
    return Claim(
        "sum_of_modes",
        "3.1",
        "The beam's motion is a sum of normal modes, each with a time function of its own (Eqs 3.3 and 3.4).",
        "Using the method of separation of variables, u(x,t) = Σ Y_i(x) η_i(t)",
        verdict(products < 1e-12 and falls),
        (
            "With Eq. 3.1 corrected the modes are orthogonal, the tip mass included: the matrix of products of the first five differs "
            f"from the unit matrix by at most {plain(products, 1)}.",
            "Without damping the problem has a closed solution without modes. The largest error of the sum at "
            f"{len(FREQUENCIES)} frequencies from 5 to 60 Hz, with "
            + listed(f"{n} mode{'s' * (n > 1)}: {percent(m)}" for n, m in misses.items())
            + ".",
            "As printed, with u_xx where u_tt belongs, Eq. 3.1 does not separate with Eq. 3.4: Y″/Y of the first mode would have to be "
            f"constant, but is {listed(plain(x, 3) for x in bent)} at a quarter, a half and three quarters of the length (in 1/L²).",
            f"{OURS.format(hertz=plain(beam.frequency, 3))}; the numbers are those of this beam.",
        ),
        "high: two independent solutions of one equation agree",
        {"products": products, "misses": {str(n): m for n, m in misses.items()}, "curvature_over_shape": bent.tolist()},
    )


def sinusoidal_tip(study: Study) -> Claim:
    """The tip moves as a sine."""
    beam = study.beam
    lines = np.fft.rfft(beam.settled())
    distortion = float(np.sqrt((abs(lines[2:]) ** 2).sum()) / abs(lines[1]))
    amplitude, expected = float(abs(lines[1]) * 2 / (2 * (len(lines) - 1))), float(beam.amplitude(OMEGA))
    slopes = [beam.slope(e.amplitude) for e in EXPERIMENTS]
    added = {tilt: float(found.max()) for tilt, found in beam.shaken(study.runs).items()}
    omegas = np.array([c.changes["omega"] for c in CASES if c.section == "5.2"])
    tips = beam.amplitude(omegas)
    parts = (
        Part(
            "clamp at rest, small deflection", verdict(distortion < 1e-5 and abs(amplitude / expected - 1) < 1e-4),
            f"harmonics {plain(distortion, 1)} of the first; {plain(1e3 * amplitude, 5)} mm, by Eq. 3.7 {plain(1e3 * expected, 5)} mm",
        ),
        Part(
            "deflection small enough at the amplitudes of section 4", verdict(max(slopes) < STEEP),
            f"the tip is inclined by {listed(plain(s, 2) for s in slopes)} rad; linear theory is good to 1 % up to {STEEP:g}",
        ),
        Part(
            "clamp on the body, which moves", UNDECIDED,
            "Eq. 3.1 leaves out the motion of the base. On our beam what the body does at "
            f"{listed(f'{tilt}°' for tilt in added)} would add harmonics of up to {listed(percent(a) for a in added.values())} of A to the "
            f"tip's sine, and at the first harmonic an answer {plain(beam.recoil(study.runs), 2)} times as large as A: one way, without "
            "feedback. On the paper's beam, which is not printed, it may be less",
        ),
    )  # fmt: skip
    return Claim(
        "sinusoidal_tip",
        "3.1",
        "The tip of the beam moves as a sine, as Eq. 2.2 demands of the inner mass (Eq. 3.7).",
        "According to (3.7), it is easy to find that the vibration of the beam is sinusoidal. That is to say ξ(t)=u(L,t), this condition "
        "meets the demand of the driving force given in (2.2)",
        verdict(all(p.verdict == CONFIRMED for p in parts[:2])),
        (
            "For a clamp at rest the claim holds: from rest under samples of a sine of "
            f"{plain(VOLTAGE, 2)} V at {plain(OMEGA / (2 * np.pi), 4)} Hz the hundredth period has "
            f"harmonics of {plain(distortion, 1)} of the first, and the amplitude of Eq. 3.7 to {plain(abs(amplitude / expected - 1), 1)}.",
            "Its amplitude depends on the frequency, though: at the five frequencies of section 5.2, which takes one A for all, a constant "
            f"voltage of {plain(VOLTAGE, 2)} V gives {listed(plain(1e3 * t, 2) for t in tips)} mm.",
            f"{OURS.format(hertz=plain(beam.frequency, 3))}.",
        ),
        "high for a linear beam on a clamp at rest; low for the rig, whose clamp moves with the body",
        {
            "distortion": distortion, "amplitude": amplitude, "by_formula": expected, "slopes": slopes, "added_harmonics": added,
            "first_harmonic_of_recoil": beam.recoil(study.runs), "tips_at_5_2": tips.tolist(), "voltage": VOLTAGE,
        },
        parts,
    )  # fmt: skip
