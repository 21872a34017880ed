"""Velocity records with harmonics of the drive, a clock that is off, jitter, hum or clipping: do intervals hold, or is it said?

Run: python verification/random_ripple.py [count] [first seed] [file]. The file (random_ripple.jsonl) has one line of JSON for each seed
and is read again: what stands there is not done twice. A seed's class is its remainder by the number of classes. The records of a shaken
robot have one thing wrong, named by the class; those of chains, capsules and joints one at random.
Capsules whose motion does not repeat, or takes too long to settle, are drawn again: their records are of no steady motion.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np
from known_coverage import run, truth_and_intervals

import stickslip as ss
from stickslip.inverse.identification.steady_curves import periods_to_settle, steady_curve
from stickslip.models.drives.rippled import with_ripple

Random = np.random.Generator
NOISE, HUM = 0.08, 1.53  # noise in standard deviations of the velocity; frequency of the mains in that of the drive (50 Hz at 32.7 Hz)
SETTLE, PERIODS, SAMPLES = 600, 20, 100  # drive periods before a record, and in it; samples in each
STARTS = 32  # of 64 that a fit has where nothing is typed; from 8 two of seven capsules ended at another minimum
SETTLED = 4  # times that a tenth of a start must be left before a record begins

#: What may be wrong with a record: its size, drawn.
WRONG: dict[str, Callable[[Random], dict[str, float]]] = {
    "nothing": lambda random: {},
    "harmonics": lambda random: {"harmonics": float(random.uniform(0.0, 0.03))},
    "frequency": lambda random: {"frequency": 1.0 + 1e-3 * float(random.choice([-1, 1]))},
    "jitter": lambda random: {"jitter": float(random.uniform(0.0, 0.5))},
    "hum": lambda random: {"hum": float(random.uniform(0.0, 3.0))},
    "clipped": lambda random: {"clip": float(random.uniform(0.7, 0.95))},
}


def measured(random: Random, machine: Any, body: int | None, unit: str, wrong: dict[str, float]) -> ss.Record:
    """The velocity of a machine, or of a body of it, in steady motion, with noise and what is wrong."""
    size = wrong.get("harmonics", 0.0)
    ripple = (size * float(random.choice([-1, 1])), 0.5 * size * float(random.normal()))
    machine = with_ripple(machine, ripple, (0.0, 0.0)) if size else machine
    done = ss.solve(machine, periods=SETTLE + PERIODS + 2, keep="trajectory")
    T = done.period_time
    t = np.arange(PERIODS * SAMPLES) / SAMPLES * T
    late = t + random.normal(0.0, wrong.get("jitter", 0.0), len(t)) * T / SAMPLES
    v = done.at((SETTLE + float(random.uniform())) * T + np.maximum(late, 0.0))["v"]
    v = v if body is None else v[:, body]
    level = NOISE * float(np.std(v))
    v = (
        v
        + wrong.get("hum", 0.0) * level * np.sin(2 * np.pi * HUM * t / T + float(random.uniform(0, 6)))
        + random.normal(0.0, level, len(t))
    )
    top = wrong.get("clip", 1.0) * float(np.max(abs(v)))
    return ss.Record.of(t, {f"velocity [{unit}]": np.clip(v, -top, top)}, synthetic=True)


def fitted(
    random: Random, make: Any, truth: dict[str, float], free: dict[str, Any], wrong: str, known: dict[str, Any], unit: str = "m/s",
    body: tuple[int, str] | None = None,
) -> dict[str, Any]:  # fmt: skip
    """A record of the machine that a maker makes, and its fit."""
    machine, off = make(**known, **truth), WRONG[wrong](random)
    rec = measured(random, machine, body[0] if body else None, unit, off)
    told: dict[str, Any] = {"frequency": off["frequency"] / machine.period} if "frequency" in off else {}
    told |= {"body": body[1]} if body else {}
    return truth_and_intervals(ss.identify(rec, make, free=free, starts=STARTS, **known, **told), truth) | {"wrong": wrong}


def rig(random: Random, wrong: str) -> dict[str, Any]:
    """A shaken robot under Coulomb friction."""
    known = {"tilt_deg": float(random.uniform(1.5, 3.0)), "amplitude": float(random.uniform(4e-4, 8e-4)), "law": "coulomb"}
    truth = {"mu0": float(random.uniform(0.12, 0.2))}
    return fitted(random, ss.presets.piezo_rig, truth, {"mu0": (0.05, 0.4)}, wrong, known)


def chain(random: Random, wrong: str) -> dict[str, Any]:
    """Two modules joined by a spring, of which one was measured."""
    known = {"phase": float(random.uniform(0.3, 3.0)), "stiffness": float(random.uniform(600.0, 2000.0))}
    truth = {"mu_plus": float(random.uniform(0.1, 0.2)), "mu_minus": float(random.uniform(0.1, 0.2))}
    free = {"mu_plus": (0.03, 0.4), "mu_minus": (0.03, 0.4)}
    body = int(random.integers(2))
    return fitted(random, ss.presets.two_modules, truth, free, wrong, known, body=(body, f"module {body + 1}"))


def capsule(random: Random, wrong: str) -> dict[str, Any]:
    """A vibro-impact capsule: force over friction, and damping."""
    while True:
        known = {"omega": float(random.uniform(0.9, 1.1)), "gap": float(random.uniform(0.02, 0.1))}
        truth = {"force_ratio": float(random.uniform(0.8, 1.6)), "damping_ratio": float(random.uniform(0.03, 0.1))}
        curve = steady_curve(ss.presets.capsule(**known, **truth))
        if curve.settled and SETTLED * periods_to_settle(curve) < SETTLE:
            break
    return fitted(random, ss.presets.capsule, truth, {"force_ratio": (0.4, 3.0), "damping_ratio": (0.0, 0.3)}, wrong, known)


def swung(mu: float, viscous: float, gravity_torque: float, amplitude: float, frequency: float) -> ss.Joint:
    """A joint under a periodic torque."""
    law = ss.CoulombViscous(mu, mu, viscous=viscous)
    return ss.Joint(0.012, law, torque=ss.HarmonicForce(amplitude=amplitude, frequency=frequency), gravity_torque=gravity_torque)


def joint(random: Random, wrong: str) -> dict[str, Any]:
    """A joint under a periodic torque, without a log of it."""
    known = {"amplitude": float(random.uniform(0.3, 0.5)), "frequency": float(random.uniform(1.5, 2.5))}
    truth = {"mu": float(random.uniform(0.03, 0.08)), "viscous": float(random.uniform(0.005, 0.02)),
             "gravity_torque": float(random.uniform(0.1, 0.3))}  # fmt: skip
    free = {"mu": (0.005, 0.2), "viscous": (0.0, 0.05), "gravity_torque": (0.02, 0.6)}
    return fitted(random, _joint_of(known["frequency"]), truth, free, wrong, {"amplitude": known["amplitude"]}, unit="rad/s")


def _joint_of(rate: float) -> Callable[..., ss.Joint]:
    """The same with the frequency of its torque known (`identify` has an argument of that name)."""

    def make(mu: float, viscous: float, gravity_torque: float, amplitude: float) -> ss.Joint:
        return swung(mu, viscous, gravity_torque, amplitude, rate)

    return make


def _of_any(machine: Callable[[Random, str], dict[str, Any]], kinds: tuple[str, ...]) -> Callable[[Random], dict[str, Any]]:
    """A record of a machine with one thing wrong, or nothing."""
    return lambda random: machine(random, str(random.choice(kinds)))


def _of(machine: Callable[[Random, str], dict[str, Any]], wrong: str) -> Callable[[Random], dict[str, Any]]:
    return lambda random: machine(random, wrong)


WITHOUT_DRIVE = tuple(wrong for wrong in WRONG if wrong != "harmonics")  # of a drive; a force has others
CLASSES = {
    **{f"rig, {wrong} wrong": _of(rig, wrong) for wrong in WRONG},
    "chain": _of_any(chain, tuple(WRONG)),
    "capsule": _of_any(capsule, WITHOUT_DRIVE),
    "joint": _of_any(joint, WITHOUT_DRIVE),
}

if __name__ == "__main__":
    run(CLASSES, sys.argv[1:], Path("random_ripple.jsonl"))
