"""A mass on a track, pulled by a spring whose end moves at constant speed."""

from __future__ import annotations

from dataclasses import dataclass
from operator import attrgetter
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.models.machines.mechanism import SpringMass


@dataclass(frozen=True, eq=False)
class PulledMass(SpringMass):
    r"""A mass pulled by a spring: the experiment in which stick-slip was first measured.

    .. math:: m\ddot x = k\,(u t - x) + c\,(u - \dot x) - R

    x is the position of the mass; the far end of the spring is at :math:`u t`, and the spring is relaxed at the start.
    It has no period: type ``ss.solve(bench, duration=...)``.

    Parameters
    ----------
    mass : float
        Mass m [kg].
    stiffness : float
        Stiffness k of the spring [N/m].
    speed : float
        Speed u of its far end [m/s].
    friction : Coulomb or LuGre or any law
        Friction law of the mass on the track.
    load : float
        Normal force [N]; with 1 the coefficients of the law are forces.
    damping : float
        Damping c of the spring [N s/m].

    References
    ----------
    F. P. Bowden, L. Leben, The nature of sliding and the analysis of friction, Proc. R. Soc. London A 169 (1939) 371-391.

    Examples
    --------
    >>> import stickslip as ss
    >>> bench = ss.PulledMass(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5))
    >>> bench.acceleration(t=5.0, x=0.1, v=0.0, R=0.5), bench.period
    (0.3, None)
    """

    kind: ClassVar[str] = "pulled_mass"

    far_end_velocity = property(attrgetter("speed"), doc="Velocity of the far end of the spring [m/s].")

    def spring_force(self, t: Numeric, x: Numeric, v: Numeric) -> Any:
        """Force of the spring on the mass [N]."""
        return self.stiffness * (self.speed * t - x) + self.damping * (self.speed - v)

    def acceleration(self, t: Numeric, x: Numeric, v: Numeric, R: Numeric) -> Any:
        """Acceleration of the mass [m/s^2]."""
        return (self.spring_force(t, x, v) - R) / self.mass

    def potential(self, t: Numeric, x: Numeric) -> Any:
        """Energy in the spring [J]."""
        return 0.5 * self.stiffness * (self.speed * t - x) ** 2

    def drive_power(self, t: Numeric, x: Numeric, v: Numeric, R: Numeric) -> Any:
        """Power supplied at the far end of the spring [W]."""
        return self.spring_force(t, x, v) * self.speed

    def damping_power(self, t: Numeric, x: Numeric, v: Numeric) -> Any:
        """Power dissipated by the damping [W]."""
        return self.damping * (self.speed - v) ** 2
