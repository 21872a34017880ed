"""Claims of section 2.2 about laws that the paper does not use: Dahl's and the bristle model."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.analysis.bench.pulled import stick_slip
from stickslip.analysis.bench.setup import Setup
from stickslip.analysis.bench.velocity import steady_friction
from stickslip.models.friction import Bristle, Coulomb, Dahl
from stickslip.models.normal_loads import normal_load
from stickslip.show.paper.cases import EXPERIMENTS, rig
from stickslip.show.paper.claims_page import ClaimData, PaperClaim, judged
from stickslip.solvers import solve

__all__ = ["bristle_is_slow", "dahl_without_stick_slip"]

#: Spring of the pulled mass [N/m]: it extends a thousand times as far as the bristles.
SPRING = 400.0
#: Fraction of a drive period run with the bristle model, and periods of the robot under Dahl friction, with scipy's DOP853.
PART, PERIODS = 0.3, 8
#: The same in the fast subset.
FAST_PART, FAST_PERIODS = 0.25, 4
#: Threshold of rest, relative to the largest speed of the body.
STILL = 0.02
_PLAIN: dict[str, Any] = {"method": "dop853", "rtol": 1e-6}


def dahl_without_stick_slip(study: ClaimData) -> PaperClaim:
    """Dahl: neither stick-slip nor Stribeck."""
    robot = rig(EXPERIMENTS[0])
    own = robot.friction
    load, mass = float(normal_load(robot, 0.0, 0.0)), float(robot.total_mass)
    numbers: dict[str, Any] = {}
    level = own.replace(mu_plus=0.18, mu_minus=0.18, f_plus=0.21, f_minus=0.21)
    for name, law in (("lugre", level), ("dahl", Dahl(0.18, 0.18, own.sigma0))):
        setup = Setup(law, load, mass, stiffness=SPRING, plain=True)
        numbers |= {f"{name}_{q.key}": q.value for e in (steady_friction(setup), stick_slip(setup)) for q in e.numbers}
    folded = {"Coulomb": Coulomb(own.mu_plus, own.mu_minus), "Dahl": Dahl(own.mu_plus, own.mu_minus, own.sigma0)}
    periods = FAST_PERIODS if study.fast else PERIODS
    rests = {name: _still(replace(robot, friction=law), periods) for name, law in folded.items()}
    sticks = not numbers["dahl_stick_slip"] and numbers["lugre_stick_slip"]
    hold = (numbers["dahl_fall"] == 0, sticks, rests["Dahl"] < 0.5 * rests["Coulomb"])
    values = {"spring": SPRING, "periods": periods, "still": STILL}
    return judged("dahl_without_stick_slip", all(hold[:2]), {**numbers, "share_still": rests}, [(part, {}) for part in hold], **values)


def _still(robot: Any, periods: int) -> float:
    """Fraction of the last of some periods in which the body is nearly at rest."""
    run = solve(robot, periods=periods, **_PLAIN)
    v = abs(run.at(np.linspace(run.strobe_times[-2], run.strobe_times[-1], 2001))["v"])
    return float(np.mean(v < STILL * v.max()))


def bristle_is_slow(study: ClaimData) -> PaperClaim:
    """Bristle model: tiny steps, long simulations."""
    robot = rig(EXPERIMENTS[0])
    part = FAST_PART if study.fast else PART
    own, time = robot.friction, part * float(robot.period)
    laws = {"lugre": own, "bristle": Bristle(own.mu_plus, own.mu_minus, own.sigma0)}
    runs = {name: solve(replace(robot, friction=law), duration=time, **_PLAIN) for name, law in laws.items()}
    counts = {name: {n: int(c) for n, c in run.counts.items()} for name, run in runs.items()}
    snaps = len([e for e in runs["bristle"].events if e.kind == "switch"])
    path, ends = {name: _path(run.x) for name, run in runs.items()}, {name: run.v[-1] for name, run in runs.items()}
    exact = study.runs.coulomb[EXPERIMENTS[0].name]
    whole = _path(exact.x[exact.t >= exact.strobe_times[-2]])
    ratio = counts["bristle"]["evaluations"] / counts["lugre"]["evaluations"]
    tiny = ratio > 10 and counts["bristle"]["steps"] > 10 * counts["lugre"]["steps"]
    return judged(
        "bristle_is_slow",
        tiny,
        {"counts": counts, "snaps": snaps, "path": path, "path_of_a_period": whole},
        [(tiny, {}), (None, {})],
        part=part,
        step=time / counts["bristle"]["steps"],
        snaps_of_a_period=100 * round(whole / path["bristle"] * snaps / 100),
        ends=ends,
        away=abs(ends["bristle"] / ends["lugre"] - 1),
        ratio=ratio,
    )


def _path(x: Any) -> float:
    return float(np.sum(abs(np.diff(x))))
