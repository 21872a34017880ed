"""Servos from command and angle alone: BAM's published parameter sets on its bench, made by tests/bam_bench.py, and fitted as M1 to M6.

    STICKSLIP_DATA=... python verification/servos_from_commands.py [servo_model ...] [--models m1,m3,...]

For each set three logs of 6 s with other loads and trajectories are fitted together, each model beginning at what a simpler one has
found; a fourth log, of another load, is held out. Each line has the processor time of all fits, the models by AICc, the errors of the
numbers of the true model in standard errors, what is not determined, and the error of the held-out angle beside that of the true ones.

All 37 sets have been run, the last 22 of them, from mx64 on, since places are those of the model (mx64_m1 and feetech
before that). The right model came first for 33; for xl330_m6 and xl320_m6 M5 fits as well (AICc lower by 1.6 and 1.9; below 4 the verdict
is that these data cannot distinguish them), erob80_50_m2 has no Stribeck friction, so that it is M1, and of erob80_50_m4 that is 9e-6 N
m, so that it is M3. AICc is that of the next model, or of the right one where another is first; errors are the largest in standard
errors; held out is the error of the held-out angle over that of the truth; processor time is that of all six fits. Of the last 21 sets no
record of a right model has structure left (before, 4 of the first 9 models had), and all 52 fits of models that lack a part (AICc higher
by more than 20) do have it.

    set          first  AICc of another  largest error  held out  time [s]  not determined
    mx106_m1        m1              0.9          0.07     0.999        72  k_t, R, viscous
    mx106_m2        m2              4.0          0.91     1.000        29  k_t, R, viscous
    mx106_m3        m3              3.1          0.32     0.999        35
    mx106_m4        m4              2.6          0.58     1.003        65
    mx106_m5        m5              2.2          1.08     1.004        44
    mx106_m6        m6             11.0          1.58     1.010        38
    xl330_m1        m1              2.0          0.74     1.001        70  k_t, R, viscous
    xl330_m2        m2              3.4          0.43     1.001        73  k_t, R, viscous
    xl330_m3        m3              5.6          0.76     1.006        32
    xl330_m4        m4              3.1          1.66     1.011        40
    xl330_m5        m5              0.0          0.87     1.005        41
    xl330_m6        m5              1.6          1.48     1.003        42
    erob80_50_m1    m1              2.0          1.27     1.000        40  k_t, R, viscous
    erob80_50_m2    m1              3.0          1.36     1.000        48  k_t, R, viscous, v_s, exponent
    erob80_50_m3    m3              7.6          0.75     1.000        32
    mx64_m1         m1              1.2          0.79     0.999        41  k_t, R, viscous
    mx64_m2         m2              4.0          2.30     1.001        34  k_t, R, viscous
    mx64_m3         m3              5.3          1.25     0.999        59
    mx64_m4         m4              1.7          0.72     1.003        66
    mx64_m5         m5              1.0          1.30     1.003        51
    mx64_m6         m6             10.5          1.58     1.010        57
    xl320_m1        m1              1.8          0.71     1.003        80  k_t, R, viscous
    xl320_m2        m2              4.0          0.30     0.999        37  k_t, R, viscous
    xl320_m3        m3              5.3          1.64     1.000        64
    xl320_m4        m4              4.0          0.70     1.001        58
    xl320_m5        m5              3.7          0.36     0.995        86  k_t, R, viscous
    xl320_m6        m5              1.9          0.56     1.006        80  k_t, R, viscous
    erob80_50_m4    m3              6.2          0.76     1.000        56  v_s, exponent
    erob80_50_m5    m5              4.0          1.43     1.001        30
    erob80_100_m1   m1              2.0          1.73     1.003        40
    erob80_100_m2   m2              4.0          0.85     1.002        22
    erob80_100_m3   m3              6.5          1.31     1.001        42
    erob80_100_m4   m4              1.9          0.68     1.002        44
    erob80_100_m5   m5             13.0          1.41     0.999        43
    erob80_100_m6   m6           1017.8          1.40     1.007        32
    erob80_50_m6    m6             83.2          1.53     1.001        37
    feetech_m1      m1              1.8          0.64     1.000        84  k_t, R, viscous
"""

from __future__ import annotations

import json
import math
import os
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
import stickslip as ss
from bam_bench import chirp, pendulum, shown, sines, swung, up_and_down
from stickslip.inverse.identification.uncertainty import faults

