"""Bang-bang control: full acceleration one way, then the other."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import ArrayLike, Numeric
from stickslip.basics.maths import sqrt, where, within
from stickslip.basics.quantities import PERIOD, positive, quantity
from stickslip.models.drives.drive import PeriodicDrive, completed

_EXAMPLE = "BangBang(a1=20.0, a2=40.0, period=0.03)"


@dataclass(frozen=True, eq=False, init=False)
class BangBang(PeriodicDrive):
    r"""Relative acceleration :math:`+a_1` for :math:`t_1`, then :math:`-a_2` for :math:`t_2`, with :math:`a_1t_1 = a_2t_2 = 2V`.

    The relative velocity is a triangle from -V to V; it begins at -V, with the phase of +a1. Equal accelerations are the symmetric
    bang-bang; unequal ones act longer on the weaker side. Moved in time by t1/2 it is a `ThreePhase` with w1 = w3 = a1 and w2 = a2.

    Parameters
    ----------
    a1 : float
        First acceleration [m/s^2].
    a2 : float
        Size of the second acceleration [m/s^2]; a1 if left out.
    period : float
        Period [s]. Give it, or `frequency`, or `stroke`, or `t1` or `t2`; more must agree.
    frequency : float, optional
        Frequency [Hz].
    stroke : float, optional
        Stroke of the inner mass, V^2/2 (1/a1 + 1/a2) [m].
    t1, t2 : float, optional
        Durations of the phases [s].

    Examples
    --------
    >>> drive = BangBang(a1=20.0, a2=40.0, period=0.03)
    >>> round(drive.t1, 12), round(drive.velocity_scale, 12)
    (0.02, 0.2)
    """

    a1: float = field(metadata=quantity("first acceleration", "m/s^2", "a_{1}", example=20.0, rule=positive, range=(2.0, 100.0)))
    a2: float = field(metadata=quantity("second acceleration", "m/s^2", "a_{2}", example=40.0, rule=positive, range=(2.0, 100.0)))
    period: float = field(metadata=PERIOD)

    def __init__(
        self,
        a1: ArrayLike | None = None,
        a2: ArrayLike | None = None,
        period: ArrayLike | None = None,
        frequency: ArrayLike | None = None,
        stroke: ArrayLike | None = None,
        t1: ArrayLike | None = None,
        t2: ArrayLike | None = None,
    ):
        ways = {
            "period": lambda T: T,
            "frequency": lambda f: 1 / f,
            "stroke": lambda L: sqrt(8 * L * (1 / self.a1 + 1 / self.a2)),
            "t1": lambda t: t * (self.a1 + self.a2) / self.a2,
            "t2": lambda t: t * (self.a1 + self.a2) / self.a1,
        }
        a2 = a1 if a2 is None else a2
        completed(self, _EXAMPLE, ("a1",), ways, a1=a1, a2=a2, period=period, frequency=frequency, stroke=stroke, t1=t1, t2=t2)

    @property
    def t1(self) -> float:
        """Duration of the phase of +a1, T a2/(a1 + a2) [s]."""
        return self.period * self.a2 / (self.a1 + self.a2)

    @property
    def t2(self) -> float:
        """Duration of the phase of -a2 [s]."""
        return self.period * self.a1 / (self.a1 + self.a2)

    @property
    def velocity_scale(self) -> float:
        """V, the largest relative velocity [m/s]."""
        return 0.5 * self.a1 * self.t1

    @property
    def stroke(self) -> float:
        """From end to end [m]."""
        return 0.5 * self.velocity_scale**2 * (1 / self.a1 + 1 / self.a2)

    @property
    def breaks(self) -> tuple[Any, ...]:
        """Where the acceleration changes within a period [s]."""
        return (self.t1,)

    def position(self, t: Numeric) -> Any:
        """Relative position, 0 at the change of phase [m]."""
        s = within(t, self.period)
        r = s - self.t1
        return where(s < self.t1, s * (0.5 * self.a1 * s - self.velocity_scale), r * (self.velocity_scale - 0.5 * self.a2 * r))

    def velocity(self, t: Numeric) -> Any:
        """Relative velocity [m/s]."""
        s = within(t, self.period)
        return where(s < self.t1, self.a1 * s - self.velocity_scale, self.velocity_scale - self.a2 * (s - self.t1))

    def acceleration(self, t: Numeric) -> Any:
        """Relative acceleration [m/s^2]."""
        return where(within(t, self.period) < self.t1, self.a1, -self.a2)
