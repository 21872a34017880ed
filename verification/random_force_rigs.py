"""Force rigs with a late, scaled and offset load cell: are friction, gain and delay right, whatever the position sensor does?

Run: python verification/random_force_rigs.py [count] [first seed] [file]. The file (random_force_rigs.jsonl) has one line of JSON for each
seed and is read again: what stands there is not done twice. The truth is made by forty steps of the law between two samples, of which one
ends at the instant that the late load cell shows; nothing of it is interpolated. Positions are exact, written with the digits of a file,
with a tiny noise, or with noise of 0.3 to 10 counts of an encoder; delays are 0, 1 and 5 ms; rates 200 to 5000 Hz; every other motion
turns exactly at a sample.
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
from stickslip.inverse.identification.law_forces import Stepped, law_force
from stickslip.models.friction.law_adapter import adapted

FINE, STARTS, LOAD = 40, 16, 40.0
GAIN = 0.02  # what a fit expects of a gain where nothing is said
POSITIONS, DELAYS, RATES = ("exact", "digits", "tiny", "counts"), (0.0, 1e-3, 5e-3), (200.0, 500.0, 1000.0, 2000.0, 5000.0)
BOTH = {"mu_minus": "mu_plus", "f_minus": "f_plus"}


def stroke(random: np.random.Generator, even: bool) -> tuple[Any, Any, Any]:
    """Times of the samples, and position and velocity over time: strokes of a few millimetres with a third harmonic."""
    rate = float(random.choice(RATES))
    a, f = float(random.uniform(1e-3, 5e-3)), float(random.uniform(0.2, 0.5))
    f, b, p = (rate / (4 * round(rate / (4 * f))), 0.0, 0.0) if even else (f, float(random.uniform(0.0, 0.15)), float(random.uniform(0, 6)))
    w = 2 * np.pi * f
    t = np.arange(0.0, min(float(random.uniform(5, 9)), 12000 / rate), 1 / rate)
    return (
        t, lambda s: a * (np.sin(w * s + p) + b * np.sin(3 * w * s)), lambda s: a * w * (np.cos(w * s + p) + 3 * b * np.cos(3 * w * s)),
    )  # fmt: skip


def law_over(law: Any, x: Any, v: Any, t: Any) -> Any:
    """Friction forces at some instants, from a motion given as functions of time."""
    h = float(t[1] - t[0])
    early = round(1.0 / h)  # samples of the second before the record, in which the rig moves already
    count = (len(t) + early) * FINE
    fine = t[0] - early * h + (np.arange(count) - FINE + 1) * h / FINE
    way = np.diff(x(fine), prepend=x(fine[0] - h / FINE)) * FINE / h
    load = np.full((len(fine), 1), LOAD)
    return law_force(adapted(law), Stepped(fine, way, v(fine)), load, np.zeros((len(fine), 1)), 1)[FINE - 1 :: FINE, 0][early:]


def position(random: np.random.Generator, x: Any, kind: str) -> Any:
    """What the sensor makes of a position."""
    if kind == "digits":
        return np.round(x, int(random.integers(6, 10)))
    if kind == "tiny":
        return x + random.normal(0.0, 10 ** float(random.uniform(-10, -8)), len(x))
    if kind == "counts":
        count = float(np.ptp(x)) * 10 ** float(random.uniform(-4.5, -3.0))
        noisy = x + random.normal(0.0, float(random.choice([0.0, 0.3, 1.0, 3.0, 10.0])) * count, len(x))
        return count * np.round(noisy / count)
    return x


def rig(kind: str, random: np.random.Generator) -> dict[str, Any]:
    """One rig: its fit beside the truth."""
    t, x, v = stroke(random, bool(random.integers(2)))
    late, gain, mu = float(random.choice(DELAYS)), float(random.normal(1.0, GAIN)), float(random.uniform(0.1, 0.3))
    truth = {"mu_plus": mu, "f_plus": mu * float(random.uniform(1.15, 1.6)), "v_s": float(10 ** random.uniform(-3.6, -2.9))}
    free: dict[str, Any] = {"mu_plus": (0.02, 0.6), "f_plus": (0.02, 0.9), "v_s": (1e-4, 1e-2, "log")}
    tied, fixed, made = BOTH, {}, ss.Stribeck(mu, mu, truth["f_plus"], truth["f_plus"], v_s=truth["v_s"])
    law: Any = ss.Stribeck
    if kind == "coulomb":
        law, made, truth, free, tied = ss.Coulomb, ss.Coulomb(mu, mu), {"mu_plus": mu}, {"mu_plus": (0.02, 0.6)}, {"mu_minus": "mu_plus"}
    if kind == "bristles":
        truth |= {"sigma0": float(10 ** random.uniform(5.5, 6.5)), "sigma2": float(random.uniform(0.0, 200.0))}
        free |= {"sigma0": (1e4, 1e8, "log"), "sigma2": (0.0, 1000.0)}
        made, law, fixed = ss.LuGre(mu, mu, truth["f_plus"], truth["f_plus"], sigma1=0.0, v_s=truth["v_s"],
                                    sigma0=truth["sigma0"], sigma2=truth["sigma2"]), ss.LuGre, {"sigma1": 0.0}  # fmt: skip
    force = law_over(made, x, v, t - late)
    level = 0.01 * float(np.std(force))
    shown = gain * force + float(random.normal(0.0, 0.02)) * float(np.std(force)) + random.normal(0.0, level, len(t))
    sensor = str(random.choice(POSITIONS))
    seen = position(random, x(t), sensor)
    rec = ss.Record.of(t, {"x [m]": seen, "F [N]": shown}, roles={"x": "position", "F": "force"}, synthetic=True)
    fit = ss.identify(rec, law, free=free, tied=tied, load=LOAD, starts=STARTS, **fixed)
    found = truth_and_intervals(fit, truth)
    for name, value in {"delay": late, "gain": gain}.items():
        got, error = fit.sensor[name]
        off = (got - value) / error if 0 < error < np.inf else 0.0
        found["numbers"][name] = [abs(off) < 1.96, off, abs(got - value), error if error < np.inf else None]
    return found | {"how": f"{sensor}, {late:g} s, {1 / (t[1] - t[0]):.0f} Hz", "made": [len(t), *truth.values()]}


CLASSES = {kind: lambda random, kind=kind: rig(kind, random) for kind in ("coulomb", "stribeck", "bristles")}

if __name__ == "__main__":
    run(CLASSES, sys.argv[1:], Path("random_force_rigs.jsonl"))
