"""Robots and benches whose bodies move in the plane."""

from __future__ import annotations

import math
from typing import Annotated, Any

from stickslip.basics.arguments import checked_numbers, explains_arguments
from stickslip.basics.errors import InputError, is_one_of
from stickslip.basics.fields import described_by
from stickslip.basics.quantities import GRAVITY, Rule, at_least, positive, quantity
from stickslip.models.friction import Coulomb, CoulombViscous
from stickslip.models.friction.coefficients import MU
from stickslip.models.machines.block_on_wedge import BlockOnWedge
from stickslip.models.machines.bristle_bot import BristleBot, Lubricated
from stickslip.models.machines.cart_pole import CartPole
from stickslip.models.machines.mode_coupling import ModeCoupling
from stickslip.models.machines.sliding_rod import SlidingRod
from stickslip.models.machines.two_link_arm import TwoLinkArm

_BELOW_90 = Rule(lambda angle: (angle > 0) & (angle < 90), "above 0 and below 90 degrees")
_WITHIN_90 = Rule(lambda angle: abs(angle) < 90, "between -90 and 90 degrees")
_PUSHED = quantity("frequency of the push", "Hz", "f", example=0.8, rule=positive)
_DEGREES = math.pi / 180


@explains_arguments
def bristle_bot(
    frequency: Annotated[Any, quantity("frequency of the rotor", "Hz", "f", example=15.0, rule=positive)] = 15.0,
    unbalance: Annotated[Any, described_by(BristleBot, "unbalance")] = 1e-6,
    drag: Annotated[Any, described_by(Lubricated, "mu")] = None,
    mu: Annotated[Any, MU] = None,
    tilt_deg: Annotated[Any, quantity("tilt of the bristles", "degrees", r"\alpha", example=25.0, rule=_BELOW_90)] = 25.0,
    length: Annotated[Any, described_by(BristleBot, "length")] = 0.01,
    stiffness: Annotated[Any, described_by(BristleBot, "stiffness")] = 0.015,
    damping: Annotated[Any, described_by(BristleBot, "damping")] = 2e-5,
    mass: Annotated[Any, quantity("mass with the rotor", "kg", "m", example=0.02, rule=positive)] = 0.02,
    along: Annotated[Any, described_by(BristleBot, "along")] = 0.0,
    gravity: Annotated[Any, GRAVITY] = 9.81,
    law: str = "lubricated",
) -> BristleBot:
    """A bristle-bot: the head of a toothbrush with the motor of a pager, which goes backwards slowly and forwards fast.

    The model is Cicconofri and DeSimone's (Int. J. Non-Linear Mech. 76 (2015) 233-239); its numbers are ours, of the size of a toothbrush.
    Under lubricated friction it turns round at `bristle_bot().reversal`, a frequency that does not depend on the rotor.

    Parameters
    ----------
    frequency : float or array
        Turns of the rotor in a second [Hz].
    unbalance : float or array
        Mass of the rotor times the distance of its centre of mass from its axis [kg m].
    drag : float or array
        Of "lubricated": friction for each newton of load and each m/s, 1 where it is not given [s/m].
    mu : float or array
        Of "coulomb": friction coefficient, the same both ways and at rest, 0.3 where it is not given [-].
    tilt_deg : float or array
        Angle of the bristles from the vertical while the robot stands [degrees].
    length : float or array
        Length of the bristles [m].
    stiffness, damping : float or array
        Of all bristles together [N m/rad], [N m s/rad].
    mass : float or array
        Mass with the rotor [kg].
    along : float or array
        Part of the rotor's force that acts along the track too: 0 is a vertical beat, 1 one rotor.
    gravity : float or array
        Acceleration of gravity [m/s^2].
    law : {"lubricated", "coulomb"}
        Friction of the tips.

    Returns
    -------
    BristleBot

    Examples
    --------
    >>> import stickslip as ss
    >>> print(f"it turns round at {bristle_bot().reversal / (2 * math.pi):.4f} Hz")
    it turns round at 9.5379 Hz
    >>> [ss.periodic_orbit(bristle_bot(frequency)).mean_velocity > 0 for frequency in (8.0, 15.0)]
    [False, True]
    """
    if not is_one_of(law, ("lubricated", "coulomb")):
        allowed = 'allowed are "lubricated" and "coulomb"; for another one type .replace(friction=...)'
        raise InputError("bristle_bot", [f"law = {law!r}; {allowed}"])
    n = checked_numbers(bristle_bot, frequency=frequency, tilt_deg=tilt_deg)
    name, value, other = ("mu", mu, "coulomb") if law == "lubricated" else ("drag", drag, "lubricated")
    if value is not None:
        raise InputError("bristle_bot", [f'{name} = {value!r} is of other friction than law="{law}"; leave it out, or type law="{other}"'])
    mu = 0.3 if mu is None else mu
    friction = Lubricated(1.0 if drag is None else drag) if law == "lubricated" else Coulomb(mu, mu)
    omega = 2 * math.pi * n["frequency"]
    return BristleBot(mass, length, _DEGREES * n["tilt_deg"], stiffness, damping, unbalance, omega, friction, along, gravity)


