"""The bristle model: bonds that bend, snap and form again at a random place."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.models.friction.coefficients import MU_MINUS, MU_PLUS, POSITIVE, SIGMA0
from stickslip.models.friction.law import Law
from stickslip.models.friction.sides import alone_or_all, by_side, each

_MASK = (1 << 64) - 1


@dataclass(frozen=True, eq=False)
class Bristle(Law):
    r"""Anisotropic bristle model, a dynamic law whose bonds snap when they are bent too far, and form again at random.

    .. math:: R = \frac{\sigma_0}{n}\sum_i z_i, \qquad \dot z_i = v, \qquad
              z_i = \pm\delta_\pm \;\to\; z_i = \pm U\delta_\pm, \qquad \delta_\pm = \tfrac32\,\frac{\mu_\pm N}{\sigma_0}

    with U uniform between 0 and 1, our reading of "a random location relative to the previous one": the mean force in sliding is then
    :math:`\mu_\pm N`, with noise that falls with the number of bristles. Fresh bristles, all at z = 0, snap together and hold up to
    1.5 times as much. U is a function of the seed, the bristle and how often it has snapped (its mode), so a run can be repeated
    bit for bit. It cannot be compiled, and is solved one case at a time.

    Parameters
    ----------
    mu_plus, mu_minus : float
        Mean friction coefficients in sliding, forwards and backwards [-].
    sigma0 : float
        Stiffness of all bristles together [N/m].
    bristles : int
        Number of bristles.
    seed : int
        Seed of the random positions.

    References
    ----------
    D. A. Haessig, B. Friedland, On the modeling and simulation of friction,
    ASME J. Dynamic Systems, Measurement, and Control 113 (1991) 354-362.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.friction.Bristle(mu_plus=0.15, mu_minus=0.21, sigma0=4e5)
    >>> law.states
    10
    >>> z = (1e-7,) * 10
    >>> round(law.force(v=1e-3, z=z, zdot=(1e-3,) * 10, load=0.7, mode=(0,) * 10), 9)
    0.04
    """

    mu_plus: float = field(metadata=MU_PLUS | POSITIVE)
    mu_minus: float = field(metadata=MU_MINUS | POSITIVE)
    sigma0: float = field(metadata=SIGMA0)
    bristles: int = 10
    seed: int = 0

    scalar_only: ClassVar[bool] = True
    random: ClassVar[bool] = True
    states = modes = property(attrgetter("bristles"), doc="Number of inner states, and of memories.")

    def _check(self, problems: Problems) -> None:
        problems.whole("bristles", self.bristles, 1, example=10)
        problems.whole("seed", self.seed, 0, example=0)

    def rate(self, v: Numeric, z: Numeric | tuple[Numeric, ...], load: Numeric, mode: tuple[Numeric, ...]) -> Any:
        """Every bristle bends with the body [m/s]."""
        return alone_or_all((v,) * self.bristles)

    def force(self, v: Numeric, z: Numeric, zdot: Numeric, load: Numeric, mode: tuple[Numeric, ...]) -> Any:
        """Friction force R [N]."""
        return self.sigma0 / self.bristles * sum(each(z))

    def switches(self, v: Numeric, z: tuple[Numeric, ...], load: Numeric, mode: Any) -> list[tuple[Any, Any, Any]]:
        """A bristle snaps where it is bent too far in the direction of motion."""
        reach = by_side(v, 1.5 * self.mu_plus, -1.5 * self.mu_minus) * load / self.sigma0  # signed
        switches: list[tuple[Any, Any, Any]] = []
        z = each(z)
        for i in range(self.bristles):
            snapped = (*mode[:i], mode[i] + 1, *mode[i + 1 :])
            bent = (*z[:i], reach * _draw(self.seed, i, int(mode[i])), *z[i + 1 :])
            switches.append((abs(reach) - by_side(v, z[i], -z[i]), snapped, alone_or_all(bent)))
        return switches

    def scale(self, load: Numeric) -> Any:
        """Typical deflections [m]."""
        return alone_or_all((0.5 * (self.mu_plus + self.mu_minus) * load / self.sigma0,) * self.bristles)

    def notes(self, load: Numeric) -> list[str]:
        """Remarks on this law for the user."""
        return [
            f"Bristle friction is random (another seed than {self.seed} gives another run), and is solved in plain Python, case by case"
        ]


@functools.lru_cache(maxsize=4096)
def _draw(seed: int, bristle: int, count: int) -> float:
    """A number from 0 to 1, the same for the same arguments on every machine (SplitMix64: Steele, Lea, Flood 2014)."""
    state = 0
    for word in (seed, bristle, count):
        state = _mix((state ^ word) + 0x9E3779B97F4A7C15 & _MASK)
    return (state >> 11) * 2.0**-53


def _mix(x: int) -> int:
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9 & _MASK
    x = (x ^ (x >> 27)) * 0x94D049BB133111EB & _MASK
    return x ^ (x >> 31)
