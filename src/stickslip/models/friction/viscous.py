"""Viscous and quadratic friction: what oil and air add to a dry contact."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.quantities import at_least, quantity
from stickslip.models.friction.law import Law
from stickslip.models.friction.sides import by_side


@dataclass(frozen=True, eq=False)
class Viscous(Law):
    r"""Anisotropic viscous and quadratic friction, which does not depend on the load and carries no force at rest.

    .. math:: R = c_\pm v + d_\pm v\,|v|

    It is usually added to a law of dry friction: ``Coulomb(...) + Viscous(...)``.

    Parameters
    ----------
    viscous_plus, viscous_minus : float
        Viscous friction c forwards and backwards [N s/m].
    quadratic_plus, quadratic_minus : float
        Quadratic friction d forwards and backwards [N s^2/m^2].

    Examples
    --------
    >>> import stickslip as ss
    >>> oil = ss.Viscous(viscous_plus=2.0, viscous_minus=4.0)
    >>> oil.sliding(v=0.1, load=5.0), oil.sliding(v=-0.1, load=5.0), oil.breakaway(load=5.0)
    (0.2, -0.4, (0.0, 0.0))
    """

    viscous_plus: float = field(
        metadata=quantity("viscous friction forwards", "N s/m", "c_{+}", example=0.4, rule=at_least(0.0), range=(0.05, 4.0))
    )
    viscous_minus: float = field(
        metadata=quantity("viscous friction backwards", "N s/m", "c_{-}", example=0.6, rule=at_least(0.0), range=(0.05, 4.0))
    )
    quadratic_plus: float = field(
        default=0.0,
        metadata=quantity("quadratic friction forwards", "N s^2/m^2", "d_{+}", example=2.0, rule=at_least(0.0), range=(0.0, 20.0)),
    )
    quadratic_minus: float = field(
        default=0.0,
        metadata=quantity("quadratic friction backwards", "N s^2/m^2", "d_{-}", example=3.0, rule=at_least(0.0), range=(0.0, 20.0)),
    )

    def sliding(self, v: Numeric, load: Numeric) -> Any:
        """Friction force R at velocity v [N]."""
        linear, quadratic = by_side(v, self.viscous_plus, self.viscous_minus), by_side(v, self.quadratic_plus, self.quadratic_minus)
        return linear * v + quadratic * v * abs(v)

    def breakaway(self, load: Numeric) -> tuple[Any, Any]:
        """No static friction [N]."""
        return 0.0 * load, 0.0 * load
