"""Random joints: the compiled solvers beside the judge. Run: python verification/random_joints.py [count] [first seed]"""

from __future__ import annotations

import sys
from collections import Counter
from typing import Any

import numpy as np

import stickslip as ss

CLOSE = 1e-6  # of the largest size of a state: dop853 at 1e-10, through some ten events
LENGTH = 2.0  # [s]


def law(random: np.random.Generator) -> Any:
    """Friction of some hundredths of a newton metre."""
    kinetic, more = float(random.uniform(0.01, 0.05)), float(random.uniform(1.0, 2.0))
    kind = random.integers(5)
    if kind == 0:
        return ss.Coulomb(kinetic, kinetic)
    if kind == 1:
        return ss.Coulomb(kinetic, kinetic * float(random.uniform(0.5, 1.5)), f_plus=kinetic * more, f_minus=2 * kinetic * more)
    if kind == 2:
        return ss.Stribeck(kinetic, kinetic, f_plus=more * kinetic, f_minus=more * kinetic, v_s=float(random.uniform(0.05, 0.5)))
    if kind == 3:
        return ss.CoulombViscous(kinetic, kinetic, viscous=float(random.uniform(1e-3, 0.02)))
    return ss.LuGre(kinetic, kinetic, more * kinetic, more * kinetic, sigma0=50.0, sigma1=0.3, sigma2=1e-3, v_s=0.2)


def target(random: np.random.Generator) -> Any:
    """A number, or a motion of one second."""
    kind = random.integers(4)
    if kind == 0:
        return float(random.uniform(-1.0, 1.0))
    if kind == 1:
        return ss.Harmonic(amplitude=float(random.uniform(0.1, 0.5)), frequency=1.0)
    if kind == 2:
        return ss.Trapezoid.example().replace(period=1.0)
    t = np.linspace(0.0, 1.0, 41)
    return (t, 0.3 * np.sin(2 * np.pi * t) + 0.1 * np.cos(4 * np.pi * t))


def joint(seed: int) -> ss.Joint:
    """A joint, whose gear is elastic with play now and then, and whose controller samples as often as not."""
    random = np.random.default_rng(seed)
    gains = {"kp": float(random.uniform(0.5, 3.0)), "ki": float(random.choice([0.0, 2.0])), "kd": float(random.uniform(0.02, 0.2))}
    sample = [None, 0.05, 0.02, 1 / 3][random.integers(4)]
    if sample == 1 / 3:
        gains = {name: 0.05 * gain for name, gain in gains.items()}
    side = ["joint", "motor"][random.integers(2)]
    control = ss.PID(**gains, target=target(random), sample=sample, feedforward=float(random.choice([0.0, 0.02])), feedback=side)
    gear = {"motor_inertia": 0.01, "backlash": 0.02, "gear_stiffness": 30.0, "gear_damping": 0.05} if random.integers(4) == 0 else {}
    torque = [None, 0.01, (np.linspace(0.0, 0.5, 21), 0.03 * np.sin(4 * np.pi * np.linspace(0.0, 0.5, 21)))][random.integers(3)]
    more = {"load_gain": 2.0} if random.integers(4) == 0 else {}
    return ss.Joint(
        inertia=float(random.uniform(0.005, 0.02)), friction=law(random), control=control, torque=torque,
        gravity_torque=float(random.choice([0.0, 0.1])), angle=float(random.uniform(-0.5, 0.5)), **gear, **more,
    )  # fmt: skip


def judged(machine: ss.Joint) -> str:
    """What is wrong with a run beside the judge's; "" where nothing is."""
    how = {"duration": LENGTH} if machine.period is None else {"periods": max(1, round(LENGTH / machine.period))}
    stiff = any(law.dynamic for law in machine.mechanics.laws)
    run = ss.solve(machine, **how, **({"rtol": 1e-9} if stiff else {}))
    judge = ss.solve(machine, **how, method="radau" if stiff else "dop853", rtol=1e-9 if stiff else 1e-10)
    t = np.linspace(0.0, float(run.pieces.t[-1]), 201)
    x, other = run.at(t)["x"], judge.at(t)["x"]
    away = np.max(abs(x - other)) / max(np.max(abs(x)), 1e-3)
    return "" if away < (1e-4 if stiff else CLOSE) else f"{away:.1e} of its way apart, {len(run.events)} events"


def main() -> None:
    """Try some, and say which differ."""
    count, first = (int(word) for word in [*sys.argv[1:], "100", "0"][:2]) if len(sys.argv) < 3 else map(int, sys.argv[1:3])
    found: Counter[str] = Counter()
    for seed in range(first, first + count):
        try:
            wrong = judged(joint(seed))
        except ss.StickslipError as error:
            wrong = f"{type(error).__name__}: {str(error)[:200]}"
        found["wrong" if wrong else "right"] += 1
        if wrong:
            print(f"seed {seed}: {wrong}", flush=True)
    print(dict(found))


if __name__ == "__main__":
    main()
