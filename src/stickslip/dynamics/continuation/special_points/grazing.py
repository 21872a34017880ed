"""Grazing of stops and guards: where a motion just touches one, which ends a branch of smooth motions."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.dynamics.continuation.following.cycle_paths import inverse_parabola_zero
from stickslip.dynamics.continuation.following.pseudo_arclength import Path, Point
from stickslip.dynamics.continuation.special_points.near_grazings import touches
from stickslip.models.machine_adapter import machine_of

if TYPE_CHECKING:
    from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit


_NEAR = 1e-5  # of the largest gap in the motion: what is missed by less is grazed
_SLOW = 1e-3  # of the velocity scale: a hit that slow is one that begins
_TOUCHED = ("stop", "guard")
_FAR, _AHEAD = 1e-3, 3.0  # of the range: how far back it is read how a gap falls, and times that, how far ahead it may be zero
_NEAR_BY = 1e-4  # of the range: how near to where it is zero it is read then


def grazed(orbit: PeriodicOrbit) -> str:
    """Name of what a motion grazes, by a hit without speed or by missing it by nothing; "" where there is none."""
    return _slow_hit(orbit) or next((name for name, (least, size) in _missed_by(orbit).items() if abs(least) < _NEAR * size), "")


def _missed_by(orbit: Any) -> dict[str, tuple[float, float]]:
    """By how much a motion misses each stop, or guard of a flow, where it turns away from it; and the size against which that is small."""
    run, misses = orbit.run, dict[str, tuple[float, float]]()
    span = float(run.model.period or orbit.duration)
    for touch in touches(run.with_axes, span, lambda what: what[0] in _TOUCHED):
        least = touch.extremum()[1]
        if touch.name not in misses or abs(least) < abs(misses[touch.name][0]):
            misses[touch.name] = least, touch.size
    return misses


def grazing_end(path: Path, last: Point) -> tuple[str, float, float] | None:
    """The grazing just ahead of the last point of a branch: its name, the value of the parameter, and its uncertainty."""
    ahead, far = float(np.sign(last.tangent[-1])), _FAR * path.span
    behind, now = _least_at(path, last, last.value - ahead * far), _missed_by(last.orbit)
    beyond = [far * least / fallen for name, (least, _) in now.items() if (fallen := behind.get(name, np.nan) - least) > 0.0]
    nearest = min((part for part in beyond if part >= 0.0), default=np.inf)
    return grazing_near(path, last, last.value + ahead * nearest, ahead, 0.0) if nearest < _AHEAD * far else None


def grazing_near(path: Path, point: Point, value: float, ahead: float, unsure: float) -> tuple[str, float, float] | None:
    """The grazing near a value of the parameter: its place and uncertainty; None if none is found.

    Up to there the least distance is a smooth function of the parameter. It is continued to zero, from motions before the value.
    """
    near = max(_NEAR_BY * path.span, 2 * unsure)
    values_near = [value - ahead * near * k for k in (0.5, 1.0, 2.0, 4.0)]
    read = [_least_at(path, point, value_near) for value_near in values_near]
    name = min(read[0], key=lambda name: read[0][name], default="")
    known = [(value_near, least.get(name, np.nan)) for value_near, least in zip(values_near, read, strict=True)]
    if not np.isfinite(known).all() or any(a[1] >= b[1] for a, b in pairwise(known)):
        return None
    grazing, other = inverse_parabola_zero(known[:3]), inverse_parabola_zero(known[1:])
    if abs(grazing - value) > near:
        return None
    return name, float(grazing), float(abs(grazing - other) + 10 * path.span * point.blur + 8 * np.spacing(abs(grazing)))


def _least_at(path: Path, last: Point, value: float) -> dict[str, float]:
    """By how much the motion at a value of the parameter misses everything; nothing where it is not found."""
    there = path.at_value(last.u, value, path.remembered(last.orbit))
    return {name: least for name, (least, _) in _missed_by(path.orbit(there)).items()} if there.good else {}


def _slow_hit(orbit: PeriodicOrbit) -> str:
    mechanics = orbit.at.mechanics
    if mechanics is None or not any(event.kind == "hit" for event in orbit.run.events):  # a flow has no stops
        return ""
    run, speed = orbit.run.with_axes, float(machine_of(orbit.model).velocity_scale)
    slow = [event.part for event in run.events if event.kind == "hit" and abs(event.velocity) < _SLOW * speed]
    return next((f"the stop {name}" for name, _ in mechanics.named_stops if name in slow), "") if slow else ""
