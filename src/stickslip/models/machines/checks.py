"""Consistency checks of the parts of a machine; all errors are reported together."""

from __future__ import annotations

import inspect
import itertools
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import InputError, Problems, did_you_mean
from stickslip.basics.fields import checked_number, describe, everywhere
from stickslip.basics.quantities import GRAVITIES, Rule, positive
from stickslip.models.controllers import NEEDS
from stickslip.models.forces import check_law
from stickslip.models.friction.law_adapter import adapted, is_affine
from stickslip.models.instant_forces import LOADS, arguments_of_load
from stickslip.models.machines.parts import Body, Contact, Link, Stop

if TYPE_CHECKING:
    from stickslip.models.mechanics import Mechanics


_CLOSED = 1e-6  # of how far a prescribed distance goes: how well it has to come back after the period
_SAME = 1e-9  # of positions: how near they have to be to the distance that is prescribed at the start
_EXAMPLES = {
    "bodies": '{"head": ss.Body(mass=0.07)}',
    "contacts": '{"head": ss.Contact("head", ss.Coulomb(mu_plus=0.15, mu_minus=0.21))}',
    "links": '{("head", "tail"): ss.Spring(stiffness=1200.0)}',
    "stops": '{("head", None): ss.Stop(gap=0.01, restitution=0.5)}',
    "controllers": '{"hold": Hold(gain=30.0)}',
}


def check_parts(machine: Any, problems: Problems) -> None:
    """Note every part that is none, names nobody knows, and numbers that are not allowed."""
    listed = {what: getattr(machine, what)() for what in _EXAMPLES}
    for what, parts in listed.items():
        if not isinstance(parts, dict):
            hint = "a list gives its parts no names; " if isinstance(parts, (list, tuple)) else ""
            problems.add(f"{what}() gives {parts!r}; {hint}allowed is a dictionary; type return {_EXAMPLES[what]}")
    if problems.mistakes:
        return
    bodies = listed["bodies"]
    if not bodies:
        problems.add(f"bodies() is empty; type return {_EXAMPLES['bodies']}")
    for name, body in bodies.items():
        _check_body(name, body, problems)
    for name, contact in listed["contacts"].items():
        _check_contact(name, contact, bodies, problems)
    for what in ("links", "stops"):
        for ends, each in listed[what].items():
            _check_ends(what, ends, bodies, problems)
            for part in each if isinstance(each, tuple) else (each,):
                _check_joint(what, ends, part, problems)
    if any(isinstance(contact, Contact) and contact.load is None for contact in listed["contacts"].values()):
        _check_gravity(getattr(machine, "gravity", None), problems)
    if machine.principal is not None and machine.principal not in bodies:
        problems.add(
            f"principal = {machine.principal!r}; allowed is None or the name of a body; {did_you_mean(str(machine.principal), bodies)}"
        )
    for name, part in listed["controllers"].items():
        _check_controller(name, part, bodies, problems)
    if not problems.mistakes:
        mechanics = machine.mechanics
        _check_groups(mechanics, problems)
        _check_stops(mechanics, problems)
        _check_controllers(mechanics, problems)
        _check_loads(mechanics, problems)


def _check_gravity(gravity: Any, problems: Problems) -> None:
    """Note a gravity, from which loads follow, beyond sense."""
    if gravity is not None:
        allowed = Rule(lambda g: (g == 0) | GRAVITIES(g), "zero, or an acceleration from 1e-6 to 1e6 m/s^2")
        checked_number("gravity", gravity, problems, allowed, allowed.words, "gravity=9.81")


def periods_differ(name: str, period: Numeric, first: str, other: Any) -> str:
    """The message about two drives of one machine whose periods differ."""
    mistake = f"{name} has the period {describe(period)} s and {first} {describe(other)} s; allowed is one common period"
    return f'{mistake}; a name with a star changes the numbers of all, type .replace({{"*.omega": 205.0}})'


def _check_body(name: Any, body: Any, problems: Problems) -> None:
    if not isinstance(body, Body):
        problems.add(f"bodies()[{name!r}] = {body!r}; allowed is a Body; type {name!r}: ss.Body(mass=0.07)")
        return
    for what in ("force", "gravity"):
        takes, example = ("time", "position", "velocity"), f"{what}=lambda t, x, v: sin(t)"
        _check_force(f"bodies()[{name!r}].{what}", getattr(body, what), takes, problems, None, "a force [N]", example)


