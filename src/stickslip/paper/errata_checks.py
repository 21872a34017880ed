"""One function for each erratum: what is printed, what is right, and the check."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from stickslip.paper.amplitudes import ROUNDING, Amplitudes
from stickslip.paper.cases import CASES, EXPERIMENTS, rig
from stickslip.paper.errata import Erratum
from stickslip.paper.solved_runs import batch
from stickslip.paper.table import Row
from stickslip.paper.words import listed, millimetres, percent, plain, speed

__all__ = ["errata"]

# Units as exponents of kg, m, s, A.
KG, METRE, SECOND, AMPERE = np.eye(4, dtype=int)
NEWTON = KG + METRE - 2 * SECOND
VOLT = NEWTON + METRE - SECOND - AMPERE


def at_rest() -> Erratum:
    """Eq. 2.6 at v = 0."""
    law, load, z, v = rig(EXPERIMENTS[0]).friction, 0.7, 1e-7, 1e-9
    limits = [law.rate(side * v, z, load) for side in (1, -1)]
    slopes = [limits[0] / v, limits[1] / -v]
    return Erratum(
        "2.6",
        "ż only for ẋ > 0 and for ẋ < 0",
        "ż = 0 at ẋ = 0; the right side is continuous there, with a kink",
        f"Both branches tend to 0 with v (at v = ±10⁻⁹ m/s ż = {plain(limits[0], 3)} and {plain(limits[1], 3)} m/s); their slopes "
        f"dż/dv are {plain(slopes[0])} and {plain(slopes[1])}.",
        max(abs(x) for x in limits) < 2 * v and abs(slopes[0] - slopes[1]) > 1e-3 and law.rate(0.0, z, load) == 0.0,
        {"limits": limits, "slopes": slopes},
    )


def beam_equation() -> Erratum:
    """Eq. 3.1."""
    bending, inertia = NEWTON + 2 * METRE + METRE - 4 * METRE, KG - METRE + METRE - 2 * SECOND
    printed = KG - METRE + METRE - 2 * METRE
    return Erratum(
        "3.1",
        "ρA₁ ∂²u/∂x², and T(δ(x−0) + δ(x−l₀))",
        "ρA₁ ∂²u/∂t², and T(δ(x) − δ(x−l₀)): two equal and opposite couples; the motion of the base, −ρA₁ẍ, is left out",
        "Units: EI u'''' is N/m, ρA₁ u_tt is N/m, ρA₁ u_xx is kg/m². A patch carries no load from outside, so its couples must add up "
        "to 0; the printed ones add up to 2T.",
        bool((bending == inertia).all() and (bending != printed).any()),
    )


def patch_moment() -> Erratum:
    """Eq. 3.2."""
    others = (METRE - VOLT) + METRE + METRE + VOLT
    modulus, electric = NEWTON - 2 * METRE, VOLT - METRE
    moment = NEWTON + METRE
    return Erratum(
        "3.2",
        "E₂ is the electric field intensity",
        "E₂ is Young's modulus of the piezo patch",
        "Units: d₃₁(h₁+h₂)b·V is m³, so a moment in N·m needs E₂ in N/m². An electric field, V/m, does not give it.",
        bool((others + modulus == moment).all() and (others + electric != moment).any()),
    )


def transient() -> Erratum:
    """Eq. 3.6."""
    zeta, free, phi, force = 0.05, 1.0, 0.7, 0.6
    damped = free * np.sqrt(1 - zeta**2)

    def residual(w: float) -> float:
        """Largest q'' + 2 zeta q' + q of the bracket times the decay, by its complex exponents."""
        t = np.linspace(0.0, 20.0, 401)
        total = np.zeros_like(t, complex)
        b = free / damped * (zeta * np.sin(phi) - force / free * np.cos(phi))
        for amplitude, s in ((np.sin(phi), -zeta * free + 1j * w), (-1j * b, -zeta * free + 1j * damped)):
            total += amplitude * (s**2 + 2 * zeta * free * s + free**2) * np.exp(s * t)
        return float(abs(total.real).max())

    printed, right = residual(free), residual(damped)
    return Erratum(
        "3.6",
        "cos ω_i t in the transient; ζ and φ without index; both C_i and B_i",
        "cos ω_d t; ζ_i and φ_i; one factor is enough",
        "Put into q'' + 2ζω_i q' + ω_i² q = 0 the printed transient leaves ζ²ω_i² sin φ: "
        f"{plain(printed, 2)} at ζ = 0.05, φ = 0.7, ω_i = 1; the corrected one leaves {plain(right, 2)}.",
        printed > 1e-3 and right < 1e-12,
        {"printed": printed, "right": right},
    )


