"""Laws whose numbers a robot does not have, fitted to a record of it, so that `compare` can put them beside the others."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from stickslip.analysis.motion import coulomb_twin
from stickslip.models.friction import Coulomb, CoulombViscous, Dahl, LuGre, Stribeck
from stickslip.records import Record

_WIDE = 4.0  # times the kinetic coefficients that a robot has, and their inverse, between which those of a law are sought
_ANY = (0.01, 1.5)  # where it has none
_STATIC = (1.0, 3.0)  # static friction over kinetic friction
_STARTS = 16

#: Numbers of a law that are sought besides its kinetic coefficients: bounds from a friction force F, a speed v and a stroke s of the robot.
SOUGHT: dict[type, Callable[[float, float, float], dict[str, tuple[Any, ...]]]] = {
    Coulomb: lambda F, v, s: {"static": _STATIC},
    CoulombViscous: lambda F, v, s: {"viscous": (0.0, 4 * F / v)},
    Stribeck: lambda F, v, s: {"static": _STATIC, "v_s": (1e-3 * v, v, "log")},
    Dahl: lambda F, v, s: {"sigma0": (F / s, 1e4 * F / s, "log")},
    LuGre: lambda F, v, s: {"static": _STATIC, "v_s": (1e-3 * v, v, "log"), "sigma0": (F / s, 1e4 * F / s, "log")},
}


def with_fitted_law(cls: type, robot: Any, record: Record, **how: Any) -> tuple[Any, str]:
    """A robot with the numbers of a law that fit a record of it best, and a sentence with them.

    The record is taken as it is, as `compare` does: by an ideal sensor, under the drive of the robot. The numbers have no intervals; those
    are by `identify`, which knows sensors.

    Parameters
    ----------
    cls : type
        The class of the law, one of `SOUGHT`.
    how : dict
        Arguments of `identify` that say what is compared: using, noise, frequency, settle, rtol.
    """
    from stickslip.inverse.identification.identify import identify

    twin = coulomb_twin(robot)
    kinetic = None if twin is None else (float(twin.friction.mu_plus), float(twin.friction.mu_minus))
    speed = float(robot.velocity_scale)
    force = float(robot.load(0.0, 0.0)) * (max(kinetic) if kinetic else 0.3)
    free: dict[str, tuple[Any, ...]] = {}
    for k, name in enumerate(("mu_plus", "mu_minus")):
        free[name] = (kinetic[k] / _WIDE, kinetic[k] * _WIDE) if kinetic and kinetic[k] > 0 else _ANY
    free |= SOUGHT[cls](force, speed, speed * float(robot.period) / math.pi)
    mass = float(robot.total_mass)

    def make(**numbers: float) -> Any:
        return robot.replace(friction=_law_of(cls, mass, **numbers))

    fit = identify(record, make, free=free, sensor={}, harmonics=0, starts=_STARTS, **how)
    values = ", ".join(f"{name} = {value:.3g}" for name, value in fit.values.items())
    said = f"{cls.__name__}: the robot does not have its numbers; those that fit this record best are {values}"
    return make(**fit.values), f"{said}; for intervals type ss.identify, for a ranking ss.identification.rank"


def _law_of(cls: type, mass: float, mu_plus: float, mu_minus: float, static: float | None = None, **own: float) -> Any:
    """A law by its kinetic coefficients, static friction over kinetic friction, and its own numbers; its bristles are half damped."""
    if static is not None:
        own |= {"f_plus": static * mu_plus, "f_minus": static * mu_minus}
    if cls is LuGre:
        own |= {"sigma1": math.sqrt(own["sigma0"] * mass), "sigma2": 0.0}
    return cls(mu_plus=mu_plus, mu_minus=mu_minus, **own)
