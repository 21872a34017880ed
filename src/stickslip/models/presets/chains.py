"""Modules joined by springs, and worms."""

from __future__ import annotations

import math
from typing import Annotated, Any

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.quantities import (
    AMPLITUDE,
    BODY_MASS,
    DAMPING,
    FREQUENCY,
    INNER_MASS,
    LENGTH,
    MASS,
    OMEGA,
    PHASE,
    STIFFNESS,
    quantity,
)
from stickslip.models.drives import Harmonic
from stickslip.models.friction import Coulomb
from stickslip.models.friction.coefficients import MU_MINUS, MU_PLUS
from stickslip.models.machines import Bodies, Chain, Gait, Spring
from stickslip.models.robot import Robot


@explains_arguments
def two_modules(
    phase: Annotated[Any, PHASE | {"label": "phase of the second module"}] = math.pi,
    stiffness: Annotated[Any, STIFFNESS] = 1200.0,
    damping: Annotated[Any, DAMPING] = 0.4,
    amplitude: Annotated[Any, AMPLITUDE] = 6e-4,
    omega: Annotated[Any, OMEGA] = 65.4 * math.pi,
    mu_plus: Annotated[Any, MU_PLUS] = 0.15,
    mu_minus: Annotated[Any, MU_MINUS] = 0.21,
    body_mass: Annotated[Any, BODY_MASS] = 62.59e-3,
    inner_mass: Annotated[Any, INNER_MASS] = 9.48e-3,
) -> Chain:
    """Two robots joined by a spring, the second driven with a phase lead.

    Masses and drive are those of the founding paper's robot, friction differs forwards and backwards under Coulomb's law, and the spring is
    our choice, near the resonance of the two against each other: in antiphase they move 4.7 times as fast as one of them.

    Parameters
    ----------
    phase : float or array
        Phase lead of the second over the first, which is the head [rad].
    stiffness, damping : float or array
        Of the spring between them [N/m], [N s/m].
    amplitude, omega : float or array
        Of the inner masses [m], [rad/s].
    mu_plus, mu_minus : float or array
        Friction coefficients forwards and backwards [-].
    body_mass, inner_mass : float or array
        Of each module [kg].

    Returns
    -------
    Chain

    Examples
    --------
    >>> import stickslip as ss
    >>> apart, together = (ss.mean_velocity(ss.solve(ss.presets.two_modules(phase), periods=200)) for phase in (math.pi, 0.0))
    >>> print(f"{apart * 1e3:.6f} mm/s in antiphase, {together * 1e3:.6f} mm/s in phase")
    11.119896 mm/s in antiphase, 2.383491 mm/s in phase
    """
    friction = Coulomb(mu_plus=mu_plus, mu_minus=mu_minus)
    module = Robot(body_mass=body_mass, inner_mass=inner_mass, drive=Harmonic(amplitude=amplitude, omega=omega), friction=friction)
    return Chain((module, module), link=Spring(stiffness=stiffness, damping=damping), phases=(0.0, phase))


@explains_arguments
def worm(
    amplitude: Annotated[Any, quantity("amplitude of the distances", "m", "A", example=2e-3)] = 2e-3,
    frequency: Annotated[Any, FREQUENCY] = 2.0,
    lag: Annotated[Any, quantity("lag of the wave", "rad", r"\delta", example=2.0944)] = 2 * math.pi / 3,
    count: int = 3,
    mass: Annotated[Any, MASS] = 0.05,
    mu_plus: Annotated[Any, MU_PLUS] = 0.1,
    mu_minus: Annotated[Any, MU_MINUS] = 0.3,
    length: Annotated[Any, LENGTH] = 0.05,
) -> Chain:
    r"""A peristaltic worm: masses whose mutual distances carry a wave from head to tail.

    The numbers are our choice. With three masses and a lag of a third of a period one mass is always at rest, and the worm moves by
    three amplitudes per period, as long as its inertia does not make this mass slip:

    .. math:: V = 3 a f \quad\text{for}\quad \mu_- \ge 2\mu_+, \quad \tfrac32 a\omega^2 \le (\mu_- - 2\mu_+) g

    Parameters
    ----------
    amplitude, frequency : float or array
        Amplitude and frequency of each distance between neighbours [m], [Hz].
    lag : float or array
        Phase lag of each distance behind the preceding one [rad].
    count : int
        Number of masses.
    mass : float or array
        Of each [kg].
    mu_plus, mu_minus : float or array
        Friction coefficients forwards and backwards [-].
    length : float or array
        Mean distance between neighbours [m].

    Returns
    -------
    Chain

    Examples
    --------
    >>> import stickslip as ss
    >>> round(ss.mean_velocity(ss.solve(ss.presets.worm(), periods=20)), 12)
    0.012
    """
    bodies = Bodies(mass=mass, count=count, friction=Coulomb(mu_plus=mu_plus, mu_minus=mu_minus))
    return Chain(bodies, link=Gait(Harmonic(amplitude=amplitude, frequency=frequency), lag=lag, length=length))
