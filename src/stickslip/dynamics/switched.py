r"""Flows that switch: smooth fields, guards between them, resets. For systems that are no robot, and as the slow second opinion for robots.

A mode has a field :math:`\dot y = f(t, y)` and switches. A switch happens when its guard falls through zero; the mode after it and the
state after it may depend on where that happens. The variational equation is carried along, with

.. math:: S = G_y + \frac{(f_+ - G_y f_- - G_t)\,\nabla g^T}{\partial_t g + \nabla g\cdot f_-}

at a switch with reset :math:`y_+ = G(t, y)`. A guard that is below zero where a mode begins switches at once; what then follows at
the same instant is one switch with the composed resets. Of guards that fall together the first in the tuple counts. Fields, guards and
resets are plain Python on sequences, written with `stickslip.maths`; their derivatives come from their own lines.

References
----------
M. di Bernardo, C. Budd, A. Champneys, P. Kowalczyk, Piecewise-smooth Dynamical Systems, Springer 2008, section 2.5.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stickslip.arguments import explains_arguments
from stickslip.dynamics.switched_arcs import arc, guards_of
from stickslip.dynamics.written import answer, derivative
from stickslip.errors import InputError, Problems, SolveError, did_you_mean
from stickslip.fields import number
from stickslip.sealing import sealed

__all__ = ["Passage", "Switch", "SwitchingFlow", "derivative", "passage", "started"]

Array = Any
Mode = Hashable
_MOST = 10_000  # switches in one passage, if it is not said
_MANY, _AT_ONCE = 100, 1e-7  # so many switches within this part of a passage accumulate: at that rate it would have 1e9
_TIGHTEST, _LOOSEST = 1e-13, 1e-2  # of rtol


@dataclass(frozen=True)
class Switch:
    """What ends a mode.

    Parameters
    ----------
    guard : callable
        g(t, y), positive while nothing happens; the switch is its fall through zero, and at once where a mode begins below zero.
    to : mode or callable
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
    to: Mode | Callable[[Any, Any], Mode]
    reset: Callable[[Any, Any], Any] | None = None

    def __post_init__(self) -> None:
        problems = Problems("Switch")
        if not callable(self.guard):
            problems.add(f"guard = {self.guard!r}; allowed is a function of (t, y); type for example guard=lambda t, y: y[0]")
        if self.reset is not None and not callable(self.reset):
            problems.add(f"reset = {self.reset!r}; allowed is a function of (t, y) that gives the state after the switch, or None")
        problems.check()


@dataclass(frozen=True)
class SwitchingFlow:
    """A flow of several modes.

    Parameters
    ----------
    fields : dict
        Mode (a number or a word) -> function of (t, y) that gives the rates.
    switches : dict
        Mode -> tuple of `Switch`.
    period : float, optional
        Of the forcing; None for a flow that does not depend on time.

    Raises
    ------
    InputError
        Where a switch leads to a mode that has no field, and the like.

    Examples
    --------
    A ball that bounces with restitution 0.8:

    >>> ball = SwitchingFlow({0: lambda t, y: (y[1], -9.81)}, {0: (Switch(lambda t, y: y[0], 0, lambda t, y: (0.0, -0.8 * y[1])),)})
    >>> done = passage(ball, [1.0, 0.0], 0, 1.0)
    >>> [round(t, 6) for t, _, _ in done.events], round(abs(float(np.linalg.det(done.monodromy))), 6)  # 0.8 squared
    ([0.451524], 0.64)
    """

    fields: Mapping[Any, Callable[[Any, Any], Any]]
    switches: Mapping[Any, tuple[Switch, ...]] = field(default_factory=dict)
    period: float | None = None

    def __post_init__(self) -> None:
        problems = Problems("SwitchingFlow")
        _check_fields(problems, self.fields)
        _check_switches(problems, self.fields, self.switches)
        if self.period is not None and not (_is_number(self.period) and self.period > 0):
            problems.add(f"period = {self.period!r}; allowed is a positive number, or None for a flow that does not depend on time")
        problems.check()


def _check_fields(problems: Problems, fields: Any) -> None:
    if not isinstance(fields, Mapping) or not fields:
        problems.add(f"fields = {fields!r}; allowed is a dict of functions; type for example fields={{0: lambda t, y: (y[1], -y[0])}}")
        problems.check()
    for mode, f in fields.items():
        if not callable(f):
            problems.add(f"fields[{mode!r}] = {f!r}; allowed is a function of (t, y) that gives the rates")


def _check_switches(problems: Problems, fields: Any, switches: Any) -> None:
    if not isinstance(switches, Mapping):
        problems.add(f"switches = {switches!r}; allowed is a dict of tuples of Switch; type for example switches={{0: (switch,)}}")
        problems.check()
    for mode, exits in switches.items():
        if mode not in fields:
            problems.add(f"switches[{mode!r}]: {_unknown(mode, fields)}")
        if not isinstance(exits, (tuple, list)) or not all(isinstance(s, Switch) for s in exits):
            problems.add(f"switches[{mode!r}] = {exits!r}; allowed is a tuple of Switch; type (switch,) for a single one")
            continue
        for k, s in enumerate(exits):
            if not callable(s.to) and not _knows(fields, s.to):
                problems.add(f"switches[{mode!r}][{k}].to: {_unknown(s.to, fields)}")


