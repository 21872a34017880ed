"""One run from its start to its end: stretch by stretch, event by event."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np

from stickslip.errors import SolveError
from stickslip.machine import machine_of
from stickslip.pieces import PolynomialPieces
from stickslip.solvers.plain.dense import Part, joined, resting
from stickslip.solvers.plain.equations import LOAD, SLIP, Equations, Memory
from stickslip.solvers.plain.stretch import Stretch, integrate
from stickslip.solvers.request import Request

__all__ = ["march"]

_GRID = 400  # looks per period at the offered force of a stuck body
_CHUNK = 4096
_EVENTS = 20_000  # events in one period that are taken for chatter
_LOST = 6


def march(todo: Request, model: Any, case: int) -> tuple[PolynomialPieces, dict[str, Any], int]:
    """The dense output of one case, what it cost, and how it ended (0, or 6 where the contact was lost)."""
    equations = Equations(model)
    run = _Run(todo, equations, todo.start[case])
    end = float(np.ravel(todo.span)[case if np.ndim(todo.span) else 0]) * todo.periods
    end = end if todo.duration is None else min(end, todo.duration)
    known = _known(model, end)
    for i, (first, last) in enumerate(itertools.pairwise(known)):
        if len(known) > 2:
            equations.between(first[0], last[0])
        if i:
            run.throw(first[1])
        run.go(last[0])
        if run.lost:
            break
    return joined(run.parts, run.t, equations.cyclic), run.counts, _LOST if run.lost else 0


def _known(model: Any, end: float) -> list[tuple[float, float]]:
    """The instants that are known beforehand, with the impulse at each: start, breaks, impulses, borders of their periods, end."""
    breaks = machine_of(model).breaks
    jumps: dict[float, float] = {}
    for s, jump in machine_of(model).impulses:
        jumps[float(s)] = jumps.get(float(s), 0.0) + float(jump)
    if not breaks and not jumps:
        return [(0.0, 0.0), (end, 0.0)]
    T = float(model.period)
    inside = sorted({0.0, *breaks, *jumps})
    known = [(k * T + s, jumps.get(s, 0.0)) for k in range(math.ceil(end / T)) for s in inside]
    return [*((t, jump) for t, jump in known if t < end - 1e-12 * T), (end, 0.0)]


class _Run:
    """A run on its way: its state, its mode, the memories of its law, and the parts of its dense output."""

    def __init__(self, todo: Request, equations: Equations, start: Any):
        self.todo, self.equations, self.t, self.y = todo, equations, 0.0, np.array(start[: 2 + equations.inner], float)
        self.memory: Memory = tuple(int(m) for m in start[2 + equations.inner :])
        self.parts: list[Part] = []
        self.counts, self.lost = {"steps": 0, "evaluations": 0, "restarts": 0}, False
        self.since, self.events = 0.0, 0
        equations.first_load = float(equations.load(0.0, float(self.y[0])))
        if equations.first_load <= 0.0:
            raise SolveError("the load is not positive at the start, so there is no contact; give a start or a drive with a positive load")
        self.mode = equations.side(0.0, self.y, 0, self.memory)

    def throw(self, jump: float) -> None:
        """An impulse: v jumps, x and z stay."""
        if jump == 0.0:
            if self.mode == 0 or self._slip() == 0.0:
                self._ask(self.mode)
            return
        before = self._slip()
        self.y[1] += jump
        if before * self._slip() <= 0.0:
            self._pass_zero()
        self._ask(0)

    def _slip(self) -> float:
        return float(self.equations.model.contact_velocity(float(self.y[1])))

    def _ask(self, before: int) -> None:
        self.mode = self.equations.side(self.t, self.y, before, self.memory)

    def go(self, end: float) -> None:
        """Run up to a time, or until the contact is lost."""
        while self.t < end and not self.lost:
            if self.mode == 0:
                self._rest(end)
            else:
                self._move(end)
            self.counts["restarts"] += 1
            self._count()
        if not self.lost:
            self.t = end

    def _count(self) -> None:
        """Stop a run that chatters."""
        if self.t > self.since + self.equations.scale_of_time:
            self.since, self.events = self.t, 0
        self.events += 1
        if self.events > _EVENTS:
            raise SolveError(
                f"there were {self.events} events in the period at t = {self.t:.6g} s; try another rtol (now {self.todo.rtol:g}) or method"
            )

    def _move(self, end: float) -> None:
        stretch = integrate(self.todo, self.equations, self.t, self.y, end, self.mode, self.memory)
        self.parts += stretch.parts
        self.counts["steps"] += stretch.steps
        self.counts["evaluations"] += stretch.evaluations
        self.t, self.y = stretch.t, np.array(stretch.y, float)
        self._take(stretch)

    def _take(self, stretch: Stretch) -> None:
        """Do what the event says."""
        if stretch.fired == SLIP:
            self._pass_zero()
            self._ask(self.mode)
        elif stretch.fired == LOAD:
            self.lost = True
        elif stretch.fired is not None:
            self._switch(self.equations.slip(self.y, self.mode), stretch.fired - 2)

    def _switch(self, slip: float, k: int) -> None:
        """One switch of the law's memory."""
        _, memory, z = self.equations.switches(self.t, self.y, slip, self.memory)[k]
        self.memory = tuple(int(m) for m in memory)
        if z is not None:
            self.y[2:] = z

    def _pass_zero(self) -> None:
        """The velocity at the contact is zero."""
        z, memory = self.equations.passed_zero(self.t, self.y, self.mode or 1, self.memory)
        self.y[2:], self.memory = z, tuple(map(int, memory))

    def _rest(self, end: float) -> None:
        """Stuck until the forces break it away, or the contact is lost."""
        e, start, x = self.equations, self.t, float(self.y[0])
        self.t, self.mode, self.lost = _break_away(e, start, x, end)
        self.parts.append(resting(start, self.t, self.y, e.rest, e.cyclic))
        self.y[0] = x + e.rest * (self.t - start)


