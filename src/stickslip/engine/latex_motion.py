"""The lines of a machine: what moves each body, links and stops, and one block for each contact, or for several that differ in numbers."""

from __future__ import annotations

from functools import partial
from typing import Any

import sympy

from stickslip.basics.contracts import Law, Model
from stickslip.basics.errors import InputError
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.engine.latex_laws import lines_of_law
from stickslip.engine.letters import Formula, expression_of, spread, symbol
from stickslip.engine.tex import Letters, dotted, indices, letters_of, letters_of_coordinates, subscripted, text_of
from stickslip.models.machine_adapter import machine_of
from stickslip.models.mechanics import Numbers
from stickslip.models.rails import weighed
from stickslip.models.several_bodies import SeveralBodies

#: What letters mean in equations of machines with coordinates of their own; z too, where a law has inner states.
_MEANT = ("t", "v", "w", "R", "N", "F", "m", "h")
_MANY = 4  # contacts of one block that are listed; of more, the first and the last


class _Parts(SeveralBodies):
    """A machine of parts whose bodies' positions and velocities are symbols of their own, and whose links are."""

    def __init__(self, model: Model):
        super().__init__(model)
        self.index = dict(zip(self.bodies, indices(self.bodies), strict=True))
        self.x, self.v = _states(list(self.index.values()))
        ends_of = [ends for ends, _ in self.elastic]
        letters = [_pull(self.index, ends, ends_of[:k]) for k, ends in enumerate(ends_of)]
        self.tensions = list(zip(ends_of, self.pulls, letters, strict=True))
        self.pulls = [partial(_letter, letter) for letter in letters]

    def positions(self, t: Any, q: Numbers) -> tuple[Any, ...]:
        return self.x

    def velocities(self, t: Any, u: Numbers) -> tuple[Any, ...]:
        return self.v

    def _arms(self, what: str, t: Any) -> tuple[Any, ...]:
        return (0.0,) * len(self.bodies)  # what prescribed distances add is in the bodies' own symbols

    def slips(self, t: Any, u: Numbers, q: Numbers = ()) -> tuple[Any, ...]:
        moving = dict(zip(self.bodies, self.v, strict=True))
        given = [contact.coefficients for contact in self.joints.values()]
        own = (sum((of[name] * v for name, v in moving.items() if name in of), 0.0) for of in given)
        return tuple(slip + offset for slip, offset in zip(own, self.offsets(t), strict=True))


def lines_of_motion(model: Model) -> list[str]:
    """All lines of a machine; `InputError` if a part of it is no formula."""
    letters = letters_of(model, [name for name, _ in leaves(model)], _own_coordinates(machine_of(model).mechanics))
    traced = replace_leaf(model, letters.symbols)
    try:
        mechanics: Any = machine_of(traced).mechanics
        if mechanics.joined:
            mechanics.alike(machine_of(model).mechanics)
            return [*_of_coordinates_joined(mechanics), *_of_contacts(mechanics, letters)]
        if isinstance(mechanics, SeveralBodies):
            mechanics = _Parts(mechanics.model)
        return [*_of_bodies(mechanics), *_of_controllers(mechanics), *_of_links(mechanics), *_of_contacts(mechanics, letters)]
    except (TypeError, ValueError, AttributeError):  # a record, say: numbers and no formula
        why = f"what drives this {type(model).__name__} cannot be written as a formula"
        raise InputError("latex", [f"{why}; for a law alone type ss.latex(law)"]) from None


def _states(own: list[str]) -> tuple[tuple[Formula, ...], tuple[Formula, ...]]:
    """Symbols of positions and velocities."""
    x, v = (tuple(symbol(subscripted(letter, index), 0) for index in own) for letter in ("x", "v"))
    return x, v


def _own_coordinates(mechanics: Any) -> list[str]:
    """The letters of coordinates of a machine's own; none of a machine of bodies on a line."""
    if not mechanics.joined:
        return []
    inner = ("z",) if any(law.states and not law.flies for law in mechanics.laws) else ()
    return letters_of_coordinates(mechanics.bodies, (*_MEANT, *inner))


def _states_of(mechanics: Any) -> tuple[tuple[Formula, ...], tuple[Formula, ...]]:
    """Symbols of positions and velocities of bodies, x and v with their index, or of coordinates of its own, with a dot on velocities."""
    own = _own_coordinates(mechanics)
    if not own:
        return _states(indices(mechanics.bodies))
    return tuple(symbol(letter, 0) for letter in own), tuple(symbol(dotted("dot", letter), 0) for letter in own)


