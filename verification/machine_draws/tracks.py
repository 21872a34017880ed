"""Masses on tracks that move: piezo stages, and conveyors on which they hop."""

from __future__ import annotations

from typing import Any

import numpy as np
from drawn_models import Draw

import stickslip as ss
from machine_draws.drawing import friction, motion, remembers, sized


def stage(law: str, d: Draw) -> Any:
    """A slider under a given load."""
    mass, load, period = 0.02 * d.wide(0.3, 10), 10.0 * d.wide(0.3, 3), 1e-3 * d.wide(1, 30)
    stroke = 2e-5 * d.wide(0.1, 100)
    omega = 2 * np.pi / period
    rubs = friction(law, sized(d, mass, stroke * omega / 2, omega, load))
    along = motion(d, stroke, period, jumps=not remembers(law))
    pull = d.uniform(-0.1, 0.1) * mass * stroke * omega**2
    return ss.MovingTrack(mass=mass, along=along, tilt=d.uniform(-0.1, 0.1), friction=rubs, load=load, force=d.sometimes(pull))


def conveyor(law: str, d: Draw) -> Any:
    """A part whose throw index is from a third to four; it hops under laws that can."""
    mass, period, index, tilt = 0.05 * d.wide(0.3, 10), 0.02 * d.wide(0.5, 2.5), d.uniform(0.3, 4.0), d.uniform(-0.1, 0.1)
    omega = 2 * np.pi / period
    height = 2 * index * 9.81 / omega**2
    stroke = height / d.uniform(0.3, 2.0)
    rubs = friction(law, sized(d, mass, stroke * omega / 2, omega, 9.81 * mass, 0.1))
    along, across = motion(d, stroke, period, jumps=not remembers(law)), motion(d, height, period)
    lands = _restitution(d) if "viscous" not in law or law == "viscous" else None  # an impact has no impulse of a force that has no load
    return ss.MovingTrack(mass=mass, along=along, across=across, tilt=tilt, friction=rubs, restitution=lands)


def _restitution(d: Draw) -> Any:
    which = d.choice.random()
    return None if which < 0.15 else 0.0 * d.uniform(0, 1) if which < 0.5 else d.uniform(0.0, 0.9)
