"""The forces on a moving body at given instants: what friction does, what it would have to do to hold the body."""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["columns", "friction_force", "held_velocity", "is_dynamic", "normal_load", "offered_force"]

_TINY = 1e-300  # a velocity that has a sign and nothing else


def is_dynamic(law: Any) -> bool:
    """Whether a law has inner states (rate and force) and so never rests exactly; else it is set-valued."""
    return hasattr(law, "rate") and hasattr(law, "force")


def normal_load(model: Any, t: Any, x: Any) -> Any:
    """Normal force N on the contact [N]: a method of the robot, a number of the test benches."""
    return model.load(t, x) if callable(model.load) else model.load


def offered_force(model: Any, t: Any, x: Any) -> Any:
    """What all forces but friction add up to [N]: the friction force that would hold the body at rest."""
    return model.total_mass * model.acceleration(t, x, 0.0 * t, 0.0)


def held_velocity(v: Any, mode: Any, least: Any = _TINY) -> Any:
    """The velocity on the side that `mode` holds, at least `least` in size: laws are evaluated inside one branch."""
    return mode * np.maximum(mode * v, least)


def friction_force(model: Any, mode: Any, t: Any, x: Any, v: Any, z: Any, zdot: Any) -> Any:
    """Friction force R [N]; z and its rate are (states, n), or (n,) for one state. Stuck bodies feel what the other forces leave over."""
    law, load = model.friction, model.load(t, x)
    slip = held_velocity(model.contact_velocity(v), np.where(mode == 0, 1, mode))
    if is_dynamic(law):
        return law.force(slip, z, zdot, load)
    return np.where(mode == 0, offered_force(model, t, x), law.sliding(slip, load))


def columns(model: Any, mode: Any, t: Any, x: Any, v: Any, z: Any, zdot: Any) -> dict[str, Any]:
    """Every force and every motion of the inner mass, by the names in `stickslip.variables`."""
    drive, ones = model.drive, np.ones_like(t)
    R = friction_force(model, mode, t, x, v, z, zdot) * ones
    acceleration = np.where((mode == 0) & (not is_dynamic(model.friction)), 0.0, model.acceleration(t, x, v, R) * ones)
    xi_acceleration, xi_rate = drive.acceleration(t) * ones, drive.velocity(t) * ones
    F = model.actuator_force(t, acceleration) * ones
    return {
        "acceleration": acceleration,
        "friction_force": R,
        "drive_force": -model.inner_mass * xi_acceleration,
        "xi": drive.position(t) * ones,
        "xi_rate": xi_rate,
        "xi_acceleration": xi_acceleration,
        "actuator_force": F,
        "actuator_power": -F * xi_rate,
    }
