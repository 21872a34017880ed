"""Elasto-plastic friction: a bristle that comes back until it is bent too far, so that small loads cause no drift."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import minimum, pi, sin, where
from stickslip.basics.quantities import at_least, quantity
from stickslip.models.friction.coefficients import SIGMA1, SIGMA2, V_S
from stickslip.models.friction.sides import by_side, fading
from stickslip.models.friction.two_sided import Bristles, Fading

_ELASTIC = quantity(
    "deflection below which nothing slips", "m", "z_{ba}", example=2e-7, rule=at_least(0.0), range=(2e-8, 2e-6), shown="µm",
    allowed="zero or more, below mu N / sigma0 [m]",
)  # fmt: skip
_MOST = 0.99  # of the deflection at which it slides: up to there the contact may be elastic


@dataclass(frozen=True, eq=False)
class ElastoPlastic(Fading, Bristles):
    r"""Anisotropic elasto-plastic friction, a dynamic law with one inner state z: LuGre without drift.

    .. math:: R = \sigma_0 z + \sigma_1 \dot z + \sigma_2 v, \qquad
              \dot z = v\left(1 - \alpha\,\frac{z}{z_{ss}}\operatorname{sgn} v\right), \qquad z_{ss} = \frac{N g_\pm(v)}{\sigma_0}

    .. math:: \alpha = 0 \;(s \le z_{ba}), \quad
              \alpha = \tfrac12 + \tfrac12\sin\!\left(\pi\,\frac{s - (z_{ss}+z_{ba})/2}{z_{ss}-z_{ba}}\right) \;(z_{ba} < s < z_{ss}), \quad
              \alpha = 1 \;(s \ge z_{ss}), \qquad s = z\operatorname{sgn} v

    with LuGre's :math:`g_\pm`. Up to the deflection :math:`z_{ba}` the contact is purely elastic: displacements are fully recovered. Where
    the load falls so far that it would be elastic beyond sliding, it is elastic up to :math:`0.99\,z_{ss}`.

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
    z_ba : float
        Deflection up to which the contact is elastic, below mu N / sigma0 [m].
    z_ba_minus : float, optional
        The same for motion backwards [m]; ``None`` means `z_ba`.

    References
    ----------
    P. Dupont, V. Hayward, B. Armstrong, F. Altpeter, Single state elastoplastic friction models,
    IEEE Trans. Automatic Control 47 (2002) 787-792.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.friction.ElastoPlastic(0.15, 0.21, 0.18, 0.24, sigma0=4e5, sigma1=100.0, sigma2=0.04, v_s=2e-3, z_ba=1.5e-7)
    >>> law.rate(v=1e-3, z=1e-7, load=0.7)
    0.001
    >>> abs(law.rate(v=1.0, z=0.15 * 0.7 / 4e5, load=0.7)) < 1e-12
    True
    """

    sigma1: float = field(metadata=SIGMA1)
    sigma2: float = field(metadata=SIGMA2)
    v_s: float = field(metadata=V_S)
    z_ba: float = field(metadata=_ELASTIC)
    z_ba_minus: float | None = field(default=None, metadata=_ELASTIC | {"example": 3e-7, "symbol": "z_{ba,-}"})

    def rate(self, v: Numeric, z: Numeric, load: Numeric) -> Any:
        """Rate of the deflection dz/dt [m/s]."""
        bent, steady = by_side(v, z, -z), load * fading(self, v) / self.sigma0
        elastic = minimum(by_side(v, self.z_ba, self.z_ba if self.z_ba_minus is None else self.z_ba_minus), _MOST * steady)
        between = 0.5 + 0.5 * sin(pi * (bent - 0.5 * (steady + elastic)) / (steady - elastic))
        alpha = where(bent > elastic, where(bent > steady, 1.0, between), 0.0)
        return v * (1.0 - alpha * bent / steady)

    def force(self, v: Numeric, z: Any, zdot: Any, load: Numeric) -> Any:
        """Friction force R [N]."""
        return self.sigma0 * z + self.sigma1 * zdot + self.sigma2 * v

    def notes(self, load: Numeric) -> list[str]:
        """Remarks on the numbers, such as an elastic range that ends beyond sliding."""
        import numpy as np

        notes = []
        minus = self.z_ba if self.z_ba_minus is None else self.z_ba_minus
        for side, mu, elastic in ((">", self.mu_plus, self.z_ba), ("<", self.mu_minus, minus)):
            sliding = np.asarray(mu * load / self.sigma0)
            if np.any(np.asarray(elastic) >= sliding):
                notes.append(
                    f"ElastoPlastic for v {side} 0: z_ba = {np.max(elastic):.4g} m is not below mu N / sigma0 = {np.min(sliding):.4g} m, "
                    f"so the contact is elastic up to {_MOST:g} of that"
                )
        return notes
