"""A motion followed along a number by continuation of its orbit: where it begins and ends, how sure that is, and how stable it is."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import takewhile
from typing import Any

from stickslip.paper.words import digits_within

__all__ = ["End", "Followed", "followed"]

#: Tolerances with which an orbit is followed, and with which a border that it meets is found again.
RTOL, TIGHT = 1e-8, 1e-10
#: How far from a border the first other point of the secant lies, as a part of the parameter.
_ASIDE = 1e-4
_WHY = {
    "flip": "doubles its period", "fold": "turns back at a fold", "neimark-sacker": "turns into a torus",
    "branch-point": "meets another branch",
    "half": "merges with the motion of half its period", "range": "was followed no further", "lost": "could not be followed",
}  # fmt: skip


@dataclass(frozen=True)
class End:
    """Where a stable motion ends.

    Parameters
    ----------
    value : float
        Of the parameter.
    kind : str
        "flip", "fold", "neimark-sacker", "branch-point", "half" (it merges with the motion of half its period), "range" (it goes on), or
        "lost".
    accuracy : float or None
        Of the value: that of the branch's special point, or by how much it moves when the tolerance is a hundredth; 0 where nothing was
        looked for, None where it is not known.
    """

    value: float
    kind: str
    accuracy: float | None

    @property
    def why(self) -> str:
        """The change of the motion there."""
        return _WHY[self.kind]

    def text(self, scale: float = 1e3) -> str:
        """The value times a scale, with no digit beyond its accuracy; three decimals where that is not known."""
        if self.kind == "range":
            return f"{scale * self.value:g}"
        return digits_within(scale * self.value, 1e-3 if self.accuracy is None else scale * self.accuracy)


@dataclass(frozen=True)
class Followed:
    """A stable motion from end to end.

    Parameters
    ----------
    parameter : str
    low, high : End
    period : int
        Drive periods until it repeats.
    multiplier : float
        The largest size of a multiplier of the orbits between the ends; 1 is reached at a border.
    orbits : int
        How many were computed.
    """

    parameter: str
    low: End
    high: End
    period: int
    multiplier: float
    orbits: int


def followed(
    parameter: str, start: float, low: float, high: float, period: int = 1, guess: Any = None, step: float = 0.2, points: int = 100,
    rtol: float = RTOL, **fixed: Any,
) -> Followed:  # fmt: skip
    """Follow the stable motion at `start` down and up, to the first border where it loses its stability, or to the ends of the range."""
    ends: list[End] = []
    sizes: list[float] = []
    for stop in (low, high):
        if stop == start:
            ends.append(End(start, "range", 0.0))
            continue
        branch = _branch(parameter, start, stop, rtol=rtol, period=period, guess=guess, step=step, points=points, **fixed)
        end, orbit = _end(branch, stop)
        ends.append(_sharpened(branch, end, orbit, fixed) if end.kind == "half" else end)
        sizes += list(takewhile(lambda size: size < 1, (float(abs(o.multipliers[0])) for o in branch.orbits)))
    return Followed(parameter, ends[0], ends[1], period, max(sizes, default=math.nan), len(sizes))


def _branch(parameter: str, start: float, stop: float, **more: Any) -> Any:
    from stickslip.dynamics.continuation.branches import continuation
    from stickslip.presets import piezo_rig

    return continuation(piezo_rig, parameter=parameter, start=start, stop=stop, tilt_deg=1.7, **more)


def _end(branch: Any, stop: float) -> tuple[End, Any]:
    """Where the motion of a branch loses its stability, or the branch ends; and the orbit there."""
    border, last = next((s for s in branch.special if s.changes_stability), None), float(branch.values[-1])
    if border is not None:
        return End(border.value, border.kind, border.accuracy), border.orbit
    if abs(last - stop) <= 1e-9 * abs(stop):
        return End(stop, "range", 0.0), branch.orbits[-1]
    halved = branch.period % 2 == 0 and branch.ended.startswith("it returned")
    return End(last, "half" if halved else "lost", None), branch.orbits[-1]


def _sharpened(branch: Any, end: End, orbit: Any, fixed: dict[str, Any]) -> End:
    """Where a motion falls together with that of half its period: there the shorter one's multiplier is -1. A secant on its orbits.

    It is found at the branch's tolerance and at a hundredth of it; the difference is its accuracy.
    """
    period = branch.period // 2

    def beyond(value: float, rtol: float) -> float:
        from stickslip.dynamics.periodic.periodic_orbits import periodic_orbit
        from stickslip.presets import piezo_rig

        robot = piezo_rig(**{"tilt_deg": 1.7, **fixed, branch.parameter: value})
        return float(periodic_orbit(robot, period, guess=orbit.state, rtol=rtol).multipliers[0].real) + 1.0

    rough = _secant(lambda value: beyond(value, branch.orbits[0].rtol), end.value, _ASIDE * end.value)
    if rough is None:
        return End(end.value, "lost", None)
    sharp = _secant(lambda value: beyond(value, TIGHT), rough, _ASIDE * end.value)
    return End(rough, end.kind, None) if sharp is None else End(sharp, end.kind, abs(sharp - rough))


def _secant(test: Callable[[float], float], at: float, aside: float) -> float | None:
    """Where a test is zero, near a value; None if that is further than a hundredth of the value away, or not found."""
    last, here, was = at + aside, at, test(at + aside)
    for _ in range(8):
        now = test(here)
        step = -now * (here - last) / (now - was) if now != was else 0.0
        if not abs(here + step - at) < 0.01 * abs(at):
            return None
        last, was, here = here, now, here + step
        if abs(step) < 1e-3 * aside:  # the secant's error falls with its square: the rounding of the multipliers is reached
            return here
    return None
