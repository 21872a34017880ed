"""Viscous and quadratic friction: what oil and air add to a dry contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from stickslip.fields import at_least
from stickslip.friction.law import Law
from stickslip.friction.sides import by_side

__all__ = ["Viscous"]


@dataclass(frozen=True, eq=False)
class Viscous(Law):
    r"""Anisotropic viscous and quadratic friction, which does not depend on the load and holds nothing at rest.

    .. math:: R = c_\pm v + d_\pm v\,|v|

    Seldom alone: add it to a law of dry friction, ``Coulomb(...) + Viscous(...)``.

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

    viscous_plus: float
    viscous_minus: float
    quadratic_plus: float = 0.0
    quadratic_minus: float = 0.0

    _example: ClassVar[dict[str, Any]] = dict(viscous_plus=0.4, viscous_minus=0.6, quadratic_plus=2.0, quadratic_minus=3.0)
    _rules: ClassVar[dict[str, Any]] = {
        "viscous_plus": (at_least(0.0), "zero or more [N s/m]"),
        "viscous_minus": (at_least(0.0), "zero or more [N s/m]"),
        "quadratic_plus": (at_least(0.0), "zero or more [N s^2/m^2]"),
        "quadratic_minus": (at_least(0.0), "zero or more [N s^2/m^2]"),
    }

    def sliding(self, v: Any, load: Any) -> Any:
        """Friction force R at velocity v [N]."""
        linear, quadratic = by_side(v, self.viscous_plus, self.viscous_minus), by_side(v, self.quadratic_plus, self.quadratic_minus)
        return linear * v + quadratic * v * abs(v)

    def breakaway(self, load: Any) -> tuple[Any, Any]:
        """Rest bears no force [N]."""
        return 0.0 * load, 0.0 * load
