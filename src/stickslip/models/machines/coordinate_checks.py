"""Consistency checks of a machine that names coordinates of its own; all errors are reported together."""

from __future__ import annotations

import random
from collections.abc import Mapping
from typing import Any

import numpy as np

from stickslip.basics.errors import Problems, did_you_mean
from stickslip.basics.fields import checked_number, everywhere
from stickslip.basics.time_rates import TimeJet
from stickslip.models.any_coordinates import AnyCoordinates
from stickslip.models.forces import check_law
from stickslip.models.friction.law_adapter import is_affine
from stickslip.models.machines.link_checks import check_links, check_placed_links
from stickslip.models.machines.parts import Body, Contact
from stickslip.models.placed_contacts import PlacedContact
from stickslip.models.rails import loose
from stickslip.models.said_of_motion import inertia_of_machine, kinetic_of_machine, places_of_machine

_FLAT = 1e-12  # of the product of a matrix's diagonal: a determinant that is zero
_LOOKS = 3
_FLAT_ROWS = 1e-9  # of their largest part: rows of which one follows from the others
_FEET = 3  # points that push on the ground at once
_MOST = 64  # combinations of slips, rests and flights that are decided together
_PLACES = 'def places(self, t, q): return {"cart": (q["x"], 0.0)}'


def check_coordinates(machine: Any, problems: Problems) -> None:
    """Note what is wrong with coordinates, places, contacts and links, and a matrix of inertia that has no inverse."""
    names = machine.coordinates
    if not isinstance(names, tuple) or not names or not all(isinstance(name, str) for name in names) or len(set(names)) < len(names):
        problems.add(f'coordinates = {names!r}; allowed is a tuple of different names; type coordinates = ("x", "angle")')
        return
    if machine.controllers():
        problems.add(
            "controllers() of a machine with coordinates of its own are not there yet; allowed are bodies on a line; leave them out"
        )
    for name, body in machine.bodies().items():
        if not isinstance(body, Body):
            problems.add(f"bodies()[{name!r}] = {body!r}; allowed is a Body; type {name!r}: ss.Body(mass=0.07)")
    check_links(machine, problems)
    if machine.principal is not None and machine.principal not in names:
        problems.add(f"principal = {machine.principal!r}; allowed is None or a coordinate; {did_you_mean(str(machine.principal), names)}")
    angles = machine.angles
    if angles is not None and not (isinstance(angles, tuple) and all(name in names for name in angles)):
        problems.add(f'angles = {angles!r}; allowed is None or a tuple of coordinates: {", ".join(names)}; type angles = ("{names[-1]}",)')
    if not problems.mistakes:
        _check_sources(machine, names, problems)
    for name, contact in machine.contacts().items():
        _check_contact(name, contact, machine, problems)
    if not problems.mistakes:
        _check_numbers(AnyCoordinates(machine), problems)


def _check_sources(machine: Any, names: tuple[str, ...], problems: Problems) -> None:
    """Note that not one of places, a matrix of inertia and a kinetic energy is given, or places that lack a body."""
    q = dict.fromkeys(names, 0.0)
    try:
        given = {
            "places": places_of_machine(machine, 0.0, dict(q)),
            "inertia": inertia_of_machine(machine, dict(q)),
            "kinetic": kinetic_of_machine(machine, dict(q), dict(q)),
        }
        forces = machine.forces(0.0, dict(q), dict(q))
    except KeyError as error:
        problems.add(f"{error} is not a coordinate; {did_you_mean(str(error.args[0]), names)}")
        return
    said = [what for what, value in given.items() if value is not None]
    if len(said) != 1:
        words = f"{' and '.join(said)} are given" if said else "neither places nor inertia nor kinetic is given"
        problems.add(f"{words}; allowed is one of them, which says what moves; type {_PLACES}")
        return
    for name in forces:
        if name not in names:
            problems.add(f"forces() has {name!r}, which is not a coordinate; {did_you_mean(str(name), names)}")
    bodies = machine.bodies()
    if said == ["places"]:
        places = given["places"]
        for name in {**bodies, **places}:
            if name not in bodies or name not in places:
                where = "places() has" if name in places else "bodies() has"
                other = "bodies" if name in places else "places"
                problems.add(f"{where} {name!r}, and {other}() has not; allowed are the same names in both")
        for name, components in places.items():
            if isinstance(components, tuple) and len(components) not in (1, 2, 3):
                problems.add(f"places()[{name!r}] has {len(components)} parts; allowed is a number, (x, z) or (x, z, angle)")
    elif said == ["inertia"]:
        n, rows = len(names), given["inertia"]
        if not _is_square(rows, n):
            problems.add(f"inertia(q) gives {rows!r}; allowed is a tuple of {n} rows of {n} numbers, in the order of {', '.join(names)}")