@explains_arguments
def cart_pole(
    push: Annotated[Any, described_by(CartPole, "push")] = 3.0,
    frequency: Annotated[Any, _PUSHED] = 0.5,
    mu: Annotated[Any, MU] = 0.1,
    cart: Annotated[Any, described_by(CartPole, "cart")] = 1.0,
    bob: Annotated[Any, described_by(CartPole, "bob")] = 0.3,
    length: Annotated[Any, described_by(CartPole, "length")] = 0.5,
    stiffness: Annotated[Any, described_by(CartPole, "stiffness")] = None,
    damping: Annotated[Any, described_by(CartPole, "damping")] = 0.0,
    gravity: Annotated[Any, GRAVITY] = 9.81,
) -> CartPole:
    """A pendulum on a cart with friction on its rail, pushed to and fro; the swing decides how strongly the cart presses on the rail.

    Its numbers are ours, of the size of the carts of laboratories.

    Parameters
    ----------
    push, frequency : float or array
        Amplitude and frequency of the force on the cart [N], [Hz].
    mu : float or array
        Friction coefficient of the rail, the same both ways and at rest [-].
    cart, bob : float or array
        Masses [kg].
    length : float or array
        From the hinge to the bob [m].
    stiffness, damping : float or array
        Of a spring that holds the cart, if any [N/m], [N s/m].
    gravity : float or array
        Acceleration of gravity [m/s^2].

    Returns
    -------
    CartPole

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.cart_pole(push=0.0), duration=4.0, start={"x": {"angle": 1.5}})
    >>> print(f"the rail bears {run.load.min():.1f} to {run.load.max():.1f} N; the weight is {1.3 * 9.81:.1f} N")
    the rail bears 9.8 to 19.0 N; the weight is 12.8 N
    """
    n = checked_numbers(cart_pole, frequency=frequency)
    return CartPole(cart, bob, length, Coulomb(mu, mu), push, 2 * math.pi * n["frequency"], stiffness, damping, gravity)


@explains_arguments
def block_on_wedge(
    slope_deg: Annotated[Any, quantity("slope of the face", "degrees", r"\alpha", example=20.0, rule=_WITHIN_90)] = 20.0,
    mu: Annotated[Any, MU] = 0.5,
    wedge: Annotated[Any, described_by(BlockOnWedge, "wedge")] = 2.0,
    block: Annotated[Any, described_by(BlockOnWedge, "block")] = 0.5,
    push: Annotated[Any, described_by(BlockOnWedge, "push")] = 4.0,
    frequency: Annotated[Any, _PUSHED] = 1.5,
    stiffness: Annotated[Any, described_by(BlockOnWedge, "stiffness")] = 20.0,
    damping: Annotated[Any, described_by(BlockOnWedge, "damping")] = 4.0,
    gravity: Annotated[Any, GRAVITY] = 9.81,
) -> BlockOnWedge:
    """A block on a wedge that is shaken on a spring: it creeps down a slope that it would rest on. Free, it is the textbook's example.

    Its numbers are ours. ``block_on_wedge(mu=0.2, push=0.0, stiffness=None, damping=0.0)`` is the wedge that goes back as the block slides.

    Parameters
    ----------
    slope_deg : float or array
        Angle of the face below the horizontal, forwards [degrees].
    mu : float or array
        Friction coefficient of the face, the same both ways and at rest [-].
    wedge, block : float or array
        Masses [kg].
    push, frequency : float or array
        Amplitude and frequency of the force on the wedge [N], [Hz].
    stiffness, damping : float or array
        Of a spring that holds the wedge, or None [N/m], [N s/m].
    gravity : float or array
        Acceleration of gravity [m/s^2].

    Returns
    -------
    BlockOnWedge

    Examples
    --------
    >>> import numpy as np
    >>> import stickslip as ss
    >>> shaken = block_on_wedge()
    >>> run = ss.solve(shaken, periods=60)
    >>> at = run.at(shaken.period * np.array([50.0, 60.0]))["x"][:, 1]
    >>> print(f"it creeps down by {(at[1] - at[0]) * 100:.4f} mm in each period")
    it creeps down by 15.6967 mm in each period
    """
    n = checked_numbers(block_on_wedge, slope_deg=slope_deg, frequency=frequency)
    omega = 2 * math.pi * n["frequency"]
    return BlockOnWedge(wedge, block, _DEGREES * n["slope_deg"], Coulomb(mu, mu), push, omega, stiffness, damping, gravity)


