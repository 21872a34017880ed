"""Joints of robots."""

from __future__ import annotations

import math
from typing import Annotated, Any

from stickslip.basics.arguments import checked_numbers, explains_arguments
from stickslip.basics.fields import described_by
from stickslip.basics.quantities import GRAVITY, at_least, positive, quantity
from stickslip.models.drives import HarmonicForce
from stickslip.models.friction import Coulomb
from stickslip.models.machines import PID, Joint, Motor, ServoLoad


@explains_arguments
def servo(
    target: Annotated[Any, described_by(PID, "target")] = 0.5,
    kp: Annotated[Any, described_by(PID, "kp")] = 1.0,
    ki: Annotated[Any, described_by(PID, "ki")] = 2.0,
    kd: Annotated[Any, described_by(PID, "kd")] = 0.04,
    sample: Annotated[Any, described_by(PID, "sample")] = None,
    static: Annotated[Any, quantity("static friction over kinetic friction", "1", "s", example=2.0, rule=at_least(1.0))] = 2.0,
    compensation: Annotated[Any, quantity("part of the friction that is compensated", "1", "q", example=1.0)] = 0.0,
    backlash: Annotated[Any, quantity("backlash", "rad", "b", example=0.01)] = 0.0,
) -> Joint:
    """A small servo: a geared motor that turns an arm under a PID controller. Its parameters are our choice, typical of a hobby servo.

    The kinetic friction torque of the joint is 0.05 N m. With more static friction and integral action it hunts about its target.

    Parameters
    ----------
    target : float, Harmonic or another drive, or tuple of array
        Target angle [rad].
    kp, ki, kd : float or array
        Gains at the joint, 50 (the gear ratio) times those at the motor [N m/rad, N m/(rad s), N m s/rad].
    sample : float, optional
        Sampling time of the controller [s]; if not given, it acts continuously.
    static : float or array
        Ratio of static to kinetic friction, 1 or more.
    compensation : float or array
        Friction compensation: the fraction of the kinetic friction that the controller adds in the direction of its target's motion.
    backlash : float or array
        Play of the gear at the joint [rad].

    Returns
    -------
    Joint

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(servo(), duration=20.0)
    >>> round(float(max(abs(0.5 - run.x[run.t > 10.0]))), 3)  # it hunts about its target [rad]
    0.038
    """
    ratio, kinetic = 50.0, 0.05
    n = checked_numbers(servo, kp=kp, ki=ki, kd=kd, static=static, compensation=compensation)
    gains = {name: n[name] / ratio for name in ("kp", "ki", "kd")}
    pid = PID(**gains, target=target, sample=sample, feedforward=n["compensation"] * kinetic / ratio)
    friction = Coulomb(mu_plus=kinetic, mu_minus=kinetic, f_plus=n["static"] * kinetic, f_minus=n["static"] * kinetic)
    return Joint(inertia=2e-3, friction=friction, gear_ratio=ratio, motor_inertia=4e-7, backlash=backlash, control=pid)


#: MX-106 by M6, from the parameter sets of BAM (https://github.com/Rhoban/bam, Apache-2.0).
_MX106: dict[str, Any] = {
    "kt": 2.209828156174588, "R": 2.033661749312417, "armature": 0.026016184370993383, "model": "m6",
    "friction_base": 1.0232526438525893e-05, "friction_viscous": 0.05071566473605552, "friction_stribeck": 0.12195409579603411,
    "load_friction_motor": 0.19800553725822115, "load_friction_external": 0.022215529897348624,
    "load_friction_motor_stribeck": 0.19859970173941574, "load_friction_external_stribeck": 0.08710328264676681,
    "load_friction_motor_quad": 0.009999930103371748, "load_friction_external_quad": 7.326919843140997e-05,
    "dtheta_stribeck": 1.7463251741328727, "alpha": 1.142827788004191,
}  # fmt: skip


@explains_arguments
def gear_joint(
    voltage: Annotated[Any, quantity("amplitude of the voltage", "V", "U", example=4.0, rule=at_least(0.0))] = 4.0,
    frequency: Annotated[Any, quantity("frequency of the voltage", "Hz", "f", example=0.25, rule=positive)] = 0.25,
    mass: Annotated[Any, quantity("mass at the end of the arm", "kg", "m", example=0.5, rule=at_least(0.0))] = 0.5,
    length: Annotated[Any, quantity("length of the arm", "m", "L", example=0.15, rule=positive)] = 0.15,
    gravity: Annotated[Any, GRAVITY] = 9.81,
) -> Joint:
    """A geared servo, Dynamixel's MX-106, that swings a mass; its friction is M6, which tells driving from being driven back.

    Motor, inertia and friction are those that M. Duclusaud, G. Passault, V. Padois and O. Ly identified (arXiv:2410.08650); see
    `stickslip.machines.ServoLoad`.

    Parameters
    ----------
    voltage, frequency : float or array
        Amplitude and frequency of the voltage at the motor [V], [Hz].
    mass : float or array
        At the end of the arm [kg].
    length : float or array
        Of the arm, which has no mass [m].
    gravity : float or array
        Acceleration of gravity [m/s^2].

    Returns
    -------
    Joint

    Examples
    --------
    >>> import stickslip as ss
    >>> joint = ss.presets.gear_joint()
    >>> run = ss.solve(joint, periods=5)
    >>> joint.load.model, bool((run.contacts["joint"].mode == 0).any())
    ('m6', True)
    """
    n = checked_numbers(gear_joint, frequency=frequency, mass=mass, length=length, gravity=gravity)
    m, arm = n["mass"], n["length"]
    return Joint(
        inertia=_MX106["armature"] + m * arm**2, friction=Coulomb(1.0, 1.0), gravity_torque=m * n["gravity"] * arm,
        motor=Motor(_MX106["kt"], resistance=_MX106["R"], supply=12.0), load=ServoLoad.from_bam(_MX106),
        voltage=HarmonicForce(voltage, omega=2 * math.pi * n["frequency"]),
    )  # fmt: skip