def _is_square(rows: Any, n: int) -> bool:
    given = isinstance(rows, (tuple, list)) and len(rows) == n
    return given and all(isinstance(row, (tuple, list)) and len(row) == n for row in rows)


def _check_contact(name: Any, contact: Any, machine: Any, problems: Problems) -> None:
    where, names = f"contacts()[{name!r}]", machine.coordinates
    if not isinstance(contact, Contact):
        problems.add(f"{where} = {contact!r}; allowed is a Contact; type {name!r}: ss.Contact({names[0]!r}, friction, load=1.0)")
        return
    bodies = machine.bodies() if not problems.mistakes and places_of_machine(machine, 0.0, dict.fromkeys(names, 0.0)) is not None else {}
    if isinstance(contact.body, Mapping):
        for each, g in contact.body.items():
            if each not in names:
                problems.add(f"{where}.body has a coefficient of {each!r}, which is not a coordinate; {did_you_mean(str(each), names)}")
            checked_number(f"{where}.body[{each!r}]", g, problems, None, "a coefficient", f"{{{each!r}: 0.5}}")
    elif contact.body not in bodies and contact.body not in names:
        problems.add(f"{where}.body = {contact.body!r}; {did_you_mean(str(contact.body), (*bodies, *names))}")
        return
    of_body = isinstance(contact.body, str) and contact.body in bodies
    if isinstance(contact.on, str) and not (of_body and contact.on in bodies and contact.on != contact.body):
        problems.add(f"{where}.on = {contact.on!r}; allowed is another body, for a contact of a body; {did_you_mean(contact.on, bodies)}")
    if contact.at is not None:
        _check_point(where, contact.at, of_body, problems)
    if contact.hold not in (None, "both", "push"):
        problems.add(f'{where}.hold = {contact.hold!r}; allowed are "both", a rail, and "push", the ground; type hold="both"')
    elif contact.hold == "push" and contact.load is not None:
        problems.add(
            f"{where}.load = {contact.load!r}; allowed is none, for on ground that pushes it follows from the motion; leave load out"
        )
    if contact.load is None:
        rail = '; or hold="both", a rail that holds it on both sides, or hold="push", ground that it may leave' if of_body else ""
        if contact.hold is None or not of_body:
            problems.add(f"{where}.load is not given; allowed is a force [N], or a function of time and coordinates; type load=1.0{rail}")
    elif not callable(contact.load):
        checked_number(f"{where}.load", contact.load, problems, None, "a force [N], or a function of time and coordinates", "load=1.0")
    if contact.restitution is not None and contact.hold != "push":
        problems.add(f'{where}.restitution = {contact.restitution!r}; allowed is one of ground that may be left; type hold="push" with it')
    elif contact.restitution is not None:
        checked_number(
            f"{where}.restitution", contact.restitution, problems, lambda e: (e >= 0) & (e < 1), "from 0 to below 1", "restitution=0.3"
        )
    own = Problems(problems.what)
    check_law(contact.friction, own)
    for sentence in own.mistakes:
        problems.add(f"{where}.{sentence}" if sentence.startswith("friction") else f"{where}: {sentence}")


