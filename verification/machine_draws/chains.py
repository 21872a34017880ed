"""Robots in a row, joined by springs that may harden or have play, under one law or several."""

from __future__ import annotations

from typing import Any

import numpy as np
from drawn_models import Draw

import stickslip as ss
from machine_draws.drawing import LAWS, friction, has_states, motion, remembers, sized

SET_VALUED = tuple(name for name in LAWS if not has_states(name))


def chain(law: str, d: Draw) -> Any:
    """Two to six modules."""
    count, period = int(d.choice.integers(2, 7)), 2 * np.pi / (205.0 * d.wide(0.3, 3))
    mixed = not has_states(law) and d.choice.random() < 0.3
    names = [str(d.choice.choice(SET_VALUED)) if mixed and i else law for i in range(count)]
    mass, stroke, jumps = 0.07 * d.wide(0.3, 3), 1e-3 * d.wide(0.3, 3), not any(map(remembers, names)) and d.choice.random() < 0.3
    modules = tuple(_module(name, d, mass * d.uniform(0.5, 2.0), stroke * d.uniform(0.5, 1.5), period, jumps) for name in names)
    springs = count - 1 if d.choice.random() < 0.3 else 1
    links = tuple(_spring(d, mass, stroke, 2 * np.pi / period) for _ in range(springs))
    return ss.Chain(modules, links if springs > 1 else links[0], tuple(d.uniform(-np.pi, np.pi) for _ in range(count)))


def _module(name: str, d: Draw, total: Any, stroke: Any, period: Any, jumps: bool) -> Any:
    ratio, drive = d.uniform(0.05, 0.4), motion(d, stroke, period, jumps)
    law = friction(name, sized(d, total, ratio * stroke * np.pi / period, 2 * np.pi / period, 9.81 * total))
    track = ss.Incline(tilt=d.uniform(-0.02, 0.02)) if d.choice.random() < 0.2 else ss.Level()
    return ss.Robot(total * (1 - ratio), total * ratio, drive, law, track=track)


def _spring(d: Draw, mass: Any, stroke: Any, omega: Any) -> Any:
    stiffness = mass * omega**2 * d.wide(0.03, 30)
    hardens, has_play = {"cubic": stiffness / stroke**2 * d.wide(0.01, 10)}, {"clearance": stroke * d.wide(0.01, 1)}
    more = ({}, hardens, has_play)[int(d.choice.choice(3, p=(0.6, 0.2, 0.2)))]
    damping = np.sqrt(stiffness * mass) * d.sometimes(d.wide(1e-3, 1.0))
    return ss.Spring(stiffness=stiffness, damping=damping, **more)
