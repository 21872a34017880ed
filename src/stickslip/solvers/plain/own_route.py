r"""Motion of a machine in coordinates of its own, for the judge alone: derived in floats, and no line of it is the engine's.

.. math:: M \ddot q = h - \sum_i g_i R_i, \qquad M = \sum_b J_b^T m_b J_b, \qquad h = Q + \sum_b J_b^T (F_b - m_b \dot J_b \dot q)

Where bodies are is asked once for a state, with numbers that carry all that is needed (`stickslip.solvers.plain.jets`). Of a kinetic
energy T the matrix is what T is at unit rates and their sums, and Lagrange's equations take its slopes. A rail's normal force is one more
unknown of the same linear equations: what the bodies that it bears need along its normal.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any, NamedTuple

from stickslip.basics.maths import cos, sin
from stickslip.models.friction.law_adapter import TINY
from stickslip.solvers.plain.jets import Jet, coordinates, lifted
from stickslip.solvers.plain.kinks import Watching, noting

_KEPT = 6  # states that are remembered
Floats = list[Any]


class _State(NamedTuple):
    """What a state asks for: the matrix of inertia, the generalized forces without friction, and of each body its place and forces."""

    M: list[Floats]
    h: Floats
    places: dict[str, list[Jet]]
    forces: dict[str, Floats]


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
        self._states: dict[Any, _State] = {}

    # ---- asked by the judge ----
    def felt(self, t: float, q: Sequence[Any], u: Sequence[Any]) -> list[Floats]:
        """What a unit force in each contact does to the rates of the coordinates."""
        M = self.state(t, q, u, None).M
        return [[float(value) for value in solution(M, row)] for row in self.rows]

    def accelerations(self, t: float, q: Sequence[Any], u: Sequence[Any], R: Sequence[Any], z: Any = None) -> Floats:
        """Second derivatives of the coordinates under friction forces."""
        state = self.state(t, q, u, z)
        h = [of - sum(row[j] * force for row, force in zip(self.rows, R, strict=True)) for j, of in enumerate(state.h)]
        return solution(state.M, h)

    def load(self, i: int, t: float, q: Sequence[Any], u: Sequence[Any], z: Any = None) -> Any:
        """Normal force on a contact [N]: what it says, or what a rail needs while its body slips to the side of its slip."""
        contact = self.mechanics.touching[i].contact
        if not self.mechanics.touching[i].is_held:
            return contact.load(t, self._named(q)) if callable(contact.load) else contact.load
        state = self.state(t, q, u, z)
        slip = sum(g * float(v) for g, v in zip(self.rows[i], u, strict=True)) + float(self.mechanics.offsets(t)[i])
        per_load = float(self.mechanics.laws[i].sliding(slip or TINY, 1.0))
        need, by = self._needed(i, state)
        free = need + sum(c * a for c, a in zip(by, solution(state.M, state.h), strict=True))
        side = 1.0 if noting(free, u[0]) > 0.0 else -1.0
        gives = sum(c * a for c, a in zip(by, solution(state.M, self.rows[i]), strict=True))
        return side * free / (1.0 + per_load * side * gives)

    # ---- once for a state ----
    def state(self, t: float, q: Sequence[Any], u: Sequence[Any], z: Any) -> _State:
        """What is derived for one state; where no condition is asked the last ones are remembered."""
        if self._has_conditions:
            return self._derived(t, q, u, z)
        t, q, u, z = float(t), list(map(float, q)), list(map(float, u)), None if z is None else list(map(float, z))
        numbers = (t, *q, *u, *(z or ()))
        if numbers not in self._states:
            if len(self._states) == _KEPT:
                del self._states[next(iter(self._states))]
            self._states[numbers] = self._derived(t, q, u, z)
        return self._states[numbers]

    @cached_property
    def _has_conditions(self) -> bool:
        """Whether a condition on the state is asked on the way, whose branches are held while an integrator steps."""

        def asked(t: float, q: Floats, u: Floats) -> Floats:
            return self._derived(t, q, u, None).h

        return bool(Watching(asked).differences(None, 0.0, self.mechanics.start, [0.0] * len(self.names)))

    def _named(self, values: Iterable[Any]) -> dict[str, Any]:
        return dict(zip(self.names, values, strict=True))

    def _derived(self, t: float, q: Sequence[Any], u: Sequence[Any], z: Any) -> _State:
        generalized = self._generalized(t, q, u, z)
        if self.mechanics.by_energy:
            M, gyroscopic = self._by_energy(q, u)
            return _State(M, [Q - g for Q, g in zip(generalized, gyroscopic, strict=True)], {}, {})
        n = len(q)
        given = self.model.places(Jet(t, [0.0] * n, 1.0, 0.0), self._named(coordinates(q, u)))
        places = {
            name: [lifted(part, n) for part in (given[name] if isinstance(given[name], tuple) else (given[name],))]
            for name in self.mechanics.placed
        }
        forces = {name: self._on_body(name, t, place) for name, place in places.items()}
        M, h = [[0.0] * n for _ in range(n)], generalized
        for name, place in places.items():
            for m, part, force in zip(self._inertias(name), place, forces[name], strict=False):
                net, slopes = force - m * part.second, part.slopes
                for j in range(n):
                    h[j] = h[j] + slopes[j] * net
                    for k in range(j + 1):
                        M[j][k] = M[k][j] = M[j][k] + m * slopes[j] * slopes[k]
        return _State(M, h, places, forces)

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
        for (first, second), link in self.mechanics.links.items():
            far, fast = (0.0, 0.0) if second is None else (x[second], v[second])
            tension = link.force(x[first] - far, v[first] - fast)
            gathered[first] = gathered[first] - tension
            if second is not None:
                gathered[second] = gathered[second] + tension
        return [gathered[name] for name in self.names]

    def _on_body(self, name: str, t: float, place: list[Jet]) -> Floats:
        """Force on a body along x, along z, and torque: its own, and its weight."""
        body, plane = self.mechanics.placed[name], len(place) > 1
        where, fast = [part.value for part in place], [part.rate for part in place]
        own = body.applied(t, tuple(where) if plane else where[0], tuple(fast) if plane else fast[0])
        forces = [*own, 0.0, 0.0][:3] if isinstance(own, tuple) else [own, 0.0, 0.0]
        if plane:
            forces[1] = forces[1] - body.mass * self.mechanics.gravity
        return forces[: len(place)]

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
        normal, n = self._normal(i, state), len(self.names)
        need: Any = 0.0
        by: Floats = [0.0] * n
        for name in self._borne(i):
            mass, place, forces = self.mechanics.placed[name].mass, state.places[name], state.forces[name]
            for along, part, force in zip(normal, place[:2], forces, strict=False):
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

    def _normal(self, i: int, state: _State) -> tuple[Any, Any]:
        """A quarter turn from the way along which the one coordinate that moves a point moves it, against what it rubs on."""
        contact = self.mechanics.touching[i].contact
        x, z = _point(state.places[contact.body], contact.at or (0.0, 0.0))
        if isinstance(contact.on, str):
            other = state.places[contact.on]
            x, z = x - other[0], z - (other[1] if len(other) > 1 else 0.0)
        ways = list(zip(x.slopes, z.slopes, strict=True))
        dx, dz = max(ways, key=lambda way: float(way[0]) ** 2 + float(way[1]) ** 2)
        length = (dx * dx + dz * dz) ** 0.5
        return -dz / length, dx / length


def _point(place: list[Jet], at: tuple[Any, Any]) -> tuple[Jet, Jet]:
    """A point of a body, from its own axes."""
    x, z, (a, b) = place[0], place[1], at
    if len(place) < 3:
        return x, z
    turn: Any = place[2]
    c, s = cos(turn), sin(turn)
    return x + a * c - b * s, z + a * s + b * c


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
