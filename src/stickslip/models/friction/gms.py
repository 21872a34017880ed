"""Generalised Maxwell slip: elements in parallel that stick and slip one after another, with memory of reversals."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import describe, everywhere
from stickslip.basics.maths import where
from stickslip.basics.quantities import positive, quantity
from stickslip.models.friction.coefficients import SIGMA2, V_S
from stickslip.models.friction.law import field_numbers
from stickslip.models.friction.sides import alone_or_all, by_side, each, fading
from stickslip.models.friction.two_sided import Bristles, Fading


def _shares(of: str, symbol: str, default: tuple[float, ...]) -> Any:
    """The field of what part each element has in something."""
    metadata = quantity(
        f"share of an element in the {of}", "1", symbol, example=default, rule=positive, allowed="several positive numbers that sum to 1"
    )
    return field(default=default, metadata=metadata)


@dataclass(frozen=True, eq=False)
class GMS(Fading, Bristles):
    r"""Anisotropic generalised Maxwell slip, a dynamic law of n elements with deflections z_i that stick or slip.

    .. math:: R = \sum_i k_i z_i + \sigma_2 v, \qquad k_i = \kappa_i \sigma_0

    .. math:: \dot z_i = v \;\text{(sticks)}, \qquad
              k_i \dot z_i = \operatorname{sgn}(v)\,C\left(\alpha_i - \frac{k_i z_i}{S}\operatorname{sgn} v\right) \;\text{(slips)}, \qquad
              S = N g_\pm(v)

    with LuGre's :math:`g_\pm`. An element sticks until its force in the direction of motion reaches :math:`\alpha_i S`, and then slips
    until v passes zero: this is discrete memory, kept as modes (0 sticks, 1 slips). Like measured contacts, and unlike a single bristle, it
    has hysteresis with non-local memory in pre-sliding, frictional lag in sliding, and no drift below break-away.

    Parameters
    ----------
    mu_plus, mu_minus : float
        Kinetic friction coefficients forwards and backwards [-].
    f_plus, f_minus : float or None
        Static friction coefficients [-]; ``None`` means the kinetic ones.
    sigma0 : float
        Stiffness of all elements together [N/m].
    v_s : float
        Stribeck velocity [m/s].
    attraction : float
        Attraction C: how fast the force of a slipping element goes to the Stribeck curve, in a time S / C [N/s].
    sigma2 : float
        Viscous friction [N s/m].
    stiffness : tuple of float
        Shares kappa_i of the stiffness, which sum to 1 [-].
    weights : tuple of float
        Shares alpha_i of the friction force, which sum to 1 [-].

    References
    ----------
    V. Lampaert, F. Al-Bender, J. Swevers, A generalized Maxwell-slip friction model appropriate for control purposes,
    Proc. IEEE Int. Conf. Physics and Control, St. Petersburg (2003) 1170-1177;
    F. Al-Bender, V. Lampaert, J. Swevers, The generalized Maxwell-slip model: a novel model for friction simulation and
    compensation, IEEE Trans. Automatic Control 50 (2005) 1883-1887.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.friction.GMS(0.15, 0.21, 0.18, 0.24, sigma0=4e5, v_s=2e-3, attraction=100.0)
    >>> law.states, law.modes
    (4, 4)
    >>> law.rate(v=1e-3, z=(0.0, 0.0, 0.0, 0.0), load=0.7, mode=(0, 0, 0, 0))
    (0.001, 0.001, 0.001, 0.001)
    """

    v_s: float = field(metadata=V_S)
    attraction: float = field(
        metadata=quantity("attraction to the Stribeck curve", "N/s", "C", example=100.0, rule=positive, range=(5.0, 500.0))
    )
    sigma2: float = field(default=0.0, metadata=SIGMA2)
    stiffness: tuple[float, ...] = _shares("stiffness", r"\kappa", (0.4, 0.3, 0.2, 0.1))
    weights: tuple[float, ...] = _shares("friction force", r"\alpha", (0.1, 0.2, 0.3, 0.4))

    def _check(self, problems: Problems) -> None:
        super()._check(problems)
        shares = {name: field_numbers(getattr(self, name)) for name in ("stiffness", "weights")}
        for name, values in shares.items():
            total = sum(values)
            if values and not everywhere(abs(total - 1.0) < 1e-9):
                given = f"{name} = {values} sum to {describe(total)}"
                problems.add(f"{given}; allowed are shares that sum to 1; divide each by their sum")
            elif getattr(self, name) == ():
                problems.add(f"{name} is empty; allowed is one share or more; type for example {name}=(0.5, 0.5)")
        counts = [len(values) for values in shares.values()]
        if all(counts) and counts[0] != counts[1]:
            problems.add(f"stiffness has {counts[0]} values and weights {counts[1]}; allowed is one of each for every element")

    @property
    def states(self) -> int:
        """Number of elements."""
        return len(self.weights)

    @property
    def modes(self) -> int:
        """Number of memories: each element sticks (0) or slips (1)."""
        return len(self.weights)

    def rate(self, v: Numeric, z: Numeric, load: Numeric, mode: tuple[Numeric, ...]) -> Any:
        """Rates of the deflections dz_i/dt [m/s]."""
        pull, signed = by_side(v, self.attraction, -self.attraction), by_side(v, 1.0, -1.0) / (load * fading(self, v))
        rates = []
        for zi, slips, kappa, alpha in zip(each(z), mode, self.stiffness, self.weights, strict=True):
            k = kappa * self.sigma0
            rates.append(where(slips > 0, pull * (alpha - k * zi * signed) / k, v))
        return alone_or_all(tuple(rates))

    def force(self, v: Numeric, z: Numeric, zdot: Numeric, load: Numeric, mode: tuple[Numeric, ...]) -> Any:
        """Friction force R [N]."""
        return self.sigma0 * sum(kappa * zi for kappa, zi in zip(self.stiffness, each(z), strict=True)) + self.sigma2 * v

    def switches(self, v: Numeric, z: tuple[Numeric, ...], load: Numeric, mode: Any) -> list[tuple[Any, Any, Any]]:
        """All elements stick when v passes zero; one slips when its force reaches its share of the Stribeck curve."""
        switches: list[tuple[Any, Any, Any]] = [(abs(v), (0,) * self.modes, None)]
        grip, z = fading(self, v), each(z)
        for i, (kappa, alpha) in enumerate(zip(self.stiffness, self.weights, strict=True)):
            left = alpha * (load * grip) - kappa * self.sigma0 * by_side(v, z[i], -z[i])
            slips = tuple(1 if j == i else mode[j] for j in range(self.modes))
            switches.append((where(mode[i] > 0, grip, left), slips, None))  # one that slips already has no event, also without a load
        return switches

    def scale(self, load: Numeric) -> Any:
        """Typical deflections: where each element begins to slip [m]."""
        whole = super().scale(load)
        return alone_or_all(tuple(alpha / kappa * whole for kappa, alpha in zip(self.stiffness, self.weights, strict=True)))
