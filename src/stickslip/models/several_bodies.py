"""The equations of motion of a machine that lists its bodies, contacts, links and stops."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property, partial, reduce
from operator import add, attrgetter
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Numeric
from stickslip.basics.maths import maximum, minimum, pi, sqrt
from stickslip.models.controllers import Controllers
from stickslip.models.friction.law_adapter import LawAdapter, adapted
from stickslip.models.instant_forces import InstantForces, arguments_of_load, parts_of_forces, pressing
from stickslip.models.links_in_time import pull_of, sees_time, several
from stickslip.models.mechanics import SOME, Mechanics, Numbers, signed_less
from stickslip.models.powers import names_of_links, powers

GRAVITY = 9.81  # of a machine that does not say its own [m/s^2]
_LOOKS = 8  # instants of a period at which applied forces are looked at for their size
_LEAST = 1e-3  # of the velocity that a force as large as the load gives: the scale of an autonomous machine


class Stopper:
    """A stop between two bodies or a body and the ground: its gap is h q + d(t), and it is open while that is positive."""

    restitution = property(attrgetter("part.restitution"), doc="Restitution of a hit; None of an elastic stop.")

    def __init__(self, mechanics: SeveralBodies, ends: tuple[str, str | None], part: Any):
        self.mechanics, self.ends, self.part = mechanics, ends, part
        self.name = "-".join(end for end in ends if end is not None)
        row = mechanics.row(*ends)
        self.direction = tuple(-part.side * g for g in row)  # of the gap

    def gap(self, t: Numeric, q: Numbers) -> Any:
        """The distance left until they touch [m]."""
        return self.part.gap_left(self.mechanics.distance(self.ends, self.mechanics.positions(t, q)), t)

    def rate(self, t: Numeric, u: Numbers) -> Any:
        """How fast the gap opens [m/s]."""
        rate = self.mechanics.distance(self.ends, self.mechanics.velocities(t, u))
        return -self.part.side * rate if self.part.at is None else -self.part.closes_at(rate, t)

    def pressed(self, x: Numbers, v: Numbers, t: Numeric) -> Any:
        """How strongly an elastic stop pushes its ends apart [N], from the positions and velocities of the bodies."""
        return self.part.side * self.part.force(self.mechanics.distance(self.ends, x), self.mechanics.distance(self.ends, v), t)

    def offset_rate(self, t: Numeric) -> Any:
        """The contribution of prescribed distances, and of a stop that moves, to the acceleration of the gap [m/s^2]."""
        arms = -self.part.side * self.mechanics.distance(self.ends, self.mechanics._arms("acceleration", t))
        return arms if self.part.at is None else arms + self.part.side * self.part.motion.acceleration(t)


class SeveralBodies(Mechanics):
    """A machine that lists its bodies, contacts, links and stops.

    Bodies that a link keeps at a prescribed distance share one coordinate, their centre of mass.
    """

    def __init__(self, model: Any):
        self.model, self.parts = model, dict(model.bodies())
        self.bodies, self.joints = tuple(self.parts), dict(model.contacts())
        self.number = {name: i for i, name in enumerate(self.bodies)}
        self.contacts = tuple(self.joints)
        counts = [arguments_of_load(c.load) or 0 for c in self.joints.values()]
        self.presses = [
            pressing(c.load, n, partial(along, c)) if n > 2 else None for c, n in zip(self.joints.values(), counts, strict=True)
        ]
        self.of_motion = tuple(n > 2 for n in counts)
        self.controllers = Controllers(model.controllers())
        links = {ends: several(link) for ends, link in model.links().items()}
        self.elastic = [(ends, link) for ends, each in links.items() for link in each if _is_elastic(link)]
        self.prescribed = [(ends, link) for ends, each in links.items() for link in each if not _is_elastic(link)]
        walls = [(ends, stop) for ends, each in model.stops().items() for stop in several(each)]
        self.elastic_stops = [(ends, stop) for ends, stop in walls if stop.restitution is None]
        self.pulls = [pull_of(link) for _, link in self.elastic] + [stop.pull for _, stop in self.elastic_stops]
        self.elastic += self.elastic_stops
        self.groups, self.arms = _groups(self.bodies, self.prescribed)
        self.coordinate = {name: c for c, group in enumerate(self.groups) for name in group}
        self.named_stops = _named([Stopper(self, ends, stop) for ends, stop in walls])
        self.stops = tuple(stop for _, stop in self.named_stops if stop.part.restitution is not None)

    # ---- what there is ----
    @property
    def coordinates(self) -> int:
        """One for each body or group of bodies at prescribed distances."""
        return len(self.groups)

    @cached_property
    def laws(self) -> tuple[LawAdapter, ...]:
        """The law of each contact."""
        return tuple(adapted(contact.friction, contact.restitution) for contact in self.joints.values())

    @cached_property
    def masses(self) -> tuple[Any, ...]:
        """All that moves with each coordinate [kg]."""
        return tuple(_sum(self.parts[name].mass for name in group) for group in self.groups)

    @property
    def shares(self) -> tuple[Any, ...]:
        """Part of each coordinate in the way that the machine makes: that of its principal body, else that of its centre of mass."""
        principal = getattr(self.model, "principal", None)
        if principal is None:
            return super().shares
        return tuple(float(c == self.coordinate[principal]) for c in range(self.coordinates))

    @cached_property
    def directions(self) -> tuple[tuple[float, ...], ...]:
        """1 at the coordinate of the contact's body, -1 at that of the body it rubs on; or what the contact says."""
        return tuple(tuple(float(g) if isinstance(g, (int, float)) else SOME for g in row) for row in self.rows(0.0, ()))

    def rows(self, t: Numeric, q: Numbers) -> tuple[tuple[Any, ...], ...]:
        """The same with the numbers that contacts say."""
        n = len(self.groups)
        return tuple(tuple(dict(row).get(k, 0.0) for k in range(n)) for row in self._rows)

    @cached_property
    def _rows(self) -> list[list[tuple[int, Any]]]:
        """What the slip of each contact takes of coordinates, where that is not zero."""
        return [self._row_of(contact) for contact in self.joints.values()]

    @cached_property
    def _ends(self) -> list[list[tuple[int, float]]]:
        """What the distance of the ends of each elastic link takes of coordinates, where that is not zero."""
        return [self._entries(*ends) for ends, _ in self.elastic]

    def _row_of(self, contact: Any) -> list[tuple[int, Any]]:
        """What a contact's slip takes of coordinates, where it is not zero: the number of each and its coefficient, in their order."""
        if isinstance(contact.body, str):
            return self._entries(contact.body, contact.on if isinstance(contact.on, str) else None)
        row: dict[int, Any] = {}
        for name, g in contact.coefficients.items():
            c = self.coordinate[name]
            row[c] = row[c] + g if c in row else g
        return [(c, row[c]) for c in sorted(row)]

    @cached_property
    def slips_of(self) -> tuple[tuple[float, ...], ...]:
        """1 at the contact's body, -1 at the body it rubs on; or what the contact says."""
        given = [c.coefficients for c in self.joints.values()]
        return tuple(
            tuple(float(g) if isinstance(g, (int, float)) else SOME for g in (of.get(name, 0.0) for name in self.bodies)) for of in given
        )

    def row(self, first: str, second: str | None) -> tuple[float, ...]:
        """Coefficients of the coordinates in the distance of two bodies, or of one from the ground."""
        coefficients = [0.0] * len(self.groups)
        for c, g in self._entries(first, second):
            coefficients[c] = g
        return tuple(coefficients)

    def _entries(self, first: str, second: str | None) -> list[tuple[int, float]]:
        """The coefficients that are not zero, each with the number of its coordinate, in the order of the coordinates."""
        one, other = self.coordinate[first], None if second is None else self.coordinate[second]
        if other is None:
            return [(one, 1.0)]
        return [] if one == other else sorted([(one, 1.0), (other, -1.0)])

    @cached_property
    def start(self) -> tuple[Any, ...]:
        """Centre of mass of the bodies of each coordinate, where they begin [m]."""
        return tuple(
            _sum(self.parts[name].mass * self.parts[name].position for name in group) / mass
            if len(group) > 1
            else self.parts[group[0]].position
            for group, mass in zip(self.groups, self.masses, strict=True)
        )

    @property
    def jumps(self) -> tuple[tuple[Any, tuple[Any, ...]], ...]:
        """Those of the bodies, each as its part of its coordinate's mass."""
        n, jumps = len(self.groups), []
        for name, body in self.parts.items():
            c = self.coordinate[name]
            part = 1.0 if len(self.groups[c]) == 1 else body.mass / self.masses[c]
            jumps += [(instant, tuple(part * jump if j == c else 0.0 for j in range(n))) for instant, jump in body.jumps]
        instants = [instant for motion in self._motions for instant, _ in getattr(motion, "jumps", None) or ()]
        instants += [instant for stop in self.stops for instant in stop.part.instants]  # one that is closed may be left, or be hit
        return (*jumps, *((instant, (0.0,) * n) for instant in instants))  # there slips jump, and no coordinate does

    @property
    def breaks(self) -> tuple[Any, ...]:
        """Instants in (0, period) at which applied forces, prescribed distances or motions are not smooth [s]."""
        links = (link for _, link in self.elastic[: len(self.elastic) - len(self.elastic_stops)])
        own = [s for part in (*self.parts.values(), *self._motions, *links) for s in getattr(part, "breaks", None) or ()]
        own += [s for _, stop in self.named_stops for s in stop.part.instants]
        return (*own, *(getattr(self.model, "breaks", None) or ()))

    @property
    def _motions(self) -> list[Any]:
        """Prescribed distances, and what contacts rub on that is neither the track nor a body."""
        return [link for _, link in self.prescribed] + [c.on for c in self.joints.values() if c.on is not None]

    @property
    def time_scale(self) -> Any:
        """A time in which something happens [s]: the period, what the machine says, or the fastest spring's; None where nobody knows."""
        if self.period is not None:
            return self.period
        own = getattr(self.model, "time_scale", None)
        stiff = [
            (link.stiffness, self.masses[self.coordinate[ends[0]]])
            for ends, link in self.elastic
            if isinstance(getattr(link, "stiffness", None), (int, float)) and link.stiffness > 0
        ]
        return own if own is not None or not stiff else reduce(minimum, [2 * pi * sqrt(m / k) for k, m in stiff])

    @property
    def velocity_scale(self) -> Any:
        """A typical velocity [m/s]: what the machine says, else what its applied forces and motions do in a part of the period."""
        own = getattr(self.model, "velocity_scale", None)
        if own is not None:
            return own
        time = self.time_scale
        time = 1.0 if time is None else time
        start, still = self.start, (0.0,) * len(self.groups)
        largest: Any = 0.0
        for q, contact, row in zip(self.loads(0.0, start), self.joints.values(), self._rows, strict=True):
            if isinstance(contact.body, str):
                largest = maximum(largest, _LEAST * abs(q) / self.masses[self.coordinate[contact.body]] * time)
            else:
                lightness = _sum(g * g / self.masses[c] for c, g in row)
                largest = maximum(largest, _LEAST * abs(q) * lightness * time)
        for k in range(_LOOKS if self.period is not None else 1):
            t = time * (k / _LOOKS)
            for a in self.accelerations(t, start, still, (0.0,) * len(self.contacts)):
                largest = maximum(largest, abs(a) * time / (2 * pi))
            for b in (*self.offsets(t), *(stop.part.motion.velocity(t) for _, stop in self.named_stops if stop.part.at is not None)):
                largest = maximum(largest, abs(b))
        return largest

    def _middle(self, group: tuple[str, ...], values: dict[str, Any]) -> Any:
        """The mass-weighted mean over the bodies of a coordinate."""
        if len(group) == 1:
            return values[group[0]]
        return _sum(self.parts[name].mass * values[name] for name in group) / self.masses[self.coordinate[group[0]]]

    # ---- motion ----
    def accelerations(self, t: Numeric, q: Numbers, u: Numbers, R: Numbers, z: Numbers | None = None) -> tuple[Any, ...]:
        """Newton's law for each coordinate."""
        x, v = self._named(t, q, u)
        total: list[Any] = [0.0] * len(self.groups)
        for name, body in self.parts.items():
            total[self.coordinate[name]] = total[self.coordinate[name]] + body.applied(t, x[name], v[name])
        controlled = self.controllers.forces(t, x, v, self.controllers.start(t, x, v) if z is None else z)
        applied = [(name, force) for name, _, force in parts_of_forces(self.model.forces(t, dict(x), dict(v)).items())]
        for name, force in (*applied, *controlled):
            total[self.coordinate[name]] = total[self.coordinate[name]] + force
        for (ends, _), pull, entries in zip(self.elastic, self.pulls, self._ends, strict=True):
            tension = pull(t, _distance(ends, x), _distance(ends, v))
            for c, g in entries:
                total[c] = signed_less(total[c], g, tension)
        for row, force in zip(self._rows, R, strict=True):
            for c, g in row:
                total[c] = signed_less(total[c], g, force)
        return tuple(force / mass for force, mass in zip(total, self.masses, strict=True))

    def distance(self, ends: tuple[str, str | None], values: Numbers) -> Any:
        """Difference of what two bodies have; with the ground, what the first has."""
        first = values[self.number[ends[0]]]
        return first if ends[1] is None else first - values[self.number[ends[1]]]

    def loads(self, t: Numeric, q: Numbers, u: Numbers | None = None, z: Numbers | None = None) -> tuple[Any, ...]:
        """Normal force on each contact [N]."""
        return self._pressed(range(len(self.contacts)), t, q, u, z)

    def load(self, i: int, t: Numeric, q: Numbers, u: Numbers | None = None, z: Numbers | None = None) -> Any:
        """Normal force on one contact [N]."""
        return self._pressed((i,), t, q, u, z)[0]

    def load_under(self, i: int, t: Numeric, q: Numbers, u: Numbers, body: str, applied: Any) -> Any:
        """Normal force on one contact under one more force of a motor on a body, such as a recorded one [N]."""
        press, x, v = self.presses[i], *self._named(t, q, u)
        forces = InstantForces(self, t, x, v, self.controllers.start(t, x, v)).with_more(body, "motor", applied)
        return self.load(i, t, q, u) if press is None else press(t, x, v, forces)

    def _pressed(self, which: Iterable[int], t: Numeric, q: Numbers, u: Numbers | None, z: Numbers | None) -> tuple[Any, ...]:
        """Normal forces on some contacts [N]."""
        x, v = dict(zip(self.bodies, self.positions(t, q), strict=True)), dict[str, Any]()
        forces: InstantForces | None = None
        asked, gravity = [(self.presses[i], self.joints[self.contacts[i]]) for i in which], getattr(self.model, "gravity", GRAVITY)
        if any(self.of_motion[i] for i in which):
            v = dict(zip(self.bodies, self.velocities(t, (0.0,) * len(self.groups) if u is None else u), strict=True))
            forces = InstantForces(self, t, x, v, self.controllers.start(t, x, v) if z is None else z)
        given = [(c, c.normal(t, along(c, x)) if press is None else press(t, x, v, forces)) for press, c in asked]
        return tuple(self.parts[c.body].mass * gravity if load is None else load for c, load in given)

    def offsets(self, t: Numeric) -> tuple[Any, ...]:
        """The contribution of prescribed distances, belts and motions to the slip [m/s]."""
        offsets = self._offsets("velocity", t)
        return tuple(offset - prescribed_velocity(c.on, t) for offset, c in zip(offsets, self.joints.values(), strict=True))

    def _offsets(self, what: str, t: Numeric) -> tuple[Any, ...]:
        """The contribution of prescribed distances to each slip, or to its rate."""
        return self._offsets_of(self._arms(what, t)) if self.prescribed else self._no_offsets

    def _offsets_of(self, arms: tuple[Any, ...]) -> tuple[Any, ...]:
        named = dict(zip(self.bodies, arms, strict=True))
        return tuple(_offset(named, c) for c in self.joints.values())

    @cached_property
    def _no_offsets(self) -> tuple[Any, ...]:
        return self._offsets_of((0.0,) * len(self.bodies))

    def slips(self, t: Numeric, u: Numbers, q: Numbers = ()) -> tuple[Any, ...]:
        """Slip velocity of each contact [m/s]."""
        slips = []
        for row, offset in zip(self._rows, self.offsets(t), strict=True):
            total: Any = 0.0
            for c, g in row:
                total = signed_less(total, -g, u[c])
            slips.append(total + offset)
        return tuple(slips)

    def positions(self, t: Numeric, q: Numbers) -> tuple[Any, ...]:
        """Position of each body [m]."""
        if not self.prescribed:
            return tuple(q[self.coordinate[name]] for name in self.bodies)
        start, own = self.start, self.parts
        arms = self._arms("position", t)
        single = [len(self.groups[self.coordinate[name]]) == 1 for name in self.bodies]
        return tuple(
            q[self.coordinate[name]] if alone else q[self.coordinate[name]] + (own[name].position - start[self.coordinate[name]] + arm)
            for name, arm, alone in zip(self.bodies, arms, single, strict=True)
        )

    def velocities(self, t: Numeric, u: Numbers) -> tuple[Any, ...]:
        """Velocity of each body [m/s]."""
        return tuple(_plus(u[self.coordinate[name]], arm) for name, arm in zip(self.bodies, self._arms("velocity", t), strict=True))

    def kinetic(self, v: Array, x: Array | None = None) -> Array:
        """Kinetic energy of all bodies from their velocities (..., bodies) [J]."""
        return np.asarray(0.5 * v**2 @ np.array([float(body.mass) for body in self.parts.values()]))

    def powers(self, t: Array, x: Array, v: Array, z: Array, column: dict[str, Array]) -> dict[str, Array]:
        """Those of its bodies, links, stops and contacts."""
        return powers(self, t, x, v, z, column)

    @property
    def names_of_links(self) -> list[str]:
        """The links and elastic stops by the bodies that they join."""
        return names_of_links(self)

    def difference(self, i: int) -> bool:
        """Where it rubs on a body or a motion, or its body moves otherwise than its coordinate."""
        contact = self.joints[self.contacts[i]]
        if not isinstance(contact.body, str):
            return True
        arms = self.arms[contact.body] or len(self.groups[self.coordinate[contact.body]]) > 1
        return bool(arms) or isinstance(contact.on, str) or callable(getattr(contact.on, "velocity", None))

    def coordinate_of(self, body: str) -> int:
        """Number of the coordinate of its group."""
        return self.coordinate[body]

    def coordinates_of(self, values: Numbers) -> tuple[Any, ...]:
        """Those of the centres of mass."""
        named = dict(zip(self.bodies, values, strict=True))
        return tuple(self._middle(group, named) for group in self.groups)

    def accelerations_of_bodies(self, t: Numeric, a: Numbers) -> tuple[Any, ...]:
        """Acceleration of each body [m/s^2]."""
        return tuple(_plus(a[self.coordinate[name]], arm) for name, arm in zip(self.bodies, self._arms("acceleration", t), strict=True))

    def offset_rates(self, t: Numeric) -> tuple[Any, ...]:
        """Rates of the contacts' offsets [m/s^2]."""
        offsets = self._offsets("acceleration", t)
        return tuple(offset - prescribed_acceleration(c.on, t) for offset, c in zip(offsets, self.joints.values(), strict=True))

    @cached_property
    def separate(self) -> tuple[Any, ...] | None:
        """Its contacts with the ground, by body, if each body has one at most and forces are those of links and of bodies alone.

        A tuple with the contact and its law for each body, or None where there is none; None for machines with anything else: stops,
        controllers, prescribed distances, jumps, breaks, forces of their own, contacts between bodies or with what has a motion.
        """
        x, v = self._named(0.0, self.start, (0.0,) * len(self.groups))
        others = (
            any(sees_time(link) for _, link in self.elastic)
            or self.named_stops
            or self.controllers.names
            or self.prescribed
            or self.breaks
            or self.jumps
        )
        if others or dict(self.model.forces(0.0, dict(x), dict(v))):
            return None
        of: dict[str, Any] = {}
        for contact, law in zip(self.joints.values(), self.laws, strict=True):
            moved = isinstance(contact.on, str) or callable(getattr(contact.on, "velocity", None))
            if not isinstance(contact.body, str) or contact.body in of or moved or callable(contact.load):
                return None
            of[contact.body] = contact, law
        return tuple(of.get(name) for name in self.bodies)

    def _arms(self, what: str, t: Numeric) -> tuple[Any, ...]:
        """The contribution of prescribed distances to each body's position, velocity or acceleration, beyond its coordinate's."""
        if not self.prescribed:
            return (0.0,) * len(self.bodies)
        arms: dict[str, Any] = {}
        for group in self.groups:
            raw = {name: _sum(sign * getattr(link, what)(t) for sign, link in self.arms[name]) for name in group}
            middle = self._middle(group, raw)
            arms |= {name: raw[name] - middle if len(group) > 1 else 0.0 for name in group}
        return tuple(arms[name] for name in self.bodies)