def _pull(index: dict[str, str], ends: tuple[str, str | None], before: list[Any]) -> Formula:
    """The symbol of a tension; a prime tells a second part between the same ends from the first."""
    between = [index[end] for end in ends if end is not None]
    joined = "".join(between) if all(len(each) == 1 for each in between) else ",".join(between)
    return symbol(subscripted("F" + "'" * before.count(ends), joined), 0)


def _of_bodies(mechanics: Any) -> list[str]:
    """Newton's law, one line for each coordinate, and the known jumps of velocities."""
    own, t = indices(mechanics.bodies), symbol("t", 0)
    x, v = _states(own)
    R = tuple(symbol(subscripted("R", index), 0) for index in indices(mechanics.contacts))
    lines = []
    q, u = _of_coordinates(mechanics, x), _of_coordinates(mechanics, v)
    moved = mechanics.accelerations(t, q, u, R, _held(mechanics))
    for c, (mass, acceleration) in enumerate(zip(mechanics.masses, moved, strict=True)):
        lines.append(f"{_inertia(mechanics, c, own)} &= {text_of(spread(expression_of(acceleration), expression_of(mass)))}")
    for instant, jumps in mechanics.jumps:
        lines += [
            rf"\Delta {subscripted('v', index)} &= {text_of(jumps[mechanics.coordinate_of(name)])}, && t = {text_of(instant)}"
            for name, index in zip(mechanics.bodies, own, strict=True)
            if expression_of(jumps[mechanics.coordinate_of(name)]) != 0
        ]
    return lines


def _of_coordinates_joined(mechanics: Any) -> list[str]:
    """The rows of the matrix of inertia times accelerations, one line for each coordinate, and what is on the other side."""
    own, t = _own_coordinates(mechanics), symbol("t", 0)
    x, v = _states_of(mechanics)
    R = tuple(symbol(subscripted("R", index), 0) for index in indices(mechanics.contacts))
    braked = [
        sum((expression_of(row[j]) * force.expression for row, force in zip(mechanics.rows(t, x), R, strict=True)), sympy.Integer(0))
        for j in range(len(own))
    ]
    lines, h = [], mechanics.applied(t, x, v)
    for contact, index in zip(mechanics.touching, indices(mechanics.contacts), strict=True):
        if contact.keeps_height:
            N = symbol(subscripted("N", index), 0).expression
            N = N / expression_of(contact.steepness(x))
            braked = [of - expression_of(up) * N for of, up in zip(braked, contact.heights_at(x), strict=True)]
    for row, force, brake in zip(mechanics.matrix(t, x), h, braked, strict=True):
        inertia = sum(
            (sympy.trigsimp(sympy.expand(expression_of(entry))) * symbol(dotted("ddot", letter), 0).expression)
            for entry, letter in zip(row, own, strict=True)
        )
        lines.append(f"{text_of(inertia)} &= {text_of(sympy.trigsimp(sympy.expand(expression_of(force))) - brake)}")
    return lines


def _held(mechanics: Any) -> tuple[Formula, ...]:
    """Symbols of what controllers hold."""
    own = mechanics.controllers
    return tuple(
        symbol(subscripted(rf"\mathrm{{{state}}}", index), 0)
        for states, index in zip(own.states, indices(own.names), strict=True)
        for state in states
    )


def _of_controllers(mechanics: Any) -> list[str]:
    """Rates of what controllers hold, and what a sample makes of it; of one that samples, what is held has no rate."""
    z, t, (q, u) = _held(mechanics), symbol("t", 0), _states_of(mechanics)
    rates = zip(z, mechanics.control_rates(t, q, u, z), strict=True)
    lines = [rf"\dot {text_of(state)} &= {text_of(rate)}" for state, rate in rates if expression_of(rate) != 0]
    if mechanics.controllers.sample is None:
        return lines
    when = rf"t = k \, {text_of(mechanics.controllers.sample)}"
    after = zip(z, mechanics.control_sampled(t, q, u, z), strict=True)
    return [*lines, *(rf"{text_of(state)}^+ &= {text_of(new)}, && {when}" for state, new in after if new is not state)]


def _of_coordinates(mechanics: Any, values: tuple[Formula, ...]) -> tuple[Formula, ...]:
    """One symbol for each coordinate: that of the first body that moves with it."""
    moves_with = [mechanics.coordinate_of(name) for name in mechanics.bodies]
    return tuple(values[moves_with.index(c)] for c in range(mechanics.coordinates))


