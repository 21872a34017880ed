"""A motion followed along a number by continuation of its orbit: both ends of its range, their accuracy, and its stability."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import takewhile
from typing import Any

from stickslip.show.paper.words import digits_within

__all__ = ["End", "Followed", "stable_range"]

#: Tolerances of the continuation, and of the refined border.
RTOL, TIGHT = 1e-8, 1e-10
#: Relative distance of the second starting point of the secant from the border.
_ASIDE = 1e-4
_WHY = {
    "flip": "doubles its period", "fold": "turns back at a fold", "neimark-sacker": "turns into a torus",
    "branch-point": "meets another branch",
    "half": "merges with the motion of half its period", "range": "was followed no further", "lost": "could not be followed",
}  # fmt: skip


@dataclass(frozen=True)
class End:
    """The end of a stable motion.

    Parameters
    ----------
    value : float
        Value of the parameter.
    kind : str
        "flip", "fold", "neimark-sacker", "branch-point", "half" (it merges with the motion of half its period), "range" (it continues),
        or "lost".
    accuracy : float or None
        Accuracy of the value: that of the branch's special point, or its change when the tolerance is reduced to a hundredth; 0 if no
        border was sought, None if unknown.
    """

    value: float
    kind: str
    accuracy: float | None

    @property
    def why(self) -> str:
        """The event at this end, in words."""
        return _WHY[self.kind]

    def text(self, scale: float = 1e3) -> str:
        """The value times a scale, with no digit beyond its accuracy; with three decimals if that is unknown."""
        if self.kind == "range":
            return f"{scale * self.value:g}"
        return digits_within(scale * self.value, 1e-3 if self.accuracy is None else scale * self.accuracy)


@dataclass(frozen=True)
class Followed:
    """A stable motion from one end to the other.

    Parameters
    ----------
    parameter : str
    low, high : End
    period : int
        Drive periods until it repeats.
    multiplier : float
        The largest modulus of a multiplier of the orbits between the ends; it is 1 at a border.
    orbits : int
        Number of computed orbits.
    """

    parameter: str
    low: End
    high: End
    period: int
    multiplier: float
    orbits: int


def stable_range(
    parameter: str, start: float, low: float, high: float, period: int = 1, fixed: dict[str, Any] | None = None, **how: Any
) -> Followed:
    """Follow the stable motion at `start` down and up, to the first border at which it loses stability, or to the ends of the range.

    `fixed` are other numbers of the robot; `how`, such as guess, step, points and rtol, is for `stable_branch`.
    """
    how, fixed = {"step": 0.2, "points": 100, "rtol": RTOL} | how, fixed or {}
    ends: list[End] = []
    sizes: list[float] = []
    for stop in (low, high):
        if stop == start:
            ends.append(End(start, "range", 0.0))
            continue
        branch = _branch(parameter, start, stop, period=period, **how, **fixed)
        end, orbit = _end(branch, stop)
        ends.append(_sharpened(branch, end, orbit, fixed) if end.kind == "half" else end)
        sizes += list(takewhile(lambda size: size < 1, (float(abs(o.multipliers[0])) for o in branch.orbits)))
    return Followed(parameter, ends[0], ends[1], period, max(sizes, default=math.nan), len(sizes))


def _branch(parameter: str, start: float, stop: float, **more: Any) -> Any:
    from stickslip.dynamics.continuation.branches import stable_branch
    from stickslip.models.presets import piezo_rig

    return stable_branch(piezo_rig, parameter, start, stop, tilt_deg=1.7, **more)


def _end(branch: Any, stop: float) -> tuple[End, Any]:
    """The end of a branch, where the motion loses its stability or the continuation stops; and the orbit there."""
    border, last = next((s for s in branch.special if s.changes_stability), None), float(branch.values[-1])
    if border is not None:
        return End(border.value, border.kind, border.accuracy), border.orbit
    if abs(last - stop) <= 1e-9 * abs(stop):
        return End(stop, "range", 0.0), branch.orbits[-1]
    halved = branch.period % 2 == 0 and branch.ended.startswith("it returned")
    return End(last, "half" if halved else "lost", None), branch.orbits[-1]


def _sharpened(branch: Any, end: End, orbit: Any, fixed: dict[str, Any]) -> End:
    """The point where a motion merges with that of half its period, whose multiplier is -1 there; by a secant method on its orbits.

    It is computed with the branch's tolerance and with `TIGHT`; the difference is its accuracy.
    """
    period = branch.period // 2

    def beyond(value: float, rtol: float) -> float:
        from stickslip.dynamics.periodic.periodic_orbits import periodic_orbit
        from stickslip.models.presets import piezo_rig

        robot = piezo_rig(**{"tilt_deg": 1.7, **fixed, branch.parameter: value})
        return float(periodic_orbit(robot, period, guess=orbit.state, rtol=rtol).multipliers[0].real) + 1.0

    rough = _secant(lambda value: beyond(value, branch.orbits[0].rtol), end.value, _ASIDE * end.value)
    if rough is None:
        return End(end.value, "lost", None)
    sharp = _secant(lambda value: beyond(value, TIGHT), rough, _ASIDE * end.value)
    return End(rough, end.kind, None) if sharp is None else End(sharp, end.kind, abs(sharp - rough))


def _secant(test: Callable[[float], float], at: float, aside: float) -> float | None:
    """A zero of a function near a value; None if it is further away than a hundredth of the value, or not found."""
    last, here, was = at + aside, at, test(at + aside)
    for _ in range(8):
        now = test(here)
        step = -now * (here - last) / (now - was) if now != was else 0.0
        if not abs(here + step - at) < 0.01 * abs(at):
            return None
        last, was, here = here, now, here + step
        if abs(step) < 1e-3 * aside:  # the secant method converges superlinearly: what remains is the rounding of the multipliers
            return here
    return None
