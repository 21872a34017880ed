"""The checks of the errata: a function for each, named as its text in ``sentences.toml``; errata without computation have none."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.show.paper.amplitudes import ROUNDING
from stickslip.show.paper.cases import AMPLITUDE_5, CASES, EXPERIMENTS, rig
from stickslip.show.paper.claims_page import ClaimData
from stickslip.show.paper.errata import Erratum
from stickslip.show.paper.readings import PRINTED_READING, STATED
from stickslip.show.paper.sentences import filled, texts
from stickslip.show.paper.solved_runs import batch

__all__ = ["errata"]

#: Whether the erratum is confirmed, the numbers of the check, and other values for the text.
Check = tuple[Any, dict[str, Any], dict[str, Any]]

# Units as exponents of kg, m, s, A.
KG, METRE, SECOND, AMPERE = np.eye(4, dtype=int)
NEWTON = KG + METRE - 2 * SECOND
VOLT = NEWTON + METRE - SECOND - AMPERE


def at_rest(study: ClaimData) -> Check:
    """Eq. 2.6 at v = 0."""
    law, load, z, v = rig(EXPERIMENTS[0]).friction, 0.7, 1e-7, 1e-9
    limits = [law.rate(side * v, z, load) for side in (1, -1)]
    slopes = [limits[0] / v, limits[1] / -v]
    holds = max(abs(x) for x in limits) < 2 * v and abs(slopes[0] - slopes[1]) > 1e-3 and law.rate(0.0, z, load) == 0.0
    return holds, {"limits": limits, "slopes": slopes}, {}


def beam_equation(study: ClaimData) -> Check:
    """Eq. 3.1."""
    bending, inertia = NEWTON + 2 * METRE + METRE - 4 * METRE, KG - METRE + METRE - 2 * SECOND
    printed = KG - METRE + METRE - 2 * METRE
    beam, static = study.beam.beam, study.beam.undamped(np.array([1e-3]))[0]
    moment, arm = float(beam.moment_per_volt), float(beam.patch_length * (beam.length - beam.patch_length / 2) / beam.bending_stiffness)
    return (bending == inertia).all() and (bending != printed).any(), {"tip_over_static": float(static / (moment * arm))}, {}


def density(study: ClaimData) -> Check:
    """Eq. 3.1, its letters."""
    per_length, per_volume, area = KG - METRE, KG - 3 * METRE, 2 * METRE
    return (per_volume + area == per_length).all() and (per_length + area != per_length).any(), {}, {}


def patch_moment(study: ClaimData) -> Check:
    """Eq. 3.2."""
    others = (METRE - VOLT) + METRE + METRE + VOLT
    modulus, electric = NEWTON - 2 * METRE, VOLT - METRE
    moment = NEWTON + METRE
    return (others + modulus == moment).all() and (others + electric != moment).any(), {}, {}


def transient(study: ClaimData) -> Check:
    """Eq. 3.6."""
    zeta, free, phi, force = 0.05, 1.0, 0.7, 0.6
    damped = free * np.sqrt(1 - zeta**2)

    def residual(w: float) -> float:
        """Largest value of q'' + 2 zeta q' + q for the bracket times the decay, by its complex exponents."""
        t = np.linspace(0.0, 20.0, 401)
        total = np.zeros_like(t, complex)
        b = free / damped * (zeta * np.sin(phi) - force / free * np.cos(phi))
        for amplitude, s in ((np.sin(phi), -zeta * free + 1j * w), (-1j * b, -zeta * free + 1j * damped)):
            total += amplitude * (s**2 + 2 * zeta * free * s + free**2) * np.exp(s * t)
        return float(abs(total.real).max())

    printed, right = residual(free), residual(damped)
    return printed > 1e-3 and right < 1e-12, {"printed": printed, "right": right}, {}


def break_away(study: ClaimData) -> Check:
    """Eq. 2.4."""
    fits = {f.reading: f for f in study.amplitudes.fits}
    ours, printed = fits[STATED], fits[PRINTED_READING]
    complete = ours.velocities == 8 and ours.types == 4
    missed = [f"{b.experiment.tilt_deg}°" for b in printed.brackets if b.joint is None]
    return (
        complete and bool(missed),
        {"stated": ours.as_data(), "printed": printed.as_data()},
        {"ours": ours, "other": printed, "missed": missed},
    )


def weight(study: ClaimData) -> Check:
    """Eq. 3.8."""
    fits = study.amplitudes.fits
    heavy = {
        f.reading.breakaway: [f"{b.experiment.tilt_deg}°" for b in f.brackets if b.joint is None] for f in fits if f.reading.weight == "M"
    }
    return all(heavy.values()), {"angles_without_amplitude": heavy}, {"heavy": heavy}


def incline(study: ClaimData) -> Check:
    """Folding."""
    difference = [r.gravity / r.lugre - 1 for r in study.table]
    return min(difference) > 0.01, {"relative_difference": difference}, {}


def third_type(study: ClaimData) -> Check:
    """Type three."""
    row = next(r for r in study.table if r.experiment.type == "III")
    return row.pattern in ("+0-", "+-0"), {"pattern": row.pattern}, {"row": row}


