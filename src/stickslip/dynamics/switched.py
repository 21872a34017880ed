r"""Flows that switch: smooth fields, guards between them, resets. For systems that are no robot, and as the slow second opinion for robots.

A mode has a field :math:`\dot y = f(t, y)` and switches. A switch happens when its guard falls through zero; the mode after it and the
state after it may depend on where that happens. The variational equation is carried along, with

.. math:: S = G_y + \frac{(f_+ - G_y f_- - G_t)\,\nabla g^T}{\partial_t g + \nabla g\cdot f_-}

at a switch with reset :math:`y_+ = G(t, y)`. Fields, guards and resets are plain Python on sequences, written with
`stickslip.maths`; their derivatives come from their own lines.

References
----------
M. di Bernardo, C. Budd, A. Champneys, P. Kowalczyk, Piecewise-smooth Dynamical Systems, Springer 2008, section 2.5.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stickslip.dynamics.duals import slopes_of, variables
from stickslip.errors import SolveError

__all__ = ["Passage", "Switch", "SwitchingFlow", "derivative", "passage"]

Array = Any
_MOST = 10_000  # switches in one passage


@dataclass(frozen=True)
class Switch:
    """What ends a mode.

    Parameters
    ----------
    guard : callable
        g(t, y), positive while nothing happens; the switch is its fall to zero.
    to : int or callable
        The mode after it, or a function of (t, y) that tells.
    reset : callable, optional
        The state after it, from (t, y); unchanged if not given.

    Examples
    --------
    >>> floor = Switch(guard=lambda t, y: y[0], to=0, reset=lambda t, y: (0.0, -0.8 * y[1]))
    >>> floor.reset(0.0, [0.0, -2.0])
    (0.0, 1.6)
    """

    guard: Callable[[Any, Any], Any]
    to: int | Callable[[Any, Any], int]
    reset: Callable[[Any, Any], Any] | None = None


@dataclass(frozen=True)
class SwitchingFlow:
    """A flow of several modes.

    Parameters
    ----------
    fields : dict
        Mode -> function of (t, y) that gives the rates.
    switches : dict
        Mode -> tuple of `Switch`.
    period : float, optional
        Of the forcing; None for a flow that does not depend on time.

    Examples
    --------
    A ball that bounces with restitution 0.8:

    >>> ball = SwitchingFlow({0: lambda t, y: (y[1], -9.81)}, {0: (Switch(lambda t, y: y[0], 0, lambda t, y: (0.0, -0.8 * y[1])),)})
    >>> done = passage(ball, [1.0, 0.0], 0, 1.0)
    >>> [round(t, 6) for t, _, _ in done.events], round(abs(float(np.linalg.det(done.monodromy))), 6)  # 0.8 squared
    ([0.451524], 0.64)
    """

    fields: Mapping[int, Callable[[Any, Any], Any]]
    switches: Mapping[int, tuple[Switch, ...]] = field(default_factory=dict)
    period: float | None = None


@dataclass(frozen=True, eq=False)
class Passage:
    """A stretch of a switching flow: where it ends, its switches (instant, mode before, mode after) and its derivative by the start."""

    state: Array
    mode: int
    events: list[tuple[float, int, int]]
    monodromy: Array
    forgets: bool  # whether a switch wiped out a direction
    lowest: Array  # of each coordinate
    highest: Array


def derivative(f: Callable[..., Any], t: float, y: Array) -> tuple[Array, Array, Array]:
    """Values of f(t, y), their derivatives by t, and by y."""
    found = f(*_split(variables(t, *y)))
    rows = found if isinstance(found, (tuple, list, np.ndarray)) else [found]
    slopes = np.array([slopes_of(row, 1 + len(y)) for row in rows], float)
    values: list[Any] = [getattr(row, "value", row) for row in rows]
    return np.array(values, float), slopes[:, 0], slopes[:, 1:]


def _split(numbers: list[Any]) -> tuple[Any, list[Any]]:
    return numbers[0], numbers[1:]


def passage(
    flow: SwitchingFlow, state: Any, mode: int, duration: float, begin: float = 0.0, rtol: float = 1e-12, switches: int = _MOST
) -> Passage:
    """Follow a switching flow, and how small changes of the start grow.

    Parameters
    ----------
    flow : SwitchingFlow
    state : array
        Where it begins.
    mode : int
        In which mode.
    duration : float
        How long at most.
    begin : float
        The time at the start.
    rtol : float
        Tolerance of the integrator (DOP853).
    switches : int
        It ends after so many switches.

    Returns
    -------
    Passage
        State and mode at the end, the switches on the way, and the monodromy matrix.

    Examples
    --------
    >>> half = passage(SwitchingFlow({0: lambda t, y: (-y[0],)}), [1.0], 0, np.log(2.0))
    >>> round(float(half.state[0]), 12), round(float(half.monodromy[0, 0]), 12)
    (0.5, 0.5)
    """
    y = np.array(state, float)
    n, end = len(y), begin + duration
    t, M, events, forgets = float(begin), np.eye(n), [], False
    low, high = y.copy(), y.copy()
    while t < end:
        t, y, M, hit, seen = _arc(flow, mode, t, y, M, end, rtol)
        low, high = np.minimum(low, seen.min(axis=1)), np.maximum(high, seen.max(axis=1))
        if hit is None:
            break
        after, y, S = _switched(flow, mode, hit, t, y)
        M, forgets = S @ M, forgets or not S.any(axis=1).all()
        events.append((t, mode, after))
        mode = after
        if len(events) >= switches:
            break
        if len(events) >= _MOST:
            raise SolveError(
                f"more than {_MOST} switches until t = {t:.9g}: the flow chatters there; give it a mode that slides along the guard"
            )
    return Passage(y, mode, events, M, forgets, low, high)


def _arc(
    flow: SwitchingFlow, mode: int, t: float, y: Array, M: Array, end: float, rtol: float
) -> tuple[float, Array, Array, Switch | None, Array]:
    """One arc, to its first switch or to the end."""
    from scipy.integrate import solve_ivp

    n, f, exits = len(y), flow.fields[mode], flow.switches.get(mode, ())

    def rates(s: float, u: Array) -> Array:
        value, _, J = derivative(f, s, u[:n])
        return np.concatenate([value, (J @ u[n:].reshape(n, n)).ravel()])

    def event(switch: Switch) -> Any:
        def g(s: float, u: Array) -> float:
            return float(switch.guard(s, u[:n]))

        g.terminal, g.direction = True, -1.0  # type: ignore[attr-defined]
        return g

    def rise(switch: Switch) -> Any:
        def slope(s: float, u: Array) -> float:
            _, by_t, by_y = derivative(switch.guard, s, u[:n])
            return float(by_t[0] + by_y[0] @ derivative(f, s, u[:n])[0])

        slope.direction = 1.0  # type: ignore[attr-defined]
        return slope

    scale = rtol * np.concatenate([np.maximum(abs(y), 1e-3 * (1 + abs(y).max())), np.full(n * n, 1.0)])
    limit = flow.period / 16 if flow.period else np.inf
    watch = [*(event(s) for s in exits), *(rise(s) for s in exits)]
    begin = np.concatenate([y, M.ravel()])
    while True:
        done = solve_ivp(rates, (t, end), begin, method="DOP853", rtol=rtol, atol=scale, events=watch or None, max_step=limit)
        if done.status == -1:
            raise SolveError(f"the flow could not be followed beyond t = {done.t[-1]:.9g}: {done.message}")
        dip = _missed(exits, done, n, t)
        if dip is None or dip >= end:
            break
        end = dip  # a guard went below zero and came back within a step: end there, so that its fall is seen
    u, at = done.y[:, -1], float(done.t[-1])
    hit = next((s for s, times in zip(exits, done.t_events or (), strict=False) if len(times)), None)
    if hit is not None:
        at, u = _onto(hit, rates, at, u, n)
    return at, u[:n], u[n:].reshape(n, n), hit, done.y[:n]


def _missed(exits: tuple[Switch, ...], done: Any, n: int, begin: float) -> float | None:
    """The first lowest point of a guard that lies below zero although no switch was seen before it."""
    found = []
    for k, switch in enumerate(exits):
        times, states = done.t_events[len(exits) + k], done.y_events[len(exits) + k]
        found += [float(at) for at, u in zip(times, states, strict=True) if at > begin and float(switch.guard(at, u[:n])) < 0.0]
    return min(found, default=None)


def _onto(hit: Switch, rates: Callable[[float, Array], Array], t: float, u: Array, n: int) -> tuple[float, Array]:
    """The last digits of a switch: Newton steps in time, each a Runge-Kutta step."""
    for _ in range(4):
        g, by_t, by_y = derivative(hit.guard, t, u[:n])
        speed = float(by_t[0] + by_y[0] @ rates(t, u)[:n])
        if speed == 0.0 or g[0] == 0.0:
            break
        h = -float(g[0]) / speed
        k1 = rates(t, u)
        k2 = rates(t + h / 2, u + h / 2 * k1)
        u, t = u + h * k2, t + h
    return t, u


def _switched(flow: SwitchingFlow, mode: int, hit: Switch, t: float, y: Array) -> tuple[int, Array, Array]:
    """Mode and state after a switch, and its saltation matrix."""
    after = hit.to if isinstance(hit.to, (int, np.integer)) else hit.to(t, y)
    old = derivative(flow.fields[mode], t, y)[0]
    if hit.reset is None:
        new, G_t, G_y = y, np.zeros(len(y)), np.eye(len(y))
    else:
        new, G_t, G_y = derivative(hit.reset, t, y)
    ahead = derivative(flow.fields[int(after)], t, new)[0]
    _, by_t, by_y = derivative(hit.guard, t, y)
    speed = float(by_t[0] + by_y[0] @ old)
    S = G_y if speed == 0.0 else G_y + np.outer(ahead - G_y @ old - G_t, by_y[0]) / speed
    return int(after), new, S
