r"""Motion of a machine in coordinates of its own, for the judge alone: derived in floats, and no line of it is the engine's.

.. math:: M \ddot q = h - \sum_i g_i R_i, \qquad M = \sum_b J_b^T m_b J_b, \qquad h = Q + \sum_b J_b^T (F_b - m_b \dot J_b \dot q)

Where bodies are is asked once for a state, with numbers that carry all that is needed (`stickslip.solvers.plain.jets`). Of a kinetic
energy T the matrix is what T is at unit rates and their sums, and Lagrange's equations take its slopes. A rail's normal force is one more
unknown of the same linear equations: what the bodies that it bears need along its normal.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

from stickslip.models.friction.law_adapter import TINY
from stickslip.models.link_ends import body_of
from stickslip.solvers.plain.jets import Jet, coordinates, lifted
from stickslip.solvers.plain.kinks import Watching, noting
from stickslip.solvers.plain.own_places import Apart, Floats, apart_of, curve_of, rubbing, slope_of, solution

_KEPT = 6  # states that are remembered
_NOTHING = 1e-12  # of its largest slope: a slope that is none


class _Shape(NamedTuple):
    """What places and energies alone ask for: the matrix of inertia, what velocities do, places, and distances that links see."""

    M: list[Floats]
    h: Floats
    places: dict[str, list[Jet]]
    apart: list[Apart]
    slips: list[_Slip]


class _Slip(NamedTuple):
    """What a contact's slip takes of the coordinates' rates, its rate while these stay, and the point that rubs, where it is one."""

    row: Floats
    bias: Any
    point: tuple[Jet, Jet] | None


class _State(NamedTuple):
    """The same with forces: generalized ones without friction, those on each body, and tensions of links."""

    shape: _Shape
    h: Floats
    forces: dict[str, Floats]
    tensions: Floats


class OwnRoute:
    """The methods of a machine's equations that the judge asks of it, by a way of its own.

    Parameters
    ----------
    mechanics : stickslip.models.any_coordinates.AnyCoordinates
        The machine: what its declaration gives.

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
        self.given = [touching.contact for touching in mechanics.touching]
        self._shapes: dict[Any, _Shape] = {}
        self._states: dict[Any, _State] = {}

    # ---- asked by the judge ----
    def rows(self, t: float, q: Sequence[Any], u: Sequence[Any]) -> list[Floats]:
        """What the slip of each contact takes of the coordinates' rates."""
        return [[float(g) for g in slip.row] for slip in self.shape(t, q, u).slips]

    def biases(self, t: float, q: Sequence[Any], u: Sequence[Any]) -> Floats:
        """Rates of the slips while the coordinates' rates stay as they are."""
        return [float(slip.bias) for slip in self.shape(t, q, u).slips]

    def slips(self, t: float, q: Sequence[Any], u: Sequence[Any]) -> Floats:
        """Slip velocities."""
        offsets = self.mechanics.offsets(t)
        return [
            sum(g * float(v) for g, v in zip(row, u, strict=True)) + float(b) for row, b in zip(self.rows(t, q, u), offsets, strict=True)
        ]

    def felt(self, t: float, q: Sequence[Any], u: Sequence[Any], aloft: frozenset[int] = frozenset()) -> list[Floats]:
        """What a unit force in each contact does to the rates of the coordinates."""
        shape = self.shape(t, q, u)
        still = dict.fromkeys(self._keeping(aloft), 0.0)
        return [[float(value) for value in self._moved(shape, slip.row, still)[0]] for slip in shape.slips]

    def accelerations(
        self, t: float, q: Sequence[Any], u: Sequence[Any], R: Sequence[Any], z: Any = None, aloft: frozenset[int] = frozenset()
    ) -> Floats:
        """Second derivatives of the coordinates under friction forces, with contacts in flight that do not press."""
        state = self.state(t, q, u, z)
        slips = state.shape.slips
        h = [of - sum(slip.row[j] * force for slip, force in zip(slips, R, strict=True)) for j, of in enumerate(state.h)]
        return self._moved(state.shape, h, self._keeping(aloft, state.shape))[0]

    def load(
        self, i: int, t: float, q: Sequence[Any], u: Sequence[Any], z: Any = None, side: int | None = None, rests: bool = False
    ) -> Any:
        """Normal force on a contact [N]: what it says, or what its motion needs while it slips to its side, or to a given one.

        Or while it `rests`, and bears on that side what it can.
        """
        contact = self.given[i]
        if not self.mechanics.touching[i].is_held:
            return contact.load(t, self._named(q)) if callable(contact.load) else contact.load
        state = self.state(t, q, u, z)
        free, by = self._pressing(i, state)
        way = 1.0 if contact.hold == "push" or noting(free, u[0]) > 0.0 else -1.0
        friction = float(self.mechanics.laws[i].breakaway(1.0)[side == 1]) if rests else self.per_load(i, t, q, u, side)
        left = 1.0 + friction * way * by
        return way * free / left if left else math.inf

    def border(self, i: int, t: float, q: Sequence[Any], u: Sequence[Any], side: int) -> float | None:
        """Positive as long as one load follows while a contact slips to a side; None of a load that is given."""
        if not self.mechanics.touching[i].is_held:
            return None
        back = self.per_load(i, t, q, u, side) * float(self._pressing(i, self.state(t, q, u, None))[1])
        return 1.0 + back if self.given[i].hold == "push" else 1.0 - abs(back)

    def gap(self, i: int, t: float, q: Sequence[Any], u: Sequence[Any]) -> tuple[float, float]:
        """How high the point of a contact is above what it rubs on, and how fast that grows."""
        point = self.shape(t, q, u).slips[i].point
        return (float(point[1].value), float(point[1].rate)) if point is not None else (0.0, 0.0)

    def rising(self, i: int, t: float, q: Sequence[Any], u: Sequence[Any], z: Any) -> float:
        """How fast the rate of its height grows while it flies."""
        height = self._upwards(i, self.shape(t, q, u))
        free = self.accelerations(t, q, u, [0.0] * len(self.given), z, frozenset([i]))
        return float(height.second + sum(slope * a for slope, a in zip(height.slopes, free, strict=True)))

    def per_load(self, i: int, t: float, q: Sequence[Any], u: Sequence[Any], side: int | None) -> float:
        """Friction force for a load of one newton."""
        slip = self.slips(t, q, u)[i]
        if side is not None and not side * slip > TINY:
            slip = side * TINY
        return float(self.mechanics.laws[i].sliding(slip or TINY, 1.0))

    # ---- contacts that keep a height ----
    def _keeping(self, aloft: frozenset[int], shape: _Shape | None = None) -> dict[int, Any]:
        """By contact that keeps its height how fast that would change its rate."""
        touching = [i for i, kind in enumerate(self._kinds) if kind == "kept" and i not in aloft]
        return {i: 0.0 if shape is None else self._upwards(i, shape).second for i in touching}

    def steepness(self, i: int, shape: _Shape) -> float:
        """The force that presses for one that changes the height."""
        point = shape.slips[i].point
        return 1.0 if point is None else slope_of(self.given[i], point[0].value)[2]

    def _upwards(self, i: int, shape: _Shape) -> Jet:
        point = shape.slips[i].point
        assert point is not None
        return point[1]

    def _moved(self, shape: _Shape, force: Floats, keeping: dict[int, Any]) -> tuple[Floats, dict[int, Any]]:
        """Accelerations under generalized forces, and the normal forces of contacts that keep their heights: one set of equations."""
        M, h = [[*row] for row in shape.M], [*force]
        for i, bias in keeping.items():
            slopes = [*self._upwards(i, shape).slopes, *(0.0 for _ in range(len(M) - len(self.names)))]
            M = [[*row, slope] for row, slope in zip(M, slopes, strict=True)]
            M.append([*slopes, 0.0])
            h.append(-bias)
        unknowns = solution(M, h)
        return unknowns[: len(self.names)], {i: -force for i, force in zip(keeping, unknowns[len(self.names) :], strict=True)}

    def _pressing(self, i: int, state: _State) -> tuple[Any, Any]:
        """The normal force without friction, and how much of it friction of one newton takes."""
        row = state.shape.slips[i].row
        if self._kinds[i] == "kept":
            free = self._moved(state.shape, state.h, self._keeping(frozenset(), state.shape))[1][i]
            s = self.steepness(i, state.shape)
            return s * free, -s * self._moved(state.shape, [-g for g in row], self._keeping(frozenset()))[1][i]
        need, by = self.needed(i, state)
        free = need + sum(c * a for c, a in zip(by, solution(state.shape.M, state.h), strict=True))
        return free, sum(c * a for c, a in zip(by, solution(state.shape.M, row), strict=True))

    @cached_property
    def _kinds(self) -> list[str]:
        """Of each contact what its slip is: "" by its declaration, "along" a way in x and z, "level" along x, or "kept" at its height."""
        n, kinds = len(self.names), []
        looks = [[0.1 + 0.37 * k + 0.23 * j for j in range(n)] for k in range(3)] if not self.mechanics.by_energy else []
        arrangements = [self._places(0.0, q, [0.0] * n) for q in looks]
        for contact in self.given:
            if self.mechanics.by_energy or not (isinstance(contact.body, str) and contact.body in self.mechanics.placed):
                kinds.append("")
                continue
            points = [rubbing(contact, places, n) for places in arrangements]
            size = max(abs(s) for point in points for part in point for s in part.slopes)
            moving = [j for j in range(n) if any(abs(part.slopes[j]) > _NOTHING * size for point in points for part in point)]
            rising = any(abs(s) > _NOTHING * size for _, z in points for s in z.slopes)
            along = contact.hold == "both" and len(moving) == 1
            kinds.append("along" if along and rising else "kept" if rising and contact.load is None else "level")
        return kinds

    def _slip(self, i: int, places: dict[str, list[Jet]], n: int) -> _Slip:
        """The slip of a contact at a state."""
        contact, kind = self.given[i], self._kinds[i]
        if not kind:
            return _Slip([float(g) for g in self.mechanics.touching[i].row], 0.0, None)
        x, z = rubbing(contact, places, n)
        if curve_of(contact) is not None:
            slope, bend, length = slope_of(contact, x.value)
            up = z + lifted(contact.on(x), n)
            w = (x.rate + slope * up.rate) / length
            bias = (x.second + slope * up.second + bend * x.rate * up.rate) / length - w * slope * bend * x.rate / length**2
            return _Slip([(a + slope * b) / length for a, b in zip(x.slopes, up.slopes, strict=True)], bias, (x, z))
        if kind != "along":
            return _Slip(list(x.slopes), x.second, (x, z))
        j = max(range(n), key=lambda j: float(x.slopes[j]) ** 2 + float(z.slopes[j]) ** 2)
        dx, dz = x.slopes[j], z.slopes[j]
        length = dz if self._upright(i) else (dx * dx + dz * dz) ** 0.5
        return _Slip([length if k == j else 0.0 for k in range(n)], (dx * x.second + dz * z.second) / length, (x, z))

    @lru_cache(maxsize=64)  # noqa: B019  # of one run
    def _upright(self, i: int) -> bool:
        """Whether a way goes along z alone."""
        n = len(self.names)
        x, _ = rubbing(self.given[i], self._places(0.0, [0.1 + 0.23 * j for j in range(n)], [0.0] * n), n)
        return all(abs(s) <= _NOTHING for s in x.slopes)

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
            return _Shape(M, [-g for g in gyroscopic], {}, [], [self._slip(i, {}, len(q)) for i in range(len(self.given))])
        n, places = len(q), self._places(t, q, u)
        M, h = [[0.0] * n for _ in range(n)], [0.0] * n
        for name, components in places.items():
            for m, part in zip(self._inertias(name), components, strict=False):
                slopes = part.slopes
                for j in range(n):
                    h[j] = h[j] - m * slopes[j] * part.second
                    for k in range(j + 1):
                        M[j][k] = M[k][j] = M[j][k] + m * slopes[j] * slopes[k]
        apart = [apart_of(link, t, places, n) for link in self.mechanics.placed_links]
        return _Shape(M, h, places, apart, [self._slip(i, places, n) for i in range(len(self.given))])

    def _places(self, t: float, q: Sequence[Any], u: Sequence[Any]) -> dict[str, list[Jet]]:
        """Where bodies are."""
        n = len(q)
        given = self.model.places(Jet(t, [0.0] * n, 1.0, 0.0), self._named(coordinates(q, u)))
        return {
            name: [lifted(part, n) for part in (given[name] if isinstance(given[name], tuple) else (given[name],))]
            for name in self.mechanics.placed
        }

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
    def needed(self, i: int, state: _State) -> tuple[Any, Floats]:
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
        """Upwards, or a quarter turn from the way along which the one coordinate that moves a point moves it."""
        if self._kinds[i] != "along":
            return 0.0, 1.0
        x, z = rubbing(self.given[i], places, len(self.names))
        dx, dz = max(zip(x.slopes, z.slopes, strict=True), key=lambda way: float(way[0]) ** 2 + float(way[1]) ** 2)
        length = dz if self._upright(i) else (dx * dx + dz * dz) ** 0.5
        return -dz / length, dx / length


def _remembered(known: dict[Any, Any], key: Any, derived: Callable[[], Any]) -> Any:
    """What is derived for a state, or was for one of the last."""
    if key not in known:
        if len(known) == _KEPT:
            del known[next(iter(known))]
        known[key] = derived()
    return known[key]
