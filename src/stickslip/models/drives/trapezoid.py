"""A trapezoidal velocity profile with smooth ramps: the two-phase drive as a controller realises it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import ArrayLike, Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import everywhere
from stickslip.basics.maths import bisected, maximum, where, within
from stickslip.basics.quantities import PERIOD, positive, quantity
from stickslip.models.drives.drive import PeriodicDrive, completed, six_digits

_EXAMPLE = "Trapezoid(u1=0.05, u2=0.4, ramp=0.01, period=0.25)"


@dataclass(frozen=True, eq=False, init=False)
class Trapezoid(PeriodicDrive):
    r"""Relative velocity :math:`+u_1`, a ramp, :math:`-u_2`, a ramp back; it begins with the plateau of +u1.

    On a ramp of duration r the velocity goes from one plateau to the other as :math:`S(\sigma) = 6\sigma^5-15\sigma^4+10\sigma^3`,
    :math:`\sigma = t/r`. So the velocity has two and the acceleration one continuous derivative; the largest acceleration is
    :math:`\tfrac{15}{8}(u_1+u_2)/r`. Without ramps it is a `TwoPhase`.

    Parameters
    ----------
    u1, u2 : float
        Relative speeds of the plateaus, forwards and backwards [m/s].
    ramp : float
        Duration of each ramp [s]; below T min(u1, u2)/(u1 + u2), so that both plateaus are left.
    period : float
        Period T [s]. Give it, or `frequency`, or `stroke`; more must agree.
    frequency : float, optional
        Frequency [Hz].
    stroke : float, optional
        Stroke of the inner mass [m].

    Examples
    --------
    >>> drive = Trapezoid(u1=0.05, u2=0.4, ramp=0.01, period=0.25)
    >>> [round(b, 6) for b in drive.breaks], round(drive.stroke, 6)
    ([0.212222, 0.222222, 0.24], 0.010798)
    """

    u1: float = field(metadata=quantity("relative speed forwards", "m/s", "u_{1}", example=0.05, rule=positive, range=(0.01, 0.5)))
    u2: float = field(metadata=quantity("relative speed backwards", "m/s", "u_{2}", example=0.4, rule=positive, range=(0.01, 1.0)))
    ramp: float = field(
        metadata=quantity(
            "duration of a ramp",
            "s",
            "r",
            example=0.01,
            rule=positive,
            range=(1e-3, 0.012),
            shown="ms",
            allowed="a positive time [s] (without ramps it is a TwoPhase)",
        )
    )
    period: float = field(metadata=PERIOD | {"example": 0.25, "range": (0.05, 0.6)})

    def __init__(
        self,
        u1: ArrayLike | None = None,
        u2: ArrayLike | None = None,
        ramp: ArrayLike | None = None,
        period: ArrayLike | None = None,
        frequency: ArrayLike | None = None,
        stroke: ArrayLike | None = None,
    ):
        ways = {"period": lambda T: T, "frequency": lambda f: 1 / f, "stroke": self._period_of}
        given = {"period": period, "frequency": frequency, "stroke": stroke}
        completed(self, _EXAMPLE, ("u1", "u2", "ramp"), ways, u1=u1, u2=u2, ramp=ramp, **given)

    def _check(self, problems: Problems) -> None:
        if problems.mistakes:
            return
        total = (self.u1 + self.u2) * self.ramp
        if not everywhere((total < self.period * self.u1) & (total < self.period * self.u2)):
            problems.add(
                f"ramp = {six_digits(self.ramp)} with period = {six_digits(self.period)} leaves no plateau; allowed is below "
                "T u/(u1 + u2), u being the smaller speed; type a shorter ramp, a longer period, or a MultiHarmonic"
            )

    @property
    def breaks(self) -> tuple[Any, ...]:
        """Ends of the first plateau, of the ramp and of the second plateau [s]."""
        total = self.u1 + self.u2
        turned = self.period * self.u2 / total
        return (turned - self.ramp, turned, self.period - self.ramp)

    @property
    def velocity_scale(self) -> float:
        """The larger of the two speeds [m/s]."""
        return maximum(self.u1, self.u2)

    @property
    def _half_turn(self) -> Any:
        """Way from the beginning of a ramp to the standstill in it, over its duration [m/s]."""
        total = self.u1 + self.u2
        sigma = _inverse(self.u1 / total)
        return self.u1 * sigma - total * _risen(sigma)

    @property
    def stroke(self) -> float:
        """From end to end [m]."""
        return self.u1 * self.breaks[0] + 2 * self.ramp * self._half_turn

    def _period_of(self, stroke: Numeric) -> Any:
        """The period with this stroke [s]."""
        return ((stroke - 2 * self.ramp * self._half_turn) / self.u1 + self.ramp) * (self.u1 + self.u2) / self.u2

    def _pieces(self, t: Numeric, first: Any, down: Any, second: Any, up: Any) -> Any:
        """One of four functions: of the time s in the period, on a ramp of sigma."""
        s, (e1, e2, e3) = within(t, self.period), self.breaks
        ramps = down(s, (s - e1) / self.ramp), up(s, (s - e3) / self.ramp)
        return where(s < e1, first(s), where(s < e2, ramps[0], where(s < e3, second(s), ramps[1])))

    def position(self, t: Numeric) -> Any:
        """Relative position, 0 where the period begins [m]."""
        u1, u2, turn = self.u1, self.u2, (self.u1 + self.u2) * self.ramp
        _, e2, e3 = self.breaks
        crest = u1 * e2 - 0.5 * turn
        last = crest - u2 * (e3 - e2)
        return self._pieces(
            t,
            lambda s: u1 * s,
            lambda s, sigma: u1 * s - turn * _risen(sigma),
            lambda s: crest - u2 * (s - e2),
            lambda s, sigma: last - u2 * (s - e3) + turn * _risen(sigma),
        )

    def velocity(self, t: Numeric) -> Any:
        """Relative velocity [m/s]."""
        u1, u2, total = self.u1, self.u2, self.u1 + self.u2
        return self._pieces(
            t, lambda s: u1, lambda s, sigma: u1 - total * _rise(sigma), lambda s: -u2, lambda s, sigma: total * _rise(sigma) - u2
        )

    def acceleration(self, t: Numeric) -> Any:
        """Relative acceleration [m/s^2]."""
        steep = (self.u1 + self.u2) / self.ramp
        return self._pieces(
            t, lambda s: 0.0, lambda s, sigma: -steep * _slope(sigma), lambda s: 0.0, lambda s, sigma: steep * _slope(sigma)
        )


def _rise(sigma: Any) -> Any:
    """From 0 to 1 with two derivatives that are zero at both ends [-]."""
    return sigma * sigma * sigma * ((6 * sigma - 15) * sigma + 10)


def _risen(sigma: Any) -> Any:
    """Integral of `_rise` [-]."""
    square = sigma * sigma
    return square * square * ((sigma - 3) * sigma + 2.5)


def _slope(sigma: Any) -> Any:
    """Derivative of `_rise` [-]."""
    half = sigma * (1 - sigma)
    return 30 * half * half


def _inverse(level: Any) -> Any:
    """Where `_rise` reaches a level between 0 and 1, by halving [-]."""
    low, high = bisected(lambda sigma: _rise(sigma) < level, 0.0, 1.0, 60)
    return 0.5 * (low + high)