def _groups(bodies: tuple[str, ...], links: list[tuple[Any, Any]]) -> tuple[list[tuple[str, ...]], dict[str, list[tuple[float, Any]]]]:
    """Bodies that prescribed distances join, and for each body the links, with their signs, from the first of its group to it."""
    groups: list[tuple[str, ...]] = []
    arms: dict[str, list[tuple[float, Any]]] = {}
    left = list(bodies)
    while left:
        group, reached = [left[0]], dict[str, list[tuple[float, Any]]]({left[0]: []})
        for at in group:  # grows while it is walked
            for (a, b), link in links:
                for here, there, sign in ((a, b, -1.0), (b, a, 1.0)):
                    if here == at and there not in reached:
                        reached[there] = [*reached[at], (sign, link)]
                        group.append(there)
        groups.append(tuple(group))
        arms |= reached
        left = [name for name in left if name not in reached]
    return groups, arms


def _named(stops: list[Stopper]) -> list[tuple[str, Stopper]]:
    """Stops with their names, numbered where two bodies have several between them."""
    names = [stop.name for stop in stops]
    for k, (name, stop) in enumerate(zip(names, stops, strict=True)):
        stop.name = name if names.count(name) == 1 else f"{name} {names[: k + 1].count(name)}"
    return [(stop.name, stop) for stop in stops]


