"""Force loops and joints whose position is noisy or rounded and whose force is late and scaled: do intervals hold the truth?

Run: python verification/random_input_noise.py [count] [first seed] [file]. The file (random_input_noise.jsonl) has one line of JSON for
each seed and is read again: what stands there is not done twice. A seed's class is its remainder by the number of classes. The truth is
made by forty steps of the law between two samples, and a late force is that of the instants that it shows: nothing of it is
interpolated. The position that is written down has noise of 0 to 10 counts of its encoder. The
medians of standard errors and of errors say whether the intervals are narrow enough to be of use.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np
from known_coverage import run, truth_and_intervals
from random_force_rigs import GAIN, LOAD, STARTS, law_over

import stickslip as ss

Random = np.random.Generator


def stroke(random: Random) -> tuple[Any, Any, Any]:
    """Times of the samples, and position and velocity over time: strokes of a few millimetres with a third harmonic."""
    a, f, b = float(random.uniform(1e-3, 5e-3)), float(random.uniform(0.2, 0.5)), float(random.uniform(0.0, 0.15))
    w, p = 2 * np.pi * f, float(random.uniform(0, 6))
    t = np.arange(0.0, float(random.uniform(5, 9)), float(random.choice([1e-3, 2e-3])))
    return (
        t, lambda s: a * (np.sin(w * s + p) + b * np.sin(3 * w * s)), lambda s: a * w * (np.cos(w * s + p) + 3 * b * np.cos(3 * w * s)),
    )  # fmt: skip


def read_by_sensors(
    random: Random, t: Any, x: Any, force: Any, level: float, names: tuple[str, str], roles: dict[str, str], longest: float = 0.02
) -> ss.Record:
    """A position with noise of 0 to 10 counts, rounded to them or not, and a late, scaled, offset force, of which noise is a part."""
    count = float(np.ptp(x(t))) * 10 ** float(random.uniform(-5.0, -2.5))
    size = float(random.choice([0.0, 0.3, 1.0, 3.0, 10.0])) * count
    seen = x(t) + random.normal(0.0, 1.0, len(t)) * size
    seen = count * np.round(seen / count) if size < 3 * count else seen
    late = float(random.choice([random.uniform(0.0, 2.0) * (t[1] - t[0]), random.uniform(0.0, longest)]))
    y = force(t - late)
    size = float(np.std(y))
    shown = y * float(random.normal(1.0, GAIN)) + float(random.normal(0.0, 0.02)) * size + random.normal(0.0, level * size, len(t))
    return ss.Record.of(t, {names[0]: seen, names[1]: shown}, roles=roles, synthetic=True)


def stribeck(random: Random) -> dict[str, Any]:
    """Sliding with a Stribeck dip, without bristles."""
    t, x, v = stroke(random)
    mu = float(random.uniform(0.1, 0.3))
    truth = {"mu_plus": mu, "f_plus": mu * float(random.uniform(1.15, 1.6)), "v_s": float(10 ** random.uniform(-3.6, -2.9))}
    both = {"mu_minus": "mu_plus", "f_minus": "f_plus"}
    law = ss.Stribeck(truth["mu_plus"], truth["mu_plus"], truth["f_plus"], truth["f_plus"], v_s=truth["v_s"])
    names, roles = ("x [m]", "F [N]"), {"x": "position", "F": "force"}
    rec = read_by_sensors(random, t, x, lambda at: law_over(law, x, v, at), 0.01, names, roles)
    free = {"mu_plus": (0.02, 0.6), "f_plus": (0.02, 0.9), "v_s": (1e-4, 1e-2, "log")}
    return truth_and_intervals(ss.identify(rec, ss.Stribeck, free=free, tied=both, load=LOAD, starts=STARTS), truth)


def bristles(random: Random) -> dict[str, Any]:
    """LuGre with all its numbers."""
    t, x, v = stroke(random)
    mu = float(random.uniform(0.15, 0.3))
    truth = {"mu_plus": mu, "f_plus": mu * float(random.uniform(1.15, 1.5)), "v_s": float(10 ** random.uniform(-3.5, -2.7)),
             "sigma0": float(10 ** random.uniform(5.0, 6.3)), "sigma2": float(random.uniform(0.0, 200.0))}  # fmt: skip
    law = ss.LuGre(mu, mu, truth["f_plus"], truth["f_plus"], sigma0=truth["sigma0"], sigma1=0.0, sigma2=truth["sigma2"], v_s=truth["v_s"])
    names, roles = ("x [m]", "F [N]"), {"x": "position", "F": "force"}
    rec = read_by_sensors(random, t, x, lambda at: law_over(law, x, v, at), 0.005, names, roles)
    free = {"mu_plus": (0.02, 0.6), "f_plus": (0.02, 0.9), "v_s": (1e-4, 1e-2, "log"), "sigma0": (1e4, 1e8, "log"), "sigma2": (0.0, 1000.0)}
    both = {"mu_minus": "mu_plus", "f_minus": "f_plus"}
    return truth_and_intervals(ss.identify(rec, ss.LuGre, free=free, tied=both, load=LOAD, starts=STARTS, sigma1=0.0), truth)


def joint(random: Random) -> dict[str, Any]:
    """A joint with inertia, gravity, Coulomb and viscous friction from torque and the counts of an encoder."""
    t = np.arange(0.0, float(random.uniform(8, 14)), float(random.choice([0.002, 0.005, 0.01])))
    parts = [(float(random.uniform(0.6, 1.3)), float(random.uniform(1.2, 2.5)), float(random.uniform(0, 6))),
             (float(random.uniform(0.1, 0.4)), float(random.uniform(4.0, 7.0)), float(random.uniform(0, 6)))]  # fmt: skip
    x = lambda s: sum(a * np.sin(w * s + p) for a, w, p in parts)  # noqa: E731
    truth = {"inertia": float(random.uniform(0.005, 0.03)), "gravity_torque": float(random.uniform(0.1, 0.5)),
             "friction.mu_plus": float(random.uniform(0.02, 0.1)), "friction.viscous": float(random.uniform(0.005, 0.05))}  # fmt: skip

    def torque(s: Any) -> Any:
        v = sum(a * w * np.cos(w * s + p) for a, w, p in parts)
        acceleration = -sum(a * w * w * np.sin(w * s + p) for a, w, p in parts)
        rubs = truth["friction.mu_plus"] * np.sign(v) + truth["friction.viscous"] * v
        return truth["inertia"] * acceleration + truth["gravity_torque"] * np.sin(x(s)) + rubs

    rec = read_by_sensors(random, t, x, torque, 0.01, ("angle [rad]", "drive [N m]"), {"drive": "force"})
    start = ss.Joint(inertia=0.02, friction=ss.CoulombViscous(0.05, 0.05, viscous=0.02), torque=0.0, gravity_torque=0.2)
    free = {"inertia": (1e-3, 0.1), "gravity_torque": (0.01, 1.0), "friction.mu_plus": (0.0, 0.3), "friction.viscous": (0.0, 0.2)}
    return truth_and_intervals(ss.identify(rec, start, free=free, tied={"friction.mu_minus": "friction.mu_plus"}, starts=STARTS), truth)


CLASSES = {"Stribeck loops": stribeck, "bristle loops": bristles, "joints": joint}

if __name__ == "__main__":
    run(CLASSES, sys.argv[1:], Path("random_input_noise.jsonl"))