def _check_force(where: str, value: Numeric, takes: tuple[str, ...], problems: Problems, rule: Any, allowed: str, example: str) -> None:
    """Note what is neither a number as it should be, nor a function of so many arguments."""
    if not callable(value):
        checked_number(where, value, problems, rule, f"{allowed}, or a function of {' and '.join(takes)}", example)
        return
    try:
        inspect.signature(value).bind(*takes)
    except TypeError as error:
        problems.add(f"{where} = {value!r}: {error}; allowed is {allowed}, or a function of {' and '.join(takes)}; type {example}")
    except ValueError:  # one that does not say what it takes
        return


def _check_contact(name: Any, contact: Any, bodies: dict[str, Any], problems: Problems) -> None:
    where = f"contacts()[{name!r}]"
    if not isinstance(contact, Contact):
        problems.add(f'{where} = {contact!r}; allowed is a Contact; type {name!r}: ss.Contact("head", friction)')
        return
    for what in ("hold", "at"):
        if getattr(contact, what) is not None:
            example = 'coordinates = ("x", "angle") and def places(self, t, q)'
            problems.add(f"{where}.{what} = {getattr(contact, what)!r}; it is for machines that say where bodies are; type {example}")
    if isinstance(contact.body, Mapping):
        _check_coefficients(where, contact, bodies, problems)
    elif contact.body not in bodies:
        problems.add(f"{where}.body = {contact.body!r}; {did_you_mean(str(contact.body), bodies)}")
    if isinstance(contact.on, str):
        if contact.on not in bodies:
            problems.add(f"{where}.on = {contact.on!r}; {did_you_mean(contact.on, bodies)}")
        elif contact.on == contact.body:
            problems.add(f"{where} has the body {contact.body!r} in contact with itself; allowed is another body, or on=None for the track")
    elif contact.on is not None and not all(callable(getattr(contact.on, name, None)) for name in ("velocity", "acceleration")):
        allowed = "the name of a body, a speed [m/s], or a motion with position, velocity and acceleration"
        checked_number(f"{where}.on", contact.on, problems, None, allowed, "on=0.1")
    if callable(contact.load):
        if arguments_of_load(contact.load) is None:
            problems.add(f"{where}.load = {contact.load!r}: {LOADS}; type load=lambda t, x, v, forces: 1.0")
    elif contact.load is not None:
        checked_number(f"{where}.load", contact.load, problems, positive, f"a positive force [N], or {LOADS}", "load=1.0")
    own = Problems(problems.what)
    check_law(contact.friction, own)
    for sentence in own.mistakes:
        problems.add(f"{where}.{sentence}" if sentence.startswith("friction") else f"{where}: {sentence}")


def _check_coefficients(where: str, contact: Any, bodies: dict[str, Any], problems: Problems) -> None:
    """Note coefficients of bodies that are not there, that are no numbers or all zero, and what a contact that has them cannot have."""
    for name, g in contact.body.items():
        if name not in bodies:
            problems.add(f"{where}.body has a coefficient of {name!r}, which is not a body; {did_you_mean(str(name), bodies)}")
        example = f"{{{name!r}: 0.5}}"
        checked_number(f"{where}.body[{name!r}]", g, problems, None, "a coefficient, positive or negative", f"ss.Contact({example}, law)")
    if not contact.coefficients:
        problems.add(
            f"{where}.body = {dict(contact.body)!r}, so that nothing decides its slip; allowed is at least one coefficient that is not "
            'zero; type ss.Contact({"q1": 0.59, "q2": 0.95}, law, load=1.0)'
        )
    if contact.load is None:
        problems.add(f"{where}.load is not given, and a contact with coefficients has no weight; allowed is a force [N]; type load=1.0")
    if isinstance(contact.on, str):
        example = f"{{..., {contact.on!r}: -1.0}}"
        problems.add(f"{where}.on = {contact.on!r}; with coefficients a body that it rubs on has one too; type ss.Contact({example}, law)")
    if contact.restitution is not None:
        problems.add(f"{where}.restitution = {contact.restitution!r}; a contact with coefficients does not fly; type restitution=None")


def _check_loads(mechanics: Mechanics, problems: Problems) -> None:
    """Note loads that ask for forces that are not known, or take a number of the body itself for those of all."""
    for i, name in enumerate(mechanics.contacts):
        if mechanics.of_motion[i]:
            try:
                mechanics.load(i, 0.0, mechanics.start)
            except InputError as error:
                for mistake in error.problems:
                    problems.add(f"contacts()[{name!r}].load: {mistake}")


