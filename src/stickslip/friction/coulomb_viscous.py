"""Dry friction with a viscous and a quadratic part."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from stickslip.errors import Problems
from stickslip.fields import at_least
from stickslip.friction.law import Law
from stickslip.friction.sides import by_side, check_static, static

__all__ = ["CoulombViscous"]


@dataclass(frozen=True, eq=False)
class CoulombViscous(Law):
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
        Viscous friction c [N s/m].
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

    mu_plus: float
    mu_minus: float
    f_plus: float | None = None
    f_minus: float | None = None
    viscous: float = 0.0
    quadratic: float = 0.0

    _example: ClassVar[dict[str, Any]] = dict(mu_plus=0.15, mu_minus=0.21, f_plus=0.18, f_minus=0.24, viscous=0.4, quadratic=2.0)
    _rules: ClassVar[dict[str, Any]] = {
        "mu_plus": (at_least(0.0), "zero or more"),
        "mu_minus": (at_least(0.0), "zero or more"),
        "f_plus": (at_least(0.0), "zero or more, or None"),
        "f_minus": (at_least(0.0), "zero or more, or None"),
        "viscous": (at_least(0.0), "zero or more [N s/m]"),
        "quadratic": (at_least(0.0), "zero or more [N s^2/m^2]"),
    }

    def _check(self, problems: Problems) -> None:
        check_static(self, problems)

    def sliding(self, v: Any, load: Any) -> Any:
        """Friction force R while sliding with velocity v [N]."""
        return by_side(v, self.mu_plus, -self.mu_minus) * load + self.viscous * v + self.quadratic * v * abs(v)

    def breakaway(self, load: Any) -> tuple[Any, Any]:
        """Friction forces (backward, forward) that rest can bear [N]."""
        return -static(self.f_minus, self.mu_minus) * load, static(self.f_plus, self.mu_plus) * load