def weight(table: tuple[Row, ...]) -> Erratum:
    """Eq. 3.8."""
    robot = rig(EXPERIMENTS[0])
    fits = {"Mg": _fits(robot.body_mass / robot.total_mass), "(M+m)g": _fits(1.0)}
    lost = [tilt for tilt, count in fits["Mg"].items() if not count]
    return Erratum(
        "3.8",
        "F = f Mg, with the weight of the body alone",
        "F = f (M+m)g, as in Eqs 2.4 and 2.6",
        "The track carries body and inner mass. "
        + (f"With Mg no amplitude gives the printed type and velocities at {listed(lost)}; with (M+m)g " if lost else "With either weight ")
        + ("there is one at every angle." if all(fits["(M+m)g"].values()) else "there is one at some angles.")
        + " (At 1.7° the LuGre velocity, printed as “about”, is allowed one digit.)",
        bool(lost) and all(fits["(M+m)g"].values()),
        {"amplitudes_that_fit": fits},
    )


def _fits(share: float) -> dict[str, int]:
    """How many amplitudes of a scan give the printed type and velocities of each angle, with a share of the friction."""
    A, found = np.arange(3e-4, 1.8e-3, 1e-6), {}
    for e in EXPERIMENTS:
        good = np.ones(len(A), bool)
        for law, printed in (("coulomb", e.coulomb), ("lugre", e.lugre)):
            robot = rig(e, amplitude=A, law=law)
            names = [n for n in ("mu_plus", "mu_minus", "f_plus", "f_minus") if getattr(robot.friction, n) is not None]
            friction = dataclasses.replace(robot.friction, **{n: share * getattr(robot.friction, n) for n in names})
            many = batch(dataclasses.replace(robot, friction=friction), periods=60, settle=40, rtol=1e-5)
            digit = 2 * ROUNDING if (e.name, law) == ("P1", "lugre") else ROUNDING
            good &= abs(many.mean_velocity - printed) <= digit
            good &= (many.motion_type == e.type) if law == "coulomb" else True
        found[f"{e.tilt_deg}°"] = int(good.sum())
    return found


def incline(table: tuple[Row, ...]) -> Erratum:
    """Folding."""
    difference = [r.gravity / r.lugre - 1 for r in table]
    return Erratum(
        "3.8, 4.1",
        "the incline's gravity is folded into the friction coefficients, for both laws",
        "exact for Coulomb friction; for LuGre friction another model, since gravity then acts on the bristle",
        f"With true gravity the LuGre mean velocities differ by {percent(min(difference))} to {percent(max(difference))}. All results "
        "of the paper are those of the folded model.",
        min(difference) > 0.01,
        {"relative_difference": difference},
    )


def figure_numbers() -> Erratum:
    """References to figures."""
    return Erratum(
        "4.1, 5.1",
        "four types \u201cshown in Fig. 5\u201d; \u201cFig. 10 shows that under the low excitation amplitude\u201d",
        "Figure 6; Figure 11",
        "Figure 5 is the measurement setup, Figure 10 is the experiment at 5.7°; the captions of Figures 6 and 11 fit.",
    )


def third_type(table: tuple[Row, ...]) -> Erratum:
    """Type three."""
    row = next(r for r in table if r.experiment.type == "III")
    return Erratum(
        "4.1",
        "types one, two and four are defined; type three is not",
        "type three: both directions, one rest in each period",
        f"What is left over, and what the exact motion at {row.experiment.tilt_deg}° does: signs {row.pattern.replace('-', '−')}, type "
        f"{row.type}.",
        row.pattern in ("+0-", "+-0"),
        {"pattern": row.pattern},
    )


def steady_velocity() -> Erratum:
    """The definition of the mean velocity."""
    from stickslip.solvers import solve

    x = solve(rig(EXPERIMENTS[0]), periods=200, rtol=1e-8)
    T, at = x.period_time, x.strobe_x
    first, steady = float(at[1] - at[0]) / T, float(at[200] - at[100]) / (100 * T)
    return Erratum(
        "4.2.1",
        "the mean steady velocity starts at 0 ≤ t₀ ≤ T, over any whole number p of periods",
        "t₀ after the transient, and p a multiple of the period number of the motion",
        f"At 1.7°, from rest, t₀ = 0 and p = 1 give {speed(first)}, periods 100 to 200 give {speed(steady)}.",
        abs(first / steady - 1) > 0.01,
        {"first_period": first, "steady": steady},
    )


