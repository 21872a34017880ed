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
from stickslip.dynamics.variational import multipliers_of
from stickslip.errors import InputError, SolveError
from stickslip.forces import is_dynamic, normal_load

__all__ = ["FlowOrbit", "Passage", "Switch", "SwitchingFlow", "flow_orbit", "passage", "switching_flow"]

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


def _derivative(f: Callable[..., Any], t: float, y: Array) -> tuple[Array, Array, Array]:
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
        value, _, J = _derivative(f, s, u[:n])
        return np.concatenate([value, (J @ u[n:].reshape(n, n)).ravel()])

    def event(switch: Switch) -> Any:
        def g(s: float, u: Array) -> float:
            return float(switch.guard(s, u[:n]))

        g.terminal, g.direction = True, -1.0  # type: ignore[attr-defined]
        return g

    def rise(switch: Switch) -> Any:
        def slope(s: float, u: Array) -> float:
            _, by_t, by_y = _derivative(switch.guard, s, u[:n])
            return float(by_t[0] + by_y[0] @ _derivative(f, s, u[:n])[0])

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
        g, by_t, by_y = _derivative(hit.guard, t, u[:n])
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
    old = _derivative(flow.fields[mode], t, y)[0]
    if hit.reset is None:
        new, G_t, G_y = y, np.zeros(len(y)), np.eye(len(y))
    else:
        new, G_t, G_y = _derivative(hit.reset, t, y)
    ahead = _derivative(flow.fields[int(after)], t, new)[0]
    _, by_t, by_y = _derivative(hit.guard, t, y)
    speed = float(by_t[0] + by_y[0] @ old)
    S = G_y if speed == 0.0 else G_y + np.outer(ahead - G_y @ old - G_t, by_y[0]) / speed
    return int(after), new, S


@dataclass(frozen=True, eq=False)
class FlowOrbit:
    """A periodic orbit of a switching flow.

    Parameters
    ----------
    state, mode : array, int
        Where it begins.
    duration : float
        Its period in time.
    multipliers : array
        The largest first; of a flow that does not depend on time the 1 along the orbit is left out.
    residual : float
        How far it is from itself.
    passage : Passage
        Once around.

    Examples
    --------
    >>> still = SwitchingFlow({0: lambda t, y: (y[1], -4.0 * y[0] - 0.2 * y[1])}, period=1.0)
    >>> orbit = flow_orbit(still, [0.1, 0.0], 0)
    >>> orbit.stable, bool(abs(orbit.state).max() < 1e-9)
    (True, True)
    """

    state: Array
    mode: int
    duration: float
    multipliers: Array
    residual: float
    passage: Passage

    @property
    def stable(self) -> bool:
        """Whether small disturbances die out."""
        return bool(np.all(abs(self.multipliers) < 1.0))

    @property
    def pattern(self) -> tuple[int, ...]:
        """The modes in order."""
        return tuple(after for _, _, after in self.passage.events) or (self.mode,)


def flow_orbit(
    flow: SwitchingFlow,
    state: Any,
    mode: int,
    *,
    periods: int = 1,
    duration: float | None = None,
    settle: int = 0,
    most: int = 30,
    rtol: float = 1e-12,
) -> FlowOrbit:
    """A periodic orbit of a switching flow, by Newton's method with the derivative that saltation gives.

    Parameters
    ----------
    flow : SwitchingFlow
    state, mode : array, int
        A guess.
    periods : int
        Periods of the forcing until it repeats.
    duration : float
        For a flow that does not depend on time: a guess of how long the orbit takes.
    settle : int
        Periods to run before Newton's method begins.
    most : int
        Largest number of iterations.
    rtol : float
        Tolerance.

    Examples
    --------
    Den Hartog's oscillator with dry friction 0.3 at 0.7 times its own frequency never stops:

    >>> from stickslip.maths import cos
    >>> slide = lambda side: lambda t, y: (y[1], -y[0] + cos(0.7 * t) - side * 0.3)
    >>> turn = {1: (Switch(lambda t, y: y[1], -1),), -1: (Switch(lambda t, y: -y[1], 1),)}
    >>> o = flow_orbit(SwitchingFlow({1: slide(1), -1: slide(-1)}, turn, 2 * np.pi / 0.7), [1.0, 0.5], 1, settle=20)
    >>> round(float(o.passage.highest[0]), 3), o.stable  # X = 1.8857
    (1.886, True)
    """
    y = np.array(state, float)
    if flow.period is None and duration is None:
        raise InputError("flow_orbit", ["the flow has no period; give duration=, a guess of how long the orbit takes"])
    T = float(duration or 0.0) if flow.period is None else periods * float(flow.period)
    if flow.period is None:
        y, mode, T = _returned(flow, y, mode, T, max(settle, 3), rtol)
    for _ in range(settle if flow.period else 0):
        done = passage(flow, y, mode, T, rtol=rtol)
        y, mode = done.state, done.mode
    for _ in range(most):
        done = passage(flow, y, mode, T, rtol=rtol)
        miss, size = done.state - y, float(abs(done.state - y).max())
        if size <= 3 * rtol * (1 + abs(y).max()):
            break
        y, T, mode = _newton_step(flow, y, mode, T, done, miss)
    else:
        if size > 1e-8 * (1 + abs(y).max()):
            raise SolveError(
                f"Newton's method found no periodic orbit of the flow in {most} iterations (miss {size:.1e}); try settle=, or another guess"
            )
    return FlowOrbit(y, mode, T, multipliers_of(done.monodromy, done.forgets, flow.period is None), size, done)


