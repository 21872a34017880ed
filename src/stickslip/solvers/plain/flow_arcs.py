"""One arc of a switching flow: a smooth field followed with its variational equation to the first switch, or to the end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import SolveError
from stickslip.basics.frozen_arrays import sealed
from stickslip.solvers.plain.step_extremes import first_fall, lowest_and_highest, points
from stickslip.solvers.plain.user_functions import scalar_of, value_and_slopes

if TYPE_CHECKING:
    from stickslip.models.switching_flow import SwitchingFlow


_STEPS = 200_000  # of the integrator in one arc: minutes
_ROUNDING = 64 * float(np.finfo(float).eps)


@dataclass(frozen=True)
class FlowGuard:
    """The guard of a switch, with its name for messages."""

    name: str
    g: Callable[[Any, Any], Any]

    def __call__(self, t: float, y: Array) -> float:
        """Its value; an error where it has none."""
        number = scalar_of(self.g, t, y, self.name)
        if np.isnan(number):
            raise SolveError(f"{self.name} gave nan at t = {t:.9g}, y = {y.tolist()}; it must be defined wherever its mode goes")
        return number

    def slopes(self, t: float, y: Array) -> tuple[float, float, Array]:
        """Value, derivative by t, derivatives by y."""
        values, by_t, by_y = value_and_slopes(self.g, t, y, self.name, 1)
        return float(values[0]), float(by_t[0]), by_y[0]

    def level(self, t: float, y: Array) -> float:
        """The size of rounding errors in its value."""
        _, by_t, by_y = self.slopes(t, y)
        return _ROUNDING * float(abs(by_y) @ sizes(y) + abs(by_t * t))

    def beyond(self, t: float, y: Array) -> bool:
        """Whether it lies below zero by more than rounding."""
        return self(t, y) < -self.level(t, y)

    def speed(self, t: float, y: Array, rate: Array) -> float:
        """How fast it grows along the flow; 0 where that is rounding."""
        _, by_t, by_y = self.slopes(t, y)
        speed = by_t + float(by_y @ rate)
        return speed if abs(speed) > _ROUNDING * (abs(by_t) + float(abs(by_y) @ abs(rate))) else 0.0


@sealed
class Arc:
    """Where an arc ends, its derivative M by its start, which guard ended it (None: its time was over), and the extremes on it."""

    t: float
    y: Array
    M: Array
    hit: int | None
    low: Array
    high: Array


def guards_of(flow: SwitchingFlow, mode: Any) -> list[FlowGuard]:
    """The guards of a mode in order."""
    return [FlowGuard(f"switches[{mode!r}][{k}].guard", s.guard) for k, s in enumerate(flow.switches.get(mode, ()))]


def sizes(y: Array) -> Array:
    """The scale of a coordinate where it passes zero."""
    return np.maximum(abs(y), 1e-3 * (1.0 + abs(y).max()))


def flow_arc(flow: SwitchingFlow, mode: Any, t: float, y: Array, end: float, rtol: float) -> Arc:
    """One arc, to its first switch or to the end. No guard is below zero where it begins."""
    from scipy.integrate import DOP853

    n, M, name, watched = len(y), np.eye(len(y)), f"fields[{mode!r}]", guards_of(flow, mode)
    rates = _rates(flow.fields[mode], name, n)
    low, high, u = y.copy(), y.copy(), np.concatenate([y, M.ravel()])
    if end - t <= 16 * np.spacing(abs(end)):
        return Arc(end, y, M, None, low, high)
    if not np.isfinite(rates(t, u)[:n]).all():
        raise SolveError(f"{name} gave {rates(t, u)[:n].tolist()} at t = {t:.9g}, y = {y.tolist()}; allowed are finite rates")
    scale = rtol * np.concatenate([sizes(y), np.ones(n * n)])
    with np.errstate(all="ignore"):
        solver = DOP853(rates, t, u, end, rtol=rtol, atol=scale, max_step=flow.period / 16 if flow.period else np.inf)
        for _ in range(_STEPS):
            before = solver.y
            message = solver.step()
            if solver.status == "failed" or not np.isfinite(solver.y[:n]).all():
                why = message or "it is not finite"
                raise SolveError(f"the flow could not be followed in mode {mode!r} beyond t = {solver.t:.9g}: {why}")
            crossing = _first(watched, solver, n)
            stop = solver.t if crossing is None else crossing[1]
            low, high = lowest_and_highest(solver.dense_output()(points(solver.t_old, stop))[:n], low, high)
            if crossing is not None and stop - t <= _ROUNDING * (end - t):  # at once: where rounding puts it decides nothing
                return Arc(t, y, M, crossing[0], y, y)
            if crossing is not None:
                at, u = _onto(watched[crossing[0]], rates, *_again(rates, solver.t_old, before, stop, rtol, scale), n)
                return Arc(at, u[:n], u[n:].reshape(n, n), crossing[0], np.minimum(low, u[:n]), np.maximum(high, u[:n]))
            if solver.status == "finished":
                return Arc(end, solver.y[:n], solver.y[n:].reshape(n, n), None, low, high)
    raise SolveError(f"{_STEPS} steps led in mode {mode!r} from t = {t:.9g} to {solver.t:.9g} only: its field is stiff there, or very fast")


def _rates(f: Callable[..., Any], name: str, n: int) -> Callable[[float, Array], Array]:
    """The flow and its variational equation."""

    def rates(s: float, u: Array) -> Array:
        rate, _, J = value_and_slopes(f, s, u[:n], name, n)
        return np.concatenate([rate, (J @ u[n:].reshape(n, n)).ravel()])

    return rates


def _first(watched: list[FlowGuard], solver: Any, n: int) -> tuple[int, float] | None:
    """Which guard falls first within the last step, and when; of several at one instant the first in order."""
    if not watched:
        return None
    dense = solver.dense_output()
    crossings: list[tuple[float, int]] = []
    for k, guard in enumerate(watched):
        level = guard.level(solver.t_old, dense(solver.t_old)[:n])
        at = first_fall(lambda s, g=guard: g(s, dense(s)[:n]), solver.t_old, solver.t, level)  # type: ignore[misc]
        if at is not None:
            crossings.append((at, k))
    if not crossings:
        return None
    earliest = min(crossings)[0]
    k = next(k for at, k in crossings if at - earliest <= 4 * np.spacing(abs(earliest)))
    return k, earliest


def _again(rates: Any, t: float, u: Array, stop: float, rtol: float, scale: Array) -> tuple[float, Array]:
    """The state at an instant within a step, by a step that ends there: better than the dense output."""
    from scipy.integrate import solve_ivp

    if stop - t <= 16 * np.spacing(abs(stop)):
        return t, u
    done = solve_ivp(rates, (t, stop), u, method="DOP853", rtol=rtol, atol=scale, first_step=stop - t)
    if done.status != 0:
        raise SolveError(f"the flow could not be followed to its switch at t = {stop:.9g}: {done.message}")
    return stop, done.y[:, -1]


def _onto(guard: FlowGuard, rates: Callable[[float, Array], Array], t: float, u: Array, n: int) -> tuple[float, Array]:
    """The last digits of a switch: Newton steps in time, each a Runge-Kutta step, while they bring the guard nearer to zero."""
    for _ in range(4):
        g, speed = guard(t, u[:n]), guard.speed(t, u[:n], rates(t, u)[:n])
        if speed == 0.0 or g == 0.0:
            break
        h = -g / speed
        ahead = u + h * rates(t + h / 2, u + h / 2 * rates(t, u))
        if not abs(guard(t + h, ahead[:n])) < abs(g):
            break
        t, u = t + h, ahead
    return t, u
