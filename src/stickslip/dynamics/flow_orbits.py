"""Periodic orbits and exponents of switching flows, and any model with a set-valued law as such a flow."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.dynamics.switched import Passage, Switch, SwitchingFlow, derivative, passage
from stickslip.dynamics.variational import multipliers_of
from stickslip.errors import InputError, SolveError
from stickslip.forces import is_dynamic, normal_load

__all__ = ["FlowOrbit", "exponents_of", "flow_orbit", "switching_flow"]

Array = Any


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

    Returns
    -------
    FlowOrbit
        Where it begins, how long it takes, and its multipliers.

    Raises
    ------
    SolveError
        Where Newton's method finds none from this guess.

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
    along = derivative(flow.fields[mode], 0.0, y)[0]
    ahead = derivative(flow.fields[done.mode], T, done.state)[0]
    whole = np.block([[A, ahead[:, None]], [along[None, :], np.zeros((1, 1))]])
    step = np.linalg.lstsq(whole, np.append(-miss, 0.0), rcond=1e-12)[0]
    return y + step[:n], T + float(np.clip(step[n], -0.5 * T, 0.5 * T)), mode


def switching_flow(model: Any) -> SwitchingFlow:
    """Any model with a set-valued law as a switching flow with modes +1, 0 and -1 and the states x and v.

    Its orbits come from an integrator and from Python's own loops: slow, and independent of our solvers.

    Parameters
    ----------
    model : Robot or a mechanism
        With a law that has `sliding` and `breakaway`.

    Returns
    -------
    SwitchingFlow

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