def _inertia(mechanics: Any, c: int, own: list[str]) -> str:
    """Mass times acceleration of all bodies of a coordinate."""
    parts = getattr(mechanics, "parts", None)
    terms = []
    for name, index in zip(mechanics.bodies, own, strict=True):
        if mechanics.coordinate_of(name) == c:
            mass = expression_of(mechanics.masses[c] if parts is None else parts[name].mass)
            factor = (
                ""
                if mass == 1
                else rf"\left({text_of(mass)}\right) "
                if mass.is_Add
                else text_of(mass) + (r" \, " if "mathrm" in text_of(mass) else " ")
            )
            terms.append(rf"{factor}\ddot {subscripted('x', index)}")
    return " + ".join(terms)


def _of_links(mechanics: Any) -> list[str]:
    """Tensions, prescribed distances and hits."""
    t = symbol("t", 0)
    lines = []
    for ends, pull, letter in getattr(mechanics, "tensions", ()):  # one body on one contact has no links
        distance, rate = mechanics.distance(ends, mechanics.x), mechanics.distance(ends, mechanics.v)
        lines += _tension(partial(pull, t), distance, rate, text_of(letter))
    for (first, second), link in mechanics.prescribed:
        start = mechanics.parts[first].position - mechanics.parts[second].position
        distance = mechanics.distance((first, second), mechanics.x)
        lines.append(f"{text_of(distance)} &= {text_of(start + link.position(t))}")
    for stop in mechanics.stops:
        after, before = (
            " - ".join(rf"{subscripted('v', mechanics.index[end])}^{sign}" for end in stop.ends if end is not None) for sign in ("+", "-")
        )
        given = before if stop.ends[1] is None else rf"\left({before}\right)"
        where = f"{text_of(mechanics.distance(stop.ends, mechanics.x))} = {text_of(stop.part.side * expression_of(stop.part.reach(t)))}"
        if stop.part.at is not None:
            wall = text_of(expression_of(stop.part.motion.velocity(t)))
            lines.append(rf"{after} &= {wall} - {text_of(stop.restitution)} \left({before} - \left({wall}\right)\right), && {where}")
            continue
        lines.append(f"{after} &= - {text_of(stop.restitution)} {given}, && {where}")
    return lines


def _letter(letter: Formula, t: Any, distance: Any, rate: Any) -> Formula:
    """The symbol of a tension, in place of its formula."""
    return letter


def _tension(pull: Any, distance: Any, rate: Any, letter: str) -> list[str]:
    """The formula of a tension; where it distinguishes cases, in the distance d, which has a line of its own."""
    force = expression_of(pull(distance, rate))
    if not force.has(sympy.Piecewise, sympy.Max, sympy.Min):
        return [f"{letter} &= {text_of(force)}"]
    marks = letter[1:].lstrip("'")
    d, moving = (symbol(own + marks, 0) for own in ("d", r"\dot d"))
    return [f"{letter} &= {text_of(pull(d, moving))}", f"{text_of(d)} &= {text_of(distance)}"]


def _of_contacts(mechanics: Any, letters: Letters) -> list[str]:
    """Slips, loads and laws; what differs in the numbers of its symbols alone stands once, with the index i."""
    own, t, bodies = indices(mechanics.contacts), symbol("t", 0), indices(mechanics.bodies)
    x, v = _states_of(mechanics)
    together = mechanics.together  # loads that follow from the motion do so from one another, and their lines stand with heights
    if together:
        solved = [contact.is_held for contact in mechanics.touching]
        loads = [
            symbol(subscripted("N", n)) if of else mechanics.load(i, t, x, v) for i, (n, of) in enumerate(zip(own, solved, strict=True))
        ]
    else:
        loads = mechanics.loads(t, x, v, _held(mechanics))
    given = list(zip(mechanics.laws, mechanics.slips(t, v, x), loads, own, strict=True))
    blocks = []
    for lines_of in (_slip_lines, _load_lines, _law_lines):
        by_text = dict[str, tuple[list[str], list[str]]]()
        for law, slip, load, index in given:
            alone = lines_of(law.law, Formula(expression_of(slip)), Formula(expression_of(load)), index, v)
            turned = v if mechanics.joined else _states(["i" if each == index else each for each in bodies])[1]
            generic = lines_of(*_renumbered(letters, law.law, slip, load, index), turned)
            by_text.setdefault("\n".join(generic) if index else "", (alone, []))[1].append(index)
        blocks += [(alone if len(of) == 1 else generic.split("\n"), of) for generic, (alone, of) in by_text.items() if alone]
    return [*_with_ranges(blocks), *(_heights(mechanics, own, x, v) if together else _flights(mechanics, own))]


