"""The derivative of the strobe map by differences, on those sides of a state on which the law goes on as it does there.

A law with discrete memory may hold an inner state at its limit: a Jenkins element that yields. A start beyond that limit is none of its
motions, and the memory switches again at the next reversal. There the derivative is the one-sided one from within the limit, which is what
the tangent of the system gives too.
"""

from __future__ import annotations

from itertools import accumulate, pairwise
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model, Numeric
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, flow_map, strobe_map
from stickslip.models.friction.law_adapter import TINY
from stickslip.models.machine_adapter import machine_of
from stickslip.models.model_adapter import adapter_of

STEP = 1e-6  # half the distance of two starts, in scales
_BEYOND = 1e-8  # in scales: rounding may take a state so far beyond a limit
_ONE_SIDED = np.array([-1.5, 2.0, -0.5])  # of values at 0, 1 and 2 steps: the slope at 0, to second order


def difference_jacobian(
    model: Model, state: Numeric, periods: int = 1, rtol: float = 1e-12, step: float = STEP, span: float | None = None,
    at: Coordinates | None = None,
) -> Array:  # fmt: skip
    """The derivative of the strobe map by differences of one batch, central ones where both sides are; memories are kept as they are.

    On a section its coordinate stays what it is, and has neither row nor column.

    Parameters
    ----------
    step : float
        Half the distance of the two points, in the scales of `coordinates`.

    Returns
    -------
    array (states, states)
        A column is NaN where the law goes on on neither side.
    """
    at = coordinates(model) if at is None else at
    free, state = at.free, np.asarray(state, float)
    d, shifts = len(free), np.eye(len(at.names))[free] * (step * at.scales)
    sides = open_sides(model, state, step, at)[free]
    weights = np.zeros((d, 5))  # of the values at -2, -1, 0, 1 and 2 steps
    weights[sides.all(axis=1)] = [0.0, -0.5, 0.0, 0.5, 0.0]
    weights[sides[:, 1] & ~sides[:, 0], 2:] = _ONE_SIDED
    weights[sides[:, 0] & ~sides[:, 1], 2::-1] = -_ONE_SIDED
    which, steps = np.nonzero(weights)
    ends = np.full((d, d), np.nan)
    if len(which):
        states = state + (steps - 2)[:, None] * shifts[which]
        after = (strobe_map(model, states, periods, rtol, at) if span is None else flow_map(model, states, span, rtol)).state[:, free]
        for i in np.unique(which):
            own = which == i
            ends[:, i] = weights[i, steps[own]] @ after[own] / (step * at.scales[free[i]])
    return ends


def open_sides(model: Model, state: Array, step: float = STEP, at: Coordinates | None = None) -> Array:
    """Whether the law goes on as it does at a state on its lower and on its upper side: array (states, 2) of bool.

    It does not where a step takes an inner state beyond a limit at which a memory switches, now or after the next reversal.
    """
    at = coordinates(model) if at is None else at
    sides = np.ones((at.smooth, 2), bool)
    if not adapter_of(model).memories:
        return sides
    for i, shift in enumerate(np.eye(at.smooth, len(at.names)) * (step * at.scales)):
        lower, upper = _guards(model, at, state - shift), _guards(model, at, state + shift)
        sides[i] = not ((lower < 0.0) & (upper > 0.0)).any(), not ((upper < 0.0) & (lower > 0.0)).any()
    return sides


def at_limits(model: Model, state: Array) -> tuple[str, ...]:
    """Names of those coordinates of a strobe state on one side of which only the law goes on.

    Examples
    --------
    >>> import stickslip as ss
    >>> orbit = ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4))
    >>> at_limits(orbit.model, orbit.state)  # a bristle has no limit
    ()
    """
    at = coordinates(model)
    one_sided = np.flatnonzero(~np.all(open_sides(model, state, at=at), axis=1))
    return tuple(at.names[i] for i in one_sided)


def beyond_limits(model: Model, state: Array) -> tuple[str, ...]:
    """Names of those coordinates of a strobe state that are beyond a limit at which a memory switches.

    No run leads there, but a guess may: where the limits of the model that it is taken from are wider.
    """
    at = coordinates(model)
    if not adapter_of(model).memories:
        return ()
    shifts = np.eye(at.smooth, len(at.names)) * (_BEYOND * at.scales)
    around = [(_guards(model, at, state - shift), _guards(model, at, state + shift)) for shift in shifts]
    far = [bool(((lower < 0.0) & (upper < 0.0) & (lower != upper)).any()) for lower, upper in around]
    return tuple(name for name, is_far in zip(at.names, far, strict=False) if is_far)


def _guards(model: Any, at: Coordinates, state: Array) -> Array:
    """Guards of the memories of all laws, as they are and after the next reversal of their contacts."""
    machine = machine_of(model)
    q, u, z = at.order.split(list(state[: at.smooth]), 0.0)
    slips, loads = machine.mechanics.slips(0.0, u, q), machine.mechanics.loads(0.0, q, u)
    inner = [z[begin:end] for begin, end in pairwise(accumulate((law.states for law in machine.laws), initial=0))]
    held = [state[at.smooth :][begin:end] for begin, end in pairwise(accumulate((law.modes for law in machine.laws), initial=0))]
    guards: list[float] = []
    for law, v, own, load, memory in zip(machine.laws, slips, inner, loads, held, strict=True):
        if law.modes:
            mode, side = tuple(np.round(memory).tolist()), 1 if v >= 0.0 else -1
            after, turned = law.passed_zero(own, load, mode, side)
            guards += [guard for guard, _, _ in law.switches(v, own, load, mode)]
            guards += [guard for guard, _, _ in law.switches(-side * TINY, after, load, turned)]
    return np.array(guards, float)
