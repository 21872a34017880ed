"""Curves on which a number of the motion is zero: grazings, borders at which a rest, a mode or an impact begins, and events of one's own.

The number (see `touches`) is one more equation beside those of the periodic motion. Where it is smooth on one side only, as of a stop that
is not yet hit, the curve is followed a little on that side, and continued to zero by a cubic from motions at four distances.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, SolveError
from stickslip.dynamics.continuation.branches import Branch
from stickslip.dynamics.continuation.curves.multipliers import CONDITIONS, has_multiplier
from stickslip.dynamics.continuation.curves.problems import CurveProblem
from stickslip.dynamics.continuation.following.path_kinds import path_of
from stickslip.dynamics.continuation.following.pseudo_arclength import Path
from stickslip.dynamics.continuation.one_parameter import Family
from stickslip.dynamics.continuation.special_points.accuracy import Special
from stickslip.dynamics.continuation.special_points.near_grazings import BOTH_SIDES, Touch, touches
from stickslip.dynamics.continuation.special_points.own_events import number_of
from stickslip.dynamics.periodic.newton import Root

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


_TOLERANCE = {True: 1e-10, False: 1e-12}  # of the equations: where runs have a tolerance, and where they are exact
_KNOWN = {True: 1e-10, False: 1e-12}  # of its size: how well the number is known
_BESIDE = (1e-2, 1e-3, 1e-4, 1e-5)  # of the branch's range: how far from the special point motions are compared
_STRAIGHT, _STRAIGHTER = 0.2, 0.01  # of the number: what falls to zero in a straight line to within this is touched; no other is asked then
_ASKED = 6  # motions of the branch that are asked what they nearly touch
_SMALL = 1e-9  # of its size: a number that is zero anyway
_DISTANCE = 1e-4  # of its size: the number on the curve, where it holds on one side only
_NEAR = 0.08  # of the motion: how far the instant may lie from where it was
_HALF = 0.5  # of a period: where the window begins in which instants are looked for


class _Vanishing(NamedTuple):
    """Which number vanishes at a special point: how large it can be, when in the motion it is asked, and two motions towards the point."""

    straight: float
    touch: Touch
    phase: float
    near: tuple[Array, float]
    far: tuple[Array, float]


def touch_problem(both: Family, branch: Branch, special: Special, origin: Array, span: Array) -> tuple[CurveProblem, Array]:
    """The equations of a curve of such points, and its first point."""
    vanishing = _vanishing(branch, special)
    if vanishing is None:
        why = "no velocity, gap, guard or room of a rest was found that falls to zero there in a straight line"
        raise InputError("special_curve", [f"it is a {special.kind}, and what is touched there is not known: {why}; {_EACH}"])
    path = path_of(both, special.orbit, origin, span)
    problem = _Touching(path, path.remembered(special.orbit), special.kind, vanishing.touch, vanishing.phase).problem()
    distance = 0.0 if vanishing.touch.what[0] == BOTH_SIDES else _DISTANCE * vanishing.touch.size
    (near, a), (far, b) = vanishing.near, vanishing.far
    begin = near + (distance - a) / (b - a) * (far - near)
    return problem, np.append(begin, 0.0)


_AT_ONCE = "both conditions hold at once here"
_EACH = "type ss.continuation at each value"


def event_problem(both: Family, branch: Branch, special: Special, origin: Array, span: Array) -> tuple[CurveProblem, Array]:
    """The equations of a curve of a user-defined event, and its first point."""
    event, path = branch.events[special.kind], path_of(both, special.orbit, origin, span)
    memory = path.remembered(special.orbit)
    size = max(abs(number_of(special.kind, event, orbit)) for orbit in branch.orbits) or 1.0

    def number(way: Path, u: Array) -> float:
        return number_of(special.kind, event, way.orbit_at(u, memory)) / size

    return _problem(path, memory, special.kind, number), path.scaled(special.orbit, origin)


def _problem(
    path: Path, memory: Array, kind: str, number: Callable[[Path, Array], float], distance: float = 0.0, **more: Any
) -> CurveProblem:
    """The periodic motions of which a number, about 1 elsewhere, has a value; where it holds on both sides, with folds and flips."""
    rough = path.has_tolerance

    def residuals(U: Array, worse: bool = False) -> Array:
        way = path.loosened() if worse else path
        return np.column_stack([way.misses(U, memory), [number(way, u) - distance for u in U]])

    def returned(u: Array, worse: bool = False) -> Array:
        return path.returned(path.derivatives(u[None, :], memory, worse)[1][0])

    def tests(root: Root, tangent: Array, facing: Array, worse: bool = False) -> tuple[dict[str, float], Array]:
        R = returned(root.at, worse)
        return {name: float(condition(R)) for name, condition in CONDITIONS.items()}, facing

    def named(u: Array, name: str) -> tuple[str, str] | None:
        return (f"{kind}-{name}", _AT_ONCE) if has_multiplier(name, np.linalg.eigvals(returned(u))) else None

    known = np.append(np.zeros(path.at.smooth), _KNOWN[rough])
    again = (lambda U: residuals(U, True)) if rough else None
    more |= {} if "beside" in more else {"tests": tests, "named": named}
    orbit = partial(path.orbit_at, memory=memory)
    return CurveProblem(path.family, path.origin, path.span, residuals, orbit, _TOLERANCE[rough], again=again, known=known, **more)


@dataclass
class _Touching:
    """A number of motions along a curve; when in the motion it is asked goes on from each point to the next."""

    path: Path
    memory: Array
    kind: str
    touch: Touch
    phase: float

    def problem(self, times: int = 1) -> CurveProblem:
        """The problem so many times as far from the curve as it is followed, where it is followed beside it."""
        if self.touch.what[0] == BOTH_SIDES:
            return _problem(self.path, self.memory, self.kind, self.value, apart=self.followed)
        return _problem(self.path, self.memory, self.kind, self.value, _DISTANCE * times, apart=self.followed, farther=self.problem)

    def value(self, path: Path, u: Array) -> float:
        """The number at a place, in its size; NaN where there is none about then."""
        extreme = self._at(path, u)
        return float("nan") if extreme is None else extreme[1] / self.touch.size

    def followed(self, u: Array) -> str:
        """Go on from a point of the curve; why it ends there."""
        extreme = self._at(self.path, u)
        if extreme is None:
            return "what is touched was lost"
        self.phase = extreme[0]
        return ""

    def _at(self, path: Path, u: Array) -> tuple[float, float] | None:
        """When in the motion it is, and the number."""
        run, whole, T = path.longer_run(u, self.memory)
        near = [(_apart(t.t / whole, self.phase), t) for t in _within(run, whole, T, lambda what: what == self.touch.what)]
        apart, touch = min(near, key=lambda item: item[0], default=(np.inf, None))
        if touch is None or apart > _NEAR:
            return None
        t, value = touch.extremum()
        return (t / whole) % 1.0, value


def _within(run: Trajectory, whole: float, T: float, asked: Callable[[Any], bool] = lambda what: True) -> Iterator[Touch]:
    """The numbers of a motion from a run that is longer: of a window of its length, off the beginning and the end of the run."""
    return (touch for touch in touches(run, T, asked) if _HALF * T <= touch.t < _HALF * T + whole)


def _apart(a: float, b: float) -> float:
    """How far two phases of a motion are apart."""
    return abs((a - b + 0.5) % 1.0 - 0.5)


# ---- which number it is ----
def _vanishing(branch: Branch, special: Special) -> _Vanishing | None:
    """The number that falls to zero, in the straightest line, towards a special point, from one side of it or the other."""
    span, best = float(np.ptp(branch.values)) or 1.0, None
    for k, after in _nearest_motions(branch, special):
        path, side = path_of(branch.family, branch.orbits[k], special.value, span), float(np.sign(branch.values[k] - special.value))
        u, then = (path.scaled(branch.orbits[i], branch.values[i]) for i in (k, after))
        along = (then - u) / (then[-1] - u[-1])
        candidates = [candidate for share in _BESIDE for candidate in _towards(path, branch.orbits[k], u, along, side * share)]
        best = min(candidates + ([best] if best else []), key=lambda candidate: candidate.straight, default=None)
        if best is not None and best.straight < _STRAIGHTER:
            return best
    return best if best is not None and best.straight < _STRAIGHT else None


def _nearest_motions(branch: Branch, special: Special) -> Iterator[tuple[int, int]]:
    """The motions of a branch that are nearest to a special point, each with its neighbour that is farther away."""
    away = abs(branch.values - special.value)
    for k in np.argsort(away)[:_ASKED]:
        farther = [i for i in (int(k) - 1, int(k) + 1) if 0 <= i < len(away) and away[i] > away[k] > 0.0]
        if farther:
            yield int(k), max(farther, key=lambda i: away[i])


def _towards(path: Path, orbit: Any, u: Array, along: Array, away: float) -> list[_Vanishing]:
    """The numbers of two motions, one twice as far from the special point as the other, by how straight they fall to zero there."""
    memory, motions = path.remembered(orbit), []
    for times in (1.0, 2.0):
        guess = u + (times * away - u[-1]) * along
        try:
            root = path.at_value(guess, path.value(guess), memory)
            run, whole, T = path.longer_run(root.at, memory)
        except (SolveError, InputError):
            return []
        if not root.good:
            return []
        motions.append((root.at, whole, list(_within(run, whole, T))))
    (near, length, here), (far, longer, there) = motions
    candidates = []
    for touch in here:
        alike = [(_apart(touch.t / length, other.t / longer), other) for other in there if other.what == touch.what]
        apart, other = min(alike, key=lambda item: item[0], default=(np.inf, None))
        if other is None or apart > _NEAR:
            continue
        (t, a), (_, b) = touch.extremum(), other.extremum()
        if abs(b) > _SMALL * touch.size and abs(a) < abs(b):
            candidates.append(_Vanishing(abs(2 * a - b) / abs(b), touch, (t / length) % 1.0, (near, a), (far, b)))
    return candidates
