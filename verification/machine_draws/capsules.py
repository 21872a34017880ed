"""Robots whose inner mass is driven by force: capsubots, and capsules with stops on one side or both."""

from __future__ import annotations

from typing import Any

import numpy as np
from drawn_models import Draw

import stickslip as ss
from machine_draws.drawing import friction, sized


def capsule(law: str, d: Draw) -> Any:
    """A body, an inner mass, a force, and no stop, one or two."""
    body, inner = 0.2 * d.wide(0.3, 3), 0.07 * d.wide(0.3, 3)
    period, size = 0.06 * d.wide(0.3, 3), 0.02 * d.wide(0.3, 3)  # of the way that the inner mass makes [m]
    omega, track = 2 * np.pi / period, _track(d, size)
    push = inner * omega**2 * size
    law = friction(law, sized(d, body + inner, inner * size * omega / (body + inner), omega, 9.81 * (body + inner), 0.3))
    stops = tuple(_stop(d, size, inner * omega**2, side) for side in ((), (1,), (-1,), (1, -1))[int(d.choice.integers(4))])
    sprung = len(stops) < 2 or d.choice.random() < 0.5
    stiffness = inner * omega**2 * d.wide(0.1, 10) if sprung else 0.0 * inner
    drive = ss.machines.Forced(
        _force(d, push, period), stiffness=stiffness, damping=inner * omega * d.sometimes(d.wide(1e-3, 0.5)), stops=stops,
        reaction=bool(d.choice.random() < 0.7),
    )  # fmt: skip
    return ss.Robot(body, inner, drive, law, track=track)


def _force(d: Draw, push: Any, period: Any) -> Any:
    which, omega = int(d.choice.integers(3)), 2 * np.pi / period
    if which == 0:
        return ss.HarmonicForce(amplitude=push, omega=omega, phase=d.uniform(-np.pi, np.pi))
    if which == 1:
        return ss.drives.Pulses(push, period=period, duty=d.uniform(0.1, 0.9))
    second = ss.HarmonicForce(push * d.uniform(0.1, 0.7), 2 * omega, d.uniform(-np.pi, np.pi))
    return ss.HarmonicForce(push, omega, d.uniform(-np.pi, np.pi)) + second


def _stop(d: Draw, size: Any, stiffness: Any, side: int) -> Any:
    gap = size * d.wide(0.03, 2.0)
    if d.choice.random() < 0.65:
        return ss.Stop(gap=gap, restitution=d.uniform(0.0, 0.95), side=side)
    return ss.Stop(gap=gap, stiffness=stiffness * d.wide(3, 1000), side=side)


def _track(d: Draw, size: Any) -> Any:
    which = d.choice.random()
    if which < 0.6:
        return ss.Level()
    if which < 0.8:
        return ss.Incline(tilt=d.uniform(-0.03, 0.03))
    return ss.tracks.FrictionWave(ss.Level(), wavelength=size * d.wide(0.3, 3), cosines=(0.0 * size,), sines=(d.uniform(0.05, 0.6),))
