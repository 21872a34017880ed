"""Ends of links in the plane: a point of a body or of the ground, and the angle of a body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, eq=False)
class Point:
    """A point of a body, or of the ground, at which a link or a stop ends; of machines with `places`.

    Parameters
    ----------
    body : str or None
        Name of the body; None is the ground.
    at : tuple of float or callable, optional
        (x, z) in the body's own axes from its place [m]; without an angle in its place these do not turn. Of the ground, where it is; a
        function of time gives a point that is moved.

    Examples
    --------
    A spring from the rim of a wheel to a wall, which pulls along the line between the two:

    >>> import stickslip as ss
    >>> ends = (ss.Point("wheel", at=(0.0, 0.1)), ss.Point(None, at=(0.5, 0.1)))
    >>> links = {ends: ss.Spring(stiffness=100.0, length=0.4)}
    """

    body: Any
    at: Any = (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Angle:
    """The angle of a body, at which a link or a stop turns it; of machines with `places` of three parts.

    Parameters
    ----------
    body : str
        Name of the body.

    Examples
    --------
    A torsion spring between two links of an arm, and one between the first and the ground [N m/rad]:

    >>> import stickslip as ss
    >>> Angle = ss.machines.Angle
    >>> links = {(Angle("upper"), Angle("lower")): ss.Spring(3.0), (Angle("upper"), None): ss.Spring(5.0)}
    """

    body: str


def body_of(end: Any) -> Any:
    """The body at which a link ends; None is the ground.

    Examples
    --------
    >>> body_of("bob"), body_of(Point("wheel", at=(0.0, 0.1))), body_of(None)
    ('bob', 'wheel', None)
    """
    return end.body if isinstance(end, (Point, Angle)) else end
