"""Dry friction with a viscous and a quadratic part."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.models.friction.coefficients import QUADRATIC, VISCOUS
from stickslip.models.friction.sides import by_side
from stickslip.models.friction.two_sided import Dry


@dataclass(frozen=True, eq=False)
class CoulombViscous(Dry):
    r"""Anisotropic Coulomb friction with static break-away, viscous and quadratic friction: a set-valued law.

    .. math:: R = \pm\mu_\pm N + c\,v + d\,v\,|v| \;(v \ne 0), \qquad -f_- N \le R \le f_+ N \;(v = 0)

    The viscous and quadratic parts do not grow with the load and are the same both ways; where they are not,
    write ``Coulomb(...) + Viscous(...)``.

    Parameters
    ----------
    mu_plus, mu_minus : float
        Kinetic friction coefficients forwards and backwards [-].
    f_plus, f_minus : float, optional
        Static (break-away) coefficients [-]; ``None`` means the kinetic ones.
    viscous : float
        Viscous friction c [N s/m]; below zero friction falls with the speed, as it does over a part of a Stribeck curve.
    quadratic : float
        Quadratic friction d [N s^2/m^2].

    References
    ----------
    B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, A survey of models, analysis tools and compensation methods
    for the control of machines with friction, Automatica 30 (1994) 1083-1138.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.CoulombViscous(mu_plus=0.15, mu_minus=0.21, viscous=2.0, quadratic=10.0)
    >>> f"{law.sliding(v=0.1, load=10.0):.3f} {law.sliding(v=-0.1, load=10.0):.3f}"
    '1.800 -2.400'
    >>> law.breakaway(load=10.0)
    (-2.1, 1.5)
    """

    viscous: float = field(default=0.0, metadata=VISCOUS | {"rule": None, "allowed": "a number"})
    quadratic: float = field(default=0.0, metadata=QUADRATIC)

    def sliding(self, v: Numeric, load: Numeric) -> Any:
        """Friction force R while sliding with velocity v [N]."""
        return by_side(v, self.mu_plus, -self.mu_minus) * load + self.viscous * v + self.quadratic * v * abs(v)

    def notes(self, load: Any) -> list[str]:
        """The speed beyond which friction that falls with it would push."""
        import numpy as np

        least, fall = np.minimum(self.mu_plus, self.mu_minus) * load, -np.asarray(self.viscous, float)
        room = fall**2 - 4 * self.quadratic * least
        if not np.any((fall > 0) & (room > 0)):
            return []
        with np.errstate(divide="ignore", invalid="ignore"):
            speed = np.where((fall > 0) & (room > 0), 2 * least / (fall + np.sqrt(np.maximum(room, 0.0))), np.inf)
        return [f"friction falls with the speed, and would push beyond {float(np.min(speed)):.3g} m/s; a Stribeck law does not"]
