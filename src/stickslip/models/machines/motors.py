"""Motors of joints: from a voltage or a current, and a speed, to a torque."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import Frozen
from stickslip.basics.maths import maximum, minimum
from stickslip.basics.quantities import positive, quantity

_CONSTANT = quantity("motor constant", "N m/A", "k_{t}", example=0.05, rule=positive, allowed="a positive torque per ampere")


@dataclass(frozen=True, eq=False)
class Motor(Frozen):
    r"""A direct-current motor: with a resistance it is driven by a voltage, without one by a current.

    .. math:: \tau = \frac{k_t}{R}\,(U - k_t\,\omega), \qquad |U| \le U_\mathrm{supply}, \qquad\text{or}\qquad \tau = k_t\, i

    The inductance is left out. At rest the supply gives the stall torque :math:`k_t U/R`; without a load the motor turns at :math:`U/k_t`,
    and with its terminals joined (U = 0) it brakes like a damper :math:`k_t^2/R`. What commands it, a `voltage`, a `current` or a
    controller whose gains are then in V or A, stands in `stickslip.Joint`; behind a gear all this is at the motor.

    Parameters
    ----------
    k_t : float
        Torque for each ampere, which is the voltage for each rad/s too [N m/A].
    resistance : float, optional
        Of the winding, R [Ohm].
    supply : float, optional
        The largest voltage, in both directions [V].

    References
    ----------
    M. Duclusaud, G. Passault, V. Padois and O. Ly, Extended friction models for the physics simulation of servo actuators,
    arXiv:2410.08650 (2024).

    Examples
    --------
    >>> motor = Motor(k_t=2.0, resistance=4.0, supply=12.0)
    >>> motor.torque(100.0, 0.0), motor.torque(12.0, 6.0), motor.torque(0.0, 1.0)
    (6.0, 0.0, -1.0)
    """

    k_t: float = field(metadata=_CONSTANT)
    resistance: float | None = field(
        default=None, metadata=quantity("resistance of the winding", "Ohm", "R_{m}", example=4.0, rule=positive)
    )
    supply: float | None = field(
        default=None, metadata=quantity("voltage of the supply", "V", r"U_{\mathrm{max}}", example=12.0, rule=positive)
    )

    def _check(self, problems: Problems) -> None:
        if self.supply is not None and self.resistance is None:
            problems.add(
                f"supply = {self.supply!r} [V] without a resistance; under a current there is no voltage; type resistance=4.0 [Ohm], "
                "or leave supply out and type limit=2.0 [A] of the joint"
            )

    @property
    def command(self) -> str:
        """What commands it: "voltage" or "current"."""
        return "current" if self.resistance is None else "voltage"

    @property
    def unit(self) -> str:
        """The unit of its command."""
        return "A" if self.resistance is None else "V"

    @property
    def gain(self) -> Any:
        """Torque at rest for each unit of the command [N m/A] or [N m/V]."""
        return self.k_t if self.resistance is None else self.k_t / self.resistance

    def torque(self, command: Numeric, speed: Numeric) -> Any:
        """Its torque [N m] under a command [A] or [V], at a speed [rad/s]."""
        if self.resistance is None:
            return self.k_t * command
        return self.k_t / self.resistance * (limited(command, self.supply) - self.k_t * speed)

    @classmethod
    def example(cls) -> Motor:
        """A servo's motor, seen from its gear's far side."""
        return cls(k_t=1.5, resistance=5.0, supply=12.0)


def limited(value: Numeric, limit: Any) -> Any:
    """A value that is not larger than a limit, either way; None is no limit.

    Examples
    --------
    >>> limited(3.0, 2.0), limited(-3.0, 2.0), limited(3.0, None)
    (2.0, -2.0, 3.0)
    """
    return value if limit is None else maximum(minimum(value, limit), -limit)