def _check_point(where: str, at: Any, of_body: bool, problems: Problems) -> None:
    """Note what is no point of a body."""
    allowed, typed = "(a, b), a point of a body in the body's own axes, from its place [m]", "at=(0.1, 0.0)"
    if not of_body or not isinstance(at, tuple) or len(at) != 2:
        problems.add(f"{where}.at = {at!r}; allowed is {allowed}; type {typed}" + ("" if of_body else ", with a body's name"))
        return
    for k, part in enumerate(at):
        checked_number(f"{where}.at[{k}]", part, problems, None, "a finite number [m]", typed)


def _check_numbers(m: AnyCoordinates, problems: Problems) -> None:
    """Note what shows at numbers only: a singular matrix, rows that vary with the place, and places that time moves."""
    draw = random.Random(20261129)
    states = [tuple(draw.uniform(-0.9, 0.9) for _ in m.bodies) for _ in range(_LOOKS)]
    if m.has_places:
        moved = (part for q in states for components in m.along(TimeJet(0.3, 1.0), q).values() for part in components)
        if any(not everywhere(part.rate == 0.0) for part in moved):
            problems.add(
                "places() vary with time, and prescribed motions of bodies are not there yet; allowed are functions of coordinates alone; "
                "type a force that moves the body, in forces(t, q, u)"
            )
            return
    check_placed_links(m, problems)
    for name in _lost(m, states):
        problems.add(
            f"nothing moves with the coordinate {name!r} alone: the matrix of inertia has no inverse; allowed are coordinates that each "
            "move a body with mass, and of which none follows from the others; let places() depend on it, give what it turns an inertia=, "
            "or leave it out"
        )
    for name, contact in zip(m.contacts, m.touching, strict=True) if not problems.mistakes else ():
        _check_row(name, contact, problems)
    for i, contact in enumerate(m.touching if not problems.mistakes else ()):
        if contact.is_held:
            _check_rail(m, i, problems)
    if not problems.mistakes and m.together:
        _check_together(m, states, problems)


def _lost(m: AnyCoordinates, states: list[tuple[float, ...]]) -> list[str]:
    """Coordinates along which elimination finds no inertia left, at all of some states."""
    lost = []
    for j, name in enumerate(m.bodies):
        left = []
        for q in states:
            M = m.matrix(0.0, q)
            own, of_others = M[j][j], [[M[a][b] for b in range(j)] for a in range(j)]
            before = own
            if j:
                from stickslip.models.linear_equations import product, solved, total

                row = [M[j][k] for k in range(j)]
                if any(not everywhere(abs(of_others[k][k]) > 0) for k in range(j)):
                    continue
                own = total([own, *(product(-1.0, product(a, b)) for a, b in zip(row, solved(of_others, row), strict=True))])
            left.append(everywhere(own > _FLAT * abs(before)))
        if not any(left):
            lost.append(name)
            break
    return lost


def _check_together(m: AnyCoordinates, states: list[tuple[float, ...]], problems: Problems) -> None:
    """Note contacts of which some follow from the motion, and that cannot be decided together."""
    held, points = [i for i, contact in enumerate(m.touching) if contact.is_held], len(m.flying)
    type_load = "type load=, a force [N] or a function of time and coordinates"
    for i in held:
        if m.touching[i].pushes and i not in m.flying:
            problems.add(
                f"contacts()[{m.contacts[i]!r}].restitution is not given; beside other contacts a point that pushes may take off and land; "
                f"type restitution=0.0, or {type_load}"
            )
    for name, law in zip(m.contacts, m.laws, strict=True):
        if law.dynamic:
            problems.add(
                f"contacts()[{name!r}]: {law.name} has inner states; where the load of another contact follows from the motion, allowed "
                "are laws that rest exactly; type ss.Stribeck(...), or give all loads"
            )
    rails, loads = len(held) - points, len(m.contacts) - len(held)
    count = 4**points * 6**rails * 3**loads
    if points > _FEET or rails > 1 or count > _MOST:
        problems.add(
            f"contacts() has {points} points that push, {rails} rails and {loads} given loads; decided together are {_FEET} points, one "
            f"rail and given loads, in {_MOST} ways (4 of a point, 6 of a rail, 3 of a load): these have {count}; leave one out"
        )
    if not problems.mistakes and points > 1:
        _check_feet(m, states, problems)


