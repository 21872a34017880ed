"""One stretch of a run: integrated by scipy with side and memories held, up to the first event, which is located to rounding."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.errors import SolveError
from stickslip.solvers.plain.dense import Part, part_of
from stickslip.solvers.plain.equations import LOAD, SLIP, Equations, Memory
from stickslip.solvers.request import Request
from stickslip.summary import STATUS

__all__ = ["NAMES", "Stretch", "integrate"]

NAMES = {"radau": "Radau", "lsoda": "LSODA", "bdf": "BDF", "dop853": "DOP853"}
_ONE_STEP = ("DOP853", "Radau")  # these begin a step anew without loss, so that an event is landed on by a step of its own
_LOOKS = np.arange(-1, 10) / 8  # where in a step guards are looked at, and beside it
_HALVINGS = 60
_NOTHING = 1e-100  # a velocity that a body at rest gets from the least velocity at which laws are asked
_NOT_A_NUMBER = 4
_LITTLE = 1e-6  # of the load at the start: a dynamic law grows infinitely stiff where the load falls to zero
_MOMENT = 1e-7  # of a period: how far ahead a guard that begins at zero is looked at


@dataclass
class Stretch:
    """What came of a stretch: where it ended, the parts of its dense output, and the guard that ended it (None: its time was over)."""

    t: float
    y: Any
    parts: list[Part]
    fired: int | None
    steps: int = 0
    evaluations: int = 0


class _Step:
    """One step of an integrator with its dense output, and the guards along it."""

    def __init__(self, equations: Equations, solver: Any, before: Any, side: int, memory: Memory):
        self.equations, self.side, self.memory = equations, side, memory
        self.start, self.end, self.dense = float(solver.t_old), float(solver.t), solver.dense_output()
        self.before, self.after = before, solver.y.copy()

    def part(self, end: float | None = None) -> Part:
        """The step as dense output, or its beginning up to a time."""
        end, after = (self.end, self.after) if end is None else (end, self.dense(end))
        return part_of(self.dense, self.start, end, self.before, after, self.side, self.memory, self.equations.cyclic)

    def guards(self, t: float) -> list[float]:
        return self.equations.guards(t, self.dense(t), self.side, self.memory)

    def first_event(self, before: list[float], fresh: set[int]) -> tuple[float, int] | None:
        """Time and number of the guard that falls to zero first; `fresh` ones have just begun at zero and rise."""
        times = self.start + _LOOKS * (self.end - self.start)
        values = np.array([before if look == 0.0 else self.guards(float(t)) for look, t in zip(_LOOKS, times, strict=True)])
        found: tuple[float, int] | None = None
        for k in range(values.shape[1]):
            end = self.end if found is None else found[0]
            if found is not None and self._holds_until(k, end, times, values[:, k]):
                t = self._dip(k, times, values[:, k], end)
            else:
                t = self._root(k, times, values[:, k], k in fresh)
            found = (t, k) if t is not None and (found is None or t < found[0]) else found
        return found

    def _holds_until(self, k: int, t: float, times: Any, g: Any) -> bool:
        """Whether a guard is positive at t and at all looks before."""
        return bool(np.all(g[2:][times[2:] <= t] >= 0)) and self.guards(t)[k] > 0

    def _root(self, k: int, times: Any, g: Any, fresh: bool) -> float | None:
        below = np.flatnonzero(g[2:-1] < (-_NOTHING if k == SLIP else 0.0)) + 2
        if len(below) == 0:
            return self._dip(k, times, g, self.end)
        last = int(below[0])
        if last > 2 or not fresh:
            dip = self._dip(k, times, g, float(times[last - 1]))
            return self._zero(k, float(times[last - 1]), float(times[last])) if dip is None else dip
        for j in range(1, _HALVINGS):
            t = self.start + (float(times[2]) - self.start) * 0.5**j
            if self.guards(t)[k] > 0:
                return self._zero(k, t, float(times[2]))
        return self.start

    def _zero(self, k: int, low: float, high: float) -> float:
        from scipy.optimize import brentq

        if self.guards(low)[k] <= 0:
            return low
        return float(brentq(lambda t: self.guards(t)[k], low, high, xtol=1e-300, rtol=1e-15))

    def _dip(self, k: int, times: Any, g: Any, end: float) -> float | None:
        """The zero of a guard that is below zero only between two looks; the looks beside the step serve for its ends."""
        from scipy.optimize import minimize_scalar

        for i in range(1, len(g) - 1):
            bend = g[i - 1] - 2 * g[i] + g[i + 1]
            if min(g[i - 1], g[i + 1]) >= g[i] > 0 and bend > 0 and g[i] < (g[i + 1] - g[i - 1]) ** 2 / (6 * bend) + 0.05 * bend:
                lowest = minimize_scalar(lambda t: self.guards(t)[k], bounds=(times[i - 1], times[i + 1]), method="bounded")
                first = max(float(times[i - 1]), self.start)
                if lowest.fun < 0 and first < lowest.x and (t := self._zero(k, first, float(lowest.x))) < end:
                    return t
        return None


def integrate(todo: Request, equations: Equations, t: float, y: Any, end: float, side: int, memory: Memory) -> Stretch:
    """Integrate up to the first event, or to `end`."""
    right = equations.right(side, memory)
    guards = equations.guards(t, y, side, memory)
    fresh, at_once = _begin(equations, right, t, y, side, memory, guards)
    if at_once is not None:
        return Stretch(t, y, [], at_once)
    solver = _solver(todo, equations, right, t, y, end)
    done = Stretch(t, y, [], None)
    while solver.status == "running":
        step = _advance(todo, equations, solver, end, side, memory)
        if step is None:
            done.t, done.y, done.fired = float(solver.t), solver.y.copy(), LOAD
            return done
        done.steps += 1
        event = step.first_event(guards, fresh)
        if event is not None:
            done.evaluations += solver.nfev
            return _landed(todo, equations, step, event, done)
        guards, fresh = step.guards(step.end), set()
        done.parts.append(step.part())
    done.t, done.y, done.evaluations = end, solver.y.copy(), done.evaluations + solver.nfev
    return done


def _begin(
    equations: Equations, right: Any, t: float, y: Any, side: int, memory: Memory, guards: list[float]
) -> tuple[set[int], int | None]:
    """Guards that begin at zero and rise, and one that begins at zero and falls: an event at once."""
    fresh = {k for k, g in enumerate(guards) if g <= 0.0}
    if fresh <= {SLIP}:
        return fresh, None
    later = equations.guards(t + _MOMENT * equations.scale_of_time, _later(right, t, y, _MOMENT * equations.scale_of_time), side, memory)
    return fresh, next((k for k in sorted(fresh - {SLIP}) if later[k] < guards[k]), None)


def _later(right: Any, t: float, y: Any, moment: float) -> Any:
    """The state a moment later, to second order: a position moves although its velocity begins at zero."""
    middle = np.asarray(y) + 0.5 * moment * np.asarray(right(t, y))
    return np.asarray(y) + moment * np.asarray(right(t + 0.5 * moment, middle))


def _solver(todo: Request, equations: Equations, right: Any, t: float, y: Any, end: float, first: float | None = None) -> Any:
    import scipy.integrate

    model, T = equations.model, equations.scale_of_time
    speed = float(model.velocity_scale) or 1.0
    typical = equations.law.scale(equations.load(t, float(y[0])))
    inner = np.full(equations.inner, speed * T) if typical is None else np.asarray(typical, float)
    atol = 0.01 * todo.rtol * np.concatenate([[speed * T, speed], np.where(inner > 0, inner, speed * T)])
    method = getattr(scipy.integrate, NAMES.get(todo.method, "DOP853"))
    options = {} if first is None else {"first_step": first}
    return method(right, t, y, end, rtol=max(todo.rtol, 3e-14), atol=atol, max_step=0.1 * T, **options)


def _advance(todo: Request, equations: Equations, solver: Any, end: float, side: int, memory: Memory) -> _Step | None:
    """One step; None where the load is so small that no step is short enough, `SolveError` if it failed otherwise."""
    before = solver.y.copy()
    with np.errstate(all="ignore"):
        message = solver.step()
    if solver.status == "failed" and equations.load(float(solver.t), float(before[0])) <= _LITTLE * equations.first_load:
        return None
    if solver.status == "failed" or not np.all(np.isfinite(solver.y)):
        why = message if np.all(np.isfinite(solver.y)) else STATUS[_NOT_A_NUMBER]
        raise SolveError(
            f"scipy's {NAMES.get(todo.method, 'DOP853')} stopped at t = {solver.t:.6g} s of {end:.6g} s: {why}; try another rtol or method"
        )
    return _Step(equations, solver, before, side, memory)


def _landed(todo: Request, equations: Equations, step: _Step, event: tuple[float, int], done: Stretch) -> Stretch:
    """The stretch ended at an event: its last step is taken once more, but only up to there."""
    done.t, done.fired = event
    if done.t - step.start <= 4 * np.spacing(abs(step.start)):
        done.t, done.y = step.start, step.before
    elif NAMES.get(todo.method, "DOP853") in _ONE_STEP:
        _land(todo, equations, step, done)
    else:
        done.y = step.dense(done.t)
        done.parts.append(step.part(done.t))
    if done.fired == SLIP:
        done.y = np.array(done.y)
        done.y[1] = equations.rest
        if done.parts:
            done.parts[-1].end_at_rest(equations.rest)
    return done


def _land(todo: Request, equations: Equations, step: _Step, done: Stretch) -> None:
    """Land on the event with steps of their own, and correct its time until the guard is zero to rounding."""
    for _ in range(4):
        again = _again(todo, equations, step, done.t)
        done.y = again[-1].after
        moved = _correction(equations, step, done.t, done.y, done.fired or SLIP)
        if not step.start < done.t + moved <= step.end or abs(moved) <= 2 * np.spacing(done.t):
            break
        done.t += moved
    done.parts += [taken.part() for taken in again]


def _again(todo: Request, equations: Equations, step: _Step, end: float) -> list[_Step]:
    """The step once more, but only up to `end`."""
    right = equations.right(step.side, step.memory)
    solver = _solver(todo, equations, right, step.start, step.before, end, end - step.start)
    taken: list[_Step] = []
    while solver.status == "running" and (one := _advance(todo, equations, solver, end, step.side, step.memory)) is not None:
        taken.append(one)
    return taken or [step]


def _correction(equations: Equations, step: _Step, t: float, y: Any, k: int) -> float:
    """How much later a guard is zero, by its slope along the motion; 0 where it only grazes."""
    right, moment = equations.right(step.side, step.memory), 1e-4 * (step.end - step.start)
    slope_of_y = np.asarray(right(t, y))
    early, now, late = (equations.guards(t + d, np.asarray(y) + d * slope_of_y, step.side, step.memory)[k] for d in (-moment, 0.0, moment))
    slope = (late - early) / (2 * moment)
    if k == LOAD or slope >= 0.0 or abs(now) > 0.05 * abs(slope) * (step.end - step.start):
        return 0.0
    return -now / slope
