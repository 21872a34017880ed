"""Friction against velocity: steady, and while the velocity rises and falls."""

from __future__ import annotations

import math
from itertools import pairwise

from stickslip.analysis.bench.findings import Experiment, ExperimentCurve, Quantity
from stickslip.analysis.bench.setup import Setup

#: Speeds of the steady curve, and angular frequencies of the lag experiment, in typical units of the law.
SPEEDS, FREQUENCIES = (0.01, 30.0), (0.01, 0.05, 0.25)
#: Mean and amplitude of the velocity in the lag experiment, in typical velocities.
MIDDLE, SWING = 1.5, 1.2


def steady_friction(bench: Setup) -> Experiment:
    """Steady friction against velocity, in both directions."""
    count = 5 if bench.random else 17 if bench.remembers else 81
    ratio = (SPEEDS[1] / SPEEDS[0]) ** (1.0 / (count - 1))
    speeds = [bench.typical_speed * SPEEDS[0] * ratio**k for k in range(count)]
    forward, backward = ([force_at_speed(bench, side * v) for v in speeds] for side in (1.0, -1.0))
    low, high = bench.holds
    return Experiment(
        "steady", "steady friction", ("speed |v|", "m/s"), ("friction force |R|", "N"),
        (
            ExperimentCurve("forwards", speeds, forward),
            ExperimentCurve("backwards", speeds, [-R for R in backward]),
            *_at_rest(bench, speeds[0]),
        ),
        (
            Quantity("slow_forward", "static or slow, forwards", high, "N", _holding(bench)),
            Quantity("slow_backward", "static or slow, backwards", abs(low), "N", "the same for motion backwards"),
            Quantity("fall", "fall with speed", _zero(bench.fall, bench), "N", "from there to the least in sliding forwards"),
        ),
        {"slowest": (speeds[0], "m/s"), "fastest": (speeds[-1], "m/s")},
        _steady_remark(bench), "x",
    )  # fmt: skip


def _at_rest(bench: Setup, edge: float) -> tuple[ExperimentCurve, ...]:
    """The static friction limits if rest is exact; a logarithmic axis has no place for speed 0, so they stand at its end."""
    low, high = bench.holds
    return (ExperimentCurve("at rest", (edge, edge), (high, -low)),) if bench.set_valued and high - low > 0 else ()


def force_at_speed(bench: Setup, v: float) -> float:
    """Steady force [N]; NaN where the law balances the applied force."""
    if bench.probe.law.needs_applied:
        low, high = (float(bench.probe.force(v, (), (), side * 1e12)) for side in (-1.0, 1.0))
        return low if low == high else math.nan
    return bench.steady_force(v)


def _holding(bench: Setup) -> str:
    if bench.set_valued or not bench.remembers:
        return "largest static friction force forwards"
    return f"steady friction at {0.01 * bench.typical_speed:.3g} m/s forwards"


def _steady_remark(bench: Setup) -> str:
    if bench.probe.law.needs_applied:
        return f"inside its band, |v| <= {bench.typical_speed:.3g} m/s, the law balances the other forces; there is no curve there"
    if bench.random:
        return "bonds form at random places: means over a short displacement, which scatter"
    return "" if bench.set_valued or bench.remembers else "friction goes to zero with the speed: the law has no static friction"


def lag(bench: Setup) -> Experiment:
    """Frictional lag: friction against a velocity that oscillates about a mean without changing its sign."""
    middle, swing = MIDDLE * bench.typical_speed, SWING * bench.typical_speed
    frequencies = [f * middle / bench.length for f in (FREQUENCIES[-1:] if bench.random else FREQUENCIES)]
    loops = [_loop(bench, middle, swing, omega) for omega in frequencies]
    widths = [_area(loop) / (2.0 * swing) if bench.remembers else 0.0 for loop in loops]
    shown = max(range(len(widths)), key=lambda k: abs(widths[k]))
    curves = [
        ExperimentCurve(f"{omega:.3g} rad/s", *zip(*loop, strict=True)) for omega, loop in zip(frequencies, loops, strict=True)
    ] if bench.remembers else [ExperimentCurve("any frequency", *zip(*loops[0], strict=True))]  # fmt: skip
    lagging = "rising minus falling velocity, mean over the swing of the velocity"
    return Experiment(
        "lag", "frictional lag", ("velocity v", "m/s"), ("friction force R", "N"), tuple(curves),
        (Quantity("lag", "lag", _zero(widths[shown], bench), "N", f"{lagging}, at {frequencies[shown]:.3g} rad/s"),),
        {"middle": (middle, "m/s"), "swing": (swing, "m/s"), "omega": (frequencies[shown], "rad/s")},
        "" if bench.remembers else "the law has no memory: the same curve up and down, at every frequency",
    )  # fmt: skip


def _zero(force: float, bench: Setup) -> float:
    """A force [N], or 0 if it is rounding."""
    return force if abs(force) > 1e-9 * bench.force else 0.0


def _loop(bench: Setup, middle: float, swing: float, omega: float) -> list[tuple[float, float]]:
    """Velocity and force over one cycle, after the transient."""
    T = 2.0 * math.pi / omega

    def velocity(t: float) -> float:
        return middle + swing * math.sin(omega * t)

    if not bench.remembers:
        return [(velocity(T * k / 200), force_at_speed(bench, velocity(T * k / 200))) for k in range(201)]
    moved = bench.contact(middle * T)
    for _ in range(1 if bench.random else 2):
        moved.follow(T, velocity)
    return [(v, R) for _, _, v, R in moved.follow(T, velocity, samples=240)]


def _area(loop: list[tuple[float, float]]) -> float:
    """Integral of the force over the velocity around a loop [N m/s]."""
    return math.fsum(0.5 * (R0 + R1) * (v1 - v0) for (v0, R0), (v1, R1) in pairwise(loop))
