r"""The equations of motion of a machine in coordinates of its own: where bodies are, or its matrix of inertia or kinetic energy.

.. math:: M(q)\,\ddot q = h(t, q, \dot q) - \sum_i g_i R_i

Of places the matrix is :math:`M = \sum J^T m J` with their derivatives J, and the accelerations that places have while the coordinates'
rates stay as they are go to the other side. Of a kinetic energy T it is its second derivative, and Lagrange's equations say the rest.
All of it takes floats, arrays of cases or symbols: derivatives are carried through plain Python (`stickslip.basics.time_rates`).
"""

from __future__ import annotations

from functools import cached_property
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np

from stickslip.basics.contracts import Array, Numeric
from stickslip.basics.maths import maximum, pi
from stickslip.basics.time_rates import TimeJet, time_jet
from stickslip.models.controllers import Controllers
from stickslip.models.friction.law_adapter import LawAdapter, adapted
from stickslip.models.kept_heights import Struck, above, given_back, lever_of, normal_force, rising_freely, struck_at, with_force
from stickslip.models.linear_equations import product, solved, total
from stickslip.models.mechanics import SOME, Mechanics, Numbers
from stickslip.models.placed_contacts import PlacedContact
from stickslip.models.placed_links import PlacedLink, links_of, shares
from stickslip.models.rails import decides, pressed_while_sliding, reaction, yielding
from stickslip.models.said_of_motion import Energies, inertia_of_machine, kinetic_of_machine, places_of_machine
from stickslip.models.whole_turns import is_angle

GRAVITY = 9.81  # of a machine that does not say its own [m/s^2]
_LOOKS = 8  # instants of a period at which applied forces are looked at for their size
_LEAST = 1e-3  # of the velocity that a force as large as the load, or gravity, gives
Parts = tuple[Any, ...]


