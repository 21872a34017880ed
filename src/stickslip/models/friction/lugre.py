"""The LuGre model: friction as a bristle that bends, with a Stribeck curve and viscous friction."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.models.friction.coefficients import SIGMA1, SIGMA2, V_S
from stickslip.models.friction.sides import fading, static
from stickslip.models.friction.two_sided import Bristles, Fading


@dataclass(frozen=True, eq=False)
class LuGre(Fading, Bristles):
    r"""Anisotropic LuGre friction, a dynamic law with one inner state z: Eqs 2.5 and 2.6 of the paper.

    .. math:: R = \sigma_0 z + \sigma_1 \dot z + \sigma_2 v, \qquad
              \dot z = v - \frac{\sigma_0 |v|}{N\,g_\pm(v)} z, \qquad
              g_\pm(v) = \mu_\pm + (f_\pm-\mu_\pm)\,e^{-(v/v_s)^2}

    The upper sign holds for v > 0. The printed Eq. 2.6 is undefined at v = 0; there :math:`\dot z = 0`.
    It never rests exactly: under a steady load below break-away it creeps.

    Parameters
    ----------
    mu_plus, mu_minus : float
        Kinetic friction coefficients forwards and backwards [-].
    f_plus, f_minus : float or None
        Static friction coefficients [-]; ``None`` means the kinetic ones.
    sigma0 : float
        Bristle stiffness [N/m].
    sigma1 : float
        Bristle (micro-)damping [N s/m].
    sigma2 : float
        Viscous friction [N s/m].
    v_s : float
        Stribeck velocity [m/s].

    References
    ----------
    C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, A new model for control of systems with friction,
    IEEE Trans. Automatic Control 40 (1995) 419-425.

    Examples
    --------
    >>> law = LuGre(mu_plus=0.15, mu_minus=0.21, f_plus=0.18, f_minus=0.24, sigma0=4e5, sigma1=100.0, sigma2=0.04, v_s=2e-3)
    >>> law.rate(v=0.0, z=1e-7, load=0.7)
    0.0
    >>> round(law.force(v=0.0, z=1e-7, zdot=0.0, load=0.7), 9)
    0.04
    """

    sigma1: float = field(metadata=SIGMA1)
    sigma2: float = field(metadata=SIGMA2)
    v_s: float = field(metadata=V_S)

    def coefficient(self, v: Numeric) -> Any:
        """Steady friction coefficient g(v) without the viscous part [-] (the bracket of Eq. 2.6)."""
        return fading(self, v)

    def rate(self, v: Numeric, z: Numeric | tuple[Numeric, ...], load: Numeric) -> Any:
        """Bristle velocity dz/dt [m/s] (Eq. 2.6)."""
        return v - self.sigma0 * abs(v) * z / (load * self.coefficient(v))

    def force(self, v: Numeric, z: Any, zdot: Any, load: Numeric) -> Any:
        """Friction force R [N] (Eq. 2.5)."""
        return self.sigma0 * z + self.sigma1 * zdot + self.sigma2 * v

    def cautions(self, load: Numeric) -> list[str]:
        """What `check` and the bench say about its energy: the passivity condition sigma1 <= sigma2 Fc / (Fs - Fc)."""
        return _passivity(self)


def _passivity(law: LuGre) -> list[str]:
    """Sufficient condition for passivity of the map v -> R with constant sigma1 (Barahanov and Ortega 2000)."""
    import numpy as np

    notes = []
    for side in ("plus", "minus"):
        mu = np.asarray(getattr(law, f"mu_{side}"), float)
        f = np.asarray(static(getattr(law, f"f_{side}"), mu), float)
        with np.errstate(divide="ignore", invalid="ignore"):
            bound = np.where(f > mu, law.sigma2 * mu / (f - mu), np.inf)
        if np.any(law.sigma1 > bound):
            notes.append(
                f"LuGre is not passive for v {'>' if side == 'plus' else '<'} 0: sigma1 = {np.max(law.sigma1):.4g} N s/m is above "
                f"sigma2 mu/(f - mu) = {np.min(bound):.4g} N s/m, so the bristle can give back more energy than it took"
            )
    return notes
