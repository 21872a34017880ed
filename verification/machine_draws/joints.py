"""Joints under a torque, a controller or both, whose gear may be elastic and have play."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from drawn_models import Draw

import stickslip as ss
from machine_draws.drawing import friction, sized
from stickslip.models.machines.periodic_record import PeriodicRecord


def joint(law: str, d: Draw) -> Any:
    """Half of them with a gear, of which half has backlash; half of the controllers take samples."""
    inertia, swing, omega = 0.01 * d.wide(0.5, 2), 0.3 * d.wide(0.5, 2), 2 * np.pi
    rubs = friction(law, sized(d, inertia, swing * omega, 3 * omega, 1.0))
    sample = [None, 0.05, 0.02][int(d.choice.integers(3))]
    control = _control(d, inertia, swing, sample)
    torque = _torque(d, inertia, swing) if d.choice.random() < 0.5 else None
    own = {"torque": torque} if torque is not None else {}
    hanging = {"gravity_torque": 0.2 * d.uniform(0.0, 1.0), "load_gain": d.uniform(0.0, 2.0)} if d.choice.random() < 0.4 else {}
    angle, gear = d.uniform(-0.5, 0.5), _gear(d)
    if gear:
        control, gear = _stable(inertia, control, gear)
    return ss.Joint(inertia=inertia, friction=rubs, control=control, angle=angle, **own, **hanging, **gear)


def _stable(inertia: Any, control: Any, gear: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
    """Gains for all that turns, and a gear damped enough for feedback from its far end, or the linear loop would grow without bounds.

    Without kp and ki Routh's condition is J d (J k + d kd) > Jm Jl k kd, with J = Jm + Jl; twice what that asks for is given.
    """
    motor = gear["motor_inertia"]
    whole = inertia + motor
    control = replace(control, **{name: getattr(control, name) * whole / inertia for name in ("kp", "ki", "kd")})
    least = 2 * inertia * motor * control.kd / whole**2 if control.feedback == "joint" else 0.0
    return control, gear | {"gear_damping": gear["gear_damping"] + least}


def _control(d: Draw, inertia: Any, swing: Any, sample: float | None) -> Any:
    speed = 2 * np.pi * d.uniform(1.0, 2.5)  # at which the loop closes: a tenth of what samples allow
    gains = {"kp": inertia * speed**2, "ki": d.sometimes(inertia * speed**3 * 0.1), "kd": inertia * speed * d.uniform(0.5, 1.5)}
    side = ("joint", "motor")[int(d.choice.integers(2))]
    return ss.machines.PID(
        **gains, target=_target(d, swing), sample=None if sample is None else sample * (1.0 + 0.0 * inertia),
        feedforward=0.02 * d.sometimes(1.0 + 0.0 * inertia), feedback=side,
    )  # fmt: skip


def _target(d: Draw, swing: Any) -> Any:
    """A number, or a motion of one second."""
    which, one = int(d.choice.integers(3)), 1.0 + 0.0 * swing
    if which == 0:
        return swing
    if which == 1:
        return ss.Harmonic(amplitude=swing, omega=2 * np.pi * one)
    return PeriodicRecord(one, swing * d.uniform(-1.0, 1.0), (0.0 * one, swing * 0.1), (swing, 0.0 * one))


def _torque(d: Draw, inertia: Any, swing: Any) -> Any:
    size = inertia * swing * (2 * np.pi) ** 2 * d.uniform(0.1, 1.0)
    return size if d.choice.random() < 0.5 else ss.HarmonicForce(size, 4 * np.pi * (1.0 + 0.0 * size), d.uniform(-3.0, 3.0))


def _gear(d: Draw) -> dict[str, Any]:
    if d.choice.random() < 0.5:
        return {}
    play = {"backlash": 0.02 * d.wide(0.1, 3)} if d.choice.random() < 0.5 else {}
    gear = {"gear_stiffness": 30.0 * d.wide(0.3, 10), "gear_damping": 0.05 * d.uniform(0.0, 1.0)}
    return {"motor_inertia": 0.01 * d.wide(0.3, 3), **gear, **play}
