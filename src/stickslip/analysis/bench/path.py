"""Friction against displacement: hysteresis with reversal points, and the loss per cycle."""

from __future__ import annotations

import math

from stickslip.analysis.bench.contact import MovedContact, swing
from stickslip.analysis.bench.findings import Experiment, ExperimentCurve, Quantity
from stickslip.analysis.bench.setup import HELD, Setup

#: Turning points of the hysteresis, in units of its reach: an inner loop from 0 to 1/2 and back within the second outer loop.
TURNS, REACH = (1.0, -1.0, 1.0, 0.0, 0.5, 0.0, -1.0, 1.0), 1.5
#: Amplitudes of the cycles in typical deflections; the one whose loss is in the table; the maximum number of cycles until they repeat.
AMPLITUDES, IN_TABLE, CYCLES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0), 10.0, 150


def hysteresis(bench: Setup) -> Experiment:
    """Pre-sliding hysteresis with reversal points."""
    reach = REACH * bench.length
    moved, x, points, marks = bench.contact(10.0 * reach), 0.0, [], []
    for turn in TURNS:
        time, velocity = swing(turn * reach - x, bench.crawl)
        points += [(position, R) for _, position, _, R in moved.follow(time, velocity, samples=80)]
        x = turn * reach
        marks.append((moved.done, points[-1][1]))
    stiffness = math.inf if bench.set_valued and bench.holds[1] > 0 else bench.contact_stiffness
    return Experiment(
        "hysteresis", "pre-sliding hysteresis", ("displacement x", "m"), ("friction force R", "N"),
        (ExperimentCurve("to and fro", *zip(*points, strict=True)),),
        (
            Quantity("stiffness", "contact stiffness", stiffness, "N/m", "slope of the force over the displacement of a fresh contact"),
            Quantity("loop_loss", "loss of the loop", marks[2][0] - marks[0][0], "J", f"over +-{reach:.3g} m, slowly"),
            Quantity("gap", "gap of the inner loop", marks[5][1] - marks[3][1] if bench.remembers else math.nan, "N",
                     "force after an inner loop minus the force before it; 0 is memory of reversal points"),
        ),
        {"reach": (reach, "m"), "peak velocity": (bench.crawl, "m/s")}, _path_remark(bench),
    )  # fmt: skip


def _path_remark(bench: Setup) -> str:
    if bench.set_valued:
        return HELD + "there is no pre-sliding: the force jumps to the other side at a reversal, and reversals are not remembered"
    if bench.probe.law.needs_applied:
        return "moved at ten times its band; inside the band the law needs the other forces, and counts as zero force here"
    return (
        ""
        if bench.remembers
        else "a viscous film: the force depends on velocity, not on displacement, and slow motion dissipates almost nothing"
    )


def dissipation(bench: Setup) -> Experiment:
    """Work dissipated in a steady cycle against its amplitude."""
    amplitudes = [a * bench.length for a in (AMPLITUDES[1:7] if bench.random else AMPLITUDES)]
    losses = [_loss(bench, a) for a in amplitudes]
    shown = amplitudes.index(IN_TABLE * bench.length)
    box = 2.0 * amplitudes[shown] * (bench.steady_force(bench.crawl) - bench.steady_force(-bench.crawl))
    return Experiment(
        "dissipation", "loss per cycle", ("amplitude a", "m"), ("loss per cycle W", "J"),
        (
            ExperimentCurve("slow cycles", amplitudes, losses),
            ExperimentCurve("sliding all the way", amplitudes, [box * a / amplitudes[shown] for a in amplitudes]),
        ),
        (
            Quantity("loss", "loss per cycle", losses[shown], "J", f"at an amplitude of {amplitudes[shown]:.3g} m, slowly"),
            Quantity("loss_share", "share of full sliding", losses[shown] / box, "", "the same by that of sliding all the way"),
            Quantity("loss_exponent", "exponent at small amplitude", _exponent(amplitudes, losses), "",
                     "loss ~ amplitude to this power, between the two smallest"),
        ),
        {"peak velocity": (bench.crawl, "m/s")}, _path_remark(bench) if not bench.set_valued else "", "xy",
    )  # fmt: skip


def _exponent(amplitudes: list[float], losses: list[float]) -> float:
    if min(losses[:2]) <= 0:
        return math.nan
    return math.log(losses[1] / losses[0]) / math.log(amplitudes[1] / amplitudes[0])


def _loss(bench: Setup, amplitude: float) -> float:
    """Loss of a cycle about x = 0 once the cycles repeat."""
    moved: MovedContact = bench.contact(amplitude)
    moved.follow(*swing(amplitude, bench.crawl))
    loss = math.inf
    for _ in range(2 if bench.random else CYCLES):
        before, done = loss, moved.done
        for way in (-2.0, 2.0):
            moved.follow(*swing(way * amplitude, bench.crawl))
        loss = moved.done - done
        if abs(loss - before) < 1e-9 * abs(loss):
            break
    return loss if abs(loss) > 1e-6 * bench.probe_force * amplitude else 0.0
