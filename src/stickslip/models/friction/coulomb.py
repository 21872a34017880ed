"""Dry friction with one constant for each direction, and optionally a higher break-away force."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.models.friction.sides import by_side
from stickslip.models.friction.two_sided import Dry


@dataclass(frozen=True, eq=False)
class Coulomb(Dry):
    r"""Anisotropic Coulomb friction, a set-valued law: Eq. 2.4 of the paper.

    .. math:: R = \mu_+ N \;(v>0), \quad R = -\mu_- N \;(v<0), \quad -f_- N \le R \le f_+ N \;(v=0)

    At rest it takes whatever value holds the body, up to the break-away force. It is solved exactly:
    there is no regularisation and no velocity threshold.

    Parameters
    ----------
    mu_plus, mu_minus : float
        Kinetic friction coefficient forwards (v > 0, downhill) and backwards [-]; one alone, or ``mu=``, is that of both directions.
    f_plus, f_minus : float, optional
        Static (break-away) coefficients [-]; ``None`` means the kinetic ones, which is Eq. 2.4 to the letter.

    Examples
    --------
    >>> Coulomb(0.2) == Coulomb(mu=0.2) == Coulomb(mu_plus=0.2, mu_minus=0.2)
    True
    >>> law = Coulomb(mu_plus=0.15, mu_minus=0.21)
    >>> law.sliding(v=0.01, load=10.0), law.sliding(v=-0.01, load=10.0)
    (1.5, -2.1)
    >>> law.breakaway(load=10.0)
    (-2.1, 1.5)
    """

    def sliding(self, v: Numeric, load: Numeric) -> Any:
        """Friction force R while sliding with velocity v [N] (Eq. 2.4, first two lines)."""
        return by_side(v, self.mu_plus, -self.mu_minus) * load