def _check_flight(name: str, contact: Any, mechanics: Any, problems: Problems) -> None:
    """Note a contact that is to fly and cannot: its body has others, or what it rubs on is a body."""
    if contact.restitution is None or isinstance(contact.body, Mapping):
        return
    where = f"contacts()[{name!r}].restitution"
    if (arguments_of_load(contact.load) or 0) > 2:
        problems.add(
            f"{where}: the load of a body that flies and lands is a function of time and position, and {contact.load!r} takes velocities "
            "too; allowed is for example load=lambda t, x: 1.0 + x; type restitution=None for a run that ends where the load falls to zero"
        )
    checked_number(where, contact.restitution, problems, lambda e: (e >= 0) & (e < 1), "from 0 to below 1", "restitution=0.3")
    law = adapted(contact.friction)
    if not law.dynamic and not is_affine(law):
        problems.add(
            f"{where}: the friction of {law.name} is not proportional to the load, so that an impact has no impulse along; allowed is a "
            "law that is, such as ss.Coulomb; type restitution=None for a run that ends where the load falls to zero"
        )
    row = mechanics.row(contact.body, contact.on if isinstance(contact.on, str) else None)
    others = [other for other, g in zip(mechanics.contacts, mechanics.directions, strict=True) if other != name and g[row.index(1.0)]]
    joined = [other for other in mechanics.groups[mechanics.coordinate[contact.body]] if other != contact.body]
    if others or joined or isinstance(contact.on, str):
        why = f"rubs on {contact.on!r}" if isinstance(contact.on, str) else f"is joined to {', '.join(map(repr, [*others, *joined]))}"
        problems.add(
            f"{where}: a body that flies and lands has this contact alone, on the track or on a motion, and {contact.body!r} {why}; "
            "type restitution=None: a run then ends where the load falls to zero"
        )


def _check_ends(what: str, ends: Any, bodies: dict[str, Any], problems: Problems) -> None:
    if not isinstance(ends, tuple) or len(ends) != 2 or ends[0] is None or ends[0] == ends[1]:
        allowed = "two names of bodies, or a name and None for the ground"
        problems.add(f"{what}() has the key {ends!r}; allowed are {allowed}; type {_EXAMPLES[what]}")
        return
    for end in ends:
        if end is not None and end not in bodies:
            problems.add(f"{what}()[{ends!r}]: {end!r} is not a body; {did_you_mean(str(end), bodies)}")


def _check_joint(what: str, ends: Any, part: Any, problems: Problems) -> None:
    where = f"{what}()[{ends!r}]"
    if what == "stops":
        if not isinstance(part, Stop):
            problems.add(f"{where} = {part!r}; allowed is a Stop; type ss.Stop(gap=0.01, restitution=0.5)")
        return
    prescribed = all(callable(getattr(part, name, None)) for name in ("position", "velocity", "acceleration"))
    if isinstance(part, Link):  # which has been checked where it was made
        prescribed = part.force is None
    if isinstance(part, type) or not (callable(getattr(part, "force", None)) or prescribed):
        problems.add(
            f"{where} = {part!r}; allowed is an object with force(distance, rate) or force(t, distance, rate), or with position(t), "
            "velocity(t) and acceleration(t) where it prescribes the distance; type for example ss.Spring(stiffness=1200.0)"
        )
    elif prescribed and ends[1] is None:
        problems.add(
            f"{where} prescribes where a body is; allowed are links between two bodies; leave the body out, or join it by a spring"
        )


def _check_controller(name: Any, part: Any, bodies: dict[str, Any], problems: Problems) -> None:
    """Note what is not a controller, or starts with other states than it has, or acts on bodies that are not there."""
    where = f"controllers()[{name!r}]"
    if missing := [each for each in NEEDS if isinstance(part, type) or not hasattr(part, each)]:
        problems.add(f"{where} = {part!r} has no {', no '.join(missing)}; allowed is an object with {', '.join(NEEDS)}")
        return
    x, v = {each: body.position for each, body in bodies.items()}, dict.fromkeys(bodies, 0.0)
    z = part.start(0.0, x, v)
    counted = {"start": z, "rates": part.rates(0.0, x, v, z), "scales": part.scales}
    for what, numbers in counted.items():
        if len(numbers) != len(part.states):
            problems.add(f"{where}.{what} gives {len(numbers)} numbers; allowed is one for each of the states {', '.join(part.states)}")
    for body in part.forces(0.0, x, v, z):
        if body not in bodies:
            problems.add(f"{where} acts on {body!r}, which is not a body; {did_you_mean(str(body), bodies)}")