def _check_feet(m: AnyCoordinates, states: list[tuple[float, ...]], problems: Problems) -> None:
    """Note points that touch, or rest, together in more ways than coordinates can decide."""
    feet = {m.contacts[i]: m.touching[i] for i in m.flying}
    bodies = [contact.contact.body for contact in feet.values()]
    shared = [name for name, contact in feet.items() if contact.curve is not None and bodies.count(contact.contact.body) > 1]
    names = " and ".join(map(repr, shared or feet))
    if shared:
        problems.add(
            f"contacts() {names} are points of one body on a curve; several points of one are solved for on flat ground; leave on out, or "
            "all but one of them"
        )
        return
    first = [bodies.index(body) == k for k, body in enumerate(bodies)]  # points of one body have one slip
    for q in states:
        rows = [
            of
            for contact, own in zip(feet.values(), first, strict=True)
            for of in (contact.heights_at(q), *([contact.row_at(q)] if own else []))
        ]
        table = np.array([[float(np.ravel(part)[0]) for part in row] for row in rows])
        if np.linalg.matrix_rank(table, tol=_FLAT_ROWS * np.max(abs(table))) < len(rows):
            problems.add(
                f"contacts() {names}: no coordinates decide what each of them bears where all touch or rest (statically indeterminate); "
                "allowed are points that coordinates can move apart, such as two of a body with an angle; leave one of them out"
            )
            return


def _check_rail(m: AnyCoordinates, i: int, problems: Problems) -> None:
    """Note a rail whose load cannot be solved for."""
    where, given, law = f"contacts()[{m.contacts[i]!r}]", m.touching[i].contact, m.laws[i]
    type_load = "type load=, a force [N] or a function of time and coordinates"
    if len(m.along(0.0, m.start)[given.body]) == 1:
        problems.add(f"{where}: {given.body!r} moves along a line, which has no normal; its place has to be (x, z); or {type_load}")
    elif m.touching[i].rubs_on_body and loose(m) != [given.on]:
        others = ", ".join(repr(name) for name in loose(m) if name != given.on)
        problems.add(f"{where}: what bears {others} is not known; {type_load}")
    if given.on is not None and not isinstance(given.on, str) and m.touching[i].curve is None:
        problems.add(f"{where}.on = {given.on!r}; a load that follows from the motion is solved for on rails that do not move; {type_load}")
    if law.dynamic:
        problems.add(f"{where}: {law.name} has inner states, and its friction and its load would follow from one another; {type_load}")
    elif not is_affine(law) or any(not everywhere(abs(law.sliding(side, 0.0)) == 0.0) for side in (1.0, -1.0)):
        problems.add(f"{where}: the friction of {law.name} is not proportional to the load, as that of ss.Coulomb is; {type_load}")


def _check_row(name: str, contact: PlacedContact, problems: Problems) -> None:
    where, given, nature = f"contacts()[{name!r}]", contact.contact, contact.nature
    if not nature.moves:
        against = "it against what it rubs on" if contact.of_body else "it"
        problems.add(
            f'{where}: no coordinate moves {against}, so that nothing decides its slip; type ss.Contact({{"x": 1.0}}, law, load=1.0)'
        )
    elif contact.curve is not None and not contact.keeps_height:
        problems.add(
            f"{where}.on = {given.on!r}; a curve z(x) is the ground of a point that coordinates can lift off it, with hold= and without "
            "load=; where one coordinate moves it, places() says the way; leave on out"
        )
    elif contact.pushes and not contact.keeps_height:
        problems.add(
            f"{where}: no coordinate lifts {given.body!r} off the ground, so that it never leaves it; "
            'type hold="both", or name a coordinate that lifts it'
        )
    elif contact.keeps_height and contact.rubs_on_body:
        own = ", ".join(repr(contact.mechanics.bodies[j]) for j in nature.moves)
        problems.add(
            f"{where} holds {given.body!r} on {given.on!r}, and {own} move it there; allowed there is one coordinate, along which "
            'it slips; type a contact of coordinates, such as ss.Contact({"x": 1.0}, law, load=1.0)'
        )
