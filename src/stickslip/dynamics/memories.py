r"""What a switch of a law's memory does to a small change of the state.

Where a guard g of the law falls to zero its memory changes, and with it the equations; it may also set inner states anew,
:math:`y_+ = G(t, y)`. All of this is read from the law's own lines:

.. math:: S = G_y + \frac{(f_+ - G_y f_- - G_t)\,\nabla g^T}{\partial_t g + \nabla g\cdot f_-}

Several memories may change at one instant: one after the other, each with its own S.

References
----------
M. di Bernardo, C. Budd, A. Champneys, P. Kowalczyk, Piecewise-smooth Dynamical Systems, Springer 2008, section 2.5.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.dynamics.duals import Dual, slopes_of, variables
from stickslip.dynamics.flows import memory_of, rates
from stickslip.errors import SolveError
from stickslip.forces import held_velocity
from stickslip.friction.adapter import law_of
from stickslip.mechanics import normal_load
from stickslip.position import knows_position

__all__ = ["remembered"]

Array = Any


class _AtRest(Dual):
    """The guard of the switches that wait for v = 0: what a law calls abs(v)."""


class _Slip(Dual):
    """The contact's velocity; its size is known again when a law gives it back as a guard."""

    def __abs__(self) -> Dual:
        plain = super().__abs__()
        return _AtRest(plain.value, plain.slopes)


class _Instant:
    """A model at one instant, as functions of time and state whose results carry slopes."""

    def __init__(self, model: Any, t: float):
        self.model, self.t = model, t
        self.cyclic = not knows_position(model)

    def rate(self, y: Array, side: int, memory: Array) -> Array:
        """Rates of the coordinates."""
        return rates(self.model, np.array([side]), np.array([self.t]), y[:, None], memory[None, :])[0][:, 0]

    def switches(self, y: Array, side: int, memory: Array) -> list[tuple[Dual, Array, list[Dual] | None]]:
        """The law's switches: guard, memories after it, inner states after it."""
        t, *states = variables(self.t, *y)
        x, v, z = (0.0, states[0], states[1:]) if self.cyclic else (states[0], states[1], states[2:])
        contact = self.model.contact_velocity(v)
        slip = _Slip(held_velocity(contact.value, side), contact.slopes)
        load = normal_load(self.model, t, x)
        found = law_of(self.model).switches(slip, tuple(z), load, memory_of(memory[None, :]))
        return [(guard, np.array([_number(m) for m in after]), None if new is None else list(new)) for guard, after, new in found]

    def contact(self, y: Array) -> Dual:
        """Velocity at the contact, by time and state."""
        states = variables(self.t, *y)[1:]
        return self.model.contact_velocity(states[0 if self.cyclic else 1])

    def reset(self, y: Array, new: list[Dual] | None) -> tuple[Array, Array, Array]:
        """The state after a switch, and its derivatives by time and by the state before."""
        n, after, slopes = len(y), y.copy(), np.eye(len(y), len(y) + 1, 1)
        for i, value in enumerate(new or []):
            row = n - len(new or []) + i
            after[row], slopes[row] = _number(value), [_number(s) for s in slopes_of(value, n + 1)]
        return after, slopes[:, 0], slopes[:, 1:]


def _number(value: Any) -> float:
    return float(np.ravel(getattr(value, "value", value))[0])


def remembered(model: Any, t: float, old: Array, new: Array, sides: tuple[int, int], memory: Array) -> Array:
    """The matrix of a switch.

    Parameters
    ----------
    old, new : array (coordinates,)
        The state before and after it.
    sides : (int, int)
        Signs of the contact's velocity.
    memory : array (2, memories)
        What the law remembers before and after.
    """
    at, v = _Instant(model, t), int(knows_position(model))
    if abs(new[v] - old[v]) > 1e-9 * float(np.max(model.velocity_scale)):
        return _thrown(at, old, new, sides, np.asarray(memory[0], float))
    y, side, held, S = old, sides[0], np.asarray(memory[0], float), np.eye(len(old))
    for _ in range(2 + memory.shape[1]):
        if side == sides[1] and np.array_equal(held, memory[1]):
            return S
        guard, after, states, turned = _next(at, y, side, held, np.asarray(memory[1], float), sides[1])
        before = at.rate(y, side, held)
        ahead, by_t, by_y = at.reset(y, states)
        slopes = np.array([_number(s) for s in slopes_of(guard, 1 + len(y))])
        falls = slopes[0] + slopes[1:] @ before
        jump = at.rate(ahead, turned, after) - by_y @ before - by_t
        S = (by_y + (np.outer(jump, slopes[1:]) / falls if falls != 0.0 else 0.0)) @ S
        y, side, held = ahead, turned, after
    raise SolveError(f"no switch of the law leads from the memory {memory[0].tolist()} to {memory[1].tolist()} at t = {t:.9g}")


def _next(at: _Instant, y: Array, side: int, held: Array, wanted: Array, last: int) -> tuple[Any, Array, Any, int]:
    """The switch that goes first: the passing of v through zero, else the guard that has fallen furthest for its size."""
    found = at.switches(y, side, held)
    if side != last:
        passing = next(((after, new) for guard, after, new in found if isinstance(guard, _AtRest)), (held, None))
        return float(side) * at.contact(y), *passing, last
    near = [
        (abs(_number(guard)), k)
        for k, (guard, after, _) in enumerate(found)
        if not isinstance(guard, _AtRest) and np.any(after != held) and np.all((after == held) | (after == wanted))
    ]
    if not near:
        raise SolveError(f"no switch of the law leads from the memory {held.tolist()} to {wanted.tolist()}")
    guard, after, new = found[min(near)[1]]
    return guard, after, new, side


def _thrown(at: _Instant, old: Array, new: Array, sides: tuple[int, int], held: Array) -> Array:
    """An impulse at a known instant: nothing but what it makes the law set anew."""
    if sides[0] == sides[1]:
        return np.eye(len(old))
    y = old.copy()
    y[0 if at.cyclic else 1] = new[0 if at.cyclic else 1]
    for guard, _, states in at.switches(y, sides[1], held):
        if isinstance(guard, _AtRest):
            return at.reset(y, states)[2]
    return np.eye(len(old))
