"""Coulomb friction with a linear piece around v = 0: an approximation, for comparison."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import where
from stickslip.models.friction.approximation import SmoothedCoulomb
from stickslip.models.friction.sides import by_side


@dataclass(frozen=True, eq=False)
class DeadBand(SmoothedCoulomb):
    r"""Anisotropic Coulomb friction that is viscous inside a band around v = 0: an approximation.

    .. math:: R = \mu_\pm N\,v/w \;(|v| < w), \qquad R = \pm\mu_\pm N \;(|v| \ge w)

    It serves to show the error of such approximations. For true sticking use `Coulomb`, which is solved exactly.

    Parameters
    ----------
    mu_plus, mu_minus : float
        Friction coefficients forwards and backwards [-].
    width : float
        Half width w of the velocity band [m/s].

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.friction.DeadBand(mu_plus=0.15, mu_minus=0.21, width=1e-3)
    >>> [round(law.force(v, z=(), zdot=(), load=1.0), 6) for v in (0.1, 5e-4, 0.0, -0.1)]
    [0.15, 0.075, 0.0, -0.21]
    """

    approximation: ClassVar[str] = (
        "dead-band Coulomb friction is a viscous film inside the band: under any force below break-away the body creeps, at up to width"
    )

    def force(self, v: Numeric, z: Numeric, zdot: Numeric, load: Numeric) -> Any:
        """Friction force R [N]."""
        share = where(v > self.width, 1.0, where(v < -self.width, -1.0, v / self.width))
        return by_side(v, self.mu_plus, self.mu_minus) * load * share
