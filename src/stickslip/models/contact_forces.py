"""Forces and accelerations of a machine of several bodies at given instants, from its states and the modes of its contacts."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.models.feet_forces import forces_of_feet
from stickslip.models.friction.law_adapter import TINY
from stickslip.models.mechanics import Mechanics
from stickslip.models.rails import load_under

_CLOSED = 1e-10  # of the velocity scale: tolerance for the gap (times the period) and the gap's rate of a closed stop


def contact_columns(mechanics: Mechanics, mode: Array, t: Array, x: Array, v: Array, z: Any, zdot: Any, memory: Any) -> dict[str, Array]:
    """Accelerations of the bodies, and friction force, slip velocity and load of the contacts.

    Parameters
    ----------
    mechanics : Mechanics
        The machine.
    mode : array (n, contacts)
        Modes of the contacts; 0 at rest, under a set-valued law.
    t : array (n,)
        Instants [s].
    x, v : array (n, bodies)
        Positions [m] and velocities [m/s] of the bodies.
    z, zdot : sequence of array (n, contacts)
        Inner states and their rates, one array for each; NaN where a law has fewer.
    memory : tuple of array (n,)
        Whole-number memories of the laws, contact by contact.

    Returns
    -------
    dict
        acceleration (n, bodies) [m/s^2], friction_force (n, contacts) [N], slip (n, contacts) [m/s], load (n, contacts) [N].
    """
    q, u = (mechanics.coordinates_of(tuple(of.T)) for of in (x, v))
    held = held_by_controllers(mechanics, np.stack(z, axis=-1) if len(z) else None)
    slips, loads = _columns(mechanics.slips(t, u, q), t), _columns(mechanics.loads(t, q, u, held), t)
    R = np.zeros_like(slips)
    first, scale = 0, getattr(mechanics, "velocity_scale", None) or 0.0
    free = _columns(mechanics.accelerations(t, q, u, (0.0,) * len(mechanics.contacts), held), t)
    prescribed, closed = _columns(mechanics.offset_rates(t), t), closed_stops(mechanics, t, q, u)
    asking: dict[int, Callable[[Array], Array]] = {}
    aloft = np.zeros(slips.shape, bool)
    for i, law in enumerate(mechanics.laws):
        own, first = tuple(memory[first : first + law.modes]), first + law.modes
        side = np.where(mode[:, i] == 0, 1, mode[:, i])
        slip = side * np.maximum(side * slips[:, i], TINY)
        inner, rates = (tuple(of[:, i] for of in states[: law.states]) for states in (z, zdot))
        if law.needs_applied:
            asking[i] = partial(law.force, slip, inner, rates, loads[:, i], own)
            R[:, i] = asking[i](_left(mechanics, i, [c for c, g in enumerate(mechanics.directions[i]) if g], free, prescribed, R))
        else:
            R[:, i] = law.resolved(law.least_creep(scale, mechanics.difference(i)), slip, inner, rates, loads[:, i], own)
        if law.flies:  # its states are the gap and the gap's rate
            aloft[:, i] = (inner[0] != 0.0) | (inner[1] != 0.0) | (rates[1] != 0.0)
            R[aloft[:, i], i], loads[aloft[:, i], i] = 0.0, 0.0
    if mechanics.together:
        feet = forces_of_feet(mechanics, mode, aloft, t, q, u, held)
        return {"acceleration": feet.accelerations, "friction_force": feet.friction, "slip": slips, "load": feet.loads}
    resting = (mode == 0) & np.array([not law.dynamic for law in mechanics.laws], bool)
    for i, force in asking.items():
        for stop, shut in zip(mechanics.stops, closed.T, strict=True):  # a closed stop joins the bodies at its ends
            ends = [c for c, h in enumerate(stop.direction) if h]
            if len(ends) > 1 and any(mechanics.directions[i][c] for c in ends):
                R[:, i] = np.where(shut, force(_left(mechanics, i, ends, free, prescribed, R)), R[:, i])
    pressed = np.zeros(closed.shape)
    places = places_of(mechanics)
    if places:
        R = _held_alone(mechanics, resting, free, prescribed, places, R)
    elif np.any(resting) or np.any(closed):
        _hold(_Instants(mechanics, t, q, u, held), np.hstack([resting, closed]), loads, R, pressed)
    for k, follows in enumerate(mechanics.of_motion if mechanics.joined else ()):  # what the motion asks of rails
        if follows:
            loads[:, k] = np.where(aloft[:, k], 0.0, load_under(mechanics, k, t, q, u, tuple(R.T), held))
    moved = list(_under(_Instants(mechanics, t, q, u, held), R, pressed))
    if mechanics.joined and np.any(aloft):
        free, flies = _columns(mechanics.loose_accelerations(t, q, u, tuple(R.T), held), t), np.any(aloft, axis=1, keepdims=True)
        moved = list(np.where(flies, free, _columns(moved, t)).T)
    for i, index in enumerate(places or ()):  # exactly, without what rounding leaves of a difference of forces
        moved[index] = np.where(resting[:, i], 0.0 - prescribed[:, i], moved[index])
    acceleration = _columns(mechanics.accelerations_of_bodies(t, moved), t)
    return {"acceleration": acceleration, "friction_force": R, "slip": slips, "load": loads}


def _left(mechanics: Mechanics, i: int, coordinates: list[int], free: Array, prescribed: Array, R: Array) -> Array:
    """The friction force that keeps the slip of a contact constant if these coordinates move as one [N]."""
    others = sum(R[:, k] for k, g in enumerate(mechanics.directions) if k != i and any(g[c] for c in coordinates))
    return sum(mechanics.masses[c] * (free[:, c] + prescribed[:, i]) for c in coordinates) - (others if len(coordinates) > 1 else 0.0)


def _columns(rows: Any, t: Array) -> Array:
    """Numbers or arrays, one for each body or contact, as one array with a row for each instant."""
    return np.array([np.broadcast_to(np.asarray(row, float), np.shape(t)) for row in rows]).reshape(len(rows), len(t)).T


def held_by_controllers(mechanics: Mechanics, z: Any) -> tuple[Array, ...]:
    """States of the controllers (time,), one after the other, from inner states (time, contact or controller, state)."""
    first = len(mechanics.contacts)
    return tuple(z[:, first + i, k] for i, count in enumerate(mechanics.controllers.counts) for k in range(count))


def closed_stops(mechanics: Mechanics, t: Array, q: ArrayLike, u: ArrayLike) -> Array:
    """Whether each stop with restitution is closed at each instant: its gap and the gap's rate are zero within a tolerance."""
    if not mechanics.stops:
        return np.zeros((len(t), 0), bool)
    gaps, rates = (_columns(of, t) for of in ([stop.gap(t, q) for stop in mechanics.stops], [stop.rate(t, u) for stop in mechanics.stops]))
    speed = float(getattr(mechanics, "velocity_scale", None) or 1.0)
    time = 1.0 if mechanics.period is None else float(mechanics.period)
    return (abs(gaps) <= _CLOSED * speed * time) & (abs(rates) <= _CLOSED * speed)


