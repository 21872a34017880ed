"""The Dahl model: friction that follows displacement, not speed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.quantities import EXPONENTS, quantity
from stickslip.models.friction.coefficients import MU_MINUS, MU_PLUS, POSITIVE, SIGMA0
from stickslip.models.friction.sides import by_side, signed_power
from stickslip.models.friction.two_sided import Elastic


@dataclass(frozen=True, eq=False)
class Dahl(Elastic):
    r"""Anisotropic Dahl friction, a dynamic law with one inner state z, the deflection of the contact.

    .. math:: R = \sigma_0 z, \qquad \dot z = v\,|u|^i \operatorname{sgn} u, \qquad
              u = 1 - \frac{\sigma_0 z}{\mu_\pm N}\operatorname{sgn} v

    The force depends on the path alone, not on how fast it is travelled. There is no Stribeck effect, no static friction above the kinetic
    one, and no true rest. With an exponent below 1 sliding is reached after a finite displacement; the curve is rounded off where
    :math:`|u| < 10^{-12}`, so that it has a slope everywhere. With an exponent of some 0.1 or less that curve is so sharp that a run may
    use up its budget of steps, which its error says.

    Parameters
    ----------
    mu_plus, mu_minus : float
        Friction coefficients forwards and backwards [-].
    sigma0 : float
        Stiffness of the contact at rest [N/m].
    exponent : float
        Exponent i, the shape of the transition to sliding [-]: 1 for ductile materials, less for brittle ones.

    References
    ----------
    P. R. Dahl, A solid friction model, Aerospace Corporation TOR-0158(3107-18)-1, 1968;
    P. R. Dahl, Solid friction damping of mechanical vibrations, AIAA Journal 14 (1976) 1675-1682.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.Dahl(mu_plus=0.15, mu_minus=0.21, sigma0=4e5)
    >>> f"{law.rate(v=1e-3, z=0.0, load=0.7):.6f} {law.rate(v=1e-3, z=0.5 * 0.15 * 0.7 / 4e5, load=0.7):.6f}"
    '0.001000 0.000500'
    >>> round(law.force(v=1e-3, z=1e-7, zdot=0.0, load=0.7), 9)
    0.04
    """

    mu_plus: float = field(metadata=MU_PLUS | POSITIVE)
    mu_minus: float = field(metadata=MU_MINUS | POSITIVE)
    sigma0: float = field(metadata=SIGMA0)
    exponent: float = field(
        default=1.0,
        metadata=quantity(
            "exponent of Dahl's law", "1", "i", example=1.0, rule=EXPONENTS, allowed="a number from 0.01 to 20, mostly 1", range=(0.5, 3.0)
        ),
    )

    def rate(self, v: Numeric, z: Numeric, load: Numeric) -> Any:
        """Rate of the deflection dz/dt [m/s]."""
        signed = by_side(v, 1.0 / self.mu_plus, -1.0 / self.mu_minus)
        return v * signed_power(1.0 - self.sigma0 * z * signed / load, self.exponent)

    def force(self, v: Numeric, z: Any, zdot: Any, load: Numeric) -> Any:
        """Friction force R [N]."""
        return self.sigma0 * z

    def notes(self, load: Numeric) -> list[str]:
        """Remarks on this law for the user."""
        return ["Dahl friction has no Stribeck effect and no static friction above the kinetic one: it makes no stick-slip by itself"]
