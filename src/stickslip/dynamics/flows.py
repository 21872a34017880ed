"""The equations of motion along an orbit, inside one branch: the rate of every coordinate, and its derivatives.

The branch is named by a mode: +1 and -1 slide forwards and backwards, 0 is stuck. Values are held on the branch's side of
v = 0, so that a law is never asked on the wrong side of its own kink.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.dynamics.duals import Dual, Truth, slopes_of, variables
from stickslip.dynamics.order import order_of
from stickslip.forces import held_velocity, offered_force
from stickslip.friction.adapter import law_of
from stickslip.machine import machine_of
from stickslip.mechanics import normal_load
from stickslip.position import knows_position

__all__ = ["breakaway_slopes", "memory_of", "offer_slopes", "rates"]

Array = Any


def rates(model: Any, mode: Array, t: Array, y: Array, memory: Array = ()) -> tuple[Array, Array]:
    """The rate of each coordinate and the Jacobian.

    Parameters
    ----------
    mode : array (n,), or (n, contacts)
        The branch at each instant, of each contact.
    t : array (n,)
        Instants [s].
    y : array (coordinates, n)
        States.
    memory : array (n, memories)
        The laws' memories at each instant, if they have any.

    Returns
    -------
    f : array (coordinates, n)
    jacobian : array (n, coordinates, coordinates)

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)
    >>> f, J = rates(robot, np.array([1]), np.zeros(1), np.array([[1e-3], [0.0]]))
    >>> J.shape, float(J[0, 1, 0])  # dz'/dv at z = 0
    ((1, 2, 2), 1.0)
    """
    order, machine = order_of(model), machine_of(model)
    mechanics, mode = machine.mechanics, np.reshape(mode, (len(t), -1)).T
    q, u, z = order.parted(variables(*y), np.zeros_like(t))
    loads = mechanics.loads(t, q)
    slips = [_held(slip, side) for slip, side in zip(mechanics.slips(t, u), np.where(mode == 0, 1, mode), strict=True)]
    if machine.has_inner_states:
        R, inner = _responses(mechanics, t, q, u, slips, z, loads, memory)
        a = mechanics.accelerations(t, q, u, R)
    else:
        a, inner = tuple(_exact(mechanics, t, q, u, slips, loads, mode)), []
    f = order.joined(u, a, inner)
    n, d = len(t), len(f)
    value = np.array([np.broadcast_to(getattr(fi, "value", fi), n) for fi in f], float)
    jacobian = np.empty((n, d, d))
    for i, fi in enumerate(f):
        for j, slope in enumerate(slopes_of(fi, d)):
            jacobian[:, i, j] = slope
    return value, jacobian


def _responses(mechanics: Any, t: Array, q: Any, u: Any, slips: Any, z: Any, loads: Any, memory: Array) -> tuple[list[Any], list[Any]]:
    """Friction forces of laws with inner states, and the rates of these, contact by contact."""
    laws, held, R, inner = mechanics.laws, memory_of(memory), [], []
    free = mechanics.accelerations(t, q, u, (0.0,) * len(laws)) if any(law.needs_applied for law in laws) else ()
    for law, slip, load, row in zip(laws, slips, loads, mechanics.directions, strict=True):
        own, z = z[: law.states], z[law.states :]
        memories, held = held[: law.modes], held[law.modes :]
        j = next(k for k, g in enumerate(row) if g)
        force, rates_of = law.response(slip, own, load, memories, mechanics.masses[j] * free[j] if free else 0.0)
        R.append(force)
        inner += rates_of
    return R, inner


def _exact(mechanics: Any, t: Array, q: Any, u: Any, slips: Any, loads: Any, mode: Array) -> list[Any]:
    """Accelerations under laws that rest exactly: a body at rest moves with what it rests on."""
    R = [law.sliding(slip, load) for law, slip, load in zip(mechanics.laws, slips, loads, strict=True)]
    a = list(mechanics.accelerations(t, q, u, R))
    for row, side, rate in zip(mechanics.directions, mode, mechanics.offset_rates(t), strict=True):
        j = next(k for k, g in enumerate(row) if g)
        a[j] = Truth(side == 0).__ss_where__(0.0 - rate, a[j])
    return a


def breakaway_slopes(model: Any, t: float, y: Array, mode: Array, contact: int, side: int) -> Array:
    """How the distance of a resting contact to break-away of one side changes: by t, then by each coordinate.

    It is what would be left of the body's acceleration under the largest friction force that rest can bear [m/s^2].
    """
    order, mechanics = order_of(model), machine_of(model).mechanics
    at, *states = variables(np.array([t]), *(np.array([value]) for value in y))
    q, u, _ = order.parted(states, np.zeros(1))
    loads, signs = mechanics.loads(at, q), np.where(mode == 0, 1, mode)
    slips = [_held(slip, sign) for slip, sign in zip(mechanics.slips(at, u), signs, strict=True)]
    R = [law.sliding(slip, load) for law, slip, load in zip(mechanics.laws, slips, loads, strict=True)]
    R[contact] = mechanics.laws[contact].breakaway(loads[contact])[1 if side > 0 else 0]
    j = next(k for k, g in enumerate(mechanics.directions[contact]) if g)
    left = mechanics.accelerations(at, q, u, R)[j] + mechanics.offset_rates(at)[contact]
    return np.array([float(np.ravel(s)[0]) for s in slopes_of(left, 1 + len(y))])


def memory_of(memory: Array) -> tuple[Dual, ...]:
    """Memories as a law with numbers that carry slopes takes them."""
    return tuple(Dual(column, []) for column in np.asarray(memory, float).T)


def _held(slip: Any, mode: Any) -> Any:
    """A slip velocity, its value held on the side of the mode."""
    return Dual(held_velocity(slip.value, mode), slip.slopes)


def offer_slopes(model: Any, t: float, x: float, side: int) -> tuple[float, float]:
    """How the distance of the offered force to the break-away force of one side changes: by t and by x."""
    at, moved = variables(np.array([t]), np.array([x]))
    where: Any = moved if knows_position(model) else np.array([x])
    offered, limits = offered_force(model, at, where), law_of(model).breakaway(normal_load(model, at, where))
    gap = offered - limits[1 if side > 0 else 0]
    by_t, by_x = (float(np.ravel(s)[0]) for s in slopes_of(gap, 2))
    return by_t, by_x
