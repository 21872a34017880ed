"""The forces on a moving body at given instants: what friction does, what it would have to do to hold the body."""

from __future__ import annotations

import functools
import inspect
import math
from typing import Any

import numpy as np

from stickslip.errors import Problems

__all__ = [
    "check_law", "columns", "friction_force", "held_velocity", "impulses_until", "is_dynamic", "law_force", "law_rate", "memories_of",
    "normal_load", "offered_force", "rest_velocity", "states_of", "wants_applied",
]  # fmt: skip

_TINY = 1e-300  # a velocity that has a sign and nothing else


# ---- laws ----
def is_dynamic(law: Any) -> bool:
    """Whether a law has inner states (rate and force) and so never rests exactly; else it is set-valued."""
    return hasattr(law, "rate") and hasattr(law, "force")


def states_of(law: Any) -> int:
    """Number of inner states of a law: 0 for a set-valued one, 1 for a dynamic one that does not say."""
    return int(getattr(law, "states", 1)) if is_dynamic(law) else 0


def memories_of(law: Any) -> int:
    """Number of whole-number memories (`modes`) of a law."""
    return int(getattr(law, "modes", 0)) if is_dynamic(law) else 0


def wants_applied(law: Any) -> bool:
    """Whether a dynamic law's force must know the friction force that would hold the body (its argument `applied`)."""
    return _takes_applied(law.__class__)


@functools.lru_cache(maxsize=256)
def _takes_applied(kind: Any) -> bool:
    return "applied" in inspect.signature(kind.force).parameters


def law_rate(law: Any, slip: Any, z: Any, load: Any, memory: Any = ()) -> Any:
    """Rate of the inner states: a number for one state, else a tuple."""
    return law.rate(slip, z, load, memory) if memories_of(law) else law.rate(slip, z, load)


def law_force(law: Any, slip: Any, z: Any, zdot: Any, load: Any, memory: Any = (), applied: Any = 0.0) -> Any:
    """Friction force R of a dynamic law [N]; `applied` is what would keep the velocity constant, for the laws that ask for it."""
    more = ((memory,) if memories_of(law) else ()) + ((applied,) if wants_applied(law) else ())
    return law.force(slip, z, zdot, load, *more)


def check_law(law: Any, problems: Problems, example: str = "friction=ss.Coulomb(mu_plus=0.15, mu_minus=0.21)") -> None:
    """Note what keeps an object from being a friction law."""
    set_valued = hasattr(law, "sliding") and hasattr(law, "breakaway")
    if isinstance(law, type) or not (set_valued or is_dynamic(law)):
        problems.add(
            f"friction = {law!r}; allowed is an object with sliding and breakaway (set-valued law) or with rate and force "
            f"(dynamic law); type for example {example}"
        )
    elif not hasattr(law, "__dataclass_fields__"):
        problems.add(f"friction = {law!r} is not a dataclass; write @dataclass(frozen=True) above the class, so that its numbers are known")


# ---- models ----
def normal_load(model: Any, t: Any, x: Any) -> Any:
    """Normal force N on the contact [N]; a model's `load` is a number, or a function of time and place."""
    return model.load(t, x) if callable(model.load) else model.load


def rest_velocity(model: Any) -> Any:
    """Velocity of the body at which the contact does not slip [m/s]: 0, or the speed of the belt."""
    return 0.0 - model.contact_velocity(0.0)


def offered_force(model: Any, t: Any, x: Any) -> Any:
    """What all forces but friction add up to [N]: the friction force that would hold the body at rest on its contact."""
    return model.total_mass * model.acceleration(t, x, rest_velocity(model) + 0.0 * t, 0.0)


def impulses_until(model: Any, end: float) -> list[tuple[float, float]]:
    """The impulses of a run up to and with `end`: (time [s], jump of v [m/s]), in order; none at the very start."""
    jumps = getattr(model, "impulses", ()) or ()
    if not jumps:
        return []
    T = float(model.period)
    slack = 1e-9 * T
    found = [(k * T + float(s), float(jump)) for k in range(math.floor(end / T + 1e-9) + 1) for s, jump in jumps]
    return sorted((t, jump) for t, jump in found if 0.0 < t <= end + slack)


def held_velocity(v: Any, mode: Any, least: Any = _TINY) -> Any:
    """The velocity on the side that `mode` holds, at least `least` in size: laws are evaluated inside one branch."""
    return mode * np.maximum(mode * v, least)


def friction_force(model: Any, mode: Any, t: Any, x: Any, v: Any, z: Any, zdot: Any, memory: Any = ()) -> Any:
    """Friction force R [N]; z and its rate are (states, n), or (n,) for one state. Stuck bodies feel what the other forces leave over."""
    law, load = model.friction, normal_load(model, t, x)
    slip = held_velocity(model.contact_velocity(v), np.where(mode == 0, 1, mode))
    if is_dynamic(law):
        applied = model.total_mass * model.acceleration(t, x, v, 0.0) if wants_applied(law) else 0.0
        return law_force(law, slip, z, zdot, load, memory, applied)
    return np.where(mode == 0, offered_force(model, t, x), law.sliding(slip, load))


def columns(model: Any, mode: Any, t: Any, x: Any, v: Any, z: Any, zdot: Any, memory: Any = ()) -> dict[str, Any]:
    """Every force, and every motion of the inner mass if there is one, by the names in `stickslip.variables`."""
    ones = np.ones_like(t)
    R = friction_force(model, mode, t, x, v, z, zdot, memory) * ones
    acceleration = np.where((mode == 0) & (not is_dynamic(model.friction)), 0.0, model.acceleration(t, x, v, R) * ones)
    found = {"acceleration": acceleration, "friction_force": R}
    return found | _of_the_drive(model, t, acceleration, ones) if hasattr(model, "drive") else found


def _of_the_drive(model: Any, t: Any, acceleration: Any, ones: Any) -> dict[str, Any]:
    xi_acceleration, xi_rate = model.drive.acceleration(t) * ones, model.drive.velocity(t) * ones
    F = model.actuator_force(t, acceleration) * ones
    return {
        "drive_force": -model.inner_mass * xi_acceleration,
        "xi": model.drive.position(t) * ones,
        "xi_rate": xi_rate,
        "xi_acceleration": xi_acceleration,
        "actuator_force": F,
        "actuator_power": -F * xi_rate,
    }
