"""Borders of motion types in two parameters: a motion is a sequence of arcs whose switch times are unknown, a border one more equation."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import SolveError
from stickslip.dynamics.continuation.branches import Branch
from stickslip.dynamics.continuation.curves.problems import CurveProblem
from stickslip.dynamics.continuation.one_parameter import Family
from stickslip.dynamics.continuation.special_points.accuracy import Special
from stickslip.dynamics.periodic.arc_sequences import Margin, Sequence, dip, gap, margins, misses, sequence_of, slope_of_gap
from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit
from stickslip.dynamics.periodic.newton import Root, newton
from stickslip.dynamics.periodic.periodic_orbits import periodic_orbit


def type_border_problem(both: Family, branch: Branch, special: Special, origin: Array, span: Array) -> tuple[CurveProblem, Array]:
    """The equations of a curve of such a border, and its first point."""
    sequence, times, key = _vanishing(branch, special)
    k, period = len(times), special.orbit.period

    def parts(u: Array) -> tuple[Any, Array]:
        return both.robot(*(origin + span * u[k:])), u[:k]

    facing = 0.0

    def turn(u: Array) -> float:
        """Whether the force falls or grows where the border's condition holds: the border ends where that turns."""
        model, t = parts(u)
        return slope_of_gap(model, _instant(sequence, t, key) * float(model.period), key[2])

    def one(u: Array, turning: bool) -> Array:
        model, t = parts(u)
        if turning:  # a dip of the force within rest has reached its beginning
            T = float(model.period)
            last = [float(gap(model, _instant(sequence, t, key) * T, key[2])), turn(u) * T]
        else:
            last = [_dip(model, sequence, t, key) if key[0] == "rest" else margins(model, sequence, t)[key]]
        return np.append(misses(model, sequence, t), last)

    def made(u: Array) -> PeriodicOrbit:
        return periodic_orbit(parts(u)[0], period)

    def watched(u: Array) -> dict[Any, float]:
        root = {name: value for name, value in margins(parts(u)[0], sequence, u[:k]).items() if name != key and np.isfinite(value)}
        return root | {_TURN: facing * turn(u)}

    def meeting(u: Array, other: Any) -> Root:
        root = newton(lambda U: np.array([one(v, True) for v in U]), u, 1e-14, most=20, reach=0.1)
        if not root.good:
            raise SolveError(f"the point where two borders meet was not found: {root.why}")
        return root

    u = np.append(times, [0.0, 0.0])
    facing = float(np.sign(turn(u)))
    return CurveProblem(both, origin, span, lambda U: np.array([one(v, False) for v in U]), made, 1e-13, watched, meeting), u


_TURN = ("turn", 0, 0)


def _instant(sequence: Sequence, times: Array, key: Margin) -> float:
    """When the border's condition is asked, in drive periods: where rest begins, or where a slide ends."""
    if key[0] == "rest" and len(times):
        return float(times[key[1]])
    return float(sequence.ends(times)[key[1]])


def _dip(model: Model, sequence: Sequence, times: Array, key: Margin) -> float:
    """The dip of the force's room in and shortly before rest, so that the border can be followed up to where it ends."""
    T, i = float(model.period), key[1]
    begin = float(times[i]) if len(times) else 0.0
    return dip(model, (begin - 0.1) * T, float(sequence.ends(times)[i]) * T, key[2])


def _vanishing(branch: Branch, special: Special) -> tuple[Sequence, Array, Margin]:
    """The sequence on the side of the border where all arcs have length, its times at the border, and the margin that vanishes there."""
    best: tuple[float, Sequence, Array, Margin] | None = None
    for side in (-1.0, 1.0):
        for distance in (1e-4, 1e-6):
            value = special.value + side * distance * (float(np.ptp(branch.values)) or 1.0)
            orbit = branch.at(value)
            sequence, times = sequence_of(orbit)
            by_condition = margins(orbit.model, sequence, times)
            name = min(by_condition, key=lambda m: abs(by_condition[m]))
            if (
                best is None
                or len(sequence.modes) < len(best[1].modes)
                or (len(sequence.modes) == len(best[1].modes) and by_condition[name] < best[0])
            ):
                best = (by_condition[name], sequence, times, name)
    assert best is not None
    return best[1], best[2], best[3]
