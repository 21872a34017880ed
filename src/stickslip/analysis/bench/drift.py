"""Drift: displacement of a mass under a force that never reaches break-away."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from stickslip.analysis.bench.envelopes import envelope
from stickslip.analysis.bench.findings import Experiment, ExperimentCurve, Quantity
from stickslip.analysis.bench.setup import Setup, shorter
from stickslip.models.machines import ForcedOscillator

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


#: Constant and oscillating parts of the force, relative to the static friction limit: Dupont's 0.4 N and 0.2 N of 1.5 N.
BIAS, FORCE = 0.4 / 1.5, 0.2 / 1.5
#: Number of periods, of which the second half counts, and their length.
PERIODS, PERIOD = 40, 1.0
_SAMPLES, _SHOWN = 400, 20
_RTOL = 1e-9


@shorter
def drift(bench: Setup) -> Experiment:
    """Drift below break-away."""
    periods, T = (8, 20.0 * 2.0 * math.pi / bench.pace) if bench.short else (PERIODS, PERIOD)
    pushed = not bench.remembers
    push = ForcedOscillator(
        mass=bench.mass, stiffness=0.0, damping=0.0, force=FORCE * bench.force, omega=2.0 * math.pi / T,
        friction=bench.law, load=bench.load, bias=BIAS * bench.force,
    )  # fmt: skip
    start = {"v": 2.0 * bench.typical_speed} if pushed else None
    run = bench.solved(push, _RTOL, periods=periods, samples=_SAMPLES, start=start)
    way = _per_period(run, periods, T)
    t, x = envelope(run, "x", 0.0, periods * T, periods * _SHOWN, bench.pace)
    return Experiment(
        "drift", "drift below break-away", ("time t", "s"), ("displacement x", "m"), (ExperimentCurve("mass", t, x),),
        (Quantity("drift", "drift", way, "m", f"displacement per period of {T:.3g} s, mean of the last {periods // 2}"),),
        {"bias": (push.bias, "N"), "force": (push.force, "N"), "omega": (push.omega, "rad/s"), "mass": (bench.mass, "kg")},
        _remark(bench, pushed),
    )  # fmt: skip


def _per_period(run: Trajectory, periods: int, T: float) -> float:
    """Displacement per period, between the mean position in the middle period and that in the last one."""
    middle = periods // 2 - 1
    inside = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    first, last = (float(np.mean(run.at((k + inside) * T)["x"])) for k in (middle, periods - 1))
    return (last - first) / (periods - 1 - middle)


def _remark(bench: Setup, pushed: bool) -> str:
    if not pushed:
        return ""
    what = "the mass starts with a push, to show whether it comes to rest"
    if bench.set_valued:
        held = bench.holds[1] > 0
        return what + ("; it does, exactly" if held else "; this law has no static friction")
    return f"{what}; it creeps on"
