"""Robots and blocks in the plane: what hops, and what rocks."""

from __future__ import annotations

from typing import Annotated, Any

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.quantities import GRAVITY, positive, quantity
from stickslip.models.friction import Coulomb
from stickslip.models.friction.coefficients import MU
from stickslip.models.machines.shaken_box import RESTITUTION, ShakenBox


@explains_arguments
def hopping_robot(
    ratio: Annotated[Any, quantity("force of the rotor over the weight", "1", r"\gamma", example=1.5, rule=positive)] = 1.5,
    frequency: Annotated[Any, quantity("frequency of the rotor", "Hz", "f", example=15.0, rule=positive)] = 15.0,
    mu: Annotated[Any, MU] = 0.3,
    restitution: Annotated[Any, RESTITUTION] = 0.0,
    mass: Annotated[Any, quantity("mass", "kg", "m", example=0.1, rule=positive)] = 0.1,
    gravity: Annotated[Any, GRAVITY] = 9.81,
) -> ShakenBox:
    """A box with an unbalanced rotor on one foot, which hops once the rotor's force is larger than the weight.

    Its numbers are those of no built robot, but of the size of those with the motor of a toothbrush.

    Parameters
    ----------
    ratio : float or array
        Force of the rotor over the weight [-]; above 1 the robot hops.
    frequency : float or array
        Turns of the rotor in a second [Hz].
    mu : float or array
        Friction coefficient, the same both ways and at rest [-].
    restitution : float or array
        Newton's coefficient of restitution of a landing [-].
    mass : float or array
        Mass with the rotor [kg].
    gravity : float or array
        Acceleration of gravity [m/s^2].

    Returns
    -------
    ShakenBox

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(hopping_robot(), periods=60)
    >>> run.status, ss.hops(run).landings > 0
    ('finished', True)
    """
    omega = 6.283185307179586 * frequency
    return ShakenBox(mass, ratio * mass * gravity / (omega * omega), omega, Coulomb(mu, mu), restitution, gravity=gravity)


@explains_arguments
def rocking_block(
    width: Annotated[Any, quantity("width", "m", "b", example=0.2, rule=positive)] = 0.2,
    height: Annotated[Any, quantity("height", "m", "H", example=1.0, rule=positive)] = 1.0,
    mu: Annotated[Any, MU] = 1.0,
    restitution: Annotated[Any, RESTITUTION] = 0.0,
    mass: Annotated[Any, quantity("mass", "kg", "m", example=1.0, rule=positive)] = 1.0,
    gravity: Annotated[Any, GRAVITY] = 9.81,
) -> ShakenBox:
    """Housner's block: it rocks from corner to corner, and each hit takes some of its rate, until it stands.

    With enough friction and without restitution each hit leaves 1 - 3/2 sin(a)^2 of the rate, where tan(a) = width/height (Housner, Bull.
    Seismol. Soc. Am. 53 (1963) 403-417). `block.tilted(0.1)` is a start on one corner.

    Parameters
    ----------
    width, height : float or array
        Size [m].
    mu : float or array
        Friction coefficient, the same both ways and at rest [-].
    restitution : float or array
        Newton's coefficient of restitution of a corner [-].
    mass : float or array
        Mass [kg].
    gravity : float or array
        Acceleration of gravity [m/s^2].

    Returns
    -------
    ShakenBox

    Examples
    --------
    >>> import stickslip as ss
    >>> block = rocking_block()
    >>> [event.part for event in ss.solve(block, duration=2.0, start=block.tilted(0.1)).events if event.kind == "landing"]
    ['left', 'right', 'left', 'right']
    """
    return ShakenBox(mass, 0.0, 6.283185307179586, Coulomb(mu, mu), restitution, width, height, gravity)
