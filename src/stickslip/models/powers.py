"""The powers of a machine that lists its bodies, part by part: what comes in, what links store, what friction and dampers take."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.models.contact_forces import closed_stops, held_by_controllers
from stickslip.models.instant_forces import parts_of_forces
from stickslip.models.links_in_time import sees_time

if TYPE_CHECKING:
    from stickslip.models.mechanics import Mechanics


def powers(mechanics: Any, t: Array, x: Array, v: Array, z: Array, column: dict[str, Array]) -> dict[str, Array]:
    """Powers [W] at instants, from positions and velocities (n, bodies), inner states and the columns of the contacts.

    Returns
    -------
    dict
        drive: of forces, controllers, what moves the ground and stops, what prescribes distances, and links that see time, under the force
        that they have at rest; gravity: of what bodies say is gravity; friction: R w of each contact (n, contacts); potential: into other
        links and elastic stops, under the force that they have at rest; damping: what else each of them takes, (n, links);
        actuator: zero, since what drives inner masses is among the applied forces.
    """
    none = np.zeros_like(t)
    R, slip = column["friction_force"], column["slip"]
    stored, damped, applied = none, [], _applied(mechanics, t, x, v, held_by_controllers(mechanics, z))
    moving = [stop for stop in mechanics.stops if stop.part.at is not None]
    needed = bool(mechanics.prescribed or moving)
    net: Any = applied - R @ np.array(mechanics.slips_of, float).reshape(-1, len(mechanics.bodies)) if needed else None
    given, links = none, len(mechanics.elastic) - len(mechanics.elastic_stops)
    for i, ((ends, link), pull) in enumerate(zip(mechanics.elastic, mechanics.pulls, strict=True)):
        distance, rate = mechanics.distance(ends, x.T), mechanics.distance(ends, v.T)
        wall = link.motion.velocity(t) if i >= links and link.at is not None else 0.0  # of a stop that moves
        force, still = pull(t, distance, rate), pull(t, distance, 0.0 * rate + wall)
        if i < links and sees_time(link):
            given = given - still * rate
        else:
            stored, given = stored + still * (rate - wall), given - force * wall
        damped.append((force - still) * (rate - wall) + none)
        if net is not None:
            net = net - np.outer(force + none, [float(name == ends[0]) - float(name == ends[1]) for name in mechanics.bodies])
    weight = sum(body.weight_at(t, x[:, i], v[:, i]) * v[:, i] for i, body in enumerate(mechanics.parts.values()))
    prescribed = none if not mechanics.prescribed else _of_distances(mechanics, t, column["acceleration"], net)
    if moving:
        prescribed = prescribed + _of_closed_stops(mechanics, moving, t, x, v, column["acceleration"], net) + given
    else:
        prescribed = prescribed + given
    drive = (applied * v).sum(axis=1) - weight + _of_the_ground(mechanics, v, R, slip) + prescribed
    damping = np.array(damped).reshape(-1, len(t)).T
    return {"drive": drive, "gravity": weight + none, "friction": R * slip, "potential": stored, "damping": damping, "actuator": none}


def names_of_links(mechanics: Mechanics) -> list[str]:
    """The links and elastic stops by the bodies that they join, in the order of their columns."""
    stops = [label_of_stop(mechanics, name) for name, stop in mechanics.named_stops if stop.part.restitution is None]
    return [*_links(mechanics), *stops]


def label_of_stop(mechanics: Mechanics, name: str) -> str:
    """A stop by its name; with a word where a link has the same."""
    return f"{name} (stop)" if name in _links(mechanics) else name


def _links(mechanics: Any) -> list[str]:
    """The links that give way, without stops."""
    joined = mechanics.elastic[: len(mechanics.elastic) - len(mechanics.elastic_stops)]
    return ["-".join(end for end in ends if end is not None) for ends, _ in joined]


def _applied(mechanics: Any, t: Array, x: Array, v: Array, held: Any) -> Array:
    """Applied force on each body, with those of controllers (n, bodies) [N]."""
    at, moving = (dict(zip(mechanics.bodies, of.T, strict=True)) for of in (x, v))
    on = {name: body.applied(t, at[name], moving[name]) + 0.0 * t for name, body in mechanics.parts.items()}
    own = [(name, force) for name, _, force in parts_of_forces(mechanics.model.forces(t, at, moving).items())]
    for name, force in [*own, *mechanics.controllers.forces(t, at, moving, held)]:
        on[name] = on[name] + force
    return np.array(list(on.values())).T


def _of_distances(mechanics: Any, t: Array, acceleration: Array, net: Array) -> Array:
    """Power of what prescribes distances [W]: force that a body's acceleration asks for beyond all others, times velocity about its group.

    Within a group these forces add up to zero, so that only the velocities about its centre of mass count.
    """
    masses = np.array([float(body.mass) for body in mechanics.parts.values()])
    about = np.array([mechanics.velocities(when, (0.0,) * mechanics.coordinates) for when in t.tolist()])
    return ((acceleration * masses - net) * about).sum(axis=1)


def _of_closed_stops(mechanics: Any, stops: list[Any], t: Array, x: Array, v: Array, acceleration: Array, net: Array | None) -> Array:
    """Power of stops that move and are closed [W]: they are pressed by what the accelerations ask for beyond all other forces."""
    q, u = (mechanics.coordinates_of(tuple(of.T)) for of in (x, v))
    closed = closed_stops(mechanics, t, q, u)[:, [mechanics.stops.index(stop) for stop in stops]].any(axis=1)
    masses = np.array([float(body.mass) for body in mechanics.parts.values()])
    about = np.array([mechanics.velocities(when, (0.0,) * mechanics.coordinates) for when in t.tolist()])
    return np.where(closed, ((acceleration * masses - net) * (v - about)).sum(axis=1), 0.0)


def _of_the_ground(mechanics: Any, v: Array, R: Array, slip: Array) -> Array:
    """A contact takes R w; its bodies give R times their own relative velocity, and what moves the ground gives the rest [W]."""
    moving = dict(zip(mechanics.bodies, v.T, strict=True))
    total = np.zeros(len(v))
    for i, contact in enumerate(mechanics.joints.values()):
        own = sum(g * moving[name] for name, g in contact.coefficients.items())
        total = total + R[:, i] * (slip[:, i] - own)
    return total
