"""Which coordinates of a machine are angles, and the units that columns of a coordinate or a contact have then."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.maths import pi
from stickslip.basics.variables import VARIABLES, about_an_axis, unit_of
from stickslip.models.said_of_motion import inertia_of_machine, kinetic_of_machine, places_of_machine

_NEAR = 1e-9  # relative: numbers that are closer are the same


def angles_of(model: Model) -> tuple[str, ...]:
    """The coordinates of a machine that are angles: those that its class names in `angles`, or else those that a whole turn leaves alone.

    A turn by 2 pi changes no place, no matrix of inertia, no kinetic energy and no applied force, and a smaller one does; the angle of a
    body may be larger by whole turns. Machines without coordinates of their own have none.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> import stickslip as ss
    >>> from stickslip.maths import cos, sin
    >>> @dataclass(frozen=True, eq=False)
    ... class Hung(ss.Machine):
    ...     length: float
    ...     coordinates = ("x", "phi")
    ...
    ...     def bodies(self):
    ...         return {"cart": ss.Body(1.0), "bob": ss.Body(0.1)}
    ...
    ...     def places(self, t, q):
    ...         bob = q["x"] + self.length * sin(q["phi"]), -self.length * cos(q["phi"])
    ...         return {"cart": (q["x"], 0.0), "bob": bob}
    >>> angles_of(Hung(0.5)), angles_of(ss.Chain.example())
    (('phi',), ())
    """
    names = getattr(model, "coordinates", None)
    if not isinstance(names, tuple):
        return ()
    said = getattr(model, "angles", None)
    return tuple(said) if said is not None else tuple(name for name in names if _turns(model, names, name))


def _turns(model: Any, names: tuple[str, ...], name: str) -> bool:
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


def unit_of_part(column: str, model: Model, part: str) -> str:
    """Unit of a column of one body, coordinate or contact: of an angle, and of friction in a joint, that about an axis.

    Without a name of a part it is that of the coordinate whose motion is the machine's.

    Examples
    --------
    >>> import stickslip as ss
    >>> unit_of_part("v", ss.Chain.example(), "module 1"), unit_of_part("v", ss.Joint.example(), "joint")
    ('m/s', 'rad/s')
    """
    unit, angles = unit_of(column, model), angles_of(model)
    if not angles or "inner_state" in VARIABLES[column].dims:
        return unit
    if "contact" in VARIABLES[column].dims:
        contact = model.contacts().get(part)  # type: ignore[attr-defined]
        part = contact.body if contact is not None and isinstance(contact.body, str) else ""
    elif part not in model.coordinates:  # type: ignore[attr-defined]
        part = getattr(model, "principal", None) or model.coordinates[0]  # type: ignore[attr-defined]
    return about_an_axis(unit) if part in angles else unit
