"""The equations of motion of any machine, as functions of plain numbers: one coordinate for each body that moves independently.

Everything here takes floats, arrays of cases or symbols, so that the plain integrators and the tracer use the same declaration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property, reduce
from operator import add
from types import MappingProxyType
from typing import Any, Protocol

import numpy as np

from stickslip.basics.contracts import Array, Model, Numeric, OneContact
from stickslip.models.controllers import NO_CONTROLLERS, Controllers
from stickslip.models.friction.law_adapter import LawAdapter, law_of
from stickslip.models.normal_loads import normal_load
from stickslip.models.position_dependence import knows_position

Numbers = Sequence[Any]

SOME = 2.0  # in a row of `directions`, a coefficient that is known with the case, the instant or the place alone


class Mechanics(Protocol):
    """The protocol between a machine and the solvers. Coordinates q [m] have velocities u; bodies, contacts and stops have names.

    A contact's slip velocity is w = g u + b(t), with its row g of `directions` and its offset b.
    """

    model: Any
    bodies: tuple[str, ...]
    contacts: tuple[str, ...]
    joints: Mapping[str, Any] = MappingProxyType({})  # the same as declared; empty for one body on one contact
    stops: tuple[Any, ...] = ()  # those with restitution
    named_stops: Sequence[tuple[str, Any]] = ()  # all of them
    elastic: Sequence[tuple[Any, Any]] = ()  # links and elastic stops, with the bodies that they join
    prescribed: Sequence[tuple[Any, Any]] = ()  # links that keep a distance
    controllers: Controllers = NO_CONTROLLERS
    of_motion: tuple[bool, ...] = ()  # of each contact, whether its load is a function of velocities or forces; () if no load is
    single: bool = False  # it is one body on one contact by its kind, and columns have no axes for them
    joined: bool = False  # the friction of a contact accelerates coordinates otherwise than by its row over their masses

    @property
    def has_places(self) -> bool:
        """Whether bodies are elsewhere than coordinates say, in a plane."""
        return False

    @property
    def angles(self) -> tuple[str, ...]:
        """Names of the coordinates that are angles while others may be lengths."""
        return ()

    @property
    def coordinates(self) -> int:
        """Number of bodies, or groups of bodies, that move independently."""

    @property
    def laws(self) -> tuple[LawAdapter, ...]:
        """The law of each contact."""

    @property
    def masses(self) -> tuple[Any, ...]:
        """The mass of each coordinate [kg]."""

    @property
    def directions(self) -> tuple[tuple[float, ...], ...]:
        """For each contact, the coefficients of the coordinates' velocities in its slip; `SOME` for one that is no literal number."""

    def rows(self, t: Numeric, q: Numbers) -> tuple[tuple[Any, ...], ...]:
        """The coefficients themselves, where `directions` has `SOME` for a number that a case, an instant or a place decides."""
        return self.directions

    @property
    def slips_of(self) -> tuple[tuple[float, ...], ...]:
        """For each contact, the coefficients of the bodies' velocities in its slip."""
        return self.directions

    @property
    def shares(self) -> tuple[Any, ...]:
        """Weight of each coordinate in the displacement of the machine: that of its centre of mass."""
        total = reduce(add, self.masses)
        return tuple(mass / total for mass in self.masses)

    @property
    def separate(self) -> tuple[Any, ...] | None:
        """For each body its contact with the ground and the law of that, where nothing else joins bodies but links; else None."""
        return None

    @property
    def start(self) -> tuple[Any, ...]:
        """Default initial coordinates of a run [m]."""
        return (0.0,) * self.coordinates

    @property
    def period(self) -> Any:
        """Period of the drives [s]; None if there is none."""
        return self.model.period

    @property
    def jumps(self) -> tuple[tuple[Any, tuple[Any, ...]], ...]:
        """Known jumps of the velocities: (instant in [0, period) [s], jump of each coordinate's velocity [m/s])."""
        return ()

    @property
    def inner(self) -> tuple[int, ...]:
        """Number of inner states of the law of each contact, and then of each controller."""
        return (*(law.states for law in self.laws), *self.controllers.counts)

    def accelerations(self, t: Numeric, q: Numbers, u: Numbers, R: Numbers, z: Numbers | None = None) -> tuple[Any, ...]:
        """Accelerations of the coordinates [m/s^2] under the contacts' friction forces R [N].

        z are the states of the controllers; if not given, the controllers are switched on at this instant.
        """

    def loose_accelerations(self, t: Numeric, q: Numbers, u: Numbers, R: Numbers, z: Numbers | None = None) -> tuple[Any, ...]:
        """The same without the normal force of a contact that keeps its height."""
        return self.accelerations(t, q, u, R, z)

    def pushed(self, t: Numeric, q: Numbers, force: Numbers) -> tuple[Any, ...]:
        """Accelerations that forces on the coordinates make."""
        return tuple(each / mass for each, mass in zip(force, self.masses, strict=True))

    def offsets(self, t: Numeric) -> tuple[Any, ...]:
        """Slip velocity of each contact while no coordinate moves [m/s]."""

    def loads(self, t: Numeric, q: Numbers, u: Numbers | None = None, z: Numbers | None = None) -> tuple[Any, ...]:
        """Normal force on each contact [N].

        Loads that are functions of velocities and forces (`of_motion`) are those at rest, and under controllers that are switched on at
        this instant, where velocities u and the states z of the controllers are not given.
        """

    def load(self, i: int, t: Numeric, q: Numbers, u: Numbers | None = None, z: Numbers | None = None) -> Any:
        """Normal force on one contact [N]."""
        return self.loads(t, q, u, z)[i]

    def decides(self, i: int, t: Numeric, q: Numbers, per_load: Any) -> Any:
        """Positive as long as one load of a contact follows from the motion, under friction of `per_load` for each newton of it.

        None of a contact whose load is given.
        """
        return None

    def positions(self, t: Numeric, q: Numbers) -> tuple[Any, ...]:
        """Position of each body [m]."""
        return tuple(q)

    def velocities(self, t: Numeric, u: Numbers) -> tuple[Any, ...]:
        """Velocity of each body [m/s]."""
        return tuple(u)

    def control_start(self, t: Numeric, q: Numbers, u: Numbers) -> tuple[Any, ...]:
        """States of the controllers when they are switched on."""
        return self.controllers.start(t, *self._named(t, q, u))

    def control_rates(self, t: Numeric, q: Numbers, u: Numbers, z: Numbers) -> tuple[Any, ...]:
        """Rates of the controllers' states between samples."""
        return self.controllers.rates(t, *self._named(t, q, u), z)

    def control_sampled(self, t: Numeric, q: Numbers, u: Numbers, z: Numbers) -> tuple[Any, ...]:
        """The controllers' states after a sample."""
        return self.controllers.sampled(t, *self._named(t, q, u), z)

    def control_answers(self, t: Numeric, q: Numbers, u: Numbers) -> tuple[Any, ...]:
        """Rates of the controllers' states and the states themselves, for controllers switched on at these positions and velocities."""
        z = self.control_start(t, q, u)
        return (*self.control_rates(t, q, u, z), *z)

    def _named(self, t: Numeric, q: Numbers, u: Numbers) -> tuple[dict[str, Any], dict[str, Any]]:
        """Positions and velocities of the bodies by their names."""
        return (
            dict(zip(self.bodies, self.positions(t, q), strict=True)),
            dict(zip(self.bodies, self.velocities(t, u), strict=True)),
        )

    def coordinate_of(self, body: str) -> int:
        """Number of the coordinate with which a body moves."""
        return self.bodies.index(body)

    def coordinates_of(self, values: Numbers) -> tuple[Any, ...]:
        """Coordinates from the positions of the bodies, or their velocities from those of the bodies."""
        return tuple(values)

    def accelerations_of_bodies(self, t: Numeric, a: Numbers) -> tuple[Any, ...]:
        """Acceleration of each body [m/s^2] from those of the coordinates."""
        return tuple(a)

    def offset_rates(self, t: Numeric) -> tuple[Any, ...]:
        """Rates of the contacts' offsets [m/s^2]."""
        return (0.0,) * len(self.contacts)

    def slip_biases(self, t: Numeric, q: Numbers, u: Numbers) -> tuple[Any, ...]:
        """Rate of each slip while the coordinates' velocities and the offsets stay as they are [m/s^2]: of rows that vary."""
        return (0.0,) * len(self.contacts)

    def heights(self, t: Numeric, q: Numbers, u: Numbers) -> dict[str, tuple[Any, Any]]:
        """By contact that keeps the height of its point, which coordinates could change, this height [m] and its rate [m/s]."""
        return {}

    @property
    def flying(self) -> tuple[int, ...]:
        """Numbers of the contacts whose inner states, the gap and its rate, follow from the coordinates."""
        return ()

    @property
    def together(self) -> bool:
        """Whether loads that follow from the motion, and other contacts, follow from one another."""
        return False

    def completed(self, q: Numbers, u: Numbers, z: Numbers) -> list[Any]:
        """Inner states of contacts and controllers, of which those that follow from coordinates do."""
        return list(z)

    @property
    def varying(self) -> tuple[bool, ...]:
        """Of each contact, whether its row varies with the place."""
        return (False,) * len(self.contacts)

    @property
    def natures(self) -> tuple[Any, ...]:
        """What holds of each contact at any place, where numbers decide it."""
        return ()

    def alike(self, other: Any) -> None:
        """Take from the same machine with plain numbers what symbols do not tell."""
        return

    def kinetic(self, v: Array, x: Array | None = None) -> Array:
        """Kinetic energy of all bodies from their velocities (..., bodies), and where that matters their positions [J]."""

    def powers(self, t: Array, x: Array, v: Array, z: Array, column: dict[str, Array]) -> dict[str, Array]:
        """Powers [W] at instants, from positions and velocities (n, bodies), inner states and the columns of forces.

        drive, gravity and actuator (n,); friction (n, contacts); damping (n,) or, of links and stops by `names_of_links`, (n, links);
        potential (n,) where `potential` does not give the energy itself.
        """

    def potential(self, t: Array, x: Array) -> Array | None:
        """Energy of springs at instants, from positions (n, bodies) [J]; None where the integral of their power has to do."""
        return None

    @property
    def knows_place(self) -> bool:
        """Whether the place of the machine as a whole may appear in its forces or loads."""
        return True

    @property
    def names_of_links(self) -> list[str]:
        """The links and elastic stops by the bodies that they join, in the order of their columns."""
        return []

    def difference(self, i: int) -> bool:
        """Whether the slip of a contact is a difference of varying velocities, so that a small slip suffers from cancellation."""
        return False

    def slips(self, t: Numeric, u: Numbers, q: Numbers = ()) -> tuple[Any, ...]:
        """Slip velocity of each contact [m/s]; coordinates q matter where `rows` vary with the place."""
        return tuple(_dot(g, u) + b for g, b in zip(self.directions, self.offsets(t), strict=True))