class _Instants(NamedTuple):
    """A machine at some instants: times, coordinates, their velocities, and the states of its controllers."""

    mechanics: Mechanics
    t: Array
    q: Any
    u: Any
    held: Any

    def accelerations(self, R: Array) -> Any:
        """Accelerations of the coordinates under friction forces (time, contact)."""
        return self.mechanics.accelerations(self.t, self.q, self.u, tuple(R.T), self.held)


def _under(at: _Instants, R: Array, pressed: Array) -> tuple[Any, ...]:
    """Accelerations under the friction forces and the forces of closed stops."""
    moved, mechanics = at.accelerations(R), at.mechanics
    for stop, force in zip(mechanics.stops, pressed.T, strict=True):
        moved = tuple(a - h / m * force for a, h, m in zip(moved, stop.direction, mechanics.masses, strict=True))
    return tuple(moved)


def _hold(instants: _Instants, resting: Array, loads: Array, R: Array, pressed: Array) -> None:
    """Set the forces of contacts at rest and of closed stops to those that keep slip velocities and gap rates constant."""
    mechanics, t = instants.mechanics, instants.t
    contacts = len(mechanics.contacts)
    R[resting[:, :contacts]] = 0.0
    if mechanics.joined:
        _hold_joined(instants, resting, R)
        return
    g = np.array([*mechanics.directions, *(stop.direction for stop in mechanics.stops)])
    masses = np.array([np.broadcast_to(mass, ()) for mass in mechanics.masses], float)
    G = (g / masses) @ g.T
    free = _columns(instants.accelerations(R), t)
    prescribed = (*mechanics.offset_rates(t), *(stop.offset_rate(t) for stop in mechanics.stops))
    push = free @ g.T + _columns(prescribed, t)  # rates of the slips and gaps without the unknown forces
    for pattern in np.unique(resting, axis=0):
        (held,) = np.nonzero(pattern)
        at = np.all(resting == pattern, axis=1)
        if len(held):
            bear = held[held < contacts]
            multipliers = _multipliers(mechanics, G[np.ix_(held, held)], push[np.ix_(at, held)], loads[np.ix_(at, bear)], bear)
            R[np.ix_(at, bear)] = multipliers[:, : len(bear)]
            pressed[np.ix_(at, held[held >= contacts] - contacts)] = multipliers[:, len(bear) :]


