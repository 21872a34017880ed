"""The reset integrator: a spring at rest, Coulomb friction in sliding, a step between them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import where
from stickslip.models.friction.coefficients import SIGMA1
from stickslip.models.friction.sides import by_side, static
from stickslip.models.friction.two_sided import Bristles


@dataclass(frozen=True, eq=False)
class ResetIntegrator(Bristles):
    r"""Anisotropic reset integrator, a dynamic law with one inner state z and one memory: it sticks or slides.

    .. math:: \text{sticks:}\; \dot z = v, \; R = \frac{f_s}{\mu_s}\sigma_0 z + \sigma_1 v, \qquad
              \text{slides:}\; \dot z = 0, \; R = \pm\mu_\pm N

    where s is the side of z. It sticks until z reaches :math:`\pm\mu_\pm N/\sigma_0` on the side to which v goes, so break-away is at
    :math:`f_\pm N`, and then slides until v passes zero. The memory is a mode: 0 sticks, 1 slides forwards, -1 backwards.

    Parameters
    ----------
    mu_plus, mu_minus : float
        Kinetic friction coefficients forwards and backwards [-].
    f_plus, f_minus : float or None
        Static friction coefficients [-]; ``None`` means the kinetic ones.
    sigma0 : float
        Stiffness of the contact without the factor f/mu [N/m].
    sigma1 : float
        Damping while it sticks [N s/m].

    References
    ----------
    D. A. Haessig, B. Friedland, On the modeling and simulation of friction,
    ASME J. Dynamic Systems, Measurement, and Control 113 (1991) 354-362.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.friction.ResetIntegrator(mu_plus=0.15, mu_minus=0.21, f_plus=0.18, f_minus=0.24, sigma0=4e5, sigma1=100.0)
    >>> edge = 0.15 * 0.7 / 4e5
    >>> [round(law.force(v=1e-6, z=edge, zdot=0.0, load=0.7, mode=(side,)) / 0.7, 9) for side in (0, 1)]
    [0.18, 0.15]
    """

    sigma1: float = field(metadata=SIGMA1)

    modes: ClassVar[int] = 1

    def rate(self, v: Numeric, z: Numeric | tuple[Numeric, ...], load: Numeric, mode: tuple[Numeric, ...]) -> Any:
        """Rate of the deflection dz/dt [m/s]."""
        return where(mode[0] > 0, 0.0 * v, where(mode[0] < 0, 0.0 * v, v))

    def force(self, v: Numeric, z: Any, zdot: Any, load: Numeric, mode: Any) -> Any:
        """Friction force R [N]."""
        steeper = by_side(z, static(self.f_plus, self.mu_plus) / self.mu_plus, static(self.f_minus, self.mu_minus) / self.mu_minus)
        sticks = steeper * self.sigma0 * z + self.sigma1 * zdot
        return where(mode[0] > 0, self.mu_plus * load, where(mode[0] < 0, -self.mu_minus * load, sticks))

    def switches(
        self, v: Numeric, z: Numeric | tuple[Numeric, ...], load: Numeric, mode: tuple[Numeric, ...]
    ) -> list[tuple[Any, Any, Any]]:
        """Sliding begins where z reaches its bound on the side to which v goes, and ends when v passes zero."""
        forward, backward = self.mu_plus * load / self.sigma0, self.mu_minus * load / self.sigma0
        bounds = by_side(v, forward - z, forward), by_side(v, backward, backward + z)
        aside = 1.0 / self.sigma0  # of one that slides already: also where the load falls to zero there is no event
        resting = [where(mode[0] > 0, aside, where(mode[0] < 0, aside, left)) for left in bounds]
        return [
            (abs(v), (0,), where(mode[0] > 0, forward, where(mode[0] < 0, -backward, z))),
            (resting[0], (1,), forward),
            (resting[1], (-1,), -backward),
        ]