def _heights(mechanics: Any, own: list[str], x: tuple[Formula, ...], v: tuple[Formula, ...]) -> list[str]:
    """Heights of points, each of which has a load, or an impulse of a hit, only where it touches, and stays; and what rails bear."""
    t, lines = symbol("t", 0), list[str]()
    heights = mechanics.heights(t, x, v)
    gained = [symbol(dotted("ddot", letter), 0) for letter in _own_coordinates(mechanics)]
    for i, (name, law, index) in enumerate(zip(mechanics.contacts, mechanics.laws, own, strict=True)):
        h, N, P = (subscripted(letter, index) for letter in ("h", "N", r"\hat N"))
        if not law.flies:
            if name in heights:
                lines.append(f"{text_of(sympy.simplify(expression_of(heights[name][0])))} &= 0")
            elif mechanics.touching[i].is_held:
                by, rest = weighed(mechanics, i, t, x, v)
                needs = sum((expression_of(of) * a.expression for of, a in zip(by, gained, strict=True)), expression_of(rest))
                lines.append(rf"{N} &= \left|{text_of(sympy.expand(needs))}\right|")
            continue
        lines += [
            f"{h} &= {text_of(sympy.simplify(expression_of(heights[name][0])))}",
            rf"0 \le {h} &\perp {N} \ge 0",
            rf"0 \le \dot {h}^+ + {text_of(law.restitution)} \, \dot {h}^- &\perp {P} \ge 0, && {h} = 0",
        ]
    return lines


def _flights(mechanics: Any, own: list[str]) -> list[str]:
    """Equations of a contact that can fly and land."""
    lines = []
    for i, (law, index) in enumerate(zip(mechanics.laws, own, strict=True)):
        if law.flies:
            h, N, R = (subscripted(letter, index) for letter in ("h", "N", "R"))
            if mechanics.joined:
                lines.append(rf"{N} &= {R} = 0, && {h} > 0")
            else:
                j = next(k for k, g in enumerate(mechanics.directions[i]) if g)
                lines.append(rf"{text_of(mechanics.masses[j])} \ddot {h} &= - {N}, \quad {R} = 0, && {h} > 0")
            lines.append(rf"\dot {h}^+ &= - {text_of(law.restitution)} \, \dot {h}^-, && {h} = 0")
    return lines


def _with_ranges(blocks: list[tuple[list[str], list[str]]]) -> list[str]:
    """The lines of all blocks; for what i stands is said after the last of neighbouring blocks with the same contacts."""
    lines = []
    for k, (block, of) in enumerate(blocks):
        lines += block
        if len(of) > 1 and (k + 1 == len(blocks) or blocks[k + 1][1] != of):
            listed = of if len(of) <= _MANY else [of[0], r"\dots", of[-1]]
            lines.append(f"i &= {', '.join(listed)}")
    return lines


def _renumbered(letters: Letters, law: Law, slip: Any, load: Any, index: str) -> tuple[Any, Any, Any, str]:
    """Law, slip and load of a contact, with i for its index and for the number that its symbols share."""
    numbers = dict(leaves(law))
    new = letters.renumbered([load, slip, *numbers.values()], "i")
    new |= {symbol(subscripted("v", index), 0).expression: symbol(subscripted("v", "i"), 0).expression}

    def turned(value: Any) -> Formula:
        return Formula(expression_of(value).xreplace(new))

    return replace_leaf(law, {name: turned(value) for name, value in numbers.items()}), turned(slip), turned(load), "i"


def _velocity_letter(slip: Any, index: str, v: tuple[Formula, ...]) -> str:
    """The letter of a law's velocity: that of the body whose velocity the slip is, else w."""
    return text_of(slip) if slip in v else subscripted("w", index)


def _slip_lines(law: Law, slip: Any, load: Any, index: str, v: tuple[Formula, ...]) -> list[str]:
    letter = _velocity_letter(slip, index, v)
    return [] if letter == text_of(slip) else [f"{letter} &= {text_of(slip)}"]


def _load_lines(law: Law, slip: Any, load: Any, index: str, v: tuple[Formula, ...]) -> list[str]:
    N = subscripted("N", index)
    return [] if load == 1 or text_of(load) == N else [f"{N} &= {text_of(load)}"]


def _law_lines(law: Law, slip: Any, load: Any, index: str, v: tuple[Formula, ...]) -> list[str]:
    """Under a load of one the coefficients are forces."""
    N = load if load == 1 else symbol(subscripted("N", index))
    return lines_of_law(law, N, _velocity_letter(slip, index, v), index)
