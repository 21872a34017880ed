"""The equations of motion along an orbit, inside one branch: the rate of every coordinate, and its derivatives.

The branch is named by a mode: +1 and -1 slide forwards and backwards, 0 is stuck. Values are held on the branch's side of
v = 0, so that a law is never asked on the wrong side of its own kink.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.dynamics.duals import Dual, Truth, slopes_of, variables
from stickslip.forces import held_velocity, offered_force
from stickslip.friction.adapter import law_of
from stickslip.mechanics import normal_load
from stickslip.position import knows_position

__all__ = ["memory_of", "offer_slopes", "rates"]

Array = Any


def rates(model: Any, mode: Array, t: Array, y: Array, memory: Array = ()) -> tuple[Array, Array]:
    """The rate of each coordinate and the Jacobian.

    Parameters
    ----------
    mode : array (n,)
        The branch at each instant.
    t : array (n,)
        Instants [s].
    y : array (coordinates, n)
        States.
    memory : array (n, memories)
        The law's memories at each instant, if it has any.

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
    cyclic = not knows_position(model)
    whole: list[Any] = [*([np.zeros_like(t)] if cyclic else []), *variables(*y)]
    x, v, z = whole[0], whole[1], whole[2:]
    law, load = law_of(model), normal_load(model, t, x)
    if law.dynamic:
        contact = _held(model, v, mode)
        applied = model.total_mass * model.acceleration(t, x, v, 0.0)
        R, zdot = law.response(contact, tuple(z), load, memory_of(memory), applied)
        f: list[Any] = [model.acceleration(t, x, v, R), *zdot]
    else:
        slide = model.acceleration(t, x, v, law.sliding(_held(model, v, np.where(mode == 0, 1, mode)), load))
        f = [Truth(mode == 0).__ss_where__(0.0, slide)]
    f = f if cyclic else [v, *f]
    n, d = len(t), len(f)
    value = np.array([np.broadcast_to(getattr(fi, "value", fi), n) for fi in f], float)
    jacobian = np.empty((n, d, d))
    for i, fi in enumerate(f):
        for j, slope in enumerate(slopes_of(fi, d)):
            jacobian[:, i, j] = slope
    return value, jacobian


def memory_of(memory: Array) -> tuple[Dual, ...]:
    """Memories as a law with numbers that carry slopes takes them."""
    return tuple(Dual(column, []) for column in np.asarray(memory, float).T)


def _held(model: Any, v: Any, mode: Array) -> Any:
    """The contact's velocity, its value held on the side of the mode."""
    contact = model.contact_velocity(v)
    return Dual(held_velocity(contact.value, mode), contact.slopes)


def offer_slopes(model: Any, t: float, x: float, side: int) -> tuple[float, float]:
    """How the distance of the offered force to the break-away force of one side changes: by t and by x."""
    at, moved = variables(np.array([t]), np.array([x]))
    where: Any = moved if knows_position(model) else np.array([x])
    offered, limits = offered_force(model, at, where), law_of(model).breakaway(normal_load(model, at, where))
    gap = offered - limits[1 if side > 0 else 0]
    by_t, by_x = (float(np.ravel(s)[0]) for s in slopes_of(gap, 2))
    return by_t, by_x
