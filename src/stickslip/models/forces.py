"""Forces on a moving body at given instants: the friction force, and the force that would hold the body."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array, Model, Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.field_types import field_types
from stickslip.basics.fields import is_array, leaves
from stickslip.models.contact_forces import contact_columns
from stickslip.models.friction.law_adapter import TINY, adapted, is_law
from stickslip.models.machine_adapter import machine_of
from stickslip.models.mechanics import rest_velocity

if TYPE_CHECKING:
    from stickslip.models.friction.law_adapter import LawAdapter


_SLOW = 1e-12  # velocity [m/s] of very slow sliding
_ORDINARY = 1e-3  # velocity [m/s] of ordinary sliding
_LEAST = 1e-9  # of the velocity scale: the least velocity at which the slip ratio is evaluated
_LIMITS = "return the static friction limits backwards (negative) and forwards (positive)"


def check_law(law: Any, problems: Problems, example: str = "friction=ss.Coulomb(mu_plus=0.15, mu_minus=0.21)") -> None:
    """Note the reasons why an object is not a friction law."""
    if isinstance(law, type) or not is_law(law):
        problems.add(
            f"friction = {law!r}; allowed is an object with sliding and breakaway (set-valued law) or with rate and force "
            f"(dynamic law); type for example {example}"
        )
    elif not hasattr(law, "__dataclass_fields__"):
        problems.add(f"friction = {law!r} is not a dataclass; write @dataclass(frozen=True) above the class, so that its numbers are known")
    else:
        for name, kind in field_types(type(law)).items():
            value = getattr(law, name)
            if kind.holds == "number" and isinstance(value, (list, tuple)):
                problems.add(
                    f"friction.{name} = {value!r}; allowed is a number or an array; type for example {name}=np.array({list(value)!r})"
                )

        if adapted(law).dynamic:
            _check_switches(law, problems)
        else:
            _check_breakaway(law, problems)


def _check_switches(law: LawAdapter, problems: Problems) -> None:
    """Note a law with whole-number memories but no switches: neither its rate nor its force would receive them."""
    if getattr(law, "modes", 0) and not adapted(law).switching:
        problems.add(
            f"{type(law).__name__} has modes = {law.modes} and no switches; allowed are both or neither; "
            "type def switches(self, v, z, load, mode)"
        )


def _check_breakaway(law: LawAdapter, problems: Problems) -> None:
    """Note a set-valued law whose breakaway does not give two limits, in the right order and at least as large as sliding friction."""
    try:
        limits = law.breakaway(1.0)
        if not isinstance(limits, (tuple, list)) or len(limits) != 2:
            problems.add(
                f"{type(law).__name__}.breakaway(load=1) gives {limits!r}; allowed are two forces; {_LIMITS}, such as return -force, force"
            )
            return
        slow = [_values(law.sliding(v, 1.0)) for v in (-_SLOW, _SLOW)]
        faster = [_values(law.sliding(v, 1.0)) for v in (-_ORDINARY, _ORDINARY)]
        rounding = [1e-9 * abs(_values(limit)) + 1e-6 * abs(force) for limit, force in zip(limits, faster, strict=True)]
    except Exception as error:  # other errors inside a law are reported, with a suggestion, when it is traced
        if isinstance(error, ValueError) and any(is_array(value) for _, value in leaves(law)) and adapted(law).compiles:
            why = f"{type(law).__name__} cannot take numbers that are arrays ({error})"
            problems.add(f"{why}; write where(condition, yes, no), maximum or minimum from stickslip.maths instead of if, max or min")
        return
    kind, (low, high) = type(law).__name__, map(_values, limits)
    if _any(low > high):
        problems.add(f"{kind}.breakaway(load=1) gives {limits!r}, the larger force first; {_LIMITS}, in this order")
    elif _any(slow[1] > high + rounding[1]) or _any(slow[0] < low - rounding[0]):
        problems.add(
            f"{kind}.breakaway(load=1) gives {limits!r}, less than its friction while it slides slowly ({slow[0]} and {slow[1]}); allowed "
            "is as much or more: a body that breaks away would be stopped at once; make breakaway at least as large as sliding near v = 0"
        )


def _values(given: Any) -> Any:
    """A float, or an array of what is none."""
    return given if type(given) is float else np.asarray(given)


def _any(condition: Any) -> bool:
    return condition if type(condition) is bool else bool(np.any(condition))


def offered_force(model: Any, t: Any, x: Any) -> Any:
    """The net applied force [N]: the friction force that would hold the body at rest on its contact."""
    return model.total_mass * model.acceleration(t, x, rest_velocity(model) + 0.0 * t, 0.0)


def impulses_until(model: Model, end: float) -> list[tuple[float, Any]]:
    """The impulses of a run up to and including `end`, in order: (time [s], jump of v [m/s]); none at t = 0.

    For a machine of several bodies a jump is an array with a number for each body.
    """
    jumps = machine_of(model).jumps
    if not jumps:
        return []
    T = float(model.period)
    slack = 1e-9 * T
    impulses = [(k * T + float(s), jump) for k in range(math.floor(end / T + 1e-9) + 1) for s, jump in jumps]
    together: list[tuple[float, Any]] = []
    for t, jump in sorted(((t, jump) for t, jump in impulses if 0.0 < t <= end + slack), key=lambda impulse: impulse[0]):
        if together and t - together[-1][0] <= slack:  # jumps at one instant are one impulse
            together[-1] = (t, together[-1][1] + jump)
        else:
            together.append((t, jump))
    return together


def held_velocity(v: Numeric, mode: Any, least: Any = TINY) -> Any:
    """The velocity on the side given by `mode`, at least `least` in magnitude, so that laws are evaluated inside one branch."""
    return mode * np.maximum(mode * v, least)


def slip_ratio(law: LawAdapter, speed: Any, mode: Any, slip: Numeric, load: Numeric, z: Any, memory: Any = ()) -> Any:
    """Slip ratio 1 - (dz/dt)/w of the first inner state on the side given by `mode`: 0 in elastic deflection, 1 in steady sliding.

    It is the ratio of the elastic part of the friction to its steady sliding value. A slip w below 1e-9 of `speed`, the machine's velocity
    scale [m/s], counts as that.
    """
    held = held_velocity(slip, mode, _LEAST * float(speed) or _LEAST)
    return 1 - np.asarray(law.rate(held, tuple(z), load, memory)[0]) / held


def columns(model: Any, mode: Any, t: Array, x: Array, v: Array, z: Any, zdot: Any, memory: Any = ()) -> dict[str, Any]:
    """Accelerations of all bodies, forces of all contacts, and of the drive if there is one, by the names in `stickslip.variables`.

    Positions and velocities are (n, bodies), modes (n, contacts), inner states and their rates a sequence of such arrays (n, contacts);
    the columns of the drive are (n,).
    """
    machine = machine_of(model)
    forces = contact_columns(machine.mechanics, mode, t, x, v, z, zdot, memory)
    return forces | _of_the_drive(model, t, forces["acceleration"][:, 0], np.ones_like(t)) if machine.drive is not None else forces


def _of_the_drive(model: Any, t: Numeric, acceleration: Numeric, ones: Any) -> dict[str, Any]:
    machine = machine_of(model)
    drive: Any = machine.drive
    xi_acceleration, xi_rate = drive.acceleration(t) * ones, drive.velocity(t) * ones
    F = model.actuator_force(t, acceleration) * ones
    several = len(machine.inner_masses) > 1
    return {
        "drive_force": -machine.whole_inner_mass * xi_acceleration,
        "xi": drive.position(t) * ones,
        "xi_rate": xi_rate,
        "xi_acceleration": xi_acceleration,
        "actuator_force": F,
        "actuator_power": model.actuator_power(t, acceleration) * ones if several else -F * xi_rate,
    }
