"""Karnopp's model: inside a band around v = 0 friction balances the other forces. An approximation, for comparison."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import where
from stickslip.models.friction.approximation import Approximation
from stickslip.models.friction.coefficients import WIDTH
from stickslip.models.friction.sides import by_side
from stickslip.models.friction.two_sided import TwoSided


@dataclass(frozen=True, eq=False)
class Karnopp(Approximation, TwoSided):
    r"""Anisotropic Karnopp friction: in a band around v = 0 the body is held as long as static friction can: an approximation.

    .. math:: R = \pm\mu_\pm N \;(|v| > w), \qquad R = \min(\max(R_0, -f_- N), f_+ N) \;(|v| \le w)

    R_0 is the friction force that would keep v constant. The body is not stopped inside the band but keeps the velocity with which it
    entered. For true sticking use `Coulomb`, which is solved exactly.

    Parameters
    ----------
    mu_plus, mu_minus : float
        Kinetic friction coefficients forwards and backwards [-].
    f_plus, f_minus : float or None
        Static friction coefficients [-]; ``None`` means the kinetic ones.
    width : float
        Half width w of the velocity band [m/s].

    References
    ----------
    D. Karnopp, Computer simulation of stick-slip friction in mechanical dynamic systems,
    ASME J. Dynamic Systems, Measurement, and Control 107 (1985) 100-103.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.friction.Karnopp(mu_plus=0.15, mu_minus=0.21, f_plus=0.18, f_minus=0.24, width=1e-3)
    >>> [law.force(0.0, z=(), zdot=(), load=1.0, applied=applied) for applied in (0.1, 0.3, -0.3)]
    [0.1, 0.18, -0.24]
    """

    width: float = field(metadata=WIDTH)

    approximation: ClassVar[str] = (
        "Karnopp's model does not bring the body to rest: inside the band it keeps the velocity with which it came in, up to width"
    )

    def force(self, v: Numeric, z: Numeric, zdot: Numeric, load: Numeric, applied: Numeric) -> Any:
        """Friction force R; `applied` is the one that would keep v constant [N]."""
        backward, forward = self.breakaway(load)
        held = where(applied > forward, forward, where(applied < backward, backward, applied))
        sliding = by_side(v, self.mu_plus, -self.mu_minus) * load
        return where(v > self.width, sliding, where(v < -self.width, sliding, held))