class OneBody(Mechanics):
    """A robot, a mechanism, or any object with friction, load, acceleration and contact velocity.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = OneBody(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4))
    >>> robot.bodies, robot.contacts, robot.slips(0.0, (0.1,)), robot.directions
    (('body',), ('contact',), (0.1,), ((1.0,),))
    """

    bodies, contacts, directions, coordinates = ("body",), ("contact",), ((1.0,),), 1
    single = True

    def __init__(self, model: OneContact):
        self.model = model

    @cached_property
    def laws(self) -> tuple[LawAdapter, ...]:
        """The law of its contact."""
        return (law_of(self.model),)

    @property
    def masses(self) -> tuple[Any, ...]:
        """Total mass that moves with the contact [kg]."""
        return (self.model.total_mass,)

    @property
    def velocity_scale(self) -> Any:
        """A typical velocity of the model [m/s]."""
        return self.model.velocity_scale

    @property
    def jumps(self) -> tuple[tuple[Any, tuple[Any, ...]], ...]:
        """The model's impulses."""
        return tuple((instant, (jump,)) for instant, jump in getattr(self.model, "impulses", None) or ())

    def accelerations(self, t: Numeric, q: Numbers, u: Numbers, R: Numbers, z: Numbers | None = None) -> tuple[Any, ...]:
        """The accelerations of the model."""
        return (self.model.acceleration(t, q[0], u[0], R[0]),)

    def offsets(self, t: Numeric) -> tuple[Any, ...]:
        """Velocity at the contact of a body at rest."""
        return (self.model.contact_velocity(0.0),)

    def slips(self, t: Numeric, u: Numbers, q: Numbers = ()) -> tuple[Any, ...]:
        """Velocity at the contact."""
        return (self.model.contact_velocity(u[0]),)

    def loads(self, t: Numeric, q: Numbers, u: Numbers | None = None, z: Numbers | None = None) -> tuple[Any, ...]:
        """Normal force [N]."""
        return (normal_load(self.model, t, q[0]),)

    def kinetic(self, v: Array, x: Array | None = None) -> Array:
        """That of all that moves with the contact."""
        return 0.5 * self.model.total_mass * v[..., 0] ** 2

    def powers(self, t: Array, x: Array, v: Array, z: Array, column: dict[str, Array]) -> dict[str, Array]:
        """Those of the drive, or those that a mechanism declares; else all forces but friction supply power."""
        model: Any = self.model
        x, v, R, none = x[:, 0], v[:, 0], column["friction_force"][:, 0], np.zeros_like(t)
        friction = (R * model.contact_velocity(v))[:, None]
        if "drive_force" in column:
            weight = model.total_mass * model.acceleration(t, x, rest_velocity(model) + 0.0 * t, 0.0) - column["drive_force"]
            works = {"drive": column["drive_force"] * v, "gravity": weight * v, "damping": none, "actuator": column["actuator_power"]}
        elif hasattr(model, "drive_power"):
            supplied, lost = model.drive_power(t, x, v, R), model.damping_power(t, x, v)
            works = {"drive": supplied + none, "gravity": none, "damping": lost + none, "actuator": none}
        else:
            supplied = model.total_mass * model.acceleration(t, x, v, 0.0) * v
            works = {"drive": supplied + none, "gravity": none, "damping": none, "actuator": none}
        return {**works, "friction": friction}

    @cached_property
    def knows_place(self) -> bool:
        """Whether its position appears in its equations."""
        return knows_position(self.model)

    def potential(self, t: Array, x: Array) -> Array:
        """That of the spring of a mechanism."""
        return (self.model.potential(t, x[:, 0]) if hasattr(self.model, "potential") else 0.0) + np.zeros_like(t)