def _break_away(e: Equations, start: float, x: float, end: float) -> tuple[float, int, bool]:
    """When a stuck body breaks away, which way, and whether it loses contact before; the end of the interval if neither happens."""

    def guards(t: Any) -> Any:
        """Positive while it rests: forward, backward, and the load."""
        place = x + e.rest * (t - start)
        up, down = e.excess(t, place)
        return np.stack(np.broadcast_arrays(-up, -down, e.load(t, place)))

    count = max(math.ceil((end - start) / e.scale_of_time * _GRID), 1)
    for first in range(0, count, _CHUNK):
        t = start + (end - start) * np.arange(first, min(first + _CHUNK, count) + 1) / count
        found = [(s, k) for k, g in enumerate(guards(t)) if (s := _fall(lambda s, k=k: float(guards(float(s))[k]), t, g)) is not None]
        if found:
            s, k = min(found)
            return s, (1, -1, 0)[k], k == 2
    return end, 0, False


def _fall(g: Any, t: Any, values: Any) -> float | None:
    """The first zero of g, given at times t; also one that lies between two of them."""
    from scipy.optimize import brentq, minimize_scalar

    below = np.flatnonzero(values < 0)
    last = int(below[0]) if len(below) else len(t) - 1
    for i in range(1, last):
        if min(values[i - 1], values[i + 1]) >= values[i] and values[i] <= abs(values[i + 1] - values[i - 1]) + abs(
            values[i - 1] - 2 * values[i] + values[i + 1]
        ):
            lowest = minimize_scalar(g, bounds=(t[i - 1], t[i + 1]), method="bounded", options={"xatol": 1e-12 * (t[i + 1] - t[i - 1])})
            if lowest.fun < 0:
                return float(brentq(g, t[i - 1], lowest.x, xtol=1e-300, rtol=1e-15)) if g(t[i - 1]) > 0 else float(t[i - 1])
    if not len(below):
        return None
    if last == 0 or g(t[last - 1]) <= 0:
        return float(t[max(last - 1, 0)])
    return float(brentq(g, t[last - 1], t[last], xtol=1e-300, rtol=1e-15))
