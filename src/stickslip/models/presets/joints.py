"""Joints of robots."""

from __future__ import annotations

from typing import Annotated, Any

from stickslip.basics.arguments import checked_arguments, explains_arguments
from stickslip.basics.errors import Problems
from stickslip.basics.fields import described_by
from stickslip.basics.quantities import at_least, quantity
from stickslip.models.friction import Coulomb
from stickslip.models.machines import PID, Joint


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
    problems, ratio, kinetic = Problems("servo"), 50.0, 0.05
    n = checked_arguments(servo, {"kp": kp, "ki": ki, "kd": kd, "static": static, "compensation": compensation}, problems)
    problems.check()
    gains = {name: n[name] / ratio for name in ("kp", "ki", "kd")}
    pid = PID(**gains, target=target, sample=sample, feedforward=n["compensation"] * kinetic / ratio)
    friction = Coulomb(mu_plus=kinetic, mu_minus=kinetic, f_plus=n["static"] * kinetic, f_minus=n["static"] * kinetic)
    return Joint(inertia=2e-3, friction=friction, gear_ratio=ratio, motor_inertia=4e-7, backlash=backlash, control=pid)