def rest_velocity(model: OneContact) -> Any:
    """Velocity of the body at which the contact does not slip [m/s]: 0, or the speed of the belt."""
    return 0.0 - model.contact_velocity(0.0)


def lists_parts(model: Any) -> bool:
    """Whether a model lists bodies and contacts itself, as a `stickslip.Machine` does."""
    return callable(getattr(model, "bodies", None)) and callable(getattr(model, "contacts", None))


def declares_parts(model: Any) -> bool:
    """Whether a model is a machine of bodies and contacts: it lists them, or its drive defines them."""
    return lists_parts(model) or _by_drive(model) is not None


def parts_of(model: Model) -> Any:
    """The object that lists a model's bodies and contacts: the machine into which its drive turns it, else the model itself.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.Robot(0.2, 0.07, ss.machines.Forced.example(), ss.Coulomb(mu_plus=0.2, mu_minus=0.3))
    >>> list(parts_of(robot).bodies()), parts_of(ss.Chain.example()) == ss.Chain.example()
    (['body', 'inner'], True)
    """
    make = _by_drive(model)
    return model if make is None else make(model)


def _by_drive(model: Model) -> Any:
    """The function by which a drive turns a model with a freely moving inner mass into a machine of several bodies, or None."""
    make = getattr(getattr(model, "drive", None), "machine", None)
    return make if callable(make) else None


def _dot(g: Numbers, u: Numbers) -> Any:
    """Scalar product."""
    total: Any = 0.0
    for factor, value in zip(g, u, strict=True):
        total = signed_less(total, -factor, value)
    return total


def signed_less(total: Any, factor: Any, value: Numeric) -> Any:
    """A sum minus a factor times a value; those of 1, -1 and 0 cost no product."""
    if not isinstance(factor, float):
        return total - factor * value
    return total if factor == 0.0 else total - value if factor == 1.0 else total + value if factor == -1.0 else total - factor * value


def brakes_one(row: Sequence[float]) -> bool:
    """Whether a contact's slip is the velocity of one coordinate, which its friction brakes with its whole force.

    Examples
    --------
    >>> brakes_one((0.0, 1.0)), brakes_one((1.0, -1.0)), brakes_one((0.3, 0.7)), brakes_one((0.5, 0.0))
    (True, False, False, False)
    """
    return sum(map(bool, row)) == 1 and 1.0 in row
