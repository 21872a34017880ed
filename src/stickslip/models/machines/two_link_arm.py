"""An arm of two links with friction in both joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import cos, sin
from stickslip.basics.quantities import GRAVITY, positive, quantity
from stickslip.models.machines.in_the_plane import InThePlane
from stickslip.models.machines.parts import Body, Contact


def _mass(which: str, symbol: str, example: float) -> dict[str, Any]:
    return quantity(f"mass of the {which} link", "kg", symbol, example=example, rule=positive)


def _centre(which: str, symbol: str, example: float) -> dict[str, Any]:
    return quantity(f"centre of mass of the {which} link, from its joint", "m", symbol, example=example)


def _inertia(which: str, symbol: str, example: float) -> dict[str, Any]:
    return quantity(f"moment of inertia of the {which} link", "kg m^2", symbol, example=example, rule=positive)


def _torque(joint: str, symbol: str, example: float) -> dict[str, Any]:
    return quantity(f"torque at the {joint}", "N m", symbol, example=example)


@dataclass(frozen=True, eq=False)
class TwoLinkArm(InThePlane):
    r"""An arm of two links that turn in a vertical plane, with friction in both joints and torques that swing.

    .. math:: M(q)\ddot q + C(q, \dot q)\dot q + g(q) = \tau\sin\omega t - R(\dot q)

    .. math:: M_{11} = J_1 + m_1 c_1^2 + J_2 + m_2(\ell_1^2 + c_2^2 + 2\ell_1 c_2\cos q_2), \quad
              M_{12} = J_2 + m_2(c_2^2 + \ell_1 c_2\cos q_2), \quad M_{22} = J_2 + m_2 c_2^2

    Coordinates are the angles `shoulder`, which hangs at 0, and `elbow`, of the lower link against the upper one.

    Parameters
    ----------
    upper, lower : float
        Masses m_1 and m_2 of the links [kg].
    length : float
        Length of the upper link, from joint to joint [m].
    upper_centre, lower_centre : float
        Places c_1 and c_2 of their centres of mass, from their joints [m].
    upper_inertia, lower_inertia : float
        Moments of inertia J_1 and J_2 about their centres of mass [kg m^2].
    shoulder, elbow : Coulomb, CoulombViscous or any law
        Friction laws of the joints; their load is 1, so that coefficients are torques [N m].
    shoulder_torque, elbow_torque, omega : float
        Amplitudes and angular frequency of the torques of the motors [N m], [rad/s].
    gravity : float
        Acceleration of gravity [m/s^2].

    References
    ----------
    M. W. Spong and M. Vidyasagar, Robot Dynamics and Control, Wiley 1989, section 6.4: the matrices of the planar elbow manipulator.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.Coulomb(mu_plus=1.6, mu_minus=1.6)
    >>> arm = TwoLinkArm(1.2, 0.8, 0.5, 0.25, 0.2, 0.03, 0.02, law, law, shoulder_torque=6.0, omega=3.0)
    >>> run = ss.solve(arm, periods=3)
    >>> [bool((run.contacts[name].mode == 0).any()) for name in ("shoulder", "elbow")]
    [True, True]
    """

    upper: float = field(metadata=_mass("upper", "m_{1}", 23.902))
    lower: float = field(metadata=_mass("lower", "m_{2}", 3.88))
    length: float = field(metadata=quantity("length of the upper link", "m", r"\ell_{1}", example=0.45, rule=positive))
    upper_centre: float = field(metadata=_centre("upper", "c_{1}", 0.091))
    lower_centre: float = field(metadata=_centre("lower", "c_{2}", 0.048))
    upper_inertia: float = field(metadata=_inertia("upper", "J_{1}", 1.266))
    lower_inertia: float = field(metadata=_inertia("lower", "J_{2}", 0.093))
    shoulder: Any
    elbow: Any
    shoulder_torque: float = field(default=0.0, metadata=_torque("shoulder", r"\tau_{1}", 40.0))
    elbow_torque: float = field(default=0.0, metadata=_torque("elbow", r"\tau_{2}", 5.0))
    omega: float = field(default=3.0, metadata=quantity("angular frequency of the torques", "rad/s", r"\omega", example=3.0, rule=positive))
    gravity: float = field(default=9.81, metadata=GRAVITY)

    kind: ClassVar[str] = "two_link_arm"  # its name in a study file
    coordinates: ClassVar[tuple[str, ...]] = ("shoulder", "elbow")
    _laws: ClassVar[tuple[str, ...]] = ("shoulder", "elbow")

    def bodies(self) -> Mapping[str, Any]:
        """The two links."""
        return {"upper": Body(self.upper, inertia=self.upper_inertia), "lower": Body(self.lower, inertia=self.lower_inertia)}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """Their centres of mass, and their angles from the vertical."""
        a, b = q["shoulder"], q["shoulder"] + q["elbow"]
        x, z = self.length * sin(a), -self.length * cos(a)
        return {
            "upper": (self.upper_centre * sin(a), -self.upper_centre * cos(a), a),
            "lower": (x + self.lower_centre * sin(b), z - self.lower_centre * cos(b), b),
        }

    def outlines(self, t: Any, q: Any) -> list[Any]:
        """From the shoulder to the elbow, and as far again."""
        a, b = q["shoulder"], q["shoulder"] + q["elbow"]
        elbow = self.length * sin(a), -self.length * cos(a)
        return [((0.0, 0.0), elbow, (elbow[0] + self.length * sin(b), elbow[1] - self.length * cos(b)))]

    def forces(self, t: Numeric, q: Any, u: Any) -> dict[str, Any]:
        """The torques of the motors."""
        beat = sin(self.omega * t)
        return {"shoulder": self.shoulder_torque * beat, "elbow": self.elbow_torque * beat}

    def contacts(self) -> Mapping[str, Any]:
        """The two joints."""
        return {"shoulder": Contact("shoulder", self.shoulder, load=1.0), "elbow": Contact("elbow", self.elbow, load=1.0)}
