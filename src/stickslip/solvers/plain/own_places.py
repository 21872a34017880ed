"""Points, distances and linear equations of the judge's own way to a machine's motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from stickslip.basics.maths import cos, sin
from stickslip.models.link_ends import Point, body_of
from stickslip.solvers.plain.jets import Jet, lifted

Floats = list[Any]


class Apart(NamedTuple):
    """How far the ends of a link are apart, and in which direction from the second to the first."""

    distance: Jet
    x: Any
    z: Any


def rubbing(contact: Any, places: dict[str, list[Jet]], n: int) -> tuple[Jet, Jet]:
    """The point of a contact, against the body that it rubs on."""
    own = places[contact.body]
    x, z = point(own, contact.at or (0.0, 0.0)) if len(own) > 1 else (own[0], lifted(0.0, n))
    if curve_of(contact) is not None:
        z = z - lifted(contact.on(x), n)
    if isinstance(contact.on, str):
        other = places[contact.on]
        x, z = x - other[0], z - (other[1] if len(other) > 1 else 0.0)
    return x, z


def curve_of(contact: Any) -> Any:
    """The ground as a function of x, if it is one."""
    return contact.on if callable(contact.on) and not callable(getattr(contact.on, "velocity", None)) else None


def slope_of(contact: Any, x: Any) -> tuple[float, float, float]:
    """The slope of the ground at x, its derivative, and the length of the ground for each length of x."""
    if curve_of(contact) is None:
        return 0.0, 0.0, 1.0
    there = lifted(contact.on(Jet(float(x), [1.0], 1.0, 0.0)), 1)
    slope, bend = float(there.slopes[0]), float(there.second)
    return slope, bend, (1.0 + slope * slope) ** 0.5


def point(of_body: list[Jet], at: tuple[Any, Any]) -> tuple[Jet, Jet]:
    """A point of a body, from its own axes."""
    x, z, (a, b) = of_body[0], of_body[1], at
    if len(of_body) < 3:
        return x + a, z + b
    turn: Any = of_body[2]
    c, s = cos(turn), sin(turn)
    return x + a * c - b * s, z + a * s + b * c


def apart_of(link: Any, t: float, places: dict[str, list[Jet]], n: int) -> Apart:
    """How far the ends of a link are apart: between angles, or on a line, with a sign."""
    (x1, z1, a1), (x2, z2, a2) = ends = [_end(end, t, places, n) for end in link.ends]
    if link.turns:
        return Apart(a1 - a2, 0.0, 0.0)
    if all(z is None for _, z, _ in ends):
        return Apart(x1 - x2, 1.0, 0.0)
    x, z = x1 - x2, (lifted(0.0, n) if z1 is None else z1) - (lifted(0.0, n) if z2 is None else z2)
    distance = (x * x + z * z) ** 0.5
    return Apart(distance, x.value / distance.value, z.value / distance.value)


def _end(end: Any, t: float, places: dict[str, list[Jet]], n: int) -> tuple[Any, Any, Any]:
    """Where a link ends in x and z, which may be a line without heights, and at what angle."""
    nothing = lifted(0.0, n)
    if end is None:
        return nothing, None, nothing
    body = body_of(end)
    if body is None:
        x, z = end.at(Jet(t, [0.0] * n, 1.0, 0.0)) if callable(end.at) else end.at
        return lifted(x, n), lifted(z, n), nothing
    of_body = places[body]
    if isinstance(end, Point):
        x, z = point([*of_body, nothing][: max(2, len(of_body))], end.at)
        return x, z, nothing
    return of_body[0], of_body[1] if len(of_body) > 1 else None, of_body[2] if len(of_body) > 2 else nothing


def solution(matrix: Sequence[Sequence[Any]], right: Sequence[Any]) -> Floats:
    """The solution of M a = right by Cholesky's factors without roots, M = L D L^T.

    Examples
    --------
    >>> solution([[2.0, 1.0], [1.0, 3.0]], [3.0, 5.0])
    [0.8, 1.4]
    """
    n = len(right)
    L: list[Floats] = [[0.0] * n for _ in range(n)]
    D: Floats = []
    y: Floats = []
    for i in range(n):
        for j in range(i):
            L[i][j] = (matrix[i][j] - sum(L[i][k] * L[j][k] * D[k] for k in range(j))) / D[j]
        D.append(matrix[i][i] - sum(L[i][k] * L[i][k] * D[k] for k in range(i)))
        y.append(right[i] - sum(L[i][k] * y[k] for k in range(i)))
    a = [value / d for value, d in zip(y, D, strict=True)]
    for i in reversed(range(n)):
        a[i] = a[i] - sum(L[k][i] * a[k] for k in range(i + 1, n))
    return a
