"""Three-phase acceleration control: push, quick return, brake."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import ArrayLike, Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import describe, everywhere
from stickslip.basics.maths import maximum, sqrt, where, within
from stickslip.basics.quantities import positive, quantity
from stickslip.models.drives.drive import PeriodicDrive, completed

_EXAMPLE = "ThreePhase(u1=0.3, w1=10.0, w2=60.0, w3=12.0)"


@dataclass(frozen=True, eq=False, init=False)
class ThreePhase(PeriodicDrive):
    r"""Relative accelerations :math:`+w_1, -w_2, +w_3`: from rest to :math:`+u_1`, on to :math:`-u_3`, and back to rest.

    .. math:: u_3 = u_1\sqrt{\frac{1/w_1+1/w_2}{1/w_2+1/w_3}}

    closes the motion. A period begins with :math:`\xi = \dot\xi = 0` and the phase of +w1. For large w2 the phase of -w2 is a jerk; the
    change of velocity in it, u1 + u3, is kept to the last digit however short the phase is.

    Parameters
    ----------
    u1 : float
        Largest relative speed forwards [m/s]. Give it, or `stroke`, or `u3`; more must agree.
    w1, w2, w3 : float
        Sizes of the accelerations [m/s^2].
    stroke : float, optional
        Stroke, u1^2/2 (1/w1 + 1/w2) [m].
    u3 : float, optional
        Largest relative speed backwards [m/s].

    References
    ----------
    F. L. Chernousko, On the motion of a body containing a movable internal mass; *Doklady Physics* 50 (2005) 593-597.

    Examples
    --------
    >>> drive = ThreePhase(u1=0.3, w1=10.0, w2=60.0, w3=12.0)
    >>> round(drive.stroke, 12), round(drive.u3, 6), [round(b, 6) for b in drive.breaks]
    (0.00525, 0.324037, [0.03, 0.040401])
    """

    u1: float = field(metadata=quantity("speed in the first phase", "m/s", "u_{1}", example=0.3, rule=positive, range=(0.05, 1.0)))
    w1: float = field(
        metadata=quantity("acceleration in the first phase", "m/s^2", "w_{1}", example=10.0, rule=positive, range=(1.0, 60.0))
    )
    w2: float = field(
        metadata=quantity("acceleration in the second phase", "m/s^2", "w_{2}", example=60.0, rule=positive, range=(1.0, 120.0))
    )
    w3: float = field(
        metadata=quantity("acceleration in the third phase", "m/s^2", "w_{3}", example=12.0, rule=positive, range=(1.0, 60.0))
    )

    def __init__(
        self,
        u1: ArrayLike | None = None,
        w1: ArrayLike | None = None,
        w2: ArrayLike | None = None,
        w3: ArrayLike | None = None,
        stroke: ArrayLike | None = None,
        u3: ArrayLike | None = None,
    ):
        ways = {
            "u1": lambda u: u,
            "stroke": lambda L: sqrt(2 * L / (1 / self.w1 + 1 / self.w2)),
            "u3": lambda u: u * sqrt((1 / self.w2 + 1 / self.w3) / (1 / self.w1 + 1 / self.w2)),
        }
        completed(self, _EXAMPLE, ("w1", "w2", "w3"), ways, u1=u1, w1=w1, w2=w2, w3=w3, stroke=stroke, u3=u3)

    def _check(self, problems: Problems) -> None:
        if not problems.mistakes and not everywhere(self._turned > self._pushed):
            problems.add(f"w2 = {describe(self.w2)} makes the return too short for double precision; allowed is less; type w2=1e12")

    @property
    def u3(self) -> float:
        """Largest relative speed backwards [m/s]."""
        return self.u1 * sqrt((1 / self.w1 + 1 / self.w2) / (1 / self.w2 + 1 / self.w3))

    @property
    def _pushed(self) -> Any:
        """End of the first phase [s]."""
        return self.u1 / self.w1

    @property
    def _turned(self) -> Any:
        """End of the second phase [s]."""
        return self._pushed + (self.u1 + self.u3) / self.w2

    @property
    def _return(self) -> Any:
        """Acceleration of the second phase, as its rounded ends have it: w2 to rounding, but exact in the change of velocity [m/s^2]."""
        return (self.u1 + self.u3) / (self._turned - self._pushed)

    @property
    def period(self) -> float:
        """u1/w1 + (u1 + u3)/w2 + u3/w3 [s]."""
        return self._turned + self.u3 / self.w3

    @property
    def breaks(self) -> tuple[Any, ...]:
        """Where the acceleration jumps within a period [s]."""
        return (self._pushed, self._turned)

    @property
    def stroke(self) -> float:
        """From end to end [m]."""
        return 0.5 * self.u1**2 * (1 / self.w1 + 1 / self.w2)

    @property
    def velocity_scale(self) -> float:
        """The larger of u1 and u3 [m/s]."""
        return maximum(self.u1, self.u3)

    def position(self, t: Numeric) -> Any:
        """Relative position, from 0 to the stroke and back [m]."""
        s = within(t, self.period)
        r, left = s - self._pushed, self.period - s
        middle = 0.5 * self.u1 * self._pushed + r * (self.u1 - 0.5 * self._return * r)
        return where(s < self._pushed, 0.5 * self.w1 * s**2, where(s < self._turned, middle, 0.5 * self.w3 * left**2))

    def velocity(self, t: Numeric) -> Any:
        """Relative velocity [m/s]."""
        s = within(t, self.period)
        middle, last = self.u1 - self._return * (s - self._pushed), -self.w3 * (self.period - s)
        return where(s < self._pushed, self.w1 * s, where(s < self._turned, middle, last))

    def acceleration(self, t: Numeric) -> Any:
        """Relative acceleration [m/s^2]; at a break it is that of the phase that begins."""
        s = within(t, self.period)
        return where(s < self._pushed, self.w1, where(s < self._turned, -self._return, self.w3))
