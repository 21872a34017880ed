"""Plain bodies in a row: worms whose distances are told, or told in part and sprung in part, or kept."""

from __future__ import annotations

from typing import Any

import numpy as np
from drawn_models import Draw

import stickslip as ss
from machine_draws.drawing import friction, motion, remembers, sized


def worm(law: str, d: Draw) -> Any:
    """Two to six bodies that a wave moves against each other; some of the links may be springs or rods."""
    count, alike = int(d.choice.integers(2, 7)), d.choice.random() < 0.5
    period, stroke, mass = 2 * np.pi / (12.0 * d.wide(0.3, 3)), 4e-3 * d.wide(0.3, 3), 0.05 * d.wide(0.3, 3)
    masses = mass if alike else tuple(mass * d.uniform(0.5, 2.0) for _ in range(count))
    omega = 2 * np.pi / period
    rubs = friction(law, sized(d, mass, stroke * omega / 2, omega, 9.81 * mass))
    wave = motion(d, stroke, period, jumps=not remembers(law) and d.choice.random() < 0.3)
    lag = 2 * np.pi / count * (1.0 + 0.0 * mass) if alike and d.choice.random() < 0.5 else d.uniform(-np.pi, np.pi)
    gait = ss.machines.Gait(wave, lag=lag, length=0.05 * d.uniform(0.0, 1.0))
    link = gait if count == 2 or d.choice.random() < 0.5 else (gait, *(_link(d, gait, mass, omega) for _ in range(count - 2)))
    return ss.Chain(ss.machines.Bodies(mass=masses, count=count, friction=rubs), link=link)


def _link(d: Draw, gait: Any, mass: Any, omega: Any) -> Any:
    which = d.choice.random()
    if which < 0.4:
        return gait
    if which < 0.5:
        return ss.machines.Rigid()
    stiffness = mass * omega**2 * d.wide(0.1, 30)
    damping = np.sqrt(stiffness * mass) * d.sometimes(d.wide(1e-2, 1.0))
    return ss.Spring(stiffness=stiffness, damping=damping, length=0.05 * d.uniform(0.0, 1.0))
