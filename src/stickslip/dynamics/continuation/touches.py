"""What a motion only just misses: dips of slip, gaps, guards and the room of rests, and the room with which a rest or a mode begins.

At a grazing, or a border of motion types, one of these numbers is zero. On one side of it they are smooth in the parameters, as long as the
motion crosses all else with a speed; under a dynamic law an extreme of the slip is so on both sides (di Bernardo, Budd, Champneys and
Kowalczyk, Piecewise-smooth Dynamical Systems, 2008, ch. 6 to 8).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from stickslip.analysis.contact_modes import watched_contacts
from stickslip.flow import is_flow
from stickslip.machine_adapter import machine_of

__all__ = ["BOTH_SIDES", "Touch", "touches"]

Array = Any
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

    def told(self) -> tuple[float, float]:
        """The instant and the number there."""
        low, high = self.within
        if low == high:
            return low, float(self.function(np.array([low]))[0])
        from scipy.optimize import minimize_scalar

        sign = -1.0 if self.what[-1] == "highest" else 1.0
        found = minimize_scalar(
            lambda t: sign * float(self.function(np.array([t]))[0]),
            bounds=self.within, method="bounded", options={"xatol": _DIGITS * (high - low)},
        )  # fmt: skip
        return float(found.x), sign * float(found.fun)

    @property
    def name(self) -> str:
        """What is touched, in words."""
        kind, of, *_ = self.what
        return {"stop": f"the stop {of}", "guard": f"guard {self.what[2]} of mode {of!r}" if len(self.what) > 2 else ""}.get(kind, "")


def touches(run: Any, span: float) -> Iterator[Touch]:
    """All of a run with its dense output, of a machine or of a flow; `span` is how long a period takes, or a cycle.

    Kinds are "slip" (an extreme of a slip, under a dynamic law), "slide" (a dip of its speed), "rest" (a dip of the room that the friction
    at rest leaves), "begins" (that room where a rest begins), "stop" (a dip of a gap), "guard" (of a flow), and "enters" (a guard where its
    mode begins).
    """
    yield from _of_flow(run, span) if is_flow(run.model) else _of_machine(run, span)


def _dips(what: tuple[Any, ...], f: Callable[[Array], Array], begin: float, end: float, span: float, size: float = 0.0) -> Iterator[Touch]:
    """Where a function of time has a dip within a stretch, or something highest where that is asked for."""
    if not end > begin:
        return
    t = np.linspace(begin, end, max(_GRID, int(np.ceil(_OF_A_PERIOD * (end - begin) / span))) + 1)
    values = f(t)
    size = max(size, float(abs(values).max()))
    signed = -values if what[-1] == "highest" else values
    left, here, right = signed[:-2], signed[1:-1], signed[2:]
    for k in 1 + np.flatnonzero((here <= left) & (here < right) & (np.maximum(left, right) - here > _SHALLOW * size)):
        yield Touch(what, float(t[k]), (float(t[k - 1]), float(t[k + 1])), size, f)


# ---- machines ----
def _of_machine(run: Any, span: float) -> Iterator[Touch]:
    machine = machine_of(run.model)
    first, last = float(run.pieces.t[0]), float(run.pieces.t[-1])
    for i, (name, watched) in enumerate(watched_contacts(run).items()):
        slip = _slip(watched.run, machine, i)
        if watched.law.dynamic:
            for end in ("lowest", "highest"):
                yield from _dips((BOTH_SIDES, name, end), slip, first, last, span, float(machine.velocity_scale))
        else:
            yield from _of_contact(name, watched, slip, first, last, span)
    if not machine.is_single:
        yield from _of_stops(run.parted, machine.mechanics, span)


def _slip(run: Any, machine: Any, number: int) -> Callable[[Array], Array]:
    """The slip of one contact as a function of time."""

    def slip(t: Array) -> Array:
        _, v, _ = run._states_at(t, run._index(t))
        if machine.is_single:
            return np.asarray(run.model.contact_velocity(v))
        mechanics = machine.mechanics
        return np.broadcast_to(mechanics.slips(t, mechanics.coordinates_of(tuple(v.T)))[number], t.shape)

    return slip


def _of_contact(name: str, watched: Any, slip: Callable[[Array], Array], first: float, last: float, span: float) -> Iterator[Touch]:
    """Of a contact that rests exactly."""
    nodes, modes = np.asarray(watched.run.pieces.t), np.asarray(watched.modes)
    turns = np.flatnonzero(np.diff(modes)) + 1
    for begin, end, mode in zip([first, *nodes[turns]], [*nodes[turns], last], modes[np.append(0, turns)], strict=True):
        if mode:
            yield from _dips(("slide", name, int(mode)), lambda t, side=int(mode): side * slip(t), begin, end, span)
            continue
        for side in (1, -1):

            def room(t: Array, side: int = side) -> Array:
                low, high = watched.limits(t)
                return np.asarray(high - watched.offered(t) if side > 0 else watched.offered(t) - low)

            size = float(max(abs(limit).max() for limit in watched.limits(np.array([begin, 0.5 * (begin + end)]))))
            yield from _dips(("rest", name, side), room, begin, end, span, size)
            if begin > first:
                yield Touch(("begins", name, side), begin, (begin, begin), size, room)


def _of_stops(run: Any, mechanics: Any, span: float) -> Iterator[Touch]:
    """Of each stop, between its hits."""
    for name, stop in mechanics.named_stops:

        def gap(t: Array, stop: Any = stop) -> Array:
            x = run._states_at(t, run._index(t))[0]
            return np.broadcast_to(stop.gap(t, mechanics.coordinates_of(tuple(x.T))), t.shape)

        struck = [event.t for event in run.events if event.kind == "hit" and event.part == name]
        size = float(abs(gap(run.t)).max())
        for begin, end in pairwise([float(run.pieces.t[0]), *struck, float(run.pieces.t[-1])]):
            yield from _dips(("stop", name), gap, begin, end, span, size)


# ---- flows ----
def _of_flow(run: Any, span: float) -> Iterator[Touch]:
    """Of each guard of each mode, between the switches."""
    first, last, flow = float(run.nodes[0]), float(run.nodes[-1]), run.model.plain
    begins = [first, *(event.t for event in run.events)]
    modes = [run._labels(np.array([0]))[0], *(event.after for event in run.events)]
    for begin, end, mode in zip(begins, [*begins[1:], last], modes, strict=True):
        for k, switch in enumerate(flow.switches.get(mode, ()) if end > begin else ()):

            def guard(t: Array, g: Callable[..., Any] = switch.guard) -> Array:
                return np.array([float(g(s, y)) for s, y in zip(t, run._evaluated(t, run._index(t)), strict=True)])

            size = float(abs(guard(np.linspace(begin, end, _GRID))).max())
            yield from _dips(("guard", mode, k), guard, begin, end, span, size)
            if begin > first:
                yield Touch(("enters", mode, k), begin, (begin, begin), size, guard)