class AnyCoordinates(Mechanics):
    """A machine that names its coordinates. They are what runs have an axis for; bodies are where `places` says.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> import stickslip as ss
    >>> from stickslip.maths import cos, sin
    >>> @dataclass(frozen=True, eq=False)
    ... class Pendulum(ss.Machine):
    ...     mass: float
    ...     length: float
    ...     coordinates = ("angle",)
    ...
    ...     def bodies(self):
    ...         return {"bob": ss.Body(self.mass)}
    ...
    ...     def places(self, t, q):
    ...         return {"bob": (self.length * sin(q["angle"]), -self.length * cos(q["angle"]))}
    >>> m = AnyCoordinates(Pendulum(2.0, 0.5))
    >>> m.matrix(0.0, (0.3,)), round(m.accelerations(0.0, (0.3,), (1.0,), ())[0] / (-9.81 / 0.5 * sin(0.3)), 12)
    (((0.5,),), 1.0)
    """

    joined = True

    def __init__(self, model: Any):
        self.model, self.placed = model, dict(model.bodies())
        self.bodies = tuple(model.coordinates)
        self.controllers = Controllers(model.controllers())
        self.joints = dict(model.contacts())
        self.contacts = tuple(self.joints)
        declared = list(links_of(model))
        self.pulls = [(ends, pull) for ends, _, pull in declared if self._joins_coordinates(ends)]
        self.elastic = [(ends, part) for ends, part, _ in declared if self._joins_coordinates(ends)]
        self.placed_links = [PlacedLink(ends, pull) for ends, _, pull in declared if not self._joins_coordinates(ends)]
        self._instants = [s for _, part, _ in declared for s in (*(getattr(part, "breaks", None) or ()), *getattr(part, "instants", ()))]

    def _joins_coordinates(self, ends: Any) -> bool:
        """Whether a link ends at coordinates, and not at bodies."""
        return ends[0] in self.bodies and (ends[1] is None or ends[1] in self.bodies)

    # ---- what there is ----
    @cached_property
    def angles(self) -> tuple[str, ...]:
        """Those that the machine names in `angles`, or else those that a whole turn leaves alone."""
        said = self.model.angles
        return tuple(said) if said is not None else tuple(name for name in self.bodies if is_angle(self.model, self.bodies, name))

    @property
    def coordinates(self) -> int:
        """As many as are named."""
        return len(self.bodies)

    @cached_property
    def laws(self) -> tuple[LawAdapter, ...]:
        """The law of each contact."""
        return tuple(adapted(each.friction, each.restitution if each.hold == "push" else None) for each in self.joints.values())

    @cached_property
    def masses(self) -> Parts:
        """The diagonal of the matrix of inertia where a run begins by default."""
        return tuple(row[i] for i, row in enumerate(self.matrix(0.0, self.start)))

    @cached_property
    def parts(self) -> dict[str, _Inertia]:
        """By coordinate what resists it alone."""
        return {name: _Inertia(mass) for name, mass in zip(self.bodies, self.masses, strict=True)}

    @property
    def start(self) -> Parts:
        """All coordinates are zero."""
        return (0.0,) * len(self.bodies)

    @property
    def shares(self) -> Parts:
        """The way that the machine makes is that of its principal coordinate, or of the first one."""
        principal = self.bodies.index(self.model.principal) if self.model.principal is not None else 0
        return tuple(float(c == principal) for c in range(len(self.bodies)))

    @property
    def breaks(self) -> Parts:
        """Those of the machine and of what contacts rub on [s]."""
        motions = [s for contact in self.joints.values() for s in getattr(contact.on, "breaks", None) or ()]
        return (*motions, *self._instants, *(getattr(self.model, "breaks", None) or ()))

    @property
    def time_scale(self) -> Any:
        """The period, or what the machine says; None where nobody knows."""
        return self.period if self.period is not None else getattr(self.model, "time_scale", None)

    @cached_property
    def velocity_scale(self) -> Any:
        """A typical rate of the coordinates: what the machine says, else what forces, gravity and motions do in a part of the period."""
        own = getattr(self.model, "velocity_scale", None)
        if own is not None:
            return own
        time = 1.0 if self.time_scale is None else self.time_scale
        still, largest = (0.0,) * len(self.bodies), _LEAST * abs(self.gravity) * time
        for load, felt in zip(self.loads(0.0, self.start), self._lightness(), strict=True):
            largest = maximum(largest, _LEAST * abs(load) * felt * time)
        for k in range(_LOOKS if self.period is not None else 1):
            t = time * (k / _LOOKS)
            for a in self.accelerations(t, self.start, still, (0.0,) * len(self.contacts)):
                largest = maximum(largest, abs(a) * time / (2 * pi))
            for b in self.offsets(t):
                largest = maximum(largest, abs(b))
        return largest

    def _lightness(self) -> list[Any]:
        """How much a unit force at each contact changes its slip rate, where a run begins by default."""
        pushed = (self.pushed(0.0, self.start, row) for row in self.rows(0.0, self.start))
        return [total(map(product, row, by)) for row, by in zip(self.rows(0.0, self.start), pushed, strict=True)]

    @property
    def gravity(self) -> Any:
        """Acceleration of gravity, downwards [m/s^2]."""
        return getattr(self.model, "gravity", GRAVITY)

    # ---- contacts ----
    @cached_property
    def touching(self) -> tuple[PlacedContact, ...]:
        """What each contact's slip takes of the rates of the coordinates, and where it presses."""
        return tuple(PlacedContact(self, contact) for contact in self.joints.values())

    def heights(self, t: Numeric, q: Numbers, u: Numbers) -> dict[str, tuple[Any, Any]]:
        """By contact that keeps the height of its point, which coordinates could change, this height [m] and its rate [m/s]."""
        moved = self.moved(t, q, u) if self.keeping else {}
        points = {name: c.point(moved)[1] for name, c in zip(self.contacts, self.touching, strict=True) if c.keeps_height}
        return {name: (point.value, point.rate) for name, point in points.items()}

    def rising(self, i: int, t: Numeric, q: Numbers, u: Numbers, z: Numbers | None = None) -> Any:
        """Second derivative of the height of a contact's point while that flies [m/s^2]."""
        return rising_freely(self, i, t, q, u, z)

    def struck(self, i: int, q: Numbers) -> Struck:
        """What impulses at the point of a contact do."""
        return struck_at(self, i, q)

    @cached_property
    def flying(self) -> tuple[int, ...]:
        """Numbers of the contacts that may take off and land."""
        return tuple(i for i, law in enumerate(self.laws) if law.flies)

    @cached_property
    def together(self) -> bool:
        """Whether a load follows from the motion, and there are other contacts."""
        return len(self.contacts) > 1 and any(contact.is_held for contact in self.touching)

    def completed(self, q: Numbers, u: Numbers, z: Numbers) -> list[Any]:
        """Inner states, with the gaps of points that may fly and their rates as the coordinates have them."""
        whole, ends = list(z), list(accumulate(self.inner, initial=0))
        heights = self.heights(0.0, q, u) if self.flying else {}
        for i in self.flying:
            whole[ends[i] : ends[i + 1]] = above(self, heights[self.contacts[i]])
        return whole

    @property
    def varying(self) -> tuple[bool, ...]:
        """Of each contact, whether its row varies with the place."""
        return tuple(contact.nature.varies for contact in self.touching)

    @property
    def natures(self) -> tuple[Any, ...]:
        """What holds of each contact at any place."""
        return tuple(contact.nature for contact in self.touching)

    def alike(self, other: Any) -> None:
        """Take from the same machine with plain numbers what holds of its contacts at any place."""
        for own, known in zip(self.touching, other.touching, strict=True):
            own.nature = known.nature

    @cached_property
    def directions(self) -> tuple[tuple[float, ...], ...]:
        """The rows of the contacts."""
        return tuple(
            tuple(
                float(g) if isinstance(g, (int, float)) and not (c.nature.varies and j in c.nature.moves) else SOME
                for j, g in enumerate(c.row)
            )
            for c in self.touching
        )

    def rows(self, t: Numeric, q: Numbers) -> tuple[Parts, ...]:
        """The same with the numbers that places or contacts say."""
        return tuple(contact.row_at(q) if contact.nature.varies else contact.row for contact in self.touching)

    def offsets(self, t: Numeric) -> Parts:
        """Slip velocity of each contact while no coordinate moves [m/s]."""
        return tuple(contact.offset(t) for contact in self.touching)

    def offset_rates(self, t: Numeric) -> Parts:
        """Rates of the contacts' offsets [m/s^2]."""
        return tuple(contact.offset_rate(t) for contact in self.touching)

    def slips(self, t: Numeric, u: Numbers, q: Numbers = ()) -> Parts:
        """Slip velocity of each contact [m/s]."""
        return tuple(total(map(product, row, u)) + b for row, b in zip(self.rows(t, q), self.offsets(t), strict=True))

    def slip_biases(self, t: Numeric, q: Numbers, u: Numbers) -> Parts:
        """Rate of each slip while the coordinates' rates and the offsets stay as they are [m/s^2]."""
        if not any(self.varying):
            return (0.0,) * len(self.touching)
        moved = self.moved(t, q, u)
        return tuple(contact.bias(q, moved) for contact in self.touching)

    def loads(self, t: Numeric, q: Numbers, u: Numbers | None = None, z: Numbers | None = None) -> Parts:
        """Normal force on each contact [N]."""
        return tuple(self.load(i, t, q, u, z) for i in range(len(self.contacts)))

    def load(self, i: int, t: Numeric, q: Numbers, u: Numbers | None = None, z: Numbers | None = None) -> Any:
        """Normal force on one contact [N]; of a rail that holds a body on both sides the one that its motion asks for while it slips."""
        contact = self.joints[self.contacts[i]]
        if self.touching[i].is_held:
            return pressed_while_sliding(self, i, t, q, (0.0,) * len(self.bodies) if u is None else u, z)
        return contact.load(t, dict(zip(self.bodies, q, strict=True))) if callable(contact.load) else contact.load

    @cached_property
    def of_motion(self) -> tuple[bool, ...]:  # type: ignore[override]
        """Of each contact, whether its load follows from the motion."""
        held = tuple(contact.is_held for contact in self.touching)
        return held if any(held) else ()

    def decides(self, i: int, t: Numeric, q: Numbers, per_load: Any) -> Any:
        """Positive as long as one load of a contact follows from the motion, under friction of `per_load` for each newton of it."""
        return decides(self, i, t, q, per_load) if self.touching[i].is_held else None

    def free_reaction(self, i: int, t: Numeric, q: Numbers, u: Numbers, z: Numbers | None = None) -> Any:
        """The force of a rail along its normal without friction [N]."""
        return reaction(self, i, t, q, u, (0.0,) * len(self.contacts), z)

    def yields(self, i: int, t: Numeric, q: Numbers) -> Any:
        """How much of the force of a rail, or of ground, its friction of one newton takes."""
        return yielding(self, i, t, q)

    def difference(self, i: int) -> bool:
        """Whether several coordinates decide a slip."""
        return sum(map(bool, self.directions[i])) > 1 or callable(getattr(self.joints[self.contacts[i]].on, "velocity", None))

    # ---- places ----
    def along(self, t: Any, q: Numbers) -> dict[str, tuple[TimeJet, ...]]:
        """Places of the bodies at an instant and coordinates that move: a number, (x, z) or (x, z, angle) of each, with two rates."""
        given = places_of_machine(self.model, t, dict(zip(self.bodies, q, strict=True)))
        return {name: tuple(map(time_jet, given[name] if isinstance(given[name], tuple) else (given[name],))) for name in self.placed}

    @cached_property
    def by_energy(self) -> bool:
        """Whether the machine says a matrix of inertia or a kinetic energy, and not where bodies are."""
        q = dict(zip(self.bodies, self.start, strict=True))
        return inertia_of_machine(self.model, dict(q)) is not None or kinetic_of_machine(self.model, q, dict(q)) is not None

    @cached_property
    def has_places(self) -> bool:
        """Whether the machine says where bodies are."""
        return places_of_machine(self.model, 0.0, dict(zip(self.bodies, self.start, strict=True))) is not None

    def slopes(self, t: Numeric, q: Numbers) -> list[dict[str, Parts]]:
        """For each coordinate, by body the derivatives of its place."""
        n, slopes = len(q), []
        for j in range(n):
            moved = self.along(t, [TimeJet(x, 1.0 if k == j else 0.0) for k, x in enumerate(q)])
            slopes.append({name: tuple(part.rate for part in components) for name, components in moved.items()})
        return slopes

    def moved(self, t: Numeric, q: Numbers, u: Numbers) -> dict[str, tuple[TimeJet, ...]]:
        """Places with their velocities, and their accelerations while the coordinates' rates stay as they are."""
        return self.along(t, [TimeJet(x, v) for x, v in zip(q, u, strict=True)])

    def inertias(self, name: str) -> Parts:
        """What resists acceleration in each part of a body's place: its mass, twice, and its moment of inertia."""
        body = self.placed[name]
        return (body.mass, body.mass, body.inertia)

    # ---- motion ----
    def matrix(self, t: Numeric, q: Numbers) -> tuple[Parts, ...]:
        """The matrix of inertia."""
        if self.by_energy:
            return self._energies.matrix(q)
        slopes, n = self.slopes(t, q), len(self.bodies)

        def entry(i: int, j: int) -> Any:
            return total(
                product(m, product(a, b))
                for name in self.placed
                for m, a, b in zip(self.inertias(name), slopes[i][name], slopes[j][name], strict=False)
            )

        upper = {(i, j): entry(i, j) for i in range(n) for j in range(i, n)}
        return tuple(tuple(upper[min(i, j), max(i, j)] for j in range(n)) for i in range(n))

    @cached_property
    def _energies(self) -> Energies:
        return Energies(self.model, self.bodies)

    @cached_property
    def keeping(self) -> tuple[PlacedContact, ...]:
        """The contact that keeps its height, if there is one."""
        return tuple(contact for contact in self.touching if contact.keeps_height)

    def loosely_pushed(self, t: Numeric, q: Numbers, force: Numbers) -> Parts:
        """Accelerations that generalized forces make if no contact keeps its height: the solution of M a = force."""
        return solved(self.matrix(t, q), force)

    def pushed(self, t: Numeric, q: Numbers, force: Numbers) -> Parts:
        """The same with the normal forces that they ask for."""
        a = self.loosely_pushed(t, q, force)
        for contact in self.keeping:
            lever = lever_of(self, contact, q)
            a = with_force(lever, a, given_back(lever, a))
        return a

    def applied(self, t: Numeric, q: Numbers, u: Numbers, z: Numbers | None = None) -> list[Any]:
        """Generalized forces but friction, with what velocities do."""
        x, v = self._named(t, q, u)
        forces: dict[str, Any] = dict.fromkeys(self.bodies, 0.0)
        controlled = self.controllers.forces(t, x, v, self.controllers.start(t, x, v) if z is None else z)
        for name, force in (*dict(self.model.forces(t, dict(x), dict(v))).items(), *controlled):
            forces[name] = forces[name] + force
        for (first, second), tension in self.pulls:
            other = (0.0, 0.0) if second is None else (x[second], v[second])
            pull = tension(t, x[first] - other[0], v[first] - other[1])
            forces[first] = forces[first] - pull
            if second is not None:
                forces[second] = forces[second] + pull
        h = [forces[name] for name in self.bodies]
        if self.by_energy:
            return [a - b for a, b in zip(h, self._energies.gyroscopic(q, u), strict=True)]
        slopes, moved = self.slopes(t, q), self.moved(t, q, u)
        pulled = shares(self.placed_links, t, moved)
        for name in self.placed:
            net = self.net(name, t, moved[name], pulled)
            for j in range(len(h)):
                h[j] = total([h[j], *map(product, slopes[j][name], net)])
        return h

    def net(self, name: str, t: Numeric, components: tuple[TimeJet, ...], pulled: dict[str, Parts]) -> Parts:
        """Applied forces on a body, less mass times the accelerations that it has while the coordinates' rates stay as they are."""
        forces = self.forces_on(name, t, components, pulled)
        resisting = (product(m, part.second) for m, part in zip(self.inertias(name), components, strict=False))
        return tuple(total([force, product(-1.0, inertia)]) for force, inertia in zip(forces, resisting, strict=True))

    def forces_on(self, name: str, t: Numeric, components: tuple[TimeJet, ...], pulled: dict[str, Parts]) -> Parts:
        """Force of the body itself, its weight, and what links do to it, in each part of its place [N] or [N m]."""
        body = self.placed[name]
        x, v = (tuple(getattr(part, what) for part in components) for what in ("value", "rate"))
        given = body.applied(t, x[0] if len(x) == 1 else x, v[0] if len(v) == 1 else v)
        own = given if isinstance(given, tuple) else (given,)
        weight = (0.0,) * len(components) if len(components) == 1 else (0.0, product(-1.0, product(body.mass, self.gravity)), 0.0)
        links = pulled.get(name, (0.0,) * 3)
        return tuple(map(total, zip((*own, *(0.0 for _ in range(len(components) - len(own)))), weight, links, strict=False)))

    def loose_accelerations(self, t: Numeric, q: Numbers, u: Numbers, R: Numbers, z: Numbers | None = None) -> Parts:
        """Second derivatives of the coordinates under the friction forces, if no contact keeps its height."""
        h = self.applied(t, q, u, z)
        for row, force in zip(self.rows(t, q), R, strict=True):
            h = [total([of, product(-1.0, product(g, force))]) for of, g in zip(h, row, strict=True)]
        return self.loosely_pushed(t, q, h)

    def accelerations(self, t: Numeric, q: Numbers, u: Numbers, R: Numbers, z: Numbers | None = None) -> Parts:
        """The same with the normal forces."""
        a = self.loose_accelerations(t, q, u, R, z)
        for contact in self.keeping:
            lever = lever_of(self, contact, q)
            a = with_force(lever, a, normal_force(self, contact, lever, t, q, u, a))
        return a

    # ---- energy ----
    def kinetic(self, v: Array, x: Array | None = None) -> Array:
        """Kinetic energy at positions and rates of the coordinates (..., coordinates) [J]."""
        q, u = tuple(np.moveaxis(np.asarray(x), -1, 0)), tuple(np.moveaxis(np.asarray(v), -1, 0))
        M = self.matrix(0.0, q)
        terms = (product(M[i][j], u[i] * u[j]) for i in range(len(u)) for j in range(len(u)))
        return np.asarray(0.5 * total(terms) + 0.0 * u[0])

    def powers(self, t: Array, x: Array, v: Array, z: Array, column: dict[str, Array]) -> dict[str, Array]:
        """Drive: of all applied forces but weights, which are gravity's; friction R w of each contact. Springs are among the drive."""
        q, u, none = tuple(x.T), tuple(v.T), np.zeros_like(t)
        R, gravity = column["friction_force"], none
        if not self.by_energy:
            for name, components in self.moved(t, q, u).items():
                if len(components) > 1:
                    gravity = gravity - self.placed[name].mass * self.gravity * components[1].rate
        gained = total(map(product, self._all_forces(t, q, u, z), u)) + none
        ground = -(R * (np.array([np.broadcast_to(b, t.shape) for b in self.offsets(t)]).reshape(-1, len(t)).T)).sum(axis=1)
        works = {"drive": gained - gravity - ground, "gravity": gravity + none, "friction": R * column["slip"]}
        return {**works, "potential": none, "damping": none, "actuator": none}

    def _all_forces(self, t: Array, q: Numbers, u: Numbers, z: Array) -> Parts:
        """Generalized forces whose power is what the kinetic energy gains, without friction."""
        from stickslip.models.contact_forces import held_by_controllers

        held = held_by_controllers(self, z)
        rates = self.applied(t, q, u, held)
        if self.by_energy:
            return tuple(total([a, b]) for a, b in zip(rates, self._energies.gyroscopic(q, u), strict=True))
        slopes, moved = self.slopes(t, q), self.moved(t, q, u)
        for name, components in moved.items():
            inertia = [product(m, part.second) for m, part in zip(self.inertias(name), components, strict=False)]
            rates = [total([h, *map(product, slopes[j][name], inertia)]) for j, h in enumerate(rates)]
        return tuple(rates)


class _Inertia(NamedTuple):
    """What resists a coordinate, as a body of a machine on a line has it."""

    mass: Any
    position: Any = 0.0
