"""Which coordinates of a machine are angles, and the units that columns of a coordinate or a contact have then."""

from __future__ import annotations

import numpy as np

from stickslip.basics.contracts import Model
from stickslip.basics.variables import VARIABLES, about_an_axis, unit_of
from stickslip.models.machine_adapter import machine_of
from stickslip.models.model_adapter import adapter_of


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
    return adapter_of(model).angles


def unit_of_part(column: str, model: Model, part: str) -> str:
    """Unit of a column of one body, coordinate or contact: of an angle, and of friction in a joint, that about an axis.

    Without a name of a part it is that of the coordinate whose motion is the machine's.

    Examples
    --------
    >>> import stickslip as ss
    >>> unit_of_part("v", ss.Chain.example(), "module 1"), unit_of_part("v", ss.Joint.example(), "joint")
    ('m/s', 'rad/s')
    """
    unit, of = unit_of(column, model), adapter_of(model)
    if not of.angles or "inner_state" in VARIABLES[column].dims:
        return unit
    m = machine_of(model).mechanics
    if "contact" in VARIABLES[column].dims:
        contact = m.joints.get(part)
        part = contact.body if contact is not None and isinstance(contact.body, str) else ""
    elif part not in m.bodies:
        part = m.bodies[int(np.argmax(m.shares))]
    return about_an_axis(unit) if part in of.angles else unit
