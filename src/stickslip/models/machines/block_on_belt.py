"""A block on a spring, carried by a belt that moves at constant speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.models.machines.mechanism import SpringMass


@dataclass(frozen=True, eq=False)
class BlockOnBelt(SpringMass):
    r"""A block held by a spring on a moving belt: the textbook example of a self-excited oscillator.

    .. math:: m\ddot x = -k x - c\,\dot x - R(\dot x - u)

    The belt moves at speed u; friction sees the velocity of the block over the belt. Stuck means that the block rides along.
    It has no period: type ``ss.solve(bench, duration=...)``. A run starts at rest, so on the moving belt it starts slipping,
    unless the start says ``v=u``.

    Parameters
    ----------
    mass : float
        Mass m of the block [kg].
    stiffness : float
        Stiffness k of the spring [N/m].
    speed : float
        Speed u of the belt [m/s].
    friction : Coulomb or LuGre or any law
        Friction law of the block on the belt; plus is a block that moves faster than the belt.
    load : float
        Normal force [N]; with 1 the coefficients of the law are forces.
    damping : float
        Damping c of the spring [N s/m].

    References
    ----------
    J. P. Den Hartog, Mechanical Vibrations, 4th ed., McGraw-Hill 1956, section 7.

    Examples
    --------
    >>> import stickslip as ss
    >>> bench = ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5))
    >>> bench.contact_velocity(0.0), bench.acceleration(t=0.0, x=0.0, v=0.0, R=-1.0)
    (-0.1, 1.0)
    """

    kind: ClassVar[str] = "block_on_belt"

    def contact_velocity(self, v: Numeric) -> Any:
        """Velocity of the block over the belt [m/s]."""
        return v - self.speed

    def acceleration(self, t: Numeric, x: Numeric, v: Numeric, R: Numeric) -> Any:
        """Acceleration of the block [m/s^2]."""
        return (-self.stiffness * x - self.damping * v - R) / self.mass

    def drive_power(self, t: Numeric, x: Numeric, v: Numeric, R: Numeric) -> Any:
        """Power that the motor of the belt delivers [W]."""
        return -R * self.speed
