"""Rate-and-state friction: contacts that strengthen with age."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import everywhere
from stickslip.basics.maths import asinh, exp, log
from stickslip.basics.quantities import at_least, positive, quantity
from stickslip.models.friction.coefficients import MU0
from stickslip.models.friction.law import Law

_LAWS = ("aging", "slip")
_MOST = 300.0  # mu0/a; of b phi/a no motion reaches as much, and the exponential of both together is a number
_STILL = 1e-40  # (|v|/v0)^2 below which the slip law does not ask for the logarithm of the speed


@dataclass(frozen=True, eq=False)
class RateState(Law):
    r"""Rate-and-state friction of Dieterich and Ruina, a dynamic law whose inner state is the age of the contacts.

    .. math:: R = a N \operatorname{arsinh}\Bigl[\frac{v}{2v_0}\,\mathrm{e}^{(\mu_0 + b\varphi)/a}\Bigr], \qquad
              \varphi = \ln\frac{v_0\theta}{D_c}

    At steady speed :math:`R/N = \mu_0 + (a-b)\ln(v/v_0)`. The age :math:`\theta` follows

    .. math:: \dot\theta = 1 - \frac{|v|\theta}{D_c} \quad\text{(aging)}, \qquad
              \dot\theta = -\frac{|v|\theta}{D_c}\ln\frac{|v|\theta}{D_c} \quad\text{(slip)},

    and the inner state of the law is :math:`\varphi`. The inverse hyperbolic sine makes the logarithm smooth through v = 0 (Rice and
    Ben-Zion 1996). Friction is the same in both directions. Unless specified otherwise, a run begins at the age of steady sliding at v0.

    Parameters
    ----------
    mu0 : float
        Friction coefficient at the speed v0 [-].
    a : float
        Direct effect: immediate increase of the friction coefficient with the logarithm of the velocity [-].
    b : float
        Evolution effect: how much of it is lost as the contacts get younger [-]; stick-slip needs b > a.
    Dc : float
        Slip in which the contacts are renewed [m].
    v0 : float
        Reference speed [m/s].
    evolution : {"aging", "slip"}
        Whether contacts strengthen with time at rest, or only as they slip.

    References
    ----------
    J. H. Dieterich, Modeling of rock friction, J. Geophys. Res. 84 (1979) 2161-2168;
    A. Ruina, Slip instability and state variable friction laws, J. Geophys. Res. 88 (1983) 10359-10370;
    J. R. Rice, Y. Ben-Zion, Slip complexity in earthquake fault models, Proc. Natl. Acad. Sci. USA 93 (1996) 3811-3818.

    Examples
    --------
    >>> law = RateState(mu0=0.6, a=0.01, b=0.015, Dc=1e-5, v0=1e-6)
    >>> round(law.force(v=1e-6, z=0.0, zdot=0.0, load=1.0), 6), round(law.rate(v=1e-6, z=0.0, load=1.0), 9)
    (0.6, 0.0)
    >>> round(law.critical_stiffness(load=1e6), 3)
    500000000.0
    """

    mu0: float = field(metadata=MU0)
    a: float = field(
        metadata=quantity(
            "direct effect of the speed",
            "1",
            "a",
            example=0.01,
            rule=positive,
            allowed="a positive number, mostly 0.005 to 0.02",
            range=(1e-3, 0.05),
        )
    )
    b: float = field(
        metadata=quantity(
            "effect of the age", "1", "b", example=0.02, rule=at_least(0.0), allowed="zero or more, mostly 0.005 to 0.03", range=(0.0, 0.05)
        )
    )
    Dc: float = field(
        metadata=quantity("slip that renews the contacts", "m", "D_{c}", example=2e-6, rule=positive, range=(1e-7, 2e-5), shown="µm")
    )
    v0: float = field(metadata=quantity("reference speed", "m/s", "v_{0}", example=1e-3, rule=positive, range=(1e-5, 1e-2), shown="mm/s"))
    evolution: str = "aging"

    def _check(self, problems: Problems) -> None:
        if self.evolution not in _LAWS:
            problems.add(f'evolution = {self.evolution!r}; allowed is "aging" or "slip"; type evolution="aging"')
        if not problems.mistakes and not everywhere(self.mu0 <= _MOST * self.a):
            problems.add(f"a = {self.a!r} is less than mu0/{_MOST:g}; allowed is more; type for example a={0.02 * self.mu0!r}")

    def start(self, load: Numeric) -> Any:
        """The state of steady sliding at v0."""
        return 0.0

    def rate(self, v: Numeric, z: Numeric, load: Numeric) -> Any:
        """Rate of the logarithm of the age [1/s]."""
        u = abs(v) / self.v0
        if self.evolution == "aging":
            return (exp(-z) - u) * (self.v0 / self.Dc)
        return -u * (0.5 * log(u * u + _STILL) + z) * (self.v0 / self.Dc)

    def force(self, v: Numeric, z: Any, zdot: Any, load: Numeric) -> Any:
        """Friction force R [N]."""
        return self.a * load * asinh(0.5 * v / self.v0 * exp((self.mu0 + self.b * z) / self.a))

    def steady(self, v: Numeric, load: Numeric) -> Any:
        """Friction force at steady speed [N]."""
        return self.force(v, -log(abs(v) / self.v0), 0.0, load)

    def critical_stiffness(self, load: Numeric) -> Any:
        """Stiffness of a spring below which steady sliding is unstable, (b - a) N / Dc, without inertia [N/m]."""
        return (self.b - self.a) * load / self.Dc

    def scale(self, load: Numeric) -> Any:
        """A typical state: the logarithm of an age [-]."""
        return 1.0

    def slip_length(self, load: Numeric) -> Any:
        """Slip over which the state changes [m]."""
        return self.Dc

    def creep_velocity(self, z: Any, load: Numeric) -> Any:
        """Velocity up to which friction is proportional to it [m/s]: the contact creeps with such velocities under small forces."""
        return 2 * self.v0 * exp(-(self.mu0 + self.b * z) / self.a)

    def velocity_scale(self) -> Any:
        """The speed about which the logarithm is written [m/s]."""
        return self.v0

    def notes(self, load: Numeric) -> list[str]:
        """Remarks on this law for the user."""
        if everywhere(self.a >= self.b):
            return ["a >= b: friction grows with the speed, and this law makes no stick-slip by itself"]
        return []
