"""Robots with several inner masses, of which one may press, on tracks whose friction varies from place to place."""

from __future__ import annotations

from typing import Any

import numpy as np
from drawn_models import Draw

import stickslip as ss
from machine_draws.drawing import friction, motion, remembers, sized


def robot(law: str, d: Draw) -> Any:
    """One to three inner masses, with periods in whole ratios."""
    total, period, stroke = 0.07 * d.wide(0.3, 3), 0.03 * d.wide(0.3, 3), 1e-3 * d.wide(0.3, 3)
    count, jumps = int(d.choice.integers(1, 4)), not remembers(law) and d.choice.random() < 0.3
    ratios = tuple(d.uniform(0.03, 0.2) for _ in range(count))
    drives = tuple(motion(d, stroke, period / int(d.choice.integers(1, 4)), jumps) for _ in range(count))
    if d.choice.random() < 0.3:
        amplitude = d.uniform(0.1, 2.0) * 9.81 * (drives[0].period / (2 * np.pi)) ** 2
        drives = (ss.drives.VerticalVibration(drives[0], amplitude=amplitude, phase=d.uniform(0, 6.28), harmonic=1), *drives[1:])
    omega = 2 * np.pi / period
    rubs = friction(law, sized(d, total, sum(ratios) * stroke * omega / 2, omega, 9.81 * total, 0.3))
    inner, drive = (tuple(total * r for r in ratios), drives) if count > 1 else (total * ratios[0], drives[0])
    return ss.Robot(total * (1 - sum(ratios)), inner, drive, rubs, track=_track(d, stroke))


def _track(d: Draw, stroke: Any) -> Any:
    """Friction that varies over about the way of a few periods."""
    level, which = ss.Incline(tilt=d.uniform(-0.02, 0.02)) if d.choice.random() < 0.3 else ss.Level(), int(d.choice.integers(4))
    length = stroke * d.wide(0.05, 3)
    factors = tuple(d.uniform(0.4, 1.5) for _ in range(3))
    if which == 0:
        return ss.tracks.FrictionWave(level, wavelength=length, cosines=(0.0 * length,), sines=(d.uniform(0.05, 0.6),))
    if which == 1:
        return ss.tracks.FrictionPatches(level, edges=(0.0 * length, length * 0.4), factors=factors[:2], wavelength=length)
    if which == 2:
        return ss.tracks.FrictionPatches(level, edges=(-length, length), factors=factors)
    return level
