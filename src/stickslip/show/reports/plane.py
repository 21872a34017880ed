"""Bodies in the plane for the animation of a run: outlines, where they are, the ground, and what joins them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.models.link_ends import Point, body_of
from stickslip.models.machine_adapter import machine_of
from stickslip.models.said_of_motion import outlines_of_machine

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory

_DIGITS = 6
_OF_GROUND = 80  # places at which a curve is drawn


def plane_of(run: Trajectory, at: dict[str, Any]) -> dict[str, Any] | None:
    """What is drawn of a machine whose bodies move in the plane; None of any other.

    Returns
    -------
    dict or None
        bodies with name, mass [kg], x and z [mm], angle [rad] (None of one that does not turn), and points [mm]: those of its contacts and
        links, by its own axes; ground, a line as pairs of x and z [mm], empty where nothing touches it; links, for each the x and z of both
        ends [mm]; outlines, for each line the x and z of its points [mm].
    """
    mechanics: Any = machine_of(run.model).mechanics
    if not mechanics.joined or not mechanics.has_places:
        return None
    q, many = tuple(np.asarray(at["x"]).T), len(at["t"])
    places = mechanics.along(0.0, q)
    flat = {name: components for name, components in places.items() if len(components) > 1}
    if not flat:
        return None

    def column(value: Any, factor: float = 1e3) -> Array:
        return np.broadcast_to(factor * np.asarray(getattr(value, "value", value), float), (many,))

    bodies: list[dict[str, Any]] = []
    for name, (x, z, *angle) in flat.items():
        points = [[1e3 * float(part) for part in point] for point in _points(mechanics, name)]
        turned = _rounded(column(angle[0], 1.0)) if angle else None
        bodies.append({"name": name, "mass": float(mechanics.placed[name].mass), "x": _rounded(column(x)), "z": _rounded(column(z)),
                       "angle": turned, "points": points})  # fmt: skip
    ends = [[link._point(end, 0.0, places) for end in link.ends] for link in mechanics.placed_links if not link.turns]
    links = [[[_rounded(column(x)), _rounded(column(z))] for x, z in both] for both in ends]
    lines = outlines_of_machine(mechanics.model, 0.0, dict(zip(mechanics.bodies, q, strict=True))) or ()
    outlines = [[[_rounded(column(x)), _rounded(column(z))] for x, z in line] for line in lines]
    return {"bodies": bodies, "ground": _ground(mechanics, bodies), "links": links, "outlines": outlines}


def _points(mechanics: Any, name: str) -> Iterator[tuple[float, float]]:
    """Points of a body that touch something, or at which something pulls."""
    for contact in mechanics.joints.values():
        if contact.body == name and contact.at is not None:
            yield contact.at
    for link in mechanics.placed_links:
        yield from (end.at for end in link.ends if isinstance(end, Point) and body_of(end) == name and not callable(end.at))


def _ground(mechanics: Any, bodies: list[dict[str, Any]]) -> list[list[float]]:
    """The ground that bodies touch, as far as they get."""
    on = [contact.curve for contact in mechanics.touching if contact.of_body and not contact.rubs_on_body]
    if not on:
        return []
    x = [value for body in bodies for value in body["x"]]
    reach = max([abs(part) for body in bodies for point in body["points"] for part in point], default=0.0)
    low, high = min(x) - reach, max(x) + reach
    curve = next((each for each in on if each is not None), None)
    if curve is None:
        return [[low, 0.0], [high, 0.0]]
    places = np.linspace(low, high, _OF_GROUND)
    return [[float(a), 1e3 * float(curve(1e-3 * float(a)))] for a in places]


def _rounded(values: Array) -> list[float]:
    return [float(f"{value:.{_DIGITS}g}") for value in values]