STEP = 0.005
SMALL = ((0.1, 0.1, 0.02), (0.05, 0.12, 0.02), (0.15, 0.08, 0.02), (0.08, 0.11, 0.02))
#: Of each servo: gain [V/rad or A/rad] and limit [V or A] of its controller, and loads (mass, length, arm) that it can swing; of eRob80,
#: whose firmware we do not know, a controller of ours. Six of its sets have no resistance: they are driven by a current.
BENCHES = {
    "mx106": (16 * 0.158 * 15, 15 * 0.9625, ((1.0, 0.15, 0.1), (0.5, 0.2, 0.1), (1.5, 0.1, 0.1), (0.8, 0.18, 0.1))),
    "mx64": (16 * 0.158 * 15, 15 * 0.9625, ((0.6, 0.15, 0.1), (0.3, 0.2, 0.1), (1.0, 0.1, 0.1), (0.5, 0.18, 0.1))),
    "xl320": (32 * 0.05048199 * 7.5, 7.5, SMALL),
    "xl330": (400 * 4096 / (2 * math.pi * 256 * 885) * 7.5, 7.5, SMALL),
    "erob80_100": (100.0, 10.0, ((5.0, 0.5, 1.0), (3.0, 0.6, 1.0), (8.0, 0.4, 1.0), (4.0, 0.55, 1.0))),
    "erob80_50": (400.0, 48.0, ((5.0, 0.5, 1.0), (3.0, 0.6, 1.0), (8.0, 0.4, 1.0), (4.0, 0.55, 1.0))),
    "feetech": (32 * 0.166 * 7.4, 7.4 * 0.97, ((0.3, 0.12, 0.05), (0.15, 0.15, 0.05), (0.5, 0.1, 0.05), (0.25, 0.13, 0.05))),
}  # fmt: skip
LOADS = ("motor", "external", "motor_stribeck", "external_stribeck")
#: What each model adds to one that it contains, by name, with bounds.
TORQUES = {"base": (0.0, 0.5), "viscous": (0.0, 0.5), "stribeck": (0.0, 0.5), "v_s": (0.2, 6.0), "exponent": (0.5, 10.0)}
FREE = {
    "m1": ("base", "viscous"), "m2": ("base", "viscous", "stribeck", "v_s", "exponent"), "m3": ("base", "viscous", "motor"),
    "m4": ("base", "viscous", "stribeck", "v_s", "exponent", "motor", "motor_stribeck"),
    "m5": ("base", "viscous", "stribeck", "v_s", "exponent", *LOADS),
    "m6": ("base", "viscous", "stribeck", "v_s", "exponent", *LOADS, "motor_quad", "external_quad"),
}  # fmt: skip
INSIDE = {"m1": None, "m2": "m1", "m3": "m1", "m4": "m3", "m5": "m4", "m6": "m5"}
TIED = {"m3": {"load.external": "load.motor"}, "m4": {"load.external": "load.motor", "load.external_stribeck": "load.motor_stribeck"}}


def logs_of(p: dict[str, Any], servo: str, seed: int) -> tuple[list[Any], list[tuple[float, float]], Any]:
    """Records of three logs and of the one that is held out, inertia and gravity of each, and the last angles without an encoder."""
    kp, supply, loads = BENCHES[servo]
    t, records, arms = np.arange(0, 6, STEP), [], [pendulum(*load) for load in loads]
    for k, (arm, command) in enumerate(zip(arms, (chirp, sines, up_and_down, sines), strict=True)):
        true = swung(p, *arm, kp, supply, command(t), STEP, 8)
        records.append(ss.Record.of(t, {"command [rad]": command(t), "angle [rad]": shown(true, 10 * seed + k)}))
    return records, arms, true


def servo_of(p: dict[str, Any], servo: str) -> Any:
    """The joint with the true numbers."""
    kp, supply, _ = BENCHES[servo]
    by_voltage = "R" in p
    motor = ss.machines.Motor(k_t=p["kt"], **({"resistance": p["R"], "supply": supply} if by_voltage else {}))
    control = ss.machines.PID(kp=kp, ki=0.0, kd=0.0, target=0.0)
    load = ss.machines.ServoLoad.from_bam(p)
    limit = {} if by_voltage else {"limit": supply}
    return ss.Joint(0.01, ss.Coulomb(1.0, 1.0), motor_inertia=p["armature"], motor=motor, control=control, load=load, **limit)


def fitted(model: str, guess: Any, records: Any, arms: Any, true: Any) -> Any:
    """The fit of one model."""
    free: dict[str, Any] = {
        "motor_inertia": (0.1 * true.motor_inertia, 5 * true.motor_inertia), "motor.k_t": (0.3 * true.motor.k_t, 3 * true.motor.k_t),
    }  # fmt: skip
    if true.motor.resistance:
        free["motor.resistance"] = (0.3 * true.motor.resistance, 3 * true.motor.resistance)
    large = _size(true)  # bounds of torques grow with the servo
    free |= {f"load.{name}": _bounds(name, large) for name in FREE[model]}
    lists = {"inertia": [J for J, _ in arms], "gravity_torque": [G for _, G in arms]}
    return ss.identify(records, guess, free=free, tied=TIED.get(model), starts=1, **lists)


