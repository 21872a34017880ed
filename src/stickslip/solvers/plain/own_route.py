r"""Motion of a machine in coordinates of its own, for the judge alone: derived in floats, and no line of it is the engine's.

.. math:: M \ddot q = h - \sum_i g_i R_i, \qquad M = \sum_b J_b^T m_b J_b, \qquad h = Q + \sum_b J_b^T (F_b - m_b \dot J_b \dot q)

Where bodies are is asked once for a state, with numbers that carry all that is needed (`stickslip.solvers.plain.jets`). Of a kinetic
energy T the matrix is what T is at unit rates and their sums, and Lagrange's equations take its slopes. A rail's normal force is one more
unknown of the same linear equations: what the bodies that it bears need along its normal.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from typing import Any, NamedTuple

from stickslip.basics.maths import cos, sin
from stickslip.models.friction.law_adapter import TINY
from stickslip.models.link_ends import Point, body_of
from stickslip.solvers.plain.jets import Jet, coordinates, lifted
from stickslip.solvers.plain.kinks import Watching, noting

_KEPT = 6  # states that are remembered
Floats = list[Any]


class _Shape(NamedTuple):
    """What places and energies alone ask for: the matrix of inertia, what velocities do, places, and distances that links see."""

    M: list[Floats]
    h: Floats
    places: dict[str, list[Jet]]
    apart: list[_Apart]


class _State(NamedTuple):
    """The same with forces: generalized ones without friction, those on each body, and tensions of links."""

    shape: _Shape
    h: Floats
    forces: dict[str, Floats]
    tensions: Floats


class _Apart(NamedTuple):
    """How far the ends of a link are apart, and in which direction from the second to the first."""

    distance: Jet
    x: Any
    z: Any


class OwnRoute:
    """The methods of a machine's equations that the judge asks of it, by a way of its own.

    Parameters
    ----------
    mechanics : stickslip.models.any_coordinates.AnyCoordinates
        The machine: what its declaration gives, and the constant rows of its contacts.

    Examples
    --------
    A bead on a wire z = x^2, where it is steep and fast: the curve takes away what gravity gives.

    >>> import stickslip as ss
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True, eq=False)
    ... class Bead(ss.Machine):
    ...     coordinates = ("x",)
    ...
    ...     def bodies(self):
    ...         return {"bead": ss.Body(2.0)}
    ...
    ...     def places(self, t, q):
    ...         return {"bead": (q["x"], q["x"] ** 2)}
    >>> x, v = 0.3, 1.5
    >>> (a,) = OwnRoute(Bead().mechanics).accelerations(0.0, (x,), (v,), ())
    >>> round(a + 2 * x * (9.81 + 2 * v**2) / (1 + 4 * x**2), 12)
    0.0
    """

    def __init__(self, mechanics: Any):
        self.mechanics, self.model, self.names = mechanics, mechanics.model, mechanics.bodies
        self.rows = [list(map(float, row)) for row in mechanics.rows(0.0, mechanics.start)]
        self._shapes: dict[Any, _Shape] = {}
        self._states: dict[Any, _State] = {}

    # ---- asked by the judge ----
    def felt(self, t: float, q: Sequence[Any], u: Sequence[Any]) -> list[Floats]:
        """What a unit force in each contact does to the rates of the coordinates."""
        M = self.shape(t, q, u).M
        return [[float(value) for value in solution(M, row)] for row in self.rows]

    def accelerations(self, t: float, q: Sequence[Any], u: Sequence[Any], R: Sequence[Any], z: Any = None) -> Floats:
        """Second derivatives of the coordinates under friction forces."""
        state = self.state(t, q, u, z)
        h = [of - sum(row[j] * force for row, force in zip(self.rows, R, strict=True)) for j, of in enumerate(state.h)]
        return solution(state.shape.M, h)

    def load(self, i: int, t: float, q: Sequence[Any], u: Sequence[Any], z: Any = None) -> Any:
        """Normal force on a contact [N]: what it says, or what a rail needs while its body slips to the side of its slip."""
        contact = self.mechanics.touching[i].contact
        if not self.mechanics.touching[i].is_held:
            return contact.load(t, self._named(q)) if callable(contact.load) else contact.load
        state = self.state(t, q, u, z)
        slip = sum(g * float(v) for g, v in zip(self.rows[i], u, strict=True)) + float(self.mechanics.offsets(t)[i])
        per_load = float(self.mechanics.laws[i].sliding(slip or TINY, 1.0))
        need, by = self._needed(i, state)
        free = need + sum(c * a for c, a in zip(by, solution(state.shape.M, state.h), strict=True))
        side = 1.0 if noting(free, u[0]) > 0.0 else -1.0
        left = 1.0 + per_load * side * self._given(i, state, by)
        return side * free / left if left else math.inf

    def border(self, i: int, t: float, q: Sequence[Any], u: Sequence[Any], side: int) -> float | None:
        """Positive as long as one load of a rail follows while its body slips to a side: 1 - |b C|; None of a load that is given."""
        if not self.mechanics.touching[i].is_held:
            return None
        slip = sum(g * float(v) for g, v in zip(self.rows[i], u, strict=True)) + float(self.mechanics.offsets(t)[i])
        state = self.state(t, q, u, None)
        per_load = float(self.mechanics.laws[i].sliding(slip if side * slip > TINY else side * TINY, 1.0))
        return 1.0 - abs(per_load * float(self._given(i, state, self._needed(i, state)[1])))

    def _given(self, i: int, state: _State, by: Floats) -> Any:
        """How much of the force of a rail its friction of one newton takes."""
        return sum(c * a for c, a in zip(by, solution(state.shape.M, self.rows[i]), strict=True))

    # ---- once for a state ----
    def state(self, t: float, q: Sequence[Any], u: Sequence[Any], z: Any) -> _State:
        """What is derived for one state."""
        if self._forces_have_conditions:
            return self._with_forces(t, q, u, z)
        q, u, z = list(map(float, q)), list(map(float, u)), None if z is None else list(map(float, z))
        return _remembered(self._states, (t, *q, *u, *(z or ())), lambda: self._with_forces(t, q, u, z))

    def shape(self, t: float, q: Sequence[Any], u: Sequence[Any]) -> _Shape:
        """What places or energies say of one state."""
        if self._places_have_conditions:
            return self._derived(t, q, u)
        q, u = list(map(float, q)), list(map(float, u))
        return _remembered(self._shapes, (t, *q, *u), lambda: self._derived(t, q, u))

    @cached_property
    def _places_have_conditions(self) -> bool:
        """Whether a condition on the state is asked, whose branches are held while an integrator steps."""
        return self._asks(lambda t, q, u: self._derived(t, q, u).h)

    @cached_property
    def _forces_have_conditions(self) -> bool:
        return self._places_have_conditions or self._asks(lambda t, q, u: self._with_forces(t, q, u, None).h)

    def _asks(self, function: Callable[..., Floats]) -> bool:
        return bool(Watching(function).differences(None, 0.0, self.mechanics.start, [0.0] * len(self.names)))

    def _named(self, values: Iterable[Any]) -> dict[str, Any]:
        return dict(zip(self.names, values, strict=True))

    def _derived(self, t: float, q: Sequence[Any], u: Sequence[Any]) -> _Shape:
        if self.mechanics.by_energy:
            M, gyroscopic = self._by_energy(q, u)
            return _Shape(M, [-g for g in gyroscopic], {}, [])
        n = len(q)
        given = self.model.places(Jet(t, [0.0] * n, 1.0, 0.0), self._named(coordinates(q, u)))
        places = {
            name: [lifted(part, n) for part in (given[name] if isinstance(given[name], tuple) else (given[name],))]
            for name in self.mechanics.placed
        }
        M, h = [[0.0] * n for _ in range(n)], [0.0] * n
        for name, components in places.items():
            for m, part in zip(self._inertias(name), components, strict=False):
                slopes = part.slopes
                for j in range(n):
                    h[j] = h[j] - m * slopes[j] * part.second
                    for k in range(j + 1):
                        M[j][k] = M[k][j] = M[j][k] + m * slopes[j] * slopes[k]
        return _Shape(M, h, places, [_apart(link, t, places, n) for link in self.mechanics.placed_links])

    def _with_forces(self, t: float, q: Sequence[Any], u: Sequence[Any], z: Any) -> _State:
        shape = self.shape(t, q, u)
        h = [a + b for a, b in zip(self._generalized(t, q, u, z), shape.h, strict=True)]
        distances = [apart.distance for apart in shape.apart]
        tensions = [
            link.pull(t, noting(d.value, q[0]), noting(d.rate, q[0]))
            for link, d in zip(self.mechanics.placed_links, distances, strict=True)
        ]
        for tension, distance in zip(tensions, distances, strict=True):
            h = [value - tension * slope for value, slope in zip(h, distance.slopes, strict=True)]
        forces = {name: self._on_body(name, t, components, q[0]) for name, components in shape.places.items()}
        for name, components in shape.places.items():
            for part, force in zip(components, forces[name], strict=True):
                h = [value + force * slope for value, slope in zip(h, part.slopes, strict=True)]
        return _State(shape, h, forces, tensions)

    def _inertias(self, name: str) -> tuple[Any, Any, Any]:
        body = self.mechanics.placed[name]
        return body.mass, body.mass, body.inertia

    def _generalized(self, t: float, q: Sequence[Any], u: Sequence[Any], z: Any) -> Floats:
        """Forces that are named by coordinate: those of the machine, of controllers, and of links between coordinates."""
        x, v, parts = self._named(q), self._named(u), self.mechanics.controllers
        gathered = dict.fromkeys(self.names, 0.0)
        of_machine = dict(self.model.forces(t, dict(x), dict(v)))
        of_controllers = parts.forces(t, x, v, parts.start(t, x, v) if z is None else z) if parts.count else ()
        for name, force in (*of_machine.items(), *of_controllers):
            gathered[name] = gathered[name] + force
        for (first, second), pull in self.mechanics.pulls:
            far, fast = (0.0, 0.0) if second is None else (x[second], v[second])
            tension = pull(t, x[first] - far, v[first] - fast)
            gathered[first] = gathered[first] - tension
            if second is not None:
                gathered[second] = gathered[second] + tension
        return [gathered[name] for name in self.names]

    def _on_body(self, name: str, t: float, components: list[Jet], like: Any) -> Floats:
        """Force on a body along x, along z, and torque: its own, and its weight."""
        body, plane = self.mechanics.placed[name], len(components) > 1
        where, fast = ([noting(value, like) for value in of] for of in ([p.value for p in components], [p.rate for p in components]))
        own = body.applied(t, tuple(where) if plane else where[0], tuple(fast) if plane else fast[0])
        forces = [*own, 0.0, 0.0][:3] if isinstance(own, tuple) else [own, 0.0, 0.0]
        if plane:
            forces[1] = forces[1] - body.mass * self.mechanics.gravity
        return forces[: len(components)]

    # ---- energies ----
    def _by_energy(self, q: Sequence[Any], u: Sequence[Any]) -> tuple[list[Floats], Floats]:
        """The matrix of inertia, and d/dt(dT/du) - dT/dq while the rates stay as they are."""
        n = len(q)
        along = self._named(coordinates(q, u))
        direct = self.model.inertia(dict(along)) if callable(getattr(self.model, "inertia", None)) else None
        parts, rest = self._parts_of_energy(along, n) if direct is None else (direct, [lifted(0.0, n)] * n)
        entries = [[lifted(part, n) for part in row] for row in parts]
        terms = []
        for i in range(n):
            momentum = sum(entries[i][k].rate * u[k] for k in range(n)) + rest[i].rate
            slope = sum(0.5 * entries[j][k].slopes[i] * u[j] * u[k] for j in range(n) for k in range(n))
            terms.append(momentum - slope - sum(rest[k].slopes[i] * u[k] for k in range(n)))
        if direct is None:
            still = lifted(self.model.kinetic(dict(along), dict.fromkeys(self.names, 0.0)), n)
            terms = [term - slope for term, slope in zip(terms, still.slopes, strict=True)]
        return [[part.value for part in row] for row in entries], terms

    def _parts_of_energy(self, along: dict[str, Jet], n: int) -> tuple[list[list[Jet]], list[Jet]]:
        """What is quadratic and what is linear in the rates, of a kinetic energy."""

        def at(*rates: tuple[int, float]) -> Jet:
            u = dict.fromkeys(self.names, 0.0) | {self.names[j]: rate for j, rate in rates}
            return lifted(self.model.kinetic(dict(along), u), n)

        still, ahead, back = at(), [at((j, 1.0)) for j in range(n)], [at((j, -1.0)) for j in range(n)]
        linear = [(a - b) * 0.5 for a, b in zip(ahead, back, strict=True)]
        matrix = [[ahead[j] + back[j] - still * 2.0 if j == k else still for k in range(n)] for j in range(n)]
        for j in range(n):
            for k in range(j):
                matrix[j][k] = matrix[k][j] = at((j, 1.0), (k, 1.0)) - ahead[j] - ahead[k] + still
        return matrix, linear

    # ---- rails ----
    def _needed(self, i: int, state: _State) -> tuple[Any, Floats]:
        """The force along a rail's normal that what it bears needs: without accelerations of coordinates, and by each of these."""
        normal, n = self._normal(i, state.shape.places), len(self.names)
        need: Any = 0.0
        by: Floats = [0.0] * n
        borne = self._borne(i)
        for link, tension, apart in zip(self.mechanics.placed_links, state.tensions, state.shape.apart, strict=True):
            held = [body_of(end) in borne for end in link.ends]
            need = need + (held[0] - held[1]) * tension * (normal[0] * apart.x + normal[1] * apart.z)
        for name in borne:
            mass, components, forces = self.mechanics.placed[name].mass, state.shape.places[name], state.forces[name]
            for along, part, force in zip(normal, components[:2], forces, strict=False):
                need = need + along * (mass * part.second - force)
                by = [value + along * mass * slope for value, slope in zip(by, part.slopes, strict=True)]
        return need, by

    def _borne(self, i: int) -> set[str]:
        """The body of a rail and all that rest on it; on a rail that stands still, also bodies that no rail holds."""
        held = {c.contact.body: c.contact.on for c in self.mechanics.touching if c.is_held}
        contact = self.mechanics.touching[i].contact
        names = {contact.body} if isinstance(contact.on, str) else {contact.body} | (set(self.mechanics.placed) - set(held))
        while more := {body for body, on in held.items() if on in names} - names:
            names |= more
        return names

    def _normal(self, i: int, places: dict[str, list[Jet]]) -> tuple[Any, Any]:
        """A quarter turn from the way along which the one coordinate that moves a point moves it, against what it rubs on."""
        contact = self.mechanics.touching[i].contact
        x, z = _point(places[contact.body], contact.at or (0.0, 0.0))
        if isinstance(contact.on, str):
            other = places[contact.on]
            x, z = x - other[0], z - (other[1] if len(other) > 1 else 0.0)
        ways = list(zip(x.slopes, z.slopes, strict=True))
        dx, dz = max(ways, key=lambda way: float(way[0]) ** 2 + float(way[1]) ** 2)
        length = (dx * dx + dz * dz) ** 0.5
        return -dz / length, dx / length