def _check_controllers(mechanics: Mechanics, problems: Problems) -> None:
    """Note controllers whose samples do not come together, or do not come back with the machine's period."""
    machine, parts = mechanics.model, mechanics.controllers.parts
    samples = {name: part.sample for name, part in parts.items() if part.sample is not None}
    for name, own in samples.items():
        fastest = mechanics.controllers.sample
        ratio = own / fastest
        if not everywhere(abs(_off_whole(ratio)) <= 1e-9):
            problems.add(
                f"controllers()[{name!r}] samples every {describe(own)} s, and the fastest every {describe(fastest)} s; "
                "allowed is a whole number of times as long; a controller without states and forces that samples in a time of which both "
                "are multiples may be the fastest"
            )
        if machine.period is not None and not everywhere(abs(_off_whole(machine.period / own)) <= 1e-9):
            mistake = f"the period of {describe(machine.period)} s is not a whole number of them"
            problems.add(f"controllers()[{name!r}] samples every {describe(own)} s, and {mistake}; allowed is a period that is")


def _off_whole(ratio: Any) -> Any:
    """How far a number is from the nearest whole one, as a part of it."""
    import numpy as np

    return (ratio - np.rint(ratio)) / ratio


def _check_groups(mechanics: Any, problems: Problems) -> None:
    """Note prescribed distances that close a loop, and contacts between bodies that one of them joins."""
    period = mechanics.model.period
    for name, contact in mechanics.joints.items():
        _check_flight(name, contact, mechanics, problems)
    joined = sum(len(group) - 1 for group in mechanics.groups)
    if joined < len(mechanics.prescribed):
        problems.add("links() prescribes distances in a closed loop; allowed is one path from body to body; leave one of them out")
    for (first, second), link in mechanics.prescribed:
        declared = mechanics.parts[first].position - mechanics.parts[second].position
        begun = link.distance(0.0) if isinstance(link, Link) else declared
        if not everywhere(abs(begun - declared) <= _SAME * (abs(declared) + abs(begun))):
            problems.add(
                f"links()[{(first, second)!r}] prescribes a distance of {describe(begun)} m at t = 0, where the positions of the "
                f"bodies are {describe(declared)} m apart; type position={describe(begun)} for the body {first!r}"
            )
    for ends, link in mechanics.prescribed if period is not None else ():
        begun, back = link.position(0.0), link.position(period)
        reach = abs(link.position(period / 3) - begun) + abs(link.position(period / 2) - begun)
        if not everywhere(abs(back - begun) <= _CLOSED * (reach + abs(begun))):
            problems.add(
                f"links()[{ends!r}] prescribes a distance that does not close: it changes by {describe(back - begun)} m in the period of "
                f"{describe(period)} s; allowed is a motion that comes back; type ss.Harmonic(amplitude=2e-3, frequency=2.0)"
            )
    for name, row in zip(mechanics.contacts, mechanics.directions, strict=True):
        if not any(row):
            problems.add(
                f"contacts()[{name!r}] is between two bodies whose distance is prescribed, so that nothing decides its slip; leave it out"
            )


def _check_stops(mechanics: Mechanics, problems: Problems) -> None:
    """Note stops between bodies whose distance is prescribed, and two that leave no way between them."""
    for name, stop in mechanics.named_stops:
        if not any(stop.direction):
            problems.add(
                f"stops() has {name}, between two bodies whose distance is prescribed, so that nothing could be stopped; leave it out, or "
                "join them by a spring"
            )
    for (first, one), (second, other) in itertools.combinations(mechanics.named_stops, 2):
        if set(one.ends) != set(other.ends) or (one.part.side == other.part.side) == (one.ends == other.ends):
            continue
        room, elastic = one.part.reach() + other.part.reach(), one.part.restitution is None and other.part.restitution is None
        if not everywhere(room >= 0 if elastic else room > 0):
            least = "zero or more" if elastic else "more than zero"
            problems.add(
                f"stops() has {first} and {second}, which face one another and overlap: their gaps add up to {describe(room)} m; "
                f"allowed is {least}; type gap=0.01 for both"
            )
