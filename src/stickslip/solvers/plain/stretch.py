"""One stretch of a run: integrated by scipy with its mode held, up to the first event, which is located to rounding."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike, Numeric
from stickslip.basics.errors import SolveError
from stickslip.basics.interruption import is_stopped
from stickslip.basics.status import Status
from stickslip.solvers.plain.deciding import ROUNDING
from stickslip.solvers.plain.dense import DensePart, part_of
from stickslip.solvers.plain.guards import Guard, guards
from stickslip.solvers.plain.plain_equations import ContactModes, Equations
from stickslip.solvers.settings import Request

NAMES = {"radau": "Radau", "lsoda": "LSODA", "bdf": "BDF", "dop853": "DOP853"}
#: Degree of the polynomials between the steps of a method; those of a multistep method have that of the step's order.
_DEGREES: dict[str, Callable[[Any], int]] = {
    "radau": lambda dense: 3, "dop853": lambda dense: 7, "bdf": lambda dense: dense.order, "lsoda": lambda dense: len(dense.p) - 1,
}  # fmt: skip
_ONE_STEP = ("DOP853", "Radau")  # these begin a step anew without loss, so that an event is landed on by a step of its own
_LOOKS, _MOST_LOOKS = 8, 40  # parts of a step at whose ends guards are looked at
_GRID = 400  # looks per period at the forces on a contact that rests
_HALVINGS = 60
_LITTLE = 1e-6  # of the load at the start: a dynamic law grows infinitely stiff where the load falls to zero
_MOMENT = 1e-7  # of a period: how far ahead a guard that begins at zero is looked at
_BESIDE = 1e-4  # of a step: how far beside an event other guards are looked at


@dataclass
class Stretch:
    """The result of a stretch: its end, the parts of its dense output, and the guards that ended it (none if its time was over)."""

    t: float
    y: Any
    parts: list[DensePart]
    fired: list[Guard] = field(default_factory=list)
    steps: int = 0
    evaluations: int = 0


class _Step:
    """One step of an integrator with its dense output, and the guards along it."""

    def __init__(self, method: str, equations: Equations, solver: Any, before: Any, mode: ContactModes):
        self.equations, self.mode = equations, mode
        self.start, self.end, self.dense = float(solver.t_old), float(solver.t), solver.dense_output()
        self.degree = _DEGREES[method](self.dense)
        self.before, self.after = before, solver.y.copy()

    def part(self, end: float | None = None) -> DensePart:
        """The step as dense output, or its beginning up to a time."""
        end, after = (self.end, self.after) if end is None else (end, self.dense(end))
        return part_of(self.equations, self.dense, self.degree, self.start, end, self.before, after, self.mode)

    def guards(self, t: float, y: Any = None) -> list[float]:
        y = self.dense(t) if y is None else y
        return [guard.value for guard in guards(self.equations, t, y, self.mode, with_noise=False)]

    def first_event(self, before: list[Guard], fresh: set[int]) -> tuple[float, int] | None:
        """Time and number of the guard that falls to zero first; `fresh` ones have just begun at zero and rise."""
        times = self.start + np.arange(-1, (count := self._looks()) + 2) / count * (self.end - self.start)
        first = [guard.value for guard in before]
        states = np.ascontiguousarray(self.dense(times).T)
        values = np.array([first if n == 1 else self.guards(float(t), y) for n, (t, y) in enumerate(zip(times, states, strict=True))])
        first_zero: tuple[float, int] | None = None
        for k, guard in enumerate(before):
            end = self.end if first_zero is None else first_zero[0]
            if first_zero is not None and self._holds_until(k, end, times, values[:, k]):
                t = self._dip(k, times, values[:, k], end, guard.noise)
            else:
                t = self._root(k, times, values[:, k], k in fresh, guard.noise)
            first_zero = (t, k) if t is not None and (first_zero is None or t < first_zero[0]) else first_zero
        return first_zero

    def _looks(self) -> int:
        e = self.equations
        if 0 not in self.mode.sides:
            return _LOOKS
        return min(max(math.ceil((self.end - self.start) / e.scale_of_time * _GRID), _LOOKS), _MOST_LOOKS)

    def fired_with(self, t: float, k: int, now: list[Guard]) -> list[Guard]:
        """The guard that fired, and all others that come to zero at the same instant."""
        near = _BESIDE * (self.end - self.start)
        early, late = self.guards(t - near), self.guards(t + near)
        size = [max(abs(a), abs(b)) / _BESIDE for a, b in zip(early, late, strict=True)]
        return [now[k]] + [
            guard for j, guard in enumerate(now)
            if j != k and guard.value <= max(guard.noise, ROUNDING * size[j]) and late[j] < early[j] and late[j] < 0
        ]  # fmt: skip

    def _holds_until(self, k: int, t: float, times: Array, g: Any) -> bool:
        """Whether a guard is positive at t and at all looks before."""
        return bool(np.all(g[2:][times[2:] <= t] >= 0)) and self.guards(t)[k] > 0

    def _root(self, k: int, times: Array, g: Any, fresh: bool, noise: float) -> float | None:
        below = np.flatnonzero(g[2:-1] < -noise) + 2
        if len(below) == 0:
            return self._dip(k, times, g, self.end, noise)
        last = int(below[0])
        if last > 2 or not fresh:
            dip = self._dip(k, times, g, float(times[last - 1]), noise)
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
        return float(brentq(lambda t: self.guards(t)[k], low, high, xtol=1e-300, rtol=1e-15, maxiter=2000))

    def _dip(self, k: int, times: Array, g: Any, end: float, noise: float) -> float | None:
        """The zero of a guard that is below zero only between two looks; the looks beside the step serve for its ends."""
        from scipy.optimize import minimize_scalar

        for i in range(1, len(g) - 1):
            bend = g[i - 1] - 2 * g[i] + g[i + 1]
            if min(g[i - 1], g[i + 1]) >= g[i] > 0 and bend > 0 and g[i] < (g[i + 1] - g[i - 1]) ** 2 / (6 * bend) + 0.05 * bend:
                bounds = (times[i - 1], times[i + 1])
                lowest = minimize_scalar(
                    lambda t: self.guards(t)[k], bounds=bounds, method="bounded", options={"xatol": 1e-9 * (bounds[1] - bounds[0])}
                )
                first = max(float(times[i - 1]), self.start)
                if lowest.fun < -noise and first < lowest.x and (t := self._zero(k, first, float(lowest.x))) < end:
                    return t
        return None


def integrate(
    todo: Request, equations: Equations, t: float, y: Array, end: float, mode: ContactModes, left: Callable[[float], float]
) -> Stretch:
    """Integrate up to the first event, or to `end`, or until no more steps are left at a time."""
    right = equations.right(mode)
    before = guards(equations, t, y, mode)
    fresh, at_once = _begin(equations, right, t, y, mode, before)
    if at_once:
        return Stretch(t, y, [], at_once)
    solver = _solver(todo, equations, right, t, y, end)
    done = Stretch(t, y, [])
    while solver.status == "running":
        if is_stopped():  # whoever goes on looks too
            done.t, done.y, done.evaluations = float(solver.t), solver.y.copy(), done.evaluations + solver.nfev
            return done
        step = _advance(todo, equations, solver, end, mode)
        if step is None:
            done.t, done.y, done.fired = float(solver.t), solver.y.copy(), [guard for guard in before if guard.sort == "load"][:1]
            return done
        done.steps += 1
        event = step.first_event(before, fresh)
        if event is not None:
            done.evaluations += solver.nfev
            return _landed(todo, equations, step, event, done)
        before, fresh = guards(equations, step.end, step.after, mode), set()
        done.parts.append(step.part())
        if done.steps >= left(step.end):
            end = step.end
            break
    done.t, done.y, done.evaluations = end, solver.y.copy(), done.evaluations + solver.nfev
    return done


def _begin(equations: Equations, right: Any, t: float, y: Array, mode: ContactModes, before: list[Guard]) -> tuple[set[int], list[Guard]]:
    """Guards that begin at zero and rise, and those that begin at zero and fall: an event at once."""
    fresh = {k for k, guard in enumerate(before) if guard.value <= 0.0}
    rates = equations.slips(t, *equations.state(y))
    asked = [
        k for k in sorted(fresh)
        if before[k].sort not in ("slip", "landing") and not (before[k].sort == "gap" and rates[before[k].part] > 0.0)
    ]  # fmt: skip
    if not asked:
        return fresh, []
    moment = _MOMENT * equations.scale_of_time
    later = guards(equations, t + moment, _later(right, t, y, moment), mode)
    return fresh, [before[k] for k in asked if later[k].value < before[k].value - before[k].noise]


def _later(right: Any, t: float, y: ArrayLike, moment: float) -> Any:
    """The state a moment later, to second order: a position moves although its velocity begins at zero."""
    middle = np.asarray(y) + 0.5 * moment * np.asarray(right(t, y))
    return np.asarray(y) + moment * np.asarray(right(t + 0.5 * moment, middle))


def _solver(todo: Request, e: Equations, right: Any, t: float, y: ArrayLike, end: float, first: float | None = None) -> Any:
    import scipy.integrate

    method = getattr(scipy.integrate, NAMES[todo.method])
    options = {} if first is None else {"first_step": first}
    return method(
        right, t, y, end, rtol=max(todo.rtol, 3e-14), atol=0.01 * todo.rtol * e.sizes(t, y), max_step=0.1 * e.scale_of_time, **options
    )


def _advance(todo: Request, equations: Equations, solver: Any, end: float, mode: ContactModes) -> _Step | None:
    """One step; None where a load is so small that no step is short enough, `SolveError` if it failed otherwise."""
    before = solver.y.copy()
    with np.errstate(all="ignore"):
        message = solver.step()
    if solver.status == "failed":
        loads = equations.loads(float(solver.t), before, mode)
        if any(load <= _LITTLE * first for load, first in zip(loads, equations.first_loads, strict=True)):
            return None
    if solver.status == "failed" or not np.all(np.isfinite(solver.y)):
        why = message if np.all(np.isfinite(solver.y)) else Status.NOT_A_NUMBER.sentence
        raise SolveError(
            f"scipy's {NAMES.get(todo.method, 'DOP853')} stopped at t = {solver.t:.6g} s of {end:.6g} s: {why}; try another rtol or method"
        )
    return _Step(todo.method, equations, solver, before, mode)


def _landed(todo: Request, equations: Equations, step: _Step, event: tuple[float, int], done: Stretch) -> Stretch:
    """The stretch ended at an event: its last step is taken once more, but only up to there."""
    done.t, k = event
    if done.t - step.start <= 4 * np.spacing(abs(step.start)):
        done.t, done.y = step.start, step.before
    elif NAMES[todo.method] in _ONE_STEP:
        _land(todo, equations, step, done, k)
    else:
        done.y = step.dense(done.t)
        done.parts.append(step.part(done.t))
    done.fired = step.fired_with(done.t, k, guards(equations, done.t, done.y, step.mode))
    return done


def _land(todo: Request, equations: Equations, step: _Step, done: Stretch, k: int) -> None:
    """Land on the event with steps of their own, and correct its time until the guard is zero to rounding."""
    for _ in range(4):
        again = _again(todo, equations, step, done.t)
        done.y = again[-1].after
        moved = _correction(equations, step, done.t, done.y, k)
        if not step.start < done.t + moved <= step.end or abs(moved) <= 2 * np.spacing(done.t):
            break
        done.t += moved
    done.parts += [taken.part() for taken in again]


def _again(todo: Request, equations: Equations, step: _Step, end: float) -> list[_Step]:
    """The step once more, but only up to `end`."""
    right = equations.right(step.mode)
    solver = _solver(todo, equations, right, step.start, step.before, end, end - step.start)
    taken: list[_Step] = []
    while solver.status == "running" and (one := _advance(todo, equations, solver, end, step.mode)) is not None:
        taken.append(one)
    return taken or [step]


def _correction(equations: Equations, step: _Step, t: float, y: Numeric, k: int) -> float:
    """How much later a guard is zero, by its slope along the motion; 0 where it only grazes."""
    right, moment = equations.right(step.mode), 1e-4 * (step.end - step.start)
    slope_of_y = np.asarray(right(t, y))
    early, now, late = (guards(equations, t + d, np.asarray(y) + d * slope_of_y, step.mode)[k] for d in (-moment, 0.0, moment))
    slope = (late.value - early.value) / (2 * moment)
    if now.sort == "load" or slope >= 0.0 or abs(now.value) > 0.05 * abs(slope) * (step.end - step.start):
        return 0.0
    return -now.value / slope
