"""Statements made in passing: lifting of the tip, limits of the voltage, Runge-Kutta, passivity, and type II by its definition."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.show.paper.beam import VOLTAGE
from stickslip.show.paper.cases import CASES, EXPERIMENTS, OMEGA, rig
from stickslip.show.paper.claims_page import ClaimData, PaperClaim, judged, together
from stickslip.show.paper.solved_runs import batch

__all__ = ["passive", "runge_kutta", "type_two_with_lugre", "vertical_motion", "voltage_and_frequency"]

#: Steps per period that are tried, and the relative error of the mean velocity that is asked for.
STEPS, FAST_STEPS, GOOD = (100, 200, 500, 1000, 2000, 5000, 10_000, 20_000), (500, 1000, 2000), 1e-3
#: Limits of the paper's hardware [V], [Hz].
VOLTS, HERTZ = (10.0, 150.0), 5000.0


def vertical_motion(study: ClaimData) -> PaperClaim:
    """The tip hardly moves along the beam."""
    lift = [study.beam.shortening(e.amplitude) for e in EXPERIMENTS]
    robot = rig(EXPERIMENTS[0])
    share = float(robot.mass_ratio / robot.gravity)
    ripple = [share * (2 * OMEGA) ** 2 * y for y in lift]
    numbers = {"amplitude": lift, "load_ripple": ripple}
    return judged("vertical_motion", max(ripple) < 0.05, numbers, tilts=[e.tilt_deg for e in EXPERIMENTS])


def voltage_and_frequency(study: ClaimData) -> PaperClaim:
    """Ten to 150 V, below 5000 Hz."""
    volts = [VOLTAGE * e.amplitude / float(study.beam.amplitude(OMEGA)) for e in EXPERIMENTS]
    used = sorted({OMEGA / (2 * np.pi), *(c.changes["omega"] / (2 * np.pi) for c in CASES if c.section == "5.2")})
    modes = study.beam.beam.frequencies(8)
    below = int((np.asarray(modes) < HERTZ).sum())
    hold = (used[-1] < HERTZ, VOLTS[0] <= min(volts) and max(volts) <= VOLTS[1])
    numbers = {"volts": volts, "frequencies": used, "resonances_below_limit": below}
    return judged("voltage_and_frequency", together(*hold), numbers, [(part, {}) for part in hold], resonances=modes[:below])


def runge_kutta(study: ClaimData) -> PaperClaim:
    """How many Runge-Kutta steps each figure needs."""
    solved = {e.figure: (study.runs.lugre[e.name], e) for e in EXPERIMENTS} | {c.figure: (study.runs.figures[c.figure], c) for c in CASES}
    figures = sorted(n for n in solved if n not in (11, 17))
    models = [solved[n][0].model for n in figures]
    rows: dict[str, Any] = {
        name: np.array([float(getattr(m.friction, name)) for m in models]) for name in ("mu_plus", "mu_minus", "f_plus", "f_minus")
    }
    drive = {name: np.array([float(getattr(m.drive, name)) for m in models]) for name in ("amplitude", "omega")}
    robot = models[0].replace({**{f"friction.{k}": v for k, v in rows.items()}, **{f"drive.{k}": v for k, v in drive.items()}})
    best = batch(robot, periods=60, settle=40, rtol=1e-8).mean_velocity
    need: dict[int, int | None] = dict.fromkeys(figures)
    for steps in reversed(FAST_STEPS if study.fast else STEPS):
        study.tell(f"Runge-Kutta with {steps} steps per period", 0, 1)
        summary = batch(robot, periods=60, settle=40, method="rk4", steps=steps)
        for n, v, exact, status in zip(figures, summary.mean_velocity, best, summary.status, strict=True):
            good = int(status) <= 1 and abs(v / exact - 1) < GOOD
            need[n] = steps if good and need[n] in (None, *[s for s in (FAST_STEPS if study.fast else STEPS) if s > steps][:1]) else need[n]
    groups: dict[int, list[int]] = {}
    for n, steps_needed in need.items():
        groups.setdefault(steps_needed or 0, []).append(n)
    holds = together(*(n != 0 for n in groups))
    return judged(
        "runge_kutta",
        holds,
        {"steps": need},
        groups=dict(sorted(groups.items())),
        good=GOOD,
        most=(FAST_STEPS if study.fast else STEPS)[-1],
    )


def passive(study: ClaimData) -> PaperClaim:
    """Passivity of the bristle."""
    law = rig(EXPERIMENTS[0]).friction
    bounds = [law.sigma2 * mu / (f - mu) for mu, f in ((law.mu_plus, law.f_plus), (law.mu_minus, law.f_minus))]
    solved = {e.figure: study.runs.lugre[e.name] for e in EXPERIMENTS} | study.runs.figures
    back = {figure: _given_back(run) for figure, run in sorted(solved.items())}
    along = next(a for a in study.omitted.along if a.name == "sigma1")
    at = [int(np.argmin(abs(np.log(along.values / s)))) for s in (min(bounds), 100.0)]
    numbers = {
        "bounds": bounds, "sigma1": law.sigma1, "given_back": back, "velocity_at_bound": float(along.lugre[at[0]]),
        "label_at_bound": str(along.labels[at[0]]), "velocity": float(along.lugre[at[1]]), "label": str(along.labels[at[1]]),
    }  # fmt: skip
    giving = [figure for figure, share in back.items() if share > 1e-9]
    hold = (law.sigma1 <= min(bounds), together(*(share <= 1e-9 for share in back.values())))
    return judged("passive", together(*hold), numbers, [(part, {}) for part in hold], tried=float(along.values[at[0]]), giving=giving)


def _given_back(run: Any) -> float:
    """Energy that the contact gives back beyond what its bristle had stored, over what it dissipates, in the settled motion."""
    law = run.model.friction
    c = run.at(np.linspace(run.strobe_times[-3], run.strobe_times[-1], 20_001)[:-1])
    rate = (c["friction_force"] - law.sigma0 * c["z"] - law.sigma2 * c["v"]) / law.sigma1
    power = c["friction_force"] * c["v"] - law.sigma0 * c["z"] * rate
    return float(np.maximum(-power, 0.0).sum() / np.maximum(power, 0.0).sum())


def type_two_with_lugre(study: ClaimData) -> PaperClaim:
    """Type II with LuGre friction, by its definition."""
    search = study.type_two
    two = [figure for figure, run in study.runs.twins.items() if _type(run) == "II"] + [
        r.experiment.figure for r in study.table if r.type == "II"
    ]
    numbers = {**search.as_data(), "figures_whose_exact_type_is_two": sorted(two)}
    parts = [(search.figures[n] >= 0, {"n": n}) for n in sorted(two)]
    worst = max(search.figures, key=lambda n: search.figures[n])
    return judged(
        "type_two_with_lugre", not search.misses_all, numbers, parts, worst=worst, largest=max(abs(f) for f in search.friction.values())
    )


def _type(run: Any) -> str:
    from stickslip.analysis.motion import motion

    return motion(run).type
