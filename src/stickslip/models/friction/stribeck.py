"""Dry friction that fades with speed: from static to kinetic friction, with a free exponent."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.quantities import EXPONENTS, quantity
from stickslip.models.friction.coefficients import V_S, VISCOUS
from stickslip.models.friction.sides import by_side, fading
from stickslip.models.friction.two_sided import Fading, TwoSided


@dataclass(frozen=True, eq=False)
class Stribeck(Fading, TwoSided):
    r"""Anisotropic Stribeck friction, a set-valued law: friction falls from f at rest to mu at speed.

    .. math:: R = \pm N\left(\mu_\pm + (f_\pm-\mu_\pm)\,e^{-|v/v_s|^\delta}\right) + c\,v \;(v \ne 0), \qquad
              -f_- N \le R \le f_+ N \;(v = 0)

    Measured curves have exponents between 1/2 and 2. With exponents other than 1 and 2 the curve is rounded off where
    :math:`|v| < 10^{-12} v_s`, so that it has a slope everywhere.

    Parameters
    ----------
    mu_plus, mu_minus : float
        Kinetic friction coefficients forwards and backwards [-].
    f_plus, f_minus : float or None
        Static friction coefficients [-]; ``None`` means the kinetic ones.
    v_s : float
        Stribeck velocity [m/s].
    exponent : float
        Exponent of the Stribeck curve [-].
    viscous : float
        Viscous friction c, independent of the load [N s/m].

    References
    ----------
    L. C. Bo, D. Pavelescu, The friction-speed relation and its influence on the critical velocity of stick-slip motion,
    Wear 82 (1982) 277-289.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.Stribeck(mu_plus=0.15, mu_minus=0.21, f_plus=0.18, f_minus=0.24, v_s=2e-3, exponent=1, viscous=0.4)
    >>> [round(law.sliding(v, load=1.0), 6) for v in (1e-12, 2e-3, 0.1, -2e-3)]
    [0.18, 0.161836, 0.19, -0.221836]
    >>> law.breakaway(load=1.0)
    (-0.24, 0.18)
    """

    v_s: float = field(metadata=V_S)
    exponent: float = field(
        default=2.0,
        metadata=quantity(
            "exponent of the Stribeck curve",
            "1",
            r"\delta",
            example=1.0,
            rule=EXPONENTS,
            allowed="a number from 0.01 to 20, mostly 1 or 2",
            range=(0.5, 4.0),
        ),
    )
    viscous: float = field(default=0.0, metadata=VISCOUS)

    def coefficient(self, v: Numeric) -> Any:
        """Steady friction coefficient without the viscous part, positive both ways [-]."""
        return fading(self, v, self.exponent)

    def sliding(self, v: Numeric, load: Numeric) -> Any:
        """Friction force R while sliding with velocity v [N]."""
        return by_side(v, 1.0, -1.0) * self.coefficient(v) * load + self.viscous * v
