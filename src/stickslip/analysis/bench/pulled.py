"""A mass pulled by a spring: break-away under a growing force, and stick-slip."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.bench.envelopes import envelope
from stickslip.analysis.bench.findings import Experiment, ExperimentCurve, Quantity
from stickslip.analysis.bench.setup import FAST, HELD, Setup, shorter
from stickslip.basics.contracts import Array
from stickslip.models.machines import PulledMass

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


#: Force rates, in units of the typical force times the bench's characteristic frequency.
RATES = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2)
#: The spring of the ramps is so soft that its end travels this many typical deflections, and fast, until the typical force is reached.
SOFT = 1e4
#: Pulling speed as a fraction of force / sqrt(stiffness mass); number of cycles in a run; rest threshold as a fraction of that speed.
PULL, CYCLES, STILL = 0.05, 12, 0.01
_RTOL = 1e-9


@shorter
def breakaway(bench: Setup) -> Experiment:
    """Break-away force against force rate."""
    rates = [r * bench.force * bench.pace for r in (RATES[3:6] if bench.short else RATES)]
    forces = [bench.holds[1] if bench.set_valued else _breakaway(bench, rate) for rate in rates]
    return Experiment(
        "breakaway", "break-away", ("force rate dF/dt", "N/s"), ("break-away force F", "N"), (ExperimentCurve("forwards", rates, forces),),
        (
            Quantity("breakaway_slow", "break-away, slow", forces[0], "N",
                     f"largest friction before sliding, force rising by {rates[0]:.3g} N/s"),
            Quantity("breakaway_fast", "break-away, fast", forces[-1], "N", f"the same by {rates[-1]:.3g} N/s"),
        ),
        {"sliding from": (FAST * bench.typical_speed, "m/s")}, _breakaway_remark(bench), "x",
    )  # fmt: skip


def _breakaway_remark(bench: Setup) -> str:
    if bench.set_valued:
        return HELD + "break-away is the static limit, at every force rate"
    return "" if bench.remembers or bench.probe.law.needs_applied else (
        f"the law has no static friction: this is the friction at which creep becomes faster than {FAST * bench.typical_speed:.3g} m/s"
    )  # fmt: skip


def _breakaway(bench: Setup, rate: float) -> float:
    """Largest friction force before the mass slides, under a steadily rising force."""
    stiffness = min(bench.force / (SOFT * bench.length), rate / (20 * FAST * bench.typical_speed))
    pull = PulledMass(mass=bench.mass, stiffness=stiffness, speed=rate / stiffness, friction=bench.law, load=bench.load)
    sliding, duration = FAST * bench.typical_speed, 1.6 * bench.force / rate + math.sqrt(2 * FAST * bench.typical_speed * bench.mass / rate)
    for _ in range(4):
        run = bench.solved(pull, 1e-8, duration=duration)
        t = np.linspace(0.0, duration, 4001)
        there = np.flatnonzero(run.at(t)["v"] > sliding)
        if len(there):
            return _largest(run, t[: there[0] + 1])
        duration *= 2.0
    return math.nan


def _largest(run: Any, t: Array) -> float:
    """Largest friction force on a grid of times, refined around its maximum."""
    R = run.at(t)["friction_force"]
    for _ in range(3):
        k = int(np.argmax(R))
        t = np.linspace(t[max(k - 1, 0)], t[min(k + 1, len(t) - 1)], 41)
        R = run.at(t)["friction_force"]
    return float(R.max())


@shorter
def stick_slip(bench: Setup) -> Experiment:
    """Stick-slip of a mass pulled by a spring."""
    stiffness = bench.stiffness or (0.05 * bench.contact_stiffness if bench.short else 2.0)
    speed = bench.speed or PULL * bench.force / math.sqrt(stiffness * bench.mass)
    pull = PulledMass(mass=bench.mass, stiffness=stiffness, speed=speed, friction=bench.law, load=bench.load)
    reach = max(bench.holds[1], bench.force)
    cycle = pull.time_scale + 2.0 * bench.fall / (stiffness * speed)
    run = bench.solved(pull, _RTOL, duration=reach / (stiffness * speed) + (0.5 if bench.short else 1.0) * CYCLES * cycle)
    period, peak, still = _cycle(run, pull, max(STILL, 2 * stiffness / bench.contact_stiffness if bench.contact_stiffness else STILL))
    sticks = bool(still > 0)
    end, shown = float(run.pieces.t[-1]), 3.2 * (period if math.isfinite(period) else pull.time_scale)
    begin = max(end - shown, 0.0)
    t, v = envelope(run, "v", begin, end, 700, bench.pace)
    return Experiment(
        "stick_slip", "stick-slip, stiff spring" if bench.short and bench.stiffness is None else "stick-slip",
        ("time t", "s"), ("velocity v", "m/s"),
        (ExperimentCurve("mass", t - begin, v), ExperimentCurve("pull", (0.0, end - begin), (speed, speed))),
        (
            Quantity("stick_slip", "stick-slip", sticks, "", "whether the mass stays still for a part of each cycle"),
            Quantity("stick_slip_period", "its period", period if sticks else math.nan, "s",
                     "from one passage of the pull's speed to the next"),
            Quantity("peak_velocity", "peak velocity", peak, "m/s", "in the last cycle"),
            Quantity("stick_share", "share at rest", still, "", f"of a cycle, slower than {STILL:g} of the pull"),
        ),
        {"stiffness": (stiffness, "N/m"), "speed": (speed, "m/s"), "mass": (bench.mass, "kg")},
        "no stick-slip: it ends in steady sliding, or oscillates without coming to rest" if not sticks else "",
    )  # fmt: skip


def _cycle(run: Trajectory, pull: Any, slow: float) -> tuple[float, float, float]:
    """Period [s], peak velocity [m/s] and fraction at rest of the last cycles; NaN and 0 if the mass slides steadily.

    A cycle that only touches v = 0 is also below the threshold for a short time, so rest must last three times as long as that.
    """
    end, u = float(run.pieces.t[-1]), abs(pull.speed)
    t = np.linspace(0.5 * end, end, 24_001)
    v = run.at(t)["v"]
    ups = np.flatnonzero((v[:-1] < u) & (v[1:] >= u))
    if len(ups) < 3 or v.max() < 1.05 * u:
        return math.nan, float(v.max()), 0.0
    starts = [_passage(run, t[k], t[k + 1], u) for k in (ups[0], ups[-2], ups[-1])]
    last = np.linspace(starts[1], starts[2], 8001)
    speeds = run.at(last)["v"]
    share = float(np.mean(abs(speeds) < slow * u))
    touch = math.acos(1.0 - slow) / math.pi
    period = (starts[2] - starts[0]) / (len(ups) - 1)
    return period, _peak(run, last, speeds), share if share > 3.0 * touch else 0.0


def _passage(run: Trajectory, before: float, after: float, u: float) -> float:
    from scipy.optimize import brentq

    return float(brentq(lambda t: float(run.at(t)["v"]) - u, before, after, xtol=1e-12 * after, rtol=1e-14))


def _peak(run: Any, t: Array, v: Array) -> float:
    k = int(np.argmax(v))
    return float(run.at(np.linspace(t[max(k - 1, 0)], t[min(k + 1, len(t) - 1)], 201))["v"].max())