@explains_arguments
def sliding_rod(
    mu: Annotated[Any, MU] = 0.3,
    length: Annotated[Any, described_by(SlidingRod, "length")] = 1.0,
    mass: Annotated[Any, quantity("mass", "kg", "m", example=1.0, rule=positive)] = 1.0,
    push: Annotated[Any, described_by(SlidingRod, "push")] = 8.0,
    frequency: Annotated[Any, _PUSHED] = 0.8,
    gravity: Annotated[Any, GRAVITY] = 9.81,
) -> SlidingRod:
    """A uniform rod that slides on its foot, Painlevé's: from a friction coefficient of 4/3 on sliding is inconsistent at some angles.

    Parameters
    ----------
    mu : float or array
        Friction coefficient, the same both ways and at rest [-].
    length : float or array
        Length [m].
    mass : float or array
        Mass [kg].
    push, frequency : float or array
        Amplitude and frequency of a force on the foot [N], [Hz].
    gravity : float or array
        Acceleration of gravity [m/s^2].

    Returns
    -------
    SlidingRod

    Examples
    --------
    >>> import stickslip as ss
    >>> start = {"x": {"angle": 1.5}, "v": {"x": 3.0, "angle": -1.0}}
    >>> run = ss.solve(ss.presets.sliding_rod(mu=1.5, push=0.0), duration=0.5, start=start)
    >>> print(f"it ends at {math.degrees(run.coordinates['angle'][-1]):.6f} degrees")
    it ends at 73.048469 degrees
    """
    n = checked_numbers(sliding_rod, frequency=frequency)
    return SlidingRod(mass, length, Coulomb(mu, mu), push, 2 * math.pi * n["frequency"], gravity)


@explains_arguments
def two_link_arm(
    shoulder_torque: Annotated[Any, described_by(TwoLinkArm, "shoulder_torque")] = 25.0,
    elbow_torque: Annotated[Any, described_by(TwoLinkArm, "elbow_torque")] = 2.5,
    frequency: Annotated[Any, quantity("frequency of the torques", "Hz", "f", example=0.25, rule=positive)] = 0.25,
    friction: Annotated[Any, quantity("friction over that of the robot", "1", "s", example=1.0, rule=at_least(0.0))] = 1.0,
    gravity: Annotated[Any, GRAVITY] = 9.81,
) -> TwoLinkArm:
    """An arm of two links with friction in both joints: the direct-drive robot of CICESE, whose parameters were identified.

    F. Reyes and R. Kelly, Experimental evaluation of model-based controllers on a direct-drive robot arm, Mechatronics 11 (2001)
    267-282: masses of 23.902 and 3.880 kg, 0.45 m from joint to joint, friction torques of 7.17 N m forwards and 8.049 N m backwards at the
    shoulder and of 1.734 N m at the elbow, with 2.288 and 0.175 N m s/rad.

    Parameters
    ----------
    shoulder_torque, elbow_torque, frequency : float or array
        Amplitudes and frequency of the torques of its motors, which give 150 and 15 N m at most [N m], [Hz].
    friction : float or array
        All friction torques, as parts of those of the robot [-].
    gravity : float or array
        Acceleration of gravity [m/s^2].

    Returns
    -------
    TwoLinkArm

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.two_link_arm(), periods=10)
    >>> [name for name, joint in run.contacts.items() if (joint.mode == 0).any()]
    ['shoulder', 'elbow']
    """
    n = checked_numbers(two_link_arm, frequency=frequency, friction=friction)
    s = n["friction"]
    shoulder = CoulombViscous(7.17 * s, 8.049 * s, viscous=2.288 * s)
    elbow = CoulombViscous(1.734 * s, 1.734 * s, viscous=0.175 * s)
    omega = 2 * math.pi * n["frequency"]
    return TwoLinkArm(
        23.902, 3.88, 0.45, 0.091, 0.048, 1.266, 0.093, shoulder, elbow, shoulder_torque, elbow_torque, omega, gravity
    )  # fmt: skip


@explains_arguments
def mode_coupling(
    mu: Annotated[Any, MU] = 0.5,
    damping: Annotated[Any, described_by(ModeCoupling, "damping")] = 0.1,
    preload: Annotated[Any, described_by(ModeCoupling, "preload")] = 10.0,
    speed: Annotated[Any, described_by(ModeCoupling, "speed")] = -0.1,
) -> ModeCoupling:
    """Hoffmann's minimal model of brake squeal: two modes of a pad flutter, under friction that does not fall with velocity.

    The equations are those of Hoffmann, Fischer, Allgaier and Gaul (Mech. Res. Commun. 29 (2002) 197-205); the numbers are ours, of the
    size that is usual with them: m = 1, springs of 11 and 20 at 150 and 30 degrees, and 11 of the contact, with a damping and a speed at
    which the pad squeals without leaving the belt.

    Parameters
    ----------
    mu : float or array
        Friction coefficient, the same both ways and at rest [-].
    damping : float or array
        In both directions [N s/m].
    preload : float or array
        Force that presses the pad down [N].
    speed : float or array
        Velocity of the belt [m/s].

    Returns
    -------
    ModeCoupling

    Examples
    --------
    >>> import stickslip as ss
    >>> pad = mode_coupling()
    >>> orbit = ss.periodic_orbit(pad, guess=ss.solve(pad, duration=100.0))
    >>> print(f"it squeals above {pad.critical:.4f}, with {1 / orbit.run.t[-1]:.4f} Hz")
    it squeals above 0.4773, with 0.6863 Hz
    """
    return ModeCoupling(1.0, 11.0, 20.0, 150 * _DEGREES, 30 * _DEGREES, 11.0, preload, speed, Coulomb(mu, mu), damping)
