"""Consistency checks of links and stops of a machine that names coordinates of its own."""

from __future__ import annotations

from typing import Any

from stickslip.basics.errors import Problems, did_you_mean
from stickslip.basics.fields import everywhere
from stickslip.models.any_coordinates import AnyCoordinates
from stickslip.models.link_ends import Angle, Point
from stickslip.models.links_in_time import several
from stickslip.models.machines.parts import Stop

_POINT = 'type ss.Point("bob", at=(0.0, 0.1))'


def check_links(machine: Any, problems: Problems) -> None:
    """Note links and stops that end at nothing, or at two things that have no distance, or that are no elastic parts."""
    names, bodies = machine.coordinates, machine.bodies()
    for where, declared in (("links", machine.links()), ("stops", machine.stops())):
        for ends, parts in declared.items():
            what = f"{where}()[{ends!r}]"
            if not isinstance(ends, tuple) or len(ends) != 2 or ends[0] is None:
                problems.add(f"{what}: allowed are two ends, the first of which is not the ground; type ({names[0]!r}, None)")
                continue
            for end in ends:
                _check_end(what, end, names, bodies, problems)
            for part in several(parts):
                _check_part(what, part, problems)
            kinds = {_kind(end, names) for end in ends if end is not None}
            if len(kinds) > 1:
                problems.add(
                    f"{what} joins a {' and a '.join(sorted(kinds))}; allowed are two coordinates, two angles, or two points of bodies"
                )


def _kind(end: Any, names: tuple[str, ...]) -> str:
    return "coordinate" if isinstance(end, str) and end in names else "angle" if isinstance(end, Angle) else "point"


def _check_end(what: str, end: Any, names: tuple[str, ...], bodies: Any, problems: Problems) -> None:
    if isinstance(end, (Point, Angle)):
        if end.body not in bodies and not (end.body is None and isinstance(end, Point)):
            problems.add(f"{what}: {end.body!r} is not a body; {did_you_mean(str(end.body), bodies)}")
        if isinstance(end, Point) and not (isinstance(end.at, tuple) and len(end.at) == 2) and not (end.body is None and callable(end.at)):
            problems.add(f"{what}: at = {end.at!r}; allowed is (x, z), or a function of time for a point of the ground; {_POINT}")
    elif end is not None and end not in names and end not in bodies:
        problems.add(f"{what}: {end!r} is not a coordinate and not a body, which links join; {did_you_mean(str(end), (*names, *bodies))}")


def _check_part(what: str, part: Any, problems: Problems) -> None:
    if isinstance(part, Stop):
        if part.restitution is not None:
            problems.add(f"{what}: stops with restitution are not there yet with coordinates; allowed are elastic ones; type stiffness=1e4")
    elif not callable(getattr(part, "force", None)):
        problems.add(f"{what} = {part!r} prescribes a distance; allowed are forces; a distance that is kept belongs into places(t, q)")


def check_placed_links(m: AnyCoordinates, problems: Problems) -> None:
    """Note what shows at places only: angles that are not given, a body in the plane tied to no point, and ends that coincide."""
    places = m.along(0.0, m.start) if m.placed_links else {}
    for link in m.placed_links:
        what = f"the link of {' and '.join(map(repr, link.bodies))}"
        if not m.has_places:
            problems.add(f"{what}: the machine has no places; allowed are links of coordinates; type ({m.bodies[0]!r}, None)")
        elif link.turns:
            if flat := [name for name in link.bodies if len(places[name]) < 3]:
                problems.add(f"{what}: places() gives {flat[0]!r} no angle; allowed is (x, z, angle)")
        elif link.is_straight(places):
            continue
        elif None in link.ends:
            problems.add(f"{what} ends at the ground, and at which point is not said; type ss.Point(None, at=(0.0, 0.0))")
        elif not everywhere(link.distance(0.0, places) > 0.0):
            problems.add(
                f"{what}: its ends coincide where all coordinates are zero, so that it pulls along no line; allowed are points apart; "
                f"{_POINT}; or two springs of coordinates, one along each"
            )