def steady_velocity(study: ClaimData) -> Check:
    """The definition of the mean velocity."""
    from stickslip.solvers import solve

    x = solve(rig(EXPERIMENTS[0]), periods=200, rtol=1e-8)
    T, at = x.period_time, x.strobe_x
    first, steady = float(at[1] - at[0]) / T, float(at[200] - at[100]) / (100 * T)
    return abs(first / steady - 1) > 0.01, {"first_period": first, "steady": steady}, {}


def missing_amplitudes(study: ClaimData) -> Check:
    """The amplitudes."""
    common, search = study.amplitudes.common, study.amplitudes.section5.stated
    low, high = search.best
    inside = all(b.inside for b in study.amplitudes.section4) and low <= AMPLITUDE_5 <= high
    return inside and common is None, search.as_data(), {"experiments": EXPERIMENTS, "common": common, "A": AMPLITUDE_5, "search": search}


def third_ratio(study: ClaimData) -> Check:
    """Eq. 5.2: k3."""
    tilt, A = np.radians([e.tilt_deg for e in EXPERIMENTS]), np.array([e.amplitude for e in EXPERIMENTS])
    robot = rig(EXPERIMENTS[0], tilt_deg=np.degrees(tilt), amplitude=A)
    law = robot.friction
    k3 = {name: (mu + np.tan(tilt)) / (0.18 - np.tan(tilt)) for name, mu in (("printed", 0.21), ("right", 0.18))}
    velocity = {name: _with_ratios(robot, law.f_minus / law.mu_minus, k) for name, k in k3.items()}
    dimensional, paper = batch(robot, periods=200).mean_velocity, np.array([e.lugre for e in EXPERIMENTS])
    error = {name: abs(v / dimensional - 1) for name, v in velocity.items()}
    off = {name: abs(v - paper) > 2 * ROUNDING for name, v in velocity.items()}
    missed = [f"{e.tilt_deg}°" for e, far in zip(EXPERIMENTS, off["printed"], strict=True) if far]
    periods = {name: _periods(f0) for name, f0 in (("printed", 0.21), ("right", 0.04))}
    numbers = {
        **{name: k.tolist() for name, k in k3.items()},
        "relative_error": {name: e.tolist() for name, e in error.items()},
        "periods": periods,
    }
    rows = list(zip(EXPERIMENTS, velocity["printed"], velocity["right"], strict=True))
    section5 = 2 not in periods["printed"].values() and periods["right"][AMPLITUDE_5] == 2
    holds = max(error["right"]) < 1e-6 and missed and not off["right"].any() and section5
    return holds, numbers, {"rows": rows, "missed": missed, "A": AMPLITUDE_5}


def _periods(numerator: float) -> dict[float, int]:
    """Period numbers at mu0 = 0.04 (Figure 23) by amplitude, with k3 = (numerator + tan)/(0.04 - tan)."""
    A = np.append(1e-4 * np.arange(3, 11), AMPLITUDE_5)
    robot, tan = rig(CASES[-1], amplitude=A, mu0=0.04, f0=0.21), np.tan(np.radians(1.7))
    law, k3 = robot.friction, (numerator + tan) / (0.04 - tan)
    mu_minus = k3 * law.mu_plus
    other = dataclasses.replace(law, mu_minus=mu_minus, f_minus=law.f_minus / law.mu_minus * mu_minus)
    many = batch(dataclasses.replace(robot, friction=other), periods=400, settle=300, rtol=1e-8)
    return {round(float(a), 9): int(n) for a, n in zip(A, many.period, strict=True)}


def _with_ratios(robot: Any, k2: Any, k3: Any) -> Any:
    """Mean velocities with the friction coefficients that follow from the ratios."""
    other = dataclasses.replace(robot.friction, mu_minus=k3 * robot.friction.mu_plus, f_minus=k2 * k3 * robot.friction.mu_plus)
    return batch(dataclasses.replace(robot, friction=other), periods=200).mean_velocity


def ratios(study: ClaimData) -> Check:
    """k1, k2 > 1."""
    equal = [c.figure for c in CASES if rig(c).friction.f_plus == rig(c).friction.mu_plus]
    return bool(equal), {"figures": equal}, {}


CHECKS: tuple[Callable[[ClaimData], Check], ...] = (
    break_away, at_rest, beam_equation, density, patch_moment, transient, weight, incline, third_type, steady_velocity,
    missing_amplitudes, third_ratio, ratios,
)  # fmt: skip


def errata(study: ClaimData) -> tuple[Erratum, ...]:
    """Every erratum, in the order of the paper."""
    checks = {check.__name__: check for check in CHECKS}
    return tuple(_erratum(text, checks.get(key), study) for key, text in texts("errata").items())


def _erratum(text: dict[str, str], check: Callable[[ClaimData], Check] | None, study: ClaimData) -> Erratum:
    holds, numbers, more = check(study) if check else (None, {}, {})
    return Erratum(**filled(text, {**numbers, **more}), holds=None if holds is None else bool(holds), numbers=numbers)