def missing_amplitudes(amplitudes: Amplitudes) -> Erratum:
    """The amplitudes."""
    chosen = amplitudes.section5.chosen
    return Erratum(
        "4, 5.2–5.4",
        "no amplitude A",
        f"{listed(millimetres(e.amplitude) for e in EXPERIMENTS)} for {listed(f'{e.tilt_deg}°' for e in EXPERIMENTS)}, "
        f"and {listed(millimetres(a, 1) for a in chosen)} in 5.2 to 5.4 (inferred)",
        "The section on amplitudes shows which intervals reproduce the printed numbers. "
        + ("One amplitude for all angles does not exist." if amplitudes.common is None else "One amplitude would serve all angles."),
        len(chosen) == 1 and amplitudes.common is None,
        {"chosen": list(chosen)},
    )


def letter() -> Erratum:
    """Eq. 5.1."""
    return Erratum(
        "5.1", "ẏ = … in the first branch", "v̇ = …", "No y is defined; the second branch and the dimensional equation before it have v̇."
    )


def third_ratio() -> Erratum:
    """Eq. 5.2: k3."""
    tilt, A = np.radians([e.tilt_deg for e in EXPERIMENTS]), np.array([e.amplitude for e in EXPERIMENTS])
    robot = rig(EXPERIMENTS[0], tilt_deg=np.degrees(tilt), amplitude=A)
    law = robot.friction
    printed, right = (0.21 + np.tan(tilt)) / (0.18 - np.tan(tilt)), (0.18 + np.tan(tilt)) / (0.18 - np.tan(tilt))
    k2 = law.f_minus / law.mu_minus
    velocity = {}
    for name, k3 in (("printed", printed), ("right", right)):
        other = dataclasses.replace(law, mu_minus=k3 * law.mu_plus, f_minus=k2 * k3 * law.mu_plus)
        velocity[name] = batch(dataclasses.replace(robot, friction=other), periods=200).mean_velocity
    dimensional = batch(robot, periods=200).mean_velocity
    error = {name: abs(v / dimensional - 1) for name, v in velocity.items()}
    text = "; ".join(
        f"{e.tilt_deg}°: {speed(a)} against {speed(b)} (paper {speed(e.lugre, 2 if e.lugre < 0.01 else 3)})"
        for e, a, b in zip(EXPERIMENTS, velocity["printed"], velocity["right"], strict=True)
    )
    paper = np.array([e.lugre for e in EXPERIMENTS])
    missed = [f"{e.tilt_deg}°" for e, v in zip(EXPERIMENTS, velocity["printed"], strict=True) if abs(v - e.lugre) > 2 * ROUNDING]
    return Erratum(
        "5.2",
        "k₃ = (f₀ + tan θ)/(μ₀ − tan θ)",
        "k₃ = (μ₀ + tan θ)/(μ₀ − tan θ)",
        "By definition k₃ = μ₋/μ₊. With the right one Eq. 5.1 gives the velocities of the dimensional equations (to "
        f"{plain(max(error['right']), 1)}); with "
        f"the printed one it misses them by {percent(min(error['printed']))} to {percent(max(error['printed']))}: {text}. The paper's "
        "own results used the "
        f"right one: the printed one would miss its LuGre velocities at {listed(missed)}.",
        bool(max(error["right"]) < 1e-6 and missed and (abs(velocity["right"] - paper) <= 2 * ROUNDING).all()),
        {"printed": printed.tolist(), "right": right.tolist(), "relative_error": {k: v.tolist() for k, v in error.items()}},
    )


def ratios() -> Erratum:
    """k1, k2 > 1."""
    equal = [c.figure for c in CASES if rig(c).friction.f_plus == rig(c).friction.mu_plus]
    return Erratum(
        "after 5.2",
        "k₁ > 1, k₂ > 1",
        "k₁ ≥ 1, k₂ ≥ 1",
        f"Figures {listed(equal)} are drawn with f₀ = μ₀, where both are 1.",
        bool(equal),
        {"figures": equal},
    )


def errata(table: tuple[Row, ...], amplitudes: Amplitudes) -> tuple[Erratum, ...]:
    """Every erratum, in the order of the paper."""
    checks: tuple[Callable[[], Erratum], ...] = (
        at_rest,
        beam_equation,
        patch_moment,
        transient,
        lambda: weight(table),
        lambda: incline(table),
        figure_numbers,
        lambda: third_type(table),
        steady_velocity,
        lambda: missing_amplitudes(amplitudes),
        letter,
        third_ratio,
        ratios,
    )
    return tuple(make() for make in checks)
