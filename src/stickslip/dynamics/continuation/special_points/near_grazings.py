"""Near-grazings of a motion: minima of slip, gaps and guards, and margins of rests, with the margins at which a mode begins.

At a grazing, or a border of motion types, one of these numbers is zero. On one side of it they are smooth in the parameters, as long as the
motion crosses all else with a speed; under a dynamic law an extreme of the slip is so on both sides (di Bernardo, Budd, Champneys and
Kowalczyk, Piecewise-smooth Dynamical Systems, 2008, ch. 6 to 8).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stickslip.analysis.run_segments import watched_contacts
from stickslip.basics.contracts import Array
from stickslip.models.machine_adapter import machine_of
from stickslip.solvers.plain.composed_flows import composed

if TYPE_CHECKING:
    from stickslip.models.mechanics import Mechanics
    from stickslip.results.trajectory import Trajectory


BOTH_SIDES = "slip"  # the kind of touches that motions on either side have
_GRID = 64  # instants of a stretch between two switches at which it is looked, at least
_OF_A_PERIOD = 256  # and of a period
_SHALLOW = 1e-12  # of the size: a dip that shallow between neighbours on the grid is rounding
_DIGITS = 1e-13  # of a bracket: how well an instant is found; the number there is far better known


class Touch(NamedTuple):
    """One of those numbers: what it is, about when, between which instants, how large it can be, and the function of time."""

    what: tuple[Any, ...]
    t: float
    within: tuple[float, float]
    size: float
    function: Callable[[Array], Array]

    def extremum(self) -> tuple[float, float]:
        """The instant and the number there."""
        low, high = self.within
        if low == high:
            return low, float(self.function(np.array([low]))[0])
        from scipy.optimize import minimize_scalar

        sign = -1.0 if self.what[-1] == "highest" else 1.0
        result = minimize_scalar(
            lambda t: sign * float(self.function(np.array([t]))[0]),
            bounds=self.within, method="bounded", options={"xatol": _DIGITS * (high - low)},
        )  # fmt: skip
        return float(result.x), sign * float(result.fun)

    @property
    def name(self) -> str:
        """The name of the stop or guard that is touched."""
        kind, of, *more = self.what
        return f"the stop {of}" if kind == "stop" else f"guard {more[0]} of mode {of!r}" if kind == "guard" else ""


def touches(run: Trajectory, span: float, asked: Callable[[tuple[Any, ...]], bool] = lambda what: True) -> Iterator[Touch]:
    """All of a run with its dense output, of a machine or of a flow, or those that are asked for by what they are.

    Kinds are "slip" (an extreme of a slip, under a dynamic law), "slide" (a dip of its speed), "rest" (a dip of the room that the friction
    at rest leaves), "begins" (that room where a rest begins), "stop" (a dip of a gap), "guard" (of a flow), and "enters" (a guard where its
    mode begins). `span` is how long a period takes, or a cycle.
    """
    for course in _of_machine(run) if run.pieces.layout.bodies else _of_flow(run):
        if asked(course.what):
            yield from _at_its_beginning(course) if course.what[0] in _BEGIN else _dips(course, span)


class _Course(NamedTuple):
    """A number as a function of time between two instants, and how large it can be, if that is known."""

    what: tuple[Any, ...]
    function: Callable[[Array], Array]
    begin: float
    end: float
    size: Callable[[], float] = lambda: 0.0


_BEGIN = ("begins", "enters")  # kinds that are asked at the beginning of their course


def _at_its_beginning(course: _Course) -> Iterator[Touch]:
    yield Touch(course.what, course.begin, (course.begin, course.begin), course.size(), course.function)


def _dips(course: _Course, span: float) -> Iterator[Touch]:
    """Where it has a dip, or is highest where that is asked for."""
    begin, end = course.begin, course.end
    t = np.linspace(begin, end, max(_GRID, int(np.ceil(_OF_A_PERIOD * (end - begin) / span))) + 1)
    values = course.function(t)
    size = max(course.size(), float(abs(values).max()))
    signed = -values if course.what[-1] == "highest" else values
    left, here, right = signed[:-2], signed[1:-1], signed[2:]
    for k in 1 + np.flatnonzero((here <= left) & (here < right) & (np.maximum(left, right) - here > _SHALLOW * size)):
        yield Touch(course.what, float(t[k]), (float(t[k - 1]), float(t[k + 1])), size, course.function)


# ---- machines ----
def _of_machine(run: Trajectory) -> Iterator[_Course]:
    machine = machine_of(run.model)
    first, last = float(run.pieces.t[0]), float(run.pieces.t[-1])
    for i, (name, watched) in enumerate(watched_contacts(run).items()):
        slip = partial(_slip, run.with_axes, machine.mechanics, i)
        if watched.law.dynamic:
            for end in ("lowest", "highest"):
                yield _Course((BOTH_SIDES, name, end), slip, first, last, partial(float, machine.velocity_scale))
        else:
            yield from _of_contact(name, watched, slip, first, last)
    yield from _of_stops(run.with_axes, machine.mechanics)


def _slip(run: Trajectory, mechanics: Mechanics, number: int, t: Array) -> Array:
    """The slip of one contact."""
    x, v = (np.reshape(of, (len(t), -1)) for of in run._states_at(t, run._index(t))[:2])
    q, u = (mechanics.coordinates_of(tuple(of.T)) for of in (x, v))
    return np.broadcast_to(mechanics.slips(t, u, q)[number], t.shape)


def _of_contact(name: str, watched: Any, slip: Callable[[Array], Array], first: float, last: float) -> Iterator[_Course]:
    """Of a contact that rests exactly."""
    nodes, modes = np.asarray(watched.run.pieces.t), np.asarray(watched.modes)
    turns = np.flatnonzero(np.diff(modes)) + 1
    for begin, end, mode in zip([first, *nodes[turns]], [*nodes[turns], last], modes[np.append(0, turns)], strict=True):
        if mode:
            yield _Course(("slide", name, int(mode)), partial(_speed, slip, int(mode)), begin, end)
        for side in (1, -1) if not mode else ():
            room, size = partial(_room, watched, side), partial(_limit, watched, 0.5 * (begin + end))
            yield _Course(("rest", name, side), room, begin, end, size)
            if begin > first:
                yield _Course(("begins", name, side), room, begin, end, size)


def _speed(slip: Callable[[Array], Array], side: int, t: Array) -> Array:
    return side * slip(t)


def _room(watched: Any, side: int, t: Array) -> Array:
    """By how much the force that holds a contact at rest is within its limit on one side."""
    low, high = watched.limits(t)
    return np.asarray(high - watched.offered(t) if side > 0 else watched.offered(t) - low)


def _limit(watched: Any, t: float) -> float:
    return float(np.max(np.abs(watched.limits(np.array([t])))))


def _of_stops(run: Trajectory, mechanics: Mechanics) -> Iterator[_Course]:
    """Of each stop, between its hits."""
    for name, stop in mechanics.named_stops:
        gap = partial(_gap, run, mechanics, stop)
        struck = [event.t for event in run.events if event.kind == "hit" and event.part == name]
        for begin, end in pairwise([float(run.pieces.t[0]), *struck, float(run.pieces.t[-1])]):
            if end > begin:
                yield _Course(("stop", name), gap, begin, end, partial(_largest, gap, run.t[0], run.t[-1]))


def _gap(run: Trajectory, mechanics: Mechanics, stop: Any, t: Array) -> Array:
    x = run._states_at(t, run._index(t))[0]
    return np.broadcast_to(stop.gap(t, mechanics.coordinates_of(tuple(x.T))), t.shape)


def _largest(f: Callable[[Array], Array], begin: float, end: float) -> float:
    return float(abs(f(np.linspace(begin, end, _GRID))).max())


# ---- flows ----
def _of_flow(run: Any) -> Iterator[_Course]:
    """Of each guard of each mode, between the switches."""
    first, last, flow = float(run.nodes[0]), float(run.nodes[-1]), composed(run.model)
    begins = [first, *(event.t for event in run.events)]
    modes = [run._columns.labels(np.array([0]))[0], *(event.after for event in run.events)]
    for begin, end, mode in zip(begins, [*begins[1:], last], modes, strict=True):
        for k, switch in enumerate(flow.switches.get(mode, ()) if end > begin else ()):
            guard = partial(_guard, run, switch.guard)
            yield _Course(("guard", mode, k), guard, begin, end)
            if begin > first:
                yield _Course(("enters", mode, k), guard, begin, end, partial(_largest, guard, begin, end))


def _guard(run: Any, guard: Callable[..., Any], t: Array) -> Array:
    return np.array([float(guard(s, y)) for s, y in zip(t, run.pieces.states(t, run._index(t)), strict=True)])
