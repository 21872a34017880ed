"""Two-phase velocity control: the inner mass goes slowly one way and fast the other, and turns in no time."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.maths import maximum, where, within
from stickslip.basics.quantities import STROKE, positive, quantity
from stickslip.models.drives.drive import PeriodicDrive, agree, given_numbers, six_digits, taken

_EXAMPLE = "TwoPhase(stroke=0.01, u1=0.05, u2=0.4)"
_TYPED = f"type for example {_EXAMPLE}"


class Wedge(PeriodicDrive):
    """Base of the motions with two speeds: they have a stroke, the speeds u1 and u2, and their durations t1 and t2."""

    @property
    def period(self: Any) -> float:
        """Both phases together [s]."""
        return self.t1 + self.t2

    @property
    def jumps(self: Any) -> tuple[tuple[Any, Any], ...]:
        """The two jumps of the relative velocity: (instant [s], jump [m/s])."""
        both = self.u1 + self.u2
        return ((0.0, both), (self.t1, -both))

    @property
    def velocity_scale(self: Any) -> float:
        """The larger of the two speeds [m/s]."""
        return maximum(self.u1, self.u2)

    def position(self: Any, t: Numeric) -> Any:
        """Relative position, from 0 to the stroke and back [m]."""
        s = within(t, self.period)
        return where(s < self.t1, self.u1 * s, self.u2 * (self.period - s))

    def velocity(self: Any, t: Numeric) -> Any:
        """Relative velocity [m/s]; at a jump it is the velocity after it."""
        return where(within(t, self.period) < self.t1, self.u1, -self.u2)

    def acceleration(self: Any, t: Numeric) -> Any:
        """Relative acceleration between the jumps: zero [m/s^2]."""
        return 0.0 * t


@dataclass(frozen=True, eq=False, init=False)
class TwoPhase(Wedge):
    r"""Relative velocity :math:`+u_1` for :math:`L/u_1`, then :math:`-u_2` for :math:`L/u_2`; it begins with the phase of +u1.

    The relative velocity jumps, so the velocity of the body jumps too, by :math:`-\mu(u_1+u_2)` where a period begins and by
    :math:`+\mu(u_1+u_2)` at :math:`t_1 = L/u_1`. They are treated as impulses.

    Parameters
    ----------
    stroke : float
        Stroke L of the inner mass [m].
    u1, u2 : float
        Relative speeds forwards and backwards [m/s].
    t1, t2 : float, optional
        Durations of the phases [s]. Give any three of stroke, u1, u2, t1, t2 that determine the rest; more must agree with stroke = u1 t1 =
        u2 t2.

    References
    ----------
    F. L. Chernousko, Analysis and optimization of the motion of a body controlled by means of a movable internal mass; *Journal of
    Applied Mathematics and Mechanics* 70 (2006) 819-842.

    Examples
    --------
    >>> drive = TwoPhase(stroke=0.01, u1=0.05, u2=0.4)
    >>> round(drive.period, 12), [(round(t, 12), round(jump, 12)) for t, jump in drive.jumps]
    (0.225, [(0.0, 0.45), (0.2, -0.45)])
    >>> round(TwoPhase(u1=0.05, t1=0.2, t2=0.025).u2, 12)
    0.4
    """

    stroke: float = field(metadata=STROKE)
    u1: float = field(metadata=quantity("relative speed forwards", "m/s", "u_{1}", example=0.05, rule=positive, range=(0.01, 0.5)))
    u2: float = field(metadata=quantity("relative speed backwards", "m/s", "u_{2}", example=0.4, rule=positive, range=(0.01, 1.0)))

    def __init__(self, stroke: Any = None, u1: Any = None, u2: Any = None, t1: Any = None, t2: Any = None):
        problems = Problems("TwoPhase")
        known = given_numbers(problems, _EXAMPLE, stroke=stroke, u1=u1, u2=u2, t1=t1, t2=t2)
        problems.check()
        own = _completed(known, problems)
        problems.check()
        taken(self, **own)

    @property
    def t1(self) -> float:
        """Duration of the phase of +u1 [s]."""
        return self.stroke / self.u1

    @property
    def t2(self) -> float:
        """Duration of the phase of -u2 [s]."""
        return self.stroke / self.u2


def _completed(known: dict[str, Any], problems: Problems) -> dict[str, Any]:
    """Stroke and speeds from any three numbers that settle them; contradictions are noted."""
    known = dict(known)
    for _ in range(2):  # the first phase may give the stroke that the second one needs, and the other way round
        for u, t in (("u1", "t1"), ("u2", "t2")):
            _complete_phase(known, u, t, problems)
    missing = [name for name in ("stroke", "u1", "u2") if name not in known]
    if missing:
        names = ", ".join(known) or "what was given"
        problems.add(f"{names} does not settle {', '.join(missing)}; allowed is any three that do, as stroke = u1 t1 = u2 t2; {_TYPED}")
    return {name: known[name] for name in ("stroke", "u1", "u2") if name in known}


def _complete_phase(known: dict[str, Any], u: str, t: str, problems: Problems) -> None:
    if u in known and t in known and "stroke" in known:
        if not agree(known[u] * known[t], known["stroke"]):
            way = six_digits(known[u] * known[t])
            problems.add(f"{u} {t} = {way} m and stroke = {six_digits(known['stroke'])} m; allowed is one stroke for both phases; {_TYPED}")
            del known[t]
    elif u in known and t in known:
        known["stroke"] = known[u] * known[t]
    elif "stroke" in known and t in known:
        known[u] = known["stroke"] / known[t]