def _distance(ends: tuple[str, str | None], values: dict[str, Any]) -> Any:
    """Difference of what two bodies have, by their names; with the ground, what the first has."""
    return values[ends[0]] if ends[1] is None else values[ends[0]] - values[ends[1]]


def _is_elastic(link: Any) -> bool:
    return callable(getattr(link, "force", None))


def along(contact: Any, x: dict[str, Any]) -> Any:
    """The position that a contact's load is a function of [m]."""
    return x[contact.body] if isinstance(contact.body, str) else _sum(g * x[name] for name, g in contact.coefficients.items())


def _offset(arms: dict[str, Any], contact: Any) -> Any:
    if not isinstance(contact.body, str):
        moved = [(g, arms[name]) for name, g in contact.coefficients.items()]
        return _sum(g * arm for g, arm in moved if not (isinstance(arm, float) and arm == 0.0))
    other = arms[contact.on] if isinstance(contact.on, str) else 0.0
    return arms[contact.body] - other


def prescribed_velocity(on: Any, t: Numeric) -> Any:
    """Velocity of what a contact rubs on, where that is not a body [m/s]."""
    return 0.0 if on is None or isinstance(on, str) else on.velocity(t) if callable(getattr(on, "velocity", None)) else on


def prescribed_acceleration(on: Any, t: Numeric) -> Any:
    """Acceleration of the same [m/s^2]."""
    return on.acceleration(t) if callable(getattr(on, "acceleration", None)) else 0.0


def _sum(terms: Iterable[Any]) -> Any:
    return reduce(add, terms, 0.0)


def _plus(value: Numeric, arm: Any) -> Any:
    return value if isinstance(arm, float) and arm == 0.0 else value + arm
