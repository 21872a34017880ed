r"""Links and elastic stops of a machine in coordinates of its own: what they join, and how they pull on it.

Between two points the distance is :math:`d = |p_1 - p_2|`, and the tension acts along the line between them. Between coordinates, angles
or bodies on one line it is a difference, which has a sign.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import cos, sin, sqrt
from stickslip.basics.time_rates import TimeJet, time_jet
from stickslip.models.linear_equations import product, total
from stickslip.models.link_ends import Angle, Point, body_of
from stickslip.models.links_in_time import pull_of, several

Places = Mapping[str, tuple[TimeJet, ...]]
Share = tuple[str, tuple[Any, Any, Any]]  # a body, and the force along x, along z and the torque on it


def links_of(model: Any) -> Iterator[tuple[Any, Any, Any]]:
    """Ends, part and tension by time, distance and its rate of each link and elastic stop that a machine declares."""
    for ends, link in model.links().items():
        yield from ((ends, part, pull_of(part)) for part in several(link))
    for ends, stop in model.stops().items():
        yield from ((ends, part, part.pull) for part in several(stop))


class PlacedLink:
    """A link that ends at bodies, their points or their angles, by its declaration."""

    def __init__(self, ends: tuple[Any, Any], pull: Any):
        self.ends, self.pull = ends, pull

    @cached_property
    def bodies(self) -> tuple[str, ...]:
        """Those that it joins."""
        return tuple(name for name in map(body_of, self.ends) if name is not None)

    @property
    def turns(self) -> bool:
        """Whether it joins angles."""
        return any(isinstance(end, Angle) for end in self.ends)

    def is_straight(self, places: Places) -> bool:
        """Whether it joins bodies on a line, so that its distance has a sign."""
        return not any(isinstance(end, Point) for end in self.ends) and all(len(places[name]) == 1 for name in self.bodies)

    def forces(self, t: Numeric, places: Places) -> list[Share]:
        """What it does to each of its bodies."""
        if self.turns or self.is_straight(places):
            number = 2 if self.turns else 0
            first, second = (_part(end, number, places) for end in self.ends)
            apart = first - second
            tension = self.pull(t, apart.value, apart.rate)
            pulls = zip(self.ends, (product(-1.0, tension), tension), strict=True)
            return [(body_of(end), (0.0, 0.0, pull) if self.turns else (pull, 0.0, 0.0)) for end, pull in pulls if end is not None]
        (x1, z1), (x2, z2) = (self._point(end, t, places) for end in self.ends)
        x, z = x1 - x2, z1 - z2
        square = x * x + z * z
        length = TimeJet(square.value, square.rate)
        d = sqrt(length.value)
        tension = self.pull(t, d, 0.5 * length.rate / d)
        along = product(tension, x.value) / d, product(tension, z.value) / d
        return [
            (body_of(end), self._on(end, places, sign * along[0], sign * along[1]))
            for end, sign in zip(self.ends, (-1.0, 1.0), strict=True)
            if body_of(end) is not None
        ]

    def distance(self, t: Numeric, places: Places) -> Any:
        """How far its ends are apart [m]."""
        (x1, z1), (x2, z2) = (self._point(end, t, places) for end in self.ends)
        return sqrt(((x1 - x2) * (x1 - x2) + (z1 - z2) * (z1 - z2)).value)

    def _point(self, end: Any, t: Numeric, places: Places) -> tuple[TimeJet, TimeJet]:
        """Where it ends."""
        a, b = _at(end)
        if body_of(end) is None:
            return _moved(end.at, t) if callable(end.at) else (TimeJet(a), TimeJet(b))
        components = (*places[body_of(end)], TimeJet(0.0))
        x, z = components[0], components[1]
        if len(places[body_of(end)]) < 3:
            return x + a, z + b
        c, s = cos(components[2]), sin(components[2])  # type: ignore[arg-type]
        return x + a * c - b * s, z + a * s + b * c

    def _on(self, end: Any, places: Places, x: Any, z: Any) -> tuple[Any, Any, Any]:
        """A force at a point, with the torque about the place of its body."""
        components, (a, b) = places[body_of(end)], _at(end)
        if len(components) < 3:
            return x, z, 0.0
        c, s = cos(components[2].value), sin(components[2].value)
        ahead, up = total([product(a, c), product(-1.0, product(b, s))]), total([product(a, s), product(b, c)])
        return x, z, total([product(ahead, z), product(-1.0, product(up, x))])


def _moved(at: Any, t: Numeric) -> tuple[TimeJet, TimeJet]:
    """A point of the ground that is moved."""
    x, z = at(TimeJet(t, 1.0))
    return time_jet(x), time_jet(z)


def _at(end: Any) -> tuple[Any, Any]:
    return (0.0, 0.0) if not isinstance(end, Point) or callable(end.at) else end.at


def _part(end: Any, number: int, places: Places) -> TimeJet:
    """The angle of an end, or its place along a line; of the ground zero."""
    return TimeJet(0.0) if end is None else places[body_of(end)][number]


def shares(links: list[PlacedLink], t: Numeric, places: Places) -> dict[str, tuple[Any, Any, Any]]:
    """By body the sum of what links do to it."""
    gathered: dict[str, tuple[Any, Any, Any]] = {}
    for link in links:
        for name, parts in link.forces(t, places):
            gathered[name] = tuple(total(pair) for pair in zip(gathered[name], parts, strict=True)) if name in gathered else parts
    return gathered
