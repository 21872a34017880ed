"""Which equations of motion a machine that lists its bodies has: by bodies on a line, or by coordinates of its own."""

from __future__ import annotations

from typing import Any

from stickslip.models.any_coordinates import AnyCoordinates
from stickslip.models.mechanics import Mechanics
from stickslip.models.several_bodies import SeveralBodies


def equations_of(model: Any) -> Mechanics:
    """The equations of a machine.

    Examples
    --------
    >>> import stickslip as ss
    >>> type(equations_of(ss.Chain.example())).__name__
    'SeveralBodies'
    """
    return SeveralBodies(model) if getattr(model, "coordinates", None) is None else AnyCoordinates(model)


#: The property of a machine that makes its equations; solvers make them themselves, of a machine whose own is this one.
mechanics_of = property(equations_of, doc="Its equations of motion, as functions of plain numbers.")
