"""A mass on a spring with dry friction under a harmonic force; without the force, free decay."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import pi, sin
from stickslip.basics.quantities import DAMPING, LOAD, MASS, OMEGA, STIFFNESS, quantity
from stickslip.models.machines.mechanism import Sprung


@dataclass(frozen=True, eq=False)
class ForcedOscillator(Sprung):
    r"""A harmonically forced oscillator with dry friction: the problem of Den Hartog and Shaw.

    .. math:: m\ddot x + c\,\dot x + k x + R = F \sin\omega t + F_0

    With ``force=0`` it decays freely; with ``stiffness=0`` it is a mass that a given force pushes over the track.

    Parameters
    ----------
    mass : float
        Mass m [kg].
    stiffness : float
        Stiffness k [N/m]; 0 is not a spring.
    force : float
        Amplitude F of the force [N].
    omega : float
        Angular frequency of the force [rad/s]. It defines the period even if there is no force.
    friction : Coulomb or LuGre or any law
        Friction law of the mass.
    load : float
        Normal force [N]; with 1 the coefficients of the law are forces.
    bias : float
        Constant part F_0 of the force [N].
    damping : float, optional
        Viscous damping c [N s/m].

    References
    ----------
    J. P. Den Hartog, Forced vibrations with combined Coulomb and viscous friction, Trans. ASME 53 (1930) 107-115.
    S. W. Shaw, On the dynamic response of a system with dry friction, J. Sound and Vibration 108 (1986) 305-325.

    Examples
    --------
    >>> import stickslip as ss
    >>> bench = ss.ForcedOscillator(mass=1.0, stiffness=1.0, force=1.0, omega=0.7, friction=ss.Coulomb(0.3, 0.3))
    >>> round(bench.period, 6), bench.acceleration(t=0.0, x=2.0, v=0.0, R=0.3)
    (8.975979, -2.3)
    """

    mass: float = field(metadata=MASS | {"example": 1.0})
    stiffness: float = field(metadata=STIFFNESS | {"example": 1.0})
    damping: float = field(default=0.0, kw_only=True, metadata=DAMPING)
    force: float = field(metadata=quantity("amplitude of the force", "N", "P", example=1.0))
    omega: float = field(metadata=OMEGA | {"example": 0.7, "allowed": ""})
    friction: Any
    load: float = field(default=1.0, metadata=LOAD)
    bias: float = field(default=0.0, metadata=quantity("constant part of the force", "N", "P_{0}", example=0.0))

    kind: ClassVar[str] = "forced_oscillator"
    _turns: ClassVar[tuple[str, ...]] = ("force", "bias")

    @property
    def period(self) -> float:
        """Period of the force [s]."""
        return 2 * pi / self.omega

    @property
    def velocity_scale(self) -> float:
        """Change of velocity in a time 1/omega under the force and a friction force equal to the load [m/s]."""
        return (abs(self.force) + self.load) / (self.mass * self.omega)

    def given_force(self, t: Numeric) -> Any:
        """The external force [N]."""
        return self.force * sin(self.omega * t) + self.bias

    def acceleration(self, t: Numeric, x: Numeric, v: Numeric, R: Numeric) -> Any:
        """Acceleration of the mass [m/s^2]."""
        return (self.given_force(t) - self.stiffness * x - self.damping * v - R) / self.mass

    def drive_power(self, t: Numeric, x: Numeric, v: Numeric, R: Numeric) -> Any:
        """Power of the external force [W]."""
        return self.given_force(t) * v
