"""Which mode a state begins: who rests, who slides which way, which stops stay closed.

Accelerations decide. Where they leave a tie (a contact would rest exactly at its limit), its next derivatives along the motion do:
break-away under equal static and kinetic friction is such a tie, and so are identical bodies that start together.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import SolveError
from stickslip.solvers.plain.deciding import ROUNDING, Answer, AtZero, blocks, decide, is_common
from stickslip.solvers.plain.flights import begun_aloft, turned_aloft
from stickslip.solvers.plain.plain_equations import ContactModes, Equations

_ORDERS = 4  # derivatives at which ties are looked; after them a tie is rest
_NODES = 9
_REACH = 0.01  # of a period: how far ahead
_SHORTER = 14  # times half of it, until its series has come to an end
_ENDED = 1e-12  # of the first coefficients: the last ones of a series that has
_ABOVE = 1e-9  # of the size of forces: what is no rounding of a coefficient
_SOON = 1e-9  # of a period: when a body that begins at rest under a dynamic law is asked which way it went


def begun(e: Equations, t: float, y: ArrayLike, memory: tuple[tuple[int, ...], ...]) -> tuple[Any, ContactModes]:
    """State and mode at the start of a run."""
    sides = [0 if w == 0.0 else _sign(w) for w in e.slips(t, *e.state(y))]
    aloft = begun_aloft(e, t, y)
    mode = conditioned(e, t, y, turned_aloft(e, t, y, ContactModes(tuple(sides), memory, aloft=aloft), [i for i in aloft if sides[i] == 0]))
    sides = [*mode.sides]
    moving = mode.moved({i: 1 for i, side in enumerate(sides) if side == 0 and e.dynamic[i]} | _stops(e, t, y))
    y, mode = after_event(e, t, y, moving)
    rates = {}
    for i, side in enumerate(sides):
        if side == 0 and e.dynamic[i]:
            rates[i] = _sign(e.slip_rates(t + _SOON * e.scale_of_time, y, mode)[i])
    return y, mode.moved(rates)


def _sign(value: float) -> int:
    return 1 if value >= 0 else -1


def _stops(e: Equations, t: float, y: ArrayLike) -> dict[int, int]:
    """Stops that touch without speed may be closed."""
    q, u = e.state(y)
    gaps, rates, small = e.gaps(t, q), e.slips(t, q, u)[e.k :], e.noise_of_gaps(q)
    beyond = [stop.name for stop, gap in zip(e.stops, gaps, strict=True) if gap < -small]
    if beyond:
        raise SolveError(f"the run begins beyond the stop {beyond[0]}; give a start, or a gap, so that it is open or closed")
    still = ROUNDING * e.scale_of_velocity
    return {e.k + s: 0 if gap <= small and abs(rate) <= still else 1 for s, (gap, rate) in enumerate(zip(gaps, rates, strict=True))}


def conditioned(e: Equations, t: float, y: ArrayLike, mode: ContactModes) -> ContactModes:
    """The mode with all conditions of forces and loads as they are; one that is at its kink as it will be a moment later."""
    now = e.differences(t, y, (None, None))
    if not any(now):
        return replace(mode, kinks=((), ()))
    own = replace(mode, kinks=(_above(now[0]), _above(now[1])))
    moment = _SOON * e.scale_of_time
    later = e.differences(t + moment, np.asarray(y) + moment * np.asarray(_drift(e, t, y, own)), (None, None))
    return replace(mode, kinks=(_above(now[0], later[0]), _above(now[1], later[1])))


def _above(now: Sequence[float], later: Sequence[float] = ()) -> tuple[bool, ...]:
    later = later if len(later) == len(now) else now
    return tuple(a > 0 if a != 0 else b > 0 for a, b in zip(now, later, strict=True))


def _drift(e: Equations, t: float, y: ArrayLike, mode: ContactModes) -> Any:
    held = mode.moved({i: 1 for i, side in enumerate(mode.sides) if side == 0})
    return e.right(held)(t, y)


# ---- the contact problem ---------------------------------------------------------------------------------------------


@dataclass
class _Problem:
    """The rows at zero slip, at one instant."""

    rows: list[int]
    G: Any
    rested: list[bool]

    def part(self, values: Any) -> Any:
        return np.array([values[i] for i in self.rows])


def after_event(
    e: Equations, t: float, y: ArrayLike, mode: ContactModes, touched: Sequence[int] = (), forced: dict[int, int] | None = None
) -> tuple[Any, ContactModes]:
    """State and mode after an event.

    `touched` are rows that came to zero slip, which with the resting rows of `mode` are decided; `forced` ones break away as told.
    """
    q, u = e.state(y)
    w = e.slips(t, q, u)
    noise = e.noise_of_slips(t, q, u, w)
    zero = [
        i for i, side in enumerate(mode.sides)
        if not e.dynamic[i] and i not in mode.aloft and (side == 0 or i in touched or (i < e.k and abs(w[i]) <= noise[i]))
    ]  # fmt: skip
    turned = [i for i in touched if e.dynamic[i]]
    if came := [*zero, *turned]:
        y = e.at_rest(t, y, mode.moved(dict.fromkeys(came, 0)))
    e.look(t, *e.state(y))
    rested = [mode.sides[i] == 0 for i in zero]
    forced, resting = dict(forced or {}), mode.moved(dict.fromkeys(zero, 0))
    problem = _Problem(zero, np.array([[e.G[i][j] for j in zero] for i in zero]).reshape(len(zero), len(zero)), rested)
    while zero:
        answer = _at_once(e, t, y, resting, problem, forced)
        resting = resting.moved(dict(zip(zero, answer.sides, strict=True)))
        freed = _by_derivatives(e, t, y, resting, problem, answer, forced)
        if not freed:
            break
        forced |= freed
    return y, resting.moved({i: _reversed(e, t, y, resting, i) for i in turned})


def _reversed(e: Equations, t: float, y: ArrayLike, mode: ContactModes, i: int) -> int:
    """The side of a dynamic contact whose slip came to zero."""
    before = mode.sides[i]
    return -before if e.slip_rates(t, y, mode)[i] * before <= 0 else before


def _at_once(e: Equations, t: float, y: ArrayLike, mode: ContactModes, problem: _Problem, forced: dict[int, int]) -> Answer:
    """The problem of the accelerations."""
    push = e.motion(t, y, mode.moved(dict.fromkeys(problem.rows, 0))).push
    loads = e.pressed(e.time(t), y, mode)
    limits = e.limits(loads)
    kinetic = [
        [e.sliding(i, side, 0.0, pressed[i] if i < e.k else 0.0) if i < e.k or side > 0 else limits[i][0] for i in problem.rows]
        for side, pressed in ((-1, loads.backwards), (1, loads.forwards))
    ]
    own = {n: forced[i] for n, i in enumerate(problem.rows) if i in forced}
    lo, hi = [limits[i][0] for i in problem.rows], [limits[i][1] for i in problem.rows]
    ranks = _ranks(e, t, problem, push)
    bare = [n for n, (low, high) in enumerate(zip(lo, hi, strict=True)) if low == high == 0.0]  # what nothing holds, the load says the size
    small = ROUNDING * max((abs(loads.forwards[problem.rows[n]]) * problem.G[n, n] for n in bare), default=0.0)
    return decide(AtZero(problem.G, problem.part(push), lo, hi, (kinetic[0], kinetic[1]), own, problem.rested, ranks, small))


def _ranks(e: Equations, t: float, problem: _Problem, push: Sequence[float]) -> list[int] | None:
    """Order of contacts on one coordinate whose prescribed accelerations are equal now, by their derivatives."""
    rank = [0] * len(problem.rows)
    for block in blocks(problem.G):
        part = problem.G[np.ix_(block, block)]
        if len(block) < 2 or not is_common(part):
            continue
        sign = np.sign(part[0])
        level = sign * np.array([push[problem.rows[n]] for n in block])
        if min(np.diff(np.sort(level))) > ROUNDING * max(abs(level)):
            continue
        rows = [problem.rows[n] for n in block]
        c = _series(e, lambda at, rows=rows, sign=sign: sign * np.array(e.offset_rates(at))[rows], t)  # type: ignore[misc]
        for n, number in zip(block, _order(c), strict=True):
            rank[n] = number
    return rank


def _order(c: Any) -> list[int]:
    """Numbers in the order of series (contact, power): the first coefficients that differ decide, equal series have equal numbers."""
    small = _ABOVE * np.max(abs(c), initial=1e-300)
    keys = [tuple(round(float(v) / small) for v in own[1 : _ORDERS + 1]) for own in c]
    close = sorted(keys)
    places = list(
        itertools.accumulate((max(abs(a - b) for a, b in zip(x, y, strict=True)) > 1 for x, y in itertools.pairwise(close)), initial=0)
    )
    return [places[close.index(key)] for key in keys]


# ---- ties ------------------------------------------------------------------------------------------------------------


def _by_derivatives(
    e: Equations, t: float, y: ArrayLike, mode: ContactModes, problem: _Problem, answer: Answer, forced: dict[int, int]
) -> dict[int, int]:
    """Contacts that rest exactly at a limit and leave it after all, with their sides."""
    limits = e.limits(e.pressed(e.time(t), y, mode))
    at = [_bound(force, *limits[i]) if side == 0 else None for i, force, side in zip(problem.rows, answer.R, answer.sides, strict=True)]
    own = [n for n, side in enumerate(answer.sides) if side == 0]
    if not any(at[n] for n in own):
        return {}
    rows = [problem.rows[n] for n in own]
    G, bounds = problem.G[np.ix_(own, own)], [at[n] or "" for n in own]
    c = _ahead(e, t, y, mode, rows)
    size = _ABOVE * max(1e-300, float(np.max(abs(c[0]))), *(abs(v) / e.effective[i] for i in rows for v in limits[i] if np.isfinite(v)))
    for m in range(1, _ORDERS + 1):
        low = [float(c[1][n, m]) if "-" in bound else -np.inf for n, bound in enumerate(bounds)]
        high = [float(c[2][n, m]) if "+" in bound else np.inf for n, bound in enumerate(bounds)]
        decision = decide(AtZero(G, c[0][:, m], low, high, small=size))
        rates = c[0][:, m] - G @ np.array(decision.R)
        freed = {rows[n]: _sign(rates[n]) for n, bound in enumerate(bounds) if bound and abs(rates[n]) > size}
        if freed:
            return freed
        for n, bound in enumerate(bounds):
            slack = size * e.effective[rows[n]]
            if bound and low[n] + slack < decision.R[n] < high[n] - slack:
                bounds[n] = ""
    return {}


def _bound(R: float, low: float, high: float) -> str | None:
    """Which limits a force is at: "+", "-", both, or None."""
    small = 4 * ROUNDING * max(abs(R), *(abs(v) for v in (low, high) if np.isfinite(v)))
    return ("+" if high - R <= small else "") + ("-" if R - low <= small else "") or None


def _ahead(e: Equations, t: float, y: Any, mode: ContactModes, rows: list[int]) -> tuple[Any, Any, Any]:
    """Series of beta and of both limits of resting rows, along the motion in which they stay at rest."""
    import scipy.integrate

    right = e.right(mode)

    def look(at: float, state: ArrayLike) -> Any:
        limits = e.limits(e.pressed(e.time(at), state, mode))
        push = e.motion(at, state, mode).push
        return np.array([[push[i], *limits[i]] for i in rows]).T.ravel()

    def values(times: Array) -> Any:
        states = [y]
        for span in itertools.pairwise(times):  # one after the other, for a dense output is of lower order
            solution = scipy.integrate.solve_ivp(right, span, states[-1], "DOP853", rtol=1e-13, atol=1e-15 * e.sizes(t, y))
            states.append(solution.y[:, -1])
        return [look(float(at), state) for at, state in zip(times, states, strict=True)]

    c = _fitted(values, t, e)
    n = len(rows)
    return c[:n], c[n : 2 * n], c[2 * n :]


def _series(e: Equations, function: Callable[[float], Any], t: float) -> Any:
    """Series of a function of time."""
    return _fitted(lambda times: [function(e.time(float(at))) for at in times], t, e)


def _fitted(values: Callable[[Any], list[Any]], t: float, e: Equations) -> Any:
    """Coefficients (value, power) of (t' - t)/reach, of a reach over which the series comes to an end."""
    reach, theta = _REACH * e.scale_of_time, 0.5 - 0.5 * np.cos(np.pi * np.arange(_NODES) / (_NODES - 1))
    for _ in range(_SHORTER):
        coefficients = np.linalg.solve(theta[:, None] ** np.arange(_NODES), np.array(values(t + reach * theta))).T
        finite = coefficients[np.all(np.isfinite(coefficients), axis=1)]
        if np.max(abs(finite[:, -2:]), initial=0.0) <= 1e3 * _ENDED * max(np.max(abs(finite), initial=0.0), 1e-300):
            break
        reach *= 0.5
    return np.nan_to_num(coefficients, nan=0.0, posinf=0.0, neginf=0.0)