def _hold_joined(instants: _Instants, resting: Array, R: Array) -> None:
    """The same where a contact's friction accelerates all coordinates, by the inverse of the matrix of inertia at each instant."""
    mechanics, t, q, u, _ = instants
    rows = mechanics.rows(0.0, q)
    g = np.stack([_columns(row, t) for row in rows], axis=1)  # (time, contact, coordinate)
    free = _columns(instants.accelerations(R), t)
    push = np.einsum("tik,tk->ti", g, free) + _columns(mechanics.offset_rates(t), t) + _columns(mechanics.slip_biases(t, q, u), t)
    felt = np.stack([np.einsum("tik,tk->ti", g, _columns(mechanics.pushed(t, q, row), t)) for row in rows], axis=-1)  # of each slip rate
    for pattern in np.unique(resting, axis=0):
        (rest,) = np.nonzero(pattern)
        at = np.flatnonzero(np.all(resting == pattern, axis=1))
        if len(rest):
            R[np.ix_(at, rest)] = np.linalg.solve(felt[np.ix_(at, rest, rest)], push[np.ix_(at, rest)][..., None])[..., 0]


def _held_alone(mechanics: Mechanics, resting: Array, free: Array, prescribed: Array, places: list[int], R: Array) -> Array:
    """The same where each contact brakes a coordinate of its own, whose acceleration without friction decides alone."""
    needed = np.stack([mechanics.masses[index] * (free[:, index] + prescribed[:, i]) for i, index in enumerate(places)], axis=1)
    return np.where(resting, needed, R)


def places_of(mechanics: Mechanics) -> list[int] | None:
    """The coordinate of each contact, if each brakes one of its own against what is no coordinate and there are no stops; else None."""
    if mechanics.stops or mechanics.joined:
        return None
    directions = mechanics.directions
    places = [[c for c, g in enumerate(row) if g] for row in directions]
    if any(len(indices) != 1 for indices in places) or any(row[indices[0]] != 1.0 for row, indices in zip(directions, places, strict=True)):
        return None
    own = [indices[0] for indices in places]
    return own if len(set(own)) == len(own) else None


def _multipliers(mechanics: Mechanics, G: Array, push: Array, loads: Array, held: Array) -> Array:
    """Forces R with G R = push; contacts that jointly hold one body share the force in proportion to their static friction limits.

    The contacts come first, then closed stops. If the ends of a stop rest on their own, that sharing determines the force of the stop,
    between zero and the largest that the static friction limits of the contacts permit.
    """
    if np.linalg.matrix_rank(G) == len(G):
        return np.linalg.solve(G, push.T).T
    limits = [law.breakaway(load) for law, load in zip([mechanics.laws[i] for i in held], loads.T, strict=True)]
    low, high = (np.stack([np.asarray(each[side], float) * np.ones(len(push)) for each in limits], 1) for side in (0, 1))
    stops = np.zeros((len(push), len(G) - len(held)))
    bears = np.hstack([high, stops + high.sum(axis=1, keepdims=True)])
    shared = np.einsum("ij,nj,kj->nik", G, bears, G)  # G R = push with R = bears (G^T y): the least R in units of the limits
    y = np.stack([np.linalg.lstsq(each, of, rcond=1e-12)[0] for each, of in zip(shared, push, strict=True)])
    return _allowed(G, bears * (y @ G), np.hstack([low, stops - np.inf]), np.hstack([high, stops]), len(held))


def _allowed(G: Array, R: Array, low: Array, high: Array, contacts: int) -> Array:
    """Forces shifted to lie within the limits, by a stop's force and contact forces at its ends that together do not affect the motion."""
    for p in range(contacts, len(G)):
        along = np.eye(len(G))[p]
        along[:contacts] = -np.linalg.lstsq(G[:contacts, :contacts], G[:contacts, p], rcond=1e-12)[0]
        if np.max(abs(G @ along)) > 1e-9 * np.max(abs(G)):
            continue  # its force is known
        moved = np.flatnonzero(abs(along) > 1e-9)
        ends = np.sort(np.stack([(limit[:, moved] - R[:, moved]) / along[moved] for limit in (low, high)]), axis=0)
        R = R + np.clip(0.0, np.max(ends[0], axis=1), np.min(ends[1], axis=1))[:, None] * along
    return R
