"""The mirror image of a machine that lists its parts: each part with forwards and backwards exchanged."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from operator import attrgetter
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import Frozen
from stickslip.basics.of_own import OfOwn
from stickslip.models.drives.turned import Reversed
from stickslip.models.friction.law_adapter import mirrored_law as mirrored_law
from stickslip.models.instant_forces import InstantForces, arguments_of_load, pressing
from stickslip.models.link_ends import Point
from stickslip.models.links_in_time import sees_time, several
from stickslip.models.machines.machine import Machine
from stickslip.models.machines.parts import Body, Contact
from stickslip.models.said_of_motion import inertia_of_machine, kinetic_of_machine, places_of_machine
from stickslip.models.several_bodies import along

Ends = tuple[str, str | None]


@dataclass(frozen=True, eq=False)
class Turned(Machine):
    """A machine in the mirror: bodies, contacts, links, stops and forces of another one, turned round. The names stay.

    Parameters
    ----------
    machine : Machine
        The other one.

    Examples
    --------
    >>> import stickslip as ss
    >>> pair = ss.Chain.example()
    >>> there, here = Turned(pair).mechanics, pair.mechanics
    >>> there.accelerations(0.01, (0.0, -0.1), (0.2, 0.0), (0.1, 0.0)) == tuple(-a for a in here.accelerations(0.01, (0.0, 0.1), (-0.2, 0.0), (-0.1, 0.0)))
    True
    """  # noqa: E501

    machine: Any

    period = property(attrgetter("machine.period"), doc="That of the machine [s].")
    principal = property(attrgetter("machine.principal"), doc="That of the machine.")

    def __getattr__(self, name: str) -> Any:
        """Other attributes of the machine, such as its gravity or its velocity scale."""
        if name.startswith("_") or name == "machine":
            raise AttributeError(name)
        return getattr(self.machine, name)

    def mirrored(self) -> Any:
        """The machine itself."""
        return self.machine

    def bodies(self) -> Mapping[str, Any]:
        """The bodies, on the other side of where positions are measured from."""
        return {name: _body(body) for name, body in self.machine.bodies().items()}

    def contacts(self) -> Mapping[str, Any]:
        """The contacts, with laws in the mirror."""
        return {name: _contact(contact, self.machine) for name, contact in self.machine.contacts().items()}

    def links(self) -> Mapping[Ends, Any]:
        """The links, whose ends change places; those to the ground are turned themselves."""
        return {_ends(ends): _turned(ends, link, _TurnedLink) for ends, link in self.machine.links().items()}

    def stops(self) -> Mapping[Ends, Any]:
        """The stops likewise."""
        return {_ends(ends): _turned(ends, stop, _stop) for ends, stop in self.machine.stops().items()}

    def controllers(self) -> Mapping[str, Any]:
        """The controllers, which see the machine as it is and act the other way round here; what they hold stays."""
        return {name: _TurnedController(part) for name, part in self.machine.controllers().items()}

    def forces(self, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any]) -> Mapping[str, Any]:
        """The forces, turned round."""
        return _negative(self.machine.forces(t, _negative(x), _negative(v)))


@dataclass(frozen=True, eq=False)
class TurnedCoordinates(Turned):
    """The same of a machine with coordinates of its own, which are turned round with it; heights stay."""

    coordinates = property(attrgetter("machine.coordinates"), doc="Those of the machine.")

    def bodies(self) -> Mapping[str, Any]:
        """The bodies, whose forces are turned round."""
        return {name: _placed_body(body) for name, body in self.machine.bodies().items()}

    def contacts(self) -> Mapping[str, Any]:
        """The contacts, with laws in the mirror."""
        return {name: _placed_contact(contact) for name, contact in self.machine.contacts().items()}

    def links(self) -> Mapping[Any, Any]:
        """The links, whose ends are turned round."""
        return {_placed_ends(ends): _placed_turned(ends, link, _TurnedLink) for ends, link in self.machine.links().items()}

    def stops(self) -> Mapping[Any, Any]:
        """The stops likewise."""
        return {_placed_ends(ends): _placed_turned(ends, stop, _stop) for ends, stop in self.machine.stops().items()}

    def places(self, t: Numeric, q: Mapping[str, Any]) -> Mapping[str, Any] | None:
        """The places, on the other side."""
        given = places_of_machine(self.machine, t, _negative(q))
        return None if given is None else {name: _across(components) for name, components in given.items()}

    def inertia(self, q: Mapping[str, Any]) -> Any:
        """The matrix of inertia where the other machine is."""
        return inertia_of_machine(self.machine, _negative(q))

    def kinetic(self, q: Mapping[str, Any], u: Mapping[str, Any]) -> Any:
        """The kinetic energy of the other machine."""
        return kinetic_of_machine(self.machine, _negative(q), _negative(u))


@dataclass(frozen=True, eq=False)
class _TurnedController:
    """A controller in the mirror."""

    part: Any

    states = property(attrgetter("part.states"), doc="Names of its states.")
    sample = property(attrgetter("part.sample"), doc="Time between its samples [s].")
    scales = property(attrgetter("part.scales"), doc="Sizes of its states.")

    def start(self, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any]) -> tuple[Any, ...]:
        """Its states when it is switched on."""
        return self.part.start(t, _negative(x), _negative(v))

    def rates(self, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any], z: Numeric | tuple[Numeric, ...]) -> tuple[Any, ...]:
        """Rates of its states."""
        return self.part.rates(t, _negative(x), _negative(v), z)

    def sampled(self, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any], z: Numeric | tuple[Numeric, ...]) -> tuple[Any, ...]:
        """Its states after a sample."""
        return self.part.sampled(t, _negative(x), _negative(v), z)

    def forces(self, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any], z: Numeric | tuple[Numeric, ...]) -> Mapping[str, Any]:
        """Its forces, turned round [N]."""
        return _negative(self.part.forces(t, _negative(x), _negative(v), z))


def _across(components: Any) -> Any:
    return tuple(part if k == 1 else -part for k, part in enumerate(components)) if isinstance(components, tuple) else -components


def _negative(values: Mapping[str, Any]) -> dict[str, Any]:
    return {name: _negative(value) if isinstance(value, Mapping) else -value for name, value in values.items()}


@dataclass(frozen=True, eq=False)
class _TurnedLink(Frozen):
    """A link to the ground in the mirror."""

    link: Any

    @property
    def stiffness(self) -> Any:
        """That of the link [N/m]; None where it has none."""
        return getattr(self.link, "stiffness", None)

    @property
    def breaks(self) -> Any:
        """Those of the link [s]."""
        return getattr(self.link, "breaks", None) or ()

    @property
    def force(self) -> Any:
        """Tension, turned round [N], by what that of the link is a function of."""
        tension = self.link.force
        if sees_time(self.link):
            return lambda t, distance, rate: -tension(t, -distance, -rate)
        return lambda distance, rate: -tension(-distance, -rate)


class _TurnedMotion(Reversed):
    """A motion in the mirror, which need not repeat as a drive does."""

    def _check(self, problems: Problems) -> None:
        """Whatever has a velocity may be one."""


def _body(body: Any) -> Body:
    def force(t: Numeric, x: Numeric, v: Numeric) -> Any:
        return -body.applied(t, -x, -v)

    def gravity(t: Numeric, x: Numeric, v: Numeric) -> Any:
        return -body.weight_at(t, -x, -v)

    jumps = tuple((instant, -jump) for instant, jump in body.jumps)
    return Body(body.mass, force=force, position=-body.position, jumps=jumps, breaks=body.breaks, gravity=gravity)


def _contact(contact: Any, machine: Any) -> Contact:
    count = arguments_of_load(contact.load) or 0
    load: Any = None if contact.load is None else lambda t, x: contact.normal(t, -x)
    if count > 2:
        press = pressing(contact.load, count, partial(along, contact))

        def load(t: Numeric, x: OfOwn, v: OfOwn, forces: InstantForces) -> Any:
            there = forces.seen(machine.mechanics, _negative(x.others), _negative(v.others))
            return press(t, _negative(x.others), _negative(v.others), there)

    return Contact(contact.body, mirrored_law(contact.friction), on=_on(contact.on), load=load, restitution=contact.restitution)


def _placed_body(body: Any) -> Body:
    """A body of a machine with places, whose forces are along x, along z, and a torque."""

    def force(t: Numeric, x: Any, v: Any) -> Any:
        given = body.applied(t, _across(x), _across(v))
        return _across(given)

    return Body(body.mass, force=force, inertia=body.inertia)


def _placed_contact(contact: Any) -> Contact:
    """A contact of a machine with coordinates of its own, whose load is a function of these."""
    load = (lambda t, q: contact.load(t, _negative(q))) if callable(contact.load) else contact.load
    at = None if contact.at is None else (-contact.at[0], contact.at[1])
    return contact.replace(friction=mirrored_law(contact.friction), on=_on(contact.on), load=load, at=at)


def _stop(stop: Any) -> Any:
    """A stop on the ground in the mirror."""
    turned = stop.replace(side=-stop.side)
    if stop.at is None:
        return turned
    return turned.replace(at=(lambda t: -stop.at(t)) if callable(stop.at) else _TurnedMotion(stop.at))


def _on(on: Any) -> Any:
    """The counterpart of a contact in the mirror image: a belt or a prescribed motion is reversed."""
    if on is None or isinstance(on, str):
        return on
    if callable(getattr(on, "velocity", None)):
        return _TurnedMotion(on)
    return (lambda x: on(-x)) if callable(on) else -on


def _ends(ends: tuple[Any, Any]) -> Any:
    return ends if ends[1] is None else (ends[1], ends[0])


def _placed_ends(ends: tuple[Any, Any]) -> Any:
    first, second = (_across_point(end) if isinstance(end, Point) else end for end in ends)
    return _ends((first, second))


def _across_point(point: Point) -> Point:
    at = point.at
    return Point(point.body, at=(lambda t: _across(at(t))) if callable(at) else _across(at))


def _placed_turned(ends: tuple[Any, Any], parts: Any, one: Callable[[Any], Any]) -> Any:
    """Links or stops of points pull as strongly in the mirror; others are turned as on a line."""
    return parts if any(isinstance(end, Point) for end in ends) else _turned(ends, parts, one)


def _turned(ends: Ends, parts: Any, one: Callable[[Any], Any]) -> Any:
    """Links or stops: between two bodies it is the ends that change places, on the ground each part is turned round."""
    return parts if ends[1] is not None else tuple(map(one, several(parts)))