def _knows(fields: Mapping[Any, Any], mode: Any) -> bool:
    return isinstance(mode, Hashable) and getattr(mode, "__hash__", None) is not None and mode in fields


def _unknown(mode: Any, fields: Mapping[Any, Any]) -> str:
    if isinstance(mode, str):
        return f"{mode!r} is no mode of the flow; {did_you_mean(mode, [repr(m) if not isinstance(m, str) else m for m in fields])}"
    return f"{mode!r} is no mode of the flow; known: {', '.join(map(repr, fields))}"


def _is_number(given: Any) -> bool:
    return isinstance(given, (int, float, np.number)) and not isinstance(given, bool) and bool(np.isfinite(given))


@sealed
@dataclass(frozen=True, eq=False)
class Passage:
    """A stretch of a switching flow: where and when it ends, its switches, its derivative by the start, and its extremes.

    Parameters
    ----------
    state : array
        Where it ends.
    mode
        In which mode.
    time : float
        When: after the duration, or at its last switch where `switches` ended it.
    events : list of tuple
        Its switches: instant, mode before, mode after.
    monodromy : array
        The derivative of the end by the start; nan where the flow touches a guard without crossing it, where there is none.
    forgets : bool
        Whether a switch wiped out a direction.
    lowest, highest : array
        Of each coordinate, also between the integrator's steps.
    """

    state: Array
    mode: Any
    time: float
    events: list[tuple[float, Any, Any]]
    monodromy: Array
    forgets: bool
    lowest: Array
    highest: Array


@dataclass(frozen=True, eq=False)
class _Crossing:
    """Switches of one instant, which a disturbance moves by `moved` times itself.

    `A` and `rate` are what the resets so far make of the disturbance and of the rate before them.
    """

    before: Array
    A: Array
    rate: Array
    moved: Array

    def through(self, f: Callable[..., Any] | None, name: str, t: float, y: Array) -> tuple[_Crossing, Array]:
        """The crossing with one more reset, and the state after it."""
        if f is None:
            return self, y
        new, G_t, G_y = derivative(f, t, y, name, len(y))
        if not np.isfinite(new).all():
            raise SolveError(f"{name} gave {new.tolist()} at t = {t:.9g}, y = {y.tolist()}; allowed is a finite state")
        return _Crossing(self.before, G_y @ self.A, G_y @ self.rate + G_t, self.moved), new + 0.0  # no negative zero

    def saltation(self, ahead: Array) -> Array:
        """The matrix, for the rate with which it goes on."""
        jump = self.rate - ahead
        return self.A + np.outer(jump, self.moved) if jump.any() else self.A


@explains_arguments
def passage(
    flow: SwitchingFlow, state: Any, mode: Any, duration: float, begin: float = 0.0, rtol: float = 1e-12, switches: int | None = None
) -> Passage:
    """Follow a switching flow, and how small changes of the start grow.

    Parameters
    ----------
    flow : SwitchingFlow
    state : array
        Where it begins. Beyond a guard it switches at once.
    mode
        In which mode.
    duration : float
        How long at most.
    begin : float
        The time at the start.
    rtol : float
        Tolerance of the integrator (DOP853).
    switches : int, optional
        It ends after so many switches.

    Returns
    -------
    Passage
        State, mode and time at the end, the switches on the way, the monodromy matrix and the extremes.

    Raises
    ------
    InputError
        For a mode that is not known, or a field, guard or reset that does not give numbers.
    SolveError
        Where switches accumulate: the flow chatters, or comes to rest in infinitely many ever shorter jumps (Zeno); and after 10 000
        switches, if `switches` does not say how many.

    Examples
    --------
    >>> half = passage(SwitchingFlow({0: lambda t, y: (-y[0],)}), [1.0], 0, np.log(2.0))
    >>> round(float(half.state[0]), 12), round(float(half.monodromy[0, 0]), 12), round(half.time, 12)
    (0.5, 0.5, 0.69314718056)
    """
    y = started(flow, state, mode, duration, begin, rtol, switches)
    t, end, M, forgets = float(begin), float(begin) + float(duration), np.eye(len(y)), False
    events: list[tuple[float, Any, Any]] = []
    low, high, crossing, seen = y.copy(), y.copy(), None, {(mode, y.tobytes())}
    while switches is None or len(events) < switches:
        hit = next((k for k, guard in enumerate(guards_of(flow, mode)) if guard.beyond(t, y)), None)
        if hit is None and t >= end:
            break
        if hit is None:
            there = arc(flow, mode, t, y, end, rtol)
            low, high = np.minimum(low, there.low), np.maximum(high, there.high)
            if there.t > t:
                seen = set()
            t, y, M, hit = there.t, there.y, there.M @ M, there.hit
            if hit is None:
                break
            crossing = _crossed(flow, mode, hit, t, y, M)
        elif crossing is None:  # it begins beyond a guard, wherever a disturbance moves it
            crossing = _Crossing(M, np.eye(len(y)), np.zeros(len(y)), np.zeros(len(y)))
        after, y, crossing, S = _switched(flow, mode, hit, t, y, crossing)
        events.append((t, mode, after))
        low, high, mode = np.minimum(low, y), np.maximum(high, y), after
        _stop_accumulating(events, (mode, y.tobytes()), seen, float(duration), switches)
        M, forgets = S @ crossing.before, forgets or not S.any(axis=1).all()
    return Passage(y, mode, t, events, M, forgets, low, high)


