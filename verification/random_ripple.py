"""Velocity records with harmonics of the drive, a clock that is off, jitter, hum or clipping: do intervals hold, or is it said?

Run: python verification/random_ripple.py [count] [first seed] [file]. The file (random_ripple.jsonl) has one line of JSON for each seed
and is read again: what stands there is not done twice. A seed's class is its remainder by the number of classes.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np
from known_coverage import run, truth_and_intervals

import stickslip as ss

Random = np.random.Generator
NOISE, HUM = 1e-3, 50.0  # m/s, Hz


def rig(random: Random, harmonics: float = 0.0, frequency: float = 1.0, jitter: float = 0.0, hum: float = 0.0, clip: float = 1.0) -> Any:
    """A record of a rig with one thing wrong, and its fit."""
    known = {"tilt_deg": float(random.uniform(1.5, 3.0)), "amplitude": float(random.uniform(4e-4, 8e-4)), "law": "coulomb"}
    mu = float(random.uniform(0.12, 0.2))
    robot = ss.presets.piezo_rig(mu0=mu, **known)
    ripple = (harmonics * float(random.choice([-1, 1])), 0.5 * harmonics * float(random.normal()))
    clean = ss.virtual_rig(robot, periods=20, phase=float(random.uniform()), harmonics=ripple)["velocity"]
    late = clean.t + random.normal(0.0, jitter, len(clean.t)) * float(clean.t[1])
    v = np.interp(late, clean.t, clean.values) + hum * NOISE * np.sin(2 * np.pi * HUM * clean.t + float(random.uniform(0, 6)))
    v = v + random.normal(0.0, NOISE, len(v))
    top = clip * float(np.max(abs(v)))
    rec = ss.Record.of(clean.t, {"velocity [m/s]": np.clip(v, -top, top)}, synthetic=True)
    typed = {} if frequency == 1.0 else {"frequency": frequency * robot.drive.omega / (2 * np.pi)}
    fit = ss.identify(rec, ss.presets.piezo_rig, free={"mu0": (0.05, 0.4)}, starts=8, **known, **typed)
    return truth_and_intervals(fit, {"mu0": mu})


CLASSES = {
    "clean": rig,
    "harmonics to 3 %": lambda random: rig(random, harmonics=float(random.uniform(0.0, 0.03))),
    "frequency 0.1 % off": lambda random: rig(random, frequency=1.0 + 1e-3 * float(random.choice([-1, 1]))),
    "jitter": lambda random: rig(random, jitter=float(random.uniform(0.0, 0.5))),
    "hum": lambda random: rig(random, hum=float(random.uniform(0.0, 3.0))),
    "clipped": lambda random: rig(random, clip=float(random.uniform(0.7, 0.95))),
}

if __name__ == "__main__":
    run(CLASSES, sys.argv[1:], Path("random_ripple.jsonl"))
