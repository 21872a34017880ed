"""The pendulum bench of BAM in plain Python: logs of command and angle of known servos. It shares no line with the package.

Equations: Duclusaud, Passault, Padois and Ly (2024), as told in the notes on its parameter sets; each step of a sliding servo is one of
Runge and Kutta's, and where the velocity would change its sign the step ends at rest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

GRAVITY, COUNT = 9.80665, 2 * math.pi / 4096


def sines(t: Any) -> Any:
    """Two slow sines, of which one is modulated [rad]."""
    return np.sin(t) * np.pi / 2 + np.sin(5 * t) * 0.5 * np.sin(2 * t)


def chirp(t: Any) -> Any:
    """A sine that becomes faster and faster [rad]."""
    return np.sin(t**2)


def up_and_down(t: Any) -> Any:
    """Slowly up to a right angle and a little back [rad]."""
    s = np.clip(t / 3, 0, 1)
    r = np.clip(t / 3 - 1, 0, 1)
    return np.pi / 2 * (3 * s**2 - 2 * s**3) - 0.2 * np.pi / 2 * (3 * r**2 - 2 * r**3)


def pendulum(mass: float, length: float, arm: float) -> tuple[float, float]:
    """Moment of inertia [kg m^2] and m g l [N m] of a mass at the end of a rod."""
    return (mass + arm / 3) * length**2, (mass + arm / 2) * GRAVITY * length


def friction(p: Mapping[str, Any]) -> Callable[[float, float, float], float]:
    """The largest friction torque of a parameter set, by velocity, torque of the motor and of gravity."""
    base, both = p["friction_base"], p.get("load_friction_base", 0.0)
    viscous, stribeck, both_s = p["friction_viscous"], p.get("friction_stribeck", 0.0), p.get("load_friction_stribeck", 0.0)
    motor, external = p.get("load_friction_motor", both), p.get("load_friction_external", both)
    motor_s, external_s = p.get("load_friction_motor_stribeck", both_s), p.get("load_friction_external_stribeck", both_s)
    driving, driven = p.get("load_friction_external_quad", 0.0), p.get("load_friction_motor_quad", 0.0)
    v_s, alpha = p.get("dtheta_stribeck", 1.0), p.get("alpha", 1.0)

    def most(v: float, m: float, e: float) -> float:
        s = math.exp(-((abs(v) / v_s) ** alpha))
        limit = base + viscous * abs(v) + abs(external * e - motor * m)
        limit += s * (stribeck + abs(external_s * e - motor_s * m))
        if m * e < 0:
            limit += s * (driving * e * e if abs(e) < abs(m) else driven * m * m)
        return limit

    return most


def swung(
    p: Mapping[str, Any], inertia: float, gravity: float, kp: float, supply: float, command: Any, step: float, parts: int = 20
) -> Any:
    """Angles of a servo at the beginning of each step of a command that holds over it, from rest at zero [rad]."""
    limit, J = friction(p), inertia + p["armature"]
    ratio, k_t = (p["kt"] / p["R"], p["kt"]) if "R" in p else (p["kt"], 0.0)  # by a voltage, or by a current
    h, x, v, angles = step / parts, 0.0, 0.0, []

    def torques(x: float, v: float, goal: float) -> tuple[float, float]:
        volts = min(max(kp * (goal - x), -supply), supply)
        return ratio * (volts - k_t * v), -gravity * math.sin(x)

    def slides(x: float, v: float, goal: float, side: float) -> float:
        m, e = torques(x, v, goal)
        return (m + e - side * limit(v, m, e)) / J

    for goal in command:
        angles.append(x)
        left = parts * h
        for _ in range(20 * parts):
            if left <= 1e-12 * step:
                break
            m, e = torques(x, v, goal)
            if v == 0.0 and abs(m + e) <= limit(0.0, m, e):
                break  # nothing changes before the next command
            side = math.copysign(1.0, v if v != 0.0 else m + e)
            s = min(h, left)
            a1 = slides(x, v, goal, side)
            a2 = slides(x + s / 2 * v, v + s / 2 * a1, goal, side)
            a3 = slides(x + s / 2 * v + s * s / 4 * a1, v + s / 2 * a2, goal, side)
            a4 = slides(x + s * v + s * s / 2 * a2, v + s * a3, goal, side)
            end = v + s * (a1 + 2 * a2 + 2 * a3 + a4) / 6
            if end * side < 0 and v != 0.0:  # it comes to rest on the way
                s *= v / (v - end)
                x, v = x + s * v / 2, 0.0
            else:
                x, v = x + s * v + s * s * (a1 + a2 + a3) / 6, end
            left -= s
    return np.array(angles)


def shown(angles: Any, seed: int, noise: float = 0.3) -> Any:
    """Angles as an encoder of 4096 counts shows them, with noise of so many counts before it [rad]."""
    noisy = angles + np.random.default_rng(seed).normal(0, noise * COUNT, len(angles))
    return COUNT * np.round(noisy / COUNT)
