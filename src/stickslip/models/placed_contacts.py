"""A contact of a machine in coordinates of its own: what its slip takes of their rates, and along what normal its body is pressed.

Both may vary with the place. A point of a body on the ground slips along x, on a curve z = c(x) along its tangent (1, c')/s with
s^2 = 1 + c'^2. Where coordinates let it leave the ground, the contact itself keeps its height above it, z - c(x), and the load is the force
that this takes (`stickslip.models.kept_heights`).
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from stickslip.basics.contracts import Numeric
from stickslip.basics.fields import everywhere
from stickslip.basics.maths import cos, sin, sqrt
from stickslip.basics.time_rates import TimeJet, time_jet
from stickslip.models.linear_equations import is_nothing, product, total
from stickslip.models.several_bodies import prescribed_acceleration, prescribed_velocity

Pair = tuple[Any, Any]
_SAME = 1e-9  # of its size: how much a row may differ from place to place and be one
_LOOKS = 3  # places at which that is looked at


class Nature(NamedTuple):
    """What holds of a contact at any place.

    moves : numbers of the coordinates that move its point against what it rubs on
    varies : whether its row varies with the place
    along : whether they move it along x, and along z
    """

    moves: tuple[int, ...]
    varies: bool
    along: tuple[bool, bool]


class Incline(NamedTuple):
    """A curve at a place: its slope, how that grows with x, and its length for each length of x."""

    slope: Any
    bend: Any
    length: Any


class PlacedContact:
    """One contact, by its declaration.

    A contact of coordinates has their coefficients. One of a body that is held on both sides, and that one coordinate moves, slips along
    the way that this leaves it, against what it rubs on; any other slips along x.
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
    def curve(self) -> Any:
        """The height of the ground as a function of x; None where that is flat, or a body."""
        on = self.contact.on
        return on if callable(on) and not callable(getattr(on, "velocity", None)) else None

    @property
    def is_held(self) -> bool:
        """Whether its load follows from the motion."""
        return self.contact.hold is not None and self.contact.load is None

    @property
    def pushes(self) -> bool:
        """Whether its load follows from the motion, and what it rubs on can push and not pull."""
        return self.is_held and self.contact.hold == "push"

    @property
    def follows(self) -> bool:
        """Whether it slips along the way of one coordinate, and not along x."""
        return self.contact.hold == "both" and len(self.nature.moves) == 1

    @property
    def keeps_height(self) -> bool:
        """Whether its normal force is what keeps its point at its height, which coordinates could change."""
        return self.is_held and self.nature.along[1] and not self.follows

    @cached_property
    def nature(self) -> Nature:
        """What holds at any place, looked at with the numbers of the machine at some places."""
        if not self.of_body:
            return Nature(tuple(j for j, g in enumerate(self.row) if not is_nothing(g)), False, (True, False))
        draw, n = random.Random(20261129), len(self.mechanics.bodies)
        ways = [self.ways_at(tuple(draw.uniform(-0.9, 0.9) for _ in range(n))) for _ in range(_LOOKS)]
        size = max(float(np.max(abs(part))) for at in ways for way in at for part in way)

        def is_there(part: Any) -> bool:
            return not everywhere(abs(part) <= _SAME * size)

        moves = tuple(j for j in range(n) if any(is_there(part) for at in ways for part in at[j]))
        follows = self.contact.hold == "both" and len(moves) == 1
        along = tuple(any(is_there(at[j][k]) for at in ways for j in moves) for k in range(2))
        if self.curve is not None:  # whatever its numbers are
            return Nature(moves, True, (along[0], along[1]))
        rows = [tuple(length_of(at[j], along) if follows else at[j][0] for j in moves) for at in ways]
        varies = any(is_there(a - b) for row in rows[1:] for a, b in zip(row, rows[0], strict=True))
        return Nature(moves, varies, (along[0], along[1]))

    def ways_at(self, q: Any) -> tuple[Pair, ...]:
        """For each coordinate how it moves the point against what it rubs on, in x and z."""
        slopes, places = self.mechanics.slopes(0.0, q), self.mechanics.along(0.0, q)
        return tuple(self._way(slope, places) for slope in slopes)

    def _way(self, slope: dict[str, Any], places: dict[str, Any]) -> Pair:
        body = self.contact.body
        x, z, turn = (*slope[body], 0.0, 0.0)[:3]
        if len(slope[body]) == 3 and self._off_the_axis:
            ahead, up = self._turned(places[body][2].value)
            x, z = total([x, product(turn, -1.0 * up)]), total([z, product(turn, ahead)])
        if self.rubs_on_body:
            other_x, other_z, _ = (*slope[self.contact.on], 0.0, 0.0)[:3]
            x, z = (_difference(*pair) for pair in ((x, other_x), (z, other_z)))
        return x, z

    @property
    def _at(self) -> Pair:
        """The point on its body, from the body's own place and axes."""
        return self.contact.at or (0.0, 0.0)

    @property
    def _off_the_axis(self) -> bool:
        """Whether the point moves when its body turns."""
        return not all(map(is_nothing, self._at))

    def _turned(self, angle: Any) -> Pair:
        """The point on its body that has turned by an angle."""
        a, b = self._at
        return a * cos(angle) - b * sin(angle), a * sin(angle) + b * cos(angle)

    def incline(self, q: Any) -> Incline:
        """The slope of its curve at given coordinates, how that grows with x, and the length of the curve for each length of x."""
        x, _ = self.in_space(self.mechanics.along(0.0, q))
        there = time_jet(self.curve(TimeJet(x.value, 1.0)))
        return Incline(there.rate, there.second, sqrt(1.0 + there.rate * there.rate))

    def steepness(self, q: Any) -> Any:
        """The length of its curve for each length of x; 1 on flat ground."""
        return 1.0 if self.curve is None else self.incline(q).length

    def point(self, places: Any) -> tuple[Any, Any]:
        """The point itself from places that move, against what it rubs on: x and z, or the height above a curve, with two rates."""
        x, z = self.in_space(places)
        return (x, z) if self.curve is None else (x, z - self.curve(x))

    def in_space(self, places: Any) -> tuple[Any, Any]:
        """The same in x and z."""
        own = places[self.contact.body]
        x, z = (*own, 0.0)[:2]
        ahead, up = self._turned(own[2]) if len(own) == 3 and self._off_the_axis else self._at
        other_x, other_z = (*places[self.contact.on], 0.0)[:2] if self.rubs_on_body else (0.0, 0.0)
        return x + ahead - other_x, z + up - other_z

    @cached_property
    def row(self) -> tuple[Any, ...]:
        """What its slip takes of the coordinates' rates; where that varies, at the place where the machine begins by default."""
        if not self.of_body:
            given = self.contact.body if isinstance(self.contact.body, Mapping) else {self.contact.body: 1.0}
            return tuple(given.get(name, 0.0) for name in self.mechanics.bodies)
        return self.row_at(self.mechanics.start)

    def row_at(self, q: Any) -> tuple[Any, ...]:
        """The same at given coordinates."""
        if not self.of_body:
            return self.row
        incline = None if self.curve is None else self.incline(q)
        return tuple(
            0.0 if j not in self.nature.moves else length_of(way, self.nature.along) if self.follows else _along(way, incline)
            for j, way in enumerate(self.ways_at(q))
        )

    def bias(self, q: Any, places: Any) -> Any:
        """Rate of its slip while the coordinates' rates stay as they are, at given coordinates and places that move."""
        if not self.nature.varies:
            return 0.0
        x, z = self.in_space(places)
        if self.curve is not None:
            slope, bend, length = self.incline(q)
            slip = (x.rate + product(slope, z.rate)) / length
            turned = product(bend, x.rate)
            gained = total([x.second, product(slope, z.second), product(turned, z.rate)]) / length
            return total([gained, product(-1.0, product(product(slip, slope), turned)) / (length * length)])
        if not self.follows:
            return x.second
        ahead, up = self.ways_at(q)[self.nature.moves[0]]
        return total([product(ahead, x.second), product(up, z.second)]) / length_of((ahead, up), self.nature.along)

    def heights_at(self, q: Any) -> tuple[Any, ...]:
        """For each coordinate how it moves the point upwards."""
        incline = None if self.curve is None else self.incline(q)
        return tuple(_upwards(way, incline) if j in self.nature.moves else 0.0 for j, way in enumerate(self.ways_at(q)))

    def normal_at(self, q: Any) -> Pair:
        """The direction in which its body is pressed: upwards, or a quarter turn from the way along which it slips."""
        if not self.follows or not self.nature.along[1]:
            return 0.0, 1.0
        x, z = way = self.ways_at(q)[self.nature.moves[0]]
        length = length_of(way, self.nature.along)
        return product(-1.0, z) / length, (x / length if self.nature.along[0] else 0.0)

    def offset(self, t: Numeric) -> Any:
        """What the speed of a belt or a motion adds to the slip [m/s]."""
        return 0.0 if self.curve is not None else 0.0 - prescribed_velocity(self.contact.on, t)

    def offset_rate(self, t: Numeric) -> Any:
        """Its rate [m/s^2]."""
        return 0.0 - prescribed_acceleration(self.contact.on, t)


def _along(way: Pair, incline: Incline | None) -> Any:
    """How far a point goes along x, or along a curve."""
    return way[0] if incline is None else total([way[0], product(incline.slope, way[1])]) / incline.length


def _upwards(way: Pair, incline: Incline | None) -> Any:
    """How far it goes upwards, or from a curve."""
    return way[1] if incline is None else total([way[1], product(-1.0, product(incline.slope, way[0]))])


def _difference(a: Any, b: Any) -> Any:
    """a less b; of equal plain numbers plain zero."""
    return a if is_nothing(b) else product(-1.0, b) if is_nothing(a) else 0.0 if a is b else a - b


def length_of(way: Pair, along: Any) -> Any:
    """How far a point goes with a coordinate, forwards or backwards where it goes along x alone, or along z.

    Examples
    --------
    >>> length_of((-1.0, 0.0), (True, False)), length_of((3.0, -4.0), (True, True)), length_of((0.0, -2.0), (False, True))
    (-1.0, 5.0, -2.0)
    """
    x, z = way
    return x if not along[1] else z if not along[0] else sqrt(x * x + z * z)
