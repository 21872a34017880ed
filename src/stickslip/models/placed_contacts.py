"""A contact of a machine in coordinates of its own: what its slip takes of their rates, and along what normal its body is pressed."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import cos, sin, sqrt
from stickslip.models.linear_equations import is_nothing, product, total
from stickslip.models.several_bodies import prescribed_acceleration, prescribed_velocity

Pair = tuple[Any, Any]


class PlacedContact:
    """One contact, by its declaration. Its row is that of the place where the machine begins by default.

    A contact of coordinates has their coefficients. One of a body that is held on both sides slips along the way that its one coordinate
    leaves it, against what it rubs on; any other slips along x.
    """

    def __init__(self, mechanics: Any, contact: Any):
        self.mechanics, self.contact = mechanics, contact

    @property
    def of_body(self) -> bool:
        """Whether it is a point of a body, and not a coefficient of coordinates."""
        return isinstance(self.contact.body, str) and self.contact.body in self.mechanics.placed and self.mechanics.has_places

    @property
    def rubs_on_body(self) -> bool:
        """Whether it rubs on another body."""
        return isinstance(self.contact.on, str)

    @property
    def is_held(self) -> bool:
        """Whether it is held on both sides, and its load follows from the motion."""
        return self.contact.hold == "both" and self.contact.load is None

    @cached_property
    def ways(self) -> tuple[Pair, ...]:
        """For each coordinate how it moves the point against what it rubs on, in x and z."""
        return self.ways_at(self.mechanics.start)

    def ways_at(self, q: Any) -> tuple[Pair, ...]:
        """The same at given coordinates."""
        slopes, places = self.mechanics.slopes(0.0, q), self.mechanics.along(0.0, q)
        return tuple(self._way(slope, places) for slope in slopes)

    def _way(self, slope: dict[str, Any], places: dict[str, Any]) -> Pair:
        body, (a, b) = self.contact.body, self.contact.at or (0.0, 0.0)
        x, z, turn = (*slope[body], 0.0, 0.0)[:3]
        if len(slope[body]) == 3 and not (is_nothing(a) and is_nothing(b)):
            angle = places[body][2].value
            ahead, up = a * cos(angle) - b * sin(angle), a * sin(angle) + b * cos(angle)  # of the point, from the body's place
            x, z = total([x, product(turn, -1.0 * up)]), total([z, product(turn, ahead)])
        if self.rubs_on_body:
            other_x, other_z, _ = (*slope[self.contact.on], 0.0, 0.0)[:3]
            x, z = (_difference(*pair) for pair in ((x, other_x), (z, other_z)))
        return x, z

    @cached_property
    def row(self) -> tuple[Any, ...]:
        """What its slip takes of the coordinates' rates."""
        if not self.of_body:
            given = self.contact.body if isinstance(self.contact.body, Mapping) else {self.contact.body: 1.0}
            return tuple(given.get(name, 0.0) for name in self.mechanics.bodies)
        return self.row_at(self.mechanics.start)

    def row_at(self, q: Any) -> tuple[Any, ...]:
        """The same at given coordinates, of a point of a body."""
        ways = self.ways_at(q)
        return tuple(length_of(way) for way in ways) if self.contact.hold == "both" else tuple(x for x, _ in ways)

    def normal_at(self, q: Any) -> Pair:
        """The direction in which a body that is held on both sides is pressed, a quarter turn from that in which it slips."""
        x, z = next(way for way in self.ways_at(q) if not (is_nothing(way[0]) and is_nothing(way[1])))
        length = length_of((x, z))
        if is_nothing(z):
            return 0.0, 1.0
        return product(-1.0, z) / length, (0.0 if is_nothing(x) else x / length)

    def offset(self, t: Numeric) -> Any:
        """What the speed of a belt or a motion adds to the slip [m/s]."""
        return 0.0 - prescribed_velocity(self.contact.on, t)

    def offset_rate(self, t: Numeric) -> Any:
        """Its rate [m/s^2]."""
        return 0.0 - prescribed_acceleration(self.contact.on, t)


def _difference(a: Any, b: Any) -> Any:
    """a less b; of equal plain numbers plain zero."""
    return a if is_nothing(b) else product(-1.0, b) if is_nothing(a) else 0.0 if a is b else a - b


def length_of(way: Pair) -> Any:
    """How far a point goes with a coordinate, forwards or backwards in x; upwards or downwards where it is not along x.

    Examples
    --------
    >>> length_of((-1.0, 0.0)), length_of((3.0, -4.0)), length_of((0.0, -2.0))
    (-1.0, 5.0, -2.0)
    """
    x, z = way
    return x if is_nothing(z) else z if is_nothing(x) else sqrt(x * x + z * z)
