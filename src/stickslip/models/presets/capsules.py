"""Robots whose inner mass is driven by force: capsubots and capsules."""

from __future__ import annotations

import math
from typing import Annotated, Any

from stickslip.basics.arguments import checked_numbers, explains_arguments
from stickslip.basics.quantities import BODY_MASS, DAMPING, GRAVITY, INNER_MASS, PERIOD, STIFFNESS, at_least, positive, quantity
from stickslip.models.drives import HarmonicForce, Pulses
from stickslip.models.friction import Coulomb
from stickslip.models.friction.coefficients import MU
from stickslip.models.machines import Forced, Stop
from stickslip.models.robot import Robot


@explains_arguments
def capsubot(
    pulse: Annotated[Any, quantity("force of the pulses", "N", "A", example=1.25)] = 1.25,
    pulse_period: Annotated[Any, PERIOD | {"label": "period of the pulses", "example": 0.06}] = 0.06,
    duty: Annotated[Any, quantity("part of the period for which the force is on", "1", "d", example=0.35)] = 0.35,
    stiffness: Annotated[Any, STIFFNESS] = 256.23,
    damper: Annotated[Any, DAMPING] = 0.0,
    mu: Annotated[Any, MU] = 0.29,
    body_mass: Annotated[Any, BODY_MASS] = 0.193,
    inner_mass: Annotated[Any, INNER_MASS] = 0.074,
    gravity: Annotated[Any, GRAVITY] = 9.81,
) -> Robot:
    """A capsubot: a coil inside the body, switched on for a part of each period, pushes a magnet on a spring.

    Masses, stiffness, friction and pulses are those with which the published model of a vibration-driven robot with an electromagnet moves
    backwards at 9.19 mm/s (Nunuparov, Becker, Bolotnik, Zeidis, Zimmermann, Arch. Appl. Mech. 89 (2019) 2193-2208). It has no damper.

    Parameters
    ----------
    pulse : float or array
        Force of the coil on the magnet while it is on, forwards [N].
    pulse_period : float or array
        Period of the pulses [s].
    duty : float or array
        Fraction of the period for which it is on, between 0 and 1 [-].
    stiffness, damper : float or array
        Stiffness and damping between magnet and body [N/m], [N s/m].
    mu : float or array
        Friction coefficient of body and track, the same both ways and at rest [-].
    body_mass, inner_mass : float or array
        Masses of the body and of the magnet [kg].
    gravity : float or array
        Acceleration of gravity [m/s^2].

    Returns
    -------
    Robot

    Examples
    --------
    >>> import stickslip as ss
    >>> print(f"{ss.mean_velocity(ss.solve(capsubot(), periods=200)) * 1e3:.6f} mm/s")
    -9.192936 mm/s
    """
    drive = Forced(Pulses(pulse, period=pulse_period, duty=duty), stiffness=stiffness, damping=damper)
    return Robot(body_mass, inner_mass, drive, Coulomb(mu_plus=mu, mu_minus=mu), gravity=gravity)


@explains_arguments
def capsule(
    force_ratio: Annotated[Any, quantity("force over sliding friction", "1", r"\alpha", example=1.6)] = 1.6,
    omega: Annotated[Any, quantity("angular frequency over the natural one", "1", r"\omega", example=0.95)] = 0.95,
    damping_ratio: Annotated[Any, quantity("damping ratio", "1", r"\xi", example=0.05, rule=at_least(0.0))] = 0.05,
    gap: Annotated[Any, quantity("gap of the stop", "1", r"\delta", example=0.02)] = 0.02,
    stop_stiffness: Annotated[Any, quantity("stiffness of the stop over that of the spring", "1", r"\beta", example=15.0)] = 15.0,
    mass_ratio: Annotated[Any, quantity("mass of the capsule over the inner mass", "1", r"\gamma", example=5.0, rule=positive)] = 5.0,
    reaction: bool = False,
) -> Robot:
    r"""A dimensionless vibro-impact capsule: a force drives the inner mass, which hits an elastic stop in front of it.

    .. math::

        x_1'' &= \alpha\cos\omega\tau + (x_2-x_1) + 2\xi(x_2'-x_1') - C, \qquad C = \beta\,\max(x_1-x_2-\delta,\,0) \\
        \gamma x_2'' &= -(x_2-x_1) - 2\xi(x_2'-x_1') + C - R, \qquad |R| \le 1

    All its units are 1: inner mass, stiffness of the spring and sliding friction. The groups are those of Liu, Pavlovskaia, Hendry,
    Wiercigroch, Int. J. Mech. Sci. 72 (2013) 39-54; the numbers are set from memory of that work, and the results are ours.

    Parameters
    ----------
    force_ratio : float or array
        Force over sliding friction, alpha [-].
    omega : float or array
        Its angular frequency over the natural one, omega [-].
    damping_ratio : float or array
        xi [-].
    gap : float or array
        Gap of the stop in front of the inner mass, delta [-].
    stop_stiffness : float or array
        Stiffness of the stop over that of the spring, beta [-].
    mass_ratio : float or array
        Mass of the capsule over the inner mass, gamma [-].
    reaction : bool
        Whether the capsule feels the reaction of the force; not in that work.

    Returns
    -------
    Robot

    Examples
    --------
    >>> import stickslip as ss
    >>> forwards, back = (ss.solve(capsule(mass_ratio=ratio), periods=300, settle=200) for ratio in (5.0, 2.0))
    >>> print(f"{ss.mean_velocity(forwards):.9f}", ss.mean_velocity(back) < 0)
    0.165538437 True
    """
    n = checked_numbers(capsule, damping_ratio=damping_ratio, mass_ratio=mass_ratio)
    damping, ratio = n["damping_ratio"], n["mass_ratio"]
    force = HarmonicForce(force_ratio, omega, phase=0.5 * math.pi)
    drive = Forced(force, stiffness=1.0, damping=2 * damping, stops=(Stop(gap=gap, stiffness=stop_stiffness),), reaction=reaction)
    one = 1 / (ratio + 1)  # of both masses' weight
    return Robot(ratio, 1.0, drive, Coulomb(mu_plus=one, mu_minus=one), gravity=1.0)
