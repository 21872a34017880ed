r"""A passage of a switching flow by SciPy's integrator and Python's own loops: the judge of the engine, and the way where it cannot go.

The variational equation is carried along, with

.. math:: S = G_y + \frac{(f_+ - G_y f_- - G_t)\,\nabla g^T}{\partial_t g + \nabla g\cdot f_-}

at a switch with reset :math:`y_+ = G(t, y)`. What follows a switch at the same instant is one switch with the composed resets.

References
----------
M. di Bernardo, C. Budd, A. Champneys, P. Kowalczyk, Piecewise-smooth Dynamical Systems, Springer 2008, section 2.5.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, SolveError
from stickslip.basics.interruption import look
from stickslip.models.switching_flow import knows_mode, unknown_mode
from stickslip.solvers.flow_engine import MOST_SWITCHES, accumulates
from stickslip.solvers.plain.flow_arcs import flow_arc, guards_of
from stickslip.solvers.plain.user_functions import checked_call, value_and_slopes

if TYPE_CHECKING:
    from stickslip.models.switching_flow import SwitchingFlow


_MANY, _AT_ONCE = 100, 1e-7  # so many switches within this part of a passage accumulate: at that rate it would have 1e9


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
        new, G_t, G_y = value_and_slopes(f, t, y, name, len(y))
        if not np.isfinite(new).all():
            raise SolveError(f"{name} gave {new.tolist()} at t = {t:.9g}, y = {y.tolist()}; allowed is a finite state")
        return _Crossing(self.before, G_y @ self.A, G_y @ self.rate + G_t, self.moved), new + 0.0  # no negative zero

    def saltation(self, ahead: Array) -> Array:
        """The matrix, for the rate with which it goes on."""
        jump = self.rate - ahead
        return self.A + np.outer(jump, self.moved) if jump.any() else self.A


def passage_by_scipy(
    flow: SwitchingFlow, y: Array, mode: Any, duration: float, begin: float, rtol: float, switches: int | None
) -> tuple[Any, ...]:
    """State, mode and time at the end, the switches, the derivative of the end by the start, whether a direction was lost, and extremes."""
    t, end, M, rank_deficient = float(begin), float(begin) + float(duration), np.eye(len(y)), False
    events: list[tuple[float, Any, Any]] = []
    low, high, crossing, visited = y.copy(), y.copy(), None, {(mode, y.tobytes())}
    while switches is None or len(events) < switches:
        look()
        hit = next((k for k, guard in enumerate(guards_of(flow, mode)) if guard.beyond(t, y)), None)
        if hit is None and t >= end:
            break
        if hit is None:
            there = flow_arc(flow, mode, t, y, end, rtol)
            low, high = np.minimum(low, there.low), np.maximum(high, there.high)
            if there.t > t:
                visited = set()
            t, y, M, hit = there.t, there.y, there.M @ M, there.hit
            if hit is None:
                break
            crossing = _crossed(flow, mode, hit, t, y, M)
        elif crossing is None:  # it begins beyond a guard, wherever a disturbance moves it
            crossing = _Crossing(M, np.eye(len(y)), np.zeros(len(y)), np.zeros(len(y)))
        after, y, crossing, S = _switched(flow, mode, hit, t, y, crossing)
        events.append((t, mode, after))
        low, high, mode = np.minimum(low, y), np.maximum(high, y), after
        _stop_accumulating(events, (mode, y.tobytes()), visited, float(duration), switches)
        M, rank_deficient = S @ crossing.before, rank_deficient or not S.any(axis=1).all()
    return y, mode, t, events, M, rank_deficient, low, high


def _crossed(flow: SwitchingFlow, mode: Any, hit: int, t: float, y: Array, M: Array) -> _Crossing:
    """The crossing of a guard that an arc ended on; a guard that is only touched moves by no number."""
    rate = value_and_slopes(flow.fields[mode], t, y)[0]
    guard = guards_of(flow, mode)[hit]
    speed, (_, _, by_y) = guard.speed(t, y, rate), guard.slopes(t, y)
    return _Crossing(M, np.eye(len(y)), rate, -by_y / speed if speed else np.full(len(y), np.nan))


def _switched(flow: SwitchingFlow, mode: Any, hit: int, t: float, y: Array, crossing: _Crossing) -> tuple[Any, Array, _Crossing, Array]:
    """Mode and state after a switch, the crossing so far, and its saltation matrix."""
    switch, name = flow.switches[mode][hit], f"switches[{mode!r}][{hit}]"
    after = checked_call(switch.to, f"{name}.to", t, y.copy()) if callable(switch.to) else switch.to
    if not knows_mode(flow.fields, after):
        raise InputError("SwitchingFlow", [f"{name}.to gave {after!r} at t = {t:.9g}: {unknown_mode(after, flow.fields)}"])
    crossing, new = crossing.through(switch.reset, f"{name}.reset", t, y)
    ahead = value_and_slopes(flow.fields[after], t, new, f"fields[{after!r}]", len(y))[0]
    return after, new, crossing, crossing.saltation(ahead)


def _stop_accumulating(
    events: list[tuple[float, Any, Any]], here: tuple[Any, bytes], visited: set[Any], duration: float, most: int | None
) -> None:
    """An error where the switches of a flow do not end."""
    t, last = events[-1][0], [repr(mode) for _, _, mode in events[-4:]]
    several = len(events) >= _MANY and t - events[-_MANY][0] <= _AT_ONCE * duration + 64 * np.spacing(abs(t))
    if here in visited or several:
        raise SolveError(accumulates(t, last, None))
    visited.add(here)
    if most is None and len(events) >= MOST_SWITCHES:
        raise SolveError(accumulates(t, last, MOST_SWITCHES))
