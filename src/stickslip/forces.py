"""The forces on a moving body at given instants: what friction does, what it would have to do to hold the body."""

from __future__ import annotations

import functools
import inspect
import math
from typing import Any

import numpy as np

from stickslip.errors import InputError, Problems
from stickslip.fields import is_array, leaves

__all__ = [
    "check_law", "columns", "friction_force", "held_velocity", "impulses_until", "is_dynamic", "is_set_valued", "law_force", "law_rate",
    "memories_of", "normal_load", "offered_force", "passed_zero", "rest_velocity", "states_of", "static_limits", "wants_applied",
]  # fmt: skip

_TINY = 1e-300  # a velocity that has a sign and nothing else
_SLOW = 1e-12  # a velocity [m/s] at which friction is that of the slowest sliding
_LIMITS = "return the friction forces that rest can bear backwards (negative) and forwards (positive)"


# ---- laws ----
def is_dynamic(law: Any) -> bool:
    """Whether a law has inner states (rate and force) and so never rests exactly; else it is set-valued."""
    return hasattr(law, "rate") and hasattr(law, "force")


def is_set_valued(law: Any) -> bool:
    """Whether a law says what it is while sliding and what rest can bear (sliding and breakaway)."""
    return hasattr(law, "sliding") and hasattr(law, "breakaway")


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


def passed_zero(law: Any, z: Any, load: Any, memory: Any) -> tuple[Any, Any]:
    """Inner states and memories of a law once v has passed zero: after the switches that wait for it and for nothing else."""
    inner, held = float(z[0]) if len(z) == 1 else tuple(map(float, z)), tuple(map(int, memory))
    at, beside = (law.switches(v, inner, load, held) for v in (0.0, _TINY))
    for (guard, new, states), (ahead, _, _) in zip(at, beside, strict=True):
        if guard <= 0 < ahead:
            return (z if states is None else np.ravel(states)), new
    return z, memory


def law_force(law: Any, slip: Any, z: Any, zdot: Any, load: Any, memory: Any = (), applied: Any = 0.0) -> Any:
    """Friction force R of a dynamic law [N]; `applied` is what would keep the velocity constant, for the laws that ask for it."""
    more = ((memory,) if memories_of(law) else ()) + ((applied,) if wants_applied(law) else ())
    return law.force(slip, z, zdot, load, *more)


def check_law(law: Any, problems: Problems, example: str = "friction=ss.Coulomb(mu_plus=0.15, mu_minus=0.21)") -> None:
    """Note what keeps an object from being a friction law."""
    if isinstance(law, type) or not (is_set_valued(law) or is_dynamic(law)):
        problems.add(
            f"friction = {law!r}; allowed is an object with sliding and breakaway (set-valued law) or with rate and force "
            f"(dynamic law); type for example {example}"
        )
    elif not hasattr(law, "__dataclass_fields__"):
        problems.add(f"friction = {law!r} is not a dataclass; write @dataclass(frozen=True) above the class, so that its numbers are known")
    else:
        for name, field in law.__dataclass_fields__.items():
            value = getattr(law, name)
            if field.type in (float, "float") and isinstance(value, (list, tuple)):
                problems.add(
                    f"friction.{name} = {value!r}; allowed is a number or an array; type for example {name}=np.array({list(value)!r})"
                )

        if is_set_valued(law) and not is_dynamic(law):
            _check_breakaway(law, problems)


def _check_breakaway(law: Any, problems: Problems) -> None:
    """Note a set-valued law whose breakaway gives no two limits, gives them in the wrong order, or lies below its sliding friction."""
    try:
        limits = law.breakaway(1.0)
        if not isinstance(limits, (tuple, list)) or len(limits) != 2:
            problems.add(
                f"{type(law).__name__}.breakaway(load=1) gives {limits!r}; allowed are two forces; {_LIMITS}, such as return -force, force"
            )
            return
        slow = [np.asarray(law.sliding(v, 1.0)) for v in (-_SLOW, _SLOW)]
        faster = [np.asarray(law.sliding(v, 1.0)) for v in (-1e9 * _SLOW, 1e9 * _SLOW)]
        rounding = [1e-9 * abs(np.asarray(limit)) + 1e-6 * abs(force) for limit, force in zip(limits, faster, strict=True)]
    except Exception as error:  # what else goes wrong inside a law is told where it is traced, with what to write
        if isinstance(error, ValueError) and any(is_array(value) for _, value in leaves(law)) and not getattr(law, "scalar_only", False):
            why = f"{type(law).__name__} cannot take numbers that are arrays ({error})"
            problems.add(f"{why}; write where(condition, yes, no), maximum or minimum from stickslip.maths instead of if, max or min")
        return
    kind, (low, high) = type(law).__name__, map(np.asarray, limits)
    if np.any(low > high):
        problems.add(f"{kind}.breakaway(load=1) gives {limits!r}, the larger force first; {_LIMITS}, in this order")
    elif np.any(slow[1] > high + rounding[1]) or np.any(slow[0] < low - rounding[0]):
        problems.add(
            f"{kind}.breakaway(load=1) gives {limits!r}, less than its friction while it slides slowly ({slow[0]} and {slow[1]}); allowed "
            "is as much or more: a body that breaks away would be stopped at once; make breakaway at least as large as sliding near v = 0"
        )


def static_limits(law: Any, load: Any) -> tuple[Any, Any] | None:
    """Friction forces (backward, forward) up to which a law holds a body [N]; None of a law that does not say."""
    if hasattr(law, "breakaway"):
        try:
            return law.breakaway(load)
        except InputError:  # the stand-in for a law whose class is not known
            return None
    sides = [getattr(law, f"f_{side}", None) for side in ("minus", "plus")]
    minus, plus = (getattr(law, f"mu_{s}", None) if f is None else f for s, f in zip(("minus", "plus"), sides, strict=True))
    return None if minus is None or plus is None else (-minus * load, plus * load)


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