def _returned(flow: SwitchingFlow, y: Array, mode: int, duration: float, turns: int, rtol: float) -> tuple[Array, int, float]:
    """A better guess for a flow that does not depend on time: a state after its last switch, and the time since the same one before."""
    events = passage(flow, y, mode, turns * duration, rtol=rtol).events
    same = [k for k, event in enumerate(events) if event[1:] == events[-1][1:]]
    if len(same) < 2:
        return y, mode, duration
    done = passage(flow, y, mode, turns * duration, rtol=rtol, switches=same[-1] + 1)
    onward = 0.5 * (events[same[-2] + 1][0] - events[same[-2]][0])  # not on a switch, but half way to the next
    done = passage(flow, done.state, done.mode, onward, rtol=rtol)
    return done.state, done.mode, events[same[-1]][0] - events[same[-2]][0]


def _newton_step(flow: SwitchingFlow, y: Array, mode: int, T: float, done: Passage, miss: Array) -> tuple[Array, float, int]:
    """The next guess: state, duration and mode."""
    n, A = len(y), done.monodromy - np.eye(len(y))
    if flow.period is not None:
        step = np.linalg.lstsq(A, -miss, rcond=1e-12)[0]
        return y + step, T, done.mode
    along = _derivative(flow.fields[mode], 0.0, y)[0]
    ahead = _derivative(flow.fields[done.mode], T, done.state)[0]
    whole = np.block([[A, ahead[:, None]], [along[None, :], np.zeros((1, 1))]])
    step = np.linalg.lstsq(whole, np.append(-miss, 0.0), rcond=1e-12)[0]
    return y + step[:n], T + float(np.clip(step[n], -0.5 * T, 0.5 * T)), mode


def switching_flow(model: Any) -> SwitchingFlow:
    """Any model with a set-valued law as a switching flow with modes +1, 0 and -1 and the states x and v.

    Its orbits come from an integrator and from Python's own loops: slow, and independent of our solvers.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    >>> done = passage(switching_flow(robot), [0.0, 0.0], 0, robot.period)
    >>> [after for _, _, after in done.events]
    [1, -1]
    """
    law = model.friction
    if is_dynamic(law):
        raise InputError("switching_flow", [f"{type(law).__name__} has inner states; allowed are laws with sliding and breakaway"])
    still = -float(model.contact_velocity(0.0))

    def slide(side: int) -> Callable[[Any, Any], Any]:
        def rate(t: Any, y: Any) -> Any:
            held = side * abs(model.contact_velocity(y[1]))
            return y[1], model.acceleration(t, y[0], y[1], law.sliding(held + side * 1e-300, normal_load(model, t, y[0])))

        return rate

    def room(t: Any, y: Any, side: int) -> Any:
        offered = model.total_mass * model.acceleration(t, y[0], still, 0.0)
        return side * (law.breakaway(normal_load(model, t, y[0]))[1 if side > 0 else 0] - offered)

    def after(t: Any, y: Any) -> int:
        return 1 if room(t, y, 1) < 0 else -1 if room(t, y, -1) < 0 else 0

    def rest(t: Any, y: Any) -> Any:
        return (y[0], still)

    fields = {1: slide(1), -1: slide(-1), 0: lambda t, y: (still, 0.0)}
    switches = {
        1: (Switch(lambda t, y: model.contact_velocity(y[1]), after, rest),),
        -1: (Switch(lambda t, y: -model.contact_velocity(y[1]), after, rest),),
        0: (Switch(lambda t, y: room(t, y, 1), 1), Switch(lambda t, y: room(t, y, -1), -1)),
    }
    return SwitchingFlow(fields, switches, getattr(model, "period", None) and float(model.period))


def exponents_of(
    flow: SwitchingFlow, state: Any, mode: int, *, duration: float, settle: float, every: float, rtol: float
) -> tuple[Array, float]:
    """Growth in every stretch of a switching flow, right at its switches: array (stretches, n), and the length of a stretch."""
    y, t, every = np.array(state, float), 0.0, flow.period or every
    if settle > 0:
        stretches = int(np.ceil(settle / every))
        done = passage(flow, y, mode, stretches * every, rtol=rtol)
        y, mode, t = done.state, done.mode, stretches * every
    Q, logs = np.eye(len(y)), np.empty((max(int(duration / every), 1), len(y)))
    for k in range(len(logs)):
        done = passage(flow, y, mode, every, begin=t, rtol=rtol)
        y, mode, t = done.state, done.mode, t + every
        Q, R = np.linalg.qr(done.monodromy @ Q)
        with np.errstate(divide="ignore"):
            logs[k] = np.log(abs(np.diag(R)))
    return logs, every
