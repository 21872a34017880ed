"""Whether a coordinate of a machine is an angle: a whole turn of it changes nothing that the machine says, or a body turns with it.

A wheel that rolls is elsewhere after a turn. Its coordinate is its angle where the body's angle grows as the coordinate does, whatever
the numbers of the machine are; where a place along x or y grows so, as of a wheel in the coordinate of its hub, it is a length.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.basics.maths import pi
from stickslip.models.said_of_motion import inertia_of_machine, kinetic_of_machine, places_of_machine

_NEAR = 1e-9  # relative: numbers that are closer are the same


def is_angle(model: Any, names: tuple[str, ...], name: str) -> bool:
    """Whether a coordinate is an angle."""
    return _turns_a_body(model, names, name) or _comes_again(model, names, name)


def _turns_a_body(model: Any, names: tuple[str, ...], name: str) -> bool:
    """Whether the angle of a body grows as the coordinate does with any numbers of the machine, and no place along x or y does."""
    draw, numbers = np.random.default_rng(0), {key: float(np.ravel(value)[0]) for key, value in leaves(model) if np.size(value)}
    turned, moved = list[Array](), list[Array]()
    for _ in range(2):
        other = replace_leaf(model, {key: number * draw.uniform(1.1, 1.9) for key, number in numbers.items()})
        q = dict(zip(names, draw.uniform(0.2, 0.9, len(names)).tolist(), strict=True))
        try:
            ahead, behind = ([*_places(other, {**q, name: q[name] + step})] for step in (0.5, -0.5))
        except (ValueError, ArithmeticError):  # a root of a negative number, say: these numbers make no machine
            return False
        slopes = [np.abs(a - b) for a, b in zip(ahead, behind, strict=True)]
        turned.append(np.array([slope[2] for slope in slopes if len(slope) == 3]))
        moved.append(np.array([each for slope in slopes for each in slope[:2]]))
    as_it = [np.all([np.abs(slope - 1.0) <= _NEAR for slope in of], axis=0) for of in (turned, moved)]
    return bool(as_it[0].any() and not as_it[1].any())


def _places(model: Any, q: dict[str, float]) -> list[Array]:
    """The places of bodies in the plane, with their angles where they are said."""
    places = places_of_machine(model, 0.0, q)
    given = places.values() if isinstance(places, Mapping) else ()
    return [np.asarray(where, float) for where in given if isinstance(where, tuple)]


def _comes_again(model: Any, names: tuple[str, ...], name: str) -> bool:
    """Whether a whole turn of a coordinate leaves everything where it is, and a part of a turn does not."""
    draw, changes = np.random.default_rng(0), False
    for _ in range(2):
        q, u = (dict(zip(names, draw.uniform(0.2, 0.9, len(names)).tolist(), strict=True)) for _ in range(2))
        here, part, whole = (_everything(model, {**q, name: q[name] + turn}, u) for turn in (0.0, 0.7, 2 * pi))
        if len(here) != len(whole) or len(here) != len(part):
            return False
        for a, b, c in zip(here, part, whole, strict=True):
            size = _NEAR * (1.0 + np.abs(a))
            if np.any(np.abs(c - a) > size):
                return False
            changes = changes or bool(np.any(np.abs(b - a) > size))
    return changes


def _everything(model: Any, q: dict[str, float], u: dict[str, float]) -> list[Array]:
    """The numbers that a machine gives of a state; angles of bodies by their sines and cosines."""
    places = places_of_machine(model, 0.0, q)
    numbers: list[Any] = []
    for where in places.values() if isinstance(places, Mapping) else ():
        if isinstance(where, tuple) and len(where) == 3:
            numbers += [*where[:2], np.sin(where[2]), np.cos(where[2])]
        else:
            numbers += _flat(where)
    numbers += _flat(inertia_of_machine(model, q)) + _flat(kinetic_of_machine(model, q, u)) + _flat(model.forces(0.0, q, u))
    return [np.asarray(number, float) for number in numbers]


def _flat(given: Any) -> list[Any]:
    if isinstance(given, Mapping):
        given = list(given.values())
    return [number for each in given for number in _flat(each)] if isinstance(given, (list, tuple)) else [] if given is None else [given]