def started(flow: Any, state: Any, mode: Any, duration: Any, begin: Any, rtol: Any, switches: Any, what: str = "passage") -> Array:
    """The state at the start; an error that says everything that is wrong with what was given."""
    problems = Problems(what)
    if not isinstance(flow, SwitchingFlow):
        told = f"{flow!r} is no flow; allowed is a SwitchingFlow"
        raise InputError(what, [f"{told}; type ss.SwitchingFlow({{0: lambda t, y: (y[1], -y[0])}})"])
    try:
        y = np.atleast_1d(np.array(number(state), float))
    except ValueError:
        y = np.array([np.nan])
    if y.ndim != 1 or not len(y) or not np.isfinite(y).all():
        problems.add(f"state = {state!r}; allowed is a list of finite numbers, one for each coordinate; type for example [0.5, 0.0]")
    if not _knows(flow.fields, mode):
        problems.add(f"mode: {_unknown(mode, flow.fields)}")
    if not (_is_number(duration) and duration > 0):
        problems.add(f"duration = {duration!r}; allowed is a positive finite number")
    if not _is_number(begin):
        problems.add(f"begin = {begin!r}; allowed is a finite number")
    if not (_is_number(rtol) and _TIGHTEST <= rtol <= _LOOSEST):
        problems.add(f"rtol = {rtol!r}; allowed is a number from {_TIGHTEST:g} to {_LOOSEST:g}; type rtol=1e-12")
    if switches is not None:
        problems.whole("switches", switches, 1, example=100)
    problems.check()
    return y


def _crossed(flow: SwitchingFlow, mode: Any, hit: int, t: float, y: Array, M: Array) -> _Crossing:
    """The crossing of a guard that an arc ended on; a guard that is only touched moves by no number."""
    rate = derivative(flow.fields[mode], t, y)[0]
    guard = guards_of(flow, mode)[hit]
    speed, (_, _, by_y) = guard.speed(t, y, rate), guard.slopes(t, y)
    return _Crossing(M, np.eye(len(y)), rate, -by_y / speed if speed else np.full(len(y), np.nan))


def _switched(flow: SwitchingFlow, mode: Any, hit: int, t: float, y: Array, crossing: _Crossing) -> tuple[Any, Array, _Crossing, Array]:
    """Mode and state after a switch, the crossing so far, and its saltation matrix."""
    switch, name = flow.switches[mode][hit], f"switches[{mode!r}][{hit}]"
    after = answer(switch.to, f"{name}.to", t, y.copy()) if callable(switch.to) else switch.to
    if not _knows(flow.fields, after):
        raise InputError("SwitchingFlow", [f"{name}.to gave {after!r} at t = {t:.9g}: {_unknown(after, flow.fields)}"])
    crossing, new = crossing.through(switch.reset, f"{name}.reset", t, y)
    ahead = derivative(flow.fields[after], t, new, f"fields[{after!r}]", len(y))[0]
    return after, new, crossing, crossing.saltation(ahead)


def _stop_accumulating(
    events: list[tuple[float, Any, Any]], here: tuple[Any, bytes], seen: set[Any], duration: float, most: int | None
) -> None:
    """An error where the switches of a flow do not end."""
    t, last = events[-1][0], [repr(mode) for _, _, mode in events[-4:]]
    how = f"switches accumulate at t = {t:.9g} (modes {' -> '.join(last)})"
    what = (
        "the flow chatters, which needs a mode that slides along the guard, or it comes to rest in ever shorter jumps (Zeno), which needs "
        "a mode of rest and a guard that leads there"
    )
    if here in seen:
        raise SolveError(f"{how}: it comes back to the same mode and state at the same instant; {what}")
    seen.add(here)
    if len(events) >= _MANY and t - events[-_MANY][0] <= _AT_ONCE * duration + 64 * np.spacing(abs(t)):
        raise SolveError(f"{how}: the last {_MANY} in {t - events[-_MANY][0]:.1e}; {what}")
    if most is None and len(events) >= _MOST:
        raise SolveError(f"{how}: {_MOST} until then; {what}; if they are meant, say how many: switches={10 * _MOST}")
