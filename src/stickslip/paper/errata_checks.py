"""The checks of the errata: a function for each, named as its text in ``sentences.toml``; errata without computation have none."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.paper.amplitudes import ROUNDING
from stickslip.paper.cases import CASES, EXPERIMENTS, rig
from stickslip.paper.claims_page import Study
from stickslip.paper.errata import Erratum
from stickslip.paper.sentences import filled, texts
from stickslip.paper.solved_runs import batch

__all__ = ["errata"]

#: Whether the erratum is confirmed, the numbers of the check, and other values for the text.
Check = tuple[Any, dict[str, Any], dict[str, Any]]

# Units as exponents of kg, m, s, A.
KG, METRE, SECOND, AMPERE = np.eye(4, dtype=int)
NEWTON = KG + METRE - 2 * SECOND
VOLT = NEWTON + METRE - SECOND - AMPERE


def at_rest(study: Study) -> Check:
    """Eq. 2.6 at v = 0."""
    law, load, z, v = rig(EXPERIMENTS[0]).friction, 0.7, 1e-7, 1e-9
    limits = [law.rate(side * v, z, load) for side in (1, -1)]
    slopes = [limits[0] / v, limits[1] / -v]
    holds = max(abs(x) for x in limits) < 2 * v and abs(slopes[0] - slopes[1]) > 1e-3 and law.rate(0.0, z, load) == 0.0
    return holds, {"limits": limits, "slopes": slopes}, {}


def beam_equation(study: Study) -> Check:
    """Eq. 3.1."""
    bending, inertia = NEWTON + 2 * METRE + METRE - 4 * METRE, KG - METRE + METRE - 2 * SECOND
    printed = KG - METRE + METRE - 2 * METRE
    return (bending == inertia).all() and (bending != printed).any(), {}, {}


def patch_moment(study: Study) -> Check:
    """Eq. 3.2."""
    others = (METRE - VOLT) + METRE + METRE + VOLT
    modulus, electric = NEWTON - 2 * METRE, VOLT - METRE
    moment = NEWTON + METRE
    return (others + modulus == moment).all() and (others + electric != moment).any(), {}, {}


def transient(study: Study) -> Check:
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


def weight(study: Study) -> Check:
    """Eq. 3.8."""
    robot = rig(EXPERIMENTS[0])
    fits = {"Mg": _fits(robot.body_mass / robot.total_mass), "(M+m)g": _fits(1.0)}
    lost, every = [tilt for tilt, count in fits["Mg"].items() if not count], all(fits["(M+m)g"].values())
    return lost and every, {"amplitudes_that_fit": fits}, {"lost": lost, "every": every}


def _fits(share: float) -> dict[str, int]:
    """The number of amplitudes in a scan that give the printed type and velocities, for each angle, with friction scaled by `share`."""
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


def incline(study: Study) -> Check:
    """Folding."""
    difference = [r.gravity / r.lugre - 1 for r in study.table]
    return min(difference) > 0.01, {"relative_difference": difference}, {}


def third_type(study: Study) -> Check:
    """Type three."""
    row = next(r for r in study.table if r.experiment.type == "III")
    return row.pattern in ("+0-", "+-0"), {"pattern": row.pattern}, {"row": row}


def steady_velocity(study: Study) -> Check:
    """The definition of the mean velocity."""
    from stickslip.solvers import solve

    x = solve(rig(EXPERIMENTS[0]), periods=200, rtol=1e-8)
    T, at = x.period_time, x.strobe_x
    first, steady = float(at[1] - at[0]) / T, float(at[200] - at[100]) / (100 * T)
    return abs(first / steady - 1) > 0.01, {"first_period": first, "steady": steady}, {}


def missing_amplitudes(study: Study) -> Check:
    """The amplitudes."""
    chosen, common = list(study.amplitudes.section5.chosen), study.amplitudes.common
    return len(chosen) == 1 and common is None, {"chosen": chosen}, {"experiments": EXPERIMENTS, "common": common}


def third_ratio(study: Study) -> Check:
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
    numbers = {**{name: k.tolist() for name, k in k3.items()}, "relative_error": {name: e.tolist() for name, e in error.items()}}
    rows = list(zip(EXPERIMENTS, velocity["printed"], velocity["right"], strict=True))
    return max(error["right"]) < 1e-6 and missed and not off["right"].any(), numbers, {"rows": rows, "missed": missed}


def _with_ratios(robot: Any, k2: Any, k3: Any) -> Any:
    """Mean velocities with the friction coefficients that follow from the ratios."""
    other = dataclasses.replace(robot.friction, mu_minus=k3 * robot.friction.mu_plus, f_minus=k2 * k3 * robot.friction.mu_plus)
    return batch(dataclasses.replace(robot, friction=other), periods=200).mean_velocity


def ratios(study: Study) -> Check:
    """k1, k2 > 1."""
    equal = [c.figure for c in CASES if rig(c).friction.f_plus == rig(c).friction.mu_plus]
    return bool(equal), {"figures": equal}, {}


CHECKS: tuple[Callable[[Study], Check], ...] = (
    at_rest, beam_equation, patch_moment, transient, weight, incline, third_type, steady_velocity, missing_amplitudes, third_ratio, ratios,
)  # fmt: skip


def errata(study: Study) -> tuple[Erratum, ...]:
    """Every erratum, in the order of the paper."""
    checks = {check.__name__: check for check in CHECKS}
    return tuple(_erratum(text, checks.get(key), study) for key, text in texts("errata").items())


def _erratum(text: dict[str, str], check: Callable[[Study], Check] | None, study: Study) -> Erratum:
    holds, numbers, more = check(study) if check else (None, {}, {})
    return Erratum(**filled(text, {**numbers, **more}), holds=None if holds is None else bool(holds), numbers=numbers)
