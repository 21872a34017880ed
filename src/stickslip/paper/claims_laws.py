"""Claims of section 2.2 about the laws that the paper does not use: Dahl's and the bristle model."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.benching.pulled import stick_slip
from stickslip.benching.setup import Setup
from stickslip.benching.velocity import steady_friction
from stickslip.friction import Bristle, Coulomb, Dahl
from stickslip.mechanics import normal_load
from stickslip.paper.cases import EXPERIMENTS, rig
from stickslip.paper.claims_page import CONFIRMED, UNDECIDED, Claim, Part, Study, verdict
from stickslip.paper.words import percent, plain, speed
from stickslip.report.html import grouped
from stickslip.solvers import solve

__all__ = ["bristle_is_slow", "dahl_without_stick_slip"]

#: Spring of the pulled mass [N/m]: it stretches a thousand times as far as the bristles.
SPRING = 400.0
#: Part of a drive period that the bristle model runs, and periods of the robot under Dahl friction, with scipy's DOP853.
PART, PERIODS = 0.3, 8
#: The body counts as still below this share of its largest speed.
STILL = 0.02
_PLAIN: dict[str, Any] = {"method": "dop853", "rtol": 1e-6}


def dahl_without_stick_slip(study: Study) -> Claim:
    """Dahl: neither stick-slip nor Stribeck."""
    robot = rig(EXPERIMENTS[0])
    own = robot.friction
    load, mass = float(normal_load(robot, 0.0, 0.0)), float(robot.total_mass)
    level = own.replace(mu_plus=0.18, mu_minus=0.18, f_plus=0.21, f_minus=0.21)
    found = {}
    for name, law in (("lugre", level), ("dahl", Dahl(0.18, 0.18, own.sigma0))):
        setup = Setup(law, load, mass, stiffness=SPRING, plain=True)
        found[name] = {q.key: q.value for e in (steady_friction(setup), stick_slip(setup)) for q in e.numbers}
    dahl, lugre = found["dahl"], found["lugre"]
    rests = {name: _still(replace(robot, friction=law)) for name, law in _folded(own).items()}
    parts = (
        Part("Stribeck effect", verdict(dahl["fall"] == 0), _fall_text(dahl, lugre)),
        Part("stick-slip of a mass pulled by a spring", verdict(not dahl["stick_slip"] and lugre["stick_slip"]), _pulled_text(dahl, lugre)),
        Part("stop-and-go of the robot itself", verdict(rests["Dahl"] < 0.5 * rests["Coulomb"]), _rest_text(rests)),
    )
    return Claim(
        "dahl_without_stick_slip",
        "2.2, 2.2.2",
        "The Dahl model shows neither stick-slip nor the Stribeck effect.",
        "For the Dahl model, friction phenomenon of stick-slip and Stribeck cannot be simulated",
        verdict(all(p.verdict == CONFIRMED for p in parts[:2])),
        (
            f"{parts[0].evidence[0].upper()}{parts[0].evidence[1:]}.",
            f"{parts[1].evidence[0].upper()}{parts[1].evidence[1:]}.",
            "The claim is judged on stick-slip that friction alone causes. The stop-and-go motion of the robot is a different effect, "
            f"which its drive causes even without static friction: {parts[2].evidence}.",
        ),
        "high: Dahl's force depends on the path alone, so it has one value in sliding",
        {**{f"{law}_{key}": value for law, numbers in found.items() for key, value in numbers.items()}, "share_still": rests},
        parts,
    )


def _folded(own: Any) -> dict[str, Any]:
    """The laws of the robot on its track."""
    return {"Coulomb": Coulomb(own.mu_plus, own.mu_minus), "Dahl": Dahl(own.mu_plus, own.mu_minus, own.sigma0)}


def _still(robot: Any) -> float:
    """Share of the last of some periods in which the body is as good as still."""
    run = solve(robot, periods=PERIODS, **_PLAIN)
    v = abs(run.at(np.linspace(run.strobe_times[-2], run.strobe_times[-1], 2001))["v"])
    return float(np.mean(v < STILL * v.max()))


def _fall_text(dahl: dict[str, Any], lugre: dict[str, Any]) -> str:
    return (
        f"from slow to fast sliding, over four decades of velocity, Dahl friction falls by {plain(dahl['fall'], 3)} N, LuGre friction "
        f"with the paper's numbers by {plain(lugre['fall'], 3)} N"
    )


def _pulled_text(dahl: dict[str, Any], lugre: dict[str, Any]) -> str:
    sticks = {True: "sticks and slips", False: "does not stick"}
    return (
        f"pulled by a spring of {SPRING:g} N/m the body {sticks[bool(dahl['stick_slip'])]} under Dahl friction, and "
        f"{sticks[bool(lugre['stick_slip'])]} under LuGre friction (still for {percent(lugre['stick_share'])} of a cycle of "
        f"{plain(1e3 * lugre['stick_slip_period'], 3)} ms)"
    )


def _rest_text(rests: dict[str, float]) -> str:
    return (
        f"in period {PERIODS} at 1.7° it moves slower than {percent(STILL, 1)} of its peak for {percent(rests['Dahl'])} of the time "
        f"under Dahl and for {percent(rests['Coulomb'])} under Coulomb friction"
    )


def bristle_is_slow(study: Study) -> Claim:
    """Bristle model: tiny steps, long simulations."""
    robot = rig(EXPERIMENTS[0])
    own, T = robot.friction, float(robot.period)
    runs = {
        law: solve(replace(robot, friction=friction), duration=PART * T, **_PLAIN)
        for law, friction in (("lugre", own), ("bristle", Bristle(own.mu_plus, own.mu_minus, own.sigma0)))
    }
    counts = {law: run.counts for law, run in runs.items()}
    snaps = len([e for e in runs["bristle"].events if e.kind == "switch"])
    path = {law: float(np.sum(abs(np.diff(run.x)))) for law, run in runs.items()}
    last = runs["lugre"]
    away = abs(runs["bristle"].v[-1] / last.v[-1] - 1)
    exact = study.runs.coulomb[EXPERIMENTS[0].name]
    whole = float(np.sum(abs(np.diff(exact.x[exact.t >= exact.strobe_times[-2]]))))
    step = PART * T / counts["bristle"]["steps"]
    ratio = counts["bristle"]["evaluations"] / counts["lugre"]["evaluations"]
    tiny = verdict(ratio > 10 and counts["bristle"]["steps"] > 10 * counts["lugre"]["steps"])
    parts = (
        Part("tiny steps, long runs", tiny, f"{plain(ratio, 2)} times the work of LuGre for the same motion by the same method"),
        Part(
            "the performance is generally not good enough", UNDECIDED,
            f"no measure is named; here the velocity at the end differs from LuGre's by {percent(away)}",
        ),
    )  # fmt: skip
    return Claim(
        "bristle_is_slow",
        "2.2",
        "The bristle model needs very small steps and long simulations.",
        "to simulate the dynamic behavior of systems with friction of bristle model, very tiny step size and long simulation time are "
        "needed. Besides, the simulation performance is generally not good enough",
        tiny,
        (
            f"The first {percent(PART, 2)} of a drive period at 1.7°, ten bristles, the same integrator and tolerance: "
            f"{grouped(counts['bristle']['steps'])} steps and {grouped(counts['bristle']['evaluations'])} evaluations of the force, "
            f"against {grouped(counts['lugre']['steps'])} and {grouped(counts['lugre']['evaluations'])} with LuGre friction.",
            f"Every snap ends a step: {grouped(snaps)} of them on the first {plain(1e6 * path['bristle'], 3)} µm, one in "
            f"{plain(1e9 * path['bristle'] / max(snaps, 1), 3)} nm, so the mean step is {plain(1e6 * step, 2)} µs. At this rate a settled "
            f"period, in which the body moves {plain(1e3 * whole, 3)} mm, has about "
            f"{grouped(100 * round(whole / path['bristle'] * snaps / 100))} snaps.",
            f"At the end the velocity differs from LuGre's by {percent(away)} ({speed(runs['bristle'].v[-1])} and {speed(last.v[-1])}).",
        ),
        "high for the steps: they follow from the stiffness of the bristles; the second sentence names no measure",
        {
            "counts": {k: {n: int(c) for n, c in v.items()} for k, v in counts.items()},
            "snaps": snaps,
            "path": path,
            "path_of_a_period": whole,
        },
        parts,
    )