def _size(servo: Any) -> float:
    """How large the torques of friction are, beside those of a small servo."""
    return float(max(1.0, (servo.load.base + servo.load.stribeck) / 0.25, servo.load.viscous / 0.25))


def _bounds(name: str, large: float) -> tuple[float, float]:
    low, high = TORQUES.get(name, (0.0, 0.6))
    return low, high * large if name in ("base", "viscous", "stribeck") else high


def begun(model: str, inside: Any) -> Any:
    """Where the search of a model begins: the numbers of a simpler one, and small ones in place of zeros."""
    size = _size(inside)
    small = {"base": 0.02 * size, "viscous": 0.02 * size, "stribeck": 0.02 * size, "v_s": 1.5, "exponent": 1.2} | dict.fromkeys(LOADS, 0.05)
    own = {name: getattr(inside.load, name) for name in (*FREE[model], *(name[5:] for name in TIED.get(model, {})))}
    fresh = model in ("m2", "m4") and not inside.load.stribeck
    replaced = {name: small.get(name, 0.01) for name, value in own.items() if value <= 1e-4 or (fresh and name in ("v_s", "exponent"))}
    return inside.replace({f"load.{name}": value for name, value in replaced.items()})


def judged(name: str, models: list[str], seed: int = 1) -> dict[str, Any]:
    """One parameter set."""
    p = json.loads((Path(os.environ["STICKSLIP_DATA"]) / "bam" / f"{name}.json").read_text())
    servo, truth = next(each for each in BENCHES if name.startswith(each)), name.rpartition("_")[2]
    records, arms, angle = logs_of(p, servo, seed)
    true, fits, began = servo_of(p, servo), {}, time.process_time()
    bare = ss.machines.ServoLoad(base=0.5 * sum(p.get(n, 0.0) for n in ("friction_base", "friction_stribeck")), viscous=0.02)
    begin = {"motor.k_t": 0.95 * p["kt"], "motor_inertia": 0.8 * p["armature"]}
    bare = true.replace(begin | ({"motor.resistance": 1.1 * p["R"]} if "R" in p else {})).replace(load=bare)
    for model in models:
        inside = INSIDE[model]
        guess = bare if inside not in fits else begun(model, fits[inside].model(0))
        fits[model] = fitted(model, guess, records[:3], arms[:3], true)
    took = time.process_time() - began
    ranking = ss.identification.rank(fits) if len(fits) > 1 else None
    best = fits[ranking.best.label if ranking else models[0]]
    known = {"kt": "motor.k_t", "R": "motor.resistance", "armature": "motor_inertia"}
    own = fits.get(truth, best)
    off = {
        new: (own.values[new] - p[old]) / own.errors[new] for old, new in known.items() if new in own.names and new not in own.undetermined
    }
    load = ss.machines.ServoLoad.from_bam(p)
    off |= {n: (own.values[n] - getattr(load, n[5:])) / own.errors[n] for n in own.names if n[:5] == "load." and n not in own.undetermined}
    kp, supply, _ = BENCHES[servo]
    t = np.arange(0, 6, STEP)
    numbers = best.model(0)
    again = {"kt": numbers.motor.k_t, "armature": numbers.motor_inertia} | numbers.load.to_bam()
    again |= {"R": numbers.motor.resistance} if "R" in p else {}
    measured, predicted = records[3]["angle"].si, swung(again, *arms[3], kp, supply, sines(t), STEP, 8)
    held = [float(np.mean(abs(measured - each))) for each in (predicted, angle)]
    return {
        "set": name, "cpu": round(took, 1), "AICc": {r.label: round(r.aicc, 1) for r in ranking.rows} if ranking else None,
        "off": {n: round(float(v), 2) for n, v in off.items()}, "undetermined": own.undetermined,
        "combinations": [f"{f} = {v:.4g} ± {e:.2g}" for f, v, e in own.combinations], "held_out": held, "ratio": held[0] / held[1],
        "faults": {m: faults(f) for m, f in fits.items()}, "verdict": ranking.verdict if ranking else None,
        "rms": {m: float(np.sqrt(np.mean(f.residuals**2)) * np.mean(f.problem.sigma)) for m, f in fits.items()},
    }  # fmt: skip


if __name__ == "__main__":
    asked = [word for word in sys.argv[1:] if not word.startswith("--")]
    chosen = next((word.partition("=")[2].split(",") for word in sys.argv[1:] if word.startswith("--models=")), list(FREE))
    every = sorted(path.stem for path in (Path(os.environ["STICKSLIP_DATA"]) / "bam").glob("*.json"))
    for name in asked or every:
        print(json.dumps(judged(name, chosen)), flush=True)
