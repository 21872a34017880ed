"""Coulomb friction smoothed by tanh: an approximation, for comparison."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import tanh
from stickslip.models.friction.approximation import SmoothedCoulomb
from stickslip.models.friction.sides import by_side


@dataclass(frozen=True, eq=False)
class TanhCoulomb(SmoothedCoulomb):
    r"""Anisotropic Coulomb friction whose step at v = 0 is replaced by a steep curve: an approximation.

    .. math:: R = \mu_\pm N \tanh(v/w)

    It serves to show the error of such approximations. For true sticking use `Coulomb`, which is solved exactly.

    Parameters
    ----------
    mu_plus, mu_minus : float
        Friction coefficients forwards and backwards [-].
    width : float
        Velocity w over which friction builds up [m/s].

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.friction.TanhCoulomb(mu_plus=0.15, mu_minus=0.21, width=1e-3)
    >>> [round(law.force(v, z=(), zdot=(), load=1.0), 6) for v in (0.1, 1e-3, 0.0, -0.1)]
    [0.15, 0.114239, 0.0, -0.21]
    """

    approximation: ClassVar[str] = (
        "tanh-smoothed Coulomb friction has no static friction: under any force below break-away the body creeps, at a speed near width"
    )

    def force(self, v: Numeric, z: Numeric, zdot: Numeric, load: Numeric) -> Any:
        """Friction force R [N]."""
        return by_side(v, self.mu_plus, self.mu_minus) * load * tanh(v / self.width)