def _point(components: list[Jet], at: tuple[Any, Any]) -> tuple[Jet, Jet]:
    """A point of a body, from its own axes."""
    x, z, (a, b) = components[0], components[1], at
    if len(components) < 3:
        return x + a, z + b
    turn: Any = components[2]
    c, s = cos(turn), sin(turn)
    return x + a * c - b * s, z + a * s + b * c


def _remembered(known: dict[Any, Any], key: Any, derived: Callable[[], Any]) -> Any:
    """What is derived for a state, or was for one of the last."""
    if key not in known:
        if len(known) == _KEPT:
            del known[next(iter(known))]
        known[key] = derived()
    return known[key]


def _apart(link: Any, t: float, places: dict[str, list[Jet]], n: int) -> _Apart:
    """How far the ends of a link are apart: between angles, or on a line, with a sign."""
    (x1, z1, a1), (x2, z2, a2) = ends = [_end(end, t, places, n) for end in link.ends]
    if link.turns:
        return _Apart(a1 - a2, 0.0, 0.0)
    if all(z is None for _, z, _ in ends):
        return _Apart(x1 - x2, 1.0, 0.0)
    x, z = x1 - x2, (lifted(0.0, n) if z1 is None else z1) - (lifted(0.0, n) if z2 is None else z2)
    distance = (x * x + z * z) ** 0.5
    return _Apart(distance, x.value / distance.value, z.value / distance.value)


def _end(end: Any, t: float, places: dict[str, list[Jet]], n: int) -> tuple[Any, Any, Any]:
    """Where a link ends in x and z, which may be a line without heights, and at what angle."""
    nothing = lifted(0.0, n)
    if end is None:
        return nothing, None, nothing
    body = body_of(end)
    if body is None:
        x, z = end.at(Jet(t, [0.0] * n, 1.0, 0.0)) if callable(end.at) else end.at
        return lifted(x, n), lifted(z, n), nothing
    components = places[body]
    if isinstance(end, Point):
        x, z = _point([*components, nothing][: max(2, len(components))], end.at)
        return x, z, nothing
    return components[0], components[1] if len(components) > 1 else None, components[2] if len(components) > 2 else nothing


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
